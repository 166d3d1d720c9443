"""Where no limits meet the requirements: which requirement is in the way, and what could be met.

Each requirement is relaxed alone, the others kept: if limits are found then, that requirement is
a limiting one, and the value that those limits reach is what could be asked for instead. Where none
helps alone, several hold the limits back together: as few as possible are then relaxed by one
common factor, the least that is found to help.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf, sqrt
from typing import TypeVar

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import NO_RESERVE, Machine
from mtcommission.plant.plant import Plant
from mtcommission.requirements.register import requirements_of
from mtcommission.requirements.requirement import Requirement, Yields
from mtcommission.requirements.residual_deviation import RESIDUAL_DEVIATION
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verdict.evaluate import Candidate, evaluate

T = TypeVar("T")

HALVINGS = 5
"""Of the range between the bound asked for and the one that is surely met, logarithmic."""

EASED = 1.0 + 1e-6
"""The band with which least residuals are judged, over the residual itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attainable:
    """What could be met in place of one requirement, all others kept.

    Parameters
    ----------
    requirement
        As in the verdict.
    limit
        What is asked for.
    value
        What was reached (the least that was found).
    unit
        SI unit of both.
    limits
        Acceleration and jerk that reach it.
    together_with
        Requirements that must give way, too (own entries); empty if it helps alone.
    """

    requirement: Requirement
    limit: float
    value: float
    unit: str
    limits: MotionLimits
    together_with: tuple[Requirement, ...] = ()


def find_attainable(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    choice: Choice,
) -> tuple[Attainable, ...]:
    """Return what could be met in place of each requirement that stands in the way.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    choice
        The search that met not all requirements.

    Returns
    -------
    tuple of Attainable
        Each one helps alone, with no reserve in the others; where none does, those that must
        give way together. Empty if not even that helps: then the force itself does not suffice.
    """
    machine = _without_reserve(machine)
    residual = find_least_residual(machine, plant, tuned)
    found = [] if residual is None else [residual]
    for requirement in _relaxed(machine):
        attained = _relax(machine, plant, tuned, requirement, known=choice.limits)
        if attained is not None:
            found.append(attained)
    return tuple(found) or _find_together(machine, plant, tuned)


def find_least_residual(machine: Machine, plant: Plant, tuned: TunedLoop) -> Attainable | None:
    """Return the least band that some limits keep with all the rest; None if none is found [m].

    The wider the band, the sooner the search's limits settle: the least is found by halving.
    """
    band = RESIDUAL_DEVIATION.bound(machine)

    def search(factor: float) -> Attainable | None:
        eased = RESIDUAL_DEVIATION.with_bound(machine, factor * band)
        candidate = evaluate(eased, plant, tuned, choose_limits(eased, plant, tuned).limits)
        if not candidate.assessment.is_met:
            return None
        found = replace(_attained(candidate, RESIDUAL_DEVIATION), limit=band)
        # In a narrower band the same motion settles later: perhaps too late.
        narrow = RESIDUAL_DEVIATION.with_bound(machine, EASED * found.value)
        left = evaluate(narrow, plant, tuned, found.limits)
        wide = candidate.assessment.check_of(RESIDUAL_DEVIATION).limit
        return found if left.assessment.is_met else replace(found, value=wide)

    return _least(search)


def _least(search: Callable[[float], T | None]) -> T | None:
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


def _without_reserve(machine: Machine) -> Machine:
    return replace(machine, requirements=replace(machine.requirements, reserve=NO_RESERVE))


def _relaxed(machine: Machine) -> Iterator[Requirement]:
    """Yield what can give way beside the band."""
    for requirement in requirements_of(machine):
        if requirement != RESIDUAL_DEVIATION and requirement.yields is not Yields.NEVER:
            yield requirement


def _relax(
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
        found = choose_limits(eased, plant, tuned).limits
        attained = [
            _attained(evaluate(machine, plant, tuned, limits), requirement)
            for limits in (found, known)
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


LARGEST_FACTOR = 1e3
"""By which requirements are relaxed together at most: what needs more is no requirement."""

COMMON_HALVINGS = 6
"""Of the range of the common factor, logarithmic: it is found to within 12 %."""


def _find_together(machine: Machine, plant: Plant, tuned: TunedLoop) -> tuple[Attainable, ...]:
    """What could be met if several requirements give way by one factor; empty if nothing helps."""
    relaxed = (RESIDUAL_DEVIATION, *_relaxed(machine))

    def search(wanted: Sequence[Requirement], factor: float) -> Candidate | None:
        eased = machine
        for item in wanted:
            eased = item.with_bound(eased, factor * item.bound(machine))
        limits = choose_limits(eased, plant, tuned).limits
        candidate = evaluate(eased, plant, tuned, limits)
        return candidate if candidate.assessment.is_met else None

    wanted = relaxed
    best = search(wanted, LARGEST_FACTOR)
    if best is None:
        return ()
    for each in wanted:
        fewer = tuple(other for other in wanted if other != each)
        candidate = search(fewer, LARGEST_FACTOR) if fewer else None
        if candidate is not None:
            wanted, best = fewer, candidate
    best = _least(partial(search, wanted)) or best
    return tuple(
        replace(
            _attained(best, item),
            limit=item.bound(machine),
            together_with=tuple(other for other in wanted if other != item),
        )
        for item in wanted
    )


def _attained(candidate: Candidate, requirement: Requirement) -> Attainable:
    check = candidate.assessment.check_of(requirement)
    return Attainable(
        requirement=requirement,
        limit=check.limit,
        value=check.value,
        unit=check.unit,
        limits=candidate.limits,
    )
