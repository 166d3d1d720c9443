"""The fastest force after which every machine of the spread keeps the band.

Exact rest of the nominal machine is not what a machine off by some per cent comes to. But the
free motion of any finite number of machines can be asked to keep the band at once, by the same
linear program; which of them matter is found by exchange.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.moves import Move
from mtcommission.messages.message import Message
from mtcommission.optimal.band.force import BandForce, as_force
from mtcommission.optimal.band.program import CellForce, Question
from mtcommission.optimal.band.search import divide_switches, find_time
from mtcommission.optimal.band.settings import BandSettings
from mtcommission.optimal.band.tail import Tail, build_tail, find_tail_peaks
from mtcommission.plant.plant import Plant


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobustForce:
    """The fastest force found after which every machine looked at keeps the band."""

    force: BandForce  # What it does
    machines: int  # How many machines were looked at
    # Largest distance of the tool from the reference after its end, over those machines [m].
    peak: float


def find_robust_force(
    plants: Sequence[Plant],
    move: Move,
    *,
    first: Sequence[int],
    force_limit: float,
    band: float,
    guess: float,
    settings: BandSettings,
) -> RobustForce:
    """Return the fastest force after which all of some machines keep the band for ever.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if a program or an exchange does not end.
    """
    tails = [build_tail(plant) for plant in plants]
    question = Question(
        plant=plants[0],
        tails=tuple(tails[i] for i in first),
        move=move,
        force_limit=force_limit,
        band=band,
        margin=settings.robust_margin,
        velocity_margin=settings.velocity_margin,
        settings=settings,
    )
    shares = np.linspace(0.0, 1.0, settings.cells + 1)
    coarse, _ = _for_all(tails, question, find_time(question, shares, guess=guess))
    shares = divide_switches(coarse.cells, parts=settings.parts)
    fine = find_time(coarse.question, shares, guess=coarse.cells.t_f, known=coarse.cells)
    found, peak = _for_all(tails, coarse.question, fine)
    return RobustForce(force=as_force(found.question, found.cells), machines=len(tails), peak=peak)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Answer:
    """A question and the force that answers it."""

    question: Question
    cells: CellForce


def _for_all(tails: Sequence[Tail], question: Question, cells: CellForce) -> tuple[_Answer, float]:
    """Return the force on the same shares of its time that all machines keep the band after.

    Machines that leave the band farther than their neighbours join the question.
    """
    for _ in range(question.settings.exchanges):
        peaks = np.array([_peak(tail, cells, question) for tail in tails])
        beyond = np.concatenate(([0.0], peaks, [0.0]))
        is_worst = (peaks >= beyond[:-2]) & (peaks > beyond[2:]) & (peaks > question.band)
        if not is_worst.any():
            return _Answer(question=question, cells=cells), float(peaks.max())
        more = tuple(tails[i] for i in np.flatnonzero(is_worst).tolist())
        question = replace(question, tails=question.tails + more)
        cells = find_time(question, cells.edges / cells.t_f, guess=cells.t_f, known=cells)
    raise ComputationError(Outcome.NO_CONVERGENCE, Message("band-exchange-goes-on"))


def _peak(tail: Tail, cells: CellForce, question: Question) -> float:
    """The farthest that the tool of one machine gets, or the middle of the margin if less."""
    moments = tail.moments(cells.edges) @ cells.force
    return find_tail_peaks(
        tail,
        moments,
        offset=cells.offset,
        level=0.5 * (question.room + question.band),
        settings=question.settings,
    ).peak
