"""Input shapers and the jerk filter, on a setpoint with trapezoidal velocity, for comparison.

A shaper splits the setpoint into a few scaled and delayed copies whose vibrations of one mode
cancel. The jerk filter is a moving average over one period of that mode. Both run through the
same loop, corners and judgement as the recommendation, each with the acceleration that suits it
best.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from mtcommission.control_kinds.kind import MOVING_AVERAGE
from mtcommission.limits.bench import build_bench
from mtcommission.limits.explore import Explorer
from mtcommission.limits.reserve import keep_reserve
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, largest_acceleration
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, dominant_mode
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT, MotionLimits
from mtcommission.verdict.evaluate import Candidate, evaluate

BACKED_OFF, LESS = 4, 0.98
"""How often, and by what share, an acceleration is lowered that the exact verdict refuses."""

SOURCES = {
    "zv": "source-singer",
    "mzv": "source-klipper",
    "zvd": "source-singer",
    "ei": "source-klipper",
}
"""Shapers that are compared, by rising duration, and who says so."""

DESIGN_DAMPING = 0.1
"""Damping ratio that Klipper's shapers are set to unless told otherwise [-]."""


def compare_shapers(machine: Machine, plant: Plant, tuned: TunedLoop) -> tuple[Candidate, ...]:
    """Return shapers and the jerk filter through the same loop and judgement.

    What Klipper's calibrate_shaper would choose comes first, where the machine was measured so.
    All are designed for the dominant mode of the nominal plant; each gets the acceleration that
    settles soonest within all requirements; F_max/m if none does.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.

    Returns
    -------
    tuple of Candidate
        The jerk in ``limits`` stands for "no limit".
    """
    mode = dominant_mode(plant)
    f = mode.frequency_hz
    found = [
        _best_candidate(
            machine,
            plant,
            tuned,
            SetpointFilter(kind=kind, frequency_hz=f, damping_ratio=mode.damping_ratio),
            name=Message("shaper-for-mode", shaper=kind.upper(), mode=mode.name, frequency=f),
            source=Message(source),
        )
        for kind, source in SOURCES.items()
    ]
    average = SetpointFilter(kind=MOVING_AVERAGE, time=1.0 / f)
    name, source = (
        Message("moving-average-for-mode", mode=mode.name, frequency=f),
        Message("source-jerk-filter"),
    )
    return (
        *_of_klipper(machine, plant, tuned),
        *found,
        _best_candidate(machine, plant, tuned, average, name=name, source=source),
    )


def _of_klipper(machine: Machine, plant: Plant, tuned: TunedLoop) -> Iterator[Candidate]:
    """What calibrate_shaper recommends for the same measurement, at its max_accel.

    Where that is more than the motor follows, or than is looked at, at that.
    """
    identified = machine.identified
    for one in identified.proposals if identified else ():
        if not one.is_recommended:
            continue
        item = SetpointFilter(
            kind=one.shaper, frequency_hz=one.frequency_hz, damping_ratio=DESIGN_DAMPING
        )
        a = min(one.max_acceleration, largest_acceleration(machine))
        limits = MotionLimits(
            acceleration=a, jerk=a / machine.control.position_cycle, setpoint_filter=item
        )
        name = Message(
            "shaper-of-calibration", shaper=one.shaper.upper(), frequency=one.frequency_hz
        )
        yield evaluate(
            machine,
            plant,
            tuned,
            limits,
            name=name,
            source=Message("source-calibrate-shaper"),
        )


def _best_candidate(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    item: SetpointFilter,
    *,
    name: Message,
    source: Message,
) -> Candidate:
    """The soonest acceleration that meets all, reserve kept; else F_max/m, which may saturate."""
    strict = keep_reserve(machine)
    # An average needs no ramp of a cycle ahead of it: behind it the jerk is finite.
    ramp = NO_JERK_LIMIT if item.averages else machine.control.position_cycle
    explorer = Explorer.about(build_bench(strict, plant, tuned))
    found = explorer.look_at([(item, ramp)], latest=inf, most=1)
    largest = largest_acceleration(strict)
    a = found.acceleration if found else largest
    for _ in range(BACKED_OFF):
        limits = MotionLimits(acceleration=a, jerk=a / ramp, setpoint_filter=item)
        candidate = evaluate(machine, plant, tuned, limits, name=name, source=source)
        if found is None or candidate.assessment.keeps(machine.requirements.reserve):
            break
        a *= LESS
    return candidate
