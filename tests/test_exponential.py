"""The matrix exponential of a boundary arc against steps in extended precision."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.machine.plant.plant import build_plant
from mtcommission.optimal.control import Bound, balanced_expm
from mtcommission.optimal.problem import bounded_problem
from tests.machines import paper_machine

Array = NDArray[np.float64]

STEPS, TERMS = 4000, 14


def _long_exponential(matrix: Array) -> Array:
    """Taylor steps with 64 bits of mantissa, multiplied one by one: no squaring, no scaling."""
    step = matrix.astype(np.longdouble) / STEPS
    term: NDArray[np.longdouble] = np.eye(len(matrix), dtype=np.longdouble)
    short: NDArray[np.longdouble] = term.copy()
    for k in range(1, TERMS):
        term = np.asarray(term @ step / k, dtype=np.longdouble)
        short = short + term
    power: NDArray[np.longdouble] = short
    for _ in range(STEPS - 1):
        power = short @ power
    return power.astype(np.float64)


def test_a_long_boundary_arc_keeps_its_digits() -> None:
    """Tight bounds were lost to this: 1e-9 of a state is what a finished control may miss."""
    machine = paper_machine()
    bounds = (Bound(name="v_phi", value=7e-4),)
    problem = bounded_problem(
        build_plant(machine), machine.moves[0], force_limit=2e3, bounds=bounds, horizon=0.05
    )
    flow, scale = problem.limits[0].boundary_flow, problem.state_scale
    exact = _long_exponential(flow.matrix * 0.05)

    def error(found: Array) -> float:
        return float((np.abs(found - exact) * scale / scale[:, np.newaxis]).max())

    plain, balanced = expm(flow.matrix * 0.05), balanced_expm(flow.matrix * 0.05)
    assert error(flow.over(0.05)) < 1e-11
    assert error(balanced) < 1e-10 < error(plain)
    # The bounded signal itself drifts in the states of the plant, not in those of the arc.
    row, rate = problem.limits[0].output_chain

    def drift(found: Array) -> float:
        return float(np.abs((row @ found - row - problem.rate * 0.05 * rate) * scale).max())

    assert drift(flow.over(0.05)) < 0.05 * drift(balanced)
