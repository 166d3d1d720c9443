"""All that a page needs to run a record's loop again with other values."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.schema.values import ForceFilterEntry, SetpointFilterEntry


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
    velocity_cycle: float
    cycles: int
    reference_delay: float
    states: list[str]
    pending: int
    held: int
    cycle: list[list[float]]
    by_state: list[list[float]]
    by_setpoint: list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedModeEntry:
    """Where a mode stands in the plant; payload p divides its terms by 1 + p ``payload_share``."""

    deflection: int
    rate: int
    payload_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalEntry:
    """A row over the plant's states whose largest magnitude counts, from t_e + τ on or always.

    Less that derivative of the delayed setpoint (0: position); null: as it is.
    """

    name: str
    unit: str
    row: list[float]
    less: int | None
    is_after: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedPlantEntry:
    """The nominal plant, and what payload, frequency and damping change in it.

    The force moves the state ``velocity`` by 1/(``moving_mass`` + payload); where the motor
    follows, the last state is its acceleration and B the jerk's. ``signals``: the motor's force,
    then each that a check of the same name bounds.
    """

    A: list[list[float]]
    B: list[float]
    tcp: list[float]
    signals: list[SignalEntry]
    position: int
    velocity: int
    moving_mass: float
    modes: list[VariedModeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class NoisyCornerEntry:
    """A corner, and what the steps of the encoder add there either way [m, N]."""

    payload: float
    frequency_factor: float
    damping_factor: float
    tool_noise: float
    force_noise: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitEntry:
    """A requirement; ``of_listed``: smaller moves than the listed ones need not keep it."""

    name: str
    unit: str
    limit: float
    of_listed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedsEntry:
    """What moves are judged by; null: not stated. ``every_size``: smaller moves count, too."""

    checks: list[LimitEntry]
    tcp_deviation: float
    contour_feed: float | None
    motion_force: float
    static_load: float
    every_size: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownLimitsEntry:
    """Limits to begin with: ``today`` or ``recommended``; ``loop`` where it is another one."""

    name: str
    acceleration: float
    jerk: float
    setpoint_filter: SetpointFilterEntry | None
    loop: SampledEntry | None


@dataclass(frozen=True, slots=True, kw_only=True)
class WhatIfPart:
    """All that it takes to run other limits, moves and machines through the loop again.

    ``jerk``: how the control limits the jerk (``limit``, ``time``, ``none``); ``averages``: from
    which to which length it can set a moving average [s]; null: it has none.
    """

    jerk: str
    loop: SampledEntry
    plant: VariedPlantEntry
    corners: list[NoisyCornerEntry]
    moves: list[dict[str, float]]
    requirements: NeedsEntry
    limits: list[KnownLimitsEntry]
    force_filters: list[ForceFilterEntry]
    averages: list[float] | None
