"""The time-optimal control without limits on states: exact, and proved.

The structure (the number of switches) is found, never assumed. docs/optimal-control.md derives
the method.
"""

from __future__ import annotations

from itertools import pairwise
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.optimal.free.bang_bang import BangBangMotion
from mtcommission.optimal.free.certificate import Claim, certify
from mtcommission.optimal.free.dual_start import guess_horizon
from mtcommission.optimal.free.flow import dyadic_flow, states_at
from mtcommission.optimal.free.mesh import ROUNDOFF
from mtcommission.optimal.free.moments import MomentProblem, independence, moment_problem
from mtcommission.optimal.free.search import Attempt, find_bang_bang
from mtcommission.optimal.solution import Arc, Bang, TimeOptimum
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

GAP_TOLERANCE = 1e-9
"""Largest relative distance of t_f from its proved lower bound."""
ERROR_TOLERANCE = 1e-9
"""Largest terminal error of a state against the peak of that state."""
SAME_INSTANT = 1e-13
"""Distance of two switches against t_f below which there are none: Newton's method has closed the
arc between them, or left it as short as rounding allows (empirical: no arc of 1480 optima was
between that and 1e-8)."""
NO_CHANGE, ONE = np.zeros((1, 1)), np.ones(1)
"""Generator and initial value of a constant force; all bang arcs share them."""


def solve_time_optimal(plant: Plant, move: Move, *, force_limit: float) -> TimeOptimum:
    """Return the fastest control that makes a move and leaves everything at rest.

    Raises
    ------
    ComputationError
        NO_FORCE_LEFT if ``force_limit`` is not positive; MODES_NOT_TOLD_APART where rounding
        alone exceeds these accuracies; NO_CONVERGENCE if the iteration ends before them otherwise.

    Source: docs/optimal-control.md, sections 1 to 4; the problem: Christiansen, Maurer & Zirn,
    eq. (1)-(3).

    Examples
    --------
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> machine = read_shipped("milling-manipulator").machine
    >>> optimum = solve_time_optimal(build_plant(machine), machine.moves[0], force_limit=2e3)
    >>> [round(t, 6) for t in (*optimum.switching_times, optimum.t_f)]
    [0.009395, 0.009731, 0.03657, 0.037678, 0.041955, 0.04352]
    >>> optimum.certificate.relative_gap < 1e-12
    True
    """
    if not force_limit > 0.0:
        detail = Message("force-left", force=force_limit, unit=plant.force_unit)
        raise ComputationError(Outcome.NO_FORCE_LEFT, detail)
    problem = moment_problem(plant, move)
    try:
        return _certified(plant, move, problem, force_limit=force_limit)
    except ComputationError as error:
        horizon = guess_horizon(problem, span=problem.target / force_limit)
        accuracy = ROUNDOFF / independence(problem, horizon)
        if accuracy < GAP_TOLERANCE:
            raise
        slowest = float(problem.magnitudes[: problem.n_modes].min(initial=inf)) * horizon
        detail = Message(
            "modes-answer-alike",
            force=force_limit,
            unit=plant.force_unit,
            t_f=horizon,
            angle=slowest,
            doubt=accuracy,
        )
        raise ComputationError(Outcome.MODES_NOT_TOLD_APART, detail) from error


def _certified(
    plant: Plant, move: Move, problem: MomentProblem, *, force_limit: float
) -> TimeOptimum:
    found = find_bang_bang(problem, span=problem.target / force_limit)
    claim = _claim(found, force_limit)
    flow = dyadic_flow(plant, problem, t_f=claim.t_f)
    times = claim.switching_times
    instants = np.array([claim.t_f, *times[-1:].tolist()])
    states = states_at(flow, instants, switching_times=times, first_force=claim.first_force)
    optimum = TimeOptimum(
        move=move,
        force_limit=force_limit,
        bounds=(),
        method="exact",
        t_f=claim.t_f,
        arcs=_arcs(claim),
        touch_points=(),
        terminal_error=_terminal_error(plant, move, states[0]),
        motion=BangBangMotion(
            plant=plant,
            problem=problem,
            grading=claim.point.mesh.grading,
            switching_times=times,
            t_f=claim.t_f,
            first_force=claim.first_force,
        ),
        certificate=certify(claim, flow),
    )
    _check(plant, optimum, np.abs(states[-1]))
    return optimum


def _claim(found: Attempt, force_limit: float) -> Claim:
    control = found.control
    zeros = _told_apart(control.zeros, control.horizon)
    return Claim(
        switching_times=control.horizon - zeros[::-1],
        t_f=control.horizon,
        first_force=control.first_sign * (-1.0) ** zeros.size * force_limit,
        point=found.point,
    )


def _told_apart(zeros: Array, horizon: float) -> Array:
    """Return the zeros but for pairs that coincide."""
    kept: list[float] = []
    for zero in zeros.tolist():
        if kept and zero - kept[-1] <= SAME_INSTANT * horizon:
            kept.pop()
        else:
            kept.append(zero)
    return np.array(kept)


def _arcs(claim: Claim) -> tuple[Arc, ...]:
    times = claim.switching_times.tolist()
    forces = [claim.first_force, -claim.first_force]
    outputs = [np.array([force]) for force in forces]
    controls = [Bang(1 if force > 0.0 else -1) for force in forces]
    return tuple(
        Arc(
            t_start=start,
            t_end=end,
            control=controls[i % 2],
            generator=NO_CHANGE,
            initial=ONE,
            output=outputs[i % 2],
        )
        for i, (start, end) in enumerate(pairwise([0.0, *times, claim.t_f]))
    )


def _terminal_error(plant: Plant, move: Move, final: Array) -> Array:
    error = final.copy()
    if isinstance(move, VelocityStep):
        error[plant.velocity] -= move.velocity_step
        error[plant.position] = 0.0
    else:
        error[plant.position] -= move.distance
    return error


def _check(plant: Plant, optimum: TimeOptimum, reached: Array) -> None:
    """Raise where the gap or the terminal error is too large.

    ``reached`` is a magnitude that each state has somewhere on the way, so it is below the peak: an
    error that passes against it passes against the peak, too, which then need not be searched for.
    """
    gap, size = optimum.certificate.relative_gap, np.abs(optimum.terminal_error)
    if gap <= GAP_TOLERANCE and all((size <= ERROR_TOLERANCE * reached).tolist()):
        return
    relative = size / optimum.peaks[: plant.order]
    worst = int(relative.argmax())
    if gap <= GAP_TOLERANCE and relative[worst] <= ERROR_TOLERANCE:
        return
    detail = Message(
        "optimum-not-accurate",
        t_f=optimum.t_f,
        switches=len(optimum.arcs) - 1,
        gap=gap,
        allowed_gap=GAP_TOLERANCE,
        state=plant.states[worst],
        error=float(relative[worst]),
        allowed_error=ERROR_TOLERANCE,
    )
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)
