"""All that judging limits needs, computed once: settling and use of force, in every corner."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import require_room
from mtcommission.loop.analysis.quantisation import SIGMAS, encoder_noise
from mtcommission.loop.batch.extremes import find_extremes
from mtcommission.loop.batch.settling import Settling, settle
from mtcommission.loop.batch.tables import ResponseTables, build_tables, sketch_tables
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move
from mtcommission.machine.requirement import (
    CONTOUR_DEVIATION,
    RMS_FORCE,
    SET_FORCE,
    Requirement,
    peak_of,
    slow_to_feed,
)
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps

Array = NDArray[np.float64]

ROUNDING = 1.05
"""Room in the tables for setpoints that rounding makes longer: two limits by 1 % each at most."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """What limits are judged with.

    Parameters
    ----------
    machine, tuned
        The nominal machine, and its loop in every corner.
    tables, sketches
        The response in each corner, exactly and for a first look.
    signals
        Rows over the outputs of one velocity cycle; the first one is the set force.
    bounds
        Largest allowed magnitude of each signal, without the encoder's noise.
    band, contour, continuous
        Allowed residual deviation, deviation along the path and RMS force, likewise [m, m, N].
    requirements
        All that bounds force and motion: what the signals come from, then contour and RMS force
        where they are bounded.
    tail
        Free motion in which force and peaks are looked at [s].
    decisive
        Corners in which force and peaks are looked at: no other asks for noticeably more.
    """

    machine: Machine
    tuned: TunedLoop
    tables: tuple[ResponseTables, ...]
    sketches: tuple[ResponseTables, ...]
    signals: Array
    bounds: Array
    band: float
    contour: float
    continuous: float
    requirements: tuple[Requirement, ...]
    tail: float
    decisive: tuple[int, ...]


def build_bench(machine: Machine, plant: Plant, tuned: TunedLoop, *, longest: float) -> Bench:
    """Return the bench for setpoints up to a duration.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant, its loop in every corner.
    longest
        Longest setpoint that will be judged, filter included [s].
    """
    given = machine.control.setpoint_filter
    order = 3 + len(given.averages) if given else 3
    tables: list[ResponseTables] = []
    for loop in tuned.loops:
        tables.append(build_tables(loop, longest=ROUNDING * longest, order=order))
        require_room(sum(item.nbytes for item in tables) / 8, array="allowance-transients")
    needs, n = machine.requirements, plant.order
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])  # tcp, encoder, force, then the states
    rows = [np.eye(n + 3)[2], *(outputs @ plant.row(peak.name) for peak in needs.peaks)]
    bounded = [SET_FORCE, *(peak_of(peak.name) for peak in needs.peaks)]
    if isfinite(needs.contour_deviation):
        bounded.append(CONTOUR_DEVIATION)
    if isfinite(machine.drive.continuous_force):
        bounded.append(RMS_FORCE)
    drive = machine.drive
    noises = [encoder_noise(loop, resolution=drive.encoder_resolution) for loop in tuned.loops]
    tool, force = max(item.tool for item in noises), max(item.force for item in noises)
    set_force = _left(drive.motion_force, force)
    return Bench(
        machine=machine,
        tuned=tuned,
        tables=tuple(tables),
        sketches=tuple(map(sketch_tables, tables, (loop.plant for loop in tuned.loops))),
        signals=np.array(rows),
        bounds=np.array([set_force, *(peak.bound for peak in needs.peaks)]),
        band=_left(needs.tcp_deviation, tool),
        contour=_left(needs.contour_deviation, tool),
        continuous=sqrt(_left(drive.continuous_force**2, (force / SIGMAS) ** 2)),
        requirements=tuple(bounded),
        tail=tables[0].reference_delay + 1.5 * min(longest_period(plant), 0.2),
        decisive=tuple(range(len(tuned.loops))),
    )


def _left(bound: float, noise: float) -> float:
    """What noise leaves of a bound; where that is nothing, so little that nothing meets it."""
    return max(bound - noise, HARDLY * bound)


HARDLY = 1e-3
"""Share of a bound that stands for nothing left of it [-]."""


def plan_steps(machine: Machine, move: Move, acceleration: Array, jerk_time: Array) -> JerkSteps:
    """Return the steps of a move's setpoints, behind the control's setpoint filter."""
    steps = jerk_steps(move, acceleration=acceleration, jerk=acceleration / jerk_time)
    return filter_steps(steps, machine.control.setpoint_filter)


def motion_time(machine: Machine, acceleration: Array, jerk_time: Array) -> Array:
    """Return t_e of the slowest move, filter included, shape (n_limits,) [s]."""
    durations = [
        plan_steps(machine, move, acceleration, jerk_time).duration for move in machine.moves
    ]
    return np.asarray(np.max(durations, axis=0))


def reached_accelerations(machine: Machine, acceleration: Array, jerk_time: Array) -> Array:
    """Return the largest acceleration that any move reaches, shape (n_limits,) [m/s²]."""
    jerk = acceleration / jerk_time
    ramps = [jerk_steps(m, acceleration=acceleration, jerk=jerk).times[:, 1] for m in machine.moves]
    return np.asarray(np.minimum(jerk * np.max(ramps, axis=0), acceleration))


def settle_gradually(
    bench: Bench,
    tables_by_corner: Sequence[ResponseTables],
    acceleration: Array,
    jerk_time: Array,
) -> Iterator[tuple[NDArray[np.bool_], Settling]]:
    """Yield the worst settling so far after each move and corner, and take back what to drop.

    Parameters
    ----------
    bench
        The bench.
    tables_by_corner
        Its tables or its sketches.
    acceleration, jerk_time
        Limits, shape (n_limits,) [m/s², s].

    Yields
    ------
    alive, found
        Limits still followed, shape (n_limits,): whoever sets one to False has seen enough of
        it, and it stays at the worst seen until then; worst settling over moves and corners.
    """
    alive = np.ones(len(acceleration), dtype=bool)
    settling, residual = np.zeros_like(acceleration), np.zeros_like(acceleration)
    # The nominal machine comes last: it is the mildest, the ends decide.
    for move, tables in product(bench.machine.moves, tables_by_corner[::-1]):
        part = np.flatnonzero(alive)
        if not part.size:
            return
        steps = plan_steps(bench.machine, move, acceleration[part], jerk_time[part])
        found = settle(tables, steps, band=bench.band)
        settling[part] = np.maximum(settling[part], found.settling_time)
        residual[part] = np.maximum(residual[part], found.residual_deviation)
        yield alive, Settling(settling_time=settling, residual_deviation=residual)


def settle_exactly(bench: Bench, acceleration: Array, jerk_time: Array) -> Settling:
    """Return the worst settling over moves and corners, seen at every velocity cycle."""
    *_, (_, found) = settle_gradually(bench, bench.tables, acceleration, jerk_time)
    return found


def use_of_bounds(bench: Bench, acceleration: Array, jerk_time: Array) -> Array:
    """Return the share of every bound that is used, worst case, shape (n_limits, n_bounds) [-].

    Parameters
    ----------
    bench
        The bench; ``bench.requirements`` are the columns.
    acceleration, jerk_time
        Limits, shape (n_limits,) [m/s², s].

    Returns
    -------
    ndarray
        Force, peaks, and contour and RMS force where they are bounded; in the decisive corners.
    """
    return np.asarray(use_by_corner(bench, acceleration, jerk_time).max(axis=0))


def use_by_corner(bench: Bench, acceleration: Array, jerk_time: Array) -> Array:
    """Return the same for each decisive corner, shape (n_corners, n_limits, n_bounds) [-]."""
    needs, drive = bench.machine.requirements, bench.machine.drive
    is_limited, follows = isfinite(drive.continuous_force), isfinite(needs.contour_deviation)
    used = np.zeros((len(bench.decisive), len(acceleration), len(bench.requirements)))
    for move in bench.machine.moves:
        slower = slow_to_feed(move, needs.contour_feed)
        steps, path = (
            plan_steps(bench.machine, item, acceleration, jerk_time) for item in (move, slower)
        )
        for place, corner in enumerate(bench.decisive):
            run = partial(
                find_extremes,
                bench.tuned.loops[corner],
                signals=bench.signals,
                tail=bench.tail,
                static_load=drive.static_load,
            )
            found = run(
                steps,
                dwell=move.dwell if is_limited else None,
                with_deviation=follows and slower == move,
            )
            columns = [found.peaks / bench.bounds]
            if follows:
                own = found if slower == move else run(path, dwell=None, with_deviation=True)
                columns.append(own.deviation[:, None] / bench.contour)
            if is_limited:
                columns.append(found.rms_force[:, None] / bench.continuous)
            used[place] = np.maximum(used[place], np.hstack(columns))
    return used


ALMOST = 0.999
"""Share of the worst use of a bound, over all corners, that the decisive ones must show."""


def find_decisive(used: Array) -> tuple[int, ...]:
    """Return as few corners as show the worst use of every bound.

    Parameters
    ----------
    used
        From ``use_by_corner``, with all corners and enough limits.

    Returns
    -------
    tuple of int
        Found greedily: each time the corner is added that shows what is most missing.

    Examples
    --------
    >>> find_decisive(np.array([[[0.5, 0.2]], [[0.9, 0.1]], [[0.9, 0.4]], [[0.8, 0.3]]]))
    (1, 2)
    """
    flat = used.reshape(len(used), -1)
    worst, leader = flat.max(axis=0), flat.argmax(axis=0)
    chosen, shown = set[int](), np.zeros(flat.shape[1])
    while np.any(shown < ALMOST * worst):
        chosen.add(int(leader[np.argmin(shown / np.maximum(worst, 1e-300))]))
        shown = flat[sorted(chosen)].max(axis=0)
    return tuple(sorted(chosen))
