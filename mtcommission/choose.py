"""The acceleration and jerk that let the slowest move settle soonest, in every corner.

The landscape of settling time over (a, t_j) is full of narrow valleys, where a ramp or the
distance of two ramps happens to cancel a mode. So the search is global first (a grid over
both, every corner, by exact superposition), then local in the best cells at once, and what it
finds is judged again by the full simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, floor, isfinite, log10

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator

from mtcommission.limits import MotionLimits
from mtcommission.loop.superposition import (
    SEARCH_HORIZON,
    ResponseTables,
    Settling,
    build_tables,
    find_extremes,
    moving_average_steps,
    settle,
    sketch_tables,
)
from mtcommission.loop.tuning import TunedLoop
from mtcommission.machine import Machine, Move, moving_mass
from mtcommission.plant import Plant
from mtcommission.rules import longest_period
from mtcommission.setpoint import JerkSteps, jerk_steps, reached_acceleration

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Where and how finely to search.

    Parameters
    ----------
    least_acceleration
        As a share of F_max/m [-].
    least_jerk_time
        [s].
    longest_jerk_time, slow_jerk_time
        In periods of the slowest mode [-], and [s]: the longer one ends the search. On a stiff
        axis the servo tail wants longer ramps than any mode.
    grid
        Points in each direction, logarithmic.
    coarse_grid
        Points in each direction at which force and peaks are simulated to guide the search.
    seeds, refinements
        Cells refined at once, and how often each is halved.
    digits
        Significant digits of what is to be typed in.
    """

    least_acceleration: float = 0.05
    least_jerk_time: float = 0.5e-3
    longest_jerk_time: float = 3.0
    slow_jerk_time: float = 0.05
    grid: int = 64
    coarse_grid: int = 12
    seeds: int = 24
    refinements: int = 6
    digits: int = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choice:
    """Recommended limits and what the search saw.

    Parameters
    ----------
    limits
        Rounded to what is typed in.
    bound_by
        What forbids faster limits.
    meets_requirements
        Whether all requirements hold by the search's own judgement.
    acceleration, jerk_time
        Axes of the landscape, shapes (n,), (n,).
    settling_time, residual_deviation
        Worst over moves and corners, shape (n, n) [s, m]; inf where not settled in the horizon.
    usage
        Share of the force limit (and of bounded peaks and RMS force) that is used, worst case,
        interpolated from a coarse grid, shape (n, n) [-].
    evaluations
        Limits judged in every corner.
    """

    limits: MotionLimits
    bound_by: str
    meets_requirements: bool
    acceleration: Array
    jerk_time: Array
    settling_time: Array
    residual_deviation: Array
    usage: Array
    evaluations: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Bench:
    """All that judging limits needs, computed once.

    ``tables`` and ``sketches`` hold the response in each corner, exactly and for a first look.
    ``signals`` are rows over the outputs of one velocity cycle, with their ``bounds`` and
    ``names``; the first one is the set force.
    """

    machine: Machine
    tuned: TunedLoop
    tables: tuple[ResponseTables, ...]
    sketches: tuple[ResponseTables, ...]
    signals: Array
    bounds: Array
    names: tuple[str, ...]
    tail: float

    @property
    def band(self) -> float:
        return self.machine.requirements.tcp_deviation

    @property
    def order(self) -> int:
        return self.tables[0].order


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Pool:
    """Limits judged so far: worst settling time, residual, and the guessed use of force."""

    acceleration: Array
    jerk_time: Array
    settling: Array
    residual: Array
    usage: Array


def choose_limits(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    starts: Sequence[MotionLimits] = (),
    settings: SearchSettings | None = None,
) -> Choice:
    """Return the limits with the least worst-case settling time that meet all requirements.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.
    starts
        Limits to refine from besides the grid's best, e.g. from the optima.
    settings
        None: the defaults.

    Returns
    -------
    Choice
        Where nothing meets the requirements, the limits with the least settling time within
        force and peaks.
    """
    settings = settings or SearchSettings()
    a_max = machine.drive.motion_force / moving_mass(machine)
    a_axis = np.geomspace(settings.least_acceleration * a_max, a_max, settings.grid)
    t_axis = np.geomspace(
        settings.least_jerk_time,
        max(
            settings.longest_jerk_time * min(longest_period(plant), 1.0),
            settings.slow_jerk_time,
        ),
        settings.grid,
    )
    bench = _build_bench(machine, plant, tuned, float(a_axis[0]), float(t_axis[-1]))
    guess = _guess_usage(bench, a_axis, t_axis, settings.coarse_grid)
    a_grid, t_grid = (axis.ravel() for axis in np.meshgrid(a_axis, t_axis, indexing="ij"))
    grid = _look(bench, guess, a_grid, t_grid)
    cell = float(a_axis[1] / a_axis[0]), float(t_axis[1] / t_axis[0])
    pool = _refine(bench, guess, grid, starts, settings, cell=cell, urgency=RESIDUAL_URGENCY)
    if not np.any((pool.residual <= bench.band) & (pool.usage <= 1.0)):
        # Nothing comes to rest within the band: then the least settling time alone counts.
        pool = _refine(bench, guess, pool, (), settings, cell=cell, urgency=0.0)
    limits, feasible = _pick(bench, pool, settings)
    return Choice(
        limits=limits,
        bound_by=_explain(bench, limits, feasible),
        meets_requirements=feasible,
        acceleration=a_axis,
        jerk_time=t_axis,
        settling_time=grid.settling.reshape(settings.grid, settings.grid),
        residual_deviation=grid.residual.reshape(settings.grid, settings.grid),
        usage=grid.usage.reshape(settings.grid, settings.grid),
        evaluations=len(pool.settling),
    )


ROUNDING = 1.05
"""Room in the tables for setpoints that rounding makes longer: two limits by 1 % each at most."""


def _build_bench(
    machine: Machine, plant: Plant, tuned: TunedLoop, least_acceleration: float, jerk_time: float
) -> _Bench:
    slowest = np.array([least_acceleration]), np.array([least_acceleration / jerk_time])
    filter_time = machine.control.moving_average_time
    longest = max(
        float(jerk_steps(move, acceleration=slowest[0], jerk=slowest[1]).duration[0])
        for move in machine.moves
    )
    tables = tuple(
        build_tables(
            loop, lifted, longest=ROUNDING * (longest + filter_time), filtered=filter_time > 0.0
        )
        for loop, lifted in zip(tuned.loops, tuned.lifted, strict=True)
    )
    needs, n = machine.requirements, plant.order
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])  # tcp, encoder, force, then the states
    rows = [np.eye(n + 3)[2], *(outputs @ plant.row(peak.name) for peak in needs.peaks)]
    return _Bench(
        machine=machine,
        tuned=tuned,
        tables=tables,
        sketches=tuple(map(sketch_tables, tables, (loop.plant for loop in tuned.loops))),
        signals=np.array(rows),
        bounds=np.array([machine.drive.motion_force, *(peak.bound for peak in needs.peaks)]),
        names=("force limit", *(f"peak {peak.name}" for peak in needs.peaks)),
        tail=tables[0].reference_delay + 1.5 * min(longest_period(plant), 0.2),
    )


def _steps(bench: _Bench, move: Move, acceleration: Array, jerk_time: Array) -> JerkSteps:
    steps = jerk_steps(move, acceleration=acceleration, jerk=acceleration / jerk_time)
    time = bench.machine.control.moving_average_time
    return moving_average_steps(steps, time=time) if time > 0.0 else steps


def _settle(
    bench: _Bench, tables_by_corner: Sequence[ResponseTables], a: Array, t_j: Array
) -> Settling:
    """Worst settling time and residual over moves and corners."""
    settling, residual = np.zeros_like(a), np.zeros_like(a)
    for move in bench.machine.moves:
        steps = _steps(bench, move, a, t_j)
        for tables in tables_by_corner:
            found = settle(tables, steps, band=bench.band)
            settling = np.maximum(settling, found.settling_time)
            residual = np.maximum(residual, found.residual_deviation)
    return Settling(settling_time=settling, residual_deviation=residual)


def _look(bench: _Bench, guess: RegularGridInterpolator, a: Array, t_j: Array) -> _Pool:
    """A first look at many limits: what is picked from it is judged exactly later."""
    found = _settle(bench, bench.sketches, a, t_j)
    settling, residual = found.settling_time, found.residual_deviation
    usage = guess(np.column_stack([np.log(a), np.log(t_j)]))
    return _Pool(acceleration=a, jerk_time=t_j, settling=settling, residual=residual, usage=usage)


def _usage(bench: _Bench, a: Array, t_j: Array) -> Array:
    """Share of every bound on force and peaks that is used, worst case, (n_limits, n_bounds)."""
    drive = bench.machine.drive
    limited = isfinite(drive.continuous_force)
    used = np.zeros((len(a), len(bench.bounds) + limited))
    for move in bench.machine.moves:
        steps = _steps(bench, move, a, t_j)
        for lifted in bench.tuned.lifted:
            found = find_extremes(
                lifted,
                steps,
                signals=bench.signals,
                order=bench.order,
                dwell=move.dwell,
                tail=bench.tail,
            )
            share = found.peaks / bench.bounds
            if limited:
                load = abs(drive.static_load)
                square = found.mean_square_force + load**2 + 2 * load * np.abs(found.mean_force)
                share = np.column_stack([share, np.sqrt(square) / drive.continuous_force])
            used = np.maximum(used, share)
    return used


def _guess_usage(
    bench: _Bench, a_axis: Array, t_axis: Array, points: int
) -> RegularGridInterpolator:
    """The use of force and peaks is smooth in (a, t_j), so a coarse grid guides the search."""
    a = np.geomspace(a_axis[0], a_axis[-1], points)
    t = np.geomspace(t_axis[0], t_axis[-1], points)
    a_grid, t_grid = (axis.ravel() for axis in np.meshgrid(a, t, indexing="ij"))
    used = _usage(bench, a_grid, t_grid).max(axis=1).reshape(points, points)
    return RegularGridInterpolator(
        (np.log(a), np.log(t)), used, bounds_error=False, fill_value=None
    )


RESIDUAL_URGENCY = 0.5
"""Power by which a residual above the band lengthens the settling time in the ranking of seeds
(empirical)."""


def _score(bench: _Bench, pool: _Pool, urgency: float) -> Array:
    """Settling time, lengthened by how far the requirements are missed (to rank seeds only)."""
    missed = np.maximum(pool.residual / bench.band, 1.0) ** urgency
    settling = np.where(np.isfinite(pool.settling), pool.settling, 2.0 * SEARCH_HORIZON)
    return np.asarray(settling * missed * np.maximum(pool.usage, 1.0) ** 4)


def _refine(
    bench: _Bench,
    guess: RegularGridInterpolator,
    grid: _Pool,
    starts: Sequence[MotionLimits],
    settings: SearchSettings,
    *,
    cell: tuple[float, float],
    urgency: float,
) -> _Pool:
    """Halve the best cells again and again, all at once."""
    best = np.argsort(_score(bench, grid, urgency), kind="stable")[: settings.seeds]
    low_a, high_a = grid.acceleration.min(), grid.acceleration.max()
    low_t, high_t = grid.jerk_time.min(), grid.jerk_time.max()
    a = np.concatenate([grid.acceleration[best], [limits.acceleration for limits in starts]])
    t = np.concatenate([grid.jerk_time[best], [limits.jerk_time for limits in starts]])
    pools = [grid]
    offsets = np.array(list(product((-1.0, -0.5, 0.0, 0.5, 1.0), repeat=2)))
    for level in range(settings.refinements):
        width = 0.5**level
        near_a = np.clip(a[:, None] * cell[0] ** (width * offsets[:, 0]), low_a, high_a)
        near_t = np.clip(t[:, None] * cell[1] ** (width * offsets[:, 1]), low_t, high_t)
        pool = _look(bench, guess, near_a.ravel(), near_t.ravel())
        pools.append(pool)
        winner = np.argmin(_score(bench, pool, urgency).reshape(near_a.shape), axis=1)
        rows = np.arange(len(a))
        a, t = near_a[rows, winner], near_t[rows, winner]
    return _Pool(
        acceleration=np.concatenate([pool.acceleration for pool in pools]),
        jerk_time=np.concatenate([pool.jerk_time for pool in pools]),
        settling=np.concatenate([pool.settling for pool in pools]),
        residual=np.concatenate([pool.residual for pool in pools]),
        usage=np.concatenate([pool.usage for pool in pools]),
    )


USAGE_DOUBT = 0.05
"""Error allowed for in the guessed use of force before it is simulated (measured: below 3 %)."""

LEADERS = 64
"""Candidates whose force is simulated together, and then their rounded neighbours, best first."""

ROUNDING_DOUBT = 0.005
"""Error allowed for in the use of force of a rounded neighbour before it is simulated, when it is
taken as the candidate's own in proportion to the limit that grows more (empirical)."""

DIGIT_WORTH = 0.002
"""Share of settling time that one digit less to type is worth (design choice)."""


def _pick(bench: _Bench, pool: _Pool, settings: SearchSettings) -> tuple[MotionLimits, bool]:
    """Best limits after rounding to typed digits, and whether they meet the requirements."""
    longest = bench.machine.requirements.max_settling_time
    possible = pool.usage <= 1.0 + USAGE_DOUBT
    good = possible & (pool.residual <= bench.band) & (pool.settling <= longest)
    for wanted, meets in ((good, True), (possible, False)):
        order = np.flatnonzero(wanted)
        order = order[np.lexsort((pool.residual[order], pool.settling[order]))]
        for start in range(0, len(order), LEADERS):
            part = order[start : start + LEADERS]
            a, t = pool.acceleration[part], pool.jerk_time[part]
            used = _usage(bench, a, t).max(axis=1)
            limits = _round(bench, a, t, used, settings, meets=meets)
            if limits:
                return limits[0], meets
    least = int(np.argmin(pool.usage))
    a_least, t_least = float(pool.acceleration[least]), float(pool.jerk_time[least])
    return (
        MotionLimits(
            acceleration=_neighbours(a_least, settings.digits, 0)[0],
            jerk=_neighbours(a_least / t_least, settings.digits, 0)[0],
        ),
        False,
    )


def _round(
    bench: _Bench, a: Array, t_j: Array, used: Array, settings: SearchSettings, *, meets: bool
) -> list[MotionLimits]:
    """The fastest neighbour with few digits that still holds; empty if rounding spoils all."""
    pairs: dict[tuple[float, float], int] = {}
    for one, ramp, share in zip(a, t_j, used, strict=True):
        reached = max(
            reached_acceleration(move, acceleration=one, jerk=one / ramp)
            for move in bench.machine.moves
        )
        for digits, reach in ((settings.digits, 1), (settings.digits + 1, 0)):
            near = product(
                _neighbours(reached, digits, reach), _neighbours(one / ramp, digits, reach)
            )
            for pair in near:
                growth = max(pair[0] / reached, pair[1] * ramp / one)
                if share * growth <= 1.0 + ROUNDING_DOUBT:
                    pairs.setdefault(pair, digits)
    if not pairs:
        return []
    acceleration, jerk = np.array(list(pairs)).T
    found = _settle(bench, bench.tables, acceleration, acceleration / jerk)
    good = np.isfinite(found.settling_time) | (not meets)
    if meets:
        good &= found.residual_deviation <= bench.band
        good &= found.settling_time <= bench.machine.requirements.max_settling_time
    cost = found.settling_time * (1.0 + DIGIT_WORTH * np.array(list(pairs.values())))
    order = np.flatnonzero(good)
    order = order[np.argsort(cost[order], kind="stable")]
    for start in range(0, len(order), LEADERS):
        part = order[start : start + LEADERS]
        exact = _usage(bench, acceleration[part], acceleration[part] / jerk[part]).max(axis=1)
        for i in part[exact <= 1.0]:
            return [MotionLimits(acceleration=float(acceleration[i]), jerk=float(jerk[i]))]
    return []


def _neighbours(value: float, digits: int, reach: int) -> list[float]:
    """The numbers with few significant digits around a value, ``reach`` more on either side."""
    exponent = floor(log10(value)) - digits + 1
    scaled = value / 10.0**exponent
    around = range(floor(scaled) - reach, ceil(scaled) + reach + 1)
    return [float(f"{number}e{exponent}") for number in around if number > 0]


def _explain(bench: _Bench, limits: MotionLimits, feasible: bool) -> str:
    """Name what breaks when either limit is raised a little."""
    steps = (1.01, 1.03, 1.1)
    pairs = [(f, 1.0) for f in steps] + [(1.0, f) for f in steps] + [(f, f) for f in steps]
    factors = np.array(pairs)
    a = limits.acceleration * factors[:, 0]
    t = a / (limits.jerk * factors[:, 1])
    used = _usage(bench, a, t) > 1.0
    names = list(bench.names)
    if isfinite(bench.machine.drive.continuous_force):
        names.append("RMS force")
    broken = {name for name, column in zip(names, used.T, strict=True) if column.any()}
    residual = _settle(bench, bench.tables, a, t).residual_deviation
    if np.any(residual > bench.band):
        broken.add("residual deviation")
    ordered = [name for name in ("residual deviation", *names) if name in broken]
    if not feasible:
        return "least settling time; no limits meet all requirements"
    return " and ".join(ordered) if ordered else "settling time (higher limits settle later)"
