"""The acceleration, jerk and setpoint filter that let the slowest move settle soonest.

One search for every size of move and for the listed sizes alone (``explore``); what it finds is
rounded to what is typed in and judged exactly, in every corner: only that verdict counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from mtcommission.base.messages.message import Message, join_by_and
from mtcommission.limits.every_size import judge_sizes
from mtcommission.limits.explore import Found
from mtcommission.limits.judge import Candidate, MoveResult, evaluate_moves, simulate_moves
from mtcommission.limits.requirements import Requirement, Yields, keep_reserve, requirements_of
from mtcommission.limits.typed import Typed, find_typed, type_in_at_least
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, largest_acceleration, practical_ceiling
from mtcommission.setpoint.motion_limits import MotionLimits

WIDER = (2.0, 4.0, 8.0, 16.0, 64.0, 256.0)
"""Factors in turn on what yields first, for which limits are sought where nothing keeps it
(empirical)."""

RESERVE_BUYS = 1.3
"""By what factor moves settle sooner without the reserve, at most [-] (empirical: 1.08 in the
middle, 1.26 at most of 87 machines)."""

RAISED = ((1.03, 1.03), (1.03, 1.0), (1.0, 1.03))
"""Factors of acceleration and jerk with which it is seen what forbids more (design
choice)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Choice:
    """Recommended limits, judged; of few is asked what binds them, so that is found then."""

    machine: Machine  # whose requirements count as they stand
    kept: Machine  # the same with what was kept: its reserve where that can be, else itself
    tuned: TunedLoop
    candidate: Candidate  # rounded to what is typed in, and the verdict on exactly that
    moves: tuple[MoveResult, ...]  # in every corner
    why: Message | None = None  # what forbids faster limits, where somebody else knows it

    @property
    def limits(self) -> MotionLimits:
        """Acceleration, jerk and filter to type in."""
        return self.candidate.limits

    @property
    def meets_requirements(self) -> bool:
        """Whether all requirements are met, reserve apart."""
        return self.candidate.assessment.is_met

    @property
    def reserve_used(self) -> bool:
        """Whether the limits need more than the reserve leaves: nothing else meets all."""
        had_one = keep_reserve(self.machine) is not self.machine
        return self.meets_requirements and self.kept is self.machine and had_one

    @property
    def warnings(self) -> tuple[Message, ...]:
        """What the verdict does not show."""
        reserve, ceiling = self.machine.requirements.reserve, practical_ceiling(self.machine)
        used = Message("reserve-used", band=reserve.band, force=reserve.force)
        why = Message("ceiling-source", kind=self.machine.control.kind.key)
        ended = Message("acceleration-ceiling", ceiling=ceiling, why=why)
        return (*[used] * self.reserve_used, *[ended] * self._is_at_ceiling)

    @property
    def _is_at_ceiling(self) -> bool:
        """Whether the search ended at the practical ceiling of the control's kind."""
        ceiling, a = practical_ceiling(self.kept), self.limits.acceleration
        return largest_acceleration(self.kept) >= ceiling and RAISED[0][0] * a > ceiling

    @cached_property
    def bound_by(self) -> Message:
        """What breaks when either limit is raised a little, and in which measured state."""
        if self.why:
            return self.why
        machine, tuned, limits = self.kept, self.tuned, self.limits
        broken = dict[Requirement, str]()
        missed = [item.requirement for item in self.candidate.assessment.checks if not item.is_met]
        if any(item.yields is Yields.FIRST for item in missed):
            return Message("bound-by-nothing-met")
        has_jerk = machine.control.kind.has_jerk_limit
        for a, j in RAISED if has_jerk else RAISED[:1]:
            raised = replace(limits, acceleration=a * limits.acceleration, jerk=j * limits.jerk)
            for check in judge_sizes(machine, tuned, raised):
                if check.share(machine) > 1.0:
                    broken.setdefault(check.requirement, check.corner.state)
        named = [_in_state(item.message, state) for item, state in broken.items()]
        motor = machine.drive.motion_force
        if self._is_at_ceiling:
            named.append(Message("bound-by-ceiling", acceleration=practical_ceiling(machine)))
        if not named and machine.drive.follows and RAISED[0][0] * limits.acceleration > motor:
            return Message("bound-by-motor", acceleration=motor)
        if not named:
            times = [[one.settling_time for one in each.responses] for each in self.moves]
            slowest = int(np.max(times, axis=0).argmax())
            return _in_state(Message("bound-by-settling-later"), tuned.corners[slowest].state)
        return Message("bound-by-requirements", requirements=join_by_and(named))


def choose_limits(
    machine: Machine,
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
        typed = find_typed(allowed, tuned, near=near, found=found, largest_jerk=largest_jerk)
        found = ()
        if typed is not None:
            choice = _judged(machine, allowed, tuned, typed)
            if choice.meets_requirements:
                return choice
            best = best or choice
            if not may_be_in_time(machine, choice.candidate.settling_time):
                break
    if best is not None:
        return best
    for factor in WIDER:
        wider = machine
        for item in requirements_of(machine):
            if item.yields is Yields.FIRST:
                wider = item.with_bound(wider, factor * item.bound(machine))
        typed = find_typed(wider, tuned, near=None, largest_jerk=largest_jerk)
        if typed is not None:
            break
    else:
        typed = type_in_at_least(machine, tuned)
    return _judged(machine, machine, tuned, typed)


def may_be_in_time(machine: Machine, settling_time: float) -> bool:
    """Return whether what settles then, reserve kept, may be in time where that is used up."""
    return settling_time <= RESERVE_BUYS * machine.requirements.max_settling_time


def _judged(machine: Machine, kept: Machine, tuned: TunedLoop, typed: Typed) -> Choice:
    """The verdict on limits by the requirements as they stand; ``kept``: what they keep."""
    moves = simulate_moves(machine, tuned, typed.limits)
    return Choice(
        machine=machine,
        kept=kept,
        tuned=tuned,
        candidate=evaluate_moves(machine, tuned, moves, sizes=typed.sizes),
        moves=moves,
    )


def _in_state(what: Message, state: str) -> Message:
    return Message("bound-in-state", what=what, state=state) if state else what
