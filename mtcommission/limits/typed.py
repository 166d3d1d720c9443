"""Limits as they are typed in: few digits, the jerk as the control takes it, and judged exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, floor, inf, log10

from mtcommission.controls.kind import Jerk
from mtcommission.limits.bench import build_bench
from mtcommission.limits.every_size import SizeCheck, judge_sizes
from mtcommission.limits.explore import REFINED, Found, explore, growth
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, largest_acceleration
from mtcommission.setpoint.duration import longest_move, require_short
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_setpoint

DIGITS, ROUND = 3, 1e-9
"""Significant digits of what is typed in; what is rounding alone, in steps of the last one."""

MOST_TYPED, MOST_SCALED = 4, 8
"""Filters whose limits are typed and judged, best first, and how often each is scaled
(empirical)."""

FEW = 1
"""Places that are refined and typed, and searches, where the best of a loop much like this one is
known."""

JUST_LESS, WELL_SOONER = 0.9995, 0.98
"""What the next limits use of what is allowed, if all is in proportion; and how much sooner longer
ramps must be than less acceleration to be tried instead [-] (empirical)."""

NOTICEABLE = 0.9995
"""What is not sooner by this factor is not worth a look [-] (empirical)."""

ROUNDS, WORTH_A_ROUND, CLOSE_ENOUGH, MOST_EXCESS = 3, 1.01, 1.003, 1.3
"""Searches, where the exact verdict finds that much more than the search saw and what is typed in
ends so much later than what was found; and by how much the next one is stricter at most [-]
(empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Typed:
    """Limits as they are typed in, and the worst of the sizes that count with them."""

    limits: MotionLimits
    sizes: tuple[SizeCheck, ...]
    duration: float  # t_e of the slowest listed move [s]


def find_typed(
    machine: Machine,
    tuned: TunedLoop,
    *,
    near: MotionLimits | None = None,
    found: tuple[Found, ...] = (),
    largest_jerk: float = inf,
) -> Typed | None:
    """Return the soonest limits, as typed in, that keep all requirements as they stand.

    None where the search finds none; a settling time is not asked for. ``near`` and ``found`` as
    for ``choose_limits``.
    """
    refined, most, rounds = (REFINED, MOST_TYPED, ROUNDS) if near is None else (FEW, FEW, FEW)
    stricter = machine
    typed: list[Typed] = []
    for _ in range(rounds):
        best = min((item.duration for item in typed), default=inf)
        if not found:
            bench = build_bench(stricter, tuned)
            found = explore(
                bench, largest_jerk=largest_jerk, near=near, refined=refined, latest=best
            )
        first: tuple[SizeCheck, ...] = ()
        for item in found[:most]:
            if item.duration >= min(best, longest_move(machine)):
                break
            nearest, used = _type_in(machine, tuned, item, latest=best)
            first = used if item is found[0] else first
            if nearest is not None:
                typed.append(nearest)
                best = nearest.duration
        missed = [check for check in first if check.share(machine) > WORTH_A_ROUND]
        if not missed or best < CLOSE_ENOUGH * found[0].duration:
            break
        # Judged exactly they use more of these than the search saw: it looks again for less.
        for check in missed:
            bound = check.requirement.bound(stricter) / min(check.share(machine), MOST_EXCESS)
            stricter = check.requirement.with_bound(stricter, bound)
        found = ()
    best_typed = min(typed, key=lambda item: item.duration, default=None)
    if near is not None:
        # What is known may serve as it is, and sooner than what was found about it.
        latest = best_typed.duration if best_typed else inf
        if near.jerk <= largest_jerk and _duration(machine, near) < latest:
            known, share = _judged(machine, tuned, near)
            return known if share <= 1.0 else best_typed
        return best_typed
    if best_typed is None:
        return None
    # Rounding, or what the search saw too large, may leave room for a little more.
    limits = best_typed.limits
    share = max(check.share(machine) for check in best_typed.sizes)
    a = min(limits.acceleration / share, largest_acceleration(machine))
    more = round_limits(machine, a, limits.jerk_time)
    more = replace(more, setpoint_filter=limits.setpoint_filter)
    if more.jerk <= largest_jerk and _duration(machine, more) < NOTICEABLE * best_typed.duration:
        raised, share = _judged(machine, tuned, more)
        return raised if share <= 1.0 else best_typed
    return best_typed


def type_in_at_least(machine: Machine, tuned: TunedLoop) -> Typed:
    """Return limits that hardly move the axis, where the search finds none at all.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG.
    """
    limits = round_limits(machine, 1e-3 * largest_acceleration(machine), 0.1)
    require_short(_duration(machine, limits), velocity_cycle=machine.control.velocity_cycle)
    sizes = judge_sizes(machine, tuned, limits)
    return Typed(limits=limits, sizes=sizes, duration=_duration(machine, limits))


def _type_in(
    machine: Machine, tuned: TunedLoop, found: Found, *, latest: float
) -> tuple[Typed | None, tuple[SizeCheck, ...]]:
    """The nearest limits that can be typed in and hold, and what the found ones use.

    None where none end before ``latest`` [s].
    """
    a, jerk_time, item = found.acceleration, found.jerk_time, found.setpoint_filter
    grows, before, bound_by = 1.0, (inf, inf), ""
    first: tuple[SizeCheck, ...] = ()

    def typed_in(acceleration: float, ramp: float) -> MotionLimits:
        return replace(round_limits(machine, acceleration, ramp), setpoint_filter=item)

    limits = typed_in(a, jerk_time)
    for _ in range(MOST_SCALED):
        if _duration(machine, limits) >= latest:
            break
        typed, used = _judged(machine, tuned, limits)
        first = first or typed.sizes
        if used <= 1.0:
            return typed, first
        now = (limits.acceleration, used)
        most = max(typed.sizes, key=lambda check: check.share(machine)).requirement.key
        if most != bound_by:
            grows = 1.0
        elif now[0] < before[0]:  # behind a shaper less of a may leave hardly less
            grows = float(growth(before, now))
        before, bound_by = now, most
        less = min(limits.acceleration * used ** (-1.0 / grows) * JUST_LESS, a * JUST_LESS)
        slower = typed_in(less, jerk_time)
        # Where a ramp takes less than a cycle or two, a longer one costs hardly any time.
        ramp = limits.jerk_time * used / JUST_LESS
        gentler = typed_in(a, ramp)
        if _duration(machine, gentler) < min(WELL_SOONER * _duration(machine, slower), latest):
            typed, left = _judged(machine, tuned, gentler)
            if left <= 1.0:
                return typed, first
            if left < used:
                jerk_time, less = ramp, gentler.acceleration / left * JUST_LESS
                slower = typed_in(less, ramp)
        a, limits = less, slower
    return None, first


def _judged(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> tuple[Typed, float]:
    """Limits, judged exactly, and the largest share of a bound that they use [-]."""
    sizes = judge_sizes(machine, tuned, limits, only_if_kept=True)
    typed = Typed(limits=limits, sizes=sizes, duration=_duration(machine, limits))
    return typed, max(check.share(machine) for check in sizes)


def _duration(machine: Machine, limits: MotionLimits) -> float:
    """t_e of the slowest listed move [s]."""
    return max(plan_setpoint(move, limits).duration for move in machine.moves)


def round_limits(machine: Machine, acceleration: float, jerk_time: float) -> MotionLimits:
    """Return the nearest limits [m/s², s] to type in that are not faster, without a filter."""
    a = _few_digits(acceleration, floor)
    match machine.control.kind.jerk:
        case Jerk.LIMIT:
            return MotionLimits(acceleration=a, jerk=_few_digits(acceleration / jerk_time, floor))
        case Jerk.TIME:
            return MotionLimits(acceleration=a, jerk=a / _few_digits(jerk_time, ceil))
        case Jerk.NONE:
            return without_jerk_limit(machine, a)


def _few_digits(value: float, towards: Callable[[float], int]) -> float:
    """The next number with few significant digits, or the value itself but for its rounding.

    >>> _few_digits(1234.0, floor), _few_digits(0.01251, ceil), _few_digits(0.0125, ceil)
    (1230.0, 0.0126, 0.0125)
    """
    exponent = floor(log10(value)) - DIGITS + 1
    scaled = value / 10.0**exponent
    nearest = round(scaled)
    number = nearest if abs(scaled - nearest) <= ROUND else towards(scaled)
    return float(f"{number}e{exponent}")
