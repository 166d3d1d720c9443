"""Loops of one machine that differ in shape and filters; of each the largest Kp with the margins.

Margins are read off one grid of frequencies that is affine in the gains (``GainGrid``) while Kp is
sought, and once off the exact response. Which loop serves the job best only the moves can tell
(``study.loops``); none is proposed that is softer than the loop by the classic rule or
forgets a lasting force much more slowly.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from math import pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import LOW_PASS, NOTCH
from mtcommission.loop.analysis import GainGrid, lay_grids
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.gains import (
    build_cascade,
    design_observer,
    feedback_gains,
    given_state_feedback,
    moving_modes,
)
from mtcommission.loop.tuning.tuned import (
    CLASSIC,
    SEARCH,
    TUNING,
    CornerPlants,
    Shape,
    TunedLoop,
    close_loop,
    corner_plants,
)
from mtcommission.machine.control import MOST_CYCLES_LATE, ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopFamily:
    """What all loops of a machine share, whatever their shape."""

    machine: Machine  # nominal
    bench: CornerPlants  # in every corner
    grids: tuple[GainGrid, ...]  # in every corner, with the observer and all filters
    base: Controller  # of which the observer counts, and state gains where these are given
    damps: bool = False  # whether state feedback by weight is built


def cascade_family(machine: Machine) -> LoopFamily:
    """Return the cascades of a machine, with its state gains where these are given.

    Raises
    ------
    ComputationError
        NOT_OBSERVABLE or FEEDBACK_DESIGN_FAILED, for given state gains.
    """
    bench = corner_plants(machine)
    base = build_cascade(machine, bench.model, fraction=1.0)
    if machine.control.state_feedback is StateFeedback.GIVEN:
        base = given_state_feedback(machine, bench.model, base)
    grids = lay_grids(bench.plants, base)
    return LoopFamily(machine=machine, bench=bench, grids=grids, base=base)


def feedback_family(cascades: LoopFamily) -> LoopFamily | None:
    """Return the family with an observer, and state feedback by weight.

    None if the sensors see no mode that moves the tool. ``cascades``: from ``cascade_family``,
    without given state gains.

    Raises
    ------
    ComputationError
        FEEDBACK_DESIGN_FAILED.
    """
    machine, bench, base = cascades.machine, cascades.bench, cascades.base
    if not moving_modes(bench.model, base.sensors):
        return None
    observer = design_observer(machine, bench.model, base)
    base = replace(base, observer=observer)
    return replace(cascades, grids=lay_grids(bench.plants, base), base=base, damps=True)


def with_filters(family: LoopFamily, filters: tuple[ForceFilter, ...]) -> LoopFamily:
    """Return the family with some filters more in the set-force path, behind those it has."""
    control = family.machine.control
    own = replace(control, force_filters=(*control.force_filters, *filters))
    return replace(
        family,
        machine=replace(family.machine, control=own),
        grids=tuple(grid.with_filters(filters) for grid in family.grids),
    )


def build(family: LoopFamily, shape: Shape, *, fraction: float) -> Controller:
    """Return a controller of the family, Kp as a fraction of the symmetrical optimum [-].

    The weight of ``shape`` counts where the family damps.
    """
    machine, model, base = family.machine, family.bench.model, family.base
    cascade = build_cascade(machine, model, fraction=fraction, shape=shape)
    if not family.damps:
        return replace(cascade, state_gains=base.state_gains, observer=base.observer)
    weight, observer = shape.mode_weight, base.observer
    gains = feedback_gains(machine, model, cascade, weight=weight, observed=observer.states)
    return replace(cascade, state_gains=gains, observer=observer)


def find_largest(keeps: Callable[[float], bool], begin: float, *, least: float) -> float | None:
    """Return the largest value up to some that keeps what it must; None where that is too small."""
    low = begin
    while not keeps(low):
        if low <= least:
            return None
        low *= TUNING.reduction
    if low == begin:
        return begin
    high = low / TUNING.reduction
    for _ in range(SEARCH.bisections):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if keeps(middle) else (low, middle)
    return low


def tune_shape(family: LoopFamily, shape: Shape, *, largest: float) -> TunedLoop | None:
    """Return the loop of a shape with the largest Kp that keeps the margins in every corner.

    Kp begins at ``largest``, over the symmetrical optimum [-]. Without remarks and warnings; None
    if no Kp keeps the margins, or the given one does not.
    """

    def close(fraction: float) -> TunedLoop:
        gains = build(family, shape, fraction=fraction)
        return replace(close_loop(family.bench, gains, family.grids), shape=shape)

    fraction = tune_on_grid(family, shape, largest=largest)
    if fraction is None:
        return None
    tuned = close(fraction)
    if tuned.keeps_margins or family.machine.control.velocity_gain is not None:
        return tuned if tuned.keeps_margins else None
    for _ in range(SEARCH.close_tries):
        fraction *= SEARCH.closer
        if (tuned := close(fraction)).keeps_margins:
            return tuned
    # The grid is far off.
    found = find_largest(lambda one: close(one).keeps_margins, fraction, least=SEARCH.least)
    return None if found is None else close(found)


def tune_on_grid(family: LoopFamily, shape: Shape, *, largest: float) -> float | None:
    """Return Kp of the same loop over the symmetrical optimum, as far as the grid tells [-].

    A given Kp counts as ``largest``.
    """

    def seems(fraction: float) -> bool:
        controller = build(family, shape, fraction=fraction)
        return all(seems_to_keep(grid, controller) for grid in family.grids)

    if family.machine.control.velocity_gain is not None:
        return largest if seems(largest) else None
    return find_largest(seems, largest, least=SEARCH.least)


def seems_to_keep(grid: GainGrid, controller: Controller) -> bool:
    """Return whether a controller keeps the margins on a plant, as far as the grid tells.

    Stability by the turns of 1 + L about the origin (Nyquist): three quarters for the three
    integrators of plant, velocity and position loop, where nothing else stands on the unit circle.
    """
    L = grid.open_loop(controller)
    away = 1.0 + L
    if np.abs(away).min() * TUNING.sensitivity_peak < 1.0:
        return False
    size = np.abs(L) - 1.0
    crossing = np.flatnonzero(size[:-1] * size[1:] < 0.0)
    share = size[crossing] / (size[crossing] - size[crossing + 1])
    at = L[crossing] + share * (L[crossing + 1] - L[crossing])
    least = 2.0 * sin(0.5 * radians(TUNING.phase_margin_deg))
    if np.any(np.abs(1.0 + at / np.abs(at)) < least):
        return False
    turned = float(np.angle(away[1:] / away[:-1]).sum())
    return abs(turned - 1.5 * pi) <= pi or not grid.is_damped


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sketch:
    """A loop as far as the grid tells."""

    filters: tuple[ForceFilter, ...]  # those that were added
    family: LoopFamily
    controller: Controller
    stiffness: float  # in the worst corner [N/m]


def find_filters(family: LoopFamily, shape: Shape) -> tuple[LoopFamily, TunedLoop] | None:
    """Return the family with the filters that make the tool stiffest, and its loop of a shape.

    No more than the kind of control has; None if none is worth its place, or if Kp is given.
    """
    control = family.machine.control
    best = None if control.velocity_gain is not None else _sketch(family, shape, ())
    left = min(SEARCH.most_filters, control.kind.force_filters - len(control.force_filters))
    while best and len(best.filters) < left:
        tried = [
            _sketch(family, shape, (*best.filters, item)) for item in _candidates(family, best)
        ]
        Kp, stiffness = best.controller.velocity_gain, best.stiffness
        good = [
            loop
            for loop in tried
            if loop
            and loop.controller.velocity_gain >= SEARCH.worth * Kp
            and loop.stiffness >= SEARCH.worth * stiffness
        ]
        if not good:
            break
        best = max(good, key=lambda loop: loop.stiffness)
    if not best or not best.filters:
        return None
    tuned = tune_shape(best.family, shape, largest=TUNING.largest_fraction)
    return (best.family, tuned) if tuned else None


def _sketch(family: LoopFamily, shape: Shape, filters: tuple[ForceFilter, ...]) -> _Sketch | None:
    if sum(item.delay for item in filters) > MOST_CYCLES_LATE * family.base.position_cycle:
        return None
    changed = with_filters(family, filters)
    fraction = tune_on_grid(changed, shape, largest=TUNING.largest_fraction)
    if fraction is None:
        return None
    gains = build(changed, shape, fraction=fraction)
    softest = max(np.abs(grid.respond(gains).compliance).max() for grid in changed.grids)
    stiffness = float(1.0 / softest)
    return _Sketch(filters=filters, family=changed, controller=gains, stiffness=stiffness)


def _candidates(family: LoopFamily, before: _Sketch) -> Iterator[ForceFilter]:
    """Notches about every mode that the encoder sees, low-passes above the weakest frequency."""
    for mode in family.bench.model.modes:
        if mode.measured_gain:
            for place, width in product(SEARCH.notch_places, SEARCH.notch_widths):
                omega, zeta = place * mode.natural_frequency, SEARCH.notch_depth * width
                yield ForceFilter(kind=NOTCH, natural_frequency=omega, damping=zeta, width=width)
    away = [np.abs(1.0 + grid.open_loop(before.controller)) for grid in before.family.grids]
    worst = int(np.argmin([distance.min() for distance in away]))
    weakest = float(family.grids[worst].omega[away[worst].argmin()])
    zeta = SEARCH.low_pass_damping
    for factor in SEARCH.low_passes:
        yield ForceFilter(kind=LOW_PASS, natural_frequency=factor * weakest, damping=zeta)


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposals:
    """The loops worth a trial."""

    family: LoopFamily  # what they share
    classic: TunedLoop | None  # the cascade by the classic rule; None if that lacks the margins
    loops: tuple[TunedLoop, ...]  # those that keep what the classic one has, that one first
    fastest_hz: float  # largest bandwidth of all loops with the margins [Hz]; 0: there is none
    remark: Message | None = None
    """Why there is no loop with state feedback, if that was sought in vain."""


def propose_cascades(family: LoopFamily) -> Proposals:
    """Return cascades of all shapes that the settings name, and the one by the classic rule."""
    classic = tune_shape(family, CLASSIC, largest=1.0)
    ratios = product(TUNING.position_ratios, TUNING.integral_ratios)
    shapes = [Shape(position_ratio=Kv, integral_ratio=Tn) for Kv, Tn in ratios]
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
        weighted = product(shapes, TUNING.mode_weights)
        weighted_shapes = [replace(shape, mode_weight=weight) for shape, weight in weighted]
        found = _propose(family, classic, weighted_shapes)
    except ComputationError as error:
        remark = Message("loop-no-state-feedback", detail=error.detail)
        return Proposals(family=cascades, classic=classic, loops=(), fastest_hz=0.0, remark=remark)
    loops = tuple(tuned for tuned in found.loops if tuned.shape.mode_weight)
    lost = Message("loop-no-state-feedback", detail=Message("loop-state-feedback-loses"))
    return replace(found, loops=loops, remark=None if loops else lost)


def feedback_shapes(near: Shape) -> tuple[Shape, ...]:
    """Return the shapes for which state feedback is worth a try.

    They are ``near``, which serves best without it, and two with a short integral time: state
    feedback damps what that shakes.
    """
    gentle = replace(CLASSIC, position_ratio=min(TUNING.position_ratios))
    return tuple(dict.fromkeys((near, CLASSIC, gentle)))


def propose_near(
    proposals: Proposals, shape: Shape, known: Collection[Shape]
) -> tuple[TunedLoop, ...]:
    """Return loops half a step away from the good one of a shape, but those known already."""
    Kv, Tn = shape.position_ratio, shape.integral_ratio
    steps, least = (1.0 / SEARCH.near, SEARCH.near), min(TUNING.integral_ratios)

    def ratio(value: float) -> float:
        return round(value, 9)  # two ways to one shape end at the same number

    near = [replace(shape, position_ratio=ratio(step * Kv)) for step in steps]
    near += [
        replace(shape, integral_ratio=ratio(step * Tn)) for step in steps if step * Tn >= least
    ]
    if shape.mode_weight:
        near += [replace(shape, mode_weight=ratio(step**2 * shape.mode_weight)) for step in steps]
    new = [item for item in near if item not in known]
    found = _propose(proposals.family, proposals.classic, new)
    return tuple(tuned for tuned in found.loops if tuned is not proposals.classic)


def _propose(family: LoopFamily, classic: TunedLoop | None, shapes: Iterable[Shape]) -> Proposals:
    """The loops of some shapes, as far as they keep what the classic loop has."""
    control = family.machine.control
    # Shapes that differ only in what is given are one.
    given = {"position_ratio": control.position_gain, "integral_ratio": control.integral_time}
    fixed = {key: getattr(CLASSIC, key) for key, gain in given.items() if gain is not None}
    found = [classic] if classic else []
    least_hz = control.minimum_bandwidth_hz if control.velocity_gain is None else 0.0
    is_fast = classic is not None and classic.least_bandwidth_hz >= least_hz
    for shape in dict.fromkeys(replace(shape, **fixed) for shape in shapes):
        largest = tune_on_grid(family, shape, largest=TUNING.largest_fraction)
        if largest is None:
            continue
        # What forgets a force too slowly by its gains alone need not be closed.
        gains = build(family, shape, fraction=largest)
        if classic and is_fast and not _forgets(classic.controller, gains):
            continue
        tuned = tune_shape(family, shape, largest=largest)
        if tuned and not any(_is_same(tuned.controller, other.controller) for other in found):
            found.append(tuned)
    kept = [
        tuned
        for tuned in found
        if tuned.least_bandwidth_hz >= least_hz and (classic is None or _keeps(classic, tuned))
    ]
    fastest = max((tuned.least_bandwidth_hz for tuned in found), default=0.0)
    return Proposals(family=family, classic=classic, loops=tuple(kept), fastest_hz=fastest)


def _is_same(one: Controller, other: Controller) -> bool:
    names = ("velocity_gain", "position_gain", "integral_time", "state_gains")
    return all(np.allclose(getattr(one, name), getattr(other, name), rtol=1e-2) for name in names)


def _keeps(classic: TunedLoop, tuned: TunedLoop) -> bool:
    is_stiff = tuned.least_stiffness >= classic.least_stiffness
    return is_stiff and _forgets(classic.controller, tuned.controller)


def _forgets(classic: Controller, gains: Controller) -> bool:
    """Whether a lasting force is forgotten soon enough."""
    share = integral_gain(gains) / integral_gain(classic)
    longest = max(TUNING.longest_integral_time, classic.integral_time)
    return gains.integral_time <= longest and share >= TUNING.least_integral_share


def integral_gain(controller: Controller) -> float:
    """Return Kp Kv / Tn [N/(m s)]: a lasting force deflects by an integral over time of F over it.

    Source: Åström & Hägglund, Advanced PID Control, 2006, ch. 4: the integrated error after a
    step of load is one over the integral gain.
    """
    return controller.velocity_gain * controller.position_gain / controller.integral_time
