"""What the profile leaves out of the controller, tuned until the margins hold in every corner.

- The cascade by ``cascade_tuning.py``.
- State feedback by ``state_feedback.py``; for each of some weights Kp is the largest that keeps
  the same margins. Of those that cost neither damping nor bandwidth against the cascade alone,
  the one that makes the tool stiffest.
- What is given is used as given, judged, and warned about where it is poor.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.cascade import build_cascade, explain_cascade
from mtcommission.loop.tuning.cascade_tuning import (
    close_cascade,
    design_cascade,
    filter_warnings,
    fractions,
    lacking_bandwidth,
    tune_cascade,
)
from mtcommission.loop.tuning.judgement import (
    judge_given,
    warn_of_modes,
)
from mtcommission.loop.tuning.state_feedback import (
    add_state_feedback,
    design_observer,
    is_seen,
    most_resonant_mode,
)
from mtcommission.loop.tuning.tuned import (
    CornerPlants,
    TunedLoop,
    TuningSettings,
    close_loop,
    close_within_margins,
    corner_plants,
    scan_corners,
)
from mtcommission.machine.machine import Machine, StateFeedback
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, PlantMode

__all__ = ["TunedLoop", "TuningSettings", "Variants", "check_loop", "tune_loop", "tune_variants"]

KEPT_BANDWIDTH = 0.95
KEPT_DAMPING = 0.9
"""What state feedback must leave of the cascade's bandwidth and of the other modes' damping."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Variants:
    """The loop without and with state feedback, both with the same margins.

    Parameters
    ----------
    plain
        The cascade alone.
    feedback
        With state feedback; None where none is of use.
    is_needed
        Whether the cascade alone misses ``minimum_bandwidth``, so that only the loop with state
        feedback may be used.
    """

    plain: TunedLoop
    feedback: TunedLoop | None
    is_needed: bool = False


def tune_loop(machine: Machine, *, settings: TuningSettings | None = None) -> TunedLoop:
    """Return the controller of a machine, given gains as given and the rest by rule.

    Parameters
    ----------
    machine
        Machine with its control block.
    settings
        Required margins; None: the defaults.

    Returns
    -------
    TunedLoop
        With state feedback "auto" the one with state feedback, where that is of use.

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
    settings = settings or TuningSettings()
    given = machine.control.state_feedback
    if given is StateFeedback.AUTO:
        found = tune_variants(machine, settings=settings)
        return found.feedback or found.plain
    if given is StateFeedback.GIVEN:
        return _with_given_state_gains(machine, settings)
    return tune_cascade(machine, settings)


def check_loop(machine: Machine) -> tuple[Message, ...]:
    """Return what is poor about the loop that a profile asks for.

    Parameters
    ----------
    machine
        With its control block; state feedback "auto" counts as "off", to be quick, unless a
        minimum bandwidth may need it.

    Returns
    -------
    tuple of Message
        Empty where nothing is, and at once where the profile leaves all to the rules.
    """
    given = machine.control
    if given.leaves_all_to_rules:
        return ()
    if given.state_feedback is StateFeedback.AUTO and given.minimum_bandwidth_hz == 0.0:
        machine = replace(machine, control=replace(given, state_feedback=StateFeedback.OFF))
    try:
        return tune_loop(machine).warnings
    except ComputationError as error:
        return (error.message,)


def tune_variants(machine: Machine, *, settings: TuningSettings) -> Variants:
    """Return the loop without and with state feedback, both with the same margins.

    Parameters
    ----------
    machine, settings
        As for ``tune_loop``; the machine's ``state_feedback`` does not count.

    Returns
    -------
    Variants
        The last remark of each says what there is to say about state feedback.

    Raises
    ------
    ComputationError
        As for ``tune_loop``.
    """
    plain = close_cascade(machine, settings)
    lacking = lacking_bandwidth(machine, plain)
    found = _compare_feedback(machine, plain, settings, is_needed=lacking is not None)
    if lacking is None:
        return found
    if found.feedback is None:
        detail = Message("loop-lacks-bandwidth-anyway", lacking=lacking)
        raise ComputationError(Outcome.BANDWIDTH_OUT_OF_REACH, detail)
    remark = Message("loop-state-feedback-needed", lacking=lacking)
    return replace(found, feedback=_noted(found.feedback, remark), is_needed=True)


def _compare_feedback(
    machine: Machine, plain: TunedLoop, settings: TuningSettings, *, is_needed: bool
) -> Variants:
    """The best loop with state feedback beside the cascade alone.

    Where it is needed, nothing of the cascade has to be kept, because that may not be used.
    """
    bench = corner_plants(machine)
    sensors = plain.controller.sensors
    unseen = tuple(mode.name for mode in bench.model.modes if not is_seen(mode, sensors))

    def noted(tuned: TunedLoop, remark: Message) -> TunedLoop:
        if not unseen:
            return _noted(tuned, remark)
        blind = Message("loop-unseen-modes", modes=unseen)
        return _noted(tuned, Message("loop-two-sentences", first=remark, second=blind))

    mode = most_resonant_mode(bench.model, sensors, plain.least_own_damping)
    if mode is None:
        return Variants(plain=noted(plain, Message("loop-no-state-feedback")), feedback=None)
    before = float(plain.nominal.mode_damping[bench.model.modes.index(mode)])
    try:
        found = list(_with_each_weight(machine, bench, plain, mode, settings))
    except ComputationError as error:
        if error.outcome is not Outcome.FEEDBACK_DESIGN_FAILED:
            raise
        failed = Message("loop-state-feedback-design-failed", detail=error.detail)
        return Variants(plain=noted(plain, failed), feedback=None)
    useful = [
        tuned
        for tuned in found
        if tuned.least_bandwidth_hz >= machine.control.minimum_bandwidth_hz
        and (is_needed or _keeps_what_was(bench.model, mode, plain, tuned))
    ]
    if not useful:
        remark = Message("loop-state-feedback-damps-nothing", mode=mode.name, damping=before)
        return Variants(plain=noted(plain, remark), feedback=None)
    best = max(useful, key=lambda tuned: tuned.least_stiffness)
    after = float(best.nominal.mode_damping[bench.model.modes.index(mode)])
    seen = "loop-observed-encoder-and-tcp" if "tcp" in sensors else "loop-observed-encoder"
    remark = Message(
        "loop-state-feedback",
        sensors=Message(seen),
        mode=mode.name,
        own=mode.damping_ratio,
        cascade=before,
        feedback=after,
    )
    warnings = (*warn_of_modes(bench, best), *filter_warnings(machine, best, settings))
    feedback = noted(replace(best, warnings=warnings), remark)
    return Variants(plain=noted(plain, remark), feedback=feedback)


def _noted(tuned: TunedLoop, remark: Message) -> TunedLoop:
    return replace(tuned, remarks=(*tuned.remarks, remark))


def _with_each_weight(
    machine: Machine,
    bench: CornerPlants,
    plain: TunedLoop,
    mode: PlantMode,
    settings: TuningSettings,
) -> Iterator[TunedLoop]:
    """The loop with state feedback for each weight, with the largest Kp that keeps the margins."""
    observer = design_observer(machine, bench.model, plain.controller, settings=settings)
    is_fixed = machine.control.velocity_gain is not None
    largest = build_cascade(machine, bench.model, fraction=settings.largest_fraction)
    least = plain.controller.velocity_gain * settings.reduction**2
    end = least / largest.velocity_gain * settings.largest_fraction
    scanned = scan_corners(bench, replace(largest, observer=observer))
    for weight in settings.mode_weights:
        for fraction in fractions(settings, start=settings.largest_fraction, end=end):
            cascade = build_cascade(machine, bench.model, fraction=fraction)
            controller = add_state_feedback(
                machine, bench.model, cascade, mode, weight=weight, observer=observer
            )
            found = close_within_margins(bench, controller, scanned, settings=settings)
            if found is not None:
                yield replace(found, remarks=explain_cascade(machine, controller))
                break
            if is_fixed:
                break


def _keeps_what_was(plant: Plant, mode: PlantMode, plain: TunedLoop, tuned: TunedLoop) -> bool:
    """Whether state feedback damps its mode better and costs neither bandwidth nor damping.

    The pole that a mode has turned into counts: what the servo mixes into it rings with the
    servo's damping, which the margins guard.
    """
    if tuned.least_bandwidth_hz < KEPT_BANDWIDTH * plain.least_bandwidth_hz:
        return False
    pairs = zip(plant.modes, plain.least_own_damping, tuned.least_own_damping, strict=True)
    return all(
        after > before if item is mode else after >= KEPT_DAMPING * before
        for item, before, after in pairs
    )


def _with_given_state_gains(machine: Machine, settings: TuningSettings) -> TunedLoop:
    bench = corner_plants(machine)
    plant = bench.model
    cascade = design_cascade(machine, bench, settings)
    gains = np.zeros(plant.order)
    for item in machine.control.state_gains:
        gains[plant.states.index(item.state)] = item.value
    observer = design_observer(machine, plant, cascade, settings=settings)
    hidden = [plant.states[i] for i in np.flatnonzero(gains) if i not in observer.states]
    if hidden:
        raise ComputationError(
            Outcome.NOT_OBSERVABLE,
            Message("loop-hidden-states", states=tuple(hidden)),
        )

    def build(changed: Machine) -> Controller:
        controller = build_cascade(changed, plant, fraction=1.0)
        return replace(controller, state_gains=gains, observer=observer)

    controller = replace(cascade, state_gains=gains, observer=observer)
    tuned = close_loop(bench, controller, remarks=explain_cascade(machine, cascade))
    warnings = judge_given(machine, bench, tuned, settings=settings, build=build)
    return replace(tuned, warnings=(*warnings, *warn_of_modes(bench, tuned)))
