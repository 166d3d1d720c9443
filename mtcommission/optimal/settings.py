"""The numbers of the search under bounds; all are empirical but where a source is given."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramSettings:
    """Sizes, rounds and tolerances of the program on cells; they bound what a search may take."""

    # Of one linear program.
    tolerance: float = 1e-9  # of the simplex method, against bounds of 1
    steps: int = 4
    """For each row and column, then it is given up; where it ends, 2.0 at most (measured)."""
    most_entries: float = 1.25e6  # cells times points: a second at most
    largest_offset: float = 1.0 - 1e-5
    """Of the reference over the band: the free motion rests in it."""
    # Peaks of its motion.
    near: float = 0.02  # room below a bound within which a peak is looked at closely [-]
    samples: int = 8  # of a part of a cell, among which its peaks are looked for,
    radians_per_part: float = 1.0  # of the fastest mode
    polishes: int = 4  # Newton steps from a sample to a peak
    # First cells.
    fewest_cells: int = 100  # even ones: enough to see every feature,
    radians_per_cell: float = 0.8  # and to resolve the fastest mode
    first_entries: float = 7.5e5  # cells times points: half a second
    coarsest: float = 2.5  # times that length up to which cells are even
    fewest_between: int = 200  # cells of a longer move without a cruise
    most_places: int = 1200  # points on longer cells, for the bounds between their ends
    growth: float = 0.15
    """Of cells with the distance from the ends of a long move and of its cruise."""
    finer: int = 4
    """Times as many cells where more time takes reach, which no motion loses by waiting: there a
    bound is so close to the least possible that the length of the cells decides."""
    contact_radians: float = 6.3  # of the slowest mode, in which the free motion is asked at first,
    contacts: int = 12  # at so many instants
    # The first search of t_f.
    time_steps: int = 24  # programs
    horizon: float = 60.0  # longest t_f in multiples of the free optimum
    slow: float = 10.0  # times the free optimum from which it begins at that of the rigid axis
    time_tolerance: float = 1e-3  # |α - 1| at which it ends, times dα/dlog t_f,
    least_slope: float = 0.01  # which is believed to be no less
    edge: float = 0.02  # share of a bracket of t_f at its ends in which the next time does not lie
    longer: float = 1.5  # factor between two times over which the reach has to grow,
    standstill: float = 1e-3  # by this share, or it never will
    least_tolerance: float = 2e-4
    """The smallest possible bound is rounded up by this: shorter cells would tell it so well."""
    # Rounds on finer and finer cells.
    rounds: int = 8
    exchanges: int = 12  # programs of one, in which peaks become points and t_f is corrected,
    largest_change: float = 0.02  # by so much of itself at most
    tolerances: tuple[float, ...] = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
    """What the programs of the rounds may miss of bounds and target; the last from there on."""
    most_radians: float = 3e5  # fastest rate times t_f
    enough: float = 7e-7  # gap at which cells are fine enough where no exact sequence exists
    not_better: float = 0.25  # share of the entries allowed where two gaps in a row were larger
    spoiled: float = 100.0  # times the best gap: the program held an arc where it should not
    # Which cells are divided.
    large_share: float = 0.01  # of the largest share of the time that a zero of σ hides in its cell
    beside: float = 1.0 / 8.0  # distance of further edges from a zero, in its cell: it moves
    nearby: float = 3.0  # cells about an acting point in which new edges become points, too
    # Arcs that are held, for orders 1 and 2, and for higher ones.
    chain_gap: float = 3.2
    """Of points, in the smaller of their cells: ripple may leave out every other."""
    chain_points: int = 5  # that make an arc; two or three surround a touch point
    margins: tuple[float, float] = (3.0, 15.0)  # cells between the ends of an arc and its interior,
    short: float = 0.7  # which may take this share of it
    least_arcs: tuple[float, float] = (0.0, 0.06)  # share of t_f from which an arc has an interior
    junctions: tuple[int, int] = (6, 30)  # even cells from the interior on,
    beyond: float = 0.3  # which go so far beyond the end
    insides: int = 8  # edges inside an interior, for what looks at its cells;
    apart: float = 0.3  # others keep this share of one from its ends
    # Sequences that Newton's method solves.
    most_pieces: int = 80  # it takes seconds for more
    most_growth: float = 10.0
    """Of the motion over an arc, as exponent of e, from which no digits are left."""
    edits: int = 12  # changes in one go
    vanished: float = 1e-6  # share of t_f below which a piece is taken out
    tight: float = 0.97  # share of the force limit below which a bound on F counts as tight
    passing: float = 1.5
    """Length of an arc, in force lags of the swift plant, up to which it only moves the force."""
    # What is returned.
    finishes: tuple[float, float] = (3e-8, 1e-6)
    """What a control on cells may exceed bounds by before its forces are divided by the reach: the
    second where the first asks too much."""
    spare: float = 1.2  # reach that it has to spare over that
    same_force: float = 1e-11
    """Of the force limit, within which two cells are one arc: tight bounds keep deflections to a
    thousandth of what the force limit causes."""
    same_time: float = 1e-7
    """Of t_f, within which a zero of σ is a switching time, and an edge is one that is there."""


SETTINGS = ProgramSettings()
