"""The switching function σ = ψ - Σ c_i φ_i: all its zeros, and the time that they prove.

For any multipliers c, no force below F_max reaches the target before the time T' with

    F_max ∫_0^{T'} |σ| dτ = target.

No zero may be missed, since the proof rests on them: an interval is settled only when a
rigorous error bound of the cubic that interpolates σ and σ' at its ends shows that σ has no
zero, or just one: σ is monotone there, or changes its sign and bends to one side only. Else it is
divided.

A cell is a column of seven rows: start, length, σ at both ends, length·σ' at both ends, bound of
the cubic's error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, log1p

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.optimal.modes import TINY, MomentProblem, powers_of_time

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

RADIANS_PER_CELL = 0.3
"""Length of a cell against the fastest pole at τ = 0 (empirical: fastest search; accuracy does
not depend on it)."""
MOST_CELLS = 1_000_000
"""Of a mesh: some seconds and 200 MB; reached where a mode rings undamped for 50 000 periods."""
LEAST_RADIANS = 17.0
"""What a mesh counts at least, spread evenly: 56 cells of a move that is shorter than the fastest
mode, and some where all modes have decayed but a cell-wise constant force must still switch
(empirical)."""
DENSITY_NODES = np.linspace(0.0, 1.0, 49)
"""Where the density of nodes is tabulated, in the logarithm of τ."""


def graded_nodes(problem: MomentProblem, horizon: float, *, radians: float) -> Array:
    """Return nodes on [0, horizon], the finer the faster the poles that are alive there [s].

    The cubic through values and slopes at the ends of a cell errs by e^{Re p τ} (|p| h)⁴ / 384, so
    h grows like e^{-Re p τ / 4} while the pole p is the fastest; ``radians`` is |p| h at τ = 0 for
    the fastest one.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where they would be more than ``MOST_CELLS``.
    """
    magnitudes = problem.magnitudes
    fastest = max(magnitudes.tolist())
    tau = np.expm1(DENSITY_NODES * log1p(horizon * fastest)) / fastest
    tau[-1] = horizon
    decay = np.exp(np.multiply.outer(0.25 * problem.rates.real, tau))
    density = np.maximum.reduce(magnitudes[:, np.newaxis] * decay)
    np.maximum(density, LEAST_RADIANS / horizon, out=density)
    passed = np.zeros(tau.size)
    (0.5 * (density[1:] + density[:-1]) * (tau[1:] - tau[:-1])).cumsum(out=passed[1:])
    total = float(passed[-1])
    if not total < radians * MOST_CELLS:
        detail = Message("optimum-too-long", t_f=horizon, radians=total, most=radians * MOST_CELLS)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    count = int(total / radians) + 1
    nodes = np.interp(np.arange(count + 1) * (total / count), passed, tau)
    nodes[-1] = horizon
    return np.asarray(nodes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Moment functions tabulated on [0, horizon]."""

    problem: MomentProblem  # The moment problem
    nodes: Array  # τ from 0 to the horizon, shape (n_cells + 1,) [s]
    lengths: Array  # Of the cells, shape (n_cells,) [s]
    values: Array  # φ and, last, ψ at the nodes, shape (size + 1, n_cells + 1)
    remainder: Array  # max |d⁴/dτ⁴ e^{pτ}| h⁴/384 on each cell, shape (n_rates, n_cells)

    @property
    def horizon(self) -> float:
        """Last node [s]."""
        return float(self.nodes[-1])

    def until(self, horizon: float) -> Mesh:
        """Return the cells that are needed for a part of it."""
        k = int(self.nodes[1:].searchsorted(horizon)) + 1
        return replace(
            self,
            nodes=self.nodes[: k + 1],
            lengths=self.lengths[:k],
            values=self.values[:, : k + 1],
            remainder=self.remainder[:, :k],
        )

    def norms(self, horizon: float) -> Array:
        """Return ∫_0^horizon |φ| as a sum, to scale moments by, shape (size,)."""
        inside = int(self.nodes[:-1].searchsorted(horizon))
        return np.asarray(np.abs(self.values[:-1, :inside]).dot(self.lengths[:inside]))


def build_mesh(
    problem: MomentProblem, horizon: float, *, radians: float = RADIANS_PER_CELL
) -> Mesh:
    """Return the tables on graded nodes."""
    return tabulate(problem, graded_nodes(problem, horizon, radians=radians))


def tabulate(problem: MomentProblem, nodes: Array) -> Mesh:
    """Return the tables on given nodes."""
    lengths = nodes[1:] - nodes[:-1]
    squared = np.multiply.outer(problem.magnitudes, lengths) ** 2
    envelope = np.exp(np.multiply.outer(problem.rates.real, nodes[:-1]))
    return Mesh(
        problem=problem,
        nodes=nodes,
        lengths=lengths,
        values=problem.values(nodes),
        remainder=envelope * squared * (squared / 384.0),
    )


ROUNDOFF = float(np.finfo(np.float64).eps)
EXTENDED_ROUNDOFF = float(np.finfo(np.longdouble).eps)
"""64 bits on x86; elsewhere perhaps only double. Where modes nearly coincide, or hardly turn during
the move, the multipliers are large against σ and ∫|σ| loses digits."""
PARTS = 4
SHARES = np.arange(PARTS)[:, np.newaxis] / PARTS
"""Parts that an unsettled cell is divided into, and where they start."""
MAX_DIVISIONS = 30
"""More than the bits of double precision: the search has always ended before."""
SLOPE_ERROR = 384.0 * float(np.sqrt(3.0)) / 216.0
"""Error of the cubic's slope times the length against that of its value."""
BEND_ERROR = 384.0 / 12.0
"""Error of its second derivative times the length squared."""
LAST_STEP = 1e-9
"""Relative length of the step after which a zero is known to the last digit."""
ZERO_STEPS = 60
"""At most: three are usual, more where two zeros nearly meet."""
FIRST_NOISE = 4
"""Divisions before cells may be so short that |σ| there is below its rounding error."""
NOTHING = np.empty(0)
LENGTHENINGS = 40
"""Doublings of a mesh before a bound counts as unlimited."""
WITHIN = 1e-12
"""Relative distance of a time from the end of the mesh below which it may lie beyond."""
SLACK = 1e-14
"""Part of the span by which a proved time stays behind, about what Newton's method leaves."""
BOUND_STEPS = 100
"""At most: one or two are usual."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Control:
    """A bang-bang force over the remaining time, with the weights of its switching function."""

    zeros: Array  # Remaining times of the switches, ascending, shape (k,) [s]
    horizon: float  # t_f [s]
    first_sign: float  # Sign of the force before the first zero, i.e. at the end of the move
    weights: Array  # (-c, 1), shape (size + 1,)


def prove_time(mesh: Mesh, start: Control, *, span: float) -> Control:
    """Return the force sign σ up to a time before which no force reaches the target.

    Only the weights of ``start`` count; with its zeros and horizon the search begins.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if that lies beyond 2^40 meshes.

    Source: docs/optimal-control.md, section 2.
    """
    weights = start.weights
    for _ in range(LENGTHENINGS):
        zeros = isolate_zeros(mesh, weights, guess=start.zeros)
        near = min(start.horizon, mesh.horizon)
        proved = _proved(mesh.problem, weights, zeros, span, near, mesh.horizon)
        if proved < (1.0 - WITHIN) * mesh.horizon:
            break
        mesh = build_mesh(mesh.problem, 2.0 * mesh.horizon)
    else:
        detail = Message("multipliers-prove-beyond", t_f=mesh.horizon)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return Control(
        zeros=zeros.tau[zeros.tau < proved],
        horizon=proved * (1.0 - 4.0 * ROUNDOFF),
        first_sign=zeros.first_sign,
        weights=weights,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Size:
    """∫|σ| over a length, at most, and the sign changes of σ in it."""

    most: float
    zeros: Array  # Ascending [s]


def integral_of_size(mesh: Mesh, weights: Array, length: float) -> Size:
    """Return what ∫|σ| is for certain not above, from 0 to a length within the mesh [s]."""
    zeros = isolate_zeros(mesh, weights)
    inside = zeros.tau[zeros.tau < length]
    reached = _integral(mesh.problem, weights, np.append(inside, length))
    most = float(reached.value) + reached.allowance + 2.0 * zeros.doubt
    return Size(most=most, zeros=inside)


def time_within(mesh: Mesh, weights: Array, span: float, *, end: float) -> float:
    """Return a time up to which ∫|σ| stays below a span for certain; at most the end [s]."""
    return _proved(mesh.problem, weights, isolate_zeros(mesh, weights), span, end, end)


def _proved(
    problem: MomentProblem, weights: Array, zeros: Zeros, span: float, time: float, end: float
) -> float:
    """Return where ∫|σ| is just below the span for certain, from a guess; at most the end."""
    if zeros.doubt == inf:
        return 0.0
    proved, slack = 0.0, SLACK * span + 2.0 * zeros.doubt
    slope = abs(float(weights.dot(problem.values(np.array([time])))[0]))
    time = max(0.5 * time, time - slack / max(slope, TINY))
    for _ in range(BOUND_STEPS):
        inside = zeros.tau[zeros.tau < time]
        reached = _integral(problem, weights, np.concatenate((inside, (time,))))
        margin = zeros.doubt + 2.0 * ROUNDOFF * span + reached.allowance
        excess = float(reached.value - span) + margin
        proved, end = (proved, time) if excess > 0.0 else (time, end)
        slack = max(slack, 2.0 * margin, ROUNDOFF * reached.slope * time)
        if -2.0 * slack <= excess <= 0.0 or end - proved <= 2.0 * ROUNDOFF * end:
            break
        aimed = time - (excess + slack) / max(reached.slope, TINY)
        time = aimed if proved < aimed < end else 0.5 * (proved + end)
    return proved


@dataclass(frozen=True, slots=True, kw_only=True)
class _Integral:
    """∫_0^T |σ| with what rounding may have taken from it."""

    value: np.longdouble  # The integral, in extended precision [s] or [s²]
    allowance: float  # Bound of its error
    slope: float  # |σ(T)|


def _integral(problem: MomentProblem, weights: Array, ends: Array) -> _Integral:
    """Return ∫|σ| from 0 over the zeros to the last end.

    The allowance counts, in units of half the roundoff, |p| τ for the product p τ as far as e^{pτ}
    is still there, 6 for e^{pτ} - 1 and its division by p, and one for each term of a sum; and,
    since a zero that is off by δ hides |σ'| δ², σ²/|σ'| at each of them.
    """
    t, rates = ends.astype(np.longdouble), problem.rates.astype(np.clongdouble)
    modal = problem.modal(weights).astype(np.clongdouble)
    of_powers, powers = weights[problem.one :], powers_of_time(t, problem.degree + 1)
    less_one = np.expm1(np.multiply.outer(t, rates))
    grown = less_one + 1.0
    primitive = (less_one @ (modal / rates)).real + of_powers @ powers[1:]
    value = (grown @ modal).real + of_powers @ powers[:-1]
    slope = (grown[:-1] @ (rates * modal)).real + of_powers[1:] @ powers[:-2, :-1]
    # A slope below |σ|/τ says that the zero is known to its own size only: then it hides τ |σ|.
    least = np.maximum(np.abs(value[:-1]) / t[:-1], TINY)
    hidden = value[:-1] ** 2 / np.maximum(np.abs(slope), least)
    # Double precision will do for the sizes of errors.
    decay = np.exp(np.multiply.outer(ends, problem.rates.real))
    sizes = (6.0 + problem.size) * np.minimum(
        ends[:, np.newaxis], (1.0 + decay) / problem.magnitudes
    )
    terms = (sizes + ends[:, np.newaxis] * decay).dot(np.abs(modal).astype(np.float64))
    terms += (2.0 + problem.size) * (np.abs(of_powers) @ powers[1:]).astype(np.float64)
    return _Integral(
        value=abs(primitive[0]) + np.add.reduce(np.abs(primitive[1:] - primitive[:-1])),
        allowance=EXTENDED_ROUNDOFF * float(terms.sum()) + 2.0 * float(np.add.reduce(hidden)),
        slope=abs(float(value[-1])),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Zeros:
    """All sign changes of a switching function."""

    tau: Array  # Ascending, shape (n_zeros,) [s]
    # ∫|σ| over the places where |σ| stays below its rounding error, so that pairs of zeros
    # there may have been left out, at most [s] or [s²].
    doubt: float
    first_sign: float  # Sign of σ before the first zero


def isolate_zeros(mesh: Mesh, weights: Array, *, guess: Array = NOTHING) -> Zeros:
    """Return all sign changes of σ on (0, horizon].

    Source: Bernstein form of the cubic Hermite interpolant with remainder |σ⁗| h⁴/384 (its
    slope: √3 |σ⁗| h³/216, its second derivative: |σ⁗| h²/12); docs/optimal-control.md, section 3.
    """
    problem, cells = mesh.problem, _first_cells(mesh, weights)
    found, doubt = [], 0.0
    for division in range(MAX_DIVISIONS):
        settled, crossing = _is_settled(cells), _crosses_zero(cells)
        found.append(cells[:, settled & crossing])
        if settled.all():
            break
        cells, crossing = cells[:, ~settled], crossing[~settled]
        if division >= FIRST_NOISE:
            rounding = _rounding(problem, weights, cells)
            noise = np.abs(cells[2:]).sum(axis=0) <= 4.0 * rounding
            doubt += float(4.0 * cells[1, noise] @ rounding[noise])
            found.append(cells[:, noise & crossing])
            cells = cells[:, ~noise]
        cells = _divided(problem, weights, cells)
    else:
        # An unsettled cell may hide anything.
        doubt = inf
    brackets = np.concatenate(found, axis=1)
    tau = _refined(problem, weights, brackets[:, brackets[0].argsort()], guess)
    sign = 1.0 if float(weights.dot(mesh.values[:, 0])) > 0.0 else -1.0
    return Zeros(tau=tau[tau > 0.0], doubt=doubt, first_sign=sign)


def _first_cells(mesh: Mesh, weights: Array) -> Array:
    sigma = weights.dot(mesh.values)
    slope = mesh.problem.differentiation.dot(weights).dot(mesh.values)
    left, right = slope[:-1] * mesh.lengths, slope[1:] * mesh.lengths
    remainder = mesh.problem.amplitudes(weights).dot(mesh.remainder)
    cells = (mesh.nodes[:-1], mesh.lengths, sigma[:-1], sigma[1:], left, right, remainder)
    return _doubtful(np.array(cells))


def _doubtful(cells: Array) -> Array:
    """Return the cells in which the cubic's control polygon comes nearer to 0 than its error."""
    _, _, left, right, left_slope, right_slope, remainder = cells
    inner, outer = left + left_slope / 3.0, right - right_slope / 3.0
    low = np.minimum(np.minimum(left, right), np.minimum(inner, outer))
    high = np.maximum(np.maximum(left, right), np.maximum(inner, outer))
    return np.asarray(cells.take(((low <= remainder) & (high >= -remainder)).nonzero()[0], axis=1))


def _crosses_zero(cells: Array) -> Mask:
    return np.asarray((cells[2] > 0.0) != (cells[3] > 0.0))


def _is_settled(cells: Array) -> Mask:
    """Return on which cells σ is monotone, or convex or concave with a sign change, for certain."""
    _, _, left, right, left_slope, right_slope, remainder = cells
    chord = 3.0 * (right - left)
    middle, error = chord - left_slope - right_slope, SLOPE_ERROR * remainder
    low = np.minimum(np.minimum(left_slope, right_slope), middle)
    high = np.maximum(np.maximum(left_slope, right_slope), middle)
    monotone = (low > error) | (high < -error)
    # The second derivative of a cubic is linear: its ends tell all.
    start, end = chord - 2.0 * left_slope - right_slope, left_slope + 2.0 * right_slope - chord
    error = 0.5 * BEND_ERROR * remainder
    bends = (np.minimum(start, end) > error) | (np.maximum(start, end) < -error)
    return np.asarray((bends & _crosses_zero(cells)) | monotone)


def _rounding(problem: MomentProblem, weights: Array, cells: Array) -> Array:
    """Return a bound of the rounding error of σ on cells, shape (n_cells,).

    Covers the products p τ inside the exponentials, the exponentials and the sum.
    """
    start, end = cells[0], cells[0] + cells[1]
    envelope = np.exp(np.multiply.outer(start, problem.rates.real)) * problem.amplitudes(weights)
    modal = envelope * (1.0 + np.multiply.outer(0.25 * end, problem.magnitudes))
    others = np.abs(weights[problem.one :]) @ powers_of_time(end, problem.degree)
    return np.asarray(8.0 * ROUNDOFF * (modal.sum(axis=1) + others))


def _divided(problem: MomentProblem, weights: Array, cells: Array) -> Array:
    parts = np.empty((7, PARTS, cells.shape[1]))
    parts[0] = cells[0] + SHARES * cells[1]
    parts[1] = cells[1] / PARTS
    values = problem.values(parts[0, 1:].ravel())
    sigma = weights.dot(values).reshape(PARTS - 1, -1)
    slope = problem.differentiation.dot(weights).dot(values).reshape(PARTS - 1, -1) * parts[1, 0]
    parts[2, 0], parts[2, 1:] = cells[2], sigma
    parts[3, -1], parts[3, :-1] = cells[3], sigma
    parts[4, 0], parts[4, 1:] = cells[4] / PARTS, slope
    parts[5, -1], parts[5, :-1] = cells[5] / PARTS, slope
    parts[6] = cells[6] / PARTS**4
    return _doubtful(parts.reshape(7, -1))


def _refined(problem: MomentProblem, weights: Array, cells: Array, guess: Array) -> Array:
    """Return the zero of each cell by Newton's method, kept between values of both signs."""
    start, length, left, right = cells[:4]
    tau, end = start + length * left / (left - right), start + length
    if guess.size == tau.size:
        tau = np.minimum(np.maximum(guess, start), end)
    rates, positive = problem.differentiation.dot(weights), left > 0.0
    for _ in range(ZERO_STEPS):
        values = problem.values(tau)
        sigma, slope = weights.dot(values), rates.dot(values)
        is_before = (sigma > 0.0) == positive
        start, end = np.where(is_before, tau, start), np.where(is_before, end, tau)
        step = np.divide(sigma, slope, out=np.zeros_like(sigma), where=slope != 0.0)
        before, newton = tau, tau - step
        tau = np.where((newton >= start) & (newton <= end), newton, 0.5 * (start + end))
        if (np.abs(tau - before) <= LAST_STEP * tau).all():
            break
    return np.asarray(tau)
