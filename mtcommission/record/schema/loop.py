"""The feedback loop of a record."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.messages.message import Message
from mtcommission.record.schema.values import ForceFilterEntry, Series, Words


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """The linear nominal loop from [x_ref, v_ref, a_ref, j_ref] to the outputs."""

    A: list[list[float]]
    B: list[list[float]]
    C: list[list[float]]
    D: list[list[float]]
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
    A: list[list[float]]
    B: list[float]
    C: list[list[float]]
    L: list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Margins:
    """How good a loop is; ``dynamic_stiffness`` in N/m or N m/rad."""

    gain_margin_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float
    bandwidth_hz: float | None
    dynamic_stiffness: float


@dataclass(frozen=True, slots=True, kw_only=True)
class VariantEntry(Margins):
    """The loop without or with state feedback, each with its own best limits."""

    name: Message
    used: bool
    mode_damping: dict[str, float]
    weakest_frequency_hz: float
    settling_time: float | None
    residual_deviation: float | None
    max_force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateEntry(Margins):
    """A loop that was tried with the limits that suit it best; margins and stiffness worst case.

    ``classic``: by the classic rule; ``used``: everything else in the record is about this one.
    """

    Kv: float
    Kp: float
    Tn: float
    state_feedback: bool
    settling_time: float | None
    meets_requirements: bool
    classic: bool
    used: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopCornerEntry(Margins):
    """How good the loop is in one corner of payload and spread, the nominal machine first.

    ``dynamic_stiffness`` is the least disturbance force per tool displacement over all
    frequencies [N/m, N m/rad]; ``mode_damping`` the damping ratio of each mode in the closed
    loop [-].
    """

    payload: float
    frequency_factor: float
    damping_factor: float
    mode_damping: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class DelayEntry:
    """What delays one path of the loop, all in seconds.

    ``setpoint_age`` is how old the setpoint is that is taken, ``dead_time`` whole cycles until it
    acts, ``hold`` the mean age of a held value, ``lag`` first-order lags (drive, filters);
    ``total`` their sum.
    """

    path: Message
    setpoint_age: float
    dead_time: float
    hold: float
    lag: float
    total: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JerkFeedforwardEntry:
    """The recommended limits with some weight of the jerk feed-forward, worst case.

    ``max_force`` is the largest |F_set| that the loop asks for, whatever the drive can give.
    """

    weight: float
    used: bool
    reference_delay: float
    max_force: float
    settling_time: float | None
    residual_deviation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class EncoderNoiseEntry:
    """What the steps of the encoder do, worst corner, either way: tool [m], set force [N]."""

    tool: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureEntry:
    """Whether the kind of control has something, and where that was read.

    ``parameters`` are its names in the control; not ``verified``: printed with "(?)".
    """

    name: str
    has: bool
    parameters: str
    source: str
    verified: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossCheckEntry:
    """What python-control says of the nominal loop, put together from the same blocks.

    ``pole_difference`` is the largest distance of a pole in the z plane [-].
    """

    pole_difference: float
    gain_margin_db: float | None
    phase_margin_deg: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopPart:
    """The controller and how good its loop is; margins with the loop cut at F_set.

    From ``kind`` to ``observer`` it is all that a second program needs beside ``plant``, defined
    in docs/feedback-loop.md. ``kind`` names the control, ``jerk`` how it limits the jerk
    (``limit``, ``time``, ``none``), ``position_loop`` where its position loop closes
    (``control``, ``interpolated``, ``drive``), ``features`` what it has. ``reference_age`` and
    ``velocity_age`` say how old the setpoint is from which wanted state and velocity are taken
    [s]. ``motion_force`` is the bound of F_set [N]; ``encoder_resolution`` 0: not stated; then
    ``encoder_noise`` is null.

    ``gain_margin_up_db`` and ``gain_margin_down_db`` say by how much the gain may rise and fall
    (null: by any amount), ``gain_margin_db`` is the smaller one. ``worst_corner`` and
    ``worst_mode_damping`` are the least favourable values over ``corners``. ``disturbance`` is
    the tool's displacement per newton (m/N, rad/(N m)) after a step of force on the line of the
    drive, by the name of the loop. ``candidates`` are the loops that were tried, soonest first,
    and ``reasons`` say why one of them is used. ``remarks`` say which rule chose what;
    ``warnings`` say what is poor about the loop, and are part of the record's warnings, too.

    ``cross_check`` holds margins and poles against python-control's.

    Where the motor follows its setpoint there is no loop: gains, margins and stiffness are null,
    what is told of them is empty, and ``closed_loop`` still moves the axis.
    """

    kind: str
    jerk: str
    position_loop: str
    features: list[FeatureEntry]
    Kv: float | None
    Kp: float | None
    Tn: float | None
    reference_model_time: float
    reference_delay: float
    reference_age: float
    velocity_age: float
    state_feedback: dict[str, float]
    feedforward: FeedforwardEntry
    position_cycle: float
    velocity_cycle: float
    force_lag: float
    motion_force: float
    force_filters: list[ForceFilterEntry]
    encoder_resolution: float
    encoder_noise: EncoderNoiseEntry | None
    sensors: list[str]
    observer: ObserverEntry
    closed_loop: ClosedLoop
    poles: list[list[float]]
    gain_margin_db: float | None
    gain_margin_up_db: float | None
    gain_margin_down_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float | None
    bandwidth_hz: float | None
    dynamic_stiffness: float | None
    weakest_frequency_hz: float | None
    mode_damping: dict[str, float]
    candidates: list[CandidateEntry]
    reasons: list[Words]
    variants: list[VariantEntry]
    worst_corner: Margins | None
    worst_mode_damping: dict[str, float]
    corners: list[LoopCornerEntry]
    cross_check: CrossCheckEntry | None
    delays: list[DelayEntry]
    disturbance: Series
    jerk_feedforward: list[JerkFeedforwardEntry]
    bode: Series
    remarks: list[Words]
    warnings: list[Words]
