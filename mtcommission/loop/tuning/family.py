"""Loops of one machine that differ in shape alone; of each the largest gains with margins."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.controller import Controller, Observer
from mtcommission.loop.tuning.cascade import Shape, build_cascade
from mtcommission.loop.tuning.grid import GainGrid, lay_gain_grid
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
    """What all loops of a machine share, whatever their shape."""

    machine: Machine  # nominal
    bench: CornerPlants  # in every corner
    settings: TuningSettings  # required margins, and the shapes tried
    grid: GainGrid  # with the observer and all filters
    observer: Observer  # without states where nothing but the cascade is built
    state_gains: Array  # as given, (n_plant,) [N per unit]; zero where none are
    damps: bool = False  # whether state feedback by weight is built


def cascade_family(machine: Machine, settings: TuningSettings) -> LoopFamily:
    """Return the cascades of a machine, with its state gains where these are given.

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
        grid=lay_gain_grid(bench, controller),
        observer=controller.observer,
        state_gains=controller.state_gains,
    )


def feedback_family(cascades: LoopFamily) -> LoopFamily | None:
    """Return the family with an observer, and state feedback by weight.

    None if the sensors see no mode that moves the tool. ``cascades``: from ``cascade_family``,
    without given state gains.

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
    grid = lay_gain_grid(bench, replace(controller, observer=observer))
    return replace(cascades, grid=grid, observer=observer, damps=True)


def build(family: LoopFamily, shape: Shape, *, fraction: float) -> Controller:
    """Return a controller of the family.

    The weight of ``shape`` counts where the family damps; ``fraction``: Kp over the symmetrical
    optimum [-].
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

    Kp begins at ``largest``, over the symmetrical optimum [-]. Without remarks and warnings; None
    if no Kp keeps the margins, or the given one does not.
    """
    low = tune_on_grid(family, shape, largest=largest)
    while low is not None and low > LEAST_FRACTION:
        # The grid is coarser than the exact response: what it misses costs half a per cent or two.
        controller = build(family, shape, fraction=low)
        found = close_within_margins(
            family.bench, controller, family.grid.scanned, settings=family.settings
        )
        if found is not None or family.machine.control.velocity_gain is not None:
            return found
        low *= CLOSER
    return None


CLOSER = 0.995
"""Share of Kp that is tried next where the exact margins are missed."""


def tune_on_grid(family: LoopFamily, shape: Shape, *, largest: float) -> float | None:
    """Return Kp of the same loop over the symmetrical optimum, as far as the grid tells [-].

    A given Kp counts as ``largest``.
    """
    settings = family.settings

    def seems(fraction: float) -> bool:
        controller = build(family, shape, fraction=fraction)
        return family.grid.keeps_margins(controller, settings=settings)

    low, good = largest, seems(largest)
    if family.machine.control.velocity_gain is not None:
        return largest if good else None
    while not good and low > LEAST_FRACTION:
        low *= settings.reduction
        good = seems(low)
    if low < largest and good:
        high = low / settings.reduction
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if seems(middle) else (low, middle)
    return low if good else None


def with_filters(family: LoopFamily, filters: tuple[ForceFilter, ...]) -> LoopFamily:
    """Return the family with some filters more in the set-force path, behind those it has."""
    control = family.machine.control
    return replace(
        family,
        machine=replace(
            family.machine,
            control=replace(control, force_filters=(*control.force_filters, *filters)),
        ),
        grid=family.grid.with_filters(filters, control.velocity_cycle),
    )
