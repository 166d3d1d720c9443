"""Which loop is used: the one whose moves settle soonest, a stiffer tool counting a little."""

from __future__ import annotations

from dataclasses import replace
from math import inf, pi

from mtcommission.limits.choose import choose_limits
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.cascade import CLASSIC
from mtcommission.loop.tuning.family import (
    FilteredLoop,
    LoopFamily,
    cascade_family,
    feedback_family,
    feedback_shapes,
    find_filters,
    propose_cascades,
    propose_feedback,
    tune_shape,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import require_bandwidth, tune_loop
from mtcommission.machine.control import FilterKind, ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.study.loop_trials import (
    LoopChoice,
    LoopSearch,
    LoopTrial,
    LoopVariant,
    in_order,
    judge_loop,
    say_settling,
    try_all,
)
from mtcommission.study.settings import Settings

SOONER = 0.98
STIFFER = 1.2
"""State feedback is worth its effort if the moves settle 2 % sooner, or as soon with a tool that is
20 % stiffer (design choice)."""


def settle_on_loop(machine: Machine, plant: Plant, settings: Settings) -> LoopChoice:
    """Return the loop that serves the moves best, with state feedback only where that pays.

    By the least price (``loop_trials.priced``); by the classic rule where given gains keep no
    margins. Filters of the set force that let Kp rise come first where they may be chosen: no
    engineer leaves a resonance unfiltered.

    Raises
    ------
    ComputationError
        As ``tune_loop``.
    """
    if machine.drive.follows:
        return LoopChoice(tuned=tune_loop(machine))
    family, remark = cascade_family(machine, settings.tuning), None
    if machine.control.seeks_force_filters:
        base = tune_shape(family, CLASSIC, largest=settings.tuning.largest_fraction)
        found = find_filters(family, CLASSIC) if base else None
        if base and found:
            family, remark = found.family, _say_filters("loop-filters-used", base, found)
        elif machine.control.velocity_gain is None:
            remark = Message("loop-no-filters")
    choice = _choose(family, plant, settings)
    return replace(choice, remarks=(*choice.remarks, *([remark] if remark else [])))


def _choose(family: LoopFamily, plant: Plant, settings: Settings) -> LoopChoice:
    machine, cascades = family.machine, propose_cascades(family)
    found = try_all(machine, plant, cascades)
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
    """Return the same choice with what filters and state feedback would add where not used."""
    if machine.drive.follows:
        return choice
    machine = with_filters(machine, choice.tuned)
    near = [judge_loop(machine, plant, each) for each in choice.others]
    choice = replace(choice, trials=in_order((*choice.trials, *near)), others=())
    if not machine.control.seeks_force_filters:
        choice = _suggest_filters(machine, choice, settings)
    return show_state_feedback(machine, plant, choice, settings)


def with_filters(machine: Machine, tuned: TunedLoop) -> Machine:
    """Return a machine whose profile names the filters of the set force that a loop has."""
    filters = tuned.controller.force_filters
    return replace(machine, control=replace(machine.control, force_filters=filters))


def _suggest_filters(machine: Machine, choice: LoopChoice, settings: Settings) -> LoopChoice:
    """The choice with a remark on filters of the set force that would let Kp rise."""
    used = next((item for item in choice.trials if item.is_used), None)
    if used is None or machine.control.kind.force_filters == 0:
        return choice
    family: LoopFamily | None = cascade_family(machine, settings.tuning)
    if used.shape.mode_weight:
        family = feedback_family(cascade_family(machine, settings.tuning))
    found = find_filters(family, used.shape) if family else None
    remark = (
        _say_filters("loop-filters-suggested", used.tuned, found)
        if found
        else Message("loop-no-filters")
    )
    return replace(choice, remarks=(*choice.remarks, remark))


def _say_filters(kind: str, before: TunedLoop, found: FilteredLoop) -> Message:
    return Message(
        kind,
        filters=tuple(map(name_filter, found.filters)),
        Kp=before.controller.velocity_gain,
        higher=found.tuned.controller.velocity_gain,
        stiffness=before.least_stiffness,
        stiffer=found.tuned.least_stiffness,
    )


def describe_loop(controller: Controller) -> list[Message]:
    """Return the gains of a loop and its filters of the set force, in sentences."""
    if controller.follows:
        return [Message("simulated-without-loop")]
    gains = Message(
        "simulated-with-loop",
        Kv=controller.position_gain,
        Kp=controller.velocity_gain,
        Tn=controller.integral_time,
    )
    filters = tuple(map(name_filter, controller.force_filters))
    return [gains, *([Message("simulated-with-filters", filters=filters)] if filters else [])]


def name_filter(item: ForceFilter) -> Message:
    """Return what a filter of the set force is called, with its numbers."""
    frequency = item.natural_frequency / (2.0 * pi)
    if item.kind is FilterKind.LOW_PASS:
        return Message("loop-filter-low-pass", frequency=frequency, damping=item.damping)
    return Message("loop-filter-notch", frequency=frequency, damping=item.damping, width=item.width)


def show_state_feedback(
    machine: Machine, plant: Plant, choice: LoopChoice, settings: Settings
) -> LoopChoice:
    """Return the same choice with what state feedback would add where it is not used.

    The loop that is used stays; variants are added unless the sensors see no mode or nothing keeps
    the margins. The other arguments are as for ``settle_on_loop``.
    """
    if choice.variants or choice.tuned.controller.state_gains.any():
        return choice
    used = next((item for item in choice.trials if item.is_used), None)
    classic = next((item.tuned for item in choice.trials if item.is_classic), None)
    shape = used.shape if used else CLASSIC
    found = propose_feedback(cascade_family(machine, settings.tuning), classic, [shape])
    if found.remark is not None:
        return replace(choice, remarks=(*choice.remarks, found.remark))
    without = used.candidate if used else choose_limits(machine, plant, choice.tuned).candidate
    tried = [
        (item.tuned, choose_limits(machine, plant, item.tuned, near=without.limits).candidate)
        for item in found.loops
    ]
    tuned, best = min(tried, key=lambda item: item[1].settling_time)
    remark = Message(
        "state-feedback-would",
        with_it=say_settling(best),
        without=say_settling(without),
        ratio=tuned.least_stiffness / choice.tuned.least_stiffness,
    )
    return replace(
        choice,
        variants=(
            LoopVariant(name=WITHOUT, tuned=choice.tuned, candidate=without, is_used=True),
            LoopVariant(name=WITH, tuned=tuned, candidate=best, is_used=False),
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
    found = try_all(machine, plant, proposals)
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
    pair = (without, with_it)
    choice = found.use(with_it, among=pair[:1]) if helps else plain.use(without, among=pair[1:])
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
