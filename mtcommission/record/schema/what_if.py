"""All that a page needs to run a record's loop again with other values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from mtcommission.machine.control import ForceFilter
from mtcommission.record.rules import above_zero, filled, long, of_one_size, one_of
from mtcommission.record.schema.values import Jerk, Matrix, Positive, SetpointFilterEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class SampledEntry:
    """The nominal loop at the velocity cycle, for whoever closes it on other machines.

    X over ``states``: the plant's first, F_set at ``pending``, what the position cycle hands down
    from ``held`` on. X⁺ = ``cycle`` X in a velocity cycle; after ``cycles`` of these the states
    from ``held`` on become ``by_state`` X, X from before them, plus ``by_setpoint`` times (x_ref,
    v_ref, a_ref, j_ref) at that time, then one position cycle earlier, and so on. Where the motor
    follows, what is handed down are its position, velocity, acceleration and jerk.
    """

    follows: bool
    velocity_cycle: Positive
    cycles: Annotated[int, above_zero]
    reference_delay: float
    states: list[str]
    pending: int
    held: int
    cycle: Matrix
    by_state: Matrix
    by_setpoint: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedModeEntry:
    """Where a mode stands in the plant; payload p divides its terms by 1 + p ``payload_share``."""

    deflection: int
    rate: int
    payload_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalEntry:
    """A row over the plant's states whose largest magnitude counts, from t_e + τ on or always."""

    name: str
    unit: str
    row: list[float]
    less: int | None  # less that derivative of the delayed setpoint, 0: position; None: as it is
    is_after: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedPlantEntry:
    """The nominal plant, and what payload, frequency and damping change in it.

    The force moves the state ``velocity`` by 1/(``moving_mass`` + payload); where the motor
    follows, the last state is its acceleration and B the jerk's. ``signals``: the motor's force,
    then each that a check of the same name bounds.
    """

    A: Matrix
    B: list[float]
    tcp: list[float]
    signals: Annotated[list[SignalEntry], filled]
    position: int
    velocity: int
    moving_mass: float
    modes: list[VariedModeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class NoisyCornerEntry:
    """A corner, and what the steps of the encoder add there either way."""

    payload: float
    frequency_factor: float
    damping_factor: float
    state: str = ""  # as the profile names it
    tool_noise: float
    force_noise: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StateEntry:
    """The plant in a state in which it was measured, and the loop around it."""

    name: str
    plant: VariedPlantEntry
    loop: SampledEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitEntry:
    """A requirement; ``of_listed``: smaller moves than the listed ones need not keep it."""

    name: str
    unit: str
    limit: float
    of_listed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedsEntry:
    """What moves are judged by; None: not stated. ``every_size``: smaller moves count, too."""

    checks: list[LimitEntry]
    tcp_deviation: Positive
    contour_feed: float | None
    motion_force: Positive
    static_load: float
    every_size: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownLimitsEntry:
    """Limits to begin with; ``loop`` where it is another one, ``states``: in each state."""

    name: Annotated[str, one_of("today", "recommended")]
    acceleration: Positive
    jerk: Positive
    setpoint_filter: SetpointFilterEntry | None
    loop: SampledEntry | None
    states: list[StateEntry] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class WhatIfPart:
    """All that it takes to run other limits, moves and machines through the loop again."""

    jerk: Jerk
    loop: SampledEntry
    plant: VariedPlantEntry
    corners: Annotated[list[NoisyCornerEntry], filled]
    moves: Annotated[list[dict[str, float]], of_one_size, long("/moves")]
    requirements: NeedsEntry
    limits: Annotated[list[KnownLimitsEntry], filled]
    force_filters: list[ForceFilter]
    states: list[StateEntry] = field(default_factory=list)
    averages: list[float] | None  # least and longest moving average; None: the control has none
