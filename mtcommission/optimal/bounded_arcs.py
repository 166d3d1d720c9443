"""Sequences of bang arcs, boundary arcs and touch points, solved to full precision.

The unknowns are the durations, the places of the touch points, the terminal multipliers and
the atoms; the equations are the entry conditions c x = ±1, c A x = 0, ..., the touch conditions
c x = ±1, c A x = 0, the terminal conditions, and σ = 0 at every switch. The system is square
for every sequence whose boundary arcs have order 1 or 2 (docs/optimal-control-bounds.md,
section 4); arcs of higher order are joined by infinitely many touch points and have no such
sequence.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.optimal.bounded_dual import Atom, Core, Measure
from mtcommission.optimal.bounded_problem import BoundedProblem, step_response, transition

Array = NDArray[np.float64]

NEWTON_STEPS = 14

RESIDUAL = 1e-10
"""Scaled residual below which a sequence counts as solved; rounding leaves 1e-15 ... 1e-12."""

LARGEST_STEP = 0.2
"""Largest change of a duration in one step, as a share of t_f: beyond it the responses of
negative durations grow without bound."""

DIFFERENCE = 1e-7
"""Relative step of the difference quotients: the root of double precision."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A bang arc or a boundary arc.

    Parameters
    ----------
    limit
        Index of the bound held; -1 on a bang arc.
    side
        Sign of the force, or of the bounded signal.
    duration
        [s].
    """

    limit: int
    side: int
    duration: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """A touch point inside a bang arc, or inside a boundary arc of order 1.

    Parameters
    ----------
    piece
        Index of the arc.
    offset
        Time since its start [s].
    limit
        Index of the bound.
    side
        +1 or -1.
    """

    piece: int
    offset: float
    limit: int
    side: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sequence:
    """Pieces in order of time, with the touch points.

    Parameters
    ----------
    pieces
        Bang and boundary arcs.
    touches
        Touch points.
    """

    pieces: tuple[Piece, ...]
    touches: tuple[Touch, ...]

    @property
    def t_f(self) -> float:
        """Sum of the durations [s]."""
        return sum(piece.duration for piece in self.pieces)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extremal:
    """A sequence with the multipliers that go with it.

    Parameters
    ----------
    sequence
        Durations and touch points.
    measure
        Dual point.
    residual
        Largest scaled residual of all conditions.
    """

    sequence: Sequence
    measure: Measure
    residual: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _System:
    problem: BoundedProblem
    sequence: Sequence
    scale: float

    @property
    def counts(self) -> tuple[int, int, int]:
        pieces = self.sequence.pieces
        entries = sum(p.limit >= 0 and self.problem.limits[p.limit].order == 2 for p in pieces)
        return len(pieces), len(self.sequence.touches), entries

    def placed(self, unknowns: Array) -> Sequence:
        n_pieces, n_touches, _ = self.counts
        times = unknowns[: n_pieces + n_touches] * self.scale
        return Sequence(
            pieces=tuple(
                replace(piece, duration=float(t))
                for piece, t in zip(self.sequence.pieces, times[:n_pieces], strict=True)
            ),
            touches=tuple(
                replace(touch, offset=float(t))
                for touch, t in zip(self.sequence.touches, times[n_pieces:], strict=True)
            ),
        )


def solve_sequence(problem: BoundedProblem, guess: Sequence) -> Extremal:
    """Return the extremal of a given sequence by Newton's method.

    Parameters
    ----------
    problem
        The bounded problem.
    guess
        Sequence with approximate durations.

    Returns
    -------
    Extremal
        Its residual tells whether the iteration converged; durations may have become negative
        where the sequence is not the optimal one.
    """
    system = _System(problem=problem, sequence=guess, scale=guess.t_f)
    times = [piece.duration for piece in guess.pieces] + [touch.offset for touch in guess.touches]
    start = np.array(times) / system.scale
    unknowns = np.concatenate([start, _first_multipliers(system, guess)])
    residual = _residual(system, unknowns)
    damping = 1e-9
    for _ in range(NEWTON_STEPS):
        norm = float(np.linalg.norm(residual))
        if norm < 1e-14:
            break
        trial, damping = _newton_step(system, unknowns, residual, damping)
        far = float(np.abs(trial - unknowns)[: start.size].max()) >= LARGEST_STEP
        following = residual if far else _residual(system, trial)
        if float(np.linalg.norm(following)) >= norm:
            break
        unknowns, residual = trial, following
        if norm < RESIDUAL and float(np.linalg.norm(residual)) > 0.1 * norm:
            break
    sequence = system.placed(unknowns)
    return Extremal(
        sequence=sequence,
        measure=_measure(system, sequence, unknowns[start.size :]),
        residual=float(np.abs(residual).max()),
    )


def _newton_step(
    system: _System, unknowns: Array, residual: Array, damping: float
) -> tuple[Array, float]:
    """Return the damped Newton iterate (Levenberg-Marquardt) and the next damping."""
    jacobian = np.empty((residual.size, unknowns.size))
    for i in range(unknowns.size):
        step = DIFFERENCE * max(1.0, abs(unknowns[i]))
        moved = unknowns.copy()
        moved[i] += step
        jacobian[:, i] = (_residual(system, moved) - residual) / step
    size = np.linalg.norm(jacobian, axis=0) + 1e-300
    left, value, right = np.linalg.svd(jacobian / size)
    weights, norm = left.T @ residual, np.linalg.norm(residual)
    trial, times = unknowns, sum(system.counts[:2])
    for _ in range(6):
        trial = unknowns - (right.T @ (weights * value / (value**2 + damping**2))) / size
        near = float(np.abs(trial - unknowns)[:times].max()) < LARGEST_STEP
        if near and float(np.linalg.norm(_residual(system, trial))) < norm:
            return trial, damping * 1e-3
        damping = max(damping, 1e-12) * 30.0
    return trial, damping


def _first_multipliers(system: _System, guess: Sequence) -> Array:
    """Return the multipliers that fit best, a linear problem for given durations."""
    _, n_touches, entries = system.counts
    size = system.problem.fixed.size + entries + n_touches
    _, final_rate, _ = _primal(system, guess)
    base = _dual(system, guess, np.zeros(size), final_rate)
    columns = [_dual(system, guess, unit, final_rate) - base for unit in np.eye(size)]
    return np.asarray(np.linalg.lstsq(np.column_stack(columns), -base, rcond=None)[0])


def _residual(system: _System, unknowns: Array) -> Array:
    n_pieces, n_touches, _ = system.counts
    sequence = system.placed(unknowns)
    conditions, final_rate, _ = _primal(system, sequence)
    multipliers = unknowns[n_pieces + n_touches :]
    return np.concatenate([conditions, _dual(system, sequence, multipliers, final_rate)])


def _flows(problem: BoundedProblem, sequence: Sequence) -> tuple[Array, Array]:
    durations = np.array([piece.duration for piece in sequence.pieces])
    # Newton's trial durations may be negative: the response then runs backwards.
    forward = transition(problem.plant, durations)
    pushes = step_response(problem.plant, durations)
    for i in np.nonzero(durations < 0.0)[0]:
        pushes[i] = -forward[i] @ step_response(problem.plant, -durations[i])
    return forward, pushes * problem.force_limit


def _primal(system: _System, sequence: Sequence) -> tuple[Array, Array, Array]:
    """Return the scaled conditions on the state, dx/dt at the end, and the states at the starts."""
    problem, plant = system.problem, system.problem.plant
    flows, pushes = _flows(problem, sequence)
    state, starts, rest = np.zeros(plant.order), [], []
    for i, piece in enumerate(sequence.pieces):
        starts.append(state)
        if piece.limit >= 0:
            limit = problem.limits[piece.limit]
            levels = np.zeros(limit.order)
            levels[0] = piece.side
            rest.append(limit.output_chain @ state - levels)
        touches = (touch for touch in sequence.touches if touch.piece == i)
        rest += [_touch_conditions(problem, touch, piece, state) for touch in touches]
        if piece.limit >= 0:
            state = expm(limit.boundary_flow * piece.duration) @ state
            continue
        state = flows[i] @ state + pushes[i] * piece.side
    error = (state - problem.target) / problem.state_scale
    rest.append(error[problem.fixed])
    force = sequence.pieces[-1].side * problem.force_limit
    return np.concatenate(rest), plant.A @ state + plant.B * force, np.array([*starts, state])


def _touch_conditions(problem: BoundedProblem, touch: Touch, piece: Piece, state: Array) -> Array:
    plant, row = problem.plant, problem.limits[touch.limit].row
    if piece.limit >= 0:
        flow = problem.limits[piece.limit].boundary_flow
        at = expm(flow * touch.offset) @ state
        return np.array([row @ at - touch.side, row @ flow @ at / problem.rate])
    since, force = np.array(touch.offset), piece.side * problem.force_limit
    at = transition(plant, since) @ state + step_response(plant, since) * force
    rate = plant.A @ at + plant.B * force
    return np.array([row @ at - touch.side, row @ rate / problem.rate])


def piece_states(problem: BoundedProblem, piece: Piece, state: Array, tau: Array) -> Array:
    """Return the states on a piece.

    Parameters
    ----------
    problem
        The bounded problem.
    piece
        Bang or boundary arc.
    state
        At its start, shape (n,).
    tau
        Evenly spaced times since its start, from 0, shape (k,) [s].

    Returns
    -------
    ndarray, shape (k, n)
    """
    if piece.limit < 0:
        pushes = step_response(problem.plant, tau) * piece.side * problem.force_limit
        return np.asarray(transition(problem.plant, tau) @ state + pushes)
    flow = expm(problem.limits[piece.limit].boundary_flow * (tau[1] - tau[0]))
    states = [state]
    for _ in tau[1:]:
        states.append(flow @ states[-1])
    return np.array(states)


def _flow_back(problem: BoundedProblem, piece: Piece, span: float) -> Array:
    """Return the map of Λ over the last ``span`` seconds of a piece, shape (n, n)."""
    if piece.limit < 0:
        return transition(problem.plant, np.array(span))
    return np.asarray(expm(problem.limits[piece.limit].adjoint_flow * span))


def _atoms(
    system: _System, sequence: Sequence, multipliers: Array
) -> tuple[dict[int, float], list[tuple[int, float, int, float]]]:
    """Return the entry atoms by piece, and the touch atoms as (piece, offset, limit, weight)."""
    problem, pieces = system.problem, sequence.pieces
    size = problem.fixed.size
    entered = [
        i for i, p in enumerate(pieces) if p.limit >= 0 and problem.limits[p.limit].order == 2
    ]
    entries = {
        i: pieces[i].side * float(nu)
        for i, nu in zip(entered, multipliers[size : size + len(entered)], strict=True)
    }
    touched = [
        (touch.piece, touch.offset, touch.limit, touch.side * float(nu))
        for touch, nu in zip(sequence.touches, multipliers[size + len(entered) :], strict=True)
    ]
    return entries, sorted(touched, key=lambda one: (-one[0], -one[1]))


def _terminal(system: _System, multipliers: Array) -> Array:
    problem = system.problem
    terminal = np.zeros(problem.plant.order)
    size = problem.fixed.size
    terminal[problem.fixed] = multipliers[:size] / problem.state_scale[problem.fixed]
    return terminal


def _dual(system: _System, sequence: Sequence, multipliers: Array, final_rate: Array) -> Array:
    """Return the conditions on the adjoint: normalisation, then σ = 0 at the switches."""
    problem, plant = system.problem, system.problem.plant
    to_sigma = problem.force_limit * plant.force_lag * plant.B
    entries, touched = _atoms(system, sequence, multipliers)
    adjoint = _terminal(system, multipliers)
    conditions = [float(adjoint @ final_rate) * system.scale - 1.0]
    flows, _ = _flows(problem, sequence)
    for i in range(len(sequence.pieces) - 1, -1, -1):
        piece = sequence.pieces[i]
        if piece.limit >= 0:
            conditions.append(float(adjoint @ to_sigma) / plant.force_lag * system.scale)
            adjoint = adjoint - _exit_weight(problem, piece, adjoint) * _row(problem, piece)
        end = piece.duration
        for _, offset, limit, weight in (one for one in touched if one[0] == i):
            adjoint = adjoint @ _flow_back(problem, piece, end - offset)
            adjoint, end = adjoint - weight * problem.limits[limit].row, offset
        whole = end == piece.duration and piece.limit < 0
        adjoint = adjoint @ (flows[i] if whole else _flow_back(problem, piece, end))
        if piece.limit >= 0:
            adjoint = adjoint - entries.get(i, 0.0) * _row(problem, piece)
            continue
        if i > 0 and sequence.pieces[i - 1].limit < 0:
            conditions.append(float(adjoint @ to_sigma) / plant.force_lag * system.scale)
    return np.array(conditions)


def _row(problem: BoundedProblem, piece: Piece) -> Array:
    return problem.limits[piece.limit].row


def _exit_weight(problem: BoundedProblem, piece: Piece, adjoint: Array) -> float:
    """Return the atom at the exit of an arc of order 2, which makes dσ/dt = 0 on the arc."""
    limit = problem.limits[piece.limit]
    if limit.order != 2:
        return 0.0
    return float(adjoint @ limit.force_chain[:, 1]) / limit.gain


def _measure(system: _System, sequence: Sequence, multipliers: Array) -> Measure:
    problem = system.problem
    entries, touched = _atoms(system, sequence, multipliers)
    atoms: list[Atom] = []
    cores: list[Core] = []
    adjoint, after = _terminal(system, multipliers), 0.0
    for i in range(len(sequence.pieces) - 1, -1, -1):
        piece = sequence.pieces[i]
        before = after + piece.duration
        if piece.limit >= 0:
            out, k = _exit_weight(problem, piece, adjoint), piece.limit
            adjoint = adjoint - out * _row(problem, piece)
            cores.append(Core(start=before, end=after, limit=k, side=piece.side))
            atoms.append(Atom(remaining=after, limit=k, weight=out))
            atoms.append(Atom(remaining=before, limit=k, weight=entries.get(i, 0.0)))
        end = piece.duration
        for _, offset, limit, weight in (one for one in touched if one[0] == i):
            adjoint = adjoint @ _flow_back(problem, piece, end - offset)
            adjoint, end = adjoint - weight * problem.limits[limit].row, offset
            at = after + piece.duration - offset
            atoms.append(Atom(remaining=at, limit=limit, weight=weight))
        adjoint = adjoint @ _flow_back(problem, piece, end)
        if piece.limit >= 0:
            adjoint = adjoint - entries.get(i, 0.0) * _row(problem, piece)
        after = before
    return Measure(
        t_f=after,
        terminal=_terminal(system, multipliers),
        atoms=tuple(atom for atom in atoms if atom.weight != 0.0),
        cores=tuple(reversed(cores)),
    )
