"""Which loop is used, and why: the one whose moves settle soonest, stiffness counting a little.

All loops with the margins are looked at with limits that suit them, the best more closely, and the
best of these exactly. What state feedback would add, and how the tool gives way, is shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

from mtcommission.base.messages.message import Message
from mtcommission.limits.choose import Choice, may_be_in_time
from mtcommission.limits.explore import REFINED, Found
from mtcommission.limits.judge import Candidate
from mtcommission.loop.disturbance import DisturbanceStep, simulate_disturbance
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.family import (
    Proposals,
    cascade_family,
    feedback_shapes,
    find_filters,
    propose_cascades,
    propose_feedback,
    propose_near,
    tune_shape,
)
from mtcommission.loop.tuning.tuned import CLASSIC, TUNING, TunedLoop
from mtcommission.loop.tuning.tuning import finish, require_bandwidth, tune_loop
from mtcommission.machine.checks import name_filter
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import STUDY
from mtcommission.study.variations import Row, choose, look

WITHOUT, WITH = Message("without-state-feedback"), Message("with-state-feedback")

NEEDS_STATE_FEEDBACK = Message("control-needs-state-feedback")


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopTrial:
    """A loop and the limits that suit it best."""

    tuned: TunedLoop  # in every corner
    is_classic: bool = False  # the cascade by the classic rule
    found: tuple[Found, ...] = ()  # limits, the best first; empty: none were found that keep all
    is_explored: bool = False  # everywhere, not at a first look
    choice: Choice | None = None  # the best limits, judged as the recommendation is
    is_used: bool = False  # everything else in the record uses it
    name: Message | None = None  # where it is one of the loops without and with state feedback

    @property
    def candidate(self) -> Candidate:
        """Its best limits, judged."""
        assert self.choice is not None
        return self.choice.candidate

    @property
    def expected_time(self) -> float:
        """Settling time as far as was looked [s]; inf where no limits were found."""
        delay = self.tuned.controller.reference_delay
        return self.found[0].duration + delay if self.found else inf

    @property
    def price(self) -> float:
        """Settling time as far as was looked, less what the stiffness is worth."""
        return priced(self.expected_time, self.tuned)

    @property
    def limits(self) -> MotionLimits | None:
        """The best limits found, not rounded; None where none were."""
        if not self.found:
            return None
        best = self.found[0]
        return MotionLimits(
            acceleration=best.acceleration,
            jerk=best.acceleration / best.jerk_time,
            setpoint_filter=best.setpoint_filter,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopChoice:
    """Which loop is used, and what others would have done."""

    tuned: TunedLoop
    used: LoopTrial | None = None  # the loop in use with its limits; None: nothing to choose
    variants: tuple[LoopTrial, ...] = ()  # without and with state feedback, if both were sought
    remarks: tuple[Message, ...] = ()  # why this loop, and what the control must offer

    @property
    def choice(self) -> Choice | None:
        """Its limits, where they were chosen already."""
        return self.used.choice if self.used else None

    @property
    def filters(self) -> list[SetpointFilter | None]:
        """The best setpoint filters of each kind, as far as they were looked at, the best first."""
        return _best_filters(self.used) if self.used else []

    @property
    def model(self) -> Any:
        """The loop as a ``control.StateSpace`` to go on with, e.g. ``control.bode_plot``."""
        return self.tuned.model


def priced(settling_time: float, tuned: TunedLoop) -> float:
    """Return a settling time divided by what the stiffness of the loop is worth."""
    return float(settling_time / tuned.least_stiffness**STUDY.stiffness_exponent)


def say_settling(candidate: Candidate) -> Message:
    """Return the settling time, or that there is none."""
    time = candidate.settling_time
    return Message("time-value", time=time) if isfinite(time) else Message("not-settled")


def settle_on_loop(machine: Machine) -> LoopChoice:
    """Return the loop that serves the moves best, with state feedback only where that pays.

    By the least price (``priced``); by the classic rule where given gains keep no margins. Filters
    of the set force that let Kp rise come first where they may be chosen: no engineer leaves a
    resonance unfiltered.

    Raises
    ------
    ComputationError
        As ``tune_loop``.
    """
    if machine.drive.follows:
        return LoopChoice(tuned=tune_loop(machine))
    family, remarks = cascade_family(machine), list[Message]()
    if machine.control.seeks_force_filters:
        base = tune_shape(family, CLASSIC, largest=TUNING.largest_fraction)
        filtered = find_filters(family, CLASSIC) if base else None
        if base and filtered:
            family, stiff = filtered
            added = stiff.controller.force_filters[len(base.controller.force_filters) :]
            remarks.append(
                Message(
                    "loop-filters-used",
                    filters=tuple(map(name_filter, added)),
                    Kp=base.controller.velocity_gain,
                    higher=stiff.controller.velocity_gain,
                    stiffness=base.least_stiffness,
                    stiffer=stiff.least_stiffness,
                )
            )
        elif machine.control.velocity_gain is None:
            remarks.append(Message("loop-no-filters"))
    cascades = propose_cascades(family)
    choice, fastest_hz = _try_all(cascades), cascades.fastest_hz
    if machine.control.state_feedback is StateFeedback.AUTO:
        near = choice.tuned.shape if choice else CLASSIC
        shapes = feedback_shapes(near)
        proposals = propose_feedback(family, cascades.classic, shapes)
        choice = _weigh_state_feedback(choice, _try_all(proposals), proposals.remark)
        fastest_hz = max(fastest_hz, proposals.fastest_hz)
    if choice is None:  # no loop keeps the margins
        require_bandwidth(family.machine, fastest_hz or inf)
        choice = LoopChoice(tuned=tune_loop(family.machine))
    return replace(choice, remarks=(*choice.remarks, *remarks))


def _try_all(proposals: Proposals) -> LoopChoice | None:
    """The best of the proposals and of those near it, judged; None where there is none.

    The best has the least price of those whose limits meet the requirements, if any does.
    """
    machine = proposals.family.machine
    looked = _look_at_all(machine, proposals)
    finalists: list[LoopTrial] = []
    for one in looked[: STUDY.finalists]:
        least = min((item.price for item in finalists), default=inf)
        is_done = one.is_explored or one.price > STUDY.too_dear * least
        refined = REFINED if least == inf else STUDY.beside_best
        finalists.append(one if is_done else _explore(machine, one, refined=refined))
    finalists.sort(key=lambda one: one.price)
    best: LoopTrial | None = None
    for item in finalists:
        if best and not may_be_in_time(machine, item.expected_time):
            continue
        trial = _judge(machine, item)
        best = best or trial
        if trial.choice and trial.choice.meets_requirements:
            best = trial
            break
    if best is None:
        return None
    why = Message(
        "loop-chosen",
        number=len(looked),
        settling=say_settling(best.candidate),
        stiffness=best.tuned.least_stiffness,
    )
    return LoopChoice(
        tuned=finish(proposals.family, best.tuned),
        used=replace(best, is_used=True),
        remarks=(why,) if len(looked) > 1 else (),
    )


def _look_at_all(machine: Machine, proposals: Proposals) -> list[LoopTrial]:
    """All proposals, and those near the best of them, at a first look; the best first.

    Once a loop has limits, others are looked at near these, and behind its best filters.
    """
    found: list[LoopTrial] = []

    def look_at(loops: Sequence[TunedLoop]) -> None:
        for tuned in loops:
            item = LoopTrial(tuned=tuned, is_classic=tuned is proposals.classic)
            known = next((other for other in found if other.limits), None)
            if known is None:
                found.append(_explore(machine, item))
            else:
                least = min(other.expected_time for other in found)
                latest = STUDY.too_late * least - item.tuned.controller.reference_delay
                row = Row(
                    machine=machine,
                    tuned=item.tuned,
                    near=known.limits,
                    beside=_best_filters(known)[1:],
                    refined=0,
                    latest=latest,
                )
                found.append(replace(item, found=look(row)))

    look_at(proposals.loops)
    for best in sorted(found, key=lambda one: one.price)[: STUDY.centres]:
        look_at(propose_near(proposals, best.tuned.shape, {one.tuned.shape for one in found}))
    return sorted(found, key=lambda one: one.price)


def _best_filters(known: LoopTrial) -> list[SetpointFilter | None]:
    kinds: dict[str, SetpointFilter | None] = {}
    for each in known.found:
        item = each.setpoint_filter
        kinds.setdefault(item.kind if item else "", item)
    return list(kinds.values())[: STUDY.beside]


def _explore(
    machine: Machine,
    item: LoopTrial,
    *,
    near: MotionLimits | None = None,
    refined: int = REFINED,
) -> LoopTrial:
    """A loop with the best limits, sought everywhere or near those of a loop much like it."""
    row = Row(machine=machine, tuned=item.tuned, near=near, refined=refined)
    return replace(item, found=look(row), is_explored=True)


def _judge(machine: Machine, item: LoopTrial, *, near: MotionLimits | None = None) -> LoopTrial:
    """A loop with the limits that were found for it, rounded and judged."""
    row = Row(machine=machine, tuned=item.tuned, found=item.found, near=near)
    return replace(item, choice=choose(row))


def _weigh_state_feedback(
    plain: LoopChoice | None, fed_back: LoopChoice | None, why_not: Message | None
) -> LoopChoice | None:
    """The loop with state feedback, if it pays, or if there is none without."""
    if fed_back is None:
        lost = (why_not,) if why_not else ()
        return plain and replace(plain, remarks=(*plain.remarks, *lost))
    needs = (NEEDS_STATE_FEEDBACK,)
    if plain is None:
        return replace(fed_back, remarks=(*fed_back.remarks, *needs))
    without, with_it = plain.used, fed_back.used
    assert without
    assert with_it
    helps, ratio = _pays(without, with_it)
    without = replace(without, name=WITHOUT, is_used=not helps)
    with_it = replace(with_it, name=WITH, is_used=helps)
    chosen = fed_back if helps else plain
    remarks = (
        Message(
            "state-feedback-chosen" if helps else "state-feedback-left-out",
            with_it=say_settling(with_it.candidate),
            without=say_settling(without.candidate),
        ),
        Message("state-feedback-stiffness", change=ratio - 1.0),
        *(needs if helps else ()),
    )
    return replace(
        chosen,
        used=with_it if helps else without,
        variants=(without, with_it),
        remarks=(*chosen.remarks, *remarks),
    )


def _pays(without: LoopTrial, with_it: LoopTrial) -> tuple[bool, float]:
    """Whether state feedback is worth its effort, and how much stiffer the tool is with it [-]."""
    before, after = without.candidate.settling_time, with_it.candidate.settling_time
    ratio = with_it.tuned.least_stiffness / without.tuned.least_stiffness
    is_stiffer = STUDY.sooner * after <= before and ratio > STUDY.stiffer
    return after < STUDY.sooner * before or is_stiffer, ratio


def with_filters(machine: Machine, tuned: TunedLoop) -> Machine:
    """Return a machine whose profile names the filters of the set force that a loop has."""
    filters = tuned.controller.force_filters
    return replace(machine, control=replace(machine.control, force_filters=filters))


def show_state_feedback(machine: Machine, choice: LoopChoice) -> LoopChoice:
    """Return the same choice with what state feedback would add where it is not used.

    The loop that is used stays; variants are added unless the sensors see no mode or nothing keeps
    the margins. Where it would pay, that is a reason to think of another control; else a remark.
    """
    given, tuned = choice.tuned.controller.state_gains, choice.tuned
    if machine.drive.follows or choice.variants or given.any():
        return choice
    machine = with_filters(machine, tuned)
    used = choice.used or _judge(machine, LoopTrial(tuned=tuned))
    classic = used.tuned if used.is_classic else None
    found = propose_feedback(cascade_family(machine), classic, [tuned.shape])
    if found.remark is not None:
        remarks = (*tuned.remarks, found.remark)
        return replace(choice, tuned=replace(tuned, remarks=remarks))
    near = used.candidate.limits
    tried = [LoopTrial(tuned=each, name=WITH) for each in found.loops]
    looks = [_explore(machine, item, near=near, refined=0) for item in tried]
    soonest = min(looks, key=lambda item: item.expected_time)
    best = _judge(machine, replace(soonest, found=()), near=near)
    without = replace(used, tuned=tuned, name=WITHOUT, is_used=True)
    helps, ratio = _pays(without, best)
    would = Message(
        "state-feedback-would",
        with_it=say_settling(best.candidate),
        without=say_settling(used.candidate),
        change=ratio - 1.0,
    )
    choice = replace(choice, variants=(without, best))
    if helps:
        return replace(choice, remarks=(*choice.remarks, would))
    return replace(choice, tuned=replace(tuned, remarks=(*tuned.remarks, would)))


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


def disturb(loop: LoopChoice) -> dict[str, DisturbanceStep]:
    """Return how the tool answers to a step of force, on the nominal machine, by name of the loop.

    The loops without and with state feedback where that pays, else the one in use; empty where the
    motor follows its setpoint, whatever pushes.
    """
    if loop.tuned.controller.follows:
        return {}
    compared = loop.variants if loop.variants and _pays(*loop.variants)[0] else ()
    shown = {item.name.kind: item.tuned for item in compared if item.name}
    return {
        name: simulate_disturbance(tuned.loops[0], duration=STUDY.push_time)
        for name, tuned in (shown or {"loop-in-use": loop.tuned}).items()
    }
