"""Numerical settings of the optimum with a band."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BandSettings:
    """How a force that is constant on cells approaches the optimum."""

    many_periods: float = 60.0
    """Of the slowest mode, from which on cells that show every switch take minutes: there it is
    asked what a band saves only if that may be worth while."""
    worthwhile: float = 0.01
    """Share of the optimum with exact rest by which it exceeds the rigid axis's, from there on: no
    band saves more [-]."""
    cells: int = 120
    """Cells at first: enough to show every switch of a move of some dozen radians (empirical)."""
    parts: int = 6
    """Pieces of each cell at which the force switches, in the next refinement."""
    refinements: int = 3
    """The last has cells of 1/26 000 of the move at its switches."""
    gap: float = 2e-5
    """Distance of t_f from its proved bound at which the search ends."""
    margin: float = 1e-5
    """Share of the band that is kept free for what lies between its rows."""
    velocity_margin: float = 1e-4
    """Share of max_velocity that is kept free for what lies between the points of cells."""
    most_velocity_margin: float = 0.03
    """The same at most, where that is not enough."""
    exchanges: int = 25
    """Rounds in which the free motion's peaks become rows, at most; two to five are usual."""
    time_tolerance: float = 1e-7
    """Relative accuracy of t_f on given cells."""
    first_contacts: int = 12
    """Rows of the free motion per period of the slowest mode, over its first two periods."""
    radians: float = 0.1
    """Samples of the free motion: a cubic between them errs by 2.6e-7 of its amplitude."""
    most_samples: int = 400_000
    """Of a free motion, until it has decayed below the band: forty thousand radians."""
    steps: int = 20_000
    """Of the simplex method, for one program."""
    frequencies: int = 5
    """Of the spread, in the first program of a robust force."""
    checked_frequencies: int = 81
    """Of the spread, at which a robust force is checked; the worst ones become rows, too."""
    robust_margin: float = 0.01
    """Share of the band that a robust force keeps free for frequencies between those."""
