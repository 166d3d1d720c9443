"""A control after which the tool stays within a band by itself, and the cells it was found on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mtcommission.machine.moves import Move
from mtcommission.optimal.band.program import CellForce, Question
from mtcommission.optimal.solution import Arc, Bang, Interior, constant_arc

FULL = 1.0 - 1e-7
"""Share of the force limit from which a cell counts as full."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandForce:
    """A set force that ends, and after which the tool stays within the band."""

    move: Move  # What it does
    # force_limit, band: What it keeps [N, m].
    force_limit: float
    band: float
    t_f: float  # When it becomes 0, for good [s]
    arcs: tuple[Arc, ...]  # In order, without gaps, from 0 to t_f
    # How far the reference lies beyond the place at which the tool comes to rest [m]; for a
    # velocity step beside its steady motion.
    offset: float


def as_force(question: Question, cells: CellForce) -> BandForce:
    """Return the force on cells as a control of its own."""
    return BandForce(
        move=question.move,
        force_limit=question.force_limit,
        band=question.band,
        t_f=cells.t_f,
        arcs=cell_arcs(question, cells),
        offset=cells.offset / cells.reach,
    )


def cell_arcs(question: Question, cells: CellForce) -> tuple[Arc, ...]:
    """Return the force on cells as arcs in the order of time, scaled to reach just the target."""
    full = FULL * question.force_limit
    force, times = cells.force[::-1] / cells.reach, cells.t_f - cells.edges[::-1]
    keep = np.flatnonzero(np.append(True, np.diff(force) != 0.0))
    ends = np.append(times[keep[1:]], cells.t_f)
    return tuple(
        constant_arc(
            start,
            end,
            control=Bang(1 if u > 0.0 else -1) if abs(u) >= full else Interior(),
            force=u,
        )
        for start, end, u in zip(
            times[keep].tolist(), ends.tolist(), force[keep].tolist(), strict=True
        )
    )
