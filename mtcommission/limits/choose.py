"""The acceleration and jerk that let the slowest move settle soonest, in every corner.

For every size of move (``every``) or for the listed sizes alone (``listed``); what either finds is
judged again by simulation: only that verdict counts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import islice
from math import inf

from mtcommission.limits.every.search import search_every_size
from mtcommission.limits.every.typed import Typed, bound_of, find_for_every_size
from mtcommission.limits.listed import explain, first_met, search_listed, soonest_possible
from mtcommission.limits.reserve import keep_reserve
from mtcommission.limits.search.landscape import Landscape, chart_landscape
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.simulation_budget import require_affordable
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Reserve
from mtcommission.machine.requirement import SETTLING_TIME, Requirement
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verdict.evaluate import Candidate, MoveResult, evaluate_moves, simulate_moves
from mtcommission.verdict.every_size import judge_every_size

__all__ = ["Choice", "SearchSettings", "choose_limits"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choice:
    """Recommended limits, judged, and what the search saw.

    Parameters
    ----------
    candidate
        The limits, rounded to what is typed in, and the verdict on exactly these.
    moves
        Their moves in every corner.
    reserve
        What was to be kept of band and force.
    reserve_used
        Whether the limits need more than that leaves, because nothing else meets the
        requirements.
    explain
        Names what forbids faster limits, when it is first asked for: few choices are.
    chart
        Charts the landscape to be printed, likewise.
    evaluations
        Limits judged in every corner, or until others were better already.
    """

    candidate: Candidate
    moves: tuple[MoveResult, ...]
    reserve: Reserve
    reserve_used: bool
    explain: Callable[[], Message]
    chart: Callable[[], Landscape]
    evaluations: int

    @property
    def limits(self) -> MotionLimits:
        """Acceleration and jerk to type in."""
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
        return (used,) if self.reserve_used else ()

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
    starts: Sequence[MotionLimits] = (),
    near: MotionLimits | None = None,
    largest_jerk: float = inf,
    settings: SearchSettings | None = None,
) -> Choice:
    """Return the limits with the least worst-case settling time that meet all requirements.

    Whatever is returned was simulated with the digits that are typed in and judged as the sheet
    judges it; what fails there gives way to the next best, and in the end to gentler limits.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.
    starts
        Limits to begin with besides those of the rules, e.g. from the optima.
    near
        Best limits of a loop much like this one: where every size counts, only their
        neighbourhood is looked at.
    largest_jerk
        [m/s³].
    settings
        None: the defaults.

    Returns
    -------
    Choice
        Keeps the reserve; where nothing does, all requirements without it. Of limits that settle
        equally soon the gentlest; else never slower than a rule or a start that meets all that
        (up to the rounding to what is typed in). Where nothing meets the requirements, the
        limits with the least settling time within force and peaks.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where the moves take more cycles than are followed.
    """
    require_affordable(machine)
    settings = settings or SearchSettings()
    strict = keep_reserve(machine)
    if not machine.requirements.every_size and machine.control.seeks_setpoint_filter:
        return _choose_filter(machine, plant, tuned, starts, largest_jerk, settings)
    if machine.requirements.every_size:
        choice = _choose_for_every_size(machine, strict, plant, tuned, near, largest_jerk, settings)
        if choice is not None:
            return choice
    found = search_listed(
        strict, plant, tuned, starts, largest_jerk=largest_jerk, settings=settings
    )
    judged = first_met(machine, strict, plant, tuned, found.proposals())
    if judged is None and strict is not machine:
        found = search_listed(
            machine, plant, tuned, starts, largest_jerk=largest_jerk, settings=settings
        )
        judged = first_met(machine, machine, plant, tuned, found.proposals())
    met = judged is not None
    candidate, moves = judged or soonest_possible(machine, plant, tuned, found)
    return Choice(
        candidate=candidate,
        moves=moves,
        reserve=machine.requirements.reserve,
        reserve_used=met and found.machine is not strict,
        explain=cache(partial(explain, found, candidate.limits, met)),
        chart=cache(
            partial(
                chart_landscape,
                machine,
                plant,
                tuned,
                candidate.limits,
                settings,
                widest=found.widest,
            )
        ),
        evaluations=len(found.pool.settling),
    )


def choose_for_listed(
    machine: Machine, plant: Plant, tuned: TunedLoop, *, settings: SearchSettings
) -> Candidate:
    """Return what would serve the listed sizes alone best, whatever smaller moves do.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    settings
        Of the search.

    Returns
    -------
    Candidate
        Judged on the listed sizes.
    """
    machine = replace(machine, requirements=replace(machine.requirements, every_size=False))
    return choose_limits(machine, plant, tuned, settings=settings).candidate


def _choose_filter(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    starts: Sequence[MotionLimits],
    largest_jerk: float,
    settings: SearchSettings,
) -> Choice:
    """The best choice over no setpoint filter and those that serve every size best.

    What serves every size with a filter serves the listed sizes, too: the search begins there.
    """
    strict = keep_reserve(machine)
    likely: dict[SetpointFilter | None, list[MotionLimits]] = {None: list(starts)}
    for item in search_every_size(strict, plant, tuned, largest_jerk=largest_jerk):
        own = MotionLimits(acceleration=item.acceleration, jerk=item.acceleration / item.jerk_time)
        likely.setdefault(item.setpoint_filter, [*starts]).append(own)
    choices = []
    for given, known in islice(likely.items(), 1 + LIKELY_FILTERS):
        control = replace(machine.control, setpoint_filter=given, seeks_setpoint_filter=False)
        choices.append(
            choose_limits(
                replace(machine, control=control),
                plant,
                tuned,
                starts=known,
                largest_jerk=largest_jerk,
                settings=settings,
            )
        )
    met = [choice for choice in choices if choice.meets_requirements] or choices
    return min(met, key=lambda choice: choice.candidate.settling_time)


LIKELY_FILTERS = 2
"""Setpoint filters that are tried for the listed sizes, the best for every size first."""


def _choose_for_every_size(
    machine: Machine,
    strict: Machine,
    plant: Plant,
    tuned: TunedLoop,
    near: MotionLimits | None,
    largest_jerk: float,
    settings: SearchSettings,
) -> Choice | None:
    """The limits and the filter that serve every smaller move, too.

    Where they only take longer than is wanted, they are still what may be typed in. None where no
    limits keep the rest.
    """
    late: Choice | None = None
    for allowed in dict.fromkeys((strict, machine)):
        typed = find_for_every_size(allowed, plant, tuned, largest_jerk=largest_jerk, near=near)
        if typed is None:
            continue
        moves = simulate_moves(machine, tuned, typed.limits)
        candidate = evaluate_moves(machine, plant, tuned, moves, sizes=typed.sizes)
        choice = Choice(
            candidate=candidate,
            moves=moves,
            reserve=machine.requirements.reserve,
            reserve_used=allowed is not strict,
            explain=cache(partial(_explain_sizes, allowed, plant, tuned, typed, largest_jerk)),
            chart=cache(partial(chart_landscape, machine, plant, tuned, typed.limits, settings)),
            evaluations=typed.evaluations,
        )
        if candidate.assessment.is_met:
            return choice
        missed = [item for item in candidate.assessment.checks if not item.is_met]
        if all(item.requirement == SETTLING_TIME for item in missed):
            late = late or choice
    return late


def _explain_sizes(
    machine: Machine, plant: Plant, tuned: TunedLoop, typed: Typed, largest_jerk: float
) -> Message:
    """Name what breaks at some size when either limit is raised a little."""
    limits, broken = typed.limits, dict[Requirement, None]()
    for a, j in RAISED:
        if j * limits.jerk > largest_jerk:
            return Message("bound-by-jerk-in-proportion", jerk=largest_jerk)
        raised = replace(limits, acceleration=a * limits.acceleration, jerk=j * limits.jerk)
        for check in judge_every_size(machine, plant, tuned, raised):
            if check.value > bound_of(machine, check.requirement):
                broken[check.requirement] = None
    motor = machine.drive.motion_force
    if not broken and machine.drive.follows and RAISED[0][0] * limits.acceleration > motor:
        return Message("bound-by-motor", acceleration=motor)
    if not broken:
        return Message("bound-by-settling-later")
    return Message(
        "bound-by-requirements", requirements=join_by_and([item.message for item in broken])
    )


RAISED = ((1.03, 1.03), (1.03, 1.0), (1.0, 1.03))
"""Factors of acceleration and jerk with which it is seen what forbids more."""
