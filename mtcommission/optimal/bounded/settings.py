"""Numerical settings of the solver under bounds; effort is limited by counts, never by a clock."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ProofSettings:
    """What a control must keep, and how closely its dual bound is evaluated."""

    gap: float = 1e-6
    """Largest relative distance of t_f from its proved lower bound."""
    loose_gap: float = 1e-3
    """The same for a control on a mesh, which is returned with the gap that it has."""
    excess: float = 1e-9
    """Largest relative excess over a bound or the force limit."""
    terminal: float = 1e-9
    """Largest terminal error of a state against its peak."""
    same_time: float = 1e-7
    """Relative distance at which a zero of σ and a switching time count as the same."""
    density_cells_per_radian: int = 16
    """Samples of a density: its sign changes are located to a sample."""
    small_density: float = 1e-8
    """Share of the largest density below which a wrong sign is rounding."""
    rounding: float = 1e-13
    """Allowance for rounding, relative to the sum of the magnitudes of all terms: some hundred
    operations of 1.1e-16 each."""
    first_cut: float = 1e-12
    """Smallest gap that is tried, as a share of t_f: about the rounding of the integrals."""
    cut_tolerance: float = 0.05
    """Relative width to which the smallest provable gap is halved."""
    radians_per_cell: float = 0.015
    """Cells for the peaks: the cubic between samples is right to (ω h)^4 / 384 = 1.3e-10."""
    cells_per_radian: int = 4
    """First cells of the integral of |σ|; cells that may hide a zero are halved."""
    halvings: int = 14
    """Times that a cell is halved at most."""
    bisections: int = 10
    """Of a cell with a zero of σ."""
    polishes: int = 3
    """Newton steps from there: a zero off by δ costs σ' δ² of the integral."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramSettings:
    """Linear programs, and the even grid that begins the search."""

    steps_per_cell: int = 8
    """Steps of the simplex method per cell after which a grid is given up: three times what those
    that end need (measured), and an end for those that turn in circles within the rounding."""
    fewest_cells: int = 200
    most_cells: int = 600
    """Cells of the grid: enough to see every feature that the refinement needs, and few enough for
    a fraction of a second (empirical)."""
    radians_per_cell: float = 0.6
    """Between the two, cells that resolve the fastest mode of the plant, for the last one."""
    coarse_radians: float = 1.8
    """The same while t_f is searched: a program of a third of the cells costs a tenth."""
    horizon: float = 60.0
    """Longest t_f that is searched, in multiples of the free optimum."""
    far: float = 3.0
    """The same from which on a program that rounding spoils ends the search: the forces that so
    tight a bound leaves are too small beside the force limit for the simplex method."""
    time_tolerance: float = 1e-3
    """|α - 1| at which the search on the grid ends; the grid itself is no better."""
    steepness: tuple[float, float] = (0.01, 1.0)
    """Least and largest dα/dlog t_f by which that tolerance is multiplied."""
    time_steps: int = 40
    """Programs of that search at most."""
    longer: float = 1.5
    """Factor between two times over which the reach has to grow, or it never will."""
    standstill: float = 1e-3
    """Relative growth of the reach over such a factor that counts as none."""
    inside: tuple[float, float] = (0.02, 0.98)
    """Share of the bracket of t_f in which the next time lies."""
    other_grids: tuple[int, ...] = (0, 7, 23)
    """Per cent of cells added where the simplex method gives up for rounding."""
    saturated: float = 1e-6
    """Distance from a limit below which a value of the program counts as on it."""
    least_times: tuple[float, ...] = (1.6, 2.2, 3.0, 4.2, 6.0, 10.0)
    """Where the smallest possible bound is looked for, in multiples of the free optimum: it falls
    with t_f until more time does not help any more."""
    least_cells: tuple[int, ...] = (400, 800, 1600)
    """Grids for the smallest bound: the first for the search of its time, the others to refine it;
    the last only for a single bound, since the program's work grows with cells times rows."""
    least_tolerance: float = 2e-4
    """Relative change of the smallest bound, over time and over the grid, that counts as none."""
    forgiving: float = 1e-8
    """Tolerance of the last attempt, if the first one had a smaller one."""
    checks_per_step: int = 3
    """Times that the simplex method may ask whether it shall go on, against the steps allowed: 1.1
    to 1.3 where it ends (measured); one that turns in circles does so without counting steps."""
    interior_steps: int = 500
    """Steps of the interior-point method at most; some dozens are usual."""
    smallest_coefficient: float = 1e-12
    """Coefficients left out: the least that HiGHS allows. Its default of 1e-9 drops what a short
    cell does to a bound far away, and with it eight digits of the bound."""
    undecided: float = 2e-3
    """Relative distance of the smallest bound from the wanted one that the grids cannot judge."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureSettings:
    """Orders of bounds, and arcs and touch points as they are detected on a mesh."""

    most_growth: float = 10.0
    """Growth of the motion over an interior, as exponent of e: twenty thousand times."""
    order_tolerance: float = 1e-10
    """Share of its own terms below which c A^j B counts as zero (rounding of the sum)."""
    follow_level: float = 0.5
    """Share of a bound that the target itself takes, above which the bound is scaled with the
    target: otherwise a bound that the target just meets (|v_s| <= velocity step) would cap the
    reachable multiple at 1 for every longer t_f, and t_f could not be told from it."""
    chain_gap: float = 3.2
    """Distance of chained points in the smaller of their cells: ripple may leave out every
    other."""
    chain_points: int = 5
    """Points that make an arc; two or three surround a touch point."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewtonSettings:
    """Solving and editing an exact sequence."""

    shortest_subarc: float = 1e-8
    """Share of t_f below which there is no room for half a subarc off it."""
    longest_swing: float = 5.0
    """Longest bang arc of a swing from one side of a bound to the other, in multiples of what the
    force alone would take for it."""
    subarc_samples: int = 9
    """Samples of each bang arc of a subarc."""
    subarc_steps: int = 8
    """Newton steps for the shares of a subarc; it is left at once where they do not converge."""
    difference: float = 1e-6
    """Relative step of the difference quotients of a subarc, which is only a guess."""
    subarc_room: float = 0.95
    """Largest share of a boundary arc beside the middle of a zone that half a subarc off it may
    take."""
    vanished: float = 1e-8
    """Share of t_f below which a piece is taken out."""
    radians_per_sample: float = 0.05
    """Samples that look for excesses of a solved sequence."""
    apart: float = 1e-7
    """Share of t_f that a zero of σ keeps from the ends of a bang arc if it calls for a switch."""
    edits: int = 30
    """Changes of a sequence in one round: pieces taken out, subarcs and touch points put in."""
    closed_gap: float = 1e-9
    """Gap of an accepted sequence below which it is not edited any more."""
    visits: int = 2
    """How often the same sequence is solved in one round: from durations of its own each time."""
    sliver: float = 1e-6
    """Share of t_f of a piece that is taken out if the sequence can be solved without it."""
    steps: int = 20
    """Newton steps at most."""
    residual: float = 1e-10
    """Scaled residual below which a sequence counts as solved; rounding leaves 1e-15 ... 1e-12."""
    largest_step: float = 0.2
    """Largest change of a duration in one step, as a share of t_f."""
    furthest_back: float = 100.0
    """Longest negative duration that is tried, in radians of the fastest rate: the responses run
    backwards grow with its exponential."""
    growth: float = 1e4
    """Growth of the residual at which full Newton steps are given up for damped ones."""
    singular: float = 1e-13
    """Share of the largest singular value below which a direction is left alone."""
    dampings: int = 6
    """Raised dampings tried in one step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshSettings:
    """Meshes: where cells lie, what is solved on them, when they are finished."""

    most_cells: int = 1000
    """Of one program at most (empirical: some hundred are usual)."""
    point_excess: float = 1e-8
    """Relative excess over a bound between the points that calls for another point at the end."""
    margin_excess: float = 2e-7
    """Relative excess that is left to the margin: it costs less than a tenth of the allowed gap."""
    point_steps: int = 16
    finishing_steps: int = 24
    """Programs that put in points, and programs at most, until a control on a mesh is finished."""
    lateness: float = 1e-8
    """Largest reach beyond 1 of a finished control."""
    broken: float = 1e-6
    """Relative excess over a bound that calls for another point of the program; what is left is
    covered by a margin."""
    radians_per_sample: float = 0.2
    """Samples of an interior among which peaks of signals are looked for."""
    near_peak: float = 0.05
    """Relative room below a bound within which a peak between two such samples is looked at
    closely."""
    finer_samples: int = 16
    """Samples on each side of such a peak."""
    part_samples: int = 13
    """Samples of a part of a cell among which its largest excess is looked for."""
    radians_per_part: float = 2.4
    """Longest part of a cell, in the period of the fastest mode."""
    exchanges: int = 6
    """Solutions of the program on one mesh, each with the points where the last broke a bound."""
    steady: float = 2e-6
    """Change of the reach by new points below which others are left to the next mesh."""
    least_slope: float = 0.3
    """Least dα/dlog t_f believed: the marginal vanishes where the first cell hides a switch."""
    largest_change: float = 0.02
    """Largest relative change of t_f on one mesh."""
    long_way: float = 1e-3
    """Least such change that tells the slope better: points put in between lower the reach, too."""
    shrink: float = 5.0
    """Factor between the cells at a feature of two rounds."""
    background: int = 80
    """Cells of the background mesh."""
    grading: float = 1.7
    """Ratio of neighbouring cells away from a feature."""
    interior_margins: tuple[float, float] = (3.0, 15.0)
    """Distance of an interior from the ends of its arc, in cells of the round before: for orders 1
    and 2, and for higher orders, where touch points that crowd towards an arc look like its end."""
    junction_cells: tuple[int, int] = (8, 30)
    """Even cells between an interior and an end of its arc, for orders 1 and 2 and for higher
    orders, where an order above 2 is among the bounds and the mesh itself is the result. Touch
    points follow each other in a fixed ratio there, so some thirty cells show all that matter
    (measured)."""
    beyond_junction: float = 0.5
    """How far the even cells go on beyond the end of the arc, as a share of the same distance."""
    margin: float = 1e-9
    """Relative distance from the bounds kept on a mesh."""
    thinning: float = 0.4
    """Share of its cell that a point keeps from its neighbour."""
    short_arc_points: int = 60
    """Most points on an arc too short for an interior."""
    feasibility: float = 1e-10
    """Tolerance of the simplex method: its smallest."""
    steps_per_line: int = 4
    """Steps of the simplex method, against rows and columns together, after which a program is
    given up: twice what those that end need (measured), and an end for those that turn in circles
    within the rounding."""
    near: float = 1e-2
    """Relative room below a bound within which a point is in the relaxation from the start; others
    follow if they are broken. It halves the rows of that program."""
    missed: float = 1e-7
    """Relative excess at which a point left out of the relaxation is broken."""
    same_force: float = 1e-9
    """Relative difference of the forces of two cells below which they are one arc."""
    at_target: float = 1e-6
    """Distance from 1 of the share of a bound that the target takes, within which no margin is
    kept."""
    splits: int = 3
    """Times a mesh is split; what is still hidden is left to the next mesh."""
    hidden_enough: float = 2e-7
    """What all cells may hide of the time, relative to it."""
    large_share: float = 1e-2
    """Share of the largest loss from which on a zero splits its cell."""
    least_loss: float = 1e-9
    """Loss of a zero below which it never does."""
    most_split: int = 300
    """Cells split at once at most, those that hide most."""
    middle: float = 0.02
    """Share of its cell that a zero keeps from the ends: closer ones hide nothing."""
    most_filled: int = 2000
    """Most points with which an interior is filled."""
    agreed: float = 1e-6
    """Distance of the reaches of both forms from which on what is hidden is the rest of the gap."""
    hidden: float = 1e-8
    """What one cell may hide of the time, relative to it: a hundredth of the gap allowed."""
    keep_hidden: float = 1e-7
    """What a cell of twice the size might hide: above that a zero keeps its cell."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundsSettings:
    """Rounds over meshes, and the ways around them."""

    many_periods: float = 120.0
    """Periods of a cruise from which on a shorter one is solved first: before, a mesh over the
    whole move costs less (measured on the paper's machine)."""
    cruise_periods: tuple[float, float] = (3.0, 4.3)
    """Periods of the slowest mode in the cruise of the first move; the second where the first leads
    to a length at which the sequence changes in a way that no edit knows."""
    long_cruise: float = 7.5
    """Periods of a cruise from which on it can be followed from a shorter one."""
    cruise_growth: float = 1.4
    """Largest factor on the time at max_velocity in one step."""
    least_cruise_growth: float = 1.1
    """Factor below which the distance is not brought closer any more."""
    tight_force: float = 0.97
    """Share of the force limit below which a bound on F counts as tight (empirical)."""
    passing: float = 1.5
    """Length of an arc, in force lags of the swift plant, up to which it only moves the force."""
    rounds: int = 8
    """Meshes tried; each is five times as fine at the features as the one before."""
    most_radians: float = 3e4
    """Fastest rate times t_f up to which there is a mesh over the whole move: half a minute of
    computing time and 400 MB (measured); longer moves are composed, or end as too long."""
    most_cruise_radians: float = 2e5
    """The same of a cruise that is lengthened, whose motion alone is followed."""
    effort: float = 3e10
    """Sum of the efforts of all programs of a search: some 20 s of computing time."""
    programs: int = 3
    finishing: int = 4
    """Programs of a round, and programs that finish its control."""
    interiors: tuple[tuple[float, float], ...] = (
        (1.0, 0.0),
        (2.0, 0.0),
        (4.0, 0.0),
        (8.0, 0.0),
        (1.0, 0.06),
    )
    """Factors tried on the distance between an interior and the ends of its arc, with the least
    share of t_f of an arc that gets an interior."""
    fewer_interiors: tuple[tuple[float, float], ...] = ((1.0, 0.02), (1.0, 0.06), (8.0, 0.06))
    """The same on finer meshes where an order above 2 is among the bounds: what looks like a short
    arc may be touch points that crowd."""
    wider: float = 4.0
    """Factor on the distance of interiors from the ends of their arcs after a mesh that proves less
    than those before, with an order above 2 among the bounds: on smaller cells touch points that
    crowd towards an arc look like its end."""
    eases: tuple[float, ...] = (1.0, 1.7, 2.5, 3.5, 5.0, 7.0)
    """Factors tried on the cells wanted until a program is small enough."""
    first_largest: float = 1.5e9
    largest: float = 3e9
    split_largest: float = 1.2e10
    """Effort of a program that the simplex method ends within some seconds, for the first mesh,
    where many of the features are none, for others, and for one with a basis to start from."""
    setback: float = 1e-3
    """Reach below 1 on a finer mesh that betrays an interior where the bound is not held."""
    splinter: float = 2e-4
    """Share of t_f of a piece that may be the ripple of a mesh: left out where it leads nowhere."""
    finished: int = 2
    """Mesh controls that are finished at most; one with long interiors may not reach full
    precision."""
    last_splits: int = 3
    worthwhile: float = 0.7
    """Times the cells of the best mesh are split once more at the end, and the share to which the
    gap falls at least if it is to be done again."""
    timely: float = 1e-5
    """Distance of the reach from 1 up to which switches stay where the cells were split."""
    hopeless: float = 0.3
    """Gap of a first mesh that is split at once; from others the next mesh is found at less
    cost."""
    enough: float = 0.7
    """Share of the gap at which a mesh is fine enough: finishing it costs a little."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundedSettings:
    """Numerical settings of the solver under bounds, by the package that uses them."""

    proof: ProofSettings = ProofSettings()
    program: ProgramSettings = ProgramSettings()
    structure: StructureSettings = StructureSettings()
    newton: NewtonSettings = NewtonSettings()
    mesh: MeshSettings = MeshSettings()
    search: RoundsSettings = RoundsSettings()


STANDARD = BoundedSettings()
