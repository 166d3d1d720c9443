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

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.cascade import CLASSIC, Shape
from mtcommission.loop.tuning.family import (
    LoopFamily,
    feedback_family,
    tune_shape,
)
from mtcommission.loop.tuning.tuned import (
    TunedLoop,
    TuningSettings,
)
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message

HALF_STEP = sqrt(2.0)
"""Shapes near a good one: half a step of the coarse set, whose steps double."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """A loop with all margins."""

    shape: Shape  # how it was built
    tuned: TunedLoop  # the loop in every corner


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposals:
    """The loops worth a trial."""

    family: LoopFamily  # what they share
    classic: TunedLoop | None  # the cascade by the classic rule; None if that lacks the margins
    loops: tuple[Proposal, ...]  # those that keep what the classic one has, that one first
    fastest_hz: float  # largest bandwidth of all loops with the margins [Hz]; 0: there is none
    remark: Message | None = None
    """Why there is no loop with state feedback, if that was sought in vain."""


def propose_cascades(family: LoopFamily) -> Proposals:
    """Return cascades of all shapes that the settings name, and the one by the classic rule."""
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
    """Return loops with state feedback, with a remark why there is none, if so.

    ``cascades`` and ``classic`` are without it; ``shapes`` are those of the cascade in it, each
    tried with each of the settings' weights.
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

    They are ``near``, which serves best without it, and two with a short integral time: state
    feedback damps what that shakes.
    """
    gentle = replace(CLASSIC, position_ratio=min(settings.position_ratios))
    return tuple(dict.fromkeys((near, CLASSIC, gentle)))


def propose_near(proposals: Proposals, shape: Shape) -> tuple[Proposal, ...]:
    """Return loops half a step away from the good one of this shape among the proposals."""
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
    longest = max(settings.longest_integral_time, classic.controller.integral_time)
    is_quick = tuned.controller.integral_time <= longest
    return is_stiff and is_quick and share >= settings.least_integral_share


def integral_gain(controller: Controller) -> float:
    """Return Kp Kv / Tn: a lasting force F deflects by an integral over time of F over it.

    The unit is N/(m s); state feedback does not change it.

    Source: Åström & Hägglund, Advanced PID Control, 2006, ch. 4: the integrated error after a
    step of load is one over the integral gain.
    """
    return controller.velocity_gain * controller.position_gain / controller.integral_time
