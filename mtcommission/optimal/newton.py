"""Sequences of bang arcs, boundary arcs and touch points, solved to full precision.

The unknowns are the durations, the places of the touch points, the terminal multipliers and
the atoms; the equations are the entry conditions c x = ±1, c A x = 0, ..., the touch conditions
c x = ±1, c A x = 0, the terminal conditions, and σ = 0 at every switch. The system is square
for every sequence whose boundary arcs have order 1 or 2 (docs/optimal-control.md,
section 8); arcs of higher order are joined by infinitely many touch points and have no such
sequence.

Every derivative is exact: on each leg the state and the adjoint follow linear flows, so the
derivative of a flow with respect to its duration is the flow times its generator.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.modes import step_response, transition
from mtcommission.optimal.problem import ArcInterior, Atom, BoundedProblem
from mtcommission.optimal.proof import Measure
from mtcommission.optimal.sequence import Sequence, Touch

Array = NDArray[np.float64]

STEPS, DAMPINGS = 20, 6
"""Newton steps at most, and raised dampings tried in one."""
RESIDUAL = 1e-10
"""Scaled residual below which a sequence counts as solved; rounding leaves 1e-15 ... 1e-12."""
LARGEST_STEP = 0.2
"""Largest change of a duration in one step, as a share of t_f."""
FURTHEST_BACK = 100.0
"""Longest negative duration that is tried, in radians of the fastest rate: the responses run
backwards grow with its exponential."""
SINGULAR = 1e-13
"""Share of the largest singular value below which a direction is left alone."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extremal:
    """A sequence with the multipliers that go with it."""

    sequence: Sequence  # Durations and touch points
    measure: Measure  # Dual point
    residual: float  # Largest scaled residual of all conditions


@dataclass(frozen=True, slots=True, kw_only=True)
class _Leg:
    """A piece from one touch point to the next.

    ``piece`` is the index of its piece, ``touch`` the touch point at its start, ``ends`` whether
    the piece ends with it, ``atom`` the number of the atom at its start or -1.
    """

    piece: int
    limit: int
    side: int
    touch: Touch | None
    ends: bool
    atom: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _System:
    problem: BoundedProblem
    legs: tuple[_Leg, ...]
    start: Array
    scale: float

    @property
    def width(self) -> int:
        """Number of durations and terminal multipliers; the atoms come behind them."""
        return len(self.legs) + self.problem.fixed.size

    @property
    def size(self) -> int:
        return self.width + 1 + max(leg.atom for leg in self.legs)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Point:
    """Unknowns, residual, Jacobian, and the number of conditions on the state (they come first)."""

    unknowns: Array
    residual: Array
    jacobian: Array
    primal: int
    exits: dict[int, float]  # Atoms at the ends of legs, where σ' is not 0 before

    @property
    def norm(self) -> float:
        return float(np.linalg.norm(self.residual))


Condition = tuple[Array, Array]
"""Scaled values that must vanish, shape (k,), and their derivatives, shape (k, n_unknowns)."""


def solve_sequence(problem: BoundedProblem, guess: Sequence) -> Extremal:
    """Return the extremal of a given sequence by Newton's method."""
    system = _system(problem, guess)
    point = _solved(system, _first_point(system))
    return Extremal(
        sequence=_placed(system, guess, point.unknowns),
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


def _tried(system: _System, point: _Point, step: Array) -> _Point | None:
    legs = len(system.legs)
    unknowns = point.unknowns - step
    back = -float(unknowns[:legs].min()) * system.scale * system.problem.rate
    if float(np.abs(step[:legs]).max()) > LARGEST_STEP or back > FURTHEST_BACK:
        return None
    return _point(system, unknowns)


def _step(system: _System, point: _Point, damping: float) -> Array:
    """Return the change of the unknowns to be taken back, damped (Levenberg-Marquardt)."""
    size = np.linalg.norm(point.jacobian, axis=0)
    size[size == 0.0] = 1.0
    left, value, right = np.linalg.svd(point.jacobian / size, full_matrices=False)
    share = value / (value**2 + max(damping, SINGULAR * value[0]) ** 2)
    return np.asarray((right.T @ (left.T @ point.residual * share)) / size)


def _system(problem: BoundedProblem, guess: Sequence) -> _System:
    legs: list[_Leg] = []
    durations: list[float] = []
    atoms = 0
    for i, piece in enumerate(guess.pieces):
        touches = sorted((t for t in guess.touches if t.piece == i), key=lambda t: t.offset)
        ends = [*(touch.offset for touch in touches), piece.duration]
        for k, touch in enumerate([None, *touches]):
            entered = touch is None and piece.limit >= 0 and problem.limits[piece.limit].order == 2
            has_atom = touch is not None or entered
            legs.append(
                _Leg(
                    piece=i,
                    limit=piece.limit,
                    side=piece.side,
                    touch=touch,
                    ends=k == len(touches),
                    atom=atoms if has_atom else -1,
                )
            )
            durations.append(ends[k] - (ends[k - 1] if k else 0.0))
            atoms += has_atom
    scale = guess.t_f
    return _System(
        problem=problem, legs=tuple(legs), start=np.array(durations) / scale, scale=scale
    )


def _placed(system: _System, guess: Sequence, unknowns: Array) -> Sequence:
    lengths = np.zeros(len(guess.pieces))
    touches: list[Touch] = []
    for leg, length in zip(system.legs, (unknowns * system.scale).tolist(), strict=False):
        if leg.touch is not None:
            offset = float(lengths[leg.piece])
            touches.append(replace(leg.touch, offset=offset))
        lengths[leg.piece] += length
    pieces = tuple(
        replace(piece, duration=length)
        for piece, length in zip(guess.pieces, lengths.tolist(), strict=True)
    )
    return Sequence(pieces=pieces, touches=tuple(touches))


def _first_point(system: _System) -> _Point:
    unknowns = np.append(system.start, np.zeros(system.size - system.start.size))
    point, times = _point(system, unknowns), system.start.size
    rows, right = point.jacobian[point.primal :, times:], -point.residual[point.primal :]
    unknowns[times:] = np.linalg.lstsq(rows, right, rcond=None)[0]
    return _point(system, unknowns)


def _newton_step(system: _System, point: _Point, damping: float) -> tuple[_Point, float]:
    # Where rounding is all that is left, damping cannot help.
    for _ in range(DAMPINGS if point.norm > RESIDUAL else 1):
        trial = _tried(system, point, _step(system, point, damping))
        if trial is not None and trial.norm < point.norm:
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
    """Return the flows and pushes of all legs as if they were bang arcs."""
    plant, force = system.problem.plant, system.problem.force_limit
    # Newton's trial durations may be negative: the response then runs backwards.
    return transition(plant, durations), step_response(plant, durations) * force


def _primal(system: _System, unknowns: Array) -> tuple[list[Condition], Array, Array]:
    """Return the conditions on the state, and dx/dt at the end with its derivative."""
    problem, plant = system.problem, system.problem.plant
    durations = unknowns[: len(system.legs)] * system.scale
    flows, pushes = _bang_flows(system, durations)
    state, slope = np.zeros(plant.order), np.zeros((plant.order, unknowns.size))
    rows = list[Condition]()
    for j, leg in enumerate(system.legs):
        held = None if leg.limit < 0 else problem.limits[leg.limit]
        generator = plant.A if held is None else held.boundary_flow.matrix
        push = plant.B * (leg.side * problem.force_limit if held is None else 0.0)
        if leg.touch is not None:
            row = problem.limits[leg.touch.limit].row
            rate = row @ generator / problem.rate
            value = [row @ state - leg.touch.side, rate @ state + row @ push / problem.rate]
            rows.append((np.array(value), np.array([row @ slope, rate @ slope])))
        elif held is not None:
            levels = held.missed(state, leg.side)
            moves = held.output_chain @ slope
            rows.append((levels, moves))
            # What is missed here is counted once: carried on, it would grow over the whole arc.
            state, slope = state - held.impulses @ levels, slope - held.impulses @ moves
        if held is None:
            state = flows[j] @ state + pushes[j] * leg.side
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
    durations = unknowns[: len(system.legs)] * system.scale
    flows, _ = _bang_flows(system, durations)
    adjoint, slope = _terminal(system, unknowns), np.zeros((plant.order, unknowns.size))
    first = len(system.legs)
    slope[problem.fixed, first + np.arange(problem.fixed.size)] = (
        1.0 / problem.state_scale[problem.fixed]
    )
    value = float(adjoint @ final_rate) * system.scale - 1.0
    moves = (final_rate @ slope + adjoint @ rate_slope) * system.scale
    rows, exits = [(np.array([value]), moves[np.newaxis])], dict[int, float]()
    for j in range(len(system.legs) - 1, -1, -1):
        leg = system.legs[j]
        held = None if leg.limit < 0 else problem.limits[leg.limit]
        generator = plant.A if held is None else held.adjoint_flow.matrix.T
        if held is not None and leg.ends:
            rows.append((adjoint[np.newaxis] @ to_sigma, (to_sigma @ slope)[np.newaxis]))
            # The atom of order 2 lets σ' = 0; here, too, a σ that is missed is not carried on.
            slope = slope - held.output_chain.T @ (held.impulses.T @ slope)
            weights = adjoint @ held.impulses
            exits |= {j: float(weights[0])} if held.order == 2 else {}
            adjoint = adjoint - weights @ held.output_chain
        flow = flows[j] if held is None else held.adjoint_flow.over(float(durations[j])).T
        adjoint, slope = adjoint @ flow, flow.T @ slope
        slope[:, j] = adjoint @ generator * system.scale
        if leg.atom >= 0:
            row = _jump_row(problem, leg)
            slope[:, system.width + leg.atom] -= row
            adjoint = adjoint - unknowns[system.width + leg.atom] * row
        elif held is None and j > 0 and system.legs[j - 1].limit < 0:
            rows.append((adjoint[np.newaxis] @ to_sigma, (to_sigma @ slope)[np.newaxis]))
    return rows, exits


def _jump_row(problem: BoundedProblem, leg: _Leg) -> Array:
    """Return the jump of Λ for a unit atom at the start of a leg: the row times the side."""
    limit, side = (leg.touch.limit, leg.touch.side) if leg.touch else (leg.limit, leg.side)
    return problem.limits[limit].row * side


def _terminal(system: _System, unknowns: Array) -> Array:
    problem, first = system.problem, len(system.legs)
    terminal = np.zeros(problem.plant.order)
    multipliers = unknowns[first : first + problem.fixed.size]
    terminal[problem.fixed] = multipliers / problem.state_scale[problem.fixed]
    return terminal


def _measure(system: _System, point: _Point) -> Measure:
    durations = point.unknowns[: len(system.legs)] * system.scale
    starts = np.append(np.cumsum(durations[::-1])[::-1], 0.0).tolist()
    atoms, interiors = list[Atom](), list[ArcInterior]()
    for j, leg in enumerate(system.legs):
        if leg.atom >= 0:
            weight = float(point.unknowns[system.width + leg.atom])
            at = leg.touch or leg
            atoms.append(Atom(remaining=starts[j], limit=at.limit, weight=at.side * weight))
        if j in point.exits:
            atoms.append(Atom(remaining=starts[j + 1], limit=leg.limit, weight=point.exits[j]))
        if leg.limit >= 0 and leg.touch is None:
            ends = [k for k, other in enumerate(system.legs) if other.piece == leg.piece]
            interiors.append(
                ArcInterior(
                    start=starts[j], end=starts[ends[-1] + 1], limit=leg.limit, side=leg.side
                )
            )
    return Measure(
        t_f=starts[0],
        terminal=_terminal(system, point.unknowns),
        atoms=tuple(atom for atom in atoms if atom.weight != 0.0),
        interiors=tuple(interiors),
    )
