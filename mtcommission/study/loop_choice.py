"""Which loop is used: state feedback only where it pays at the same margins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any

from mtcommission.limits.choose import SearchSettings, choose_limits
from mtcommission.loop.tuning.tuned import TunedLoop, TuningSettings, has_margins
from mtcommission.loop.tuning.tuning import tune_loop, tune_variants
from mtcommission.machine.machine import Machine, StateFeedback
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.evaluate import Trial, judge
from mtcommission.study.robustness import RobustnessSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Numerical settings, all printed on the sheet.

    Parameters
    ----------
    tuning, search
        Of the loop's tuning and of the choice of limits.
    comparison
        The coarser search that decides whether state feedback pays.
    robustness
        How closely the recommendation is looked at where machine or limits differ.
    """

    tuning: TuningSettings = field(default_factory=TuningSettings)
    search: SearchSettings = field(default_factory=SearchSettings)
    comparison: SearchSettings = field(
        default_factory=lambda: SearchSettings(grid=32, coarse_grid=8, seeds=12, refinements=3)
    )
    robustness: RobustnessSettings = field(default_factory=RobustnessSettings)


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopVariant:
    """The loop without or with state feedback, each with the limits that suit it best.

    Parameters
    ----------
    name
        ``"without state feedback"`` or ``"with state feedback"``.
    tuned
        The loop in every corner.
    trial
        Its best limits by the coarser search, judged.
    is_used
        Whether everything else in the record uses this loop.
    """

    name: str
    tuned: TunedLoop
    trial: Trial
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
    """

    tuned: TunedLoop
    variants: tuple[LoopVariant, ...]

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
        The remarks of its loop state settling time and stiffness of both.
    """
    if machine.control.state_feedback is not StateFeedback.AUTO:
        return LoopChoice(tuned=tune_loop(machine, settings=settings.tuning), variants=())
    found = tune_variants(machine, settings=settings.tuning)
    if found.feedback is None:
        return LoopChoice(tuned=found.plain, variants=())
    if found.is_needed:
        remarks = (*found.feedback.remarks, Message("verbatim", text=NEEDS_STATE_FEEDBACK))
        return LoopChoice(tuned=replace(found.feedback, remarks=remarks), variants=())
    without = _try_loop(machine, plant, WITHOUT, found.plain, settings, starts=())
    starts = (without.limits,)
    with_it = _try_loop(machine, plant, WITH, found.feedback, settings, starts=starts)
    helps = _pays(without, with_it, found.plain, found.feedback, settings.tuning)
    kept = found.feedback if helps else found.plain
    variants = tuple(
        LoopVariant(name=trial.name, tuned=loop, trial=trial, is_used=loop is kept)
        for trial, loop in ((without, found.plain), (with_it, found.feedback))
    )
    verdict = (
        f"Best settling time {_milliseconds(with_it.settling_time)} with it, "
        f"{_milliseconds(without.settling_time)} without it: "
        f"it is {'used' if helps else 'left out'}."
    )
    ratio = found.feedback.least_stiffness / found.plain.least_stiffness
    stiffness = f"With it the tool is {ratio:.3g} times as stiff against a disturbance."
    hint = f" {NEEDS_STATE_FEEDBACK}" if helps else ""
    remarks = (*kept.remarks, Message("verbatim", text=f"{verdict} {stiffness}{hint}"))
    return LoopChoice(tuned=replace(kept, remarks=remarks), variants=variants)


WITHOUT, WITH = "without state feedback", "with state feedback"

NEEDS_STATE_FEEDBACK = (
    'The control must offer state feedback; if yours does not, set state_feedback = "off".'
)

SOONER = 0.98
STIFFER = 1.2
"""State feedback is worth its effort if the moves settle 2 % sooner (the coarser search is no
finer), or as soon with a tool that is 20 % stiffer (design choice)."""


def _pays(
    without: Trial,
    with_it: Trial,
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
    name: str,
    tuned: TunedLoop,
    settings: Settings,
    *,
    starts: Sequence[MotionLimits],
) -> Trial:
    """The limits that suit a loop best by the coarser search, judged."""
    choice = choose_limits(machine, plant, tuned, starts=starts, settings=settings.comparison)
    return judge(machine, plant, tuned, name, "coarser search", choice.limits)


def _milliseconds(time: float) -> str:
    return f"{1e3 * time:.4g} ms" if isfinite(time) else "not settled"
