"""Plant + move + t_f -> the damping-optimal control: the saturated linear-quadratic problem.

minimise ∫ F_set² + Σ c_i x_i² dt   subject to |F_set| <= F_max, from rest to the target
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import newton_cotes

from mtcommission.machine.machine import Weight
from mtcommission.machine.moves import Move
from mtcommission.optimal.damping.hamiltonian import (
    SAMPLES_PER_PIECE,
    Labels,
    PiecewiseFlow,
    SaturatedProblem,
    matrix_powers,
    scale_problem,
    terminal_target,
)
from mtcommission.optimal.damping.saturated import Iterate, solve_saturated
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import (
    Arc,
    Bang,
    DampingOptimum,
    Interior,
    constant_arc,
    propagate,
)
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

REFINEMENT = 8
"""Cells per sample interval for quadrature and peaks: nine-point Newton-Cotes and cubic
interpolation then err by less than 1e-14 and 3e-9 of the fastest amplitude."""

BLOCK = 256
"""Pieces that are sampled finely at a time: some ten megabytes."""


def solve_damping_optimal(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, weights: tuple[Weight, ...]
) -> DampingOptimum:
    """Return the control that reaches the target at t_f with the least weighted squares.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE, also where t_f is below the shortest time.
    ValueError
        If a weight names no state of the plant.

    Source: Christiansen, Maurer & Zirn, eqs. (5) and (16); derived in
    docs/optimal-control.md, section 9.

    Examples
    --------
    >>> from itertools import groupby
    >>> from mtcommission.optimal.solution import control_text
    >>> from mtcommission.machine.drive import Drive
    >>> from mtcommission.machine.machine import Machine, Weight
    >>> from mtcommission.machine.mechanics import FlexibleMode
    >>> from mtcommission.machine.moves import VelocityStep
    >>> from mtcommission.machine.requirements import Modes, Requirements
    >>> from mtcommission.plant.modal import Modal
    >>> from mtcommission.plant.plant import build_plant
    >>> axis = Machine(name="a", axis="X", source="example",
    ...     mechanics=Modal(moving_mass=100.0, modes=(FlexibleMode(name="column",
    ...         natural_frequency=250.0, damping_ratio=0.03, tcp_gain=0.01),)),
    ...     drive=Drive(force_lag=2e-3, max_force=280.0), moves=(VelocityStep(velocity_step=0.1),),
    ...     requirements=Requirements(tcp_deviation=1e-5,
    ...         modes=Modes(surface=4e-6, accuracy=1e-5, speed=4e-5)))
    >>> best = solve_damping_optimal(build_plant(axis), axis.moves[0], force_limit=280.0,
    ...     t_f=0.05, weights=(Weight(state="v_column", value=1e5),))
    >>> [control_text(kind) for kind, _ in groupby(arc.control for arc in best.arcs)]
    ['+F_max', 'interior', '+F_max', 'interior', '-F_max']
    """
    problem = scale_problem(plant, move, force_limit=force_limit, t_f=t_f, weights=weights)
    solved = solve_saturated(problem)
    arcs = _published(problem, solved)
    target, fixed = terminal_target(plant, move)
    measured = _measure(plant, problem, solved.flow)
    squares = [
        weight.value * measured.squares[plant.states.index(weight.state)] for weight in weights
    ]
    terms = np.array([measured.effort, *squares])
    return DampingOptimum(
        move=move,
        force_limit=force_limit,
        bounds=(),
        method="exact",
        t_f=t_f,
        weights=weights,
        arcs=arcs,
        cost=float(terms.sum()),
        cost_terms=terms,
        adjoint_initial=solved.flow.starts[0, plant.order : -1] * problem.adjoint_scale,
        law_residual=solved.violation,
        terminal_error=np.where(fixed, propagate(plant, arcs) - target, 0.0),
        peaks=measured.peaks,
    )


def _published(problem: SaturatedProblem, solved: Iterate) -> tuple[Arc, ...]:
    F, edges, width = problem.force_limit, solved.arcs.edges, 2 * problem.order
    arcs, generator = [], problem.generators[1, :width, :width]
    output = F * problem.control_row[:width]
    for start, end, label in zip(edges[:-1], edges[1:], solved.arcs.labels, strict=True):
        if label:
            control = Bang(int(label))
            arcs.append(constant_arc(float(start), float(end), control=control, force=label * F))
            continue
        inside = (solved.flow.t[:, 0] >= start) & (solved.flow.t[:, 0] < end)
        starts = np.append(solved.flow.t[inside, 0], end)
        for i, z in enumerate(solved.flow.starts[inside]):
            arcs.append(
                Arc(
                    t_start=float(starts[i]),
                    t_end=float(starts[i + 1]),
                    control=Interior(),
                    generator=generator,
                    initial=z[:width],
                    output=output,
                )
            )
    return tuple(arcs)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Block:
    """Fine samples of some pieces, m of the cells between the samples of the flow."""

    step: Array  # Between fine samples, shape (m,) [s]
    control: Array  # Unlimited control, shape (m, REFINEMENT + 1)
    labels: Labels  # As in ``ArcSequence``, shape (m,)
    # values, rates: Signals and their derivatives, shape (m, REFINEMENT + 1, n_signals).
    values: Array
    rates: Array


def _blocks(plant: Plant, problem: SaturatedProblem, flow: PiecewiseFlow) -> Iterator[_Block]:
    """Yield the fine samples of the whole move, some thousand cells at a time."""
    signals = np.zeros((len(plant.signals), problem.control_row.size))
    signals[:, : plant.order] = signal_rows(plant) * problem.state_scale
    first = np.append(0, np.flatnonzero(np.diff(flow.owner)) + 1)
    steps, labels = (flow.t[first, 1] - flow.t[first, 0]) / REFINEMENT, flow.labels[first]
    finer = matrix_powers(problem.flows(labels, steps), REFINEMENT)
    rates = signals @ problem.generators[labels + 1]
    waiting: list[_Block] = []
    for arc, pieces in enumerate(np.split(flow.starts, first[1:])):
        rows = np.vstack([problem.control_row, signals, rates[arc]]) @ finer[arc]
        for part in np.split(pieces, range(BLOCK, len(pieces), BLOCK)):
            waiting.append(_block(part, flow.powers[arc, :-1], rows, steps[arc], labels[arc]))
            if sum(block.step.size for block in waiting) >= BLOCK * SAMPLES_PER_PIECE:
                yield _joined(waiting)
                waiting = []
    if waiting:
        yield _joined(waiting)


def _block(pieces: Array, powers: Array, rows: Array, step: float, label: int) -> _Block:
    N = pieces.shape[1]
    coarse = (pieces @ powers.transpose(2, 0, 1).reshape(N, -1)).reshape(-1, N)
    fine = (coarse @ rows.reshape(-1, N).T).reshape(len(coarse), *rows.shape[:2])
    k = rows.shape[1] // 2
    return _Block(
        step=np.full(len(coarse), step),
        control=fine[:, :, 0],
        labels=np.full(len(coarse), label),
        values=fine[:, :, 1 : k + 1],
        rates=fine[:, :, k + 1 :],
    )


def _joined(blocks: list[_Block]) -> _Block:
    return _Block(
        step=np.concatenate([block.step for block in blocks]),
        control=np.concatenate([block.control for block in blocks]),
        labels=np.concatenate([block.labels for block in blocks]),
        values=np.concatenate([block.values for block in blocks]),
        rates=np.concatenate([block.rates for block in blocks]),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Measured:
    """Integrals of F_set² [N² s] and of each squared signal, and the signals' peaks."""

    effort: float
    squares: Array
    peaks: Array


def _measure(plant: Plant, problem: SaturatedProblem, flow: PiecewiseFlow) -> _Measured:
    rule = newton_cotes(REFINEMENT)[0]
    k = len(plant.signals)
    effort, squares, peaks = 0.0, np.zeros(k), np.zeros(k)
    for block in _blocks(plant, problem, flow):
        force = np.where(
            block.labels[:, None] == 0, block.control, block.labels[:, None] * flow.bound
        )
        effort += float(block.step @ (force**2 @ rule))
        squares += block.step @ (rule @ block.values**2)
        inside = hermite_peaks(
            np.repeat(block.step, REFINEMENT),
            block.values[:, :-1].reshape(-1, k),
            block.values[:, 1:].reshape(-1, k),
            start_rate=block.rates[:, :-1].reshape(-1, k),
            end_rate=block.rates[:, 1:].reshape(-1, k),
        )
        peaks = np.maximum(peaks, inside)
    return _Measured(effort=problem.force_limit**2 * effort, squares=squares, peaks=peaks)
