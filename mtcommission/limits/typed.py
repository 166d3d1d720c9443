"""Limits as they are typed in: few digits, the jerk as the control takes it, and judged exactly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, floor, inf, log, log10

import numpy as np

from mtcommission.control_kinds.kind import Jerk
from mtcommission.limits.bench import Bench, build_bench
from mtcommission.limits.every_size import SizeCheck, judge_sizes
from mtcommission.limits.explore import LEAST_GROWTH, REFINED, Found, explore
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, largest_acceleration
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.duration import longest_move, require_short
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import jerk_steps, plan_setpoint

DIGITS, ROUND = 3, 1e-9
"""Significant digits of what is typed in; what is rounding alone, in steps of the last one."""

MOST_TYPED, MOST_SCALED = 4, 8
"""Filters whose limits are typed and judged, best first, and how often each is scaled
(empirical)."""

FEW = 1
"""Places that are refined, and typed, where the best of a loop much like this one is known."""

JUST_LESS, WELL_SOONER = 0.9995, 0.98
"""What the next limits use of what is allowed, if all is in proportion; and how much sooner longer
ramps must be than less acceleration to be tried instead [-] (empirical)."""

REACH = 2
"""Of one size alone: steps of the last digit about what was found, of which the soonest is taken
(empirical)."""

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
    plant: Plant,
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
    refined, most = (REFINED, MOST_TYPED) if near is None else (FEW, FEW)
    stricter = machine
    typed: list[Typed] = []
    for _ in range(ROUNDS):
        bench = build_bench(stricter, plant, tuned)
        found = found or explore(bench, largest_jerk=largest_jerk, near=near, refined=refined)
        best = min((item.duration for item in typed), default=inf)
        first: tuple[SizeCheck, ...] = ()
        for item in found[:most]:
            if item.duration >= min(best, longest_move(machine)):
                break
            own = _Typing(
                machine=machine,
                plant=plant,
                tuned=tuned,
                bench=bench,
                latest=best,
            )
            nearest, used = own.type_in(item)
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
    return min(typed, key=lambda item: item.duration, default=None)


def type_in_at_least(machine: Machine, plant: Plant, tuned: TunedLoop) -> Typed:
    """Return limits that hardly move the axis, where the search finds none at all.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG.
    """
    limits = round_limits(machine, 1e-3 * largest_acceleration(machine), 0.1)
    require_short(_duration(machine, limits), velocity_cycle=machine.control.velocity_cycle)
    sizes = judge_sizes(machine, plant, tuned, limits)
    return Typed(limits=limits, sizes=sizes, duration=_duration(machine, limits))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Typing:
    """Limits to be typed in, that must be soon enough."""

    machine: Machine
    plant: Plant
    tuned: TunedLoop
    bench: Bench
    latest: float  # duration [s]

    def type_in(self, found: Found) -> tuple[Typed | None, tuple[SizeCheck, ...]]:
        """Return the nearest limits that can be typed in and hold, and what the found ones use.

        None where none are as soon as asked for.
        """
        (a, jerk_time), item = _reached(self.machine, found), found.setpoint_filter
        grows, before = 1.0, (inf, inf)
        first: tuple[SizeCheck, ...] = ()
        limits = self._nearest(a, jerk_time, item)
        for _ in range(MOST_SCALED):
            if _duration(self.machine, limits) >= self.latest:
                return None, first
            typed, used = self._judged(limits)
            first = first or typed.sizes
            if used <= 1.0:
                return typed, first
            now = (log(limits.acceleration), log(used))
            if now[0] < before[0] < inf:  # behind a shaper less of a may leave hardly less
                grows = min(max((before[1] - now[1]) / (before[0] - now[0]), LEAST_GROWTH), 1.0)
            before = now
            less = min(limits.acceleration * used ** (-1.0 / grows) * JUST_LESS, a * JUST_LESS)
            slower = replace(round_limits(self.machine, less, jerk_time), setpoint_filter=item)
            # Where a ramp takes less than a cycle or two, a longer one costs hardly any time.
            ramp = limits.jerk_time * used / JUST_LESS
            gentler = replace(round_limits(self.machine, a, ramp), setpoint_filter=item)
            soon = _duration(self.machine, gentler)
            if soon < min(WELL_SOONER * _duration(self.machine, slower), self.latest):
                typed, left = self._judged(gentler)
                if left <= 1.0:
                    return typed, first
                if left < used:
                    jerk_time, less = ramp, gentler.acceleration / left * JUST_LESS
                    slower = replace(round_limits(self.machine, less, ramp), setpoint_filter=item)
            a, limits = less, slower
        return None, first

    def _judged(self, limits: MotionLimits) -> tuple[Typed, float]:
        """Limits, judged exactly, and the largest share of a bound that they use [-]."""
        sizes = judge_sizes(self.machine, self.plant, self.tuned, limits, only_if_kept=True)
        typed = Typed(limits=limits, sizes=sizes, duration=_duration(self.machine, limits))
        return typed, max(check.share(self.machine) for check in sizes)

    def _nearest(self, a: float, jerk_time: float, item: SetpointFilter | None) -> MotionLimits:
        """The nearest limits to type in that are not faster; of one size alone the soonest kept."""
        machine = self.machine
        nearest = replace(round_limits(machine, a, jerk_time), setpoint_filter=item)
        if machine.requirements.every_size:
            return nearest
        about = _limits_about(machine, a, jerk_time, reach=REACH)
        for each in sorted(about, key=lambda limits: _duration(machine, limits)):
            use, own = self.bench.use(item, each.jerk_time), np.array([each.acceleration])
            if use.of_after(own)[0] <= 1.0 and use.of_rest(each.acceleration) <= 1.0:
                return replace(each, setpoint_filter=item)
        return nearest


def _reached(machine: Machine, found: Found) -> tuple[float, float]:
    """The same motions by the acceleration that the listed moves reach, and its jerk time.

    More of it changes nothing, so that how much more would be up to the last digit of a sum.
    """
    a, t_j = found.acceleration, found.jerk_time
    if machine.control.kind.jerk is Jerk.NONE:  # the ramp follows from a: there more of it counts
        return a, t_j
    jerk = np.array([a / t_j])
    ramps = [
        float(jerk_steps(move, acceleration=np.array([a]), jerk=jerk).times[0, 1])
        for move in machine.moves
    ]
    reached = min(max(ramps), t_j)
    return a * reached / t_j, reached


def _duration(machine: Machine, limits: MotionLimits) -> float:
    """t_e of the slowest listed move [s]."""
    return max(plan_setpoint(move, limits).duration for move in machine.moves)


def round_limits(machine: Machine, acceleration: float, jerk_time: float) -> MotionLimits:
    """Return the nearest limits [m/s², s] to type in that are not faster, without a filter."""
    return next(_limits_about(machine, acceleration, jerk_time))


def _limits_about(
    machine: Machine, acceleration: float, jerk_time: float, *, reach: int = 0
) -> Iterator[MotionLimits]:
    """Limits to type in, up to some steps of the last digit away, the gentlest first."""
    for a in _numbers_about(acceleration, reach):
        match machine.control.kind.jerk:
            case Jerk.LIMIT:
                jerks = _numbers_about(acceleration / jerk_time, reach)
            case Jerk.TIME:
                jerks = [a / time for time in reversed(_numbers_about(jerk_time, reach))]
            case Jerk.NONE:
                jerks = [without_jerk_limit(machine, a).jerk]
        for jerk in jerks:
            yield MotionLimits(acceleration=a, jerk=jerk)


def _numbers_about(value: float, reach: int) -> list[float]:
    """The numbers with few significant digits about a value, rising.

    >>> _numbers_about(1234.0, 0), _numbers_about(0.0125, 1)
    ([1230.0, 1240.0], [0.0124, 0.0125, 0.0126])
    """
    exponent = floor(log10(value)) - DIGITS + 1
    scaled = value / 10.0**exponent
    around = range(floor(scaled + ROUND) - reach, ceil(scaled - ROUND) + reach + 1)
    return [float(f"{number}e{exponent}") for number in around if number > 0]
