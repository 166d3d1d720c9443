"""Machines that differ from the nominal one: drawn, listed, or scaled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.corners import Corner
from mtcommission.machine.machine import Machine

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Variations:
    """Machines that differ from the nominal one.

    Parameters
    ----------
    payload
        Shape (n_samples,) [kg].
    frequency_factor, damping_factor
        Factors on all eigenfrequencies and damping ratios, shape (n_samples,) [-].
    """

    payload: Array
    frequency_factor: Array
    damping_factor: Array

    def corner(self, index: int) -> Corner:
        """Return one sample as a corner."""
        return Corner(
            payload=float(self.payload[index]),
            frequency_factor=float(self.frequency_factor[index]),
            damping_factor=float(self.damping_factor[index]),
        )


def draw_variations(machine: Machine, *, samples: int, seed: int) -> Variations:
    """Return machines drawn uniformly from the stated ranges.

    Parameters
    ----------
    machine
        Its requirements state payload and spreads.
    samples
        How many.
    seed
        Of the generator.

    Returns
    -------
    Variations
    """
    generator, needs = np.random.default_rng(seed), machine.requirements

    def factor(spread: float) -> Array:
        return generator.uniform(1.0 - spread, 1.0 + spread, samples)

    return Variations(
        payload=generator.uniform(*needs.payload, samples),
        frequency_factor=factor(needs.frequency_spread),
        damping_factor=factor(needs.damping_spread),
    )


def as_variations(places: Sequence[Corner]) -> Variations:
    """Return corners as variations, in the same order."""
    return Variations(
        payload=np.array([corner.payload for corner in places]),
        frequency_factor=np.array([corner.frequency_factor for corner in places]),
        damping_factor=np.array([corner.damping_factor for corner in places]),
    )


def scale_variations(
    variations: Variations, *, frequency: float = 1.0, damping: float = 1.0
) -> Variations:
    """Return the same machines with all frequencies or damping ratios times a factor [-]."""
    return replace(
        variations,
        frequency_factor=variations.frequency_factor * frequency,
        damping_factor=variations.damping_factor * damping,
    )
