"""Which loop is used: the stiffest of those that let the moves settle soonest."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import inf, pi

from mtcommission.allowance import find_part
from mtcommission.loop.tuning.cascade import CLASSIC
from mtcommission.loop.tuning.family import LoopFamily, cascade_family, feedback_family
from mtcommission.loop.tuning.force_filters import find_filters
from mtcommission.loop.tuning.proposals import feedback_shapes, propose_cascades, propose_feedback
from mtcommission.loop.tuning.tuning import finish, require_bandwidth, tune_loop
from mtcommission.machine.control import FilterKind, ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.study.loop_trials import (
    LATER,
    LoopChoice,
    LoopSearch,
    LoopTrial,
    LoopVariant,
    best_limits,
    say_settling,
    try_all,
)
from mtcommission.study.settings import Settings

SOONER = 0.98
STIFFER = 1.2
"""State feedback is worth its effort if the moves settle 2 % sooner (the coarser search is no
finer), or as soon with a tool that is 20 % stiffer (design choice)."""


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
    found = try_all(machine, plant, settings, cascades)
    if machine.control.state_feedback is StateFeedback.AUTO:
        return _weigh_state_feedback(machine, plant, settings, found)
    if found.best is not None:
        return found.use(found.best)
    return _by_the_classic_rule(machine, settings, fastest_hz=cascades.fastest_hz)


def _by_the_classic_rule(machine: Machine, settings: Settings, *, fastest_hz: float) -> LoopChoice:
    """What is left where no loop keeps the margins, unless a bandwidth is asked for."""
    require_bandwidth(machine, fastest_hz or inf)
    return LoopChoice(tuned=tune_loop(machine, settings=settings.tuning))


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
    """
    if machine.drive.follows:
        return choice
    if not machine.control.seeks_force_filters:
        show = partial(_with_filters, machine, plant, choice, settings)
        choice = find_part(show, otherwise=partial(_left_out, choice, "loop-filters-left-out"))
    show = partial(show_state_feedback, machine, plant, choice, settings)
    return find_part(show, otherwise=partial(_left_out, choice, "loop-feedback-left-out"))


def _left_out(choice: LoopChoice, kind: str, _: Message) -> LoopChoice:
    """The choice with a remark on what would have been too much to compute."""
    return replace(choice, remarks=(*choice.remarks, Message(kind)))


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
    after = best_limits(machine, plant, settings, found.tuned, (used.candidate.limits,))
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
        settling=say_settling(used.candidate),
        settling_after=say_settling(after),
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
    without = used.candidate if used else best_limits(machine, plant, settings, choice.tuned, ())
    trials = [
        LoopTrial(
            shape=item.shape,
            tuned=item.tuned,
            candidate=best_limits(machine, plant, settings, item.tuned, (without.limits,)),
            is_classic=False,
        )
        for item in found.loops
    ]
    best = min(trials, key=lambda item: item.candidate.settling_time)
    remark = Message(
        "state-feedback-would",
        with_it=say_settling(best.candidate),
        without=say_settling(without),
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
    machine: Machine, plant: Plant, settings: Settings, plain: LoopSearch
) -> LoopChoice:
    """The best loop with state feedback, if it pays, or if there is none without."""
    cascades, without = plain.proposals, plain.best
    shapes = feedback_shapes(settings.tuning, near=without.shape if without else CLASSIC)
    proposals = propose_feedback(cascades.family, cascades.classic, shapes)
    found = try_all(machine, plant, settings, proposals)
    with_it = found.best
    if with_it is None and without is None:
        fastest = max(cascades.fastest_hz, proposals.fastest_hz)
        return _by_the_classic_rule(machine, settings, fastest_hz=fastest)
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
            with_it=say_settling(with_it.candidate),
            without=say_settling(without.candidate),
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
