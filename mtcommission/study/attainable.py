"""What limits other bounds than those asked for allow.

Where no limits meet the requirements: what could be asked for instead. Each requirement is relaxed
alone, the others kept: if limits are found then, that requirement is a limiting one, and the value
that those limits reach is what could be asked for. Where none helps alone, as few as possible are
relaxed together by one common factor, the least found to help.

For the machining modes surface, accuracy and speed: what each column of G-code gets. The loop is
linear: limits n times as large leave n times the deviation. So a mode with n times the band gets at
most n times the jerk of the recommendation; more would live on ramps so short that what they excite
is no longer in any model, for little time. A tighter band gets no more jerk than a wider one,
unless nothing else meets it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, sqrt

from mtcommission.limits.choose import Choice
from mtcommission.limits.explore import REFINED
from mtcommission.limits.judge import Candidate
from mtcommission.limits.requirements import (
    RESIDUAL_DEVIATION,
    Requirement,
    Yields,
    requirements_of,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirements import NO_RESERVE
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import STUDY
from mtcommission.study.variations import Row, judge, look

EASED = 1.0 + 1e-6
"""The bounds with which attained values are judged, over these values."""

MODES = ("surface", "accuracy", "speed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Attainable:
    """What could be met in place of one requirement, all others kept."""

    requirement: str  # named as in the verdict's checks
    limit: float  # what is asked for
    value: float  # the least that was found
    unit: str  # SI, of both
    limits: MotionLimits  # that reach it
    together_with: tuple[str, ...] = ()  # must give way, too; empty: it helps alone


def find_attainable(machine: Machine, tuned: TunedLoop, choice: Choice) -> tuple[Attainable, ...]:
    """Return what could be met in place of each requirement that stands in the way.

    Each one helps alone, with no reserve in the others; where none does, those that must give way
    together. Empty if not even that helps: then the force itself does not suffice.
    """
    needs = replace(machine.requirements, reserve=NO_RESERVE)
    machine = replace(machine, requirements=needs)
    # Whatever is asked for may give way but the drive's own limit, the band first.
    asked = [item for item in requirements_of(machine) if item.yields is not Yields.NEVER]
    asked.sort(key=lambda item: item != RESIDUAL_DEVIATION)
    alone = [one for item in asked for one in _ease(machine, tuned, [item], known=choice.limits)]
    if alone or _search(machine, tuned, asked, STUDY.largest_factor) is None:
        return tuple(alone)
    for item in list(asked):
        fewer = [other for other in asked if other != item]
        if fewer and _search(machine, tuned, fewer, STUDY.largest_factor):
            asked = fewer
    return tuple(_ease(machine, tuned, asked))


def find_least_residual(machine: Machine, tuned: TunedLoop) -> Attainable | None:
    """Return the least band that some limits keep with all the rest; None if none is found [m]."""
    return next(iter(_ease(machine, tuned, [RESIDUAL_DEVIATION])), None)


def _ease(
    machine: Machine,
    tuned: TunedLoop,
    wanted: Sequence[Requirement],
    *,
    known: MotionLimits | None = None,
) -> list[Attainable]:
    """What some requirements reach by the least factor that helps; empty if none does."""
    best = _search(machine, tuned, wanted, STUDY.largest_factor, known=known)
    if best is None:
        return []
    low, high = 1.0, STUDY.largest_factor
    if [item.yields for item in wanted] != [Yields.MINIMISED]:  # that is the least at once
        high = _largest_share(machine, wanted, best)
        for _ in range(STUDY.halvings):
            factor = sqrt(low * high)
            found = _search(machine, tuned, wanted, factor, known=known, near=best.limits)
            if found is None:
                low = factor
            else:
                high, best = factor, found
    eased, reached = machine, {item: best.assessment.check_of(item) for item in wanted}
    for item, check in reached.items():
        eased = item.with_bound(eased, EASED * check.value)
    # In a narrower band the same motion settles later: perhaps too late.
    is_kept = judge(Row(machine=eased, tuned=tuned, limits=best.limits)).assessment.is_met
    return [
        Attainable(
            requirement=item.key,
            limit=item.bound(machine),
            value=check.value if is_kept else high * item.bound(machine),
            unit=check.unit,
            limits=best.limits,
            together_with=tuple(other.key for other in wanted if other != item),
        )
        for item, check in reached.items()
    ]


def _search(
    machine: Machine,
    tuned: TunedLoop,
    wanted: Sequence[Requirement],
    factor: float,
    *,
    known: MotionLimits | None = None,
    near: MotionLimits | None = None,
) -> Candidate | None:
    """The limits that need least of what is relaxed by a factor; None where none meet the rest."""
    for item in wanted:
        machine = item.with_bound(machine, factor * item.bound(machine))
    row = Row(machine=machine, tuned=tuned, near=near, refined=1 if near else REFINED)
    seen = look(row)
    rows = [replace(row, found=seen)] if seen else []
    rows += [replace(row, limits=known)] if known else []
    found = [item for item in map(judge, rows) if item.assessment.is_met]
    return min(found, key=lambda item: _largest_share(machine, wanted, item), default=None)


def _largest_share(machine: Machine, wanted: Sequence[Requirement], item: Candidate) -> float:
    return max(item.assessment.check_of(one).value / one.bound(machine) for one in wanted)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeLimits:
    """Limits for one machining mode, from a band of its own; None where none meet all with it."""

    name: str  # one of ``MODES``
    band: float  # allowed residual deviation [m]
    meets_requirements: bool
    acceleration: float | None = None  # [m/s²]
    jerk: float | None = None  # [m/s³]
    jerk_time: float | None = None  # [s]
    settling_time: float | None = None  # slowest move, worst corner [s]
    attainable: float | None = None  # the band that could be asked for instead [m]


def find_limits_by_mode(
    machine: Machine, tuned: TunedLoop, choice: Choice
) -> tuple[ModeLimits, ...]:
    """Return limits for each machining mode; the recommendation where a mode has its band."""
    needs, own = machine.requirements, choice.limits.setpoint_filter
    # Controls switch limits with the mode, but have one setpoint filter for all of them.
    control = replace(
        machine.control,
        setpoint_filter=own or machine.control.setpoint_filter,
        seeks_setpoint_filter=False,
    )
    machine = replace(machine, control=control)
    shares = {name: float(getattr(needs.modes, name)) / needs.tcp_deviation for name in MODES}
    found: dict[str, ModeLimits] = {}
    largest = choice.limits.jerk
    # From the recommendation to ever tighter bands, then to ever wider ones.
    for name in sorted(MODES, key=lambda name: (shares[name] >= 1.0, abs(shares[name] - 1.0))):
        if shares[name] >= 1.0:
            largest = shares[name] * choice.limits.jerk
        most = largest if choice.meets_requirements else inf
        found[name] = _find_mode(machine, tuned, choice, name, most)
        largest = min(largest, found[name].jerk or inf)
    return tuple(found[name] for name in MODES)


def _find_mode(
    machine: Machine, tuned: TunedLoop, choice: Choice, name: str, largest_jerk: float
) -> ModeLimits:
    needs, candidate = machine.requirements, choice.candidate
    band: float = getattr(needs.modes, name)
    if band != needs.tcp_deviation:
        # A wider band's limits lie about the recommended ones, a tighter one's may lie anywhere.
        near = choice.limits if band > needs.tcp_deviation else None
        machine = RESIDUAL_DEVIATION.with_bound(machine, band)
        row = Row(machine=machine, tuned=tuned, near=near, largest_jerk=largest_jerk)
        candidate = judge(row)
        if not candidate.assessment.is_met and isfinite(largest_jerk):
            candidate = judge(replace(row, largest_jerk=inf))
    limits, is_met = candidate.limits, candidate.assessment.is_met
    if not is_met:
        least = find_least_residual(machine, tuned)
        other = least.value if least else None
        return ModeLimits(name=name, band=band, meets_requirements=False, attainable=other)
    return ModeLimits(
        name=name,
        band=band,
        meets_requirements=True,
        acceleration=limits.acceleration,
        jerk=limits.jerk,
        jerk_time=limits.jerk_time,
        settling_time=candidate.settling_time,
    )
