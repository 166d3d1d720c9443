"""What a loop leaves of the tool's deviation after a move, averaged over the phases of a cycle.

A step of the jerk falls anywhere within a position cycle. Averaged over these phases, and dead
times apart, the tool after the end of a jerk-limited move behind a filter is, from τ on,

    e(s) = j Re Σ_p c_p G(p) F(p) exp(p s),   s: since the end of the setpoint

G(p) = (e^(p t₁) - 1) (e^(p t₂) - 1) (e^(p t₃) - 1) with t₁ the ramp of the acceleration, t₂ from
its rise to its fall, t₃ from the start to the braking (a velocity step lacks the last one); F(p):
the same of the filter's own steps. Within 0.1 % of ``loop.respond`` where cycles are short against
what rings, within some per cent elsewhere, at a tenth of the time: for searching, never to judge.

Source: derived here; held to ``loop.respond`` by tests/test_mean_response.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.respond import LoopPoles, free_motion, lay_grid, set_in_motion
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PHASES = 8
"""Of a step within a position cycle, over which the mean is taken (exact to 1e-6 at πT/2 each)."""

SAMPLES = 12
"""Instants to a period: the peak of a swing is missed by 3 % at most."""

GONE = -1e6
"""Rate that stands for poles that a corner has not [1/s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeanResponse:
    """A loop in every corner, by the poles that ring on after a jerk step."""

    poles: LoopPoles
    rates: Complex  # (n_corners, n_poles) [1/s]
    seen: NDArray[np.float32]  # tool at each instant by Re and Im of what poles hold,
    # (n_corners, 2 n_poles, n_instants)

    def behind(self, item: SetpointFilter | None) -> Complex:
        """Return F of a filter, shape (n_corners, n_poles)."""
        one = JerkSteps(times=np.zeros((1, 1)), steps=np.ones((1, 1)))
        steps = filter_steps(one, item)
        age = steps.duration[:, None] - steps.times
        total = (steps.steps[..., None, None] * np.exp(self.rates * age[..., None, None])).sum(1)
        return np.asarray(total[0] / self.rates ** (steps.order - one.order))

    def residual(self, steps: JerkSteps, item: SetpointFilter | None, behind: Complex) -> Array:
        """Return the residual deviation of moves in their worst corner, shape (n_setpoints,) [m].

        ``steps``: from ``jerk_steps``; ``behind``: of the filter.
        """
        if not self.rates.size:  # nothing but a table tells of this loop
            motions = set_in_motion(self.poles, filter_steps(steps, item))
            return free_motion(motions, lay_grid(self.poles, SAMPLES)).residual.max(axis=1)
        times, jerk = steps.times, steps.steps[:, 0]
        ramp = times[:1, 1] if np.all(times[:, 1] == times[0, 1]) else times[:, 1]
        held = behind * self._between(ramp) * self._between(times[:, 2])
        if times.shape[1] > 4:
            held = held * self._between(times[:, 4])
        both = np.concatenate([held.real, held.imag], axis=2).astype(np.float32)
        found = np.abs(both.transpose(1, 0, 2) @ self.seen)
        return np.asarray(jerk * found.max(axis=(0, 2)))

    def _between(self, time: Array) -> Complex:
        """Two steps of opposite sign, a time apart, at the later one."""
        return np.asarray(np.exp(self.rates * time[:, None, None]) - 1.0)


@lru_cache(maxsize=16)
def average_phases(poles: LoopPoles) -> MeanResponse:
    """Return the response of a loop averaged over the phases of its position cycle."""
    T, missing = poles.dt, np.abs(poles.factors) == 0.0
    rates = np.where(missing, GONE, poles.rates)
    early = (np.arange(PHASES) + 0.5)[:, None, None] / PHASES * T
    # The step comes s before its first sample, ``forced`` cycles before what the poles hold.
    held = sum(early**b / factorial(b) * poles.starts[3 - b] for b in range(4))
    age = np.where(missing, 0.0, rates) * (early + poles.forced * T)
    c = np.where(missing, 0.0, (held * np.exp(-age)).mean(axis=0))
    grid = lay_grid(poles, SAMPLES)
    s = poles.delay + np.unique(grid.cycle * T + grid.part * poles.velocity_cycle)
    tool = (c * poles.shapes[:, 0, 0])[..., None] * np.exp(rates[..., None] * s)
    seen = np.concatenate([tool.real, -tool.imag], axis=1).astype(np.float32)
    return MeanResponse(poles=poles, rates=rates, seen=seen)
