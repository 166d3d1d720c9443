"""If these fail, the cross-check by direct transcription checks nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.control import DampingOptimum, TimeOptimum
from mtcommission.optimal.damping import solve_damping_optimal
from mtcommission.optimal.transcription import transcribe_damping_optimal, transcribe_time_optimal
from mtcommission.optimal.transcription_settings import Scheme, TranscriptionSettings
from tests.machines import paper_machine
from tests.references_optimal import PAPER_WEIGHTS

PLANT, STEP = build_plant(paper_machine()), VelocityStep(velocity_step=0.1)
SLOW_TOWER = (SignalValue(name="v_phi", value=0.005),)


def shortest(
    intervals: int, scheme: Scheme = Scheme.GAUSS, *, bounds: tuple[SignalValue, ...] = SLOW_TOWER
) -> TimeOptimum:
    how = TranscriptionSettings(scheme=scheme, intervals=intervals)
    return transcribe_time_optimal(PLANT, STEP, force_limit=2e3, bounds=bounds, settings=how)


def smoothest(intervals: int, scheme: Scheme = Scheme.GAUSS, **changes: Any) -> DampingOptimum:
    how = {"t_f": 0.0522, "bounds": ()} | changes
    return transcribe_damping_optimal(
        PLANT,
        STEP,
        force_limit=2e3,
        weights=PAPER_WEIGHTS,
        settings=TranscriptionSettings(scheme=scheme, intervals=intervals),
        **how,
    )


@pytest.mark.parametrize("solve", [shortest, smoothest])
@pytest.mark.parametrize(
    ("scheme", "order", "grids", "error"),
    [
        (Scheme.EULER, 1.0, (400, 800), 0.1),  # of the state at t_f, see the module's docstring
        (Scheme.TRAPEZOIDAL, 2.0, (200, 400), 2e-3),
        (Scheme.GAUSS, 4.0, (50, 100), 2e-5),
    ],
)
def test_terminal_error_shrinks_with_the_order_of_the_scheme(solve, scheme, order, grids, error):
    found = [solve(N, scheme) for N in grids]
    n = PLANT.order
    coarse, fine = (float(np.abs(each.terminal_error / each.peaks[:n]).max()) for each in found)
    assert fine < error
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("bounds", [(), SLOW_TOWER])
def test_times_converge_to_the_exact_ones_at_second_order(bounds):
    # over 50 ... 400 intervals: where a switch lies inside its interval is another on each grid
    exact = solve_bounded_time_optimal(PLANT, STEP, force_limit=2e3, bounds=bounds).t_f
    grids = np.array([50, 100, 200, 400])
    found = [shortest(int(N), bounds=bounds) for N in grids]
    errors = [each.t_f / exact - 1.0 for each in found]
    slope, _ = np.polyfit(np.log(grids), np.log(errors), 1)
    assert -slope == pytest.approx(2.0, abs=0.4)
    assert abs(errors[-1]) < 1.2e-4
    assert np.isnan(found[0].certificate.t_f_lower_bound)  # a transcription claims no proof


def test_damping_optimum_agrees_with_the_exact_one():
    exact = solve_damping_optimal(PLANT, STEP, force_limit=2e3, t_f=0.0522, weights=PAPER_WEIGHTS)
    found = smoothest(1000)
    assert found.peaks == pytest.approx(exact.peaks, rel=2e-3)
    assert found.peaks[5] == pytest.approx(exact.peaks[5], rel=1e-4)
    fixed = [0, 2, 3, 4, 5, 6]
    assert found.certificate.adjoint_initial[fixed] == pytest.approx(
        exact.certificate.adjoint_initial[fixed], rel=1e-3
    )
    assert found.certificate.law_residual < 1e-4
    assert found.cost_terms == pytest.approx(exact.cost_terms, rel=1e-3)


def test_bound_that_no_time_can_meet():
    with pytest.raises(ComputationError) as caught:
        shortest(50, bounds=(SignalValue(name="v_s", value=0.05),))
    assert caught.value.outcome is Outcome.BOUND_CANNOT_HOLD
    assert "0.5 of the target is reached" in str(caught.value)


def test_bound_out_of_reach_by_the_given_time_is_named_with_a_remedy():
    # Without it an engineer only learns that IPOPT failed.
    with pytest.raises(ComputationError, match="time-optimal control under the same") as caught:
        smoothest(100, t_f=0.048, bounds=SLOW_TOWER)
    assert caught.value.outcome is Outcome.FINAL_TIME_TOO_SHORT


def test_nothing_is_printed(capfd):
    shortest(20)
    assert capfd.readouterr() == ("", "")
