"""Loops of one machine that differ in shape, each with the largest Kp that keeps the margins.

Which of them serves the job best only the moves can tell (``study.loop_choice``). None is offered
that is softer than the loop by the classic rule or forgets a lasting force much more slowly.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from math import isclose, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.analysis.block_responses import BlockResponses
from mtcommission.loop.model.controller import Controller, Observer
from mtcommission.loop.tuning.cascade import CLASSIC, Shape, build_cascade
from mtcommission.loop.tuning.state_feedback import (
    add_state_feedback,
    design_observer,
    given_state_feedback,
    moving_modes,
)
from mtcommission.loop.tuning.tuned import (
    CornerPlants,
    TunedLoop,
    TuningSettings,
    close_within_margins,
    corner_plants,
    scan_corners,
)
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message

Array = NDArray[np.float64]

LEAST_FRACTION = 0.001
"""Below a thousandth of the symmetrical optimum a loop is not tuned but given up (empirical)."""

BISECTIONS = 5
"""Between the first Kp that keeps the margins and the one before: its last digit is 0.5 %."""

HALF_STEP = sqrt(2.0)
"""Shapes near a good one: half a step of the coarse set, whose steps double."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopFamily:
    """What all loops of a machine share, whatever their shape.

    Parameters
    ----------
    machine, bench
        Nominal, and in every corner.
    settings
        Required margins, and the shapes tried.
    scanned
        From ``scan_corners`` with the observer.
    observer
        Without states where nothing but the cascade is built.
    state_gains
        As given, shape (n_plant,) [N per unit]; zero where none are.
    damps
        Whether state feedback by weight is built.
    """

    machine: Machine
    bench: CornerPlants
    settings: TuningSettings
    scanned: tuple[BlockResponses, ...]
    observer: Observer
    state_gains: Array
    damps: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """A loop with all margins.

    Parameters
    ----------
    shape, tuned
        How it was built, and the loop in every corner.
    """

    shape: Shape
    tuned: TunedLoop


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposals:
    """The loops worth a trial.

    Parameters
    ----------
    family
        What they share.
    classic
        The cascade by the classic rule; None if that lacks the margins.
    loops
        Those that keep what the classic one has, that one first.
    fastest_hz
        Largest bandwidth of all loops with the margins [Hz]; 0 if there is none.
    remark
        Why there is no loop with state feedback, if that was sought in vain.
    """

    family: LoopFamily
    classic: TunedLoop | None
    loops: tuple[Proposal, ...]
    fastest_hz: float
    remark: Message | None = None


def cascade_family(machine: Machine, settings: TuningSettings) -> LoopFamily:
    """Return the cascades of a machine, with its state gains where these are given.

    Parameters
    ----------
    machine, settings
        As for ``tune_loop``.

    Returns
    -------
    LoopFamily

    Raises
    ------
    ComputationError
        NOT_OBSERVABLE or FEEDBACK_DESIGN_FAILED, for given state gains.
    """
    bench = corner_plants(machine)
    controller = build_cascade(machine, bench.model, fraction=1.0)
    if machine.control.state_feedback is StateFeedback.GIVEN:
        controller = given_state_feedback(machine, bench.model, controller, settings=settings)
    return LoopFamily(
        machine=machine,
        bench=bench,
        settings=settings,
        scanned=scan_corners(bench, controller),
        observer=controller.observer,
        state_gains=controller.state_gains,
    )


def feedback_family(cascades: LoopFamily) -> LoopFamily | None:
    """Return the same with an observer, and state feedback by weight.

    Parameters
    ----------
    cascades
        From ``cascade_family``, without given state gains.

    Returns
    -------
    LoopFamily or None
        None if the sensors see no mode that moves the tool.

    Raises
    ------
    ComputationError
        FEEDBACK_DESIGN_FAILED.
    """
    machine, bench = cascades.machine, cascades.bench
    controller = build_cascade(machine, bench.model, fraction=1.0)
    if not moving_modes(bench.model, controller.sensors):
        return None
    observer = design_observer(machine, bench.model, controller, settings=cascades.settings)
    scanned = scan_corners(bench, replace(controller, observer=observer))
    return replace(cascades, scanned=scanned, observer=observer, damps=True)


def build(family: LoopFamily, shape: Shape, *, fraction: float) -> Controller:
    """Return a controller of the family.

    Parameters
    ----------
    family
        What it shares with the others.
    shape
        Its weight counts where the family damps.
    fraction
        Kp over the symmetrical optimum [-].

    Returns
    -------
    Controller
    """
    model = family.bench.model
    cascade = build_cascade(family.machine, model, fraction=fraction, shape=shape)
    if not family.damps:
        return replace(cascade, state_gains=family.state_gains, observer=family.observer)
    return add_state_feedback(
        family.machine,
        model,
        cascade,
        weight=shape.mode_weight,
        observer=family.observer,
    )


def tune_shape(family: LoopFamily, shape: Shape, *, largest: float) -> TunedLoop | None:
    """Return the loop of a shape with the largest Kp that keeps the margins in every corner.

    Parameters
    ----------
    family, shape
        As for ``build``.
    largest
        Where Kp begins, over the symmetrical optimum [-].

    Returns
    -------
    TunedLoop or None
        Without remarks and warnings; None if no Kp keeps the margins, or the given one does not.
    """
    bench, scanned, settings = family.bench, family.scanned, family.settings

    def close(fraction: float) -> TunedLoop | None:
        controller = build(family, shape, fraction=fraction)
        return close_within_margins(bench, controller, scanned, settings=settings)

    low, found = largest, close(largest)
    if family.machine.control.velocity_gain is not None:
        return found
    while found is None and low > LEAST_FRACTION:
        low *= settings.reduction
        found = close(low)
    if found is None or low == largest:
        return found
    high = low / settings.reduction
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        tried = close(middle)
        low, high, found = (middle, high, tried) if tried else (low, middle, found)
    return found


def propose_cascades(family: LoopFamily) -> Proposals:
    """Return cascades of all shapes that the settings name, and the one by the classic rule.

    Parameters
    ----------
    family
        From ``cascade_family``.

    Returns
    -------
    Proposals
    """
    classic = tune_shape(family, CLASSIC, largest=1.0)
    settings = family.settings
    shapes = [
        Shape(position_ratio=position, integral_ratio=integral)
        for position, integral in product(settings.position_ratios, settings.integral_ratios)
    ]
    return _propose(family, classic, shapes)


def propose_feedback(
    cascades: LoopFamily, classic: TunedLoop | None, shapes: Iterable[Shape]
) -> Proposals:
    """Return loops with state feedback.

    Parameters
    ----------
    cascades, classic
        Without state feedback.
    shapes
        Of the cascade in it; each is tried with each of the settings' weights.

    Returns
    -------
    Proposals
        With a remark why there is none, if so.
    """
    try:
        family = feedback_family(cascades)
        if family is None:
            raise ComputationError(Outcome.FEEDBACK_DESIGN_FAILED, Message("loop-sees-no-mode"))
        weighted = product(shapes, family.settings.mode_weights)
        found = _propose(
            family, classic, [replace(shape, mode_weight=weight) for shape, weight in weighted]
        )
    except ComputationError as error:
        remark = Message("loop-no-state-feedback", detail=error.detail)
        return Proposals(family=cascades, classic=classic, loops=(), fastest_hz=0.0, remark=remark)
    loops = tuple(item for item in found.loops if item.shape.mode_weight)
    lost = Message("loop-no-state-feedback", detail=Message("loop-state-feedback-loses"))
    return replace(found, loops=loops, remark=None if loops else lost)


def feedback_shapes(settings: TuningSettings, *, near: Shape) -> tuple[Shape, ...]:
    """Return the shapes for which state feedback is worth a try.

    Parameters
    ----------
    settings
        With the shapes tried.
    near
        That which serves best without it.

    Returns
    -------
    tuple of Shape
        That one, and two with a short integral time: state feedback damps what that shakes.
    """
    gentle = replace(CLASSIC, position_ratio=min(settings.position_ratios))
    return tuple(dict.fromkeys((near, CLASSIC, gentle)))


def propose_near(proposals: Proposals, shape: Shape) -> tuple[Proposal, ...]:
    """Return loops half a step away from a good one.

    Parameters
    ----------
    proposals
        That the good one is from.
    shape
        Of the good one.

    Returns
    -------
    tuple of Proposal
    """
    steps = (1.0 / HALF_STEP, HALF_STEP)
    near = [replace(shape, position_ratio=step * shape.position_ratio) for step in steps]
    near += [
        replace(shape, integral_ratio=step * shape.integral_ratio)
        for step in steps
        if step * shape.integral_ratio >= min(proposals.family.settings.integral_ratios)
    ]
    if shape.mode_weight:
        near += [replace(shape, mode_weight=step**2 * shape.mode_weight) for step in steps]
    found = _propose(proposals.family, proposals.classic, near)
    return tuple(item for item in found.loops if item.tuned is not proposals.classic)


def tune_with_filters(
    family: LoopFamily, shape: Shape, filters: tuple[ForceFilter, ...]
) -> tuple[LoopFamily, TunedLoop | None]:
    """Return the family with other filters in the set-force path, and its loop of a shape.

    Parameters
    ----------
    family, shape
        As for ``tune_shape``; plant and observer stay what they are.
    filters
        All of them, in order.

    Returns
    -------
    (family, loop)
        None for a loop without the margins.
    """
    control = replace(family.machine.control, force_filters=filters)
    changed = replace(family, machine=replace(family.machine, control=control))
    return changed, tune_shape(changed, shape, largest=family.settings.largest_fraction)


def _propose(family: LoopFamily, classic: TunedLoop | None, shapes: Iterable[Shape]) -> Proposals:
    """The loops of some shapes, as far as they keep what the classic loop has."""
    control, largest = family.machine.control, family.settings.largest_fraction
    found = [Proposal(shape=CLASSIC, tuned=classic)] if classic else []
    for shape in dict.fromkeys(_with_given(family.machine, shape) for shape in shapes):
        tuned = tune_shape(family, shape, largest=largest)
        if tuned and not any(_is_same(tuned.controller, item.tuned.controller) for item in found):
            found.append(Proposal(shape=shape, tuned=tuned))
    is_fast = control.velocity_gain is not None
    return Proposals(
        family=family,
        classic=classic,
        loops=tuple(
            item
            for item in found
            if (is_fast or item.tuned.least_bandwidth_hz >= control.minimum_bandwidth_hz)
            and (classic is None or _keeps(classic, item.tuned, family.settings))
        ),
        fastest_hz=max((item.tuned.least_bandwidth_hz for item in found), default=0.0),
    )


def _with_given(machine: Machine, shape: Shape) -> Shape:
    """The same shape for all that differ only in what is given."""
    given = machine.control
    if given.position_gain is not None:
        shape = replace(shape, position_ratio=CLASSIC.position_ratio)
    if given.integral_time is not None:
        shape = replace(shape, integral_ratio=CLASSIC.integral_ratio)
    return shape


def _is_same(one: Controller, other: Controller) -> bool:
    pairs = (
        (one.velocity_gain, other.velocity_gain),
        (one.position_gain, other.position_gain),
        (one.integral_time, other.integral_time),
    )
    gains = all(isclose(a, b, rel_tol=1e-2) for a, b in pairs)
    return gains and np.allclose(one.state_gains, other.state_gains, rtol=1e-2)


def _keeps(classic: TunedLoop, tuned: TunedLoop, settings: TuningSettings) -> bool:
    share = integral_gain(tuned.controller) / integral_gain(classic.controller)
    is_stiff = tuned.least_stiffness >= classic.least_stiffness
    return is_stiff and share >= settings.least_integral_share


def integral_gain(controller: Controller) -> float:
    """Return Kp Kv / Tn: a lasting force F deflects by an integral over time of F over it.

    Parameters
    ----------
    controller
        State feedback does not change it.

    Returns
    -------
    float
        [N/(m s)].

    Source: Åström & Hägglund, Advanced PID Control, 2006, ch. 4: the integrated error after a
    step of load is one over the integral gain.
    """
    return controller.velocity_gain * controller.position_gain / controller.integral_time
