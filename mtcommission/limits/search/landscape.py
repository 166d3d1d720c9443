"""The landscape of settling time over acceleration and jerk time, to be printed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.search.bench import Bench, settle_gradually
from mtcommission.limits.search.explore import Guess
from mtcommission.limits.search.region import Region

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Landscape:
    """Worst over moves and corners, at a first look.

    Parameters
    ----------
    acceleration, jerk_time
        Axes, shapes (n,), (n,) [m/s², s].
    settling_time, residual_deviation
        Shape (n, n) [s, m]; inf where not settled in the horizon.
    usage
        Share of the available force (and of bounded peaks and RMS force) that is used,
        interpolated from a coarse grid, shape (n, n) [-].
    """

    acceleration: Array
    jerk_time: Array
    settling_time: Array
    residual_deviation: Array
    usage: Array


def chart_landscape(bench: Bench, guess: Guess, region: Region, *, points: int) -> Landscape:
    """Return the landscape over a whole region.

    Parameters
    ----------
    bench, guess
        For the region.
    region
        Its ends are the ends of the axes.
    points
        In each direction, logarithmic.

    Returns
    -------
    Landscape
    """
    a = np.geomspace(region.least_acceleration, region.largest_acceleration, points)
    t = np.geomspace(region.shortest_jerk_time, region.longest_jerk_time, points)
    a_grid, t_grid = (axis.ravel() for axis in np.meshgrid(a, t, indexing="ij"))
    *_, (_, found) = settle_gradually(bench, bench.sketches, a_grid, t_grid)
    return Landscape(
        acceleration=a,
        jerk_time=t,
        settling_time=found.settling_time.reshape(points, points),
        residual_deviation=found.residual_deviation.reshape(points, points),
        usage=guess.at(a_grid, t_grid).reshape(points, points),
    )
