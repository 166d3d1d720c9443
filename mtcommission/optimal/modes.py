"""A plant in its modes: its motion as sums of exponentials, and what rest demands of the force.

With the remaining time τ = t_f - t, every terminal condition of an axis is a condition on a
moment of the set force,

    ∫ φ(τ) F_set dτ = 0        φ = Re e^{pτ}, Im e^{pτ} for each mode, and e^{-τ/T} behind a lag,
    ∫ ψ(τ) F_set dτ = target   ψ = 1 (velocity step, target m Δv)
                               ψ = τ (positioning, target m L; then φ = 1 joins the first line)

and the functions φ, ψ do not depend on t_f. All of them decay or stay bounded, so nothing
overflows, however long the move. A combination of them is told by its weights, those of φ first
and that of ψ last; the switching function σ = ψ - Σ c_i φ_i has the weights (-c, 1).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant, PlantMode, driven_at_once

Array = NDArray[np.float64]


def step_response(plant: Plant, tau: Array) -> Array:
    """Return the states a time τ after a unit step of the input from rest; 0 for τ <= 0.

    The input is the set force, or the jerk of a motor that follows.

    Source: partial fractions of the transfer functions.
    """
    if plant.follows:
        return _ramp_response(plant, np.maximum(np.asarray(tau, dtype=np.float64), 0.0))
    T, after = plant.force_lag, np.maximum(np.asarray(tau, dtype=np.float64), 0.0)
    rise, fall = _rise(plant, after), _fall(plant, after)
    out = np.zeros((*after.shape, plant.order))
    out[..., plant.lagged] = rise[..., np.newaxis]
    out[..., plant.velocity] = (after - T * rise) / plant.moving_mass
    out[..., plant.position] = (after**2 / 2 - T * after + T**2 * rise) / plant.moving_mass
    for mode in plant.modes:
        p = mode.pole
        left = _left(plant, mode, fall)
        turn = 2.0 / ((p - p.conjugate()) * (T * p + 1.0) * p) * np.exp(p * after)
        started = np.asarray(after > 0.0)
        deflection = mode.natural_frequency**-2.0 - T**2 * left + turn.real
        out[..., mode.deflection] = mode.scale * deflection * started
        out[..., mode.rate] = mode.scale * (T * left + (p * turn).real) * started
    return out


def _ramp_response(plant: Plant, tau: Array) -> Array:
    """Return the states a time τ after the jerk of a motor that follows has become 1."""
    moved = step_response(driven_at_once(plant), tau)
    out = np.empty((*tau.shape, plant.order))
    out[..., plant.force] = tau
    out[..., plant.velocity] = tau**2 / 2.0
    out[..., plant.position] = tau**3 / 6.0
    for mode in plant.modes:
        p = mode.pole
        turn = 2.0 / ((p - p.conjugate()) * p**2) * np.expm1(p * tau)
        out[..., mode.deflection] = mode.scale * (tau / mode.natural_frequency**2 + turn.real)
        out[..., mode.rate] = moved[..., mode.deflection]
    return out


def _rise(plant: Plant, tau: Array) -> Array:
    """Return the share 1 - e^{-τ/T} of a set force that acts after τ; 1 without a lag."""
    return -np.expm1(-tau / plant.force_lag) if plant.force_lag else np.ones_like(tau)


def _fall(plant: Plant, tau: Array) -> Array:
    """Return the rest e^{-τ/T}; 0 without a lag."""
    return np.exp(-tau / plant.force_lag) if plant.force_lag else np.zeros_like(tau)


def _left(plant: Plant, mode: PlantMode, fall: Array) -> Array:
    """Return e^{-τ/T} / (1 - 2 ζ ω T + (ω T)²), the lag's share in a mode's answer."""
    bend = mode.natural_frequency * plant.force_lag
    return fall / (1.0 - 2.0 * mode.damping_ratio * bend + bend**2)


def impulse_response(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) B in closed form.

    Source: derivative of the step response.
    """
    T, tau = plant.force_lag, np.asarray(tau, dtype=np.float64)
    if plant.follows:
        moved = step_response(driven_at_once(plant), tau)
        return np.concatenate([moved, np.ones((*tau.shape, 1))], axis=-1)
    rise, fall = _rise(plant, tau), _fall(plant, tau)
    out = np.empty((*tau.shape, plant.order))
    out[..., plant.lagged] = fall[..., np.newaxis] / (T or 1.0)
    out[..., plant.velocity] = rise / plant.moving_mass
    out[..., plant.position] = (tau - T * rise) / plant.moving_mass
    for mode in plant.modes:
        p = mode.pole
        left = _left(plant, mode, fall)
        turn = 2.0 / ((p - p.conjugate()) * (T * p + 1.0)) * np.exp(p * tau)
        out[..., mode.deflection] = mode.scale * (T * left + turn.real)
        out[..., mode.rate] = mode.scale * ((p * turn).real - left)
    return out


def advance(plant: Plant, states: Array, tau: Array) -> Array:
    """Return expm(A τ) x of many states and times, (..., n) and (...), in closed form.

    Source: free oscillation of each mode; what a force leaves, if it has a lag, from B.
    """
    tau = np.asarray(tau, dtype=np.float64)
    out = np.empty(np.broadcast_shapes(states.shape, (*tau.shape, 1)))
    out[...] = states
    out[..., plant.position] += tau * states[..., plant.velocity]
    for mode in plant.modes:
        omega, zeta, p = mode.natural_frequency, mode.damping_ratio, mode.pole
        d, v = states[..., mode.deflection], states[..., mode.rate]
        decay, wave = np.exp(p.real * tau), p.imag * tau
        c, s = decay * np.cos(wave), decay * np.sin(wave) / p.imag
        out[..., mode.deflection] = (c + zeta * omega * s) * d + s * v
        out[..., mode.rate] = -(omega**2) * s * d + (c - zeta * omega * s) * v
    # A force is what an impulse of the input leaves, behind a lag T times that.
    if plant.force_lag or plant.follows:
        force = states[..., plant.force, np.newaxis] * (plant.force_lag or 1.0)
        out[..., plant.force] = 0.0
        out += force * impulse_response(plant, tau)
    return out


def transition(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) in closed form."""
    columns = advance(plant, np.eye(plant.order), np.asarray(tau)[..., np.newaxis])
    return np.asarray(np.swapaxes(columns, -1, -2))


Complex = NDArray[np.complex128]

MOMENT_SAMPLES = 400
"""Where moment functions are compared, enough for moves of some dozen radians; longer ones tell
all modes apart."""
TINY = 1e-300
PLANTS = 128
"""Plants whose moment problems are kept."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MomentProblem:
    """The moment functions of one move on one plant."""

    # Poles p of the modes (positive imaginary part), then -1/T if there is a force lag; shape
    # (n_rates,) [1/s].
    rates: Complex
    degree: int  # ψ = τ^degree: 0 for a velocity step, 1 for positioning
    target: float  # ∫ ψ F_set dτ: m Δv [N s] or m L [N s²]

    @cached_property
    def magnitudes(self) -> Array:
        """|p| of each rate, shape (n_rates,) [1/s]."""
        return np.abs(self.rates)

    @cached_property
    def n_modes(self) -> int:
        """How many rates are of modes."""
        return int(np.count_nonzero(self.rates.imag))

    @cached_property
    def one(self) -> int:
        """Index of the function 1: one each for the real rates, two for the complex ones before."""
        return self.n_modes + self.rates.size

    @property
    def lag(self) -> slice:
        """Where the functions are of the force lag; empty without one."""
        return slice(2 * self.n_modes, self.one)

    @cached_property
    def size(self) -> int:
        """Number of moments that must vanish."""
        return self.one + self.degree

    @cached_property
    def differentiation(self) -> Array:
        """D with Σ w_i dφ_i/dτ = Σ (D w)_i φ_i, ψ among them; shape (size + 1, size + 1) [1/s]."""
        D, one = np.zeros((self.size + 1, self.size + 1)), self.one
        for i, p in enumerate(self.rates[: self.n_modes].tolist()):
            pair = slice(2 * i, 2 * i + 2)
            D[pair, pair] = [[p.real, p.imag], [-p.imag, p.real]]
        D[self.lag, self.lag] = self.rates[self.n_modes :].real
        D[one:-1, one + 1 :] = 1.0
        return D

    def amplitudes(self, weights: Array) -> Array:
        """Return the magnitude of each rate's part of a combination, shape (n_rates,)."""
        return np.abs(self.modal(weights))

    def modal(self, weights: Array) -> Complex:
        """Return C with Σ w_i φ_i = Re Σ C e^{pτ}, but for 1 and τ; shape (n_rates,)."""
        pairs = np.zeros(2 * self.rates.size)
        # The imaginary part of the lag, whose rate is real, stays 0.
        pairs[: self.one] = weights[: self.one]
        return pairs.view(np.complex128).conj()

    def values(self, tau: Array) -> Array:
        """Return φ and, last, ψ at remaining times τ [s] of shape (k,), as shape (size + 1, k)."""
        return self._rows(np.exp(np.multiply.outer(tau, self.rates)), 1.0, tau)

    def values_and_integrals(self, tau: Array) -> tuple[Array, Array]:
        """Return the same with their integrals from 0 to τ."""
        less_one = np.expm1(np.multiply.outer(tau, self.rates))
        integrals = self._rows(less_one / self.rates, tau, 0.5 * tau * tau)
        return self._rows(less_one + 1.0, 1.0, tau), integrals

    def _rows(self, modal: Complex | Array, of_one: Array | float, of_tau: Array) -> Array:
        rows = np.empty((self.size + 1, len(modal)))
        rows[: self.one] = modal.view(np.float64)[:, : self.one].T
        rows[self.one] = of_one
        if self.degree:
            rows[-1] = of_tau
        return rows


@lru_cache(maxsize=PLANTS)
def moment_problem(plant: Plant, move: Move) -> MomentProblem:
    """Return the moment conditions of a move.

    Source: variation of constants in the eigenvectors of A; docs/optimal-control.md, section 1.
    """
    rates = np.array([*(mode.pole for mode in plant.modes), *plant.lag_rates], dtype=complex)
    if isinstance(move, VelocityStep):
        return MomentProblem(rates=rates, degree=0, target=plant.moving_mass * move.velocity_step)
    return MomentProblem(rates=rates, degree=1, target=plant.moving_mass * move.distance)


def independence(problem: MomentProblem, horizon: float) -> float:
    """Return how far the moment functions are from linear dependence, 0 to 1."""
    # Denser near 0, where a fast lag lives that is gone for most of a long move.
    functions = problem.values(horizon * ((np.arange(MOMENT_SAMPLES) + 0.5) / MOMENT_SAMPLES) ** 3)
    lengths = np.linalg.norm(functions, axis=1, keepdims=True) + TINY
    values = np.linalg.svd(functions / lengths, compute_uv=False)
    return float(values[-1] / values[0])


def moment_rows(plant: Plant, problem: MomentProblem) -> Array:
    """Return the functionals of the state that the moments measure.

    Row w_i fulfils w_i e^{Aτ} B = φ_i(τ), so w_i x(t_f) is the moment of φ_i; the last row does
    the same for ψ.

    Source: left eigenvectors of A (and one principal vector for ψ = τ), scaled by w B = 1;
    docs/optimal-control.md, section 1.
    """
    return all_moment_rows(plant)[: problem.size + 1]


@lru_cache(maxsize=PLANTS)
def all_moment_rows(plant: Plant) -> Array:
    """Return ``moment_rows`` for the functions of all rates, 1 and τ, shape (n, n)."""
    T, m = plant.force_lag, plant.moving_mass
    rows = np.zeros((plant.order, plant.order))
    for i, mode in enumerate(plant.modes):
        p, pair = mode.pole, slice(2 * i, 2 * i + 2)
        rate = (1.0 + p * T) / mode.scale
        on_deflection = -(mode.natural_frequency**2) * rate / p
        rows[pair, mode.deflection] = on_deflection.real, on_deflection.imag
        rows[pair, mode.rate] = rate.real, rate.imag
        rows[2 * i, plant.lagged] = T
    rows[2 * len(plant.modes) : -1, plant.lagged] = T
    rows[-2, plant.velocity] = m
    rows[-1, plant.position], rows[-1, plant.velocity] = m, m * T
    rows.setflags(write=False)
    return rows


RADIANS, BLOCK = 0.2, 64
"""Between samples, of the fastest rate, and how many of them one power of it serves."""
MOST_SAMPLES = 400_000
"""Of a free motion, until it has decayed below the band."""
NEAR = 0.97
"""Share of the band from which a sample may stand next to a peak that leaves it."""
POLISHES = 4
"""Newton steps from a sampled peak to the peak itself."""


def free_row(plant: Plant, row: Array) -> Array:
    """Return the row of a signal's distance from its rest, or its steady motion, shape (n,).

    Source: the row in the left eigenvectors of A without momentum and place of rest.
    """
    basis = all_moment_rows(plant)
    return np.asarray(np.linalg.solve(basis.T, row)[:-2] @ basis[:-2])


def free_rates(plant: Plant) -> Complex:
    """Return the poles of the modes, then that of a force lag, shape (n_rates,) [1/s]."""
    return np.array([*(mode.pole for mode in plant.modes), *plant.lag_rates], dtype=complex)


def free_gains(plant: Plant, rows: Array) -> Complex:
    """Return C of signals r x(t_f + s) = Re Σ_k C_k z_k e^{p_k s}, shape (n_rows, n_rates).

    z_k = ∫ e^{p_k τ} F_set dτ are the moments of the force; docs/optimal-control.md, section 6.
    """
    parts, modal = np.linalg.solve(all_moment_rows(plant).T, rows.T).T, 2 * len(plant.modes)
    of_lag = parts[:, modal : modal + len(plant.lag_rates)]
    return np.hstack([parts[:, 0:modal:2] - 1j * parts[:, 1:modal:2], of_lag])


def free_moments(plant: Plant, state: Array) -> Complex:
    """Return the moments z of the force that has led to a state, shape (n_rates,)."""
    parts, modal = all_moment_rows(plant) @ state, 2 * len(plant.modes)
    of_lag = parts[modal : modal + len(plant.lag_rates)]
    return np.concatenate([parts[0:modal:2] + 1j * parts[1:modal:2], of_lag])


def free_peaks(
    rates: Complex, weights: Complex, *, offset: float
) -> tuple[NDArray[np.intp], Array, Array]:
    """Return the peaks of |Re Σ w_k e^{p_k s} - offset| near 1 and above, for all s >= 0.

    Rates and weights of shape (m, k); indices of the motions, s and heights.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if a motion needs too many samples to decay.
    """
    if not weights.size:
        return np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros(0)
    step = RADIANS / float(np.abs(rates).max())
    longest, level = MOST_SAMPLES * step, 1.0 - abs(offset)
    horizon = _decayed(rates.real, np.abs(weights), level, longest=longest)
    if horizon > longest:
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("free-motion-rings-on"))
    blocks = int(np.ceil(horizon / step / BLOCK)) + 1
    far = weights[..., np.newaxis] * np.exp(
        rates[..., np.newaxis] * (BLOCK * step * np.arange(blocks))
    )
    near = np.exp(rates[..., np.newaxis] * (step * np.arange(BLOCK)))
    values = (np.swapaxes(far, -1, -2) @ near).real.reshape(len(weights), -1) - offset
    size = np.pad(np.abs(values), ((0, 0), (1, 0)))
    is_peak = (size[:, 1:-1] >= size[:, :-2]) & (size[:, 1:-1] > size[:, 2:])
    motion, at = np.nonzero(is_peak & (size[:, 1:-1] > NEAR))
    p, w, first = rates[motion], weights[motion], step * at
    low, high, s = np.maximum(first - step, 0.0), first + step, first
    for _ in range(POLISHES):
        waves = w * np.exp(s[:, np.newaxis] * p) * p
        slope, bend = waves.sum(axis=-1).real, (waves * p).sum(axis=-1).real
        s = np.clip(s - np.divide(slope, bend, out=np.zeros_like(s), where=bend != 0.0), low, high)
    height = np.abs((w * np.exp(s[:, np.newaxis] * p)).sum(axis=-1).real - offset)
    sample = size[motion, at + 1]
    # The free motion may begin at its largest.
    return motion, np.where(height >= sample, s, first), np.maximum(height, sample)


def _decayed(decay: Array, magnitudes: Array, level: float, *, longest: float) -> float:
    """Return a time after which all amplitudes of each motion stay below a level [s]."""
    s = 1.0 / float(np.abs(decay).max())
    while float((magnitudes * np.exp(decay * s)).sum(axis=1).max()) > level and s < longest:
        s *= 1.25
    return s
