"""What is left of a signal after setpoints: how much, and until when."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, factorial, floor, log, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.motions import (
    OUTPUTS,
    Motions,
    Signal,
    by_parts,
    seen,
    tool_deviation,
    transients,
)
from mtcommission.loop.poles import LoopPoles, once_for_rows
from mtcommission.setpoint.pieces import INSTANT

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycles = NDArray[np.int64]

FADED = 1e-3
"""Share to which a pole has decayed where its swings need no samples any more [-]."""

SWINGS, LATER = 2.5, 40
"""Periods of a pole that are looked at densely; instants after them, at most (empirical)."""

RESTING = 1e-12
"""Final velocity, as a share of what single steps add, that is rounding alone [-]."""

BACKWARDS = np.unique(np.append(np.arange(-1, 13), np.geomspace(13, 1e4, 40).round()))[::-1]
"""Position cycles before the envelope enters the band, at which its last swings are looked at."""

BISECTIONS = 40
"""Halvings of the time until an envelope enters the band: to 1e-12 of it."""

TOGETHER = 500
"""Setpoints and corners whose last swings are looked at at once."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Velocity cycles at which free motion is looked at, from ``recent`` cycles after a step."""

    cycle: Cycles  # position cycles since then, shape (n_instants,)
    part: Cycles  # velocity cycle within it
    faded: Complex  # λ^cycle, (n_instants, n_corners, n_poles)


def swing_times(pole: complex, periods: float) -> tuple[float, float]:
    """Return until when the swings of a pole [1/s] are looked at densely, and when it is gone [s].

    Densely for so many periods.
    """
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


@once_for_rows
def shapes_on(poles: LoopPoles, rows: Array, grid: Grid) -> Array:
    """Return signals on a grid by Re and Im of modal states, rows last, see ``by_parts``."""
    seen_by_pole = (rows @ poles.shapes)[:, grid.part]
    return by_parts(seen_by_pole * grid.faded.transpose(1, 0, 2)[:, :, None])


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
    m = np.arange(floor((tau - T - T_v) / T + 1e-9), poles.recent)
    setpoint = np.repeat(np.arange(len(end)), len(m))
    cycles = (end[:, None] + m).ravel()
    near = transients(motions, setpoint, cycles, rows, parts, all_steps=True)
    near = near.reshape(len(end), len(m), -1, len(parts)).transpose(2, 0, 1, 3)
    instants, part = (T * m[:, None] + T_v * parts).ravel(), np.tile(parts, len(m))
    if poles.factors.size:
        instants = np.append(instants, T * (poles.recent + grid.cycle) + T_v * grid.part)
        part = np.append(part, grid.part)
    by_corner = np.empty((len(near), len(end), len(instants)))
    known = len(m) * len(parts)
    by_corner[:, :, :known] = near.reshape(len(near), len(end), known)
    if poles.factors.size:
        seen(motions.modal[-1], shapes_on(poles, rows, grid), out=by_corner[:, :, known:])
    e = by_corner.transpose(1, 0, 2)
    if np.any(v_end):
        e += v_end[:, None, None] * coasting[:, part]
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
