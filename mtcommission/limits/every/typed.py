"""From what a search found to what is typed in: few digits, and the exact verdict on them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from mtcommission.control_kinds.kind import Jerk
from mtcommission.limits.digits import round_limits
from mtcommission.limits.every.search import Found, search_every_size
from mtcommission.limits.search.bench import reached_accelerations
from mtcommission.loop.simulation_budget import longest_affordable
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import Kind, Requirement
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from mtcommission.verdict.every_size import SizeCheck, judge_every_size

MOST_TYPED = 6
"""Found limits that are typed and judged, best first, until none can be sooner."""

MOST_SCALED = 6
"""How often limits are taken back in proportion to what they use too much."""

LIKELY = 0.995
"""What rounding and the verdict add differs from limits to limits by about half a per cent."""

DIGITS = 3
"""Significant digits of what is typed in."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Typed:
    """Limits as they are typed in, and the worst of every size with them.

    Parameters
    ----------
    limits
        With the setpoint filter.
    duration
        t_e of the slowest listed move [s].
    sizes
        One for each requirement.
    evaluations
        Places where the search found limits.
    """

    limits: MotionLimits
    duration: float
    sizes: tuple[SizeCheck, ...]
    evaluations: int


def find_for_every_size(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    largest_jerk: float,
    near: MotionLimits | None = None,
) -> Typed | None:
    """Return the soonest limits, as typed in, that keep every bound at every size of move.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, whose requirements count as they stand, its plant and its loop.
    largest_jerk
        [m/s³].
    near
        Limits of a loop much like this one, near which to look.

    Returns
    -------
    Typed or None
        None where the search finds none.
    """
    best: Typed | None = None
    found = search_every_size(machine, plant, tuned, largest_jerk=largest_jerk, near=near)
    longer = 1.0  # what rounding and the exact verdict added to the duration found, at least
    for item in found[:MOST_TYPED]:
        if best is not None and LIKELY * longer * item.duration >= best.duration:
            continue
        latest = best.duration if best else longest_affordable(machine)
        typed = _type(machine, plant, tuned, item, latest=latest, evaluations=len(found))
        if typed is None:
            continue
        added = typed.duration / item.duration
        longer = added if best is None else min(longer, added)
        best = typed
    return best


def _type(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    found: Found,
    *,
    latest: float,
    evaluations: int,
) -> Typed | None:
    """The nearest limits that can be typed in and hold.

    None where that does not end, or only with moves that take as long as ``latest``.
    """
    a, jerk_time = _reached(machine, found)
    for tried in range(MOST_SCALED):
        rounded = round_limits(machine, a, jerk_time, digits=DIGITS)
        limits = replace(rounded, setpoint_filter=found.setpoint_filter)
        duration = max(plan_setpoint(move, limits).duration for move in machine.moves)
        if duration >= latest:
            return None
        sizes = judge_every_size(machine, plant, tuned, limits, only_if_kept=True)
        used = max(_proved(check) / bound_of(machine, check.requirement) for check in sizes)
        if used <= 1.0:
            return Typed(limits=limits, duration=duration, sizes=sizes, evaluations=evaluations)
        # Behind a shaper the worst size may change little with a: then ever longer steps.
        a = min(limits.acceleration, a) / used ** (1 + tried) * JUST_LESS
    return None


def _reached(machine: Machine, found: Found) -> tuple[float, float]:
    """The same motions by the acceleration that the listed moves reach, and its jerk time.

    More of it changes nothing, so that how much more would be up to the last digit of a sum.
    """
    a, t = found.acceleration, found.jerk_time
    if machine.control.kind.jerk is Jerk.NONE:  # the ramp follows from a: there more of it counts
        return a, t
    reached = float(reached_accelerations(machine, np.array([a]), np.array([t]))[0])
    return reached, t * reached / a


def _proved(check: SizeCheck) -> float:
    """What no size exceeds, where that is proved; else the worst that was found."""
    return check.bound if isfinite(check.bound) else check.value


JUST_LESS = 0.9995
"""What the next limits use of what is allowed, if all is in proportion."""


def bound_of(machine: Machine, requirement: Requirement) -> float:
    """Return what a machine allows of what is required [own unit]."""
    needs, drive = machine.requirements, machine.drive
    match requirement.kind:
        case Kind.RESIDUAL_DEVIATION:
            return needs.tcp_deviation
        case Kind.CONTOUR_DEVIATION:
            return needs.contour_deviation
        case Kind.SETTLING_TIME:
            return needs.max_settling_time
        case Kind.SET_FORCE:
            return drive.motion_force
        case Kind.RMS_FORCE:
            return drive.continuous_force
        case Kind.PEAK:
            return next(peak.bound for peak in needs.peaks if peak.name == requirement.signal)
