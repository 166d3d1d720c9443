"""What a machine asks for, sorted by how many setpoints are looked at at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.requirements.register import requirements_of
from mtcommission.limits.requirements.requirement import Mean, Requirement, Settling, Swing
from mtcommission.loop.respond import OUTPUTS, Signal
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Swings:
    """Requirements on signals of the same moves, less the same derivative of the setpoint."""

    requirements: tuple[Requirement, ...]
    rows: Array  # over the outputs of a velocity cycle, (n_requirements, n_outputs)
    less: int | None  # see ``Signal``
    moves: tuple[Move, ...]  # each listed one, as it is judged


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Asked:
    """The requirements of a machine, each sort in the order of records."""

    settling: tuple[Requirement, ...]
    after: tuple[tuple[Requirement, Signal], ...]  # from t_e + τ on only
    during: tuple[Swings, ...]
    means: tuple[tuple[Requirement, Mean], ...]


def sort_requirements(machine: Machine, plant: Plant) -> Asked:
    """Return what a machine asks for."""
    ways = [(one, one.by_poles(plant)) for one in requirements_of(machine)]
    swings = [(one, way) for one, way in ways if isinstance(way, Swing)]
    during: dict[tuple[int | None, tuple[Move, ...]], dict[Requirement, Array]] = {}
    for one, way in swings:
        if not way.is_after:
            place = way.signal.less, tuple(one.judged(machine, move) for move in machine.moves)
            during.setdefault(place, {})[one] = way.signal.row
    return Asked(
        settling=tuple(one for one, way in ways if isinstance(way, Settling)),
        after=tuple((one, way.signal) for one, way in swings if way.is_after),
        during=tuple(
            Swings(
                requirements=tuple(own), rows=np.array(list(own.values())), less=less, moves=moves
            )
            for (less, moves), own in during.items()
        ),
        means=tuple((one, way) for one, way in ways if isinstance(way, Mean)),
    )


def bounded_states(machine: Machine, plant: Plant) -> Iterator[tuple[Requirement, Swing]]:
    """Yield what bounds the plant's states, not the tool's deviation or the set force."""
    for requirement in requirements_of(machine):
        swing = requirement.by_poles(plant)
        if isinstance(swing, Swing) and swing.signal.row[OUTPUTS:].any():
            yield requirement, swing
