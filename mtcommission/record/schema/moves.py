"""The simulated moves of a record, and the verdict on them."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.schema.values import Series, SetpointFilterEntry, Words


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """One segment of Ruckig's profile."""

    duration: float
    jerk: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointEntry:
    """The setpoint of a move with the recommended limits."""

    duration: float
    setpoint_filter: SetpointFilterEntry | None
    segments: list[Segment]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseEntry:
    """A closed-loop response in one corner."""

    payload: float
    frequency_factor: float
    damping_factor: float
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    mode_amplitudes: dict[str, float]
    peaks: dict[str, float]
    max_force: float
    rms_force: float
    saturated: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveEntry:
    """One move with the recommended limits: nominal response, corners, motion for the plots."""

    move: dict[str, float]
    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    series: Series


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against what was found; ``value`` null = not settled.

    ``reserve`` is the share of the limit that a recommendation may use [-]; 1: all of it.
    """

    name: str
    value: float | None
    limit: float
    reserve: float
    unit: str
    met: bool
    where: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentPart:
    """The verdict."""

    met: bool
    checks: list[Check]
    obstacle: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationPart:
    """What ``simulate`` prints: the first move's setpoint and response, and all moves.

    ``warnings`` say what is poor about the loop.
    """

    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    moves: list[MoveEntry]
    warnings: list[Words]
    assessment: AssessmentPart
