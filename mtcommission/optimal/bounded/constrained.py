"""The time-optimal control under bounds on states and outputs: exact, and proved.

The sequence of bang arcs, boundary arcs and touch points is found, never assumed.
docs/optimal-control-bounds.md derives the method.
"""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Move, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded.lengthened_cruise import (
    cruise_periods,
    lengthened_cruise,
    slowest_period,
)
from mtcommission.optimal.bounded.mesh.plan import first_features
from mtcommission.optimal.bounded.newton.exact import solve_exactly
from mtcommission.optimal.bounded.problem import (
    BoundedProblem,
    all_bounds,
    bounded_problem,
    describe_bounds,
)
from mtcommission.optimal.bounded.program.grid import solve_grid_time
from mtcommission.optimal.bounded.proof.accepted import Found
from mtcommission.optimal.bounded.proof.dual_point import adjoint_before, stretches
from mtcommission.optimal.bounded.proof.dual_value import dual_value
from mtcommission.optimal.bounded.proof.motion import require_followable
from mtcommission.optimal.bounded.search import search
from mtcommission.optimal.bounded.tight_force import force_sequence, swift_plant, tight_force_bound
from mtcommission.optimal.closed_form import impulse_response
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import Bound, Certificate, TimeOptimum, TouchPoint
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


def solve_bounded_time_optimal(
    plant: Plant, move: Move, *, force_limit: float, bounds: tuple[Bound, ...]
) -> TimeOptimum:
    """Return the fastest control that makes a move within bounds and leaves everything at rest.

    Raises
    ------
    KeyError
        If there is no such signal.
    ComputationError
        BOUND_CANNOT_HOLD, BEYOND_HORIZON, NO_FORCE_LEFT, or NO_CONVERGENCE.

    Source: docs/optimal-control-bounds.md; the problem: Christiansen, Maurer & Zirn, sec. 5.2.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.optimal.solution import Boundary
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> optimum = solve_bounded_time_optimal(build_plant(machine), machine.moves[0],
    ...     force_limit=2e3, bounds=(Bound(name="v_phi", value=0.02),))
    >>> held = [arc.control for arc in optimum.arcs if isinstance(arc.control, Boundary)]
    >>> round(optimum.t_f, 7), held
    (0.0436416, [Boundary(signal='v_phi', side=-1)])
    """
    every = all_bounds(plant, move, bounds)
    refuse_impossible(plant, move, every)
    free = solve_time_optimal(plant, move, force_limit=force_limit)
    peaks = dict(zip(plant.signals, free.peaks.tolist(), strict=True))
    active = tuple(bound for bound in every if peaks[bound.name] > bound.value)
    if not active:
        # It keeps the bounds, and so is the answer under them.
        return replace(free, bounds=every)
    problem = bounded_problem(plant, move, force_limit=force_limit, bounds=every, horizon=free.t_f)
    found = _under_force_bound(problem, move)
    if found is None:
        found = _best(problem, t_free=free.t_f)
    if found is None:
        told, unit = describe_bounds(plant, every), plant.force_unit
        detail = Message("bounded-optimum-not-found", bounds=told, force=force_limit, unit=unit)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return as_optimum(problem, move, every, found)


def _best(problem: BoundedProblem, *, t_free: float) -> Found | None:
    """Return the optimum from a mesh over the whole move, or from a shorter cruise."""
    settings = problem.settings.search
    long = cruise_periods(problem) > settings.many_periods
    cruise = cruise_periods(problem) * slowest_period(problem)
    require_followable(cruise, problem.rate, most=settings.most_cruise_radians)
    first = lengthened_cruise(problem) if long else over_all(problem, t_free=t_free)
    if first is not None and first.gap <= problem.settings.proof.gap:
        return first
    if long and cruise * problem.rate > settings.most_radians:
        return first
    second = over_all(problem, t_free=t_free) if long else lengthened_cruise(problem)
    found = [one for one in (first, second) if one is not None]
    return min(found, key=lambda one: one.gap, default=None)


def over_all(problem: BoundedProblem, *, t_free: float) -> Found | None:
    """Return the optimum from a mesh over the whole move, or None where that does not converge."""
    try:
        grid = solve_grid_time(problem, t_free=t_free)
        require_followable(grid.t_f, problem.rate, most=problem.settings.search.most_radians)
        return search(problem, first_features(problem, grid))
    except ComputationError as error:
        if error.outcome is not Outcome.NO_CONVERGENCE:
            raise
        return None


def _under_force_bound(problem: BoundedProblem, move: Move) -> Found | None:
    """Return the optimum under a tight bound on F, from that of a plant with a swift force."""
    index = tight_force_bound(problem)
    if index < 0:
        return None
    others = tuple(limit.bound for i, limit in enumerate(problem.limits) if i != index)
    force = problem.limits[index].bound.value
    try:
        swift = solve_bounded_time_optimal(
            swift_plant(problem, index), move, force_limit=force, bounds=others
        )
    except ComputationError:
        return None
    return solve_exactly(problem, force_sequence(problem, index, swift.arcs))


def refuse_impossible(plant: Plant, move: Move, bounds: tuple[Bound, ...]) -> None:
    """Raise BOUND_CANNOT_HOLD where the target breaks a bound, or one forbids any motion."""
    target = np.zeros(plant.order)
    if isinstance(move, VelocityStep):
        target[plant.velocity] = move.velocity_step
    else:
        target[plant.position] = move.distance
    for bound in bounds:
        row = plant.row(bound.name)
        free = isinstance(move, VelocityStep) and row[plant.position] != 0.0
        least = 0.0 if free else abs(float(row @ target))
        if not bound.value > 0.0 or bound.value < least:
            unit, told = plant.unit(bound.name), describe_bounds(plant, (bound,))
            detail = Message("bound-not-positive", bound=told)
            if least > 0.0:
                detail = Message("bound-below-need", bound=told, least=least, unit=unit)
            raise ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)


def as_optimum(
    problem: BoundedProblem, move: Move, bounds: tuple[Bound, ...], found: Found
) -> TimeOptimum:
    """Return what was found as an optimum with its proof."""
    error = np.zeros(problem.plant.order)
    error[problem.fixed] = (found.motion.final - problem.target)[problem.fixed]
    touches = [
        TouchPoint(
            t=found.t_f - at.remaining,
            signal=problem.limits[at.limit].bound.name,
            side=at.side,
        )
        for at in found.touches
    ]
    return TimeOptimum(
        move=move,
        force_limit=problem.force_limit,
        bounds=bounds,
        method="exact",
        t_f=found.t_f,
        arcs=found.motion.arcs,
        touch_points=tuple(sorted(touches, key=lambda touch: touch.t)),
        terminal_error=error,
        motion=found.motion,
        certificate=_certificate(problem, found),
    )


def _certificate(problem: BoundedProblem, found: Found) -> Certificate:
    plant, parts = problem.plant, stretches(problem, found.measure)
    initial = adjoint_before(problem, parts[0])
    # At rest H = 1 + λ B F_set, so its zero fixes the factor between Λ and the paper's λ.
    factor = -1.0 / (problem.force_limit * abs(float(initial @ plant.B)))
    zeros = dual_value(problem, parts, found.measure.atoms).zeros
    switches = found.t_f - np.array([arc.t_end for arc in found.motion.arcs[:-1]])
    slopes = [
        -factor * float(part.adjoint @ plant.A @ impulse_response(plant, np.array(at - part.end)))
        for at in switches.tolist()
        for part in parts
        if part.end <= at < part.start
    ]
    return Certificate(
        t_f_lower_bound=found.t_lower,
        relative_gap=found.gap,
        adjoint_initial=factor * initial,
        switching_slopes=np.array(slopes),
        switching_law_holds=found.exact and _law_holds(problem, found, zeros),
        terminal_jacobian_rank=-1,
        terminal_jacobian_condition=nan,
    )


def _law_holds(problem: BoundedProblem, found: Found, zeros: Array) -> bool:
    """Return whether σ changes sign off the boundary arcs just where the force switches."""
    ends = found.t_f - np.array([0.0, *(arc.t_end for arc in found.motion.arcs)])
    distance = np.abs(zeros[:, np.newaxis] - ends).min(axis=1)
    return bool(np.all(distance < problem.settings.proof.same_time * found.t_f))
