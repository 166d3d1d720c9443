"""Sequences of bang arcs, boundary arcs and touch points, solved to full precision.

The unknowns are the durations, the places of the touch points, the terminal multipliers and
the atoms; the equations are the entry conditions c x = ±1, c A x = 0, ..., the touch conditions
c x = ±1, c A x = 0, the terminal conditions, and σ = 0 at every switch. The system is square
for every sequence whose boundary arcs have order 1 or 2 (docs/optimal-control.md,
section 8); arcs of higher order are joined by infinitely many touch points and have no such
sequence.

Every derivative is exact: on each piece the state and the adjoint follow linear flows, so the
derivative of a flow with respect to its duration is the flow times its generator.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.modes import step_response, transition
from mtcommission.optimal.problem import ArcInterior, Atom, BoundedProblem
from mtcommission.optimal.proof import Measure
from mtcommission.optimal.sequence import Pieces, final_time

Array = NDArray[np.float64]

STEPS, DAMPINGS = 20, 6
"""Newton steps at most, and raised dampings tried in one."""
FURTHEST_BACK = 100.0
"""Longest negative duration that is tried, in radians of the fastest rate: the responses run
backwards grow with its exponential."""
RESIDUAL = 1e-10
"""Scaled residual below which a sequence counts as solved; rounding leaves 1e-15 ... 1e-12."""
SINGULAR = 1e-13
"""Share of the largest singular value below which a direction is left alone."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extremal:
    """Pieces with the multipliers that go with them."""

    pieces: Pieces
    measure: Measure  # Dual point
    residual: float  # Largest scaled residual of all conditions


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _System:
    problem: BoundedProblem
    pieces: Pieces
    scale: float  # Unit of the durations [s]
    atoms: tuple[int, ...]  # Number of the atom where a piece begins; -1 without one

    @property
    def width(self) -> int:
        """Number of durations and terminal multipliers; the atoms come behind them."""
        return len(self.pieces) + self.problem.fixed.size

    @property
    def size(self) -> int:
        return self.width + 1 + max(self.atoms)

    def is_last(self, index: int) -> bool:
        """Return whether an arc ends with a piece, and not just at a touch point."""
        return index + 1 == len(self.pieces) or self.pieces[index + 1].touch is None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Point:
    """Unknowns, residual, Jacobian, and the number of conditions on the state (they come first)."""

    unknowns: Array
    residual: Array
    jacobian: Array
    primal: int
    exits: dict[int, float]  # Atoms at the ends of pieces, where σ' is not 0 before

    @property
    def norm(self) -> float:
        return float(np.linalg.norm(self.residual))


Condition = tuple[Array, Array]
"""Scaled values that must vanish, shape (k,), and their derivatives, shape (k, n_unknowns)."""


def solve_sequence(problem: BoundedProblem, guess: Pieces) -> Extremal:
    """Return the extremal of given pieces by Newton's method."""
    orders = [0 if piece.limit < 0 else problem.limits[piece.limit].order for piece in guess]
    has_atom = [p.touch is not None or order == 2 for p, order in zip(guess, orders, strict=True)]
    atoms = np.where(has_atom, np.cumsum(has_atom) - 1, -1)
    scale = final_time(guess)
    system = _System(problem=problem, pieces=guess, scale=scale, atoms=tuple(atoms.tolist()))
    point = _solved(system, _first_point(system))
    durations = (point.unknowns[: len(guess)] * scale).tolist()
    solved = zip(guess, durations, strict=True)
    return Extremal(
        pieces=tuple(replace(piece, duration=duration) for piece, duration in solved),
        measure=_measure(system, point),
        residual=float(np.abs(point.residual).max()),
    )


def _solved(system: _System, point: _Point) -> _Point:
    damping = 1e-9
    for _ in range(STEPS):
        if point.norm < 1e-14:
            break
        following, damping = _newton_step(system, point, damping)
        if following.norm >= point.norm:
            break
        done = point.norm < RESIDUAL and following.norm > 0.1 * point.norm
        point = following
        if done:
            break
    return point


def _step(system: _System, point: _Point, damping: float) -> Array:
    """Return the change of the unknowns to be taken back, damped (Levenberg-Marquardt)."""
    size = np.linalg.norm(point.jacobian, axis=0)
    size[size == 0.0] = 1.0
    left, value, right = np.linalg.svd(point.jacobian / size, full_matrices=False)
    share = value / (value**2 + max(damping, SINGULAR * value[0]) ** 2)
    return np.asarray((right.T @ (left.T @ point.residual * share)) / size)


def _first_point(system: _System) -> _Point:
    unknowns, times = np.zeros(system.size), len(system.pieces)
    unknowns[:times] = [piece.duration / system.scale for piece in system.pieces]
    point = _point(system, unknowns)
    rows, right = point.jacobian[point.primal :, times:], -point.residual[point.primal :]
    unknowns[times:] = np.linalg.lstsq(rows, right, rcond=None)[0]
    return _point(system, unknowns)


def _newton_step(system: _System, point: _Point, damping: float) -> tuple[_Point, float]:
    # Where rounding is all that is left, damping cannot help.
    for _ in range(DAMPINGS if point.norm > RESIDUAL else 1):
        unknowns = point.unknowns - _step(system, point, damping)
        back = -float(unknowns[: len(system.pieces)].min()) * system.scale * system.problem.rate
        trial = _point(system, unknowns) if back < FURTHEST_BACK else point
        if trial.norm < point.norm:
            return trial, damping * 1e-3
        damping = max(damping, 1e-12) * 30.0
    return point, damping


def _point(system: _System, unknowns: Array) -> _Point:
    on_state, final_rate, rate_slope = _primal(system, unknowns)
    on_adjoint, exits = _dual(system, unknowns, final_rate=final_rate, rate_slope=rate_slope)
    values, slopes = zip(*on_state, *on_adjoint, strict=True)
    return _Point(
        unknowns=unknowns,
        residual=np.concatenate(values),
        jacobian=np.vstack(slopes),
        primal=sum(value.size for value, _ in on_state),
        exits=exits,
    )


def _bang_flows(system: _System, durations: Array) -> tuple[Array, Array]:
    """Return the flows and pushes of all pieces as if they were bang arcs."""
    plant, force = system.problem.plant, system.problem.force_limit
    # Newton's trial durations may be negative: the response then runs backwards.
    return transition(plant, durations), step_response(plant, durations) * force


def _primal(system: _System, unknowns: Array) -> tuple[list[Condition], Array, Array]:
    """Return the conditions on the state, and dx/dt at the end with its derivative."""
    problem, plant = system.problem, system.problem.plant
    durations = unknowns[: len(system.pieces)] * system.scale
    flows, pushes = _bang_flows(system, durations)
    state, slope = np.zeros(plant.order), np.zeros((plant.order, unknowns.size))
    rows = list[Condition]()
    for j, piece in enumerate(system.pieces):
        held = None if piece.limit < 0 else problem.limits[piece.limit]
        generator = plant.A if held is None else held.boundary_flow.matrix
        push = plant.B * (piece.side * problem.force_limit if held is None else 0.0)
        if piece.touch is not None:
            row = problem.limits[piece.touch.limit].row
            rate = row @ generator / problem.rate
            value = [row @ state - piece.touch.side, rate @ state + row @ push / problem.rate]
            rows.append((np.array(value), np.array([row @ slope, rate @ slope])))
        elif held is not None:
            levels = held.missed(state, piece.side)
            moves = held.output_chain @ slope
            rows.append((levels, moves))
            # What is missed here is counted once: carried on, it would grow over the whole arc.
            state, slope = state - held.impulses @ levels, slope - held.impulses @ moves
        if held is None:
            state = flows[j] @ state + pushes[j] * piece.side
            slope = flows[j] @ slope
        else:
            flow = held.boundary_flow.over(float(durations[j]))
            state, slope = flow @ state, flow @ slope
        slope[:, j] = (generator @ state + push) * system.scale
    error, scales = state - problem.target, problem.state_scale[problem.fixed]
    rows.append((error[problem.fixed] / scales, slope[problem.fixed] / scales[:, np.newaxis]))
    return rows, generator @ state + push, generator @ slope


def _dual(
    system: _System, unknowns: Array, *, final_rate: Array, rate_slope: Array
) -> tuple[list[Condition], dict[int, float]]:
    """Return the conditions on the adjoint: normalisation, then σ = 0 at the switches; exits."""
    problem, plant = system.problem, system.problem.plant
    to_sigma = problem.force_limit * plant.B * system.scale
    durations = unknowns[: len(system.pieces)] * system.scale
    flows, _ = _bang_flows(system, durations)
    adjoint, slope = _terminal(system, unknowns), np.zeros((plant.order, unknowns.size))
    first = len(system.pieces)
    slope[problem.fixed, first + np.arange(problem.fixed.size)] = (
        1.0 / problem.state_scale[problem.fixed]
    )
    value = float(adjoint @ final_rate) * system.scale - 1.0
    moves = (final_rate @ slope + adjoint @ rate_slope) * system.scale
    rows, exits = [(np.array([value]), moves[np.newaxis])], dict[int, float]()
    for j in range(len(system.pieces) - 1, -1, -1):
        piece, atom = system.pieces[j], system.atoms[j]
        held = None if piece.limit < 0 else problem.limits[piece.limit]
        generator = plant.A if held is None else held.adjoint_flow.matrix.T
        if held is not None and system.is_last(j):
            rows.append((adjoint[np.newaxis] @ to_sigma, (to_sigma @ slope)[np.newaxis]))
            # The atom of order 2 lets σ' = 0; here, too, a σ that is missed is not carried on.
            slope = slope - held.output_chain.T @ (held.impulses.T @ slope)
            weights = adjoint @ held.impulses
            exits |= {j: float(weights[0])} if held.order == 2 else {}
            adjoint = adjoint - weights @ held.output_chain
        flow = flows[j] if held is None else held.adjoint_flow.over(float(durations[j])).T
        adjoint, slope = adjoint @ flow, flow.T @ slope
        slope[:, j] = adjoint @ generator * system.scale
        if atom >= 0:
            # The jump of Λ for a unit atom.
            at = piece.touch or piece
            row = problem.limits[at.limit].row * at.side
            slope[:, system.width + atom] -= row
            adjoint = adjoint - unknowns[system.width + atom] * row
        elif held is None and j > 0 and system.pieces[j - 1].limit < 0:
            rows.append((adjoint[np.newaxis] @ to_sigma, (to_sigma @ slope)[np.newaxis]))
    return rows, exits


def _terminal(system: _System, unknowns: Array) -> Array:
    problem, first = system.problem, len(system.pieces)
    terminal = np.zeros(problem.plant.order)
    multipliers = unknowns[first : first + problem.fixed.size]
    terminal[problem.fixed] = multipliers / problem.state_scale[problem.fixed]
    return terminal


def _measure(system: _System, point: _Point) -> Measure:
    durations = point.unknowns[: len(system.pieces)] * system.scale
    starts = np.append(np.cumsum(durations[::-1])[::-1], 0.0).tolist()
    atoms, interiors = list[Atom](), list[ArcInterior]()
    begin = 0
    for j, (piece, number) in enumerate(zip(system.pieces, system.atoms, strict=True)):
        if number >= 0:
            weight = float(point.unknowns[system.width + number])
            at = piece.touch or piece
            atoms.append(Atom(remaining=starts[j], limit=at.limit, weight=at.side * weight))
        if j in point.exits:
            atoms.append(Atom(remaining=starts[j + 1], limit=piece.limit, weight=point.exits[j]))
        begin = begin if piece.touch else j
        if piece.limit >= 0 and system.is_last(j):
            start, end = starts[begin], starts[j + 1]
            held = ArcInterior(start=start, end=end, limit=piece.limit, side=piece.side)
            interiors.append(held)
    return Measure(
        t_f=starts[0],
        terminal=_terminal(system, point.unknowns),
        atoms=tuple(atom for atom in atoms if atom.weight != 0.0),
        interiors=tuple(interiors),
    )
