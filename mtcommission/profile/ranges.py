"""What a quantity of a profile may be: its dimension and the ends that make sense.

The ends only catch slips of units: a thousand tonnes, a nanometre, a kilometre.
"""

from __future__ import annotations

from math import inf

from mtcommission.profile.values import Quantity, Range
from mtcommission.units.axis_units import LINEAR, ROTARY
from mtcommission.units.quantities import (
    FREQUENCY,
    GAIN,
    INERTIA,
    LENGTH,
    RATIO,
    ROTARY_DAMPING,
    ROTARY_STIFFNESS,
    TIME,
    Dimension,
)


def _range(dimension: Dimension, low: float, high: float, above: float = -inf) -> Range:
    return Range(dimension=dimension, low=low, high=high, above=above)


def _same(dimension: Dimension, low: float, high: float, above: float = -inf) -> Quantity:
    both = _range(dimension, low, high, above)
    return Quantity(both, both)


MASS_Q = Quantity(_range(LINEAR.mass, 1e-3, 1e6, 0.0), _range(ROTARY.mass, 1e-9, 1e7, 0.0))
LOAD_Q = Quantity(_range(LINEAR.mass, 0.0, 1e6), _range(ROTARY.mass, 0.0, 1e7))
# The tower turns on a rotary axis as well, so its own quantities stay rotary.
INERTIA_Q = _same(INERTIA, 1e-9, 1e7, 0.0)
ROTARY_STIFFNESS_Q = _same(ROTARY_STIFFNESS, 1e-3, 1e13, 0.0)
ROTARY_DAMPING_Q = _same(ROTARY_DAMPING, 0.0, 1e11)
ARM_Q = Quantity(_range(LENGTH, -100.0, 100.0), _range(RATIO, -1e4, 1e4))
STIFFNESS_Q = Quantity(
    _range(LINEAR.stiffness, 1.0, 1e12, 0.0), _range(ROTARY.stiffness, 1e-3, 1e13, 0.0)
)
DAMPING_Q = Quantity(_range(LINEAR.damping, 0.0, 1e10), _range(ROTARY.damping, 0.0, 1e11))
FORCE_Q = Quantity(_range(LINEAR.force, 1e-3, 1e8, 0.0), _range(ROTARY.force, 1e-6, 1e8, 0.0))
WEIGHT_Q = Quantity(_range(LINEAR.force, -1e8, 1e8), _range(ROTARY.force, -1e8, 1e8))
VELOCITY_Q = Quantity(
    _range(LINEAR.velocity, 1e-6, 100.0, 0.0), _range(ROTARY.velocity, 1e-6, 1e4, 0.0)
)
DISTANCE_Q = Quantity(_range(LINEAR.length, 1e-7, 1e3, 0.0), _range(ROTARY.length, 1e-7, 1e5, 0.0))
BAND_Q = Quantity(_range(LINEAR.length, 1e-10, 0.1, 0.0), _range(ROTARY.length, 1e-10, 1.0, 0.0))
MODE_GAIN_Q = Quantity(_range(LINEAR.gain, -1e6, 1e6), _range(ROTARY.gain, -1e12, 1e12))
VELOCITY_GAIN_Q = Quantity(
    _range(LINEAR.damping, 1e-6, 1e12, 0.0), _range(ROTARY.damping, 1e-9, 1e12, 0.0)
)
DELAY_Q = Quantity(_range(TIME, 0.0, 10.0), _range(TIME, 0.0, 10.0), word="auto")
LAG_Q = _same(TIME, 1e-6, 0.1, 0.0)
FILTER_TIME_Q = _same(TIME, 1e-6, 1.0, 0.0)
# Drives have 31.25 us and more, controls up to 20 ms; every simulation steps through them.
CYCLE_Q = _same(TIME, 1e-5, 0.05, 0.0)
DWELL_Q = _same(TIME, 0.0, 1e5)
TIME_Q = _same(TIME, 1e-6, 1e4, 0.0)
FREQUENCY_Q = _same(FREQUENCY, 1e-2, 1e5, 0.0)
GAIN_Q = _same(GAIN, 1e-3, 1e5, 0.0)
RATIO_Q = _same(RATIO, -1e30, 1e30)
SPREAD_Q = _same(RATIO, 0.0, 1e30)
FILTER_DAMPING_Q = _same(RATIO, 0.0, 10.0)
FEEDFORWARD_Q = _same(RATIO, 0.0, 10.0)
