"""The linear response of a loop by its closed-loop poles: many setpoints, all corners, at once.

Lifted to the position cycle T the loop is X⁺ = A X + B r with r = (x, v, a, j) of the setpoint at
t = n T. A setpoint is a sum of steps of its q-th derivative (3: the jerk; one more behind each
moving average). While nothing steps, the loop follows the polynomial, X = Σ S_k x⁽ᵏ⁾, whatever the
phase; a step that comes the time s before its first sample adds Σ s^b/b! (-S_{q-b}) there, which
then fades as A^m. So an output is a polynomial and, for each step so far, a sum over the closed
loop's poles, exact at every phase of a step within its cycle:

    y = Σ_k (C S_k) x⁽ᵏ⁾(n T) + Re Σ_p c_p λ_p^m,     m: cycles since the step's first sample

Dead times (kept setpoints, what is handed down, poles below ``DEAD``) are gone after some cycles;
until then a table of A^m stands for the poles. Where eigenvectors are ill-conditioned (equal
poles), the table goes on until all has faded: stepping, once for all setpoints. The cost depends
neither on the length of a move nor on how slowly a mode decays.

Axes of arrays: setpoint, corner, position cycle or instant, velocity cycle in it, signal; of what
the poles hold: setpoint, corner, pole.

Source: derived here; held to the stepped loop by tests/test_respond.py.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, wraps
from math import ceil, factorial, hypot, log
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matrix_balance, schur, solve_sylvester

from mtcommission.loop.model.assembly import INPUTS, LiftedLoop, SampledLoop

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycles = NDArray[np.int64]

HIGHEST = 5
"""Highest derivative that steps: the jerk behind two moving averages."""

DEAD, FADING = 0.03, 9
"""Poles below this magnitude have fallen below 1e-13 after so many cycles: they count as dead
times."""

ILL_CONDITIONED = 1e9
"""Condition of the eigenvectors above which the loop is stepped: seven digits are left."""

STEPPED = 20_000
"""Cycles of the table at most, where the loop is stepped."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopPoles:
    """A controller on the machine in every corner, by the poles of the closed loop."""

    loops: tuple[SampledLoop, ...]
    recent: int  # cycles after a step until the poles alone tell what is left of it
    factors: Complex  # λ per position cycle, one of each pair, (n_corners, n_poles)
    shapes: Complex  # outputs by pole, pairs doubled, (n_corners, cycles, n_out, n_poles)
    starts: Complex  # states of -S_k after ``recent`` cycles, (order + 1, n_corners, n_poles)
    table: Array  # outputs until then, (recent, n_corners, cycles, n_out, order + 1)
    steady: Array  # by each derivative of the setpoint, (n_corners, cycles, n_out, order + 1)
    powers: tuple[Complex, Complex]  # λ^m for m < BASE, and for multiples of BASE

    @property
    def dt(self) -> float:
        """Position cycle [s]."""
        return self.loops[0].lifted.dt

    @property
    def delay(self) -> float:
        """Reference delay τ [s]."""
        return self.loops[0].controller.reference_delay

    @property
    def velocity_cycle(self) -> float:
        """[s]."""
        return self.loops[0].controller.velocity_cycle

    @property
    def cycles(self) -> int:
        """Velocity cycles in a position cycle."""
        return self.loops[0].controller.cycles

    @property
    def outputs(self) -> int:
        """Outputs of a velocity cycle: tcp, encoder, force, then the plant's states."""
        return len(self.loops[0].outputs)

    @property
    def rates(self) -> Complex:
        """The poles in the continuous plane, (n_corners, n_poles) [1/s]; -inf of padding."""
        gone = np.abs(self.factors) == 0.0
        found = np.log(np.where(gone, 1.0, self.factors)) / self.dt
        return np.asarray(np.where(gone, -np.inf, found))

    def power(self, m: Cycles) -> Complex:
        """λ^m of every pole, shape (*m.shape, n_corners, n_poles)."""
        low, high = self.powers
        quotient, rest = np.divmod(m, BASE)
        if not np.any(quotient):
            return np.asarray(low[rest])
        found = low[rest] * high[np.minimum(quotient, len(high) - 1)]
        beyond = quotient >= len(high)
        if np.any(beyond):
            found[beyond] = np.power(self.factors, m[beyond][:, None, None].astype(np.float64))
        return np.asarray(found)


BASE, BLOCKS = 256, 64
"""Powers that are kept: up to the first, and so many multiples of it."""


@lru_cache(maxsize=16)
def find_poles(loops: tuple[SampledLoop, ...]) -> LoopPoles:
    """Return a controller on the machine in every corner by its poles; stable ones only."""
    first = loops[0]
    n_out, cycles, delays = len(first.outputs), first.controller.cycles, first.kept
    slow = [_slow_part(loop.lifted.A) for loop in loops]
    recent = delays + FADING
    if any(part.condition > ILL_CONDITIONED for part in slow):
        slowest = max(float(np.max(np.abs(np.linalg.eigvals(loop.lifted.A)))) for loop in loops)
        recent = delays + min(ceil(log(1e-12) / log(min(slowest, 1.0 - 1e-9))), STEPPED)
        slow = [
            replace(one, factors=one.factors[:0], right=one.right[:, :0], left=one.left[:0])
            for one in slow
        ]
    most = max(len(part.factors) for part in slow)
    factors = np.zeros((len(loops), most), dtype=complex)
    starts = np.zeros((HIGHEST + 1, len(loops), most), dtype=complex)
    shapes = np.zeros((len(loops), cycles, n_out, most), dtype=complex)
    table = np.empty((recent, len(loops), cycles, n_out, HIGHEST + 1))
    steady = np.empty((len(loops), cycles, n_out, HIGHEST + 1))
    for i, (loop, part) in enumerate(zip(loops, slow, strict=True)):
        count, C = len(part.factors), loop.lifted.C.reshape(cycles, n_out, -1)
        S, past = following_states(loop.lifted, HIGHEST), past_setpoints(loop.lifted, HIGHEST)
        factors[i, :count], steady[i] = part.factors, C @ S.T
        shapes[i, ..., :count] = C @ part.right
        X = -S.T
        for m in range(recent):
            table[m, i] = C @ X
            X = loop.lifted.A @ X
            if m < delays:  # of what was kept before the step, m cycles later
                older = loop.lifted.B[:, len(INPUTS) * (m + 1) :]
                X -= older @ past[:, len(INPUTS) : len(INPUTS) + older.shape[1]].T
        starts[:, i, :count] = (part.left @ X).T
    low: Complex = np.power(factors, np.arange(BASE, dtype=np.float64)[:, None, None])
    each = np.arange(BLOCKS, dtype=np.float64)[:, None, None]
    powers = low, np.power(factors**BASE, each)
    return LoopPoles(
        loops=loops,
        recent=recent,
        factors=factors,
        shapes=shapes,
        starts=starts,
        table=table,
        steady=steady,
        powers=powers,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _SlowPart:
    """What is no dead time: poles, one of each pair, right vectors doubled for it, left ones."""

    factors: Complex
    right: Complex
    left: Complex
    condition: float


def _slow_part(A: Array) -> _SlowPart:
    """Dead times are split off as an invariant subspace: their own vectors are degenerate."""
    balanced, (scale, _) = matrix_balance(A, permute=False, separate=True)
    T, Q, count = schur(balanced, sort=lambda real, imag: hypot(real, imag) > DEAD)
    slow, dead = T[:count, :count], T[count:, count:]
    # Q [I -Y; 0 I] makes T block-diagonal, with slow Y - Y dead = T12.
    Y = solve_sylvester(slow, -dead, T[:count, count:])
    factors, inner = np.linalg.eig(slow)
    left = np.linalg.solve(inner, (Q.T[:count] + Y @ Q.T[count:]).astype(complex)) / scale
    right = scale[:, None] * (Q[:, :count] @ inner)
    kept, doubled = factors.imag >= 0.0, np.where(factors.imag > 0.0, 2.0, 1.0)
    return _SlowPart(
        factors=factors[kept].astype(complex),
        right=(right * doubled)[:, kept],
        left=np.asarray(left[kept], dtype=np.complex128),
        condition=float(np.linalg.cond(inner)) if count else 1.0,
    )


def following_states(lifted: LiftedLoop, order: int) -> Array:
    """Return S_k, the loop's state per unit of the k-th derivative of the setpoint, (order+1, n).

    X = Σ S_k x⁽ᵏ⁾ solves X⁺ = A X + B r for every polynomial, by Taylor to the next cycle.
    """
    n, T = len(lifted.A), lifted.dt
    inverse = np.linalg.inv(np.eye(n) - lifted.A)
    pushed = past_setpoints(lifted, order) @ lifted.B.T
    S = np.zeros((order + 1, n))
    for k in range(order + 1):
        later = sum((S[k - i] * (T**i / factorial(i)) for i in range(1, k + 1)), np.zeros(n))
        S[k] = inverse @ (pushed[k] - later)
    return S


def past_setpoints(lifted: LiftedLoop, order: int) -> Array:
    """Return the setpoint now and as kept, per unit of its k-th derivative now, as ``lifted.B``.

    By Taylor into the past, shape (order + 1, 4 (kept + 1)).
    """
    ago = -lifted.dt * np.arange(lifted.B.shape[1] // len(INPUTS))
    past = np.zeros((order + 1, len(ago), len(INPUTS)))
    for k in range(order + 1):
        for q in range(min(k + 1, len(INPUTS))):
            past[k, :, q] = ago ** (k - q) / factorial(k - q)
    return past.reshape(order + 1, -1)


def restrict(poles: LoopPoles, corners: Sequence[int]) -> LoopPoles:
    """Return the same in some corners only."""
    own = list(corners)
    return replace(
        poles,
        loops=tuple(poles.loops[i] for i in own),
        factors=poles.factors[own],
        shapes=poles.shapes[own],
        starts=poles.starts[:, own],
        table=poles.table[:, own],
        steady=poles.steady[own],
        powers=(poles.powers[0][:, own], poles.powers[1][:, own]),
    )


Computed = TypeVar("Computed", bound=Callable[..., Any])


def once_for_rows(compute: Computed) -> Computed:
    """Keep what is computed of a loop and of rows over its outputs, for all setpoints on it."""

    @lru_cache(maxsize=32)
    def known(poles: LoopPoles, shape: tuple[int, ...], row_bytes: bytes, *more: Hashable) -> Any:
        return compute(poles, np.frombuffer(row_bytes).reshape(shape), *more)

    @wraps(compute)
    def find(poles: LoopPoles, rows: Array, *more: Hashable) -> Any:
        return known(poles, rows.shape, rows.tobytes(), *more)

    return cast(Computed, find)
