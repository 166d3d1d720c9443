"""The reference of a move, where no sequence of arcs is recognised: kept, proved, and said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.constrained_survey import largest_excess
from benchmarks.population import random_machine
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.limits.optima import find_optima
from mtcommission.machine.moves import Positioning
from mtcommission.machine.plant.plant import build_plant
from mtcommission.optimal.control import propagate


def test_reference_on_cells_says_how_far_from_the_optimum_it_can_be() -> None:
    """A reader must see that the reference is not the optimum itself; somebody else integrates."""
    machine = random_machine(125)
    plant, move = build_plant(machine), machine.moves[0]
    assert isinstance(move, Positioning)
    found = find_optima(replace(machine, moves=(move,)), plant, move)
    optimum, gap = found.time, found.time.certificate.relative_gap
    assert 1e-6 < gap < 1e-2
    assert "Nothing is faster than" in Catalogue().say(found.remarks[0])
    assert largest_excess(plant, optimum) < 1e-9
    error = np.abs(propagate(plant, optimum.arcs))
    error[plant.position] = abs(error[plant.position] - move.distance)
    assert np.all(error < 1e-6 * optimum.peaks[: plant.order])
