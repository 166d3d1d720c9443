"""A better machine must never get a slower recommendation: less lag, stiffer, more damping, ...

    python -m benchmarks.better_machine --machines 20 [--first 0]

Random machines over all kinds of control, each made better in one way at a time; prints by how
much the recommended moves settle later, and how many do by more than 1 %.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from math import sqrt

from benchmarks.every_size import draw_profile
from mtcommission.base.errors import ComputationError
from mtcommission.commission.recommend import recommend
from mtcommission.machine.machine import Machine
from mtcommission.machine.profile.read import parse_profile

LATER = 0.01
"""By which a better machine may settle later [-]: limits are typed with three digits."""


def improved(machine: Machine) -> Iterator[tuple[str, Machine]]:
    """Yield the machine, better in one way, with a name for it."""
    drive, control, mechanics = machine.drive, machine.control, machine.mechanics
    if not drive.follows:
        yield "less lag", replace(machine, drive=replace(drive, force_lag=0.8 * drive.force_lag))
    unchanged = {"payload": 0.0, "payload_radius": 0.0}
    stiffer = mechanics.vary(**unchanged, frequency=sqrt(1.1), damping=1.0)
    yield "stiffer", replace(machine, mechanics=stiffer)
    damped = mechanics.vary(**unchanged, frequency=1.0, damping=1.2)
    yield "more damping", replace(machine, mechanics=damped)
    yield "more force", replace(machine, drive=replace(drive, max_force=1.1 * drive.max_force))
    if control.position_cycle >= 2.0 * control.velocity_cycle:
        finer = replace(control, position_cycle=0.5 * control.position_cycle)
        yield "finer cycle", replace(machine, control=finer)


def later(machine: Machine) -> Iterator[tuple[str, float]]:
    """Yield by how much each better machine settles later [-]; nothing where nothing is met."""
    before = recommend(machine).choice
    if not before.meets_requirements:
        return
    for name, better in improved(machine):
        after = recommend(better).choice
        yield name, after.candidate.settling_time / before.candidate.settling_time - 1.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    tried, slower = 0, 0
    for seed in range(options.first, options.first + options.machines):
        machine = parse_profile(draw_profile(seed), where=f"r{seed}.toml")
        try:
            found = list(later(machine))
        except ComputationError as error:
            print(f"{machine.name}: {error.outcome.name}", flush=True)
            continue
        tried += len(found)
        slower += sum(share > LATER for _, share in found)
        shown = ", ".join(f"{name} {share:+.2%}" for name, share in found)
        print(f"{machine.name} ({machine.control.kind.key}): {shown}", flush=True)
    print(f"{tried} better machines, {slower} settle more than {LATER:.0%} later")


if __name__ == "__main__":
    main()
