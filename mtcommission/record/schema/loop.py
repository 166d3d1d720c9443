"""The feedback loop of a record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from mtcommission.control_kinds.kind import FEATURES, PositionLoop
from mtcommission.control_kinds.kinds import KINDS
from mtcommission.machine.control import ForceFilter
from mtcommission.messages.message import Message
from mtcommission.record.rules import long, named, one_of
from mtcommission.record.schema.values import (
    ByMode,
    Jerk,
    Matrix,
    Positive,
    PositiveOrNone,
    Series,
    Words,
    mode_names,
)

BODE = ("open_loop_db", "open_loop_deg", "closed_velocity_db")
LOOPS = ("without-state-feedback", "with-state-feedback", "loop-in-use")
"""Whose answer to a disturbance there may be."""


def _bode(record: Any) -> list[str]:
    return [] if record.machine.follows else list(BODE)


def _damped(record: Any) -> list[str]:
    return [] if record.machine.follows else mode_names(record)


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """The linear nominal loop from [x_ref, v_ref, a_ref, j_ref] to the outputs."""

    A: Annotated[Matrix, long("states", "states")]
    B: Annotated[Matrix, long("states", "inputs")]
    C: Annotated[Matrix, long("outputs", "states")]
    D: Annotated[Matrix, long("outputs", "inputs")]
    dt: float
    states: list[str]
    inputs: list[str]
    outputs: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedforwardEntry:
    """Weights of the feed-forward [-], and the mass by which acceleration becomes force."""

    velocity: float
    acceleration: float
    jerk: float
    mass: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ObserverEntry:
    """The predicting observer at the velocity cycle: x̂⁺ = A x̂ + B F_set + L (y - C x̂)."""

    states: list[str]
    sensors: list[str]
    A: Annotated[Matrix, long("states", "states")]
    B: Annotated[list[float], long("states")]
    C: Annotated[Matrix, long("", "states")]
    L: Annotated[Matrix, long("states")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Margins:
    """How good a loop is."""

    gain_margin_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float
    bandwidth_hz: float | None
    dynamic_stiffness: float  # least disturbance force per displacement of the tool, any frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class VariantEntry(Margins):
    """The loop without or with state feedback, each with its own best limits."""

    name: Message
    used: bool
    mode_damping: ByMode
    weakest_frequency_hz: float
    settling_time: float | None
    residual_deviation: float | None
    max_force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateEntry(Margins):
    """A loop that was tried with the limits that suit it best; margins and stiffness worst case."""

    dynamic_stiffness: Positive
    Kv: float
    Kp: float
    Tn: float
    state_feedback: bool
    settling_time: PositiveOrNone
    meets_requirements: bool
    classic: bool  # by the classic rule
    used: bool  # everything else in the record is about this one


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopCornerEntry(Margins):
    """How good the loop is in one corner of payload and spread, the nominal machine first."""

    payload: float
    frequency_factor: float
    damping_factor: float
    state: str = ""  # as the profile names it
    mode_damping: ByMode


@dataclass(frozen=True, slots=True, kw_only=True)
class DelayEntry:
    """What delays one path of the loop [s]."""

    path: Message
    setpoint_age: float  # how old the setpoint is that is taken
    dead_time: float  # whole cycles until it acts
    hold: float  # mean age of a held value
    lag: float  # first-order lags: drive, filters
    total: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JerkFeedforwardEntry:
    """The recommended limits with some weight of the jerk feed-forward, worst case."""

    weight: float
    used: bool
    reference_delay: float
    max_force: float  # the largest |F_set| that the loop asks for, whatever the drive can give
    settling_time: float | None
    residual_deviation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class EncoderNoiseEntry:
    """What the steps of the encoder do, worst corner, either way."""

    tool: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureEntry:
    """Whether the kind of control has something, and where that was read."""

    name: Annotated[str, one_of(*FEATURES)]
    has: bool
    parameters: str  # its names in the control
    source: str
    verified: bool  # else printed with "(?)"


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossCheckEntry:
    """What python-control says of the nominal loop, put together from the same blocks."""

    pole_difference: float  # largest distance of a pole in the z plane [-]
    gain_margin_db: float | None
    phase_margin_deg: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopPart:
    """The controller and how good its loop is; margins with the loop cut at F_set.

    From ``kind`` to ``observer`` it is all that a second program needs beside ``plant``, defined
    in docs/feedback-loop.md. Where the motor follows its setpoint there is no loop: gains, margins
    and stiffness are None, what is told of them is empty, and ``closed_loop`` still moves the axis.
    """

    kind: Annotated[str, one_of(*KINDS)]
    jerk: Jerk
    position_loop: Annotated[str, one_of(*(place.value for place in PositionLoop))]
    features: list[FeatureEntry]
    Kv: float | None
    Kp: float | None
    Tn: float | None
    reference_model_time: float
    reference_delay: float
    reference_age: float  # of the setpoint from which the wanted state is taken
    velocity_age: float  # of the one from which the wanted velocity is taken
    state_feedback: dict[str, float]
    feedforward: FeedforwardEntry
    position_cycle: Positive
    velocity_cycle: Positive
    force_lag: float
    motion_force: Positive  # bound of F_set
    force_filters: list[ForceFilter]
    encoder_resolution: float  # 0: not stated; then encoder_noise is None
    encoder_noise: EncoderNoiseEntry | None
    sensors: list[str]
    observer: ObserverEntry
    closed_loop: ClosedLoop
    poles: Matrix  # real and imaginary part each
    gain_margin_db: float | None  # the smaller of the two
    gain_margin_up_db: float | None  # by how much the gain may rise; None: by any amount
    gain_margin_down_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float | None
    bandwidth_hz: float | None
    dynamic_stiffness: float | None
    weakest_frequency_hz: float | None
    mode_damping: dict[str, float]
    candidates: list[CandidateEntry]  # soonest first
    reasons: list[Words]  # why one of them is used
    variants: list[VariantEntry]
    worst_corner: Margins | None
    worst_mode_damping: Annotated[dict[str, float], named(_damped)]
    corners: list[LoopCornerEntry]
    cross_check: CrossCheckEntry | None
    delays: list[DelayEntry]
    # The tool's displacement per newton after a step of force, by loop.
    disturbance: Annotated[Series, one_of(*LOOPS)]
    jerk_feedforward: list[JerkFeedforwardEntry]
    bode: Annotated[Series, named(_bode)]
    remarks: list[Words]  # which rule chose what
    warnings: list[Words]  # what is poor about the loop; part of the record's warnings, too
