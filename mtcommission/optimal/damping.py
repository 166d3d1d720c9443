"""Plant + move + t_f -> the damping-optimal control: the saturated linear-quadratic problem.

minimise ∫ F_set² + Σ c_i x_i² dt   subject to |F_set| <= F_max, from rest to the target
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import newton_cotes

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Weight
from mtcommission.machine.moves import Move
from mtcommission.messages.message import Message
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.piecewise import follow_piecewise
from mtcommission.optimal.saturated import (
    Iterate,
    SaturatedProblem,
    scale_problem,
    solve_saturated,
    terminal_target,
)
from mtcommission.optimal.solution import (
    Arc,
    Bang,
    DampingOptimum,
    Interior,
    KnownPeaks,
    Law,
    Optimum,
    TimeOptimum,
    constant_arc,
    propagate,
)
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

FINER, BLOCK = 8, 256
"""Parts of a cell for quadrature and peaks: nine-point Newton-Cotes and cubic interpolation then
err by less than 1e-14 and 3e-9 of the fastest amplitude; pieces at a time, some ten megabytes."""
MOST_RADIANS = 1e4
"""Of the fastest mode over the motion: a hundred thousand samples (empirical)."""


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
    found = solve_saturated(problem, force_unit=plant.force_unit)
    arcs = _arcs(problem, found)
    target, fixed = terminal_target(plant, move)
    effort, squares, peaks = _measured(plant, problem, found)
    of_states = [weight.value * squares[plant.states.index(weight.state)] for weight in weights]
    terms = np.array([effort, *of_states])
    return Optimum(
        move=move,
        force_limit=force_limit,
        bounds=(),
        method="exact",
        t_f=t_f,
        weights=weights,
        arcs=arcs,
        cost_terms=terms,
        certificate=Law(
            adjoint_initial=found.z[0, 0, plant.order : -1] * problem.adjoint_scale,
            law_residual=found.violation,
        ),
        terminal_error=np.where(fixed, propagate(plant, arcs) - target, 0.0),
        motion=KnownPeaks(peaks=peaks),
    )


def _arcs(problem: SaturatedProblem, found: Iterate) -> tuple[Arc, ...]:
    """Return one arc where the force is saturated, and one for each piece where it is not."""
    F, width = problem.force_limit, 2 * problem.target.size
    generator, output = problem.generators[0, :width, :width], F * problem.control_row[:width]
    ends = np.append(found.t[1:, 0], problem.t_f).tolist()
    arcs: list[Arc] = []
    for label, start, end, z in zip(
        found.labels.tolist(), found.t[:, 0].tolist(), ends, found.z[:, 0, :width], strict=True
    ):
        if label and arcs and arcs[-1].control == Bang(label):
            start = arcs.pop().t_start
        if label:
            arcs.append(constant_arc(start, end, control=Bang(label), force=label * F))
        else:
            arcs.append(
                Arc(
                    t_start=start,
                    t_end=end,
                    control=Interior(),
                    generator=generator,
                    initial=z,
                    output=output,
                )
            )
    return tuple(arcs)


def _measured(
    plant: Plant, problem: SaturatedProblem, found: Iterate
) -> tuple[float, Array, Array]:
    """Return the integrals of F_set² [N² s] and of each squared signal, and the signals' peaks."""
    rule, rows = newton_cotes(FINER)[0], signal_rows(plant)
    k, n = len(rows), plant.order
    effort, squares, peaks = 0.0, np.zeros(k), np.zeros(k)
    for first in range(0, len(found.z), BLOCK):
        part = slice(first, first + BLOCK)
        labels, step = found.labels[part], found.step[part] / FINER
        finer = problem.flows(labels, step).transpose(0, 2, 1)
        fine = [found.z[part, :-1]]  # each of shape (pieces, cells, N)
        for _ in range(FINER):
            fine.append(fine[-1] @ finer)
        z = np.stack(fine)
        side = labels[:, None] * found.bound
        force = problem.force_limit * np.where(side == 0.0, z @ problem.control_row, side)
        x = z[..., :n] * problem.state_scale
        rates = (x @ plant.A.T + force[..., None] * plant.B) @ rows.T
        values = x @ rows.T
        share = rule[:, None, None] * step[:, None]
        effort += float((share * force**2).sum())
        squares += (share[..., None] * values**2).sum(axis=(0, 1, 2))
        inside = hermite_peaks(
            np.broadcast_to(step[:, None], force[1:].shape).ravel(),
            values[:-1].reshape(-1, k),
            values[1:].reshape(-1, k),
            start_rate=rates[:-1].reshape(-1, k),
            end_rate=rates[1:].reshape(-1, k),
        )
        peaks = np.maximum(peaks, inside)
    return effort, squares, peaks


def balanced_weights(plant: Plant, reference: TimeOptimum) -> tuple[Weight, ...]:
    """Return the weights with which all terms are equal along the time-optimal motion.

    c_i = ∫ F_set² dt / ∫ x_i² dt over the reference, for the deflection and the rate of each
    flexible mode. Along the damping-optimal motion itself the terms then differ: it is what
    the optimisation is free to change.

    Source: Christiansen, Maurer & Zirn, sec. 6: "all terms ... have the same magnitude". That
    the time-optimal solution of their sec. 5.1 is meant is inferred: it gives (17) to 1 ... 3 %,
    see docs/optimal-control.md, section 9.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG.
    """
    fastest = max(mode.natural_frequency for mode in plant.modes)
    radians = fastest * reference.t_f
    if radians > MOST_RADIANS:
        detail = Message("optimum-too-long", t_f=reference.t_f, radians=radians, most=MOST_RADIANS)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    motion = follow_piecewise(plant, reference.arcs, longest=reference.t_f)
    effort, squares = motion.effort, motion.squares
    places = [mode.deflection for mode in plant.modes] + [mode.rate for mode in plant.modes]
    return tuple(Weight(state=plant.states[i], value=effort / float(squares[i])) for i in places)
