"""What setpoints do to a loop by its poles: any signal at any cycle, the largest, what is left.

Axes of arrays as in ``loop.poles``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, factorial, floor, log, pi

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from mtcommission.loop.poles import LoopPoles, once_for_rows, restrict
from mtcommission.setpoint.setpoint import INSTANT, JerkSteps, Pieces, cut

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycles = NDArray[np.int64]


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
class Motions:
    """Setpoints on a loop: steps in rising order, and the modal states that they leave."""

    poles: LoopPoles
    steps: JerkSteps
    first: Cycles  # sample at which each step is seen first, (n_setpoints, n_steps)
    basis: Array  # weights of -S_q, -S_(q-1), ... at that sample, (n_setpoints, n_steps, q + 1)
    modal: Complex
    """Modal states by all steps up to each, ``recent`` cycles after its first sample, (n_steps,
    n_setpoints, n_corners, n_poles)."""

    @property
    def pieces(self) -> Pieces:
        """The setpoints as polynomials between their steps."""
        return cut(self.steps.times, self.steps.steps, order=self.steps.order)


def set_in_motion(poles: LoopPoles, steps: JerkSteps) -> Motions:
    """Return setpoints on a loop, ready to be asked for outputs."""
    rising = np.argsort(steps.times, axis=1, kind="stable")
    times = np.take_along_axis(steps.times, rising, axis=1)
    sizes = np.take_along_axis(steps.steps, rising, axis=1)
    q = steps.order
    first = np.ceil((times - INSTANT) / poles.dt).astype(np.int64)
    basis = _basis(sizes, first * poles.dt - times, q)
    starts = poles.starts[q::-1].reshape(q + 1, -1)  # by the power of s
    modal = (basis.swapaxes(0, 1).reshape(-1, q + 1) @ starts).reshape(
        *sizes.shape[::-1], *poles.factors.shape
    )
    faded = poles.power(np.diff(first, axis=1))
    for j in range(1, len(modal)):
        modal[j] += modal[j - 1] * faded[:, j - 1]
    own = JerkSteps(times=times, steps=sizes, order=q)
    return Motions(poles=poles, steps=own, first=first, basis=basis, modal=modal)


def _basis(sizes: Array, early: Array, order: int) -> Array:
    """Weights of -S_q, -S_(q-1), ... a time after steps of some sizes."""
    basis = np.empty((*sizes.shape, order + 1))
    basis[..., 0] = sizes
    for b in range(1, order + 1):
        basis[..., b] = basis[..., b - 1] * early / b
    return basis


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class View:
    """A loop as some signals see it in some velocity cycles of a position cycle.

    What is seen stands in the order (n_corners, n_parts, n_rows).
    """

    table: Array  # by cycles since a step and power of s, ((q + 1) recent, n_seen)
    shapes: Array  # by Re and Im of modal states, (n_corners, 2 n_poles, n_parts n_rows)
    steady: Array  # by derivative of the setpoint, (q + 1, n_seen)


@once_for_rows
def _look(poles: LoopPoles, rows: Array, parts: tuple[int, ...], order: int) -> View:
    own = list(parts)
    table = rows @ poles.table[:, :, own, :, order::-1]
    steady = (rows @ poles.steady[:, own, :, : order + 1]).reshape(-1, order + 1).T
    return View(
        table=np.moveaxis(table, -1, 1).reshape((order + 1) * poles.recent, -1),
        shapes=_by_parts(rows @ poles.shapes[:, own]),
        steady=np.ascontiguousarray(steady),
    )


def _by_parts(shapes: Complex) -> Array:
    """Signals by pole, (n_corners, n_parts, n_rows, n_poles), by Re and Im of modal states."""
    flat = shapes.reshape(len(shapes), shapes.shape[1] * shapes.shape[2], shapes.shape[3])
    parts = np.concatenate([flat.real, -flat.imag], axis=2)
    return np.ascontiguousarray(parts.transpose(0, 2, 1))


def _seen(state: Complex, shapes: Array, *, out: Array | None = None) -> Array:
    """Signals of modal states, (n_corners, n, n_seen); ``shapes`` from ``_by_parts``."""
    parts = np.concatenate([state.real, state.imag], axis=2).transpose(1, 0, 2)
    return np.asarray(np.matmul(parts, shapes, out=out))


def outputs_at(
    motions: Motions,
    n: Cycles,
    rows: Array,
    *,
    parts: Cycles | None = None,
    less: int | None = None,
) -> Array:
    """Return signals in some position cycles of each setpoint.

    ``n``: shape (n_setpoints, n_times); ``rows``: over the outputs of a velocity cycle, shape
    (n_rows, n_outputs), less the same derivative of the delayed setpoint, see ``Signal``;
    ``parts``: which velocity cycles, None: all. Result: (n_setpoints, n_corners, n_times, n_parts,
    n_rows).
    """
    setpoint = np.repeat(np.arange(len(n)), n.shape[1])
    own = np.arange(motions.poles.cycles) if parts is None else parts
    found = _signals_at(
        motions, motions.pieces, setpoint, n.ravel(), np.atleast_2d(rows), own, less
    )
    return np.moveaxis(found.reshape(*n.shape, *found.shape[1:]), 2, 1)


def _signals_at(
    motions: Motions,
    pieces: Pieces,
    setpoint: Cycles,
    n: Cycles,
    rows: Array,
    parts: Cycles,
    less: int | None,
) -> Array:
    """Signals of some setpoints at some cycles, (n_times, n_corners, n_parts, n_rows)."""
    q, t = motions.steps.order, np.asarray(n * motions.poles.dt)
    x = pieces.sample(t, derivatives=q + 1, setpoint=setpoint)
    view = _look(motions.poles, rows, tuple(parts.tolist()), q)
    age = n[:, None] - motions.first[setpoint]
    found = _transients(motions, view, setpoint, age, age >= 0) + x.T @ view.steady
    found = found.reshape(len(n), len(motions.poles.loops), len(parts), -1)
    if less is not None:
        seen = t[:, None] + motions.poles.velocity_cycle * parts - motions.poles.delay
        wanted = _wanted(pieces, np.repeat(setpoint, len(parts)), seen, less)
        found -= wanted[:, None, :, None]
    return np.asarray(found)


def _transients(
    motions: Motions, view: View, setpoint: Cycles, age: Cycles, counts: NDArray[np.bool_]
) -> Array:
    """What the loop has beside its polynomial, (n_times, n_seen).

    ``age``: cycles since each step, (n_times, n_steps), of some setpoints; ``counts``: which of
    them. Those to come are continued backwards.
    """
    poles, q = motions.poles, motions.steps.order
    # The steps that the table tells of, ...
    is_near = counts & (age < poles.recent)
    time, step = np.nonzero(is_near)
    since, basis = age[time, step], motions.basis[setpoint[time], step]
    to_come = np.flatnonzero(since < 0)
    if len(to_come):
        place = setpoint[time[to_come]], step[to_come]
        early = (since[to_come] + motions.first[place]) * poles.dt - motions.steps.times[place]
        basis[to_come] = _basis(motions.steps.steps[place], early, q)
    column = (q + 1) * np.maximum(since, 0)[:, None] + np.arange(q + 1)
    ends = (q + 1) * np.append(0, np.cumsum(is_near.sum(axis=1)))
    weights = csr_array(
        (basis.ravel(), column.ravel(), ends), shape=(len(age), (q + 1) * poles.recent)
    )
    found = np.asarray(weights @ view.table)
    # ... and those that the poles tell of, up to the last one.
    last = np.sum(age >= poles.recent, axis=1) - 1
    far = np.flatnonzero(last >= 0)
    if poles.factors.size and len(far):
        last = last[far]
        state = motions.modal[last, setpoint[far]] * poles.power(age[far, last] - poles.recent)
        found[far] += _seen(state, view.shapes).transpose(1, 0, 2).reshape(len(far), -1)
    return found


def _wanted(pieces: Pieces, setpoint: Cycles, t: Array, derivative: int) -> Array:
    """A derivative of each setpoint at times of its own, shape of ``t``."""
    found = pieces.sample(t.ravel(), derivatives=derivative + 1, setpoint=setpoint)[derivative]
    return np.asarray(found.reshape(t.shape))


FADED = 1e-3
"""Share to which a pole has decayed where its swings need no samples any more [-]."""

SWINGS, LATER = 2.5, 40
"""Periods of a pole that are looked at densely; instants after them, at most (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Velocity cycles at which free motion is looked at, from ``recent`` cycles after a step."""

    cycle: Cycles  # position cycles since then, shape (n_instants,)
    part: Cycles  # velocity cycle within it
    faded: Complex  # λ^cycle, (n_instants, n_corners, n_poles)


def swing_times(pole: complex, periods: float) -> tuple[float, float]:
    """Return until when so many periods of a pole [1/s] have passed, and when it is gone [s]."""
    gone = log(1.0 / FADED) / max(-pole.real, 1e-9)
    return min(periods * 2.0 * pi / abs(pole), gone), gone


@lru_cache(maxsize=32)
def lay_grid(poles: LoopPoles, samples: float) -> Grid:
    """Return instants, so many to a period of each nominal pole at first, then ever fewer.

    Bounded by the number of poles, however slowly they decay: swings of one pole only become
    smaller, and those of several are met at ever other phases of each other.
    """
    found = [np.zeros(1)]
    for pole in poles.rates[0][np.abs(poles.factors[0]) > 0.0]:
        dense, gone = swing_times(pole, SWINGS)
        found.append(np.arange(0.0, dense, 2.0 * pi / abs(pole) / samples))
        if gone > dense:
            count = min(ceil(log(gone / dense) * samples / 2.0), LATER)
            found.append(np.geomspace(dense, gone, count + 1))
    at = np.unique(np.round(np.concatenate(found) / poles.velocity_cycle).astype(np.int64))
    cycle, part = np.divmod(at, poles.cycles)
    return Grid(cycle=cycle, part=part, faded=poles.power(cycle))


def every_part(poles: LoopPoles, samples: float) -> Grid:
    """Return the position cycles of that grid with each of their velocity cycles.

    A force has ripple within a position cycle, whose top a sparser grid misses.
    """
    cycles = np.unique(lay_grid(poles, samples).cycle)
    cycle, part = np.repeat(cycles, poles.cycles), np.tile(np.arange(poles.cycles), len(cycles))
    return Grid(cycle=cycle, part=part, faded=poles.power(cycle))


@once_for_rows
def _shapes_on(poles: LoopPoles, rows: Array, grid: Grid) -> Array:
    """Signals on a grid by Re and Im of modal states, rows last, see ``_by_parts``."""
    by_pole = (rows @ poles.shapes)[:, grid.part]
    return _by_parts(by_pole * grid.faded.transpose(1, 0, 2)[:, :, None])


RESTING = 1e-12
"""Final velocity, as a share of what single steps add, that is rounding alone [-]."""

BACKWARDS = np.unique(np.append(np.arange(-1, 13), np.geomspace(13, 1e4, 40).round()))[::-1]
"""Position cycles before the envelope enters the band, at which its last swings are looked at."""

BISECTIONS = 40
"""Halvings of the time until an envelope enters the band: to 1e-12 of it."""

TOGETHER = 500
"""Setpoints and corners whose last swings are looked at at once."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FreeMotion:
    """A signal's magnitude from t_e + τ on; before it 0, just before it that at t_e + τ itself.

    The tool's deviation e where no other one is asked for: of that alone there is a settling time.
    """

    instants: Array  # since the position cycle in which the setpoint has ended, (n_instants,) [s]
    ended: Array  # that cycle, (n_setpoints,) [s]
    until: Array  # t_e + τ, (n_setpoints,) [s]
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
        modal, shapes = self.motions.modal[-1, row, corner], poles.shapes[corner, :, 0]
        p = np.maximum(poles.rates.real, -1e3 / poles.dt) + 1j * poles.rates.imag
        p = poles.dt * p[corner]
        sizes, left = np.abs(modal) * np.abs(shapes).max(axis=1), band - np.abs(offset).max(axis=1)
        low = np.zeros(len(row))
        with np.errstate(divide="ignore", invalid="ignore"):
            high = np.log(sizes.sum(axis=1) / left) / -p.real.max(axis=1)
        is_seen = np.isfinite(high) & (high > 0.0)
        high = np.where(is_seen, high, 0.0)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            is_out = (sizes * np.exp(p.real * middle[:, None])).sum(axis=1) > left
            low, high = np.where(is_out, middle, low), np.where(is_out, high, middle)
        begin, each = np.ceil(high), np.arange(len(row))
        for _ in range(2):  # and once more, densely behind the last one that is outside
            age = begin[:, None] - BACKWARDS
            state = modal[:, None] * np.exp(p[:, None] * np.maximum(age, 0.0)[..., None])
            e = np.abs((state @ shapes.transpose(0, 2, 1)).real + offset[:, None])
            e[age < 0.0] = 0.0
            e = e.reshape(len(e), -1)
            last = e.shape[1] - 1 - np.argmax((e > band)[:, ::-1], axis=1)
            last = np.minimum(last, e.shape[1] - 2)
            begin = age[each, (last + 1) // poles.cycles]
        t = poles.dt * (poles.recent + age)[..., None]
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


def free_motion(motions: Motions, grid: Grid, *, signal: Signal | None = None) -> FreeMotion:
    """Return what is left of a signal after each setpoint, in every corner.

    ``signal``: comes to rest with the setpoint; None: the tool's deviation.
    """
    poles, steps, q = motions.poles, motions.steps, motions.steps.order
    signal = signal or tool_deviation(poles.outputs - OUTPUTS)
    T, T_v, tau, parts = poles.dt, poles.velocity_cycle, poles.delay, np.arange(poles.cycles)
    rows, end, t_e = signal.row[None], motions.first[:, -1], steps.duration
    age = t_e[:, None] - steps.times
    v_end = np.sum(steps.steps * age ** (q - 1), axis=1) / factorial(q - 1)
    v_end[np.abs(v_end) < RESTING * np.max(np.abs(steps.steps) * age ** (q - 1), axis=1)] = 0.0
    coasting = poles.steady[..., 1] @ signal.row
    if signal.less == 0:
        coasting = coasting + tau - T_v * parts
    elif signal.less == 1:
        coasting = coasting - 1.0
    # From the last sample before t_e + τ on, which lies between two.
    m = np.arange(floor((tau - T - T_v) / T + 1e-9), poles.recent)
    setpoint, cycles = np.repeat(np.arange(len(end)), len(m)), (end[:, None] + m).ravel()
    since = cycles[:, None] - motions.first[setpoint]
    view = _look(poles, rows, tuple(parts.tolist()), q)
    near = _transients(motions, view, setpoint, since, np.ones_like(since, dtype=bool))
    near = near.reshape(len(end), len(m), -1, len(parts)).transpose(2, 0, 1, 3)
    instants, part = (T * m[:, None] + T_v * parts).ravel(), np.tile(parts, len(m))
    known = len(instants)
    if poles.factors.size:
        instants = np.append(instants, T * (poles.recent + grid.cycle) + T_v * grid.part)
        part = np.append(part, grid.part)
    by_corner = np.empty((len(near), len(end), len(instants)))
    by_corner[:, :, :known] = near.reshape(len(near), len(end), known)
    if poles.factors.size:
        _seen(motions.modal[-1], _shapes_on(poles, rows, grid), out=by_corner[:, :, known:])
    e = by_corner.transpose(1, 0, 2)
    if np.any(v_end):
        e += v_end[:, None, None] * coasting[:, part]
    until = t_e + tau
    keep_from(instants, e, until - end * T)
    return FreeMotion(
        instants=instants,
        ended=np.asarray(end * T),
        until=until,
        deviation=e,
        motions=motions,
        offset=v_end[:, None, None] * coasting,
    )


def keep_from(instants: Array, e: Array, begin: Array) -> None:
    """Turn signals into their magnitudes from the beginning of free motion on, in place.

    ``instants``: shape (n,) [s]; ``e``: by what coasts or rests after it, shape (n_setpoints,
    n_corners, n); ``begin``: of each setpoint [s]. What comes before is 0; the instant just before
    it stands for ``begin`` itself, interpolated.
    """
    first, each = np.searchsorted(instants, begin - INSTANT), np.arange(len(e))
    prior = np.maximum(first - 1, 0)
    share = (begin - instants[prior]) / np.maximum(instants[first] - instants[prior], INSTANT)
    at_begin = e[each, :, prior]
    at_begin = at_begin + share[:, None] * (e[each, :, first] - at_begin)
    np.abs(e, out=e)
    head = int(first.max(initial=0))
    e[:, :, :head] *= np.arange(head) >= prior[:, None, None]
    e[each, :, prior] = np.abs(at_begin)


BETWEEN = 6
"""Cycles looked at between two far steps besides those near them: a polynomial has few extremes."""


def extremes(
    motions: Motions, grid: Grid, rows: Array, *, parts: Cycles, less: int | None = None
) -> Array:
    """Return the largest magnitudes of signals while setpoints move, and on until all has faded.

    ``rows``: over the outputs of a velocity cycle, all less the same derivative of the delayed
    setpoint, see ``Signal``; ``parts``: the velocity cycles of a position cycle that are looked at.
    Shape (n_setpoints, n_corners, n_rows).
    """
    pieces = motions.pieces
    near = _near_steps(motions, pieces, rows, parts, less).max(axis=2)
    return np.asarray(np.maximum(near, _far_from_steps(motions, pieces, grid, rows, less)))


def _near_steps(
    motions: Motions, pieces: Pieces, rows: Array, parts: Cycles, less: int | None
) -> Array:
    """Largest in the cycles after each step, and in some until the next one.

    Shape (n_setpoints, n_corners, n_parts, n_rows).
    """
    poles, first = motions.poles, motions.first
    gaps = np.diff(first, axis=1, append=first[:, -1:] + poles.recent)
    begun = np.arange(poles.recent)
    later = np.linspace(0.0, 1.0, BETWEEN + 1)[1:]
    later = (np.maximum(gaps - 1, 0)[..., None] * later).astype(np.int64)
    ages = np.concatenate([np.broadcast_to(begun, (*gaps.shape, len(begun))), later], axis=2)
    own = np.concatenate([begun < gaps[..., None], later >= poles.recent], axis=2)
    setpoint, _, _ = np.nonzero(own)
    at = (first[:, :, None] + ages)[own]
    found = _signals_at(motions, pieces, setpoint, at, rows, parts, less)
    largest = np.zeros((len(first), *found.shape[1:]))
    begins = np.flatnonzero(np.diff(setpoint, prepend=-1))
    largest[setpoint[begins]] = np.maximum.reduceat(np.abs(found), begins, axis=0)
    return largest


def _far_from_steps(
    motions: Motions, pieces: Pieces, grid: Grid, rows: Array, less: int | None
) -> Array:
    """Largest of what the poles alone tell of, from ``recent`` cycles after steps to their next.

    At the instants of the grid, in any velocity cycle; shape (n_setpoints, n_corners, n_rows).
    """
    poles, first, q, R = motions.poles, motions.first, motions.steps.order, len(rows)
    largest = np.zeros((len(first), len(poles.loops), R))
    if not poles.factors.size:
        return largest
    shapes = _shapes_on(poles, rows, grid)
    steady = (rows @ poles.steady[..., : q + 1])[:, grid.part]
    steady = steady.transpose(1, 3, 0, 2).reshape(len(grid.part), q + 1, -1)
    gaps = np.diff(first, axis=1, append=first[:, -1:] + poles.recent + grid.cycle[-1] + 1)
    is_last = np.arange(gaps.shape[1]) == gaps.shape[1] - 1
    for alike in (~is_last, is_last):  # the last one is followed far longer than the others
        own, j = np.nonzero((gaps > poles.recent) & alike)
        if not len(own):
            continue
        left = gaps[own, j] - poles.recent
        used = int(np.searchsorted(grid.cycle, left.max()))
        cycle, part = grid.cycle[:used], grid.part[:used]
        found = _seen(motions.modal[j, own], shapes[:, :, : used * R]).transpose(1, 0, 2)
        found = found.reshape(len(own), -1, used, R)
        at, setpoint = first[own, j, None] + poles.recent + cycle, np.repeat(own, used)
        sampled = np.asarray(at.ravel() * poles.dt)
        x = pieces.sample(sampled, derivatives=q + 1, setpoint=setpoint)
        x = x.reshape(q + 1, *at.shape).transpose(2, 1, 0)
        found += (x @ steady[:used]).reshape(used, len(own), -1, R).transpose(1, 2, 0, 3)
        if less is not None:
            t = at * poles.dt + part * poles.velocity_cycle - poles.delay
            found -= _wanted(pieces, setpoint, t, less)[:, None, :, None]
        np.abs(found, out=found)
        found *= (cycle < left[:, None])[:, None, :, None]
        np.maximum.at(largest, own, found.max(axis=2, initial=0.0))
    return largest


RAMPS = (2e-3, 10e-3, 40e-3, 150e-3)
"""By which poles, corners and velocity cycles are compared [s]."""

SAMPLES = 12
"""Instants to a period at which these moves are compared (empirical)."""

LEADS = 0.995
"""A corner leads if it comes within this share of the worst [-]."""


@once_for_rows
def where_signals_lead(poles: LoopPoles, signals: Array) -> tuple[LoopPoles, Cycles]:
    """Return corners, and velocity cycles in a position cycle, in which signals swing furthest.

    Compared by moves of ``RAMPS``; a corner counts that comes within half a per cent.
    """
    t = np.array(RAMPS)
    steps = JerkSteps(
        times=np.column_stack([np.zeros_like(t), t, 1.5 * t, 2.5 * t]),
        steps=np.tile([1.0, -1.0, -1.0, 1.0], (len(t), 1)),
    )
    motions = set_in_motion(poles, steps)
    pieces, grid = motions.pieces, lay_grid(poles, SAMPLES)
    near = _near_steps(motions, pieces, signals, np.arange(poles.cycles), None)
    far = _far_from_steps(motions, pieces, grid, signals, None)
    peaks = np.maximum(near, far[:, :, None])  # (n_setpoints, n_corners, cycles, n_signals)
    parts = np.unique(peaks.max(axis=1).argmax(axis=1))
    by_corner = peaks.max(axis=2)
    leads = by_corner >= LEADS * by_corner.max(axis=1, keepdims=True)
    return restrict(poles, np.flatnonzero(leads.any(axis=(0, 2))).tolist()), parts
