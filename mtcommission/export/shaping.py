"""Input shapers: a setpoint as the sum of delayed copies of itself."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.setpoint import Setpoint

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaper:
    """A zero-vibration shaper as a control knows it.

    Parameters
    ----------
    order
        1: ZV, 2: ZVD (its derivative vanishes, too).
    frequency_hz
        Natural frequency that is typed in [Hz].
    damping_ratio
        Typed in [-].
    """

    order: int
    frequency_hz: float
    damping_ratio: float

    @property
    def name(self) -> str:
        """Name in lower case."""
        return "zv" if self.order == 1 else "zvd"


def shaper_impulses(shaper: Shaper) -> tuple[Array, Array]:
    """Return instants and amplitudes of a shaper's impulses.

    Parameters
    ----------
    shaper
        ZV or ZVD.

    Returns
    -------
    times, amplitudes
        Shapes (order + 1,) [s, -]; the amplitudes add up to 1.

    Source: Singer & Seering 1990: ZV = [1, K]/(1+K) at 0, T_d/2; ZVD is ZV twice.

    Examples
    --------
    >>> times, amplitudes = shaper_impulses(Shaper(order=2, frequency_hz=50.0, damping_ratio=0.0))
    >>> times.tolist(), amplitudes.tolist()
    ([0.0, 0.01, 0.02], [0.25, 0.5, 0.25])
    """
    zeta = shaper.damping_ratio
    K = exp(-zeta * pi / sqrt(1.0 - zeta**2))
    half_period = 0.5 / (shaper.frequency_hz * sqrt(1.0 - zeta**2))
    amplitudes = np.array([1.0])
    for _ in range(shaper.order):
        amplitudes = np.convolve(amplitudes, [1.0, K])
    times = half_period * np.arange(shaper.order + 1, dtype=np.float64)
    return times, amplitudes / amplitudes.sum()


def shape_setpoint(setpoint: Setpoint, shaper: Shaper) -> Setpoint:
    """Return a setpoint behind an input shaper.

    Parameters
    ----------
    setpoint
        Unshaped.
    shaper
        ZV or ZVD.

    Returns
    -------
    Setpoint
        Longer by the shaper's last instant.
    """
    times, amplitudes = shaper_impulses(shaper)
    knots = (times[:, None] + setpoint.knot_times).ravel()
    order = np.argsort(knots, kind="stable")
    return replace(
        setpoint,
        knot_times=knots[order],
        jerk_steps=np.outer(amplitudes, setpoint.jerk_steps).ravel()[order],
        snap_steps=np.outer(amplitudes, setpoint.snap_steps).ravel()[order],
    )
