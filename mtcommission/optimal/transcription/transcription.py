"""Plant + move -> optimal control on a grid, by direct transcription and IPOPT.

This is the paper's own method. It needs no knowledge of the structure, takes any bounds, and
serves as an independent check of the exact solutions; it is neither exact nor certified.
Every number of a result but t_f and the adjoint belongs to the *exact* motion of the plant
under the control that was found, so the discretisation shows as a terminal error.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Weight
from mtcommission.machine.moves import Move, Positioning
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded import explain_short_time
from mtcommission.optimal.damping.hamiltonian import state_scales, terminal_target
from mtcommission.optimal.solution import (
    Bound,
    Certificate,
    DampingOptimum,
    TimeOptimum,
)
from mtcommission.optimal.transcription.discretisation import (
    LONGEST,
    Aim,
    GridProblem,
    GridSolution,
    bounded_rows,
    solve_grid,
)
from mtcommission.optimal.transcription.grid_motion import follow_grid, grid_arcs
from mtcommission.optimal.transcription.settings import TranscriptionSettings
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

COARSEST = 500
"""Intervals up to which t_f is an unknown of the program (empirical: IPOPT crawls from 1600 on).
On finer grids Newton's method finds t_f: one step on each four times finer grid, and on the
last one until the target is reached."""

MOST_TIMES = 12
"""Final times that Newton's method may try (empirical: two to four are enough)."""

REACHED = 0.5
"""Distance from 1, in tolerances of all intervals added, at which the target counts as reached:
IPOPT leaves each force a gap of up to its tolerance, and the multiple errs by their sum."""

SATURATED = 1e-5
"""Distance from the limit, in units of F_max, below which an interval counts as saturated:
IPOPT ends at most about its tolerance over the multiplier inside the limit."""

LAW_TOLERANCE = 1e-5
"""Largest violation of the switching law, weighted with |λ_F| / max |λ_F| [-]."""


def transcribe_time_optimal(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    bounds: tuple[Bound, ...],
    settings: TranscriptionSettings,
) -> TimeOptimum:
    """Return the shortest move on a grid.

    Raises
    ------
    ComputationError
        BOUND_CANNOT_HOLD if IPOPT finds the bounds infeasible, BEYOND_HORIZON if t_f reaches
        the end of the search, NO_CONVERGENCE for IPOPT's other failures.
    KeyError
        If a bound names no signal of the plant.

    Source: Christiansen, Maurer & Zirn, secs. 5 and 5.2.
    """
    found, scales = _shortest(
        plant, move, force_limit=force_limit, bounds=bounds, settings=settings
    )
    control = _snap(found.control) * force_limit
    motion = follow_grid(plant, control, t_f=found.t_f)
    target, fixed = terminal_target(plant, move)
    return TimeOptimum(
        move=move,
        force_limit=force_limit,
        bounds=bounds,
        method="transcription",
        t_f=found.t_f,
        arcs=grid_arcs(control, t_f=found.t_f, force_limit=force_limit),
        touch_points=(),
        terminal_error=np.where(fixed, motion.states[-1] - target, 0.0),
        motion=motion,
        certificate=_certificate(plant, found, adjoint_scale=1.0 / scales),
    )


def transcribe_damping_optimal(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    t_f: float,
    weights: tuple[Weight, ...],
    bounds: tuple[Bound, ...],
    settings: TranscriptionSettings,
) -> DampingOptimum:
    """Return the move with the least weighted squares on a grid.

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT if there is no such move, under bounds with the smallest possible
        ones; BOUND_CANNOT_HOLD if there is none at any time; NO_CONVERGENCE for IPOPT's other
        failures.
    KeyError
        If a bound names no signal of the plant.
    ValueError
        If a weight names no state.

    Source: Christiansen, Maurer & Zirn, sec. 6.
    """
    scales = state_scales(plant, force_limit=force_limit, t_f=t_f)
    problem = _grid_problem(
        plant,
        move,
        bounds=bounds,
        scales=scales,
        t_f=t_f,
        force_limit=force_limit,
        aim=Aim.FUNCTIONAL,
        weights=weights,
        intervals=settings.intervals,
    )
    try:
        found = solve_grid(problem, settings)
    except ComputationError as error:
        if not problem.rows.size:
            raise
        reason = explain_short_time(plant, move, force_limit=force_limit, t_f=t_f, bounds=bounds)
        raise reason or error from error
    control = _snap(found.control) * force_limit
    motion = follow_grid(plant, control, t_f=t_f)
    target, fixed = terminal_target(plant, move)
    adjoint_scale = force_limit**2 / scales
    wanted = -found.adjoint @ (adjoint_scale * plant.B) / 2.0
    law = np.abs(control - np.clip(wanted, -force_limit, force_limit)) / force_limit
    terms = motion.cost_terms(weights)
    return DampingOptimum(
        move=move,
        force_limit=force_limit,
        bounds=bounds,
        method="transcription",
        t_f=t_f,
        weights=weights,
        arcs=grid_arcs(control, t_f=t_f, force_limit=force_limit),
        cost=float(terms.sum()),
        cost_terms=terms,
        adjoint_initial=found.adjoint_initial * adjoint_scale,
        law_residual=float(law.max()),
        terminal_error=np.where(fixed, motion.states[-1] - target, 0.0),
        peaks=motion.peaks,
    )


def _shortest(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    bounds: tuple[Bound, ...],
    settings: TranscriptionSettings,
) -> tuple[GridSolution, Array]:
    """Return the shortest move on the wanted grid, and the scales of its states."""
    grids = [settings.intervals]
    while grids[-1] > COARSEST:
        grids.append(grids[-1] // 4)
    t_guess = _guess_time(plant, move, force_limit=force_limit)

    def solve(t_f: float, aim: Aim, intervals: int) -> tuple[GridSolution, Array]:
        scales = state_scales(plant, force_limit=force_limit, t_f=t_f)
        problem = _grid_problem(
            plant,
            move,
            bounds=bounds,
            scales=scales,
            t_f=t_f,
            force_limit=force_limit,
            aim=aim,
            weights=(),
            intervals=intervals,
        )
        return solve_grid(problem, replace(settings, intervals=intervals)), scales

    found, scales = solve(t_guess, Aim.TIME, grids[-1])
    if found.t_f > 0.999 * LONGEST * t_guess:
        raise ComputationError(Outcome.BEYOND_HORIZON, Message("ipopt-went-far", t_f=found.t_f))
    if len(grids) == 1:
        return found, scales
    t_f, near = found.t_f, REACHED * settings.tolerance * settings.intervals
    for intervals in (*grids[-2:0:-1], *([settings.intervals] * MOST_TIMES)):
        found, scales = solve(t_f, Aim.REACH, intervals)
        if intervals == settings.intervals and abs(found.reach - 1.0) < near:
            return found, scales
        t_f += (1.0 - found.reach) / found.reach_rate
    detail = Message("target-not-reached", reach=found.reach, t_f=found.t_f)
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)


def _guess_time(plant: Plant, move: Move, *, force_limit: float) -> float:
    """Return the rigid body's shortest time plus the time that flexibility may cost [s]."""
    slowest = max(2.0 * np.pi / mode.natural_frequency for mode in plant.modes)
    acceleration = force_limit / plant.moving_mass
    if not isinstance(move, Positioning):
        rigid = move.velocity_step / acceleration
    elif move.distance * acceleration > move.max_velocity**2:
        rigid = move.distance / move.max_velocity + move.max_velocity / acceleration
    else:
        rigid = 2.0 * sqrt(move.distance / acceleration)
    return float(rigid + slowest / 2.0 + 4.0 * plant.force_lag)


def _grid_problem(
    plant: Plant,
    move: Move,
    *,
    bounds: tuple[Bound, ...],
    scales: Array,
    t_f: float,
    force_limit: float,
    aim: Aim,
    weights: tuple[Weight, ...],
    intervals: int,
) -> GridProblem:
    velocity_limit = move.max_velocity if isinstance(move, Positioning) else inf
    if isfinite(velocity_limit):
        velocity = plant.states[plant.velocity]
        bounds = (*bounds, Bound(name=velocity, value=velocity_limit))
    c = np.zeros(plant.order)
    for weight in weights:
        c[plant.states.index(weight.state)] += weight.value
    target, fixed = terminal_target(plant, move)
    force = _rigid_force(plant, move, target=target / scales, intervals=intervals)
    return GridProblem(
        A=plant.A * scales / scales[:, None],
        B=plant.B * force_limit / scales,
        target=target / scales,
        fixed=fixed,
        t_guess=t_f,
        aim=aim,
        weights=c * (scales / force_limit) ** 2,
        rows=bounded_rows(plant, bounds, state_scale=scales),
        start_states=_rigid_motion(plant, force),
        start_control=force[1:],
    )


def _rigid_force(plant: Plant, move: Move, *, target: Array, intervals: int) -> Array:
    """Return the scaled force that moves the rigid mass in the guessed time, shape (N + 1,)."""
    if not isinstance(move, Positioning):
        return np.full(intervals + 1, target[plant.velocity])
    tau = np.linspace(0.0, 1.0, intervals + 1)
    return np.asarray(4.0 * target[plant.position] * np.where(tau < 0.5, 1.0, -1.0))


def _rigid_motion(plant: Plant, force: Array) -> Array:
    """Return the scaled motion of the rigid mass in the guessed time, shape (N + 1, n).

    A scaled unit of force moves it by a scaled unit of velocity in the guessed time, and
    bends each mode by a scaled unit.
    """
    intervals = force.size - 1
    motion = np.zeros((force.size, plant.order))
    motion[:, plant.lagged] = force[:, np.newaxis]
    for mode in plant.modes:
        motion[:, mode.deflection] = np.sign(mode.scale) * force
    motion[1:, plant.velocity] = np.cumsum(force[:-1]) / intervals
    motion[1:, plant.position] = np.cumsum(motion[1:, plant.velocity]) / intervals
    return motion


def _snap(control: Array) -> Array:
    """Return the control with its nearly saturated intervals at the limit exactly."""
    return np.where(np.abs(control) > 1.0 - SATURATED, np.sign(control), control)


def _certificate(plant: Plant, found: GridSolution, *, adjoint_scale: Array) -> Certificate:
    switching = found.adjoint @ (adjoint_scale * plant.B)
    changes = np.flatnonzero(np.sign(switching[1:]) != np.sign(switching[:-1]))
    step = found.t_f / found.control.size
    violation = np.abs(found.control + np.sign(switching)) * np.abs(switching)
    return Certificate(
        t_f_lower_bound=nan,
        relative_gap=nan,
        adjoint_initial=found.adjoint_initial * adjoint_scale,
        switching_slopes=(switching[changes + 1] - switching[changes]) / step,
        switching_law_holds=bool(violation.max() <= LAW_TOLERANCE * np.abs(switching).max()),
        terminal_jacobian_rank=-1,
        terminal_jacobian_condition=nan,
    )
