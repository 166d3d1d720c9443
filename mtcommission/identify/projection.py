"""Least squares in the poles; masses, gains and residual terms are eliminated at each step.

Every response of one state of the machine shares c, ω and ζ; delay, lag, mass, gains and residual
term are its own::

    H(s) = e^(-s tau)/(1 + s T) s^p [ b/(s² + c s) + Σ g_k/(s² + 2 ζ_k ω_k s + ω_k²) + R ]

b = 1/m, g_k and R enter linearly: variable projection leaves c, tau, T, ω_k and ζ_k.

Source: Golub, Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; Kaufman, BIT 15 (1975) 49, for the
Jacobian without its second term; Marquardt, SIAM J. Appl. Math. 11 (1963) 431.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.measured.measurement import Array, ComplexArray, FrequencyResponse

ERROR_FLOOR = 3e-3
"""Least relative standard error of a line: no sensor and no amplifier is better (empirical)."""
UNKNOWN_ERROR = 3e-2
"""Relative standard error where the file has no coherence; only its course over the lines counts,
its size comes from the misfit."""
MOST_LINES = 6000
"""More are joined where they lie closer than any mode is wide."""
CLOSE = 1e-3
"""Relative width of the groups in which they are joined: a third of a mode of ζ = 0.3 %."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lines:
    """A response as the fit weighs it."""

    frequency_hz: Array  # Shape (n,) [Hz]
    values: ComplexArray  # Shape (n,), complex [SI of output per input]
    error: Array  # Standard error of real and of imaginary part, shape (n,) [as values]
    derivative: int  # Power of s by which the output differs from a position

    @property
    def s(self) -> ComplexArray:
        """Laplace variable of each line [rad/s]."""
        return np.asarray(2j * np.pi * self.frequency_hz)

    @property
    def size(self) -> int:
        """Number of lines."""
        return int(self.frequency_hz.size)

    def position(self, delay: float = 0.0, lag: float = 0.0) -> ComplexArray:
        """Return the position per input, without a delay and a lag [s]."""
        s = self.s
        return np.asarray(self.values * np.exp(s * delay) * (1.0 + s * lag) / s**self.derivative)


def ends_of(responses: Sequence[Lines]) -> tuple[float, float]:
    """Return the lowest and the highest line of some responses [Hz]."""
    first, last = zip(
        *((one.frequency_hz[0], one.frequency_hz[-1]) for one in responses), strict=True
    )
    return float(min(first)), float(max(last))


def count_values(responses: Sequence[Lines]) -> int:
    """Return how many real numbers some responses hold."""
    return sum(2 * lines.size for lines in responses)


def share_frequencies(responses: Sequence[Lines]) -> list[Lines]:
    """Return the responses, those with equal frequencies with one array of them.

    So that what depends on frequencies alone is computed once.
    """
    kept: list[Array] = []
    found = []
    for lines in responses:
        f = lines.frequency_hz
        same = next((one for one in kept if np.array_equal(one, f)), f)
        if same is f:
            kept.append(f)
        found.append(replace(lines, frequency_hz=same))
    return found


def spacing_at(frequency_hz: Array, wanted_hz: Array) -> Array:
    """Return how far the lines about some frequencies lie apart [Hz]."""
    at = np.clip(np.searchsorted(frequency_hz, wanted_hz), 1, frequency_hz.size - 1)
    return np.asarray(frequency_hz[at] - frequency_hz[at - 1])


def see(response: FrequencyResponse, chosen: NDArray[np.bool_]) -> Lines:
    """Return some lines of a response, weighed by its coherence.

    With coherence alone its course counts; no error is below the floor.
    """
    known = response.relative_error
    relative = np.hypot(known, ERROR_FLOOR) if known is not None else UNKNOWN_ERROR
    lines = Lines(
        frequency_hz=response.frequency_hz[chosen],
        values=response.values[chosen],
        error=(relative * np.abs(response.values))[chosen],
        derivative=response.output.derivative,
    )
    return lines if lines.size <= MOST_LINES else _join(lines)


def _join(lines: Lines) -> Lines:
    """Weighed means of neighbours within groups of a thousandth of their frequency."""
    group = np.floor(np.log(lines.frequency_hz) / CLOSE)
    _, place = np.unique(group, return_inverse=True)
    weight = 1.0 / np.maximum(lines.error, 1e-300) ** 2
    total = np.bincount(place, weight)

    def mean(values: Array) -> Array:
        return np.asarray(np.bincount(place, weight * values) / total)

    return replace(
        lines,
        frequency_hz=mean(lines.frequency_hz),
        values=mean(lines.values.real) + 1j * mean(lines.values.imag),
        error=1.0 / np.sqrt(total),
    )


DAMPING_ENDS = (2e-4, 0.3)
"""Damping ratios that are tried."""
DELAY_ENDS = (-2e-3, 20e-3)
"""Delays that are tried [s]; a negative one tells of a clock or of a wrong phase."""
LAG_ENDS = (1e-6, 20e-3)
"""Lags that are tried [s]."""
RIDGE = 1e-13
"""Share of 1 added to the inner products of a basis."""
LONGEST_STEP = 0.7
"""Longest step in ln ω and ln ζ."""
LONGEST_DELAY_STEP = 5e-4
"""Longest step in a delay or a lag [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Poles:
    """What enters nonlinearly."""

    drag: float  # c, viscous friction per mass [1/s]
    # delays, lags: tau and T of each response, shape (n_responses,) [s]; a lag of 0 is not there,
    # and stays 0.
    delays: Array
    lags: Array
    # omega, zeta: Natural frequencies [rad/s] and damping ratios, shape (n_modes,).
    omega: Array
    zeta: Array

    @property
    def frequency_hz(self) -> Array:
        """Natural frequencies, shape (n_modes,) [Hz]."""
        return np.asarray(self.omega / (2 * np.pi))

    def add(self, omega: float, zeta: float) -> Poles:
        """Return the poles and one more mode."""
        return replace(self, omega=np.append(self.omega, omega), zeta=np.append(self.zeta, zeta))

    def drop(self, mode: int) -> Poles:
        """Return the poles without one mode."""
        return replace(self, omega=np.delete(self.omega, mode), zeta=np.delete(self.zeta, mode))

    def of(self, place: int) -> Poles:
        """Return the poles for one response alone."""
        own = slice(place, place + 1)
        return replace(self, delays=self.delays[own], lags=self.lags[own])


@dataclass(frozen=True, slots=True, eq=False)
class _Basis:
    """One response at some poles: weighed shapes, their inner products, the best gains."""

    shapes: ComplexArray  # Before they were weighed
    rows: ComplexArray
    scale: Array
    inverse: Array  # Of the inner products of the rows, each scaled to 1
    gains: Array
    residual: ComplexArray
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class Projected:
    """The best that some poles can do."""

    poles: Poles
    bases: tuple[_Basis, ...]  # Of each response

    @property
    def gains(self) -> Array:
        """b, g_k and R of each response, shape (n_responses, n_modes + 2)."""
        return np.array([basis.gains for basis in self.bases])

    @property
    def residuals(self) -> list[ComplexArray]:
        """(model - measured) / standard error of each response."""
        return [basis.residual for basis in self.bases]

    @property
    def cost(self) -> float:
        """Sum of their squared magnitudes."""
        return sum(basis.cost for basis in self.bases)

    @property
    def parameters(self) -> int:
        """How many numbers were fitted."""
        poles, lags = self.poles, int(np.count_nonzero(self.poles.lags))
        count = poles.omega.size
        return 1 + poles.delays.size + lags + len(self.bases) * (count + 2) + 2 * count


def _inner(one: ComplexArray, other: ComplexArray) -> Array:
    """Sums over real and imaginary parts of rows: complex lines count as two real ones."""
    return np.asarray(one.view(np.float64) @ other.view(np.float64).T)


def weighed_rows(lines: Lines, poles: Poles, place: int) -> ComplexArray:
    """Return the shapes of b, g_k and R of a response, weighed, shape (n_modes + 2, n_lines)."""
    return _shapes(lines.s, poles) * _weight(lines, poles, place)


def _weight(lines: Lines, poles: Poles, place: int) -> ComplexArray:
    s = lines.s
    found: ComplexArray = np.exp(-s * poles.delays[place]) * s**lines.derivative / lines.error
    if lag := poles.lags[place]:
        found /= 1.0 + s * lag
    return found


def _shapes(s: ComplexArray, poles: Poles) -> ComplexArray:
    omega, found = s.imag, np.empty((poles.omega.size + 2, s.size), dtype=np.complex128)
    real = np.append(0.0, poles.omega**2)[:, None] - omega**2
    turned = np.append(poles.drag, 2 * poles.zeta * poles.omega)[:, None] * omega
    # By hand: numpy's complex reciprocal takes several times as long.
    power = 1.0 / (real**2 + turned**2)
    found.real[:-1], found.imag[:-1], found[-1] = real * power, -turned * power, 1.0
    return found


def _solve(lines: Lines, shapes: ComplexArray, weight: ComplexArray) -> _Basis:
    rows = shapes * weight
    products = _inner(rows, rows)
    scale = np.sqrt(np.diag(products))
    # The ridge is for two equal poles, of which any share does.
    inverse = np.linalg.inv(products / np.outer(scale, scale) + RIDGE * np.eye(scale.size))
    y = lines.values / lines.error
    gains = inverse @ (_inner(rows, y) / scale) / scale
    residual = gains @ rows - y
    cost = float(np.vdot(residual, residual).real)
    return _Basis(shapes, rows, scale, inverse, gains, residual, cost)


def project(responses: Sequence[Lines], poles: Poles) -> Projected:
    """Return masses, gains and residual terms that fit best for some poles."""
    known = {id(one.frequency_hz): one.s for one in responses}
    shapes = {grid: _shapes(s, poles) for grid, s in known.items()}
    bases = (
        _solve(lines, shapes[id(lines.frequency_hz)], _weight(lines, poles, place))
        for place, lines in enumerate(responses)
    )
    return Projected(poles, tuple(bases))


def _slopes(lines: Lines, poles: Poles, place: int, basis: _Basis) -> ComplexArray:
    """Derivative of the weighed model by c, own delay and lag, ln ω and ln ζ, a row for each."""
    s, count, lag = lines.s, poles.omega.size, poles.lags[place]
    rate = np.empty((3 + 2 * count, s.size), dtype=np.complex128)
    by_gain = basis.rows * basis.gains[:, None]
    np.multiply(by_gain[0] * basis.shapes[0], -s, out=rate[0])
    np.multiply(by_gain.sum(axis=0), -s, out=rate[1])
    rate[2] = rate[1] / (1.0 + s * lag) if lag else 0.0
    modes = by_gain[1:-1] * basis.shapes[1:-1]
    damped = rate[3 + count :]
    np.multiply(modes, s, out=damped)
    damped *= (-2 * poles.zeta * poles.omega)[:, None]
    np.multiply(modes, (-2 * poles.omega**2)[:, None], out=rate[3 : 3 + count])
    rate[3 : 3 + count] += damped
    return rate


def _own(place: int, poles: Poles) -> NDArray[np.intp]:
    """Which of all parameters a response has: c, its delay and lag, all modes."""
    n, first = poles.delays.size, 1 + 2 * poles.delays.size
    return np.array([0, 1 + place, 1 + n + place, *range(first, first + 2 * poles.omega.size)])


def _pack(poles: Poles) -> Array:
    modes = np.log(poles.omega), np.log(poles.zeta)
    return np.concatenate([[poles.drag], poles.delays, poles.lags, *modes])


def _unpack(theta: Array, n_responses: int) -> Poles:
    n, modes = n_responses, np.exp(theta[1 + 2 * n_responses :])
    half = modes.size // 2
    return Poles(
        float(theta[0]), theta[1 : 1 + n], theta[1 + n : 1 + 2 * n], modes[:half], modes[half:]
    )


def _bounds(responses: Sequence[Lines], poles: Poles) -> tuple[Array, Array, Array]:
    n, count, (low_hz, high_hz) = len(responses), poles.omega.size, ends_of(responses)
    slow, fast = np.log(2 * np.pi * low_hz / 2), np.log(2 * np.pi * high_hz * 3.0)
    drag = 2 * np.pi * max(3.0 * low_hz, 10.0)
    least, most = np.log(DAMPING_ENDS)
    lags = np.minimum(poles.lags, LAG_ENDS[0]).tolist()
    low = [0.0, *[DELAY_ENDS[0]] * n, *lags, *[slow] * count, *[least] * count]
    high = [drag, *[DELAY_ENDS[1]] * n, *[LAG_ENDS[1]] * n, *[fast] * count, *[most] * count]
    reach = [np.inf, *[LONGEST_DELAY_STEP] * 2 * n, *[LONGEST_STEP] * 2 * count]
    return np.array(low), np.array(high), np.array(reach)


def _normal(responses: Sequence[Lines], fit: Projected) -> tuple[Array, Array, list[ComplexArray]]:
    """Jᵀ J and Jᵀ r of the projected residuals, and the slopes of each response."""
    poles, bases = fit.poles, fit.bases
    size = 1 + 2 * len(responses) + 2 * poles.omega.size
    square, slope, rates = np.zeros((size, size)), np.zeros(size), []
    for place, (lines, basis) in enumerate(zip(responses, bases, strict=True)):
        rate = _slopes(lines, poles, place, basis)
        along = _inner(basis.rows, rate) / basis.scale[:, None]
        own = _own(place, poles)
        square[np.ix_(own, own)] += _inner(rate, rate) - along.T @ basis.inverse @ along
        slope[own] += _inner(rate, basis.residual)
        rates.append(rate)
    return square, slope, rates


def refine(
    responses: Sequence[Lines],
    poles: Poles,
    *,
    steps: int = 40,
    tolerance: float = 1e-6,
    holds_delay: bool = False,
) -> Projected:
    """Return the poles of least squares near some others."""
    n = len(responses)
    low, high, reach = _bounds(responses, poles)
    theta = np.clip(_pack(poles), low, high)
    best, damping = project(responses, _unpack(theta, n)), 1e-3
    for _ in range(steps):
        square, slope, _ = _normal(responses, best)
        diagonal = np.diag(square)
        free = ~(((theta <= low) & (slope > 0)) | ((theta >= high) & (slope < 0)))
        free[1 : 1 + n] &= not holds_delay
        free &= diagonal > 0.0
        inner, gradient = square[np.ix_(free, free)], slope[free]
        lowered = 0.0
        while damping < 1e8:
            step = np.linalg.solve(inner + np.diag(damping * diagonal[free]), -gradient)
            tried = theta.copy()
            tried[free] += np.clip(step, -reach[free], reach[free])
            tried = np.clip(tried, low, high)
            new = project(responses, _unpack(tried, n))
            if new.cost < best.cost:
                lowered = (best.cost - new.cost) / best.cost
                theta, best = tried, new
                damping = max(damping * 0.1, 1e-9)
                break
            damping *= 8.0
        if lowered < tolerance:
            break
        damping = min(damping, 1e2)
    return best


@dataclass(frozen=True, slots=True, eq=False)
class Variances:
    """Covariance of what was fitted, for residuals of variance 1."""

    poles: Array  # Of c, delays, lags, ln ω_k, ln ζ_k, square
    gains: Array  # Of b, g_k and R, shape (n_responses, n_modes + 2, n_modes + 2)

    def of_gains(self, place: int, chosen: Array) -> float:
        """Return the standard error of a weighed sum of b, g_k and R of a response."""
        return float(np.sqrt(max(chosen @ self.gains[place] @ chosen, 0.0)))

    @property
    def each_gain(self) -> Array:
        """Standard errors of b, g_k and R, shape (n_responses, n_modes + 2)."""
        found = np.diagonal(self.gains, axis1=1, axis2=2)
        return np.asarray(np.sqrt(np.maximum(found, 1e-300)))

    @property
    def of_modes(self) -> Array:
        """Standard errors of ln ω and ln ζ of each mode, shape (2, n_modes)."""
        count = self.gains.shape[1] - 2
        found = np.diag(self.poles)[self.poles.shape[0] - 2 * count :].reshape(2, count)
        # A negative one is rounding of a huge one: nothing determines that pole.
        return np.asarray(np.sqrt(np.where(found > 0.0, found, np.inf)))


def find_variances(
    responses: Sequence[Lines], fit: Projected, *, curvature: float = 0.0
) -> Variances:
    """Return the covariance (Jᵀ J)⁻¹ of poles and gains at a fit.

    Of the full Jacobian: the poles' part is the inverse of its Schur complement, which is that of
    the projected one; the gains carry the poles' errors along.
    """
    bases = fit.bases
    square, _, rates = _normal(responses, fit)
    scale = np.sqrt(np.maximum(np.diag(square), 1e-300))
    with np.errstate(over="ignore"):  # a pole that no line sees
        related = np.nan_to_num(square / np.outer(scale, scale))
    inverse = np.linalg.pinv(related, rcond=1e-13, hermitian=True)
    poles = inverse / np.outer(scale, scale)
    owns = [_own(place, fit.poles) for place in range(len(responses))]
    alongs = [
        basis.inverse @ (_inner(basis.rows, rate) / basis.scale[:, None])
        for basis, rate in zip(bases, rates, strict=True)
    ]
    _, high = ends_of(responses)
    gains = np.array([
        (basis.inverse + along @ poles[np.ix_(own, own)] @ along.T)
        / np.outer(basis.scale, basis.scale)
        for basis, along, own in zip(bases, alongs, owns, strict=True)
    ])  # fmt: skip
    covariance = poles.copy()
    for lines, basis, rate, along, own in zip(responses, bases, rates, alongs, owns, strict=True):
        lacking = basis.rows[-1] * (curvature * basis.gains[-1]) * (lines.frequency_hz / high) ** 2
        onto = _inner(basis.rows, lacking) / basis.scale
        shift = poles[:, own] @ (_inner(rate, lacking) - along.T @ onto)
        covariance += np.outer(shift, shift)
        for place, (other, carried) in enumerate(zip(bases, alongs, strict=True)):
            moved = -carried @ shift[owns[place]]
            if other is basis:
                moved += basis.inverse @ onto
            gains[place] += np.outer(moved / other.scale, moved / other.scale)
    return Variances(covariance, gains)


def predict(frequency_hz: Array, poles: Poles, gains: Array, derivative: int) -> ComplexArray:
    """Return H of the one response of some poles, shape (n,)."""
    values, error = np.zeros(frequency_hz.size, dtype=complex), np.ones(frequency_hz.size)
    lines = Lines(frequency_hz=frequency_hz, values=values, error=error, derivative=derivative)
    return np.asarray(gains @ weighed_rows(lines, poles, 0))
