"""Linear programs: digits, known bases, and nothing on standard output, where JSON goes."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose
from scipy.optimize import linprog

from mtcommission.optimal.linear_program import Program, solve_program

SOLVE = """
import numpy as np
from mtcommission.optimal.linear_program import Program, solve_program

one, none = np.ones((1, 1)), np.empty(0)
program = Program(cost=-one[0], rows=one, rooms=np.array([2.0]), equal=np.empty((0, 1)),
    right=none, lower=np.zeros(1), upper=np.full(1, np.inf))
assert solve_program(program, steps=10).unknowns[0] == 2.0
"""


def test_programs_are_solved_without_a_word():
    """HiGHS 1.16 prints a banner for its first solver: `limits --json -` was no JSON any more."""
    done = subprocess.run([sys.executable, "-c", SOLVE], capture_output=True, check=True)
    assert (done.stdout, done.stderr) == (b"", b"")


def test_program_from_a_known_basis_is_that_from_none():
    # Otherwise an exchange of points would end somewhere else than a program with all of them.
    generator = np.random.default_rng(11)
    rows, cost = generator.standard_normal((30, 12)), generator.standard_normal(12)
    few = Program(
        cost=cost,
        rows=rows[:20],
        rooms=np.ones(20),
        equal=np.ones((1, 12)),
        right=np.zeros(1),
        lower=-np.ones(12),
        upper=np.ones(12),
    )
    every = replace(few, rows=rows, rooms=np.ones(30))
    first = solve_program(few, steps=500)
    assert first is not None
    warm = solve_program(every, steps=500, start=first.basis)
    cold = linprog(cost, rows, np.ones(30), np.ones((1, 12)), np.zeros(1), bounds=(-1.0, 1.0))
    assert warm is not None
    assert_allclose(warm.unknowns, cold.x, atol=1e-9)
    assert_allclose(warm.rows, cold.ineqlin.marginals, atol=1e-9)
    assert_allclose(warm.bounds, cold.lower.marginals + cold.upper.marginals, atol=1e-9)
