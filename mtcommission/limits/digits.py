"""Limits as they are typed into a control: few digits, and a jerk as the control takes it."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, log10

from mtcommission.control_kinds.kind import Jerk
from mtcommission.machine.machine import Machine
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit

ROUND = 1e-9
"""Distance from a number with few digits, in steps of its last digit, that is rounding alone."""


def round_limits(
    machine: Machine, acceleration: float, jerk_time: float, *, digits: int
) -> MotionLimits:
    """Return the nearest limits to type in that are not faster, without a setpoint filter.

    The machine's control limits the jerk, the time of a ramp, or nothing. ``acceleration`` and
    ``jerk_time`` are not round yet [m/s², s]; ``digits`` are significant digits.
    """
    return next(limits_about(machine, acceleration, jerk_time, digits=digits))


def limits_about(
    machine: Machine, acceleration: float, jerk_time: float, *, digits: int, reach: int = 0
) -> Iterator[MotionLimits]:
    """Yield the limits to type in about some that need not be round, the gentlest first.

    The arguments are as for ``round_limits``; ``reach``: so many steps of the last digit more on
    either side.
    """
    for a in _numbers_about(acceleration, digits, reach):
        match machine.control.kind.jerk:
            case Jerk.LIMIT:
                jerks = _numbers_about(acceleration / jerk_time, digits, reach)
            case Jerk.TIME:
                jerks = [a / time for time in reversed(_numbers_about(jerk_time, digits, reach))]
            case Jerk.NONE:
                jerks = [without_jerk_limit(machine, a).jerk]
        for jerk in jerks:
            yield MotionLimits(acceleration=a, jerk=jerk)


def _numbers_about(value: float, digits: int, reach: int) -> list[float]:
    """The numbers with few significant digits about a value, rising.

    >>> _numbers_about(1234.0, 3, 0), _numbers_about(0.0125, 3, 1)
    ([1230.0, 1240.0], [0.0124, 0.0125, 0.0126])
    """
    exponent = floor(log10(value)) - digits + 1
    scaled = value / 10.0**exponent
    around = range(floor(scaled + ROUND) - reach, ceil(scaled - ROUND) + reach + 1)
    return [float(f"{number}e{exponent}") for number in around if number > 0]
