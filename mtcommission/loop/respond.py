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

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, factorial, floor, hypot, log, pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matrix_balance, schur, solve_sylvester

from mtcommission.loop.model.assembly import LiftedLoop, SampledLoop
from mtcommission.setpoint.pieces import INSTANT, Pieces, cut, taylor
from mtcommission.setpoint.setpoint import JerkSteps

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

FADED = 1e-3
"""Share to which a pole has decayed where its swings need no samples any more [-]."""

SWINGS, LATER = 2.5, 40
"""Periods of a pole that are looked at densely; instants after them, at most (empirical)."""

RESTING = 1e-12
"""Final velocity, as a share of what single steps add, that is rounding alone [-]."""

BACKWARDS = np.unique(np.append(np.arange(-1, 13), np.geomspace(13, 1e4, 40).round()))[::-1]
"""Position cycles before the envelope enters the band, at which its last swings are looked at."""

TOGETHER = 500
"""Setpoints and corners whose last swings are looked at at once."""

BETWEEN = 6
"""Cycles looked at between two far steps besides those near them: a polynomial has few extremes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopPoles:
    """A controller on the machine in every corner, by the poles of the closed loop."""

    loops: tuple[SampledLoop, ...]
    forced: int  # cycles after a step until the poles alone tell what is left of it
    factors: Complex  # λ per position cycle, one of each pair, (n_corners, n_poles)
    shapes: Complex  # outputs by pole, pairs doubled, (n_corners, cycles, n_out, n_poles)
    starts: Complex  # states of -S_k after ``forced`` cycles, (order + 1, n_corners, n_poles)
    table: Array  # outputs until then and as long again, (n, n_corners, cycles, n_out, order + 1)
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
    n_out, cycles, own = len(first.outputs), first.controller.cycles, first.own_size
    delays = (len(first.lifted.A) - own) // 4
    slow = [_slow_part(loop.lifted.A[:own, :own]) for loop in loops]
    forced = delays + FADING
    if any(part.condition > ILL_CONDITIONED for part in slow):
        slowest = max(
            float(np.max(np.abs(np.linalg.eigvals(loop.lifted.A[:own, :own])))) for loop in loops
        )
        forced = delays + min(ceil(log(1e-12) / log(min(slowest, 1.0 - 1e-9))), STEPPED)
        slow = [part.without_any() for part in slow]
    most = max(len(part.factors) for part in slow)
    factors = np.zeros((len(loops), most), dtype=complex)
    starts = np.zeros((HIGHEST + 1, len(loops), most), dtype=complex)
    shapes = np.zeros((len(loops), cycles, n_out, most), dtype=complex)
    table = np.empty((2 * forced + 1, len(loops), cycles, n_out, HIGHEST + 1))
    steady = np.empty((len(loops), cycles, n_out, HIGHEST + 1))
    for i, (loop, part) in enumerate(zip(loops, slow, strict=True)):
        count, C = len(part.factors), loop.lifted.C.reshape(cycles, n_out, -1)
        S = following_states(loop.lifted, HIGHEST)
        factors[i, :count], steady[i] = part.factors, C @ S.T
        shapes[i, ..., :count] = C[:, :, :own] @ part.right
        X = -S.T
        for m in range(len(table)):
            if m == forced:
                starts[:, i, :count] = (part.left @ X[:own]).T
            table[m, i] = C @ X
            X = loop.lifted.A @ X
    low: Complex = np.power(factors, np.arange(BASE, dtype=np.float64)[:, None, None])
    each = np.arange(BLOCKS, dtype=np.float64)[:, None, None]
    high: Complex = np.power(factors**BASE, each)
    return LoopPoles(
        loops=loops,
        forced=forced,
        factors=factors,
        shapes=shapes,
        starts=starts,
        table=table,
        steady=steady,
        powers=(low, high),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _SlowPart:
    """What is no dead time: poles, one of each pair, right vectors doubled for it, left ones."""

    factors: Complex
    right: Complex
    left: Complex
    condition: float

    def without_any(self) -> _SlowPart:
        return _SlowPart(
            factors=self.factors[:0], right=self.right[:, :0], left=self.left[:0], condition=1.0
        )


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
    S = np.zeros((order + 1, n))
    for k in range(order + 1):
        later = sum((S[k - i] * (T**i / factorial(i)) for i in range(1, k + 1)), np.zeros(n))
        S[k] = inverse @ ((lifted.B[:, k] if k < 4 else 0.0) - later)
    return S


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motions:
    """Setpoints on a loop: steps in rising order, and what of them the poles hold."""

    poles: LoopPoles
    steps: JerkSteps
    first: Cycles  # sample at which each step is seen first, (n_setpoints, n_steps)
    basis: Array  # weights of -S_q, -S_(q-1), ... at that sample, (n_setpoints, n_steps, q + 1)
    held: Complex  # of all steps up to each, ``forced`` cycles after its first sample,
    # (n_steps, n_setpoints, n_corners, n_poles)

    @property
    def order(self) -> int:
        """Which derivative steps."""
        return self.steps.order


def set_in_motion(poles: LoopPoles, steps: JerkSteps) -> Motions:
    """Return setpoints on a loop, ready to be asked for outputs."""
    rising = np.argsort(steps.times, axis=1, kind="stable")
    times = np.take_along_axis(steps.times, rising, axis=1)
    sizes = np.take_along_axis(steps.steps, rising, axis=1)
    q = steps.order
    first = np.ceil((times - INSTANT) / poles.dt).astype(np.int64)
    basis = _basis(sizes, first * poles.dt - times, q)
    starts = poles.starts[q::-1].reshape(q + 1, -1)  # by the power of s
    new = (basis.reshape(-1, q + 1) @ starts).reshape(*sizes.shape, *poles.factors.shape)
    faded = poles.power(np.diff(first, axis=1))
    held = np.empty((sizes.shape[1], len(sizes), *poles.factors.shape), dtype=complex)
    for j in range(len(held)):
        held[j] = new[:, j] + held[j - 1] * faded[:, j - 1] if j else new[:, j]
    own = JerkSteps(times=times, steps=sizes, order=q)
    return Motions(poles=poles, steps=own, first=first, basis=basis, held=held)


def _basis(sizes: Array, early: Array, order: int) -> Array:
    """Weights of -S_q, -S_(q-1), ... a time after steps of some sizes."""
    basis = np.empty((*sizes.shape, order + 1))
    basis[..., 0] = sizes
    for b in range(1, order + 1):
        basis[..., b] = basis[..., b - 1] * early / b
    return basis


def outputs_at(motions: Motions, n: Cycles, rows: Array) -> Array:
    """Return signals in some position cycles of each setpoint.

    ``n``: shape (n_setpoints, n_times); ``rows``: over the outputs of a velocity cycle, shape
    (n_rows, n_outputs). Result: (n_setpoints, n_corners, n_times, cycles, n_rows).
    """
    setpoint = np.repeat(np.arange(len(n)), n.shape[1])
    parts = np.arange(motions.poles.cycles)
    found = _outputs(motions, _pieces(motions), setpoint, n.ravel(), np.atleast_2d(rows), parts)
    return np.moveaxis(found.reshape(*n.shape, *found.shape[1:]), 2, 1)


def _pieces(motions: Motions) -> Pieces:
    steps = motions.steps
    return cut(steps.times, steps.steps, order=steps.order)


def _outputs(
    motions: Motions, pieces: Pieces, setpoint: Cycles, n: Cycles, rows: Array, parts: Cycles
) -> Array:
    """Signals of some setpoints at some cycles, (n_times, n_corners, n_parts, n_rows)."""
    q = motions.order
    x = _sampled(pieces, setpoint, np.asarray(n * motions.poles.dt), q + 1)
    steady = rows @ motions.poles.steady[:, parts, :, : q + 1]
    found = _transients(motions, setpoint, n, rows, parts)
    found += (x.T @ steady.reshape(-1, q + 1).T).reshape(found.shape)
    return found


def _transients(
    motions: Motions,
    setpoint: Cycles,
    n: Cycles,
    rows: Array,
    parts: Cycles,
    *,
    all_steps: bool = False,
) -> Array:
    """What the loop has beside its polynomial, (n_times, n_corners, n_parts, n_rows).

    ``all_steps``: beside that of all steps, those to come included, continued backwards.
    """
    poles, q = motions.poles, motions.order
    found = np.zeros((len(n), len(poles.loops) * len(parts) * len(rows)))
    # The last step that the poles alone tell of, and those since.
    age = n[:, None] - motions.first[setpoint]
    told = np.sum(age >= poles.forced, axis=1)
    far = np.flatnonzero(told)
    if poles.factors.size and len(far):
        last = told[far] - 1
        state = motions.held[last, setpoint[far]] * poles.power(age[far, last] - poles.forced)
        shapes = rows @ poles.shapes[:, parts]
        found[far] = seen(state, shapes.reshape(len(shapes), -1, shapes.shape[3])).reshape(
            len(far), -1
        )
    table = (rows @ poles.table[:, :, parts][..., q::-1]).reshape(len(poles.table), -1, q + 1)
    time, step = np.nonzero(age < poles.forced if all_steps else (age >= 0) & (age < poles.forced))
    if len(time):
        own, basis = setpoint[time], motions.basis[setpoint[time], step]
        to_come = np.flatnonzero(age[time, step] < 0)
        if len(to_come):
            place = own[to_come], step[to_come]
            early = n[time[to_come]] * poles.dt - motions.steps.times[place]
            basis[to_come] = _basis(motions.steps.steps[place], early, q)
        each = np.einsum("pxb,pb->px", table[np.maximum(age[time, step], 0)], basis)
        begins = np.flatnonzero(np.diff(time, prepend=-1))
        found[time[begins]] += np.add.reduceat(each, begins, axis=0)
    return found.reshape(len(n), len(poles.loops), len(parts), len(rows))


def seen(state: Complex, shapes: Complex) -> Array:
    """Return signals of modal states, shapes (n, n_corners, n_p), (n_corners, n_signals, n_p)."""
    by_corner = np.concatenate([state.real, state.imag], axis=2).transpose(1, 0, 2)
    by_part = np.concatenate([shapes.real, -shapes.imag], axis=2).transpose(0, 2, 1)
    return np.asarray((by_corner @ by_part).transpose(1, 0, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signal:
    """What is seen of a loop: a row over the outputs of a velocity cycle, shape (n_outputs,).

    Less that derivative of the delayed setpoint (0: position); None: as it is.
    """

    row: Array
    less: int | None = None


OUTPUTS, TOOL, FORCE = 3, 0, 2
"""Outputs of a velocity cycle before the plant's states: tcp, encoder, force; places of two."""


def tool_deviation(order: int) -> Signal:
    """Return the tool's deviation from the delayed setpoint [m], of a plant of some order."""
    return Signal(row=np.eye(order + OUTPUTS)[TOOL], less=0)


def output_of_states(row: Array) -> Array:
    """Return a row over the outputs of a velocity cycle from one over the plant's states."""
    return np.concatenate([np.zeros(OUTPUTS), row])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Velocity cycles at which free motion is looked at, from ``forced`` cycles after a step."""

    cycle: Cycles  # position cycles since then, shape (n_instants,)
    part: Cycles  # velocity cycle within it
    faded: Complex  # λ^cycle, (n_instants, n_corners, n_poles)


@lru_cache(maxsize=32)
def lay_grid(poles: LoopPoles, samples: float) -> Grid:
    """Return instants, so many to a period of each nominal pole at first, then ever fewer.

    Bounded by the number of poles, however slowly they decay: swings of one pole only become
    smaller, and those of several are met at ever other phases of each other.
    """
    found = [np.zeros(1)]
    for pole in poles.rates[0][np.abs(poles.factors[0]) > 0.0]:
        period, gone = 2.0 * pi / abs(pole), log(1.0 / FADED) / max(-pole.real, 1e-9)
        dense = min(SWINGS * period, gone)
        found.append(np.arange(0.0, dense, period / samples))
        if gone > dense:
            count = min(ceil(log(gone / dense) * samples / 2.0), LATER)
            found.append(np.geomspace(dense, gone, count + 1))
    at = np.unique(np.round(np.concatenate(found) / poles.velocity_cycle).astype(np.int64))
    cycle, part = np.divmod(at, poles.cycles)
    return Grid(cycle=cycle, part=part, faded=poles.power(cycle))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FreeMotion:
    """A signal's magnitude from t_e + τ on; before it 0, just before it that at t_e + τ itself.

    The tool's deviation e where no other one is asked for: of that alone there is a settling time.
    """

    instants: Array  # since the position cycle in which the setpoint has ended, (n_instants,) [s]
    ended: Array  # that cycle, (n_setpoints,) [s]
    until: Array  # t_e + τ, (n_setpoints,) [s]
    begin: Cycles  # first instant at or after it
    deviation: Array  # (n_setpoints, n_corners, n_instants) [own unit]
    motions: Motions  # whose free motion it is
    offset: Array  # by which it stays off while the axis coasts, (n_setpoints, n_corners, cycles)

    @property
    def residual(self) -> Array:
        """The largest, (n_setpoints, n_corners) [own unit]; of e the residual deviation [m]."""
        return np.asarray(self.deviation.max(axis=2))

    def settling(self, band: float) -> Array:
        """Settling time, (n_setpoints, n_corners) [s]; inf where it stays out of the band."""
        found = np.repeat(self.until[:, None], self.deviation.shape[1], axis=1)
        row, corner = np.nonzero(self.residual > band)
        e, begin = self.deviation[row, corner], (self.until - self.ended)[row]
        last, crossing = last_crossing(self.instants, e, band, begin=begin)
        if self.motions.poles.factors.size and len(row):
            # Late swings are looked at sparsely.
            places = np.array_split(np.arange(len(row)), ceil(len(row) / TOGETHER))
            late = np.concatenate([self._last_crossing(row[i], corner[i], band) for i in places])
            crossing = np.where(late > self.instants[last], late, crossing)
        found[row, corner] = np.maximum(self.until[row], self.ended[row] + crossing)
        return found

    def _last_crossing(self, row: Cycles, corner: Cycles, band: float) -> Array:
        """When the poles alone last bring it into the band, since the end's cycle; -inf: never.

        Looked at densely just before their envelope enters the band, then backwards ever fewer.
        """
        poles, offset = self.motions.poles, self.offset[row, corner]
        held, shapes = self.motions.held[-1, row, corner], poles.shapes[corner, :, 0]
        p = np.maximum(poles.rates.real, -1e3 / poles.dt) + 1j * poles.rates.imag
        p = poles.dt * p[corner]
        sizes, left = np.abs(held) * np.abs(shapes).max(axis=1), band - np.abs(offset).max(axis=1)
        low = np.zeros(len(row))
        with np.errstate(divide="ignore", invalid="ignore"):
            high = np.log(sizes.sum(axis=1) / left) / -p.real.max(axis=1)
        is_seen = np.isfinite(high) & (high > 0.0)
        high = np.where(is_seen, high, 0.0)
        for _ in range(40):
            middle = 0.5 * (low + high)
            is_out = (sizes * np.exp(p.real * middle[:, None])).sum(axis=1) > left
            low, high = np.where(is_out, middle, low), np.where(is_out, high, middle)
        begin, each = np.ceil(high), np.arange(len(row))
        for _ in range(2):  # and once more, densely behind the last one that is outside
            age = begin[:, None] - BACKWARDS
            state = held[:, None] * np.exp(p[:, None] * np.maximum(age, 0.0)[..., None])
            e = np.abs((state @ shapes.transpose(0, 2, 1)).real + offset[:, None])
            e[age < 0.0] = 0.0
            e = e.reshape(len(e), -1)
            last = e.shape[1] - 1 - np.argmax((e > band)[:, ::-1], axis=1)
            last = np.minimum(last, e.shape[1] - 2)
            begin = age[each, (last + 1) // poles.cycles]
        t = poles.dt * (poles.forced + age)[..., None]
        t = (t + poles.velocity_cycle * np.arange(poles.cycles)).reshape(len(e), -1)
        here, there = e[each, last], e[each, last + 1]
        start, end = t[each, last], t[each, last + 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            found = start + (here - band) / (here - there) * (end - start)
        return np.where(is_seen & (here > band), found, -np.inf)


def last_crossing(t: Array, e: Array, band: float, *, begin: Array) -> tuple[Cycles, Array]:
    """Return the last instant at which each |e| is outside the band, and when it then enters it.

    ``t``: shape (n,) [s]; ``e``: magnitudes that leave the band, shape (n_rows, n), the one before
    ``begin``, shape (n_rows,) [s], standing for ``begin`` itself. Indices, and times [s]; inf where
    it ends outside.
    """
    last = e.shape[1] - 1 - np.argmax((e > band)[:, ::-1], axis=1)
    following, row = np.minimum(last + 1, e.shape[1] - 1), np.arange(len(e))
    here, there = e[row, last], e[row, following]
    start = np.where(t[last] < begin - INSTANT, begin, t[last])
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = start + (here - band) / (here - there) * (t[following] - start)
    return last, np.where(following == last, np.inf, crossing)


def free_motion(
    motions: Motions, grid: Grid, *, parts: Cycles | None = None, signal: Signal | None = None
) -> FreeMotion:
    """Return what is left of a signal after each setpoint, in every corner.

    ``parts``: velocity cycles of a position cycle that are looked at first; None: all.
    ``signal``: comes to rest with the setpoint; None: the tool's deviation.
    """
    poles = motions.poles
    signal = signal or tool_deviation(poles.outputs - OUTPUTS)
    T, T_v, tau = poles.dt, poles.velocity_cycle, poles.delay
    parts = np.arange(poles.cycles) if parts is None else parts
    rows, steps, q = signal.row[None], motions.steps, motions.order
    end, t_e = motions.first[:, -1], steps.duration
    age = t_e[:, None] - steps.times
    v_end = np.sum(steps.steps * age ** (q - 1), axis=1) / factorial(q - 1)
    v_end[np.abs(v_end) < RESTING * np.max(np.abs(steps.steps) * age ** (q - 1), axis=1)] = 0.0
    coasting = poles.steady[..., 1] @ signal.row
    if signal.less == 0:
        coasting = coasting + tau - T_v * np.arange(poles.cycles)
    elif signal.less == 1:
        coasting = coasting - 1.0
    # From the last sample before t_e + τ on, which lies between two.
    m = np.arange(floor((tau - T - T_v) / T + 1e-9), poles.forced)
    setpoint = np.repeat(np.arange(len(end)), len(m))
    cycles = (end[:, None] + m).ravel()
    near = _transients(motions, setpoint, cycles, rows, parts, all_steps=True)
    near = near.reshape(len(end), len(m), -1, len(parts)).transpose(0, 2, 1, 3)
    near = near + (v_end[:, None, None] * coasting[:, parts])[:, :, None]
    e = near.reshape(len(end), near.shape[1], -1)
    instants = (T * m[:, None] + T_v * parts).ravel()
    if poles.factors.size:
        by_pole = grid.faded.transpose(1, 0, 2) * (signal.row @ poles.shapes)[:, grid.part]
        far = seen(motions.held[-1], by_pole)
        if np.any(v_end):
            far += v_end[:, None, None] * coasting[:, grid.part]
        instants = np.append(instants, T * (poles.forced + grid.cycle) + T_v * grid.part)
        e = np.concatenate([e, far], axis=2)
    until = t_e + tau
    own = until - end * T
    begin = np.searchsorted(instants, own - INSTANT)
    each, prior = np.arange(len(e)), np.maximum(begin - 1, 0)
    share = (own - instants[prior]) / np.maximum(instants[begin] - instants[prior], INSTANT)
    at_end = e[each, :, prior]
    at_end = at_end + share[:, None] * (e[each, :, begin] - at_end)
    np.abs(e, out=e)
    head = int(begin.max(initial=0))
    e[:, :, :head] *= np.arange(head) >= prior[:, None, None]
    e[each, :, prior] = np.abs(at_end)
    return FreeMotion(
        instants=instants,
        ended=np.asarray(end * T),
        until=until,
        begin=begin,
        deviation=e,
        motions=motions,
        offset=v_end[:, None, None] * coasting,
    )


def extremes(
    motions: Motions, grid: Grid, rows: Array, *, parts: Cycles, less: int | None = None
) -> Array:
    """Return the largest magnitudes of signals while setpoints move, and on until all has faded.

    ``rows``: over the outputs of a velocity cycle, all less the same derivative of the delayed
    setpoint, see ``Signal``; ``parts``: the velocity cycles of a position cycle that are looked at.
    Shape (n_setpoints, n_corners, n_rows).
    """
    poles, first, pieces = motions.poles, motions.first, _pieces(motions)
    count, steps = first.shape
    gaps = np.diff(first, axis=1, append=first[:, -1:] + poles.forced)
    begun = np.arange(poles.forced)
    later = np.linspace(0.0, 1.0, BETWEEN + 1)[1:]
    later = (np.maximum(gaps - 1, 0)[..., None] * later).astype(np.int64)
    ages = np.concatenate([np.broadcast_to(begun, (*gaps.shape, len(begun))), later], axis=2)
    own = np.concatenate([begun < gaps[..., None], later >= poles.forced], axis=2)
    setpoint, _, _ = np.nonzero(own)
    at = (first[:, :, None] + ages)[own]
    found = _outputs(motions, pieces, setpoint, at, rows, parts)
    if less is not None:
        t = at[:, None] * poles.dt + poles.velocity_cycle * parts - poles.delay
        wanted = _wanted(pieces, np.repeat(setpoint, len(parts)), t, less)
        found -= wanted[:, None, :, None]
    largest = np.zeros((count, len(poles.loops), len(rows)))
    each = np.abs(found).max(axis=2)
    begins = np.flatnonzero(np.diff(setpoint, prepend=-1))
    largest[setpoint[begins]] = np.maximum.reduceat(each, begins, axis=0)
    if poles.factors.size:
        gaps[:, -1] = poles.forced + grid.cycle[-1] + 1
        for part in (slice(0, steps - 1), slice(steps - 1, steps)):
            place, j = np.nonzero(gaps[:, part] > poles.forced)
            if len(place):
                j = j + (part.start or 0)
                _note_far(motions, pieces, grid, rows, largest, place, j, gaps, less)
    return largest


def _note_far(
    motions: Motions,
    pieces: Pieces,
    grid: Grid,
    signals: Array,
    largest: Array,
    own: Cycles,
    j: Cycles,
    gaps: Cycles,
    less: int | None,
) -> None:
    """Add what the poles alone tell of, from ``forced`` cycles after some steps to their next."""
    poles, q = motions.poles, motions.order
    left = gaps[own, j] - poles.forced
    used = int(np.searchsorted(grid.cycle, left.max()))
    cycle, part, R = grid.cycle[:used], grid.part[:used], len(signals)
    shapes = (signals @ poles.shapes)[:, part] * grid.faded[:used].transpose(1, 0, 2)[:, :, None]
    found = seen(motions.held[j, own], shapes.reshape(len(shapes), used * R, -1))
    at = motions.first[own, j, None] + poles.forced + cycle
    x = _sampled(pieces, np.repeat(own, used), np.asarray(at.ravel() * poles.dt), q + 1)
    steady = (signals @ poles.steady[..., : q + 1])[:, part]  # (n_corners, used, R, q + 1)
    found = found.reshape(len(own), -1, used, R)
    found += np.einsum("kst,ctrk->sctr", x.reshape(q + 1, *at.shape), steady, optimize=True)
    if less is not None:
        t = at * poles.dt + part * poles.velocity_cycle - poles.delay
        found -= _wanted(pieces, np.repeat(own, used), t, less)[:, None, :, None]
    np.abs(found, out=found)
    found *= (cycle < left[:, None])[:, None, :, None]
    np.maximum.at(largest, own, found.max(axis=2, initial=0.0))


def _wanted(pieces: Pieces, setpoint: Cycles, t: Array, derivative: int) -> Array:
    """A derivative of each setpoint at times of its own, shape of ``t``."""
    found = _sampled(pieces, setpoint, t.ravel(), derivative + 1)[derivative]
    return np.asarray(found.reshape(t.shape))


def _sampled(pieces: Pieces, setpoint: Cycles, t: Array, derivatives: int) -> Array:
    """Position and derivatives of each setpoint at a time of its own, (derivatives, n_times)."""
    knots, values = pieces.knots, pieces.values
    piece = np.sum(t >= knots[:, setpoint] - INSTANT, axis=0)
    age = t - knots[np.maximum(piece - 1, 0), setpoint]
    own = values[piece, :, setpoint].T
    found = np.zeros((derivatives, len(t)))
    for k in range(min(derivatives, len(own))):
        found[k] = taylor(own[k:], age)
    return found


def where_signals_lead(poles: LoopPoles, signals: Array) -> tuple[LoopPoles, Cycles]:
    """Return corners, and velocity cycles in a position cycle, in which signals swing furthest.

    Compared by moves of ``RAMPS``; a corner counts that comes within half a per cent.
    """
    return _find_leading(poles, signals.shape, signals.tobytes())


@lru_cache(maxsize=16)
def _find_leading(
    poles: LoopPoles, shape: tuple[int, ...], signal_bytes: bytes
) -> tuple[LoopPoles, Cycles]:
    """Once for all limits that are judged on a loop."""
    signals = np.frombuffer(signal_bytes).reshape(shape)
    t = np.array(RAMPS)
    steps = JerkSteps(
        times=np.column_stack([np.zeros_like(t), t, 1.5 * t, 2.5 * t]),
        steps=np.tile([1.0, -1.0, -1.0, 1.0], (len(t), 1)),
    )
    motions, grid = set_in_motion(poles, steps), lay_grid(poles, 12)
    each = [extremes(motions, grid, signals, parts=np.array([i])) for i in range(poles.cycles)]
    peaks = np.array(each)  # (cycles, n_setpoints, n_corners, n_signals)
    parts = np.unique(peaks.max(axis=2).argmax(axis=0))
    by_corner = peaks.max(axis=0)
    leads = by_corner >= LEADS * by_corner.max(axis=1, keepdims=True)
    return restrict(poles, np.flatnonzero(leads.any(axis=(0, 2))).tolist()), parts


RAMPS = (2e-3, 10e-3, 40e-3, 150e-3)
"""By which poles, corners and velocity cycles are compared [s]."""

LEADS = 0.995
"""A corner leads if it comes within this share of the worst [-]."""


def restrict(poles: LoopPoles, corners: Sequence[int]) -> LoopPoles:
    """Return the same in some corners only."""
    own = list(corners)
    return LoopPoles(
        loops=tuple(poles.loops[i] for i in own),
        forced=poles.forced,
        factors=poles.factors[own],
        shapes=poles.shapes[own],
        starts=poles.starts[:, own],
        table=poles.table[:, own],
        steady=poles.steady[own],
        powers=(poles.powers[0][:, own], poles.powers[1][:, own]),
    )
