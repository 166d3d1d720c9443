"""What rest at the end demands of the force, as moments over the remaining time.

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

from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SAMPLES = 400
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
    functions = problem.values(horizon * ((np.arange(SAMPLES) + 0.5) / SAMPLES) ** 3)
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
