"""The loop by the classic rule: given gains as given, the rest until the margins hold.

It knows nothing of the moves; which loop serves them best is ``study.loops``'s to find.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import reduce
from math import floor, log10
from typing import Any

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.loop.tuning.family import (
    LoopFamily,
    build,
    cascade_family,
    feedback_shapes,
    find_largest,
    propose_cascades,
    propose_feedback,
    tune_on_grid,
    tune_shape,
)
from mtcommission.loop.tuning.gains import (
    explain_cascade,
    is_seen,
    moving_modes,
    symmetrical_optimum,
)
from mtcommission.loop.tuning.tuned import (
    CLASSIC,
    SEARCH,
    TUNING,
    CornerPlants,
    TunedLoop,
    close_loop,
    corner_plants,
    describe_corner,
    describe_margins,
    follow,
)
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine


def tune_loop(machine: Machine) -> TunedLoop:
    """Return the controller of a machine, given gains as given and the rest by the classic rule.

    An open-loop axis just follows. With state feedback "auto" the stiffest with one of the weights,
    where there is one.

    Raises
    ------
    ComputationError
        UNSTABLE_LOOP if given gains are unstable in a corner; MARGINS_OUT_OF_REACH if no
        cascade has the margins; BANDWIDTH_OUT_OF_REACH if none of those has the minimum
        bandwidth, nor one with state feedback where that is "auto"; UNDAMPED_MODE if a mode
        without damping is out of reach of the loop; NOT_OBSERVABLE if a given state gain needs
        a state that the sensors do not see; FEEDBACK_DESIGN_FAILED if the observer for given
        state gains cannot be computed.
    """
    if machine.drive.follows:
        return follow(machine, corner_plants(machine))
    family = cascade_family(machine)
    classic = tune_shape(family, CLASSIC, largest=1.0)
    if machine.control.state_feedback is StateFeedback.AUTO:
        found = propose_feedback(family, classic, [CLASSIC])
        if found.loops:
            best = max(found.loops, key=lambda tuned: tuned.least_stiffness)
            return finish(found.family, best)
    tuned = classic or close_as_given(family)
    require_bandwidth(machine, tuned.least_bandwidth_hz)
    return finish(family, tuned)


def check_loop(machine: Machine) -> tuple[Message, ...]:
    """Return what is poor about the loop that a profile asks for, whichever is chosen.

    Empty where nothing is, and at once where the profile leaves all to tuning. State feedback
    "auto" counts as "off", to be quick, unless a minimum bandwidth may need it.
    """
    given = machine.control
    if machine.drive.follows or given.leaves_all_to_rules:
        return ()
    try:
        proposals = propose_cascades(cascade_family(machine))
        if not proposals.loops and given.state_feedback is StateFeedback.AUTO:
            shapes = feedback_shapes(near=CLASSIC)
            proposals = propose_feedback(proposals.family, proposals.classic, shapes)
        found = [finish(proposals.family, tuned) for tuned in proposals.loops]
        if not found:
            return tune_loop(machine).warnings
    except ComputationError as error:
        return (error.message,)
    shared = set.intersection(*(set(tuned.warnings) for tuned in found))
    return tuple(warning for warning in found[0].warnings if warning in shared)


def finish(family: LoopFamily, tuned: TunedLoop) -> TunedLoop:
    """Return a loop without remarks and warnings with what there is to say about it.

    Raises
    ------
    ComputationError
        UNSTABLE_LOOP, for given gains, with the corner.
    """
    machine, given = family.machine, family.machine.control
    remarks = explain_cascade(machine, tuned.controller)
    if family.damps:
        remarks = (*remarks, *_explain_feedback(family, tuned))
    warnings = list(warn_of_modes(family.bench, tuned))
    if given.has_given_gains or given.state_gains:
        warnings += _judge_given(family, tuned)
    if given.force_filters and not given.seeks_force_filters:
        bare = replace(given, force_filters=(), state_feedback=StateFeedback.OFF, state_gains=())
        with suppress(ComputationError):  # given gains that are unstable without them need them
            without = tune_loop(replace(machine, control=bare))
            filtered, unfiltered = tuned.least_bandwidth_hz, without.least_bandwidth_hz
            if filtered < SEARCH.softened * unfiltered:
                costs = {"filtered": filtered, "unfiltered": unfiltered}
                warnings.append(Message("loop-filters-soften", **costs))
    return replace(tuned, remarks=remarks, warnings=tuple(warnings))


def _explain_feedback(family: LoopFamily, tuned: TunedLoop) -> tuple[Message, ...]:
    model, sensors = family.bench.model, tuned.controller.sensors
    seen = "loop-observed-encoder-and-tcp" if "tcp" in sensors else "sensor-encoder"
    mode = moving_modes(model, sensors)[0]
    remark = Message(
        "loop-state-feedback",
        sensors=Message(seen),
        mode=mode.name,
        own=mode.damping_ratio,
        feedback=float(tuned.nominal.mode_damping[model.modes.index(mode)]),
    )
    unseen = tuple(item.name for item in model.modes if not is_seen(item, sensors))
    return (remark, Message("loop-unseen-modes", modes=unseen)) if unseen else (remark,)


def require_bandwidth(machine: Machine, reached: float) -> None:
    """Refuse loops that are too slow; given gains are only warned about.

    ``reached``: by the fastest loop with the margins [Hz].

    Raises
    ------
    ComputationError
        BANDWIDTH_OUT_OF_REACH.
    """
    given = machine.control
    if given.velocity_gain is None and reached < given.minimum_bandwidth_hz:
        detail = Message("loop-lacks-bandwidth", reached=reached, wanted=given.minimum_bandwidth_hz)
        raise ComputationError(Outcome.BANDWIDTH_OUT_OF_REACH, detail)


def close_as_given(family: LoopFamily) -> TunedLoop:
    """Return the loop with the given gains where these keep no margins, the rest without them.

    Raises
    ------
    ComputationError
        MARGINS_OUT_OF_REACH or UNDAMPED_MODE, where no gain is given.
    """
    machine, bench = family.machine, family.bench
    _require_damping(bench)
    given = machine.control
    if given.velocity_gain is not None:
        return close_loop(bench, build(family, CLASSIC, fraction=1.0))
    if given.has_given_gains or given.state_gains:
        control = replace(given, position_gain=None, integral_time=None, minimum_bandwidth_hz=0.0)
        control = replace(control, state_feedback=StateFeedback.OFF, state_gains=())
        free = tune_loop(replace(machine, control=control))
        fraction = free.controller.velocity_gain / symmetrical_optimum(machine)
        return close_loop(bench, build(family, CLASSIC, fraction=fraction))
    softest = close_loop(bench, build(family, CLASSIC, fraction=SEARCH.least))
    detail = Message(
        "loop-no-margins",
        Kp=softest.controller.velocity_gain,
        share=SEARCH.least,
        margins=describe_margins(softest.analyses),
    )
    raise ComputationError(Outcome.MARGINS_OUT_OF_REACH, detail)


def _require_damping(bench: CornerPlants) -> None:
    """A mode without damping that the encoder does not see rings for ever under any cascade."""
    for mode in bench.model.modes:
        if mode.damping_ratio == 0.0 and mode.measured_gain == 0.0:
            at = mode.frequency_hz
            detail = Message("loop-mode-without-damping", mode=mode.name, frequency=at)
            raise ComputationError(Outcome.UNDAMPED_MODE, detail)


def warn_of_modes(bench: CornerPlants, tuned: TunedLoop) -> Iterator[Message]:
    """Yield the modes that the loop damps much less than the structure does."""
    for index, mode in enumerate(bench.model.modes):
        own = [plant.modes[index].damping_ratio for plant in bench.plants]
        closed = [float(analysis.mode_damping[index]) for analysis in tuned.analyses]
        worst = min(range(len(own)), key=lambda i: closed[i] - own[i])
        if closed[worst] < SEARCH.undamped * own[worst]:
            ring, rings = closed[worst], own[worst]
            yield Message("loop-takes-damping", mode=mode.name, closed=ring, own=rings)


def _judge_given(family: LoopFamily, tuned: TunedLoop) -> Iterator[Message]:
    """What is poor about a loop with given gains, and which of them to lower."""
    control = family.machine.control
    if not tuned.keeps_margins:
        cure = _name_cure(family)
        for corner, analysis in zip(tuned.corners, tuned.analyses, strict=True):
            if not analysis.is_stable:
                gains, where = tuned.controller, describe_corner(corner)
                Kv, Kp, Tn = gains.position_gain, gains.velocity_gain, gains.integral_time
                detail = Message("loop-unstable", Kv=Kv, Kp=Kp, Tn=Tn, corner=where, cure=cure)
                raise ComputationError(Outcome.UNSTABLE_LOOP, detail)
        yield Message(
            "loop-given-gains-poor",
            margins=describe_margins(tuned.analyses),
            gain=TUNING.gain_margin_db,
            phase=TUNING.phase_margin_deg,
            peak=TUNING.sensitivity_peak,
            cure=cure,
        )
    reached, wanted = tuned.least_bandwidth_hz, control.minimum_bandwidth_hz
    if reached < wanted:
        yield Message("loop-given-gains-slow", reached=reached, wanted=wanted)


CURES = {
    "loop-cure-kv": ("position_gain", 1),
    "loop-cure-kp": ("velocity_gain", 1),
    "loop-cure-kp-from": ("velocity_gain", -1),  # too soft for its integrator, or for Kv
    "loop-cure-tn": ("integral_time", -1),
}
"""Which given gain to lower (1), or to raise (-1)."""


def _name_cure(family: LoopFamily) -> Message:
    """The value of each given gain, nearest to it, that keeps the margins.

    The other given gains stay as they are; what is left out is tuned, as it will be then.
    """
    cures: dict[str, Message] = {}
    for kind, (name, power) in CURES.items():
        given = getattr(family.machine.control, name)
        if given is None or (kind == "loop-cure-kp-from" and "loop-cure-kp" in cures):
            continue
        found = _largest(family, name, power)
        if found is not None:
            cures[kind] = Message(kind, value=found)
    if not cures:
        return Message("loop-no-cure")
    gains = reduce(lambda one, other: Message("either", first=one, last=other), cures.values())
    return Message("loop-cure", gains=gains)


def _largest(family: LoopFamily, name: str, power: int) -> float | None:
    """The largest ``power`` of a gain below the given one with the margins, as that gain.

    To three digits of the power.
    """

    def changed(value: float) -> LoopFamily:
        gain: dict[str, Any] = {name: value**power}
        control = replace(family.machine.control, **gain)
        return replace(family, machine=replace(family.machine, control=control))

    def seems(value: float) -> bool:
        return tune_on_grid(changed(value), CLASSIC, largest=1.0) is not None

    def keeps(value: float) -> bool:
        return tune_shape(changed(_round_down(value)), CLASSIC, largest=1.0) is not None

    given = float(getattr(family.machine.control, name) ** power)
    low = find_largest(seems, given, least=SEARCH.least * given)
    if low is None:
        return None
    found = find_largest(keeps, low, least=SEARCH.least * given)
    return None if found is None else float(_round_down(found) ** power)


def _round_down(value: float) -> float:
    step = 10.0 ** (floor(log10(value)) - 2)
    return floor(value / step) * step
