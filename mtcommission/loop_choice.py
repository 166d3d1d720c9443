"""Which loop is used: state feedback only where it lets the moves settle sooner."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import isfinite

from mtcommission.choose import SearchSettings, choose_limits
from mtcommission.loop.tuning import TunedLoop, TuningSettings, tune_loop
from mtcommission.machine import Machine, StateFeedback
from mtcommission.plant import Plant
from mtcommission.robustness import RobustnessSettings
from mtcommission.trials import Trial, judge


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


def settle_on_loop(machine: Machine, plant: Plant, settings: Settings) -> LoopChoice:
    """Return the tuned loop, with state feedback only where it lets the move settle sooner.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Numerical settings.

    Returns
    -------
    LoopChoice
        The remarks of its loop state both settling times.
    """
    tuned = tune_loop(machine, settings=settings.tuning)
    if machine.control.state_feedback is not StateFeedback.AUTO:
        return LoopChoice(tuned=tuned, variants=())
    off = replace(machine, control=replace(machine.control, state_feedback=StateFeedback.OFF))
    plain = tune_loop(off, settings=settings.tuning)
    if not tuned.controller.state_gains.any():
        kept = replace(plain, remarks=(*plain.remarks, tuned.remarks[-1]))
        return LoopChoice(tuned=kept, variants=())
    trials = []
    for name, loop in (("without state feedback", plain), ("with state feedback", tuned)):
        limits = choose_limits(machine, plant, loop, settings=settings.comparison).limits
        trials.append(judge(machine, plant, loop, name, "coarser search", limits))
    helps = trials[1].settling_time < trials[0].settling_time
    verdict = (
        f"Best settling time {_milliseconds(trials[1].settling_time)} with it, "
        f"{_milliseconds(trials[0].settling_time)} without it: "
        f"it is {'used' if helps else 'left out'}."
    )
    kept = tuned if helps else plain
    variants = tuple(
        LoopVariant(name=trial.name, tuned=loop, trial=trial, is_used=loop is kept)
        for trial, loop in zip(trials, (plain, tuned), strict=True)
    )
    remarks = (*plain.remarks, tuned.remarks[-1], verdict)
    return LoopChoice(tuned=replace(kept, remarks=remarks), variants=variants)


def _milliseconds(time: float) -> str:
    return f"{1e3 * time:.4g} ms" if isfinite(time) else "not settled"
