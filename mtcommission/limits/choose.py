"""The acceleration, jerk and setpoint filter that let the slowest move settle soonest.

One search for every size of move and for the listed sizes alone (``explore``); what it finds is
rounded to what is typed in and judged exactly, in every corner: only that verdict counts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from math import inf, isfinite, isnan, log, nan

import numpy as np

from mtcommission.control_kinds.kind import Jerk
from mtcommission.limits.bench import Bench, build_bench
from mtcommission.limits.digits import limits_about, round_limits
from mtcommission.limits.every_size import SizeCheck, judge_every_size
from mtcommission.limits.explore import LEAST_GROWTH, REFINED, Found, explore
from mtcommission.limits.judge import (
    Assessment,
    Candidate,
    MoveResult,
    assess,
    evaluate_moves,
    simulate_moves,
)
from mtcommission.limits.landscape import Landscape, chart_landscape
from mtcommission.limits.reserve import keep_reserve
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Reserve, largest_acceleration, practical_ceiling
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.requirements.register import requirements_of
from mtcommission.requirements.requirement import Requirement, Yields
from mtcommission.setpoint.duration import longest_move, require_short
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import jerk_steps, plan_setpoint

__all__ = ["Choice", "choose_limits"]

DIGITS = 3
"""Significant digits of what is typed in."""

MOST_TYPED, MOST_SCALED = 4, 8
"""Filters whose limits are typed and judged, best first, and how often each is scaled
(empirical)."""

FEW = 1
"""Places that are refined, and typed, where the best of a loop much like this one is known."""

JUST_LESS = 0.9995
"""What the next limits use of what is allowed, if all is in proportion (empirical)."""

MOST_RAISED, REACH, ALMOST, NOTICEABLE = 3, 2, 1.002, 0.9995
"""Faster limits that are judged last, the fastest first; how far about in steps of the last digit;
what of a bound they may seem to use; and what is not worth it [-] (empirical)."""

ROUNDS, WORTH_A_ROUND, CLOSE_ENOUGH, MOST_EXCESS = 3, 1.01, 1.003, 1.3
"""Searches, where the exact verdict finds that much more than the search saw and what is typed in
ends so much later than what was found; and by how much the next one is stricter at most [-]
(empirical)."""

WIDER = (2.0, 4.0, 8.0, 16.0, 64.0, 256.0)
"""Factors in turn on what yields first, for which limits are sought where nothing keeps it
(empirical)."""

RAISED = ((1.03, 1.03), (1.03, 1.0), (1.0, 1.03))
"""Factors of acceleration and jerk with which it is seen what forbids more (design
choice)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choice:
    """Recommended limits, judged, and what the search saw."""

    candidate: Candidate  # rounded to what is typed in, and the verdict on exactly that
    moves: tuple[MoveResult, ...]  # in every corner
    reserve: Reserve  # what was to be kept of band and force
    reserve_used: bool  # the limits need more than that leaves: nothing else meets all
    ceiling: tuple[Message, ...]  # said where a practical one of the control's kind ends them
    explain: Callable[[], Message]  # names what forbids faster limits: few choices are asked
    chart: Callable[[], Landscape]  # the map to be printed, likewise

    @property
    def limits(self) -> MotionLimits:
        """Acceleration, jerk and filter to type in."""
        return self.candidate.limits

    @property
    def meets_requirements(self) -> bool:
        """Whether all requirements are met, reserve apart."""
        return self.candidate.assessment.is_met

    @property
    def warnings(self) -> tuple[Message, ...]:
        """What the verdict does not show."""
        kept = self.reserve
        used = Message("reserve-used", band=kept.band, force=kept.force)
        return (*((used,) if self.reserve_used else ()), *self.ceiling)

    @property
    def bound_by(self) -> Message:
        """What forbids faster limits."""
        return self.explain()

    @property
    def landscape(self) -> Landscape:
        """Settling time, residual deviation and use of force over all limits."""
        return self.chart()


def choose_limits(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    near: MotionLimits | None = None,
    found: tuple[Found, ...] = (),
    largest_jerk: float = inf,
) -> Choice:
    """Return the limits with the least worst-case settling time that meet all requirements.

    ``near``: the best limits of a loop much like this one; then only their neighbourhood is looked
    at; ``found``: what ``explore`` found with the reserve kept, if that was asked. The reserve is
    kept; where nothing does, all requirements without it. Of limits that settle equally soon the
    gentlest. Where nothing meets the requirements, those that miss least what yields first, within
    all others.
    """
    strict, best = keep_reserve(machine), None
    for allowed in dict.fromkeys((strict, machine)):
        typed = find_typed(allowed, plant, tuned, near=near, found=found, largest_jerk=largest_jerk)
        found = ()
        if typed is not None:
            choice = _judged(machine, allowed, plant, tuned, typed, largest_jerk)
            if choice.meets_requirements:
                return choice
            best = best or choice  # too late, perhaps: the reserve may buy that time
    if best is not None:
        return best
    for factor in WIDER:
        wider = machine
        for item in requirements_of(machine):
            if item.yields is Yields.FIRST:
                wider = item.with_bound(wider, factor * item.bound(machine))
        typed = find_typed(wider, plant, tuned, near=None, largest_jerk=largest_jerk)
        if typed is not None:
            break
    else:
        a = 1e-3 * largest_acceleration(machine)
        limits = round_limits(machine, a, 0.1, digits=DIGITS)
        require_short(_duration(machine, limits), velocity_cycle=machine.control.velocity_cycle)
        typed = Typed(limits=limits, sizes=None)
    return _judged(machine, machine, plant, tuned, typed, largest_jerk)


def choose_for_listed(machine: Machine, plant: Plant, tuned: TunedLoop) -> Candidate:
    """Return what would serve the listed sizes alone best, whatever smaller moves do."""
    machine = replace(machine, requirements=replace(machine.requirements, every_size=False))
    return choose_limits(machine, plant, tuned).candidate


@dataclass(frozen=True, slots=True, kw_only=True)
class Typed:
    """Limits as they are typed in, and the worst of every size with them, where it counts."""

    limits: MotionLimits
    sizes: tuple[SizeCheck, ...] | None
    duration: float = inf  # t_e of the slowest listed move [s]


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

    None where the search finds none; a settling time is not asked for.
    """
    bench = build_bench(machine, plant, tuned)
    refined = REFINED if near is None else FEW
    typed: list[Typed] = []
    for _ in range(ROUNDS):
        found = found or explore(bench, largest_jerk=largest_jerk, near=near, refined=refined)
        best, excess = min((item.duration for item in typed), default=inf), 1.0
        for item in found[:MOST_TYPED]:
            if item.duration >= min(best, longest_move(machine)):
                break
            own = _Typing(machine=machine, plant=plant, tuned=tuned, bench=bench, latest=best)
            nearest, used = own.type_in(item, largest_jerk)
            excess = max(excess, used) if item is found[0] else excess
            if nearest is not None:
                typed.append(nearest)
                best = nearest.duration
        if not found or excess < WORTH_A_ROUND or best < CLOSE_ENOUGH * found[0].duration:
            break
        # Judged exactly more is left than the search saw: it looks again for less.
        stricter = bench.left_after / min(excess, MOST_EXCESS)
        bench, found = replace(bench, left_after=stricter), ()
    return min(typed, key=lambda item: item.duration, default=None)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Typing:
    """Limits to be typed in, that must be soon enough."""

    machine: Machine
    plant: Plant
    tuned: TunedLoop
    bench: Bench
    latest: float  # duration [s]

    def type_in(self, found: Found, largest_jerk: float) -> tuple[Typed | None, float]:
        """Return the nearest limits that can be typed in and hold, and what the found ones use.

        None where none are as soon as asked for.
        """
        (a, jerk_time), item = _reached(self.machine, found), found.setpoint_filter
        grows, before, first = 1.0, (inf, inf), nan
        limits = self._nearest(a, jerk_time, item)
        for _ in range(MOST_SCALED):
            if _duration(self.machine, limits) >= self.latest:
                return None, first
            used, sizes = _use_of_bounds(self.machine, self.plant, self.tuned, limits)
            first = used if isnan(first) else first
            if used <= 1.0:
                break
            now = (log(limits.acceleration), log(used))
            if now[0] < before[0] < inf:  # behind a shaper less of a may leave hardly less
                grows = min(max((before[1] - now[1]) / (before[0] - now[0]), LEAST_GROWTH), 1.0)
            before = now
            a = min(limits.acceleration * used ** (-1.0 / grows) * JUST_LESS, a * JUST_LESS)
            limits = _rounded(self.machine, a, jerk_time, item)
        else:
            return None, first
        best = Typed(limits=limits, sizes=sizes, duration=_duration(self.machine, limits))
        for raised in self._above(limits, used, jerk_time, largest_jerk):
            if _duration(self.machine, raised) >= NOTICEABLE * best.duration:
                break
            used, sizes = _use_of_bounds(self.machine, self.plant, self.tuned, raised)
            if used <= 1.0:
                duration = _duration(self.machine, raised)
                return Typed(limits=raised, sizes=sizes, duration=duration), first
        return best, first

    def _nearest(self, a: float, jerk_time: float, item: SetpointFilter | None) -> MotionLimits:
        """The nearest limits to type in that are not faster; of one size alone the soonest kept."""
        machine = self.machine
        nearest = _rounded(machine, a, jerk_time, item)
        if machine.requirements.every_size:
            return nearest
        about = limits_about(machine, a, jerk_time, digits=DIGITS, reach=REACH)
        for each in sorted(about, key=partial(_duration, machine)):
            use, own = self.bench.use(item, each.jerk_time), np.array([each.acceleration])
            if use.of_after(own)[0] <= 1.0 and use.of_rest(each.acceleration) <= 1.0:
                return replace(each, setpoint_filter=item)
        return nearest

    def _above(
        self, limits: MotionLimits, used: float, jerk_time: float, largest_jerk: float
    ) -> list[MotionLimits]:
        """Faster limits that may hold, in proportion to what quick looks tell; fastest first."""
        largest, item = largest_acceleration(self.machine), limits.setpoint_filter

        def share(each: MotionLimits) -> float:
            use = self.bench.use(item, each.jerk_time)
            a = np.array([each.acceleration])
            return float(max(use.of_after(a)[0], use.of_cruise(a)[0], 1e-9))

        now, scaled = share(limits), min(limits.acceleration / used, largest)
        above = [
            replace(each, setpoint_filter=item)
            for each in limits_about(self.machine, scaled, jerk_time, digits=DIGITS, reach=REACH)
            if each.jerk <= largest_jerk and each.acceleration <= largest
        ]
        likely = [each for each in above if used * share(each) / now <= ALMOST]
        return sorted(likely, key=partial(_duration, self.machine))[:MOST_RAISED]


def _rounded(
    machine: Machine, a: float, jerk_time: float, item: SetpointFilter | None
) -> MotionLimits:
    return replace(round_limits(machine, a, jerk_time, digits=DIGITS), setpoint_filter=item)


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


def _use_of_bounds(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits
) -> tuple[float, tuple[SizeCheck, ...] | None]:
    """The largest share of any requirement but the settling time that limits use, exactly [-]."""
    if machine.requirements.every_size:
        sizes = judge_every_size(machine, plant, tuned, limits, only_if_kept=True)
        return max(_proved(item) / item.requirement.bound(machine) for item in sizes), sizes
    checks = _judge_listed(machine, plant, tuned, limits).checks
    return max(item.value / item.limit for item in checks if _is_searched(item.requirement)), None


def _is_searched(requirement: Requirement) -> bool:
    return requirement.yields is not Yields.MINIMISED


def _judge_listed(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits
) -> Assessment:
    values = [result.values for result in simulate_moves(machine, tuned, limits)]
    return assess(machine, plant, tuned.corners, values)


def _proved(check: SizeCheck) -> float:
    """What no size exceeds, where that is proved; else the worst that was found."""
    return check.bound if isfinite(check.bound) else check.value


def _judged(
    machine: Machine,
    allowed: Machine,
    plant: Plant,
    tuned: TunedLoop,
    typed: Typed,
    largest_jerk: float,
) -> Choice:
    """The verdict on limits by the requirements as they stand; ``allowed``: what they keep."""
    moves = simulate_moves(machine, tuned, typed.limits)
    candidate = evaluate_moves(machine, plant, tuned, moves, sizes=typed.sizes)
    met = candidate.assessment.is_met
    return Choice(
        candidate=candidate,
        moves=moves,
        reserve=machine.requirements.reserve,
        ceiling=_say_ceiling(allowed, typed.limits),
        reserve_used=met and allowed is machine and keep_reserve(machine) is not machine,
        explain=cache(partial(_explain, allowed, plant, tuned, candidate, largest_jerk)),
        chart=cache(partial(chart_landscape, machine, plant, tuned, typed.limits)),
    )


def _say_ceiling(machine: Machine, limits: MotionLimits) -> tuple[Message, ...]:
    """The practical ceiling of the control's kind, where the search ended at it."""
    ceiling, kind = practical_ceiling(machine), machine.control.kind.key
    if largest_acceleration(machine) < ceiling or RAISED[0][0] * limits.acceleration <= ceiling:
        return ()
    why = Message("ceiling-source", kind=kind)
    return (Message("acceleration-ceiling", ceiling=ceiling, why=why),)


def _explain(
    machine: Machine, plant: Plant, tuned: TunedLoop, candidate: Candidate, largest_jerk: float
) -> Message:
    """Name what breaks when either limit is raised a little."""
    limits, broken = candidate.limits, dict[Requirement, None]()
    missed = [item.requirement for item in candidate.assessment.checks if not item.is_met]
    if any(item.yields is Yields.FIRST for item in missed):
        return Message("bound-by-nothing-met")
    has_jerk = machine.control.kind.has_jerk_limit
    for a, j in RAISED if has_jerk else RAISED[:1]:
        if j * limits.jerk > largest_jerk:
            return Message("bound-by-jerk-in-proportion", jerk=largest_jerk)
        raised = replace(limits, acceleration=a * limits.acceleration, jerk=j * limits.jerk)
        if machine.requirements.every_size:
            sizes = judge_every_size(machine, plant, tuned, raised)
            used = {item.requirement: _proved(item) for item in sizes}
        else:
            checks = _judge_listed(machine, plant, tuned, raised).checks
            used = {item.requirement: item.value for item in checks}
        for requirement, value in used.items():
            if _is_searched(requirement) and value > requirement.bound(machine):
                broken[requirement] = None
    named, motor = [item.message for item in broken], machine.drive.motion_force
    if _say_ceiling(machine, limits):
        named.append(Message("bound-by-ceiling", acceleration=practical_ceiling(machine)))
    if not named and machine.drive.follows and RAISED[0][0] * limits.acceleration > motor:
        return Message("bound-by-motor", acceleration=motor)
    if not named:
        return Message("bound-by-settling-later")
    return Message("bound-by-requirements", requirements=join_by_and(named))
