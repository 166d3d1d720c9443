"""The time-optimal control without limits on states: exact, and proved.

The structure (the number of switches) is found, never assumed. docs/optimal-control.md derives
the method.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import inf, nan

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesdd

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.bang_bang import (
    AGREEMENT,
    LEAST_SHARE,
    MARGIN,
    Attempt,
    attempt,
    find_bang_bang,
    guess_horizon,
)
from mtcommission.optimal.control import (
    ONE,
    STILL,
    Arc,
    Bang,
    Certificate,
    Optimum,
    TimeOptimum,
    hermite_peaks,
    signal_rows,
    terminal_target,
)
from mtcommission.optimal.modes import (
    TINY,
    MomentProblem,
    driven,
    impulse_response,
    independence,
    moment_problem,
    moment_rows,
    step_response,
    transition,
)
from mtcommission.optimal.switching import (
    ROUNDOFF,
    Control,
    build_mesh,
    graded_nodes,
)

Array = NDArray[np.float64]

GAP_TOLERANCE = 1e-9
"""Largest relative distance of t_f from its proved lower bound."""
ERROR_TOLERANCE = 1e-9
"""Largest terminal error of a state against the peak of that state."""
SAME_INSTANT = 1e-13
"""Distance of two switches against t_f below which there are none: Newton's method has closed the
arc between them, or left it as short as rounding allows (empirical: no arc of 1480 optima was
between that and 1e-8)."""
SIGN_TOLERANCE = 1e-9
"""|λ B| against its largest value below which a sign is not judged: there the control switches."""
SIGN_ROUNDING = 1e3 * ROUNDOFF
"""The same against the sum of the magnitudes that λ B is composed of (empirical)."""
RANK_TOLERANCE = 1e-12
"""Singular value against the largest below which the terminal Jacobian counts as singular."""


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
    >>> from mtcommission.machine.plant.plant import build_plant
    >>> from mtcommission.machine.profile.shipped import read_shipped
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
    span = problem.target / force_limit
    try:
        found = find_bang_bang(problem, span=span)
        return _published(plant, move, problem, found, force_limit=force_limit)
    except ComputationError as error:
        horizon = guess_horizon(problem, span=span)
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


def solve_forces(
    plant: Plant, move: Move, force_limits: Array
) -> Iterator[tuple[BangBangMotion, float] | None]:
    """Yield optimal motion and proved least time for forces in rising order.

    Each search starts from the control before; None where nothing is proved.
    """
    problem = moment_problem(plant, move)
    found: Attempt | None = None
    for force in force_limits.tolist():
        near, found, span = found, None, problem.target / force
        if near:
            mesh, horizon = near.mesh, near.control.horizon
            if horizon < LEAST_SHARE * mesh.horizon:
                mesh = build_mesh(problem, MARGIN * horizon)
            found = attempt(mesh, near.control, span=span)
        if found is None or found.gap > AGREEMENT:
            try:
                found = find_bang_bang(problem, span=span)
            except ComputationError:
                found = None
        if found is None or found.gap > GAP_TOLERANCE:
            yield None
            continue
        motion = _motion(plant, problem, found.control, force_limit=force)
        yield motion, min(found.proved.horizon, motion.t_f)


def _published(
    plant: Plant, move: Move, problem: MomentProblem, found: Attempt, *, force_limit: float
) -> TimeOptimum:
    motion = _motion(plant, problem, found.control, force_limit=force_limit)
    t_f = motion.t_f
    states = motion.states_at(np.array([t_f, *motion.switching_times[-1:].tolist()]))
    target, fixed = terminal_target(plant, move)
    optimum = Optimum(
        move=move,
        force_limit=force_limit,
        bounds=(),
        method="exact",
        t_f=t_f,
        arcs=_arcs(motion),
        touch_points=(),
        terminal_error=np.where(fixed, states[0] - target, 0.0),
        motion=motion,
        certificate=certify(motion, found.proved, nodes=found.mesh.nodes),
    )
    _check(optimum, plant, np.abs(states[-1]))
    return optimum


def _motion(
    plant: Plant, problem: MomentProblem, control: Control, *, force_limit: float
) -> BangBangMotion:
    zeros, t_f = _told_apart(control), control.horizon
    return BangBangMotion(
        plant=plant,
        problem=problem,
        switching_times=t_f - zeros[::-1],
        t_f=t_f,
        first_force=control.first_sign * (-1.0) ** zeros.size * force_limit,
    )


def _told_apart(control: Control) -> Array:
    kept: list[float] = []
    for zero in control.zeros.tolist():
        if kept and zero - kept[-1] <= SAME_INSTANT * control.horizon:
            kept.pop()
        else:
            kept.append(zero)
    return np.array(kept)


def _arcs(motion: BangBangMotion) -> tuple[Arc, ...]:
    forces = [motion.first_force, -motion.first_force]
    outputs = [np.array([force]) for force in forces]
    controls = [Bang(1 if force > 0.0 else -1) for force in forces]
    return tuple(
        Arc(
            t_start=start,
            t_end=end,
            control=controls[i % 2],
            generator=STILL,
            initial=ONE,
            output=outputs[i % 2],
        )
        for i, (start, end) in enumerate(
            pairwise([0.0, *motion.switching_times.tolist(), motion.t_f])
        )
    )


def certify(motion: BangBangMotion, proved: Control, *, nodes: Array) -> Certificate:
    """Return what a switching function and the time that it proves say about a control.

    The switching times enter only the comparisons; the bound comes from the multipliers. The sign
    of λ B is looked at on the nodes.

    Source: Pontryagin's principle as in Christiansen, Maurer & Zirn, eq. (7)-(9); the bound:
    docs/optimal-control.md, section 2.
    """
    plant, problem, weights, t_f = motion.plant, motion.problem, proved.weights, motion.t_f
    # The control meets its target only to rounding, so the bound may exceed it by as little.
    bound = min(proved.horizon, t_f)
    # In the order of time, so those at t = 0 come first.
    functions = problem.values(t_f - np.concatenate(((0.0,), motion.switching_times)))
    sigma, slopes = weights.dot(functions), problem.differentiation.dot(weights).dot(functions)
    factor, rank, condition = 1.0 / abs(motion.first_force * float(sigma[0])), -1, nan
    if len(functions) == sigma.size:
        values = dgesdd(_scaled(functions), compute_uv=0)[1]
        rank = int((values > RANK_TOLERANCE * values[0]).sum())
        condition = float(values[0] / max(values[-1], TINY))
    rows = -factor * moment_rows(plant, problem)
    along = _along_force(motion, weights.dot(rows), nodes[nodes < t_f])
    composed = factor * (float(problem.amplitudes(weights).sum()) + t_f**problem.degree)
    zero = SIGN_TOLERANCE * float(np.abs(along).max()) + SIGN_ROUNDING * composed
    largest = max(float(along.max()), factor * float(np.abs(sigma[1:]).max(initial=0.0)))
    return Certificate(
        t_f_lower_bound=bound,
        relative_gap=(t_f - bound) / t_f,
        adjoint_initial=_moved(problem, weights, t_f).dot(rows),
        switching_slopes=factor * slopes[1:],
        switching_law_holds=largest <= zero,
        terminal_jacobian_rank=rank,
        terminal_jacobian_condition=condition,
    )


def _moved(problem: MomentProblem, weights: Array, tau: float) -> Array:
    moved = weights.copy()
    pairs = problem.modal(weights) * np.exp(problem.rates * tau)
    moved[: problem.one] = pairs.conj().view(np.float64)[: problem.one]
    if problem.degree:
        moved[-2] += tau * weights[-1]
    return moved


def _scaled(functions: Array) -> Array:
    lengths = np.sqrt(np.add.reduce(functions * functions, axis=1))
    by_row = functions / np.maximum(lengths, TINY)[:, np.newaxis]
    return np.asarray(by_row / np.sqrt(np.add.reduce(by_row * by_row)))


def _along_force(motion: BangBangMotion, end: Array, tau: Array) -> Array:
    """Return λ B sign F_set at remaining times, from λ(t_f) by the plant's own e^{Aτ} B."""
    times = motion.switching_times
    switches = times.size - (motion.t_f - times[::-1]).searchsorted(tau)
    signs = np.sign(motion.first_force) * (-1.0) ** switches
    return np.asarray(signs * (impulse_response(motion.plant, tau) @ end))


def _check(optimum: TimeOptimum, plant: Plant, reached: Array) -> None:
    """Raise where the gap or the terminal error is too large.

    ``reached`` is a magnitude that each state has somewhere on the way, so it is below the peak: an
    error that passes against it passes against the peak, too, which then need not be searched for.
    """
    gap, size = optimum.certificate.relative_gap, np.abs(optimum.terminal_error)
    if gap <= GAP_TOLERANCE and (size <= ERROR_TOLERANCE * reached).all():
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


Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

PEAK_RADIANS = 0.5
"""Mesh for peaks against the fastest pole: cubics through it err by 2e-4 of an oscillation."""
PEAK_PARTS = 20
"""Of a cell that may hold a peak: cubics then err by 1e-9 of an oscillation."""
SELECTION_MARGIN = 1e-3
"""Relative reserve for the error of the coarse cubics."""
ROUNDOFF_MARGIN = 1e-13
"""Rise within a cell, against the peak, that is not worth a closer look."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBangMotion:
    """The motion from rest under a force that changes sign at given times."""

    plant: Plant  # The plant
    problem: MomentProblem  # A moment problem of it
    switching_times: Array  # Ascending, shape (n_switches,) [s]
    t_f: float  # End [s]
    first_force: float  # F_set on the first arc [N]

    def states_at(self, instants: Array) -> Array:
        """Return the states at some times, as sums of step responses: without the moments."""
        starts = np.concatenate(((0.0,), self.switching_times))
        steps = np.full(starts.size, -2.0 * self.first_force)
        steps[0], steps[2::2] = self.first_force, 2.0 * self.first_force
        # A step that is still to come has no response.
        since = np.maximum(instants[:, np.newaxis] - starts, 0.0)
        responses = step_response(self.plant, since)
        return np.asarray(steps @ responses)

    @property
    def force_peak(self) -> float:
        """Largest magnitude of what is set [N]."""
        return abs(self.first_force)

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals`` on [0, t_f].

        Cubics show in which cells a peak is possible; there finer ones find it.
        """
        plant, rows = self.plant, signal_rows(self.plant)
        lengths = np.diff(np.concatenate(([0.0], self.switching_times, [self.t_f])))
        forces = np.full(lengths.size, self.first_force)
        forces[1::2] *= -1.0
        starts = np.zeros((lengths.size, plant.order))
        flows = transition(plant, lengths)
        pushes = step_response(plant, lengths) * forces[:, np.newaxis]
        for i in range(lengths.size - 1):
            starts[i + 1] = flows[i] @ starts[i] + pushes[i]

        def signals(arc: Index, since: Array) -> tuple[Array, Array]:
            states = driven(plant, starts[arc], forces[arc], since)
            rates = states @ plant.A.T + np.multiply.outer(forces[arc], plant.B)
            return states @ rows.T, rates @ rows.T

        nodes = graded_nodes(self.problem, float(lengths.max()), radians=PEAK_RADIANS)
        # A fast pole matters only for a while after each switch, for all arcs alike.
        counts = np.maximum(nodes.searchsorted(lengths), 1) + 1
        arc = np.arange(counts.size).repeat(counts)
        index = np.arange(arc.size) - (counts.cumsum() - counts).repeat(counts)
        since = np.minimum(nodes[index], lengths[arc])
        value, rate = signals(arc, since)
        # From the end of an arc to the start of the next is a cell of no length.
        step = (since[1:] - since[:-1]) * (index[1:] > 0)
        size, third = np.abs(value), step[:, np.newaxis] / 3.0
        outer = np.maximum(size[:-1], size[1:])
        inner = np.maximum(
            np.abs(value[:-1] + third * rate[:-1]), np.abs(value[1:] - third * rate[1:])
        )
        largest = outer.max(axis=0)
        # A plateau is nearly largest everywhere, but its control points do not rise above its ends.
        rises = inner > outer + ROUNDOFF_MARGIN * largest
        chosen = ((inner >= (1.0 - SELECTION_MARGIN) * largest) & rises).any(axis=1)
        cell = chosen.nonzero()[0]
        if not cell.size:
            return np.asarray(largest)
        finer = step[cell] / PEAK_PARTS
        at = since[cell, np.newaxis] + finer[:, np.newaxis] * np.arange(PEAK_PARTS + 1)
        value, rate = signals(arc[cell].repeat(PEAK_PARTS + 1), at.ravel())
        start = np.arange(at.size).reshape(at.shape)[:, :-1].ravel()
        inside = hermite_peaks(
            finer.repeat(PEAK_PARTS),
            value[start],
            value[start + 1],
            start_rate=rate[start],
            end_rate=rate[start + 1],
        )
        return np.asarray(np.maximum(largest, inside))
