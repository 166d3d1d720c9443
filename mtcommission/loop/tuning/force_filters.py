"""Notch and low-pass filters of the set force that let Kp rise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import pi

from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.cascade import Shape
from mtcommission.loop.tuning.family import (
    LoopFamily,
    build,
    tune_on_grid,
    tune_shape,
    with_filters,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.control import FilterKind, ForceFilter

PLACES = (0.9, 1.0, 1.1)
WIDTHS = (0.2, 0.5)
DEPTH = 0.3
"""Of the notches tried: frequency over that of the resonance, denominator damping, and numerator
over denominator damping. Deeper or narrower ones miss a resonance that is off by some per cent,
and cost more phase below it (empirical)."""

LOW_PASSES = (1.5, 3.0)
"""Of the low-passes tried: frequency over that at which the sensitivity peaks."""

LOW_PASS_DAMPING = 0.7
"""The flattest pass band (Butterworth: 1/sqrt 2)."""

WORTH = 1.03
"""A filter is worth its place if Kp and dynamic stiffness rise by 3 % (design choice: an entry more
that brings less is not worth typing)."""

MOST = 2
"""More filters than this are not suggested: each costs phase (design choice)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FilteredLoop:
    """A loop with filters that the profile does not name."""

    filters: tuple[ForceFilter, ...]  # those that were added
    family: LoopFamily  # with all filters
    tuned: TunedLoop  # in every corner


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sketch:
    """A loop as far as the grid tells."""

    filters: tuple[ForceFilter, ...]  # those that were added
    family: LoopFamily
    controller: Controller
    stiffness: float  # in the worst corner [N/m]

    def is_worth(self, before: _Sketch) -> bool:
        """Whether the last filter is worth its place."""
        rises = self.controller.velocity_gain >= WORTH * before.controller.velocity_gain
        return rises and self.stiffness >= WORTH * before.stiffness


def find_filters(family: LoopFamily, shape: Shape) -> FilteredLoop | None:
    """Return the loop of the same shape with the filters that make the tool stiffest.

    No more than the kind of control has; None if none is worth its place, or if Kp is given.
    """
    control = family.machine.control
    begin = None if control.velocity_gain is not None else _sketch(family, shape, ())
    best = begin
    for _ in range(min(MOST, control.kind.force_filters - len(control.force_filters))):
        if best is None or (better := _add_filter(family, shape, best)) is None:
            break
        best = better
    if best is None or best is begin:
        return None
    tuned = tune_shape(best.family, shape, largest=_largest(family))
    return FilteredLoop(filters=best.filters, family=best.family, tuned=tuned) if tuned else None


def _largest(family: LoopFamily) -> float:
    return family.settings.largest_fraction


def _add_filter(family: LoopFamily, shape: Shape, before: _Sketch) -> _Sketch | None:
    """The stiffest loop with one filter more, if that is worth its place."""
    tried = (
        _sketch(family, shape, (*before.filters, item)) for item in _candidates(family, before)
    )
    good = [loop for loop in tried if loop is not None and loop.is_worth(before)]
    return max(good, key=lambda loop: loop.stiffness, default=None)


def _sketch(family: LoopFamily, shape: Shape, filters: tuple[ForceFilter, ...]) -> _Sketch | None:
    changed = with_filters(family, filters)
    fraction = tune_on_grid(changed, shape, largest=_largest(family))
    if fraction is None:
        return None
    controller = build(changed, shape, fraction=fraction)
    stiffness = changed.grid.stiffness(controller)
    return _Sketch(filters=filters, family=changed, controller=controller, stiffness=stiffness)


def _candidates(family: LoopFamily, before: _Sketch) -> Iterator[ForceFilter]:
    """Notches about every mode that the encoder sees, low-passes above the weakest frequency."""
    for mode in family.bench.model.modes:
        if mode.measured_gain:
            for place, width in product(PLACES, WIDTHS):
                yield ForceFilter(
                    kind=FilterKind.NOTCH,
                    natural_frequency=place * mode.natural_frequency,
                    damping=DEPTH * width,
                    width=width,
                )
    weakest_hz = before.family.grid.weakest_hz(before.controller)
    for factor in LOW_PASSES:
        yield ForceFilter(
            kind=FilterKind.LOW_PASS,
            natural_frequency=factor * 2.0 * pi * weakest_hz,
            damping=LOW_PASS_DAMPING,
        )
