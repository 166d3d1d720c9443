"""The time-optimal control without limits on states: exact, and proved.

The structure (the number of switches) is found, never assumed. docs/optimal-control.md derives
the method.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, nan

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesdd

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.closed_form import impulse_response
from mtcommission.optimal.free.bang_bang import BangBangMotion
from mtcommission.optimal.free.mesh import Mesh, build_mesh
from mtcommission.optimal.free.moments import (
    TINY,
    MomentProblem,
    independence,
    moment_problem,
    moment_rows,
)
from mtcommission.optimal.free.newton import refine_control
from mtcommission.optimal.free.start import (
    LEAST_SHARE,
    MARGIN,
    PARTS,
    guess_horizon,
    improve,
    refine_cells,
    start_force,
)
from mtcommission.optimal.free.switching import ROUNDOFF, Control, prove_time
from mtcommission.optimal.solution import (
    Arc,
    Bang,
    Certificate,
    Optimum,
    TimeOptimum,
    terminal_target,
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
AGREEMENT = 1e-12
"""Relative distance of time and bound at which the search ends at once."""
SUFFICIENT = 1e-10
"""Distance that no finer start is tried for: rounding, not the start, is what is left."""
ROUNDING = 1e-9
"""Doubt about t_f that rounding alone may leave for a refinement to be tried."""
EXCHANGES = 4
"""Changes of structure in a row; one is usual next to the birth of an arc."""
TOLERANCES = (5e-3, 1e-4, 1e-6)
"""Gaps of the starts on the first cells: with two modes five of six attempts succeed from the
first, the next one gives the structure where pairs of zeros are close (empirical)."""
REFINEMENTS = 8
"""Divisions; the last has cells of 1e-5 of the fastest period where σ is near zero."""
SIGN_TOLERANCE = 1e-9
"""|λ B| against its largest value below which a sign is not judged: there the control switches."""
SIGN_ROUNDING = 1e3 * ROUNDOFF
"""The same against the sum of the magnitudes that λ B is composed of (empirical)."""
RANK_TOLERANCE = 1e-12
"""Singular value against the largest below which the terminal Jacobian counts as singular."""
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attempt:
    """A feasible control, and the sign of its σ up to the time that this proves."""

    control: Control
    proved: Control
    mesh: Mesh  # That σ was looked at on

    @property
    def gap(self) -> float:
        """Relative distance of both times."""
        return abs(1.0 - self.proved.horizon / self.control.horizon)


def find_bang_bang(problem: MomentProblem, *, span: float) -> Attempt:
    """Return the time-optimal control as signs over the remaining time.

    Starts of rising accuracy are refined, the last ones on finer cells. An attempt is accepted when
    the bound that its multipliers prove equals the time that it takes.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if no attempt is feasible; how far the bound stays behind is left to the
        certificate.
    """
    cells = start_force(problem, span=span, tolerance=TOLERANCES[0])
    best = _exchange(cells.mesh, cells.control, span)
    for tolerance in TOLERANCES[1:]:
        if best and best.gap <= AGREEMENT:
            return best
        cells = improve(cells, span=span, tolerance=tolerance)
        best = _better(best, _exchange(cells.mesh, cells.control, span))
    # Finer starts help the structure, not the digits that nearly dependent functions cost.
    is_worth = ROUNDING * independence(problem, cells.horizon) > ROUNDOFF
    for refinement in range(REFINEMENTS if is_worth else 0):
        if best and best.gap <= SUFFICIENT:
            break
        for start in (cells.control, prove_time(cells.mesh, cells.control, span=span)):
            best = _better(best, _exchange(cells.mesh, start, span))
        tolerance = TOLERANCES[-1] * PARTS ** -(refinement + 1)
        cells = improve(refine_cells(cells), span=span, tolerance=tolerance)
    if best is None:
        detail = Message("no-control-reaches-rest", span=span, t_f=cells.horizon)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return best


def _better(one: Attempt | None, other: Attempt | None) -> Attempt | None:
    if one is None or other is None:
        return one or other
    return one if one.gap <= other.gap else other


def _exchange(mesh: Mesh, start: Control, span: float) -> Attempt | None:
    """Refine; where the multipliers then show other zeros than the control has, do so with those.

    Next to the birth of an arc this is what adds two zeros; where no control has the zeros of the
    start, the two that are closest are dropped.
    """
    best = None
    for _ in range(EXCHANGES):
        control = refine_control(mesh, start, span=span)
        if control is None:
            if best or start.zeros.size < 2:
                break
            closest = int(np.diff(start.zeros).argmin())
            start = replace(start, zeros=np.delete(start.zeros, (closest, closest + 1)))
            continue
        start = prove_time(mesh, control, span=span)
        attempt = Attempt(control=control, proved=start, mesh=mesh)
        best = _better(best, attempt)
        if attempt.gap <= AGREEMENT or start.zeros.size == control.zeros.size:
            break
    return best


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
            found = _exchange(mesh, near.control, span)
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
    """Return the motion under a control."""
    zeros, t_f = _told_apart(control), control.horizon
    return BangBangMotion(
        plant=plant,
        problem=problem,
        switching_times=t_f - zeros[::-1],
        t_f=t_f,
        first_force=control.first_sign * (-1.0) ** zeros.size * force_limit,
    )


def _told_apart(control: Control) -> Array:
    """Return the zeros but for pairs that coincide."""
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
            generator=NO_CHANGE,
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
    """Return the weights of σ(· + τ)."""
    moved = weights.copy()
    pairs = problem.modal(weights) * np.exp(problem.rates * tau)
    moved[: problem.one] = pairs.conj().view(np.float64)[: problem.one]
    if problem.degree:
        moved[-2] += tau * weights[-1]
    return moved


def _scaled(functions: Array) -> Array:
    """Return functions with rows and then columns of length 1."""
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
