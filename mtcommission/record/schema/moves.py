"""The simulated moves of a record, and the verdict on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from mtcommission.record.rules import filled, named
from mtcommission.record.schema.values import (
    ByMode,
    BySignal,
    Move,
    Series,
    SetpointFilterEntry,
    Words,
    signals_of,
)

REFERENCES = ("x_ref_delayed", "v_ref", "a_ref", "j_ref", "deviation", "F_set")
"""Signals of a simulated move beside those of the plant."""


def moved_signals(record: Any) -> list[str]:
    """Return the names of all signals of a simulated move."""
    return [*REFERENCES, *signals_of(record)]


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
    state: str = ""  # as the profile names it
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    mode_amplitudes: ByMode
    peaks: BySignal
    max_force: float
    rms_force: float
    saturated: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveEntry:
    """One move with the recommended limits: nominal response, corners, motion for the plots."""

    move: Move
    setpoint: SetpointEntry
    response: ResponseEntry
    corners: Annotated[list[ResponseEntry], filled]
    series: Annotated[Series, named(moved_signals)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against what was found."""

    name: str
    value: float | None  # None: not settled
    limit: float
    reserve: float  # share of the limit that a recommendation may use [-]
    unit: str
    met: bool
    where: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentPart:
    """The verdict."""

    met: bool
    checks: list[Check]
    obstacle: str  # the requirement that stands in the way; "": none


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationPart:
    """What ``simulate`` prints: the first move's setpoint and response, and all moves."""

    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    moves: list[MoveEntry]
    warnings: list[Words]  # what is poor about the loop
    assessment: AssessmentPart
