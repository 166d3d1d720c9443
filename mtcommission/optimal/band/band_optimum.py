"""The fastest control to a state from which the free motion keeps the tool within the band.

Exact rest is more than a band asks for: modes may ring, as long as the tool stays within. The
states from which it does so for ever are a convex set, so a linear program finds the control and
its multipliers prove a bound, as for exact rest. docs/optimal-control.md, section 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mtcommission.machine.moves import Move
from mtcommission.optimal.band.force import BandForce, as_force
from mtcommission.optimal.band.program import Question
from mtcommission.optimal.band.proof import prove_time
from mtcommission.optimal.band.search import divide_switches, find_time
from mtcommission.optimal.band.settings import BandSettings
from mtcommission.optimal.band.tail import build_tail
from mtcommission.plant.plant import Plant


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandOptimum:
    """The fastest control to a state from which the tool stays within the band by itself."""

    force: BandForce  # What it does
    lower_bound: float  # No admissible control is faster [s]

    @property
    def gap(self) -> float:
        """Relative distance of its time from the proved bound."""
        return (self.force.t_f - self.lower_bound) / self.force.t_f


def find_band_optimum(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    band: float,
    at_rest: float,
    settings: BandSettings,
) -> BandOptimum:
    """Return the fastest control to a state from which the free motion keeps the band for ever.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if a program or the exchange of its rows does not end.
    """
    question = Question(
        plant=plant,
        tails=(build_tail(plant),),
        move=move,
        force_limit=force_limit,
        band=band,
        margin=settings.margin,
        velocity_margin=settings.velocity_margin,
        settings=settings,
    )
    shares = np.linspace(0.0, 1.0, settings.cells + 1)
    cells = find_time(question, shares, guess=at_rest)
    lower = prove_time(question, cells)
    for _ in range(settings.refinements):
        if cells.t_f - lower <= settings.gap * cells.t_f:
            break
        shares = divide_switches(cells, parts=settings.parts)
        cells = find_time(question, shares, guess=cells.t_f, known=cells)
        lower = max(lower, prove_time(question, cells))
    return BandOptimum(force=as_force(question, cells), lower_bound=min(lower, cells.t_f))
