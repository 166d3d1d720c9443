"""What rest at the end demands of the force, as moments over the remaining time.

With the remaining time τ = t_f - t, every terminal condition of an axis is a condition on a
moment of the set force,

    ∫ φ(τ) F_set dτ = 0        φ = Re e^{pτ}, Im e^{pτ} for each mode, and e^{-τ/T} behind a lag,
    ∫ ψ(τ) F_set dτ = target   ψ = 1 (velocity step, target m Δv)
                               ψ = τ (positioning, target m L; then φ = 1 joins the first line)

and the functions φ, ψ do not depend on t_f. All of them decay or stay bounded, so nothing
overflows, however long the move.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from math import cos, expm1, sin

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
ExtendedComplex = NDArray[np.clongdouble]

SAMPLES = 400
"""Where moment functions are compared, enough for moves of some dozen radians; longer ones tell
all modes apart."""
TINY = 1e-300
PLANTS = 128
"""Plants whose moment problems are kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MomentProblem:
    """The moment functions of one move on one plant."""

    # Poles p of the modes (positive imaginary part), then -1/T if there is a force lag; shape
    # (n_rates,) [1/s].
    rates: Complex
    degree: int  # ψ = τ^degree: 0 for a velocity step, 1 for positioning
    target: float  # ∫ ψ F_set dτ: m Δv [N s] or m L [N s²]
    n_modes: int = field(init=False)  # How many rates are of modes
    magnitudes: Array = field(init=False)  # |p| of each rate, shape (n_rates,) [1/s]
    # Real and imaginary parts of all rates, shape (1, 2 n_rates) [1/s].
    exponents: Array = field(init=False)
    # D with dφ/dτ = φ D as rows, for the functions of all rates, 1 and τ, shape (one + 2, one
    # + 2) [1/s].
    joint_differentiation: Array = field(init=False)
    # The same for the φ alone, so Σ c_i dφ_i/dτ = φ (D c), shape (size, size) [1/s].
    differentiation: Array = field(init=False)
    # joint_evaluation, joint_integration: Take rows of ``table`` to φ and, last, ψ, and to
    # their integrals from 0, each of shape (one + 3, size + 1) [-, s].
    joint_evaluation: Array = field(init=False)
    joint_integration: Array = field(init=False)

    def __post_init__(self) -> None:
        """Derive what is needed time and again."""
        object.__setattr__(self, "magnitudes", np.abs(self.rates))
        object.__setattr__(self, "n_modes", int(np.count_nonzero(self.rates.imag)))
        lag, one = self.lag, self.one
        D, inverse = np.zeros((one + 2, one + 2)), np.zeros((one + 3, self.size + 1))
        for i, p in enumerate(self.rates[: self.n_modes].tolist()):
            for matrix, rate in ((D, p), (inverse, 1.0 / p)):
                matrix[2 * i, 2 * i] = matrix[2 * i + 1, 2 * i + 1] = rate.real
                matrix[2 * i, 2 * i + 1], matrix[2 * i + 1, 2 * i] = rate.imag, -rate.imag
        rate = self.rates[self.n_modes :].real
        D[lag, lag], D[one, one + 1] = rate, 1.0
        # Of the columns of ``table`` τ integrates 1, and τ²/2 integrates τ if that is asked for.
        inverse[lag, lag], inverse[one + 1, one] = 1.0 / rate, 1.0
        inverse[one + 2, one + 1 :] = 1.0
        # What vanishes at τ = 0 of each Re e^{pτ} - 1 is made up for by the column of ones.
        evaluation = np.eye(one + 3, self.size + 1)
        evaluation[one, 0:one:2] = 1.0
        object.__setattr__(self, "exponents", self.rates.view(np.float64)[np.newaxis])
        object.__setattr__(self, "joint_differentiation", D)
        object.__setattr__(self, "differentiation", D[: self.size, : self.size])
        object.__setattr__(self, "joint_evaluation", evaluation)
        object.__setattr__(self, "joint_integration", inverse)

    @property
    def one(self) -> int:
        """Index of the function 1: one each for the real rates, two for the complex ones before."""
        return self.n_modes + self.rates.size

    @property
    def lag(self) -> slice:
        """Where the functions are of the force lag; empty without one."""
        return slice(2 * self.n_modes, self.one)

    @property
    def size(self) -> int:
        """Number of moments that must vanish."""
        return self.one + self.degree

    def amplitudes(self, multipliers: Array) -> Array:
        """Return the magnitudes of multipliers (..., size) of each rate, shape (..., n_rates)."""
        modal = 2 * self.n_modes
        found = np.empty((*multipliers.shape[:-1], self.rates.size))
        pairs = multipliers[..., 0:modal:2], multipliers[..., 1:modal:2]
        np.hypot(*pairs, out=found[..., : self.n_modes])
        np.abs(multipliers[..., self.lag], out=found[..., self.n_modes :])
        return found

    def weights(self, multipliers: Array) -> ExtendedComplex:
        """Return C with Σ c_i φ_i = Re Σ C e^{pτ} but for φ = 1, shape (..., n_rates)."""
        modal = 2 * self.n_modes
        found = np.zeros((*multipliers.shape[:-1], self.rates.size), dtype=np.clongdouble)
        found.real[..., : self.n_modes] = multipliers[..., 0:modal:2]
        found.imag[..., : self.n_modes] = -multipliers[..., 1:modal:2]
        found.real[..., self.n_modes :] = multipliers[..., self.lag]
        return found

    def constant(self, multipliers: Array) -> float:
        """Return the multiplier of φ = 1; 0 for a velocity step."""
        return float(multipliers[-1]) if self.degree else 0.0

    def values(self, tau: Array) -> Array:
        """Return φ at remaining times τ [s] of shape (k,), as shape (k, size)."""
        return self.columns(np.exp(tau[:, np.newaxis] * self.rates), 1.0)

    def joint_values(self, tau: Array) -> Array:
        """Return φ and, last, ψ at remaining times τ [s] of shape (k,), as shape (size + 1, k)."""
        parts = tau[:, np.newaxis].dot(self.exponents)
        modal = parts.view(np.complex128)
        np.exp(modal, out=modal)
        values = np.empty((self.size + 1, tau.size))
        values[: self.one] = parts.T[: self.one]
        values[self.one] = 1.0
        if self.degree:
            values[-1] = tau
        return values

    def values_and_slopes(self, tau: Array) -> tuple[Array, Array]:
        """Return φ and dφ/dτ at remaining times τ [s] of shape (k,), each of shape (k, size)."""
        values = self.values(tau)
        return values, values @ self.differentiation

    def table(self, tau: Array) -> Array:
        """Return what φ, ψ and their integrals are composed of, shape (k, one + 3).

        The columns are real and imaginary parts of e^{pτ} - 1 for each rate, 1, τ and τ²/2.
        """
        one, parts = self.one, tau[:, np.newaxis].dot(self.exponents)
        modal = parts.view(np.complex128)
        np.expm1(modal, out=modal)
        table = np.empty((tau.size, one + 3))
        table[:, :one] = parts[:, :one]
        table[:, one] = 1.0
        table[:, one + 1] = tau
        np.multiply(tau, 0.5 * tau, out=table[:, one + 2])
        return table

    def integrals(self, tau: Array) -> Array:
        """Return ∫_0^τ φ at remaining times τ [s] of shape (k,), as shape (k, size)."""
        return self.columns(np.expm1(tau[:, np.newaxis] * self.rates) / self.rates, tau)

    def combination(self, multipliers: Array, tau: float) -> tuple[float, float]:
        """Return ∫_0^τ σ and σ at one τ, σ = ψ - Σ c_i φ_i; scalar, since it sits in root searches.

        The real exponentials of ``values`` and ``integrals``, without the cost of short arrays.
        """
        constant = self.constant(multipliers)
        value = (tau if self.degree else 1.0) - constant
        primitive = (0.5 * tau * tau if self.degree else tau) - constant * tau
        c = multipliers.tolist()
        for i, p in enumerate(self.rates.tolist()):
            real, imaginary = c[2 * i], (c[2 * i + 1] if p.imag else 0.0)
            growth, turn = expm1(p.real * tau), p.imag * tau
            half = sin(0.5 * turn)
            less_one = complex(growth * cos(turn) - 2.0 * half * half, (growth + 1.0) * sin(turn))
            integral = less_one / p
            value -= real * (less_one.real + 1.0) + imaginary * less_one.imag
            primitive -= real * integral.real + imaginary * integral.imag
        return primitive, value

    def target_values(self, tau: Array) -> Array:
        """Return ψ(τ)."""
        return tau if self.degree else np.ones_like(tau)

    def target_integrals(self, tau: Array) -> Array:
        """Return ∫_0^τ ψ."""
        return 0.5 * tau * tau if self.degree else tau

    def columns(self, modal: Complex, constant: Array | float) -> Array:
        """Return one real column for each φ, given one complex column for each rate.

        The lag's pole is real, so its imaginary part is void; the column of φ = 1 is ``constant``.
        Shape (k, n_rates) -> (k, size).
        """
        columns = np.empty((len(modal), self.size))
        columns[:, : self.one] = modal.view(np.float64)[:, : self.one]
        columns[:, self.one :] = np.reshape(constant, (-1, 1))
        return columns


@lru_cache(maxsize=PLANTS)
def moment_problem(plant: Plant, move: Move) -> MomentProblem:
    """Return the moment conditions of a move.

    Source: variation of constants in the eigenvectors of A; docs/optimal-control.md, section 1.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> moment_problem(build_plant(machine), machine.moves[0]).size
    5
    """
    rates = np.array([*(mode.pole for mode in plant.modes), *plant.lag_rates], dtype=complex)
    if isinstance(move, VelocityStep):
        return MomentProblem(rates=rates, degree=0, target=plant.moving_mass * move.velocity_step)
    return MomentProblem(rates=rates, degree=1, target=plant.moving_mass * move.distance)


def independence(problem: MomentProblem, horizon: float) -> float:
    """Return how far the moment functions are from linear dependence, 0 to 1.

    Examples
    --------
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> machine = read_shipped("milling-manipulator").machine
    >>> problem = moment_problem(build_plant(machine), machine.moves[0])
    >>> [f"{independence(problem, t):.0e}" for t in (0.1, 1e-3)]
    ['2e-01', '2e-08']
    """
    # Denser near 0, where a fast lag lives that is gone for most of a long move.
    tau = horizon * ((np.arange(SAMPLES) + 0.5) / SAMPLES) ** 3
    functions = np.column_stack([problem.values(tau), problem.target_values(tau)])
    lengths = np.sqrt((functions**2).sum(axis=0)) + TINY
    values = np.linalg.svd(functions / lengths, compute_uv=False)
    return float(values[-1] / values[0])


def moment_rows(plant: Plant, problem: MomentProblem) -> Array:
    """Return the functionals of the state that the moments measure.

    Row w_i fulfils w_i e^{Aτ} B = φ_i(τ), so w_i x(t_f) is the moment of φ_i; the last row does
    the same for ψ.

    Source: left eigenvectors of A (and one principal vector for ψ = τ), scaled by w B = 1;
    docs/optimal-control.md, section 1.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> plant = build_plant(machine)
    >>> rows = moment_rows(plant, moment_problem(plant, machine.moves[0]))
    >>> [round(float(b), 12) for b in rows @ plant.B]
    [1.0, 0.0, 1.0, 0.0, 1.0, 1.0]
    """
    return all_moment_rows(plant)[: problem.size + 1]


@lru_cache(maxsize=PLANTS)
def all_moment_rows(plant: Plant) -> Array:
    """Return ``moment_rows`` for the functions of all rates, 1 and τ, shape (n, n)."""
    T, m = plant.force_lag, plant.moving_mass
    rows = np.zeros((plant.order, plant.order))
    for i, mode in enumerate(plant.modes):
        p = mode.pole
        rate = (1.0 + p * T) / mode.scale
        on_deflection = -(mode.natural_frequency**2) * rate / p
        rows[2 * i, mode.deflection], rows[2 * i + 1, mode.deflection] = (
            on_deflection.real,
            on_deflection.imag,
        )
        rows[2 * i, mode.rate], rows[2 * i + 1, mode.rate] = rate.real, rate.imag
        rows[2 * i, plant.lagged] = T
    rows[2 * len(plant.modes) : -1, plant.lagged] = T
    rows[-2, plant.velocity] = m
    rows[-1, plant.position], rows[-1, plant.velocity] = m, m * T
    rows.setflags(write=False)
    return rows
