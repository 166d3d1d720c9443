"""Random pairs of axes: circles, corners and lines by a program that shares nothing with ours.

    python -m benchmarks.group_pairs --count 50 [--first 0]

Each pair is a random machine under a kind of control with a loop, and the same with another mass
and frequency. Named are predictions of circles that miss by more than 0.1 um and 1 %, promises that
are broken (circles that are entered at the path acceleration, corners, lines in 16 directions), and
axes that settle later than alone with the same filter.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np

from benchmarks.every_size import draw_profile
from mtcommission.base.errors import ComputationError
from mtcommission.group.contours import worst_circle
from mtcommission.group.group import LEAST_RADIUS, Group, join
from mtcommission.group.judged import circle_test, corner_speeds, draw_circles, judge_group
from mtcommission.group.task import Task
from mtcommission.machine.machine import Corner, Machine, moving_mass, vary
from mtcommission.machine.profile.read import ProfileSource, parse_profile
from tests.group_record import driven
from tests.independent_circle import circle_off, corner_off, entry_off, line_off

ROUNDING = 1.005
"""What a promise may be exceeded by, as the second program looks at few instants."""

ROOM = 0.1e-6
"""In which a predicted circle must lie, or in 1 % [m]."""


TURN = 1.0
"""How long a circle takes about, for the second program drives it cycle by cycle [s]."""


def draw_pair(seed: int) -> tuple[Machine, Machine] | None:
    """A random machine and another like it; None: without a loop."""
    first = parse_profile(draw_profile(seed), where=f"random {seed}")
    if first.drive.follows:
        return None
    generator = np.random.default_rng([37, seed])
    heavier = moving_mass(first) * generator.uniform(0.1, 0.8)
    other = vary(
        first, Corner(payload=heavier, frequency_factor=float(generator.uniform(0.75, 1.3)))
    )
    return first, replace(other, axis="Y")


def task_of(machines: tuple[Machine, Machine], seed: int) -> Task:
    """A contour of some tolerance at some feed."""
    generator = np.random.default_rng([38, seed])
    source = ProfileSource(path=Path(f"random {seed}"), sha256="", text="")
    return Task(
        machines=machines,
        sources=(source, source),
        plane=(0, 1),
        tolerance=float(np.exp(generator.uniform(*np.log([5e-6, 50e-6])))),
        feed=float(np.exp(generator.uniform(*np.log([0.02, 0.2])))),
        radius=None,
    )


def refuted(group: Group, seed: int) -> list[str]:
    """What the second program says against a group."""
    generator, item, task = np.random.default_rng([39, seed]), group.setpoint_filter, group.task
    count = len(group.drawn[0].follower.tuned.corners)
    somewhere = int(generator.integers(count)), int(generator.integers(count))
    found, allowed = [], ROUNDING * group.allowed
    # Smaller than what is driven within a second.
    largest = max(min(50e-3, task.feed * TURN / (2.0 * pi)), 2e-3)
    radius = float(np.exp(generator.uniform(*np.log([1e-3, largest]))))
    a, _ = group.path.on_circles
    feed = min(task.feed, (a * radius) ** 0.5)
    circle = draw_circles(group, ((radius, feed),))[0]
    _, worst = worst_circle(group.pair, np.array([feed / radius]))
    off, _ = circle_off(driven(group, divmod(int(worst[0]), count)), item, radius=radius, feed=feed)
    for name, ours, theirs in (
        ("radius", circle.radius_deviation, float(off.mean())),
        ("form", circle.form_deviation, float(np.ptp(off))),
    ):
        if abs(ours - theirs) > max(ROOM, 0.01 * abs(theirs)):
            found.append(f"{name} of circle {1e6 * ours:.3f} um, {1e6 * theirs:.3f}")
    if np.abs(off).max() > allowed:
        found.append(f"circle {1e6 * np.abs(off).max():.2f} um of {1e6 * group.allowed:.2f}")
    turned = float(generator.uniform(0.0, pi))
    # Smaller circles are passed as corners are.
    entered = max(task.feed**2 / a, LEAST_RADIUS)
    off_entry = entry_off(
        driven(group, somewhere), item, radius=entered, feed=task.feed, turned=turned
    )
    if off_entry > allowed:
        found.append(f"entry {1e6 * off_entry:.2f} um of {1e6 * group.allowed:.2f}")
    corners = corner_speeds(group)
    one = corners[int(generator.integers(len(corners)))]
    off_corner = corner_off(
        driven(group, somewhere), item, angle=one.angle, arc=one.arc_radius, feed=one.speed,
        turned=turned,
    )  # fmt: skip
    if off_corner > allowed:
        found.append(f"corner {1e6 * off_corner:.2f} um of {1e6 * group.allowed:.2f}")
    direction = float(generator.integers(1, 8)) * pi / 16.0
    (along,), (jerk,) = group.path.along(np.array([direction]))
    off_line = line_off(
        driven(group, somewhere), item, feed=task.feed, acceleration=float(along),
        jerk=float(jerk), direction=direction,
    )  # fmt: skip
    if off_line > allowed:
        found.append(f"line {1e6 * off_line:.2f} um of {1e6 * group.allowed:.2f}")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--first", type=int, default=0, help="seed of the first of them")
    options = parser.parse_args()
    judged = broken = 0
    for seed in range(options.first, options.first + options.count):
        pair = draw_pair(seed)
        if pair is None:
            continue
        try:
            group = join(task_of(pair, seed))
        except ComputationError as error:
            print(f"{seed}: {error.outcome.name}", flush=True)
            continue
        contour = judge_group(group, circle_test(group))[:2]
        if not all(check.met for check in contour):
            print(f"{seed}: no promise", flush=True)
            continue
        against = refuted(group, seed)
        judged, broken = judged + 1, broken + bool(against)
        print(
            f"{seed}: {group.control.corner.kind.value}: {'; '.join(against) or 'kept'}", flush=True
        )
    print(f"{judged} pairs, {broken} refuted")


if __name__ == "__main__":
    main()
