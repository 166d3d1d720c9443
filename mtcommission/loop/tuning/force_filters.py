"""Notch and low-pass filters of the set force that let Kp rise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import pi

import numpy as np

from mtcommission.loop.tuning.cascade import Shape
from mtcommission.loop.tuning.family import LoopFamily, tune_with_filters
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
    """A loop with filters that the profile does not name.

    Parameters
    ----------
    filters
        Those that were added.
    family, tuned
        Of the loop, with all filters, and the loop in every corner.
    """

    filters: tuple[ForceFilter, ...]
    family: LoopFamily
    tuned: TunedLoop


def find_filters(family: LoopFamily, shape: Shape, tuned: TunedLoop) -> FilteredLoop | None:
    """Return the loop of the same shape with the filters that make the tool stiffest.

    Parameters
    ----------
    family, shape, tuned
        The loop without more filters than are given.

    Returns
    -------
    FilteredLoop or None
        With no more filters than the kind of control has; None if none is worth its place, or if
        Kp is given.
    """
    control = family.machine.control
    if control.velocity_gain is not None:
        return None
    found: FilteredLoop | None = None
    for _ in range(min(MOST, control.kind.force_filters - len(control.force_filters))):
        better = _add_filter(
            family, shape, found.filters if found else (), found.tuned if found else tuned
        )
        if better is None:
            break
        found = better
    return found


def _add_filter(
    family: LoopFamily, shape: Shape, added: tuple[ForceFilter, ...], tuned: TunedLoop
) -> FilteredLoop | None:
    """The stiffest loop with one filter more, if that is worth its place."""
    loops = []
    for item in _candidates(family, tuned):
        filters = (*added, item)
        given = family.machine.control.force_filters
        changed, found = tune_with_filters(family, shape, (*given, *filters))
        if found is not None and _is_worth(tuned, found):
            loops.append(FilteredLoop(filters=filters, family=changed, tuned=found))
    return max(loops, key=lambda loop: loop.tuned.least_stiffness, default=None)


def _is_worth(before: TunedLoop, after: TunedLoop) -> bool:
    rises = after.controller.velocity_gain >= WORTH * before.controller.velocity_gain
    return rises and after.least_stiffness >= WORTH * before.least_stiffness


def _candidates(family: LoopFamily, tuned: TunedLoop) -> Iterator[ForceFilter]:
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
    peaks = [1.0 / np.abs(1.0 + response.open_loop) for response in tuned.responses]
    worst = max(range(len(peaks)), key=lambda i: float(np.max(peaks[i])))
    weakest_hz = float(tuned.responses[worst].frequency_hz[np.argmax(peaks[worst])])
    for factor in LOW_PASSES:
        yield ForceFilter(
            kind=FilterKind.LOW_PASS,
            natural_frequency=factor * 2.0 * pi * weakest_hz,
            damping=LOW_PASS_DAMPING,
        )
