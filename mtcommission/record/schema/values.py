"""Values that several parts of a record hold; a number is in SI unless its key says otherwise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from mtcommission.control_kinds.kind import FIR, MOVING_AVERAGE, SHAPERS, TWO_AVERAGES
from mtcommission.messages.message import Message
from mtcommission.record.rules import above_zero, at_least, long, named, of_one_size, one_of, rising

Words: TypeAlias = Message | str
"""What the catalogue says, or the user's own words."""

Matrix: TypeAlias = list[list[float]]
Positive = Annotated[float, above_zero]
PositiveOrNone = Annotated[float | None, above_zero]
NotNegative = Annotated[float | None, at_least(0.0)]
Positives = Annotated[list[float], above_zero]
Move = Annotated[dict[str, float], of_one_size]
"""A move by the profile's keys."""

Jerk = Annotated[str, one_of("limit", "time", "none")]
"""How a control limits the jerk."""


def mode_names(record: Any) -> list[str]:
    """Return the names of the flexible modes."""
    return [mode.name for mode in record.plant.modes]


def signals_of(record: Any) -> list[str]:
    """Return the names of states and outputs."""
    return [*record.plant.states, *record.plant.outputs]


ByMode = Annotated[dict[str, float], named(mode_names)]
BySignal = Annotated[dict[str, float], named(signals_of)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """A sampled motion for the plots; ``signals`` by name (F_set, then every state and output)."""

    t: Annotated[list[float], rising]
    signals: Annotated[dict[str, list[float]], long("", "t")]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilterEntry:
    """A filter of the control in the setpoint: a sum of copies, behind averages."""

    kind: Annotated[str, one_of(MOVING_AVERAGE, TWO_AVERAGES, FIR, *SHAPERS)]
    time: float  # of the first average
    second_time: float
    frequency_hz: float  # of a shaper's mode
    damping_ratio: float
    delays: list[float]  # of each copy
    shares: list[float]
    duration: float  # by how much it lengthens every setpoint
