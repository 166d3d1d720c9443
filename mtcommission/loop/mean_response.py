"""What a loop leaves of a signal after a move, averaged over the phases of a position cycle.

A step of the jerk falls anywhere within a position cycle. Averaged over these phases, and dead
times apart, the tool's deviation after the end of a jerk-limited move behind a filter is from τ on

    e(s) = j Re Σ_p c_p G(p) F(p) exp(p s),   s: since the end of the setpoint

G(p) = (e^(p t₁) - 1) (e^(p t₂) - 1) (e^(p t₃) - 1) with t₁ the ramp of the acceleration, t₂ from
its rise to its fall, t₃ from the start to the braking (a velocity step lacks the last one); F(p):
the same of the filter's own steps. Within 0.1 % of ``loop.respond.free_motion`` on the ball
screw (1 ms), within some per cent where cycles are long against what rings, at a tenth of the time:
for searching, never to judge.

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
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PHASES = 8
"""Of a step within a position cycle, over which the mean is taken (empirical: 64 of them change it
by 0.03 % at most)."""

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

GONE = -1e6
"""Rate that stands for poles that a corner has not [1/s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeanResponse:
    """A loop in every corner, by the poles that ring on after a jerk step."""

    rates: Complex  # (n_corners, n_poles) [1/s]
    ages: Array  # times that meet the swings of every pole that counts, from 0 [s]
    seen: NDArray[
        np.float32
    ]  # signals at ages by Re, Im of modal states, (n_corners, 2 n_poles, n)
    signals: int

    def behind(self, item: SetpointFilter | None) -> Complex:
        """Return F of a filter, shape (n_corners, n_poles)."""
        one = JerkSteps(times=np.zeros((1, 1)), steps=np.ones((1, 1)))
        steps = filter_steps(one, item)
        age = steps.duration[:, None] - steps.times
        total = (steps.steps[..., None, None] * np.exp(self.rates * age[..., None, None])).sum(1)
        return np.asarray(total[0] / self.rates ** (steps.order - one.order))

    def since(self, time: Array | float) -> Complex:
        """Return exp(p t), shape (n_times, n_corners, n_poles)."""
        return np.asarray(np.exp(self.rates * np.atleast_1d(time)[:, None, None]))

    def largest(self, modal: Complex) -> Array:
        """Return what is left of each signal, worst corner, shape (n_setpoints, n_signals).

        ``modal``: G F of each at the end of its setpoint, (n_setpoints, n_corners, n_poles).
        """
        both = np.concatenate([modal.real, modal.imag], axis=2).astype(np.float32)
        largest = np.empty((len(modal), self.signals))
        together = max(CELLS // (len(self.seen) * self.seen.shape[2]), 1)
        for start in range(0, len(modal), together):
            found = both[start : start + together].transpose(1, 0, 2) @ self.seen
            np.abs(found, out=found)
            found = found.reshape(*found.shape[:2], self.signals, -1)
            largest[start : start + together] = found.max(axis=3).max(axis=0)
        return largest

    def residual(self, steps: JerkSteps, behind: Complex) -> Array:
        """Return the same of moves, from ``jerk_steps``, with F of the filter."""
        times, jerk = steps.times, steps.steps[:, 0]
        modal = behind * (self.since(times[:, 1]) - 1.0) * (self.since(times[:, 2]) - 1.0)
        if times.shape[1] > 4:
            modal = modal * (self.since(times[:, 4]) - 1.0)
        return np.asarray(jerk[:, None] * self.largest(modal))


@once_for_rows
def average_phases(poles: LoopPoles, rows: Array) -> MeanResponse:
    """Return the response of a loop averaged over the phases of its position cycle.

    ``rows``: of signals that come to rest with the setpoint, over the outputs of a velocity cycle.
    """
    if not poles.factors.size:  # equal poles: a little apart they are as good here
        poles = find_poles.__wrapped__(tuple(map(_nudge, poles.loops)))
    T, missing = poles.dt, np.abs(poles.factors) == 0.0
    rates = np.where(missing, GONE, poles.rates)
    early = (np.arange(PHASES) + 0.5)[:, None, None] / PHASES * T
    # The step comes ``early`` before its first sample.
    begun = sum(early**b / factorial(b) * poles.starts[3 - b] for b in range(4))
    age = np.where(missing, 0.0, rates) * early
    c = np.where(missing, 0.0, (begun * np.exp(-age)).mean(axis=0))
    ages = _lay_ages(poles)
    # The modal states are those ``recent`` cycles after that sample.
    s = poles.delay + ages - poles.recent * T
    signals = (rows @ poles.shapes[:, 0]).swapaxes(1, 2) * c[..., None]
    each = signals[..., None] * np.exp(np.where(missing, 0.0, rates)[..., None] * s)[:, :, None]
    each = each.reshape(*rates.shape, -1)
    seen = np.concatenate([each.real, -each.imag], axis=1).astype(np.float32)
    return MeanResponse(rates=rates, ages=ages, seen=seen, signals=len(rows))


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
