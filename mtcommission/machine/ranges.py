"""What a quantity of a machine may be: its dimension and the ends that make sense.

The ends only catch slips of units: a thousand tonnes, a nanometre, a kilometre.
"""

from __future__ import annotations

from math import inf

from mtcommission.base.units.axis_units import LINEAR, ROTARY
from mtcommission.base.units.quantities import (
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
from mtcommission.machine.readers import AxisRange, Range

Ends = tuple[float, float]


def _same(of: Dimension, low: float, high: float, above: float = -inf) -> AxisRange:
    both = Range(of, low, high, above)
    return AxisRange(both, both)


def _of_axis(name: str, linear: Ends, rotary: Ends | None = None, above: float = -inf) -> AxisRange:
    """A quantity that is another one on a rotary axis; ``rotary`` None: with the same numbers."""
    turned = Range(getattr(ROTARY, name), *(rotary or linear), above)
    return AxisRange(Range(getattr(LINEAR, name), *linear, above), turned)


MASSES = _of_axis("mass", (1e-3, 1e6), (1e-9, 1e7), above=0.0)
LOADS = _of_axis("mass", (0.0, 1e6), (0.0, 1e7))
# The tower turns on a rotary axis as well, so its own quantities stay rotary.
INERTIAS = _same(INERTIA, 1e-9, 1e7, 0.0)
ROTARY_STIFFNESSES = _same(ROTARY_STIFFNESS, 1e-3, 1e13, 0.0)
ROTARY_DAMPINGS = _same(ROTARY_DAMPING, 0.0, 1e11)
ARMS = AxisRange(Range(LENGTH, -100.0, 100.0), Range(RATIO, -1e4, 1e4))
STIFFNESSES = _of_axis("stiffness", (1.0, 1e12), (1e-3, 1e13), above=0.0)
DAMPINGS = _of_axis("damping", (0.0, 1e10), (0.0, 1e11))
FORCES = _of_axis("force", (1e-3, 1e8), (1e-6, 1e8), above=0.0)
LEADS = _same(LENGTH, 1e-5, 100.0, 0.0)
GEARS = _same(RATIO, 1e-4, 1e4, 0.0)
RESOLUTIONS = _of_axis("length", (1e-13, 1e-3), (1e-13, 0.1), above=0.0)
FRICTIONS = _of_axis("force", (0.0, 1e8))
STATIC_LOADS = _of_axis("force", (-1e8, 1e8))
VELOCITIES = _of_axis("velocity", (1e-6, 100.0), (1e-6, 1e4), above=0.0)
ACCELERATIONS = _of_axis("acceleration", (1e-4, 1e4), (1e-4, 1e7), above=0.0)
JERKS = _of_axis("jerk", (1e-3, 1e8), (1e-3, 1e11), above=0.0)
DISTANCES = _of_axis("length", (1e-7, 1e3), (1e-7, 1e5), above=0.0)
BANDS = _of_axis("length", (1e-10, 0.1), (1e-10, 1.0), above=0.0)
MODE_GAINS = _of_axis("gain", (-1e6, 1e6), (-1e12, 1e12))
VELOCITY_GAINS = _of_axis("damping", (1e-6, 1e12), (1e-9, 1e12), above=0.0)
MODEL_TIMES = _same(TIME, 0.0, 10.0)
DELAYS = AxisRange(MODEL_TIMES.linear, MODEL_TIMES.rotary, word="auto")
LAGS = _same(TIME, 1e-6, 0.1, 0.0)
FILTER_TIMES = _same(TIME, 1e-6, 1.0, 0.0)
# Drives have 31.25 us and more, controls up to 20 ms; every simulation steps through them.
CYCLES = _same(TIME, 1e-5, 0.05, 0.0)
DWELLS = _same(TIME, 0.0, 1e5)
TIMES = _same(TIME, 1e-6, 1e4, 0.0)
FREQUENCIES = _same(FREQUENCY, 1e-2, 1e5, 0.0)
STEP_RATES = _same(FREQUENCY, 1.0, 1e9, 0.0)
POSITION_GAINS = _same(GAIN, 1e-3, 1e5, 0.0)
RATIOS = _same(RATIO, -1e30, 1e30)
SPREADS = _same(RATIO, 0.0, 1e30)
SHARES = _same(RATIO, 0.01, 1.0, 0.0)
FILTER_DAMPINGS = _same(RATIO, 0.0, 10.0)
TAPS = _same(RATIO, -10.0, 10.0)
FEEDFORWARDS = _same(RATIO, 0.0, 10.0)
# A standard error may be as small as it likes; a delay as a clock shows it may be negative.
MEASURED_FREQUENCIES = _same(FREQUENCY, 0.0, 1e6)
MEASURED_TIMES = _same(TIME, -10.0, 10.0)
MEASURED_MASSES = _of_axis("mass", (0.0, 1e8))
