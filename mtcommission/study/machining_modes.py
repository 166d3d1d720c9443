"""Limits for the machining modes surface, accuracy and speed, each from a band of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mtcommission.limits.choose import Choice, SearchSettings, choose_limits
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.attainable import Attainable, find_least_residual
from mtcommission.verdict.evaluate import Candidate, evaluate

NO_LIMITS = Message("no-limits-with-this-band")
"""Why a mode has no values."""

MODES = ("surface", "accuracy", "speed")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeLimits:
    """Limits for one machining mode, from a band of its own.

    Parameters
    ----------
    name
        One of ``MODES``.
    band
        Allowed residual deviation [m].
    choice, candidate
        The search with this band, and its result judged with it.
    attainable
        Where that result does not meet all requirements, it is no recommendation: the least
        residual deviation that was found with the others kept; None if met, or if there is none.
    """

    name: str
    band: float
    choice: Choice
    candidate: Candidate
    attainable: Attainable | None


def find_limits_by_mode(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    choice: Choice,
    *,
    starts: Sequence[MotionLimits],
    settings: SearchSettings,
) -> tuple[ModeLimits, ...]:
    """Return limits for each machining mode.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    choice
        The recommendation; reused where a mode has the same band.
    starts
        Limits to refine from.
    settings
        Of the search.

    Returns
    -------
    tuple of ModeLimits
    """
    found = []
    for name in MODES:
        band: float = getattr(machine.requirements.modes, name)
        needs = replace(machine.requirements, tcp_deviation=band)
        other = replace(machine, requirements=needs)
        chosen = choice
        if band != machine.requirements.tcp_deviation:
            chosen = choose_limits(other, plant, tuned, starts=starts, settings=settings)
        candidate = evaluate(other, plant, tuned, chosen.limits)
        attainable = None
        if not candidate.assessment.is_met:
            attainable = find_least_residual(other, plant, tuned, chosen)
        found.append(
            ModeLimits(
                name=name, band=band, choice=chosen, candidate=candidate, attainable=attainable
            )
        )
    return tuple(found)
