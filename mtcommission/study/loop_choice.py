"""Which loop is used: the stiffest of those that let the moves settle soonest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, pi
from typing import Any

from mtcommission.limits.choose import choose_limits
from mtcommission.loop.tuning.cascade import CLASSIC, Shape
from mtcommission.loop.tuning.force_filters import find_filters
from mtcommission.loop.tuning.proposals import (
    LoopFamily,
    Proposal,
    Proposals,
    cascade_family,
    feedback_family,
    feedback_shapes,
    propose_cascades,
    propose_feedback,
    propose_near,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import finish, require_bandwidth, tune_loop
from mtcommission.machine.machine import FilterKind, ForceFilter, Machine, StateFeedback
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import Settings
from mtcommission.verdict.evaluate import Candidate

LATER = 0.03
"""What a stiffer tool may cost in settling time (design choice)."""

SOONER = 0.98
STIFFER = 1.2
"""State feedback is worth its effort if the moves settle 2 % sooner (the coarser search is no
finer), or as soon with a tool that is 20 % stiffer (design choice)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopTrial:
    """A loop with the limits that suit it best.

    Parameters
    ----------
    shape
        Kv and Tn over Kp.
    tuned
        The loop in every corner.
    candidate
        Its best limits by the coarser search, judged.
    is_classic, is_used
        Whether it is the cascade by the classic rule, and whether everything else in the record
        uses it.
    """

    shape: Shape
    tuned: TunedLoop
    candidate: Candidate
    is_classic: bool
    is_used: bool = False


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
    """Which loop is used, and what others would have done.

    Parameters
    ----------
    tuned
        The loop that is used.
    trials
        The loops that were tried, soonest first; empty where there was nothing to choose.
    variants
        The best loop without and with state feedback; empty where only one was sought.
    remarks
        Why this loop, and what the control must offer.
    """

    tuned: TunedLoop
    trials: tuple[LoopTrial, ...] = ()
    variants: tuple[LoopVariant, ...] = ()
    remarks: tuple[Message, ...] = ()

    @property
    def model(self) -> Any:
        """The loop as a ``control.StateSpace`` to go on with, e.g. ``control.bode_plot``."""
        return self.tuned.model


@dataclass(frozen=True, slots=True, kw_only=True)
class _Search:
    """What was proposed, and what came of it.

    Parameters
    ----------
    proposals, trials
        All of the proposals were tried, and those near the best of them.
    """

    proposals: Proposals
    trials: tuple[LoopTrial, ...]

    @property
    def best(self) -> LoopTrial | None:
        """The one that serves the moves best; None if there is none."""
        return pick_loop(self.trials)

    def use(self, trial: LoopTrial, *, among: Sequence[LoopTrial] = ()) -> LoopChoice:
        """The choice of one of the trials, listed beside all others, soonest first."""
        listed = [replace(item, is_used=item is trial) for item in (*self.trials, *among)]
        listed.sort(key=lambda item: item.candidate.settling_time)
        tuned = finish(self.proposals.family, trial.tuned)
        return LoopChoice(tuned=tuned, trials=tuple(listed), remarks=_explain(trial, listed))


def settle_on_loop(machine: Machine, plant: Plant, settings: Settings) -> LoopChoice:
    """Return the loop that serves the moves best, with state feedback only where that pays.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Numerical settings.

    Returns
    -------
    LoopChoice
        By the rule of ``pick_loop``; by the classic rule where given gains keep no margins.

    Raises
    ------
    ComputationError
        As ``tune_loop``.
    """
    if machine.drive.follows:
        return LoopChoice(tuned=tune_loop(machine))
    choice = _choose(machine, plant, settings)
    if machine.control.seeks_force_filters:
        return _with_filters(machine, plant, choice, settings)
    return choice


def _choose(machine: Machine, plant: Plant, settings: Settings) -> LoopChoice:
    cascades = propose_cascades(cascade_family(machine, settings.tuning))
    found = _try_all(machine, plant, settings, cascades)
    if machine.control.state_feedback is StateFeedback.AUTO:
        return _weigh_state_feedback(machine, plant, settings, found)
    if found.best is not None:
        return found.use(found.best)
    require_bandwidth(machine, cascades.fastest_hz or inf)
    return LoopChoice(tuned=tune_loop(machine, settings=settings.tuning))


def pick_loop(trials: Sequence[LoopTrial]) -> LoopTrial | None:
    """Return the stiffest loop of those whose moves settle nearly as soon as any.

    Parameters
    ----------
    trials
        Those that meet the requirements count, if any does.

    Returns
    -------
    LoopTrial or None
        None of none.
    """
    good = [item for item in trials if item.candidate.assessment.is_met] or trials
    soonest = min((item.candidate.settling_time for item in good), default=inf)
    near = [item for item in good if item.candidate.settling_time <= (1.0 + LATER) * soonest]
    return max(near, key=lambda item: item.tuned.least_stiffness, default=None)


def show_alternatives(
    machine: Machine, plant: Plant, choice: LoopChoice, settings: Settings
) -> LoopChoice:
    """Return the same choice with what filters and state feedback would add where not used.

    Parameters
    ----------
    machine, plant, settings
        As for ``settle_on_loop``.
    choice
        The loop that is used stays.

    Returns
    -------
    LoopChoice
    """
    if machine.drive.follows:
        return choice
    if not machine.control.seeks_force_filters:
        choice = _with_filters(machine, plant, choice, settings)
    return show_state_feedback(machine, plant, choice, settings)


def _with_filters(
    machine: Machine, plant: Plant, choice: LoopChoice, settings: Settings
) -> LoopChoice:
    """The choice with a remark on filters of the set force that let Kp rise, used if asked for."""
    control = machine.control
    used = next((item for item in choice.trials if item.is_used), None)
    if used is None or control.kind.force_filters == 0:
        return choice
    family: LoopFamily | None = cascade_family(machine, settings.tuning)
    if used.shape.mode_weight:
        family = feedback_family(cascade_family(machine, settings.tuning))
    found = find_filters(family, used.shape, used.tuned) if family else None
    if found is None:
        return replace(choice, remarks=(*choice.remarks, Message("loop-no-filters")))
    after = _best_limits(machine, plant, settings, found.tuned, (used.candidate.limits,))
    if after.settling_time > (1.0 + LATER) * used.candidate.settling_time:
        return replace(choice, remarks=(*choice.remarks, Message("loop-no-filters")))
    seeks = control.seeks_force_filters
    remark = Message(
        "loop-filters-used" if seeks else "loop-filters-suggested",
        filters=tuple(map(_name_filter, found.filters)),
        Kp=used.tuned.controller.velocity_gain,
        higher=found.tuned.controller.velocity_gain,
        stiffness=used.tuned.least_stiffness,
        stiffer=found.tuned.least_stiffness,
        settling=_settling(used.candidate),
        settling_after=_settling(after),
    )
    choice = replace(choice, remarks=(*choice.remarks, remark))
    if not seeks:
        return choice
    filtered = replace(used, tuned=found.tuned, candidate=after, is_classic=False)
    trials = [filtered, *(replace(item, is_used=False) for item in choice.trials)]
    trials.sort(key=lambda item: item.candidate.settling_time)
    tuned = finish(found.family, found.tuned)
    return replace(choice, tuned=tuned, trials=tuple(trials), variants=())


def _name_filter(item: ForceFilter) -> Message:
    frequency = item.natural_frequency / (2.0 * pi)
    if item.kind is FilterKind.LOW_PASS:
        return Message("loop-filter-low-pass", frequency=frequency, damping=item.damping)
    return Message("loop-filter-notch", frequency=frequency, damping=item.damping, width=item.width)


def show_state_feedback(
    machine: Machine, plant: Plant, choice: LoopChoice, settings: Settings
) -> LoopChoice:
    """Return the same choice with what state feedback would add where it is not used.

    Parameters
    ----------
    machine, plant, settings
        As for ``settle_on_loop``.
    choice
        The loop that is used stays.

    Returns
    -------
    LoopChoice
        With variants, unless the sensors see no mode or nothing keeps the margins.
    """
    if choice.variants or choice.tuned.controller.state_gains.any():
        return choice
    used = next((item for item in choice.trials if item.is_used), None)
    classic = next((item.tuned for item in choice.trials if item.is_classic), None)
    shape = used.shape if used else CLASSIC
    found = propose_feedback(cascade_family(machine, settings.tuning), classic, [shape])
    if found.remark is not None:
        return replace(choice, remarks=(*choice.remarks, found.remark))
    without = used.candidate if used else _best_limits(machine, plant, settings, choice.tuned, ())
    trials = [
        LoopTrial(
            shape=item.shape,
            tuned=item.tuned,
            candidate=_best_limits(machine, plant, settings, item.tuned, (without.limits,)),
            is_classic=False,
        )
        for item in found.loops
    ]
    best = min(trials, key=lambda item: item.candidate.settling_time)
    remark = Message(
        "state-feedback-would",
        with_it=_settling(best.candidate),
        without=_settling(without),
        ratio=best.tuned.least_stiffness / choice.tuned.least_stiffness,
    )
    return replace(
        choice,
        variants=(
            LoopVariant(name=WITHOUT, tuned=choice.tuned, candidate=without, is_used=True),
            LoopVariant(name=WITH, tuned=best.tuned, candidate=best.candidate, is_used=False),
        ),
        remarks=(*choice.remarks, remark),
    )


WITHOUT, WITH = Message("without-state-feedback"), Message("with-state-feedback")

NEEDS_STATE_FEEDBACK = Message("control-needs-state-feedback")


def _weigh_state_feedback(
    machine: Machine, plant: Plant, settings: Settings, plain: _Search
) -> LoopChoice:
    """The best loop with state feedback, if it pays, or if there is none without."""
    cascades, without = plain.proposals, plain.best
    shapes = feedback_shapes(settings.tuning, near=without.shape if without else CLASSIC)
    proposals = propose_feedback(cascades.family, cascades.classic, shapes)
    found = _try_all(machine, plant, settings, proposals)
    with_it = found.best
    if with_it is None and without is None:
        require_bandwidth(machine, max(cascades.fastest_hz, proposals.fastest_hz) or inf)
        return LoopChoice(tuned=tune_loop(machine, settings=settings.tuning))
    if with_it is None:
        assert without is not None
        choice = plain.use(without)
        why_not = (proposals.remark,) if proposals.remark else ()
        return replace(choice, remarks=(*choice.remarks, *why_not))
    if without is None:
        choice = found.use(with_it)
        return replace(choice, remarks=(*choice.remarks, NEEDS_STATE_FEEDBACK))
    helps = _pays(without, with_it)
    if helps:
        choice = found.use(with_it, among=plain.trials)
    else:
        choice = plain.use(without, among=found.trials)
    remarks = (
        Message(
            "state-feedback-chosen" if helps else "state-feedback-left-out",
            with_it=_settling(with_it.candidate),
            without=_settling(without.candidate),
        ),
        Message(
            "state-feedback-stiffness",
            ratio=with_it.tuned.least_stiffness / without.tuned.least_stiffness,
        ),
        *((NEEDS_STATE_FEEDBACK,) if helps else ()),
    )
    pairs = ((WITHOUT, without, not helps), (WITH, with_it, helps))
    return replace(
        choice,
        variants=tuple(
            LoopVariant(name=name, tuned=item.tuned, candidate=item.candidate, is_used=is_used)
            for name, item, is_used in pairs
        ),
        remarks=(*choice.remarks, *remarks),
    )


def _pays(without: LoopTrial, with_it: LoopTrial) -> bool:
    """Whether state feedback is used."""
    before, after = without.candidate.settling_time, with_it.candidate.settling_time
    if after < SOONER * before:
        return True
    is_as_soon = SOONER * after <= before
    return is_as_soon and with_it.tuned.least_stiffness > STIFFER * without.tuned.least_stiffness


def _try_all(machine: Machine, plant: Plant, settings: Settings, proposals: Proposals) -> _Search:
    """What the moves make of each proposal, and of those near the best one."""
    trials: list[LoopTrial] = []
    starts: tuple[MotionLimits, ...] = ()

    def attempt(proposal: Proposal) -> None:
        nonlocal starts
        tuned = proposal.tuned
        found = _best_limits(machine, plant, settings, tuned, starts)
        starts = starts or (found.limits,)
        is_classic = tuned is proposals.classic
        trials.append(
            LoopTrial(shape=proposal.shape, tuned=tuned, candidate=found, is_classic=is_classic)
        )

    for proposal in proposals.loops:
        attempt(proposal)
    best = pick_loop(trials)
    if best is not None:
        for proposal in propose_near(proposals, best.shape):
            attempt(proposal)
    return _Search(proposals=proposals, trials=tuple(trials))


def _best_limits(
    machine: Machine,
    plant: Plant,
    settings: Settings,
    tuned: TunedLoop,
    starts: Sequence[MotionLimits],
) -> Candidate:
    """The limits that suit a loop best by the coarser search, judged."""
    near = starts[0] if starts else None
    found = choose_limits(
        machine, plant, tuned, starts=starts, near=near, settings=settings.comparison
    )
    return found.candidate


def _explain(used: LoopTrial, trials: Sequence[LoopTrial]) -> tuple[Message, ...]:
    """Why a loop is used, and what the classic rule's would do."""
    if len(trials) < 2:
        return ()
    reason = Message(
        "loop-chosen",
        number=len(trials),
        later=LATER,
        settling=_settling(used.candidate),
        stiffness=used.tuned.least_stiffness,
        soonest=_settling(min(trials, key=lambda item: item.candidate.settling_time).candidate),
    )
    classic = [
        Message(
            "loop-by-classic-rule",
            settling=_settling(item.candidate),
            stiffness=item.tuned.least_stiffness,
        )
        for item in trials
        if item.is_classic and not item.is_used
    ]
    return (reason, *classic)


def _settling(candidate: Candidate) -> Message:
    time = candidate.settling_time
    return Message("time-value", time=time) if isfinite(time) else Message("not-settled")
