"""Recommended limits in every corner and size, by a program that shares nothing with the package.

    python -m benchmarks.second_program --count 40 [--first 0]

Every shipped profile, then random machines over all kinds of control with a feedback loop; names
what the second program refutes.
"""

from __future__ import annotations

import argparse

import numpy as np

from benchmarks.every_size import draw_profile
from mtcommission.base.errors import ComputationError
from mtcommission.machine.profile.read import parse_profile, read_profile
from tests.test_second_program import PROFILES, broken_requirements

SHARES = (1.0, *np.geomspace(0.01, 0.8, 9).tolist())
"""Sizes of a move that are looked at, by the listed one [-]."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="seed of the first of them")
    options = parser.parse_args()
    machines = [(path.stem, read_profile(path)) for path in PROFILES]
    for seed in range(options.first, options.first + options.count):
        name = f"random {seed}"
        machines.append((name, parse_profile(draw_profile(seed), where=name)))
    promised = refuted = 0
    for name, machine in machines:
        if machine.drive.follows:  # no loop: nothing for the second program to step through
            continue
        try:
            broken = broken_requirements(machine, SHARES)
        except ComputationError as error:
            print(f"{name}: {error.outcome.name}")
            continue
        promised += broken is not None
        refuted += bool(broken)
        print(f"{name}: {'no promise' if broken is None else broken or 'kept'}", flush=True)
    print(f"{promised} promises, {refuted} refuted")


if __name__ == "__main__":
    main()
