"""Plant + move + t_f -> the damping-optimal control: the saturated linear-quadratic problem.

minimise ∫ F_set² + Σ c_i x_i² dt   subject to |F_set| <= F_max, from rest to the target
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import newton_cotes
from scipy.linalg import expm

from mtcommission.machine import Move, Weight
from mtcommission.optimal.hamiltonian import (
    PiecewiseFlow,
    SaturatedProblem,
    matrix_powers,
    scale_problem,
    terminal_target,
)
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.saturated import Iterate, solve_saturated
from mtcommission.optimal.solution import Arc, DampingOptimum, constant_arc, propagate
from mtcommission.plant import Plant

Array = NDArray[np.float64]

REFINEMENT = 8
"""Cells per sample interval for quadrature and peaks: nine-point Newton-Cotes and cubic
interpolation then err by less than 1e-14 and 3e-9 of the fastest amplitude."""

SAME_STEP = 1e-11
"""Relative distance of two steps that counts as none."""


def solve_damping_optimal(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, weights: tuple[Weight, ...]
) -> DampingOptimum:
    """Return the control that reaches the target at t_f with the least weighted squares.

    Parameters
    ----------
    plant
        Plant with n states.
    move
        Velocity step or positioning move. The velocity limit of a positioning move is not
        part of this problem and is not enforced; ``transcribe_damping_optimal`` takes bounds.
    force_limit
        Force left for motion, F_max [N].
    t_f
        Final time [s], longer than the shortest possible one.
    weights
        c_i by state [N² per squared unit]; states without one have weight 0.

    Returns
    -------
    DampingOptimum
        A long interior arc is given in several pieces, each exact: the Hamiltonian flow would
        lose digits over its whole length.

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT, proved by weak duality; NO_CONVERGENCE.
    ValueError
        If a weight names no state of the plant.

    Source: Christiansen, Maurer & Zirn, eqs. (5) and (16); derived in
    docs/optimal-control-damping.md.

    Examples
    --------
    >>> from mtcommission.machine import *
    >>> from mtcommission.plant import build_plant
    >>> axis = Machine(name="a", axis="X", source="example",
    ...     mechanics=Modal(moving_mass=100.0, modes=(FlexibleMode(name="column",
    ...         natural_frequency=250.0, damping_ratio=0.03, tcp_gain=0.01),)),
    ...     drive=Drive(force_lag=2e-3, max_force=280.0), moves=(VelocityStep(velocity_step=0.1),),
    ...     requirements=Requirements(tcp_deviation=1e-5,
    ...         modes=Modes(surface=4e-6, accuracy=1e-5, speed=4e-5)))
    >>> best = solve_damping_optimal(build_plant(axis), axis.moves[0], force_limit=280.0,
    ...     t_f=0.05, weights=(Weight(state="v_column", value=1e5),))
    >>> [arc.control for arc in best.arcs]
    ['+F_max', 'interior', 'interior', '+F_max', 'interior', 'interior', 'interior', '-F_max']
    """
    problem = scale_problem(plant, move, force_limit=force_limit, t_f=t_f, weights=weights)
    solved = solve_saturated(problem)
    arcs = _published(problem, solved)
    target, fixed = terminal_target(plant, move)
    fine = _resample(problem, solved.flow)
    terms = _cost_terms(plant, problem, solved.flow, fine, weights=weights)
    return DampingOptimum(
        move=move,
        force_limit=force_limit,
        method="exact",
        t_f=t_f,
        weights=weights,
        arcs=arcs,
        cost=float(terms.sum()),
        cost_terms=terms,
        adjoint_initial=solved.flow.z[0, 0, plant.order : -1] * problem.adjoint_scale,
        law_residual=solved.violation,
        terminal_error=np.where(fixed, propagate(plant, arcs) - target, 0.0),
        peaks=_peaks(plant, problem, solved.flow, fine),
    )


def _published(problem: SaturatedProblem, solved: Iterate) -> tuple[Arc, ...]:
    F, edges, width = problem.force_limit, solved.arcs.edges, 2 * problem.order
    arcs = []
    for start, end, label in zip(edges[:-1], edges[1:], solved.arcs.labels, strict=True):
        if label:
            name = "+F_max" if label > 0 else "-F_max"
            arcs.append(constant_arc(float(start), float(end), control=name, force=label * F))
            continue
        inside = (solved.flow.t[:, 0] >= start) & (solved.flow.t[:, 0] < end)
        starts = np.append(solved.flow.t[inside, 0], end)
        for i, z in enumerate(solved.flow.z[inside, 0]):
            arcs.append(
                Arc(
                    t_start=float(starts[i]),
                    t_end=float(starts[i + 1]),
                    control="interior",
                    generator=problem.generators[1, :width, :width],
                    initial=z[:width],
                    output=F * problem.control_row[:width],
                )
            )
    return tuple(arcs)


def _resample(problem: SaturatedProblem, flow: PiecewiseFlow) -> Array:
    """Return z inside every sample interval, shape (k, intervals, REFINEMENT + 1, N)."""
    step = (flow.t[:, 1] - flow.t[:, 0]) / REFINEMENT
    # The pieces of an arc are alike up to rounding.
    other = np.abs(np.diff(step)) > SAME_STEP * step[1:]
    first = np.append(True, other | (np.diff(flow.labels) != 0))
    kind = np.cumsum(first) - 1
    generators = problem.generators[flow.labels[first] + 1] * step[first, None, None]
    moves = matrix_powers(expm(generators), REFINEMENT)
    return np.asarray(flow.z[:, :-1] @ _side_by_side(moves)[kind]).reshape(
        *flow.z[:, :-1].shape[:2], REFINEMENT + 1, -1
    )


def _side_by_side(moves: Array) -> Array:
    """Return the transposed matrices of each stack in one row, shape (k, N, powers N)."""
    k, count, N, _ = moves.shape
    return moves.transpose(0, 3, 1, 2).reshape(k, N, count * N)


def _cost_terms(
    plant: Plant,
    problem: SaturatedProblem,
    flow: PiecewiseFlow,
    fine: Array,
    *,
    weights: tuple[Weight, ...],
) -> Array:
    rule = newton_cotes(REFINEMENT)[0] / REFINEMENT
    step = (flow.t[:, 1] - flow.t[:, 0])[:, None, None]
    label = flow.labels[:, None, None]
    control = np.where(label == 0, fine @ problem.control_row, label * flow.bound)
    terms = [problem.force_limit**2 * float((step * control**2 * rule).sum())]
    for weight in weights:
        i = plant.states.index(weight.state)
        integral = float((step * fine[..., i] ** 2 * rule).sum())
        terms.append(weight.value * problem.state_scale[i] ** 2 * integral)
    return np.array(terms)


def _peaks(plant: Plant, problem: SaturatedProblem, flow: PiecewiseFlow, fine: Array) -> Array:
    rows = np.zeros((len(plant.signals), fine.shape[-1]))
    rows[:, : plant.order] = signal_rows(plant) * problem.state_scale
    value = fine @ rows.T
    rate = np.stack(
        [
            piece @ (rows @ problem.generators[label + 1]).T
            for piece, label in zip(fine, flow.labels, strict=True)
        ]
    )
    step = np.repeat((flow.t[:, 1] - flow.t[:, 0]) / REFINEMENT, fine[0, :, 1:, 0].size)
    k = rows.shape[0]
    return hermite_peaks(
        step,
        value[:, :, :-1].reshape(-1, k),
        value[:, :, 1:].reshape(-1, k),
        start_rate=rate[:, :, :-1].reshape(-1, k),
        end_rate=rate[:, :, 1:].reshape(-1, k),
    )
