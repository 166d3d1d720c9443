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
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]
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
        D[one:, one:] = np.eye(self.degree + 1, k=1)
        return D

    def amplitudes(self, weights: Array) -> Array:
        """Return the magnitude of each rate's part of a combination, shape (n_rates,)."""
        return np.abs(self.modal(weights))

    def modal(self, weights: Array) -> Complex:
        """Return C with Σ w_i φ_i = Re Σ C e^{pτ} but for the powers, shape (..., n_rates)."""
        pairs = np.zeros((*weights.shape[:-1], 2 * self.rates.size))
        # The imaginary part of the lag, whose rate is real, stays 0.
        pairs[..., : self.one] = weights[..., : self.one]
        return pairs.view(np.complex128).conj()

    def values(self, tau: Array) -> Array:
        """Return φ and, last, ψ at remaining times τ [s] of shape (k,), as shape (size + 1, k)."""
        return self._rows(
            np.exp(np.multiply.outer(tau, self.rates)), powers_of_time(tau, self.degree)
        )

    def values_and_integrals(self, tau: Array) -> tuple[Array, Array]:
        """Return the same with their integrals from 0 to τ."""
        less_one = np.expm1(np.multiply.outer(tau, self.rates))
        powers = powers_of_time(tau, self.degree + 1)
        integrals = self._rows(less_one / self.rates, powers[1:])
        return self._rows(less_one + 1.0, powers[:-1]), integrals

    def _rows(self, modal: Array | Complex, powers: Array) -> Array:
        rows = np.empty((self.size + 1, len(modal)))
        rows[: self.one] = modal.view(np.float64)[:, : self.one].T
        rows[self.one :] = powers
        return rows


def powers_of_time(tau: NDArray[Any], highest: int) -> NDArray[Any]:
    """Return 1, τ, τ²/2, ..., shape (highest + 1, ...)."""
    powers = np.empty((highest + 1, *tau.shape), dtype=tau.dtype)
    powers[0], powers[1:2] = 1.0, tau
    for k in range(2, highest + 1):
        powers[k] = powers[k - 1] * tau / k
    return powers


@lru_cache(maxsize=PLANTS)
def moment_problem(plant: Plant, move: Move) -> MomentProblem:
    """Return the moment conditions of a move.

    Source: variation of constants in the eigenvectors of A; docs/optimal-control.md, section 1.
    """
    rates = in_moments(plant).functions.rates
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
    """Return the functionals of the state that the moments measure, ψ's last."""
    return in_moments(plant).rows[: problem.size + 1]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class InMoments:
    """The states of a plant as moments of what has driven it, of all its functions."""

    # Functions of all rates, 1 and τ, and τ²/2 where the input is the jerk of a motor.
    functions: MomentProblem
    # Row w_i fulfils w_i e^{Aτ} B = φ_i(τ), so w_i x(t_f) is the moment of φ_i; shape (n, n).
    rows: Array
    back: Array  # Its inverse: from moments to states


@lru_cache(maxsize=PLANTS)
def in_moments(plant: Plant) -> InMoments:
    """Return what takes the states of a plant to moments and back.

    Source: left eigenvectors of A (and principal vectors for the powers), scaled by w B = 1;
    docs/optimal-control.md, section 1.
    """
    T, m, rows = plant.force_lag, plant.moving_mass, np.zeros((plant.order, plant.order))
    force = slice(plant.force, plant.order) if plant.follows else plant.lagged
    for i, mode in enumerate(plant.modes):
        p, pair = mode.pole, slice(2 * i, 2 * i + 2)
        rate = (p if plant.follows else 1.0 + p * T) / mode.scale
        on_deflection = -(mode.natural_frequency**2) * rate / p
        rows[pair, mode.deflection] = on_deflection.real, on_deflection.imag
        rows[pair, mode.rate] = rate.real, rate.imag
        rows[2 * i, force] = 1.0 if plant.follows else T
    one = 2 * len(plant.modes) + len(plant.lag_rates)
    rows[2 * len(plant.modes) : one + 1, force] = 1.0 if plant.follows else T
    rows[-2, plant.velocity] = m
    rows[-1, plant.position], rows[-1, plant.velocity] = m, m * T
    rows.setflags(write=False)
    rates = np.array([*(mode.pole for mode in plant.modes), *plant.lag_rates], dtype=complex)
    functions = MomentProblem(rates=rates, degree=plant.order - one - 1, target=nan)
    return InMoments(
        functions=functions, rows=rows, back=np.asarray(np.linalg.inv(rows), dtype=np.float64)
    )


def step_response(plant: Plant, tau: Array) -> Array:
    """Return the states a time τ after a unit step of the input from rest, also for τ < 0.

    The input is the set force, or the jerk of a motor that follows.
    """
    tau, known = np.asarray(tau, dtype=np.float64), in_moments(plant)
    integrals = known.functions.values_and_integrals(tau.ravel())[1]
    return np.asarray(integrals.T @ known.back.T).reshape(*tau.shape, plant.order)


def impulse_response(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) B."""
    tau, known = np.asarray(tau, dtype=np.float64), in_moments(plant)
    values = known.functions.values(tau.ravel())
    return np.asarray(values.T @ known.back.T).reshape(*tau.shape, plant.order)


def driven(plant: Plant, states: Array, force: Array | float, tau: Array) -> Array:
    """Return the states a time τ later, (..., n), under a constant force, (...)."""
    tau, known = np.asarray(tau, dtype=np.float64), in_moments(plant)
    functions, moments = known.functions, states @ known.rows.T
    one, powers = functions.one, powers_of_time(tau, functions.degree + 1)
    modal = functions.modal(moments).conj()
    less_one = np.expm1(np.multiply.outer(tau, functions.rates))
    turned = modal + less_one * (modal + np.multiply.outer(force, 1.0 / functions.rates))
    moved = np.empty((*turned.shape[:-1], plant.order))
    moved[..., :one] = turned.view(np.float64)[..., :one]
    for k in range(functions.degree + 1):
        moved[..., one + k] = powers[k + 1] * force
        for j in range(k + 1):
            moved[..., one + k] += powers[k - j] * moments[..., one + j]
    return np.asarray(moved @ known.back.T)


def transition(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ)."""
    columns = driven(plant, np.eye(plant.order), 0.0, np.asarray(tau)[..., np.newaxis])
    return np.asarray(np.swapaxes(columns, -1, -2))


def rows_after(plant: Plant, rows: Array, tau: Array) -> Array:
    """Return r e^{A τ}, what signals see of a state a time τ later without force; shape (k, n).

    ``rows``: one for each time; a matrix for each would take gigabytes on many machines at once.
    """
    known = in_moments(plant)
    functions, own = known.functions, rows @ known.back
    one, powers = functions.one, powers_of_time(tau, functions.degree)
    waves = functions.modal(own) * np.exp(np.multiply.outer(tau, functions.rates))
    turned = np.zeros_like(own)
    turned[:, :one] = waves.conj().view(np.float64)[:, :one]
    for j in range(functions.degree + 1):
        for k in range(j, functions.degree + 1):
            turned[:, one + j] += powers[k - j] * own[:, one + k]
    return np.asarray(turned @ known.rows)


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

    Source: the row in moments without momentum and place of rest.
    """
    known = in_moments(plant)
    return np.asarray((row @ known.back)[:-2] @ known.rows[:-2])


def free_waves(plant: Plant, rows: Array, state: Array) -> Complex:
    """Return C of the signals r x(t_f + s) = Re Σ_k C_k e^{p_k s}, shape (n_rows, n_rates).

    docs/optimal-control.md, section 6.
    """
    known = in_moments(plant)
    gains = known.functions.modal(rows @ known.back)
    return np.asarray(gains * known.functions.modal(known.rows @ state).conj())


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
