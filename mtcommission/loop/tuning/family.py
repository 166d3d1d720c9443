"""Loops of one machine that differ in shape alone; of each the largest gains with margins."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.block_responses import BlockResponses
from mtcommission.loop.model.controller import Controller, Observer
from mtcommission.loop.tuning.cascade import Shape, build_cascade
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
    seems_within_margins,
)
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine

Array = NDArray[np.float64]

LEAST_FRACTION = 0.001
"""Below a thousandth of the symmetrical optimum a loop is not tuned but given up (empirical)."""

BISECTIONS = 5
"""Between the first Kp that keeps the margins and the one before: its last digit is 0.5 %."""


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


def cascade_family(machine: Machine, settings: TuningSettings) -> LoopFamily:
    """Return the cascades of a machine, with its state gains where these are given.

    Parameters
    ----------
    machine, settings
        As for ``tune_loop``.

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
    bench, settings = family.bench, family.settings

    def close(fraction: float) -> TunedLoop | None:
        controller = build(family, shape, fraction=fraction)
        return close_within_margins(bench, controller, settings=settings)

    if family.machine.control.velocity_gain is not None:
        return close(largest)

    def seems(fraction: float) -> bool:
        controller = build(family, shape, fraction=fraction)
        return seems_within_margins(controller, family.scanned, settings=settings)

    low, good = largest, seems(largest)
    while not good and low > LEAST_FRACTION:
        low *= settings.reduction
        good = seems(low)
    if low < largest and good:
        high = low / settings.reduction
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if seems(middle) else (low, middle)
    while low > LEAST_FRACTION:
        # The grid is coarser than the exact response: what it misses costs half a per cent or two.
        if (found := close(low)) is not None:
            return found
        low *= CLOSER
    return None


CLOSER = 0.995
"""Share of Kp that is tried next where the exact margins are missed."""


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
