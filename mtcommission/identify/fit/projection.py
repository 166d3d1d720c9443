"""Least squares in the poles; masses, gains and residual terms are eliminated at each step.

Every response of one state of the machine shares c, ω and ζ; delay, mass, gains and residual
term are its own::

    H(s) = e^(-s tau) s^p [ b/(s² + c s) + Σ g_k/(s² + 2 ζ_k ω_k s + ω_k²) + R ]

b = 1/m, g_k and R enter linearly: variable projection leaves c, tau, ω_k and ζ_k.

Source: Golub, Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; Kaufman, BIT 15 (1975) 49, for the
Jacobian without its second term; Marquardt, SIAM J. Appl. Math. 11 (1963) 431.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit.lines import Lines

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

DAMPING_ENDS = (2e-4, 0.3)
"""Damping ratios that are tried."""
DELAY_ENDS = (-2e-3, 20e-3)
"""Delays that are tried [s]; a negative one tells of a clock or of a wrong phase."""
RIDGE = 1e-13
"""Share of 1 added to the inner products of a basis."""
LONGEST_STEP = 0.7
"""Longest step in ln ω and ln ζ."""
LONGEST_DELAY_STEP = 5e-4
"""Longest step in a delay [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Poles:
    """What enters nonlinearly.

    Parameters
    ----------
    drag
        c, viscous friction per mass [1/s].
    delays
        tau of each response, shape (n_responses,) [s].
    omega, zeta
        Natural frequencies [rad/s] and damping ratios, shape (n_modes,).
    """

    drag: float
    delays: Array
    omega: Array
    zeta: Array

    def add(self, omega: float, zeta: float) -> Poles:
        """Return the poles and one more mode."""
        return Poles(
            self.drag, self.delays, np.append(self.omega, omega), np.append(self.zeta, zeta)
        )

    def drop(self, mode: int) -> Poles:
        """Return the poles without one mode."""
        return Poles(
            self.drag, self.delays, np.delete(self.omega, mode), np.delete(self.zeta, mode)
        )


@dataclass(frozen=True, slots=True, eq=False)
class Projected:
    """The best that some poles can do.

    Parameters
    ----------
    poles
        The poles.
    gains
        b, g_k and R of each response, shape (n_responses, n_modes + 2).
    residuals
        (model - measured) / standard error of each response, complex.
    cost
        Sum of their squared magnitudes.
    """

    poles: Poles
    gains: Array
    residuals: tuple[ComplexArray, ...]
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class _Basis:
    """One response at some poles: weighed columns, their inner products, the best gains."""

    columns: ComplexArray
    scale: Array
    inverse: Array
    """Of the inner products of the columns, each scaled to 1."""
    gains: Array
    residual: ComplexArray
    cost: float


def _inner(one: ComplexArray, other: ComplexArray) -> Array:
    """Sums over real and imaginary parts: complex lines count as two real ones."""
    found: Array = one.real.T @ other.real + one.imag.T @ other.imag
    return found


def weighed_columns(lines: Lines, poles: Poles, delay: float) -> ComplexArray:
    """Return the columns of b, g_k and R, weighed, shape (n_lines, n_modes + 2)."""
    s = lines.s
    found = np.empty((s.size, poles.omega.size + 2), dtype=np.complex128)
    found[:, 0] = 1.0 / (s * (s + poles.drag))
    found[:, 1:-1] = 1.0 / _denominators(s, poles)
    found[:, -1] = 1.0
    found *= (np.exp(-s * delay) * s**lines.derivative / lines.error)[:, None]
    return found


def _denominators(s: ComplexArray, poles: Poles) -> ComplexArray:
    found: ComplexArray = s[:, None] * (2 * poles.zeta * poles.omega)
    found += (s * s)[:, None] + poles.omega**2
    return found


def _solve(lines: Lines, poles: Poles, delay: float) -> _Basis:
    columns = weighed_columns(lines, poles, delay)
    products = _inner(columns, columns)
    scale = np.sqrt(np.diag(products))
    # The ridge is for two equal poles, of which any share does.
    inverse = np.linalg.inv(products / np.outer(scale, scale) + RIDGE * np.eye(scale.size))
    y = lines.values / lines.error
    gains = inverse @ (_inner(columns, y[:, None])[:, 0] / scale) / scale
    residual = columns @ gains - y
    cost = float(np.vdot(residual, residual).real)
    return _Basis(columns, scale, inverse, gains, residual, cost)


def project(responses: Sequence[Lines], poles: Poles) -> Projected:
    """Return masses, gains and residual terms that fit best for some poles."""
    return _projected(poles, _solve_all(responses, poles))


def _solve_all(responses: Sequence[Lines], poles: Poles) -> list[_Basis]:
    pairs = zip(responses, poles.delays.tolist(), strict=True)
    return [_solve(lines, poles, delay) for lines, delay in pairs]


def _projected(poles: Poles, bases: Sequence[_Basis]) -> Projected:
    return Projected(
        poles,
        np.array([basis.gains for basis in bases]),
        tuple(basis.residual for basis in bases),
        sum(basis.cost for basis in bases),
    )


def _slopes(lines: Lines, poles: Poles, basis: _Basis) -> ComplexArray:
    """Derivative of the weighed model by c, own delay, ln ω and ln ζ, shape (n_lines, 2 + 2 n)."""
    s, count = lines.s, poles.omega.size
    rate = np.empty((s.size, 2 + 2 * count), dtype=np.complex128)
    by_gain = basis.columns * basis.gains
    rate[:, 0] = -by_gain[:, 0] / (s + poles.drag)
    rate[:, 1] = -s * by_gain.sum(axis=1)
    modes = by_gain[:, 1:-1] / _denominators(s, poles)
    damped = modes * s[:, None] * (2 * poles.zeta * poles.omega)
    rate[:, 2 : 2 + count] = -damped - modes * (2 * poles.omega**2)
    rate[:, 2 + count :] = -damped
    return rate


def _own(place: int, n_responses: int, n_modes: int) -> NDArray[np.intp]:
    """Which of all parameters a response has: c, its delay, all modes."""
    return np.array([0, 1 + place, *range(1 + n_responses, 1 + n_responses + 2 * n_modes)])


def _pack(poles: Poles) -> Array:
    return np.concatenate([[poles.drag], poles.delays, np.log(poles.omega), np.log(poles.zeta)])


def _unpack(theta: Array, n_responses: int) -> Poles:
    count = (theta.size - 1 - n_responses) // 2
    delays, modes = theta[1 : 1 + n_responses], theta[1 + n_responses :]
    return Poles(float(theta[0]), delays, np.exp(modes[:count]), np.exp(modes[count:]))


def _ends(responses: Sequence[Lines], count: int) -> tuple[Array, Array]:
    low_hz = min(float(lines.frequency_hz[0]) for lines in responses)
    high_hz = max(float(lines.frequency_hz[-1]) for lines in responses)
    n = len(responses)
    slow, fast = np.log(2 * np.pi * low_hz / 2), np.log(2 * np.pi * high_hz * 3.0)
    drag = 2 * np.pi * max(3.0 * low_hz, 10.0)
    low = [0.0, *[DELAY_ENDS[0]] * n, *[slow] * count, *[np.log(DAMPING_ENDS[0])] * count]
    high = [drag, *[DELAY_ENDS[1]] * n, *[fast] * count, *[np.log(DAMPING_ENDS[1])] * count]
    return np.array(low), np.array(high)


def _normal(
    responses: Sequence[Lines], poles: Poles, bases: Sequence[_Basis]
) -> tuple[Array, Array]:
    """Jᵀ J and Jᵀ r of the projected residuals."""
    n, count = len(responses), poles.omega.size
    size = 1 + n + 2 * count
    square, slope = np.zeros((size, size)), np.zeros(size)
    for place, (lines, basis) in enumerate(zip(responses, bases, strict=True)):
        rate = _slopes(lines, poles, basis)
        along = _inner(basis.columns, rate) / basis.scale[:, None]
        own = _own(place, n, count)
        square[np.ix_(own, own)] += _inner(rate, rate) - along.T @ basis.inverse @ along
        slope[own] += _inner(rate, basis.residual[:, None])[:, 0]
    return square, slope


def refine(
    responses: Sequence[Lines],
    poles: Poles,
    *,
    steps: int = 40,
    tolerance: float = 1e-6,
    holds_delay: bool = False,
) -> Projected:
    """Return the poles of least squares near some others.

    Parameters
    ----------
    responses
        Of one state of the machine.
    poles
        Where to begin.
    steps
        At most so many.
    tolerance
        Ends where a step lowers the cost by less than this share.
    holds_delay
        Whether the delays stay.
    """
    n = len(responses)
    low, high = _ends(responses, poles.omega.size)
    theta = np.clip(_pack(poles), low, high)
    poles = _unpack(theta, n)
    bases = _solve_all(responses, poles)
    best = _projected(poles, bases)
    reach = np.full(theta.size, LONGEST_STEP)
    reach[0] = np.inf
    reach[1 : 1 + n] = LONGEST_DELAY_STEP
    damping = 1e-3
    for _ in range(steps):
        square, slope = _normal(responses, best.poles, bases)
        free = ~(((theta <= low) & (slope > 0)) | ((theta >= high) & (slope < 0)))
        free[1 : 1 + n] &= not holds_delay
        diagonal = np.diag(square).copy()
        free &= diagonal > 0.0
        inner, gradient = square[np.ix_(free, free)], slope[free]
        lowered = 0.0
        while damping < 1e8:
            damped = inner + np.diag(damping * diagonal[free])
            step = np.linalg.solve(damped, -gradient)
            tried = theta.copy()
            tried[free] += np.clip(step, -reach[free], reach[free])
            tried = np.clip(tried, low, high)
            poles = _unpack(tried, n)
            at = [
                _solve(x, poles, d) for x, d in zip(responses, poles.delays.tolist(), strict=True)
            ]
            new = _projected(poles, at)
            if new.cost < best.cost:
                lowered = (best.cost - new.cost) / best.cost
                theta, bases, best = tried, at, new
                damping = max(damping * 0.1, 1e-9)
                break
            damping *= 8.0
        if lowered < tolerance:
            break
        damping = min(damping, 1e2)
    return best


@dataclass(frozen=True, slots=True, eq=False)
class Variances:
    """Covariance of what was fitted, for residuals of variance 1.

    Parameters
    ----------
    poles
        Of c, delays, ln ω_k, ln ζ_k, square.
    gains
        Of b, g_k and R, shape (n_responses, n_modes + 2, n_modes + 2).
    """

    poles: Array
    gains: Array

    def of_gains(self, place: int, chosen: Array) -> float:
        """Return the standard error of a weighed sum of b, g_k and R of a response."""
        return float(np.sqrt(max(chosen @ self.gains[place] @ chosen, 0.0)))

    def of_mode(self, mode: int, n_modes: int) -> tuple[float, float]:
        """Return the standard errors of ln ω and ln ζ of a mode."""
        first = self.poles.shape[0] - 2 * n_modes + mode
        variances = self.poles[first, first], self.poles[first + n_modes, first + n_modes]
        # A negative one is rounding of a huge one: nothing determines that pole.
        omega, zeta = (float(np.sqrt(one)) if one > 0.0 else np.inf for one in variances)
        return omega, zeta


def find_variances(responses: Sequence[Lines], fit: Projected) -> Variances:
    """Return the covariance (Jᵀ J)⁻¹ of poles and gains at a fit.

    Of the full Jacobian: the poles' part is the inverse of its Schur complement, which is that of
    the projected one; the gains carry the poles' errors along.
    """
    n = len(responses)
    bases = _solve_all(responses, fit.poles)
    square, _ = _normal(responses, fit.poles, bases)
    scale = np.sqrt(np.maximum(np.diag(square), 1e-300))
    inverse = np.linalg.pinv(square / np.outer(scale, scale), rcond=1e-13, hermitian=True)
    poles = inverse / np.outer(scale, scale)
    gains = np.empty((n, fit.gains.shape[1], fit.gains.shape[1]))
    for place, (lines, basis) in enumerate(zip(responses, bases, strict=True)):
        rate = _slopes(lines, fit.poles, basis)
        along = basis.inverse @ (_inner(basis.columns, rate) / basis.scale[:, None])
        own = _own(place, n, fit.poles.omega.size)
        total = basis.inverse + along @ poles[np.ix_(own, own)] @ along.T
        gains[place] = total / np.outer(basis.scale, basis.scale)
    return Variances(poles, gains)


def predict(
    frequency_hz: Array, poles: Poles, gains: Array, *, delay: float, derivative: int
) -> ComplexArray:
    """Return H of one response, shape (n,)."""
    lines = Lines(
        frequency_hz=frequency_hz,
        values=np.zeros(frequency_hz.size, dtype=np.complex128),
        error=np.ones(frequency_hz.size),
        derivative=derivative,
    )
    found: ComplexArray = weighed_columns(lines, poles, delay) @ gains
    return found
