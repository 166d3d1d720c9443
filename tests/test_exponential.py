"""The matrix exponential of a boundary arc against steps in extended precision."""

import numpy as np
from scipy.linalg import expm

from mtcommission.optimal.bounded_problem import bounded_problem
from mtcommission.optimal.exponential import balanced_expm
from mtcommission.optimal.solution import Bound
from mtcommission.plant import build_plant
from tests.machines import paper_machine

STEPS, TERMS = 4000, 14


def _long_exponential(matrix):
    """Taylor steps with 64 bits of mantissa, multiplied one by one: no squaring, no scaling."""
    step = matrix.astype(np.longdouble) / STEPS
    term = np.eye(len(matrix), dtype=np.longdouble)
    short = term.copy()
    for k in range(1, TERMS):
        term = term @ step / k
        short = short + term
    out = np.eye(len(matrix), dtype=np.longdouble)
    for _ in range(STEPS):
        out = short @ out
    return out.astype(float)


def test_a_long_boundary_arc_keeps_its_digits():
    """Tight bounds were lost to this: 1e-9 of a state is what a finished control may miss."""
    machine = paper_machine()
    bounds = (Bound(name="v_phi", value=7e-4),)
    problem = bounded_problem(
        build_plant(machine), machine.moves[0], force_limit=2e3, bounds=bounds, horizon=0.05
    )
    flow, scale = problem.limits[0].boundary_flow * 0.05, problem.state_scale
    exact = _long_exponential(flow)

    def error(found):
        return (np.abs(found - exact) * scale / scale[:, np.newaxis]).max()

    assert error(balanced_expm(flow)) < 1e-10 < error(expm(flow))
