"""How finely the limits are searched, printed on the sheet."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Where and how finely to search.

    Parameters
    ----------
    least_acceleration
        As a share of F_max/m [-]; less where that still settles sooner than what is known.
    least_jerk_time
        [s].
    longest_jerk_time, slow_jerk_time
        In periods of the slowest mode [-], and [s]: the longer one ends the search where no
        limits are known to meet the requirements. Where some are, the search ends where the
        setpoint alone takes longer than they do, and nothing beyond can settle sooner.
    grid
        Points in each direction over the widest region, logarithmic; a narrower one is searched
        as finely.
    coarse_grid
        Points in each direction at which force and peaks are simulated to guide the search.
    seeds, refinements
        Cells refined at once, and how often each is halved.
    digits
        Significant digits of the limits.
    landscape
        Points in each direction of the landscape to be printed.
    """

    least_acceleration: float = 0.05
    least_jerk_time: float = 0.5e-3
    longest_jerk_time: float = 3.0
    slow_jerk_time: float = 0.05
    grid: int = 96
    coarse_grid: int = 12
    seeds: int = 24
    refinements: int = 6
    digits: int = 3
    landscape: int = 64
