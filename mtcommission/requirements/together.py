"""What a machine asks for, sorted by how many setpoints are looked at at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.motions import OUTPUTS, Signal
from mtcommission.machine.machine import Machine, Move
from mtcommission.plant.plant import Plant
from mtcommission.requirements.register import requirements_of
from mtcommission.requirements.requirement import Mean, Requirement, Settling, Swing

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
    settling = list[Requirement]()
    after = list[tuple[Requirement, Signal]]()
    during = dict[tuple[int | None, tuple[Move, ...]], Swings]()
    means = list[tuple[Requirement, Mean]]()
    for one in requirements_of(machine):
        way = one.by_poles(plant)
        if isinstance(way, Settling):
            settling.append(one)
        elif isinstance(way, Mean):
            means.append((one, way))
        elif way.is_after:
            after.append((one, way.signal))
        else:
            moves = tuple(one.judged(machine, move) for move in machine.moves)
            row, place = way.signal.row[None], (way.signal.less, moves)
            found = during.get(place)
            during[place] = (
                Swings(requirements=(one,), rows=row, less=way.signal.less, moves=moves)
                if found is None
                else replace(
                    found,
                    requirements=(*found.requirements, one),
                    rows=np.vstack([found.rows, row]),
                )
            )
    return Asked(
        settling=tuple(settling),
        after=tuple(after),
        during=tuple(during.values()),
        means=tuple(means),
    )


def bounded_states(machine: Machine, plant: Plant) -> Iterator[tuple[Requirement, Swing]]:
    """Yield what bounds the plant's states, not the tool's deviation or the set force."""
    for requirement in requirements_of(machine):
        swing = requirement.by_poles(plant)
        if isinstance(swing, Swing) and swing.signal.row[OUTPUTS:].any():
            yield requirement, swing
