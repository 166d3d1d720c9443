"""What a loop leaves of a signal after a move by its poles alone, at every phase of a step.

Dead times apart, the tool's deviation after the end t_e of steps w_i of the setpoint at t_i is

    e(s) = Re Σ_i w_i Σ_p P(φ_i) exp(p (t_e - t_i + s)),   s: since the end, from τ on

P: modal states that a step leaves, by the phase φ of a position cycle at which it falls. A setpoint
filter makes of each step several, so P of the filter holds them all, each at its own phase. A
change of velocity has four steps, at 0, the ramp, the rise and their sum. Within some per cent of
``loop.respond.free_motion``, at a tenth of the time: for searching, never to judge.

Source: derived here; held to ``loop.respond.free_motion`` by tests/test_respond.py.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import factorial, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.poles import LoopPoles, find_poles, once_for_rows
from mtcommission.loop.respond import RAMPS, swing_times
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.setpoint import INSTANT, JerkSteps, filter_steps

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Modal = NDArray[np.complex64]
Seen = NDArray[np.float32]

PHASES = 64
"""Of a position cycle, at the nearest of which a step is taken (empirical)."""

SAMPLES = 12
"""Instants to a period: the peak of a swing is missed by 3 % at most."""

SWINGS = 1.75
"""Periods of each pole for which free times are looked at densely (empirical)."""

LATER = 8
"""Free times between these and when the pole is gone (empirical)."""

CELLS = 100_000
"""Numbers that are looked at at once: keeps them in the cache."""

COUNTS = 0.03
"""A pole counts if ramps excite it to this share of the one that they excite most [-]."""

ROUNDING = 1e-9
"""Share to which a pole fades from τ until its states are taken, below which they are rounding
[-]."""

GONE = -1e6
"""Rate that stands for poles that a corner has not [1/s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Lapse:
    """Times, and what they leave of each pole; of both arrays the first axes broadcast."""

    time: Array  # [s]
    left: Modal  # exp(p t), shape (*time.shape, n_corners, n_poles)

    def __add__(self, other: Lapse) -> Lapse:
        return Lapse(self.time + other.time, self.left * other.left)


def lapse(rates: Complex, time: Array) -> Lapse:
    """Return some times [s] and what they leave of poles, (n_corners, n_poles) [1/s]."""
    return Lapse(time, np.exp(rates * time[..., None, None]).astype(np.complex64))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Residuals:
    """A loop in every corner, by the poles that ring on after a step of the setpoint."""

    rates: Complex  # (n_corners, n_poles) [1/s]
    ages: Lapse  # times that meet the swings of every pole that counts, from 0
    seen: Seen  # signals at ages by Re, Im of modal states, (n_corners, 2 n_poles, n)
    signals: int
    starts: Complex  # of -S_k at ``recent`` cycles after a step, (order + 1, n_corners, n_poles)
    since_step: Complex  # exp(-p t) from each phase to its sample, (PHASES + 1, n_corners, n_poles)
    cycle: float  # position cycle [s]

    def behind(self, item: SetpointFilter | None) -> Modal:
        """Return P of a filter: what a step of the jerk leaves at its end, by its phase.

        Shape (PHASES + 1, n_corners, n_poles): seen by a sample at once, ..., just missed by one.
        """
        one = JerkSteps(times=np.zeros((1, 1)), steps=np.ones((1, 1)))
        steps, q = filter_steps(one, item), 3 + (len(item.averages) if item else 0)
        early = np.linspace(0.0, self.cycle, PHASES + 1)[:, None, None]
        begun = [early**b / factorial(b) * self.starts[q - b] for b in range(q + 1)]
        left = np.sum(begun, axis=0) * self.since_step
        found, at = np.zeros_like(left), np.arange(PHASES + 1)
        for t, w in zip(steps.times[0], steps.steps[0], strict=True):
            later = at - self._phases(-t)
            faded = np.exp(self.rates * (steps.duration[0] - t))
            found += w * faded * left[np.where(later < 0, later + PHASES, later)]
        return np.asarray(found, dtype=np.complex64)

    def _phases(self, time: Array | float) -> NDArray[np.int64]:
        """How early before the next sample a step comes, in parts of a cycle."""
        cycles = np.asarray(time) / self.cycle
        early = np.ceil(cycles - INSTANT / self.cycle) - cycles
        return np.maximum(np.rint(PHASES * early), 0.0).astype(np.int64)

    def after(self, time: Array) -> Lapse:
        """Return some times [s] and what they leave."""
        return lapse(self.rates, time)

    def of_change(self, step: Modal, start: Lapse | None, ramp: Lapse, rise: Lapse) -> Modal:
        """Return modal states at the end of a change of velocity, per unit of its jerk.

        ``step``: from ``behind``; when it begins, None: with the setpoint; how long the jerk acts,
        and until the acceleration falls again.
        """
        begin = start.time if start else 0.0
        first = step[self._phases(begin)] * ramp.left - step[self._phases(begin + ramp.time)]
        falls = begin + rise.time
        last = step[self._phases(falls)] * ramp.left - step[self._phases(falls + ramp.time)]
        return np.asarray(first * rise.left - last)

    def of_pair(self, step: Modal, brake: Lapse, ramp: Lapse, rise: Lapse) -> Modal:
        """Return the same of two changes, the second one back to rest from ``brake`` on."""
        first = self.of_change(step, None, ramp, rise)
        return np.asarray(first * brake.left - self.of_change(step, brake, ramp, rise))

    def largest(self, modal: Modal) -> Array:
        """Return what is left of each signal, worst corner, shape (n_setpoints, n_signals).

        ``modal``: of each at the end of its setpoint, (n_setpoints, n_corners, n_poles).
        """
        both = np.concatenate([modal.real, modal.imag], axis=2)
        largest = np.empty((len(modal), self.signals))
        together = max(CELLS // (len(self.seen) * self.seen.shape[2]), 1)
        for start in range(0, len(modal), together):
            found = both[start : start + together].transpose(1, 0, 2) @ self.seen
            np.abs(found, out=found)
            found = found.reshape(*found.shape[:2], self.signals, -1)
            largest[start : start + together] = found.max(axis=3).max(axis=0)
        return largest

    def of_moves(self, step: Modal, steps: JerkSteps) -> Array:
        """Return the same of moves, from ``jerk_steps``; ``step``: from ``behind``."""
        ramp, rise = self.after(steps.times[:, 1]), self.after(steps.times[:, 2])
        if steps.times.shape[1] > 4:
            modal = self.of_pair(step, self.after(steps.times[:, 4]), ramp, rise)
        else:
            modal = self.of_change(step, None, ramp, rise)
        return np.asarray(steps.steps[:, :1] * self.largest(modal))


@once_for_rows
def find_residuals(poles: LoopPoles, rows: Array) -> Residuals:
    """Return what a loop leaves of signals that come to rest with the setpoint.

    ``rows``: over the outputs of a velocity cycle.
    """
    if not poles.factors.size:  # equal poles: a little apart they are as good here
        poles = find_poles.__wrapped__(tuple(map(_nudge, poles.loops)))
    T, missing = poles.dt, np.abs(poles.factors) == 0.0
    rates = np.where(missing, GONE, poles.rates)
    early = np.linspace(0.0, T, PHASES + 1)[:, None, None]
    age = np.where(missing, 0.0, rates) * early
    ages = _lay_ages(poles)
    # The modal states are those ``recent`` cycles after the first sample that sees a step.
    s = poles.delay + ages - poles.recent * T
    is_gone = np.exp(rates.real * (poles.recent * T - poles.delay)) < ROUNDING
    signals = (rows @ poles.shapes[:, 0]).swapaxes(1, 2)
    each = signals[..., None] * np.exp(np.where(missing, 0.0, rates)[..., None] * s)[:, :, None]
    each = each.reshape(*rates.shape, -1)
    seen = np.concatenate([each.real, -each.imag], axis=1).astype(np.float32)
    return Residuals(
        rates=rates,
        ages=lapse(rates, ages),
        seen=seen,
        signals=len(rows),
        starts=np.where(is_gone, 0.0, poles.starts),
        since_step=np.exp(-age),
        cycle=T,
    )


def _counting_poles(poles: LoopPoles) -> Complex:
    """Return the nominal poles that ramps excite at the tool, in the continuous plane [1/s]."""
    p = poles.rates[0]
    sizes = np.abs(poles.shapes[0, :, 0]).max(axis=0) * np.abs(poles.starts[3, 0])
    there = np.flatnonzero(sizes > 0.0)
    excited = [sizes[there] * np.minimum(np.abs(p[there]) * t, 2.0) ** 2 for t in RAMPS]
    counts = np.any([each >= COUNTS * each.max(initial=0.0) for each in excited], axis=0)
    return np.asarray(p[there[counts]])


def _lay_ages(poles: LoopPoles) -> Array:
    """Free times that meet the swings of every pole of the nominal loop that counts."""
    found, gone = [np.zeros(1)], 1e-3
    for pole in _counting_poles(poles):
        dense, fades = swing_times(pole, SWINGS)
        found.append(np.arange(0.0, dense, 2.0 * pi / abs(pole) / SAMPLES))
        found.append(np.geomspace(dense, max(fades, 1.01 * dense), LATER + 1))
        gone = max(gone, fades)
    ages = np.unique(np.concatenate(found))
    finest = np.min(np.diff(ages[:2])) if len(ages) > 1 else gone
    return np.asarray(ages[np.append(True, np.diff(ages) > 0.3 * finest)])


NUDGE = 1e-7
"""Relative change of the loop that separates equal poles: they come 3e-4 apart (empirical)."""


def _nudge(loop: SampledLoop) -> SampledLoop:
    pattern = 1.0 + NUDGE * np.arange(loop.step.size).reshape(loop.step.shape) / loop.step.size
    return replace(loop, step=loop.step * pattern)
