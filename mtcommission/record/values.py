"""Values that several parts of a record hold; a number is in SI unless its key says otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant
from mtcommission.record.shape import of

Array = NDArray[np.float64]

Words: TypeAlias = Message | str
"""What the catalogue says, or the user's own words."""

Matrix: TypeAlias = list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """A sampled motion for the plots; ``signals`` by name (F_set, then every state and output)."""

    t: list[float]
    signals: dict[str, list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilterEntry:
    """A filter of the control in the setpoint: a sum of copies, behind averages."""

    kind: str
    time: float  # of the first average
    second_time: float
    frequency_hz: float  # of a shaper's mode
    damping_ratio: float
    delays: list[float] = of("impulses.delays")  # of each copy
    shares: list[float] = of("impulses.shares")
    duration: float  # by how much it lengthens every setpoint


@dataclass(frozen=True, slots=True, kw_only=True)
class InCorner:
    """A machine of the corners: payload, and factors of all frequencies and damping ratios."""

    payload: float = of("corner.payload")
    frequency_factor: float = of("corner.frequency_factor")
    damping_factor: float = of("corner.damping_factor")
    state: str = of("corner.state", default="")  # as the profile names it


def describe_move(move: Move) -> dict[str, float]:
    """Return a move with the profile's keys; limits that were not set are left out."""
    if isinstance(move, VelocityStep):
        entry = {"velocity_step": move.velocity_step}
    else:
        entry = {"distance": move.distance}
        if isfinite(move.max_velocity):
            entry["max_velocity"] = move.max_velocity
    if move.dwell:
        entry["dwell"] = move.dwell
    return entry


def by_name(names: Sequence[str], values: Array) -> dict[str, float]:
    """Return values by the names of signals or states."""
    return dict(zip(names, values.tolist(), strict=True))


def by_mode(plant: Plant, values: ArrayLike) -> dict[str, float]:
    """Return values by the names of the plant's modes."""
    return by_name([mode.name for mode in plant.modes], np.asarray(values, dtype=np.float64))


def rounded(values: Array, digits: int) -> Array:
    """Return values for plots, short to write; of the same shape."""
    return np.array([float(f"{value:.{digits}g}") for value in values.flat]).reshape(values.shape)


def series_of(plant: Plant, t: Array, states: Array, extra: Mapping[str, Array]) -> Series:
    """Return signals by name, states and outputs, rounded to seven digits: for plots only.

    ``t``, ``states``: shapes (n_samples,) [s], (n_samples, n_states); ``extra``: further signals
    by name, each of shape (n_samples,).
    """
    columns = {
        **extra,
        **dict(zip(plant.states, states.T, strict=True)),
        **dict(zip(plant.outputs, (states @ plant.C.T).T, strict=True)),
    }
    signals = {name: rounded(column, 7).tolist() for name, column in columns.items()}
    return Series(t=rounded(t, 7).tolist(), signals=signals)
