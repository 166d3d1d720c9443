"""Limits for the machining modes surface, accuracy and speed: what each column of G-code gets.

The loop is linear: limits n times as large leave n times the deviation. So a mode with n times the
band gets at most n times the jerk of the recommendation; more would live on ramps so short that
what they excite is no longer in any model, for little time. A tighter band gets no more jerk than
a wider one, unless nothing else meets it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.judge import Candidate
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.study.attainable import Attainable, find_least_residual

NO_LIMITS = Message("no-limits-with-this-band")
"""Why a mode has no values."""

MODES = ("surface", "accuracy", "speed")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeLimits:
    """Limits for one machining mode, from a band of its own."""

    name: str  # one of ``MODES``
    band: float  # allowed residual deviation [m]
    choice: Choice  # the search with this band, judged with it
    bound_by: Message  # what forbids faster limits
    attainable: Attainable | None  # the least residual found where no limits meet all requirements

    @property
    def candidate(self) -> Candidate:
        """The limits, judged with this band."""
        return self.choice.candidate


def find_limits_by_mode(
    machine: Machine, plant: Plant, tuned: TunedLoop, choice: Choice
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
    bands: dict[str, float] = {name: getattr(needs.modes, name) for name in MODES}
    # From the recommendation to ever tighter bands, then to ever wider ones.
    tighter = [name for name in MODES if bands[name] < needs.tcp_deviation]
    wider = [name for name in MODES if bands[name] >= needs.tcp_deviation]
    tighter.sort(key=lambda name: -bands[name])
    wider.sort(key=lambda name: bands[name])
    found: dict[str, ModeLimits] = {}
    largest = choice.limits.jerk
    for name in (*tighter, *wider):
        if name in wider:
            largest = choice.limits.jerk * bands[name] / needs.tcp_deviation
        most = largest if choice.meets_requirements else inf
        mode = _find_mode(machine, plant, tuned, choice, name, bands[name], most)
        if mode.candidate.assessment.is_met:
            largest = min(largest, mode.candidate.limits.jerk)
        found[name] = mode
    return tuple(found[name] for name in MODES)


def _find_mode(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    choice: Choice,
    name: str,
    band: float,
    largest_jerk: float,
) -> ModeLimits:
    chosen, bound_by = choice, choice.bound_by
    if band != machine.requirements.tcp_deviation:
        machine = replace(machine, requirements=replace(machine.requirements, tcp_deviation=band))
        chosen = choose_limits(machine, plant, tuned, largest_jerk=largest_jerk)
        bound_by = chosen.bound_by
        if not chosen.meets_requirements and isfinite(largest_jerk):
            chosen = choose_limits(machine, plant, tuned)
            bound_by = Message("bound-by-less-jerk-meets-nothing", jerk=largest_jerk)
    attainable = None
    if not chosen.meets_requirements:
        attainable = find_least_residual(machine, plant, tuned)
    return ModeLimits(name=name, band=band, choice=chosen, bound_by=bound_by, attainable=attainable)
