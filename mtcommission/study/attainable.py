"""Where no limits meet the requirements: what could be asked for instead.

Each requirement is relaxed alone, the others kept: if limits are found then, that requirement is a
limiting one, and the value that those limits reach is what could be asked for. Where none helps
alone, as few as possible are relaxed together by one common factor, the least found to help.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, sqrt
from typing import TypeVar

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.judge import Candidate, evaluate
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import NO_RESERVE, Machine
from mtcommission.plant.plant import Plant
from mtcommission.requirements.register import requirements_of
from mtcommission.requirements.requirement import Requirement, Yields
from mtcommission.requirements.residual_deviation import RESIDUAL_DEVIATION
from mtcommission.setpoint.motion_limits import MotionLimits

Found = TypeVar("Found")

HALVINGS = 5
"""Of the range between the bound asked for and the one that is surely met, logarithmic."""

LARGEST_FACTOR, COMMON_HALVINGS = 1e3, 6
"""By which requirements are relaxed together at most (what needs more is no requirement), and
halvings of its range: the common factor is found to within 12 %."""

EASED = 1.0 + 1e-6
"""The band with which least residuals are judged, over the residual itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attainable:
    """What could be met in place of one requirement, all others kept."""

    requirement: Requirement
    limit: float  # what is asked for
    value: float  # the least that was found
    unit: str  # SI, of both
    limits: MotionLimits  # that reach it
    together_with: tuple[Requirement, ...] = ()  # must give way, too; empty: it helps alone


def _relaxable(machine: Machine) -> list[Requirement]:
    """What may give way beside the band: all that is asked for but the drive's own limit."""
    asked = requirements_of(machine)
    return [r for r in asked if r != RESIDUAL_DEVIATION and r.yields is not Yields.NEVER]


def find_attainable(
    machine: Machine, plant: Plant, tuned: TunedLoop, choice: Choice
) -> tuple[Attainable, ...]:
    """Return what could be met in place of each requirement that stands in the way.

    Each one helps alone, with no reserve in the others; where none does, those that must give way
    together. Empty if not even that helps: then the force itself does not suffice.
    """
    needs = replace(machine.requirements, reserve=NO_RESERVE)
    machine = replace(machine, requirements=needs)
    found = [
        find_least_residual(machine, plant, tuned),
        *(
            _relax_alone(machine, plant, tuned, item, known=choice.limits)
            for item in _relaxable(machine)
        ),
    ]
    alone = tuple(item for item in found if item is not None)
    return alone or _relax_together(machine, plant, tuned)


def find_least_residual(machine: Machine, plant: Plant, tuned: TunedLoop) -> Attainable | None:
    """Return the least band that some limits keep with all the rest; None if none is found [m].

    The wider the band, the sooner the search's limits settle: the least is found by halving.
    """
    band = RESIDUAL_DEVIATION.bound(machine)

    def search(factor: float) -> Attainable | None:
        candidate = _choose(RESIDUAL_DEVIATION.with_bound(machine, factor * band), plant, tuned)
        if candidate is None:
            return None
        found = _attained(candidate, RESIDUAL_DEVIATION, limit=band)
        # In a narrower band the same motion settles later: perhaps too late.
        narrow = RESIDUAL_DEVIATION.with_bound(machine, EASED * found.value)
        is_met = evaluate(narrow, plant, tuned, found.limits).assessment.is_met
        return found if is_met else replace(found, value=factor * band)

    return _least(search)


def _least(search: Callable[[float], Found | None]) -> Found | None:
    """What is found with the least factor that helps, to within 12 %; None if none does."""
    low, high, best = 1.0, LARGEST_FACTOR, search(LARGEST_FACTOR)
    for _ in range(COMMON_HALVINGS if best is not None else 0):
        factor = sqrt(low * high)
        found = search(factor)
        if found is None:
            low = factor
        else:
            high, best = factor, found
    return best


def _relax_alone(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    requirement: Requirement,
    *,
    known: MotionLimits,
) -> Attainable | None:
    """The least value found for one requirement; None if dropping it does not help."""

    def search(bound: float) -> Attainable | None:
        eased = requirement.with_bound(machine, bound)
        chosen = choose_limits(eased, plant, tuned).limits
        attained = [
            _attained(evaluate(machine, plant, tuned, limits), requirement)
            for limits in (chosen, known)
            if evaluate(eased, plant, tuned, limits).assessment.is_met
        ]
        return min(attained, key=lambda item: item.value, default=None)

    best = search(inf)
    if best is None or requirement.yields is Yields.MINIMISED:
        return best
    low = requirement.bound(machine)
    for _ in range(HALVINGS):
        middle = sqrt(low * best.value)
        found = search(middle)
        if found is None:
            low = middle
        else:
            best = found
    return best


def _relax_together(machine: Machine, plant: Plant, tuned: TunedLoop) -> tuple[Attainable, ...]:
    """What could be met if several requirements give way by one factor; empty if nothing helps."""

    def search(wanted: Sequence[Requirement], factor: float) -> Candidate | None:
        eased = machine
        for item in wanted:
            eased = item.with_bound(eased, factor * item.bound(machine))
        return _choose(eased, plant, tuned)

    wanted = (RESIDUAL_DEVIATION, *_relaxable(machine))
    best = search(wanted, LARGEST_FACTOR)
    if best is None:
        return ()
    for each in wanted:
        fewer = tuple(other for other in wanted if other != each)
        candidate = search(fewer, LARGEST_FACTOR) if fewer else None
        if candidate is not None:
            wanted, best = fewer, candidate
    best = _least(lambda factor: search(wanted, factor)) or best
    return tuple(
        replace(
            _attained(best, item, limit=item.bound(machine)),
            together_with=tuple(other for other in wanted if other != item),
        )
        for item in wanted
    )


def _choose(machine: Machine, plant: Plant, tuned: TunedLoop) -> Candidate | None:
    """The search's limits, judged; None where they do not meet what is asked for."""
    candidate = choose_limits(machine, plant, tuned).candidate
    return candidate if candidate.assessment.is_met else None


def _attained(
    candidate: Candidate, requirement: Requirement, *, limit: float | None = None
) -> Attainable:
    check = candidate.assessment.check_of(requirement)
    return Attainable(
        requirement=requirement,
        limit=check.limit if limit is None else limit,
        value=check.value,
        unit=check.unit,
        limits=candidate.limits,
    )
