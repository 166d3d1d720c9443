"""Recommended limits in every corner, by a program that shares nothing with the package.

    python -m benchmarks.second_program --count 40

Every shipped profile, then as many random machines; names what the second program refutes.
"""

from __future__ import annotations

import argparse

from benchmarks.population import random_machine
from mtcommission.errors import ComputationError
from mtcommission.profile.read import read_profile
from tests.test_second_program import PROFILES, broken_requirements


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=40)
    count = parser.parse_args().count
    machines = [(path.stem, read_profile(path)) for path in PROFILES]
    machines += [(f"random {seed}", random_machine(seed)) for seed in range(count)]
    promised = refuted = 0
    for name, machine in machines:
        try:
            broken = broken_requirements(machine)
        except ComputationError as error:
            print(f"{name}: {error.outcome.name}")
            continue
        promised += broken is not None
        refuted += bool(broken)
        print(f"{name}: {'no promise' if broken is None else broken or 'kept'}", flush=True)
    print(f"{promised} promises, {refuted} refuted")


if __name__ == "__main__":
    main()
