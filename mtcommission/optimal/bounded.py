"""The time-optimal control under bounds on states and outputs, with a proved bound.

The program on cells shows the sequence of bang arcs, boundary arcs and touch points, which is
found, never assumed; Newton's method makes it exact. Where it is not recognised, finer cells bring
program and proof together, and the gap that is left stands in the certificate.
docs/optimal-control.md derives the method.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from math import nan

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, least_motion_time
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.cells import first_cells
from mtcommission.optimal.control import (
    Certificate,
    Optimum,
    TimeOptimum,
    TouchPoint,
    terminal_target,
)
from mtcommission.optimal.edits import (
    force_sequence,
    holds_high_order,
    solve_exactly,
    swift_plant,
    tight_force_bound,
)
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.optimal.problem import (
    BoundedProblem,
    all_bounds,
    bounded_problem,
    describe_bounds,
)
from mtcommission.optimal.proof import Found, prove, require_followable, slopes
from mtcommission.optimal.refine import Seen, cell_arcs, finish, refined
from mtcommission.optimal.sequence import detect_sequence, plainest_sequence
from mtcommission.optimal.settings import SETTINGS

Array = NDArray[np.float64]

SHORTEST_RAMP = 1e-4
"""Of the acceleration from 0 to its limit, times the fastest mode [rad]: proofs of 1e-8 there, and
searches that do not end below (measured)."""


def solve_bounded_time_optimal(
    plant: Plant, move: Move, *, force_limit: float, bounds: tuple[SignalValue, ...]
) -> TimeOptimum:
    """Return the fastest control that makes a move within bounds and leaves everything at rest.

    The gap to the proved bound is some 1e-12 where the sequence of arcs could be solved exactly
    (orders 1 and 2); else the arcs are cells, and the gap stands in the certificate. Bounds and
    force are kept to 1e-9, the target against each state's peak to 1e-9 or, on cells, 1e-8. A
    finite ``max_velocity`` of the move bounds the rigid velocity.

    Raises
    ------
    KeyError
        If there is no such signal.
    ComputationError
        BOUND_CANNOT_HOLD, BEYOND_HORIZON, NO_FORCE_LEFT, MOVE_TOO_LONG or NO_CONVERGENCE.

    Source: docs/optimal-control.md; the problem: Christiansen, Maurer & Zirn, sec. 5.2.

    Examples
    --------
    >>> from mtcommission.machine.profile.shipped import read_shipped
    >>> from mtcommission.machine.plant.plant import build_plant
    >>> from mtcommission.machine.readers import SignalValue
    >>> from mtcommission.optimal.control import Boundary
    >>> machine = read_shipped("milling-manipulator").machine
    >>> optimum = solve_bounded_time_optimal(build_plant(machine), machine.moves[0],
    ...     force_limit=2e3, bounds=(SignalValue(name="v_phi", value=0.02),))
    >>> held = [arc.control for arc in optimum.arcs if isinstance(arc.control, Boundary)]
    >>> round(optimum.t_f, 7), held
    (0.0436416, [Boundary(signal='v_phi', side=-1)])
    """
    every = all_bounds(plant, move, bounds)
    refuse_impossible(plant, move, every)
    free = solve_time_optimal(plant, move, force_limit=force_limit)
    peaks = dict(zip(plant.signals, free.peaks.tolist(), strict=True))
    if all(peaks[bound.name] <= bound.value for bound in every):
        # It keeps the bounds, and so is the answer under them.
        return replace(free, bounds=every)
    problem = bounded_problem(plant, move, force_limit=force_limit, bounds=every, horizon=free.t_f)
    found = _under_force_bound(problem, move)
    if found is None:
        least = least_motion_time(move, force_limit / plant.moving_mass)
        require_followable(least, problem.rate, most=SETTINGS.most_radians)
        found = _search(problem, t_free=least if least > SETTINGS.slow * free.t_f else free.t_f)
    return _as_optimum(problem, move, every, found)


def solve_problem(
    problem: BoundedProblem, move: Move, bounds: tuple[SignalValue, ...], *, t_free: float
) -> TimeOptimum:
    """Return the optimum of a scaled problem; ``t_free``: that of the same move without bounds [s].

    Raises
    ------
    ComputationError
        As ``solve_bounded_time_optimal``.
    """
    return _as_optimum(problem, move, bounds, _search(problem, t_free=t_free))


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


def refuse_impossible(plant: Plant, move: Move, bounds: tuple[SignalValue, ...]) -> None:
    """Raise BOUND_CANNOT_HOLD where the target breaks a bound, or one forbids any motion."""
    target, fixed = terminal_target(plant, move)
    for bound in bounds:
        row = plant.row(bound.name)
        least = 0.0 if row[~fixed].any() else abs(float(row @ target))
        if not bound.value > 0.0 or bound.value < least:
            unit, told = plant.unit(bound.name), describe_bounds(plant, (bound,))
            detail = Message("bound-not-positive", bound=told)
            if least > 0.0:
                detail = Message("bound-below-need", bound=told, least=least, unit=unit)
            raise ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)


def _search(problem: BoundedProblem, *, t_free: float) -> Found:
    """Return the exact sequence that finer and finer cells show, or the best control on cells."""
    best: Seen | None = None
    first = first_cells(problem, t_free=t_free)
    for seen in refined(problem, first):
        guess = detect_sequence(problem, seen.structure, seen.dual, seen.mesh)
        plainest = plainest_sequence(problem, seen.structure, seen.dual)
        found = solve_exactly(problem, guess) or solve_exactly(problem, plainest)
        if found is not None:
            return found
        may_be_exact = False
        if best is None or seen.gap < best.gap:
            best, may_be_exact = seen, not holds_high_order(problem, guess)
        if best.gap < SETTINGS.enough and not may_be_exact:
            break
    # Where an arc is held too long for a control that has to enter it, the first cells hold none.
    measure = first.measure if best is None else best.cells.measure
    for known, tolerance in product(
        (first,) if best is None else (best.cells, first), SETTINGS.finishes
    ):
        cells = finish(problem, known, tolerance=tolerance)
        if cells is None:
            continue
        found = prove(problem, cell_arcs(problem, cells), measure, (), is_exact=False)
        if found is not None:
            return found
    told, unit = describe_bounds(problem.plant, problem.bounds), problem.plant.force_unit
    force = problem.force_limit
    detail = Message("bounded-optimum-not-found", bounds=told, force=force, unit=unit)
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)


def _as_optimum(
    problem: BoundedProblem, move: Move, bounds: tuple[SignalValue, ...], found: Found
) -> TimeOptimum:
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
    return Optimum(
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
    plant, parts = problem.plant, found.dual.parts
    initial = parts[0].before
    # At rest H = 1 + λ B F_set, so its zero fixes the factor between Λ and the paper's λ.
    factor = -1.0 / (problem.force_limit * abs(float(initial @ plant.B)))
    switches = found.t_f - np.array([arc.t_end for arc in found.motion.arcs[:-1]])
    return Certificate(
        t_f_lower_bound=found.t_lower,
        relative_gap=found.gap,
        adjoint_initial=factor * initial,
        switching_slopes=-factor * slopes(problem, parts, switches),
        switching_law_holds=found.is_exact and _law_holds(found),
        terminal_jacobian_rank=-1,
        terminal_jacobian_condition=nan,
    )


def _law_holds(found: Found) -> bool:
    """Return whether σ changes sign off the boundary arcs just where the force switches."""
    ends = found.t_f - np.array([0.0, *(arc.t_end for arc in found.motion.arcs)])
    distance = np.abs(found.dual.zeros[:, np.newaxis] - ends).min(axis=1)
    return bool(np.all(distance < SETTINGS.same_time * found.t_f))
