"""The survey's figures in the docs would be worth nothing if it counted poor loops as tuned."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.loop_survey import Tally, examine, from_population, survey
from mtcommission.loop.tuning.tuned import close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop


def test_every_machine_ends_somewhere_with_the_margins_of_the_analysis() -> None:
    found = survey("some", from_population, 4)
    assert sum(found.ends.values()) == 4
    phases = [
        min(analysis.phase_margin_deg for analysis in tune_loop(from_population(seed)).analyses)
        for seed in range(4)
    ]
    assert found.phase_margin_deg == pytest.approx(phases, rel=1e-3)


def test_a_loop_without_the_margins_stops_the_survey() -> None:
    machine = from_population(3)
    controller = tune_loop(machine).controller
    hard = replace(controller, velocity_gain=2.0 * controller.velocity_gain)
    with pytest.raises(SystemExit, match="seed 3: radius"):
        examine(close_loop(corner_plants(machine), hard), Tally(name="hard"), where="seed 3")
