"""Which loop is used: state feedback only where it pays at the same margins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

from mtcommission.limits.choose import choose_limits
from mtcommission.loop.tuning.tuned import TunedLoop, TuningSettings, has_margins
from mtcommission.loop.tuning.tuning import tune_loop, tune_variants
from mtcommission.machine.machine import Machine, StateFeedback
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import Settings
from mtcommission.verdict.evaluate import Candidate, evaluate


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopVariant:
    """The loop without or with state feedback, each with the limits that suit it best.

    Parameters
    ----------
    name
        Without or with state feedback.
    tuned
        The loop in every corner.
    candidate
        Its best limits by the coarser search, judged.
    is_used
        Whether everything else in the record uses this loop.
    """

    name: Message
    tuned: TunedLoop
    candidate: Candidate
    is_used: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopChoice:
    """Which loop is used, and what the other one would have done.

    Parameters
    ----------
    tuned
        The loop that is used.
    variants
        Empty where there was nothing to choose.
    remarks
        Settling time and stiffness of both, and what the control must offer.
    """

    tuned: TunedLoop
    variants: tuple[LoopVariant, ...] = ()
    remarks: tuple[Message, ...] = ()

    @property
    def model(self) -> Any:
        """The loop as a ``control.StateSpace`` to go on with, e.g. ``control.bode_plot``."""
        return self.tuned.model


def settle_on_loop(machine: Machine, plant: Plant, settings: Settings) -> LoopChoice:
    """Return the tuned loop, with state feedback only where that pays.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Numerical settings.

    Returns
    -------
    LoopChoice
    """
    if machine.control.state_feedback is not StateFeedback.AUTO:
        return LoopChoice(tuned=tune_loop(machine, settings=settings.tuning))
    found = tune_variants(machine, settings=settings.tuning)
    if found.feedback is None:
        return LoopChoice(tuned=found.plain)
    if found.is_needed:
        return LoopChoice(tuned=found.feedback, remarks=(NEEDS_STATE_FEEDBACK,))
    without = _try_loop(machine, plant, found.plain, settings, starts=())
    starts = (without.limits,)
    with_it = _try_loop(machine, plant, found.feedback, settings, starts=starts)
    helps = _pays(without, with_it, found.plain, found.feedback, settings.tuning)
    return LoopChoice(
        tuned=found.feedback if helps else found.plain,
        variants=(
            LoopVariant(name=WITHOUT, tuned=found.plain, candidate=without, is_used=not helps),
            LoopVariant(name=WITH, tuned=found.feedback, candidate=with_it, is_used=helps),
        ),
        remarks=(
            Message(
                "state-feedback-chosen" if helps else "state-feedback-left-out",
                with_it=_settling(with_it),
                without=_settling(without),
            ),
            Message(
                "state-feedback-stiffness",
                ratio=found.feedback.least_stiffness / found.plain.least_stiffness,
            ),
            *((NEEDS_STATE_FEEDBACK,) if helps else ()),
        ),
    )


WITHOUT, WITH = Message("without-state-feedback"), Message("with-state-feedback")

NEEDS_STATE_FEEDBACK = Message("control-needs-state-feedback")

SOONER = 0.98
STIFFER = 1.2
"""State feedback is worth its effort if the moves settle 2 % sooner (the coarser search is no
finer), or as soon with a tool that is 20 % stiffer (design choice)."""


def _pays(
    without: Candidate,
    with_it: Candidate,
    plain: TunedLoop,
    feedback: TunedLoop,
    settings: TuningSettings,
) -> bool:
    """Whether state feedback is used; a loop with poor margins, given as such, never wins."""
    if not all(has_margins(analysis, settings=settings) for analysis in plain.analyses):
        return True
    if with_it.settling_time < SOONER * without.settling_time:
        return True
    is_as_soon = SOONER * with_it.settling_time <= without.settling_time
    return is_as_soon and feedback.least_stiffness > STIFFER * plain.least_stiffness


def _try_loop(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    settings: Settings,
    *,
    starts: Sequence[MotionLimits],
) -> Candidate:
    """The limits that suit a loop best by the coarser search, judged."""
    choice = choose_limits(machine, plant, tuned, starts=starts, settings=settings.comparison)
    return evaluate(machine, plant, tuned, choice.limits)


def _settling(candidate: Candidate) -> Message:
    time = candidate.settling_time
    return Message("time-value", time=time) if isfinite(time) else Message("not-settled")
