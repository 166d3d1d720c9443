"""Linear programs: what the solver says must not reach standard output, where JSON goes."""

from __future__ import annotations

import subprocess
import sys

SOLVE = """
import numpy as np
from mtcommission.optimal.bounded.program.linear_program import Program, solve_program
from mtcommission.optimal.bounded.settings import ProgramSettings

one, none = np.ones((1, 1)), np.empty(0)
program = Program(cost=-one[0], rows=one, rooms=np.array([2.0]), equal=np.empty((0, 1)),
    right=none, lower=np.zeros(1), upper=np.full(1, np.inf))
assert solve_program(program, ProgramSettings(), steps=10).unknowns[0] == 2.0
"""


def test_programs_are_solved_without_a_word() -> None:
    """HiGHS 1.16 prints a banner for its first solver: `limits --json -` was no JSON any more."""
    done = subprocess.run([sys.executable, "-c", SOLVE], capture_output=True, check=True)
    assert (done.stdout, done.stderr) == (b"", b"")
