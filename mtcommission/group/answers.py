"""How an axis answers what contours are made of: steps of velocity and acceleration, lines.

A corner steps the velocity of an axis, the entry of a circle its acceleration; a line moves all
axes in proportion. Behind the group's filter, in every corner of the machine, by poles.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.poles import LoopPoles
from mtcommission.loop.respond import FORCE, TOOL, outputs_at, set_in_motion, swing_times
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps

Array = NDArray[np.float64]

PERIODS, LONGEST = 2.0, 0.6
"""Of each pole that an answer is followed, and the longest [s] (empirical)."""

PHASES = (0.0, 1e-4, 0.5)
"""At which a step comes within a position cycle: with its sample, which sees all derivatives step
before anything has moved; just behind it, so that the next sample sees all; and between."""

AFTER = 100.0
"""End of a step of acceleration, later than anything that is looked at [s]."""

FINER = 4
"""Instants of a position cycle that are looked at."""

SHARES = (0.05, 0.2, 0.5, 1.0)
"""Of the feed to which a line accelerates."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisAnswers:
    """An axis of a group behind its filter, with its wait."""

    poles: LoopPoles
    setpoint_filter: SetpointFilter | None
    wait: int  # position cycles

    @property
    def lag(self) -> Array:
        """By how much slow motion comes later than its setpoint, (n_corners,) [s]."""
        waited = self.wait * self.poles.dt + filter_lag(self.setpoint_filter)
        return np.asarray(waited - self.poles.steady[:, 0, TOOL, 1], dtype=np.float64)

    @property
    def step(self) -> float:
        """Time between two instants that are looked at: a quarter of a position cycle or so [s]."""
        return self.poles.dt / len(self._parts)

    @property
    def _parts(self) -> list[int]:
        cycles = self.poles.cycles
        return list(range(0, cycles, max(cycles // FINER, 1)))

    def tool(self, steps: JerkSteps, cycles: int) -> Array:
        """Return the tool's position, (n_corners, n_setpoints, n_times), some position cycles on.

        The first step comes within the first cycle.
        """
        found = self._outputs(steps, cycles, TOOL)[..., self._parts]
        return np.asarray(found.reshape(*found.shape[:2], -1), dtype=np.float64)

    def _outputs(self, steps: JerkSteps, cycles: int, output: int) -> Array:
        """An output, (n_corners, n_setpoints, n_cycles, velocity cycles)."""
        n = np.arange(cycles) - self.wait
        motions = set_in_motion(self.poles, filter_steps(steps, self.setpoint_filter))
        each = np.tile(np.maximum(n, 0), (len(steps.times), 1))
        found = outputs_at(motions, each, np.eye(self.poles.outputs)[output])[..., 0]
        found[:, :, n < 0] = 0.0
        return np.asarray(found.swapaxes(0, 1), dtype=np.float64)

    def cycles(self, duration: float) -> int:
        """Return after how many position cycles the answer to so long a setpoint [s] is over."""
        rings = [swing_times(pole, PERIODS)[0] for pole in self.poles.rates[0] if np.isfinite(pole)]
        rest = float(self.lag.max()) + min(max(rings, default=0.0), LONGEST)
        own = self.setpoint_filter.duration if self.setpoint_filter else 0.0
        return ceil((duration + own + rest) / self.poles.dt) + 2

    def to_velocity(self, phase: float) -> Array:
        """Return the answer to a step of velocity of 1 m/s, (n_corners, n_times) [s].

        ``phase``: when within a position cycle it comes [-]; the first instant is that cycle's.
        """
        return self.tool(self._single_step(phase), self.cycles(0.0))[:, 0]

    def largest_step(self, force_limit: float) -> float:
        """Return the step of velocity [m/s] that takes all of a force [N], in any corner and phase.

        inf where the motor follows its setpoint: what it can do is then no matter of a force.
        """
        if self.poles.loops[0].controller.follows:
            return inf
        cycles = self.cycles(0.0)
        forces = [self._outputs(self._single_step(one), cycles, FORCE) for one in PHASES]
        return force_limit / float(np.abs(forces).max())

    def _single_step(self, phase: float) -> JerkSteps:
        at = np.full((1, 1), phase * self.poles.dt)
        return JerkSteps(times=at, steps=np.ones((1, 1)), order=1)

    def entry(self) -> float:
        """Return the largest deviation after a step of acceleration of 1 m/s² [s²].

        That is how a circle is entered from its tangent: against the circle that comes so late.
        """
        cycles, starts = self.cycles(0.0), self.poles.dt * np.array(PHASES)
        # Behind its last step a setpoint coasts: the acceleration ends after all that is seen.
        lasting = JerkSteps(
            times=np.array([starts, starts + AFTER]).T,
            steps=np.tile([1.0, -1.0], (len(starts), 1)),
            order=2,
        )
        found = self.tool(lasting, cycles)
        t = self.step * np.arange(found.shape[2])
        late = np.maximum(t - starts[:, None] - self.lag[:, None, None], 0.0)
        return float(np.abs(found - 0.5 * late**2).max())


def filter_lag(item: SetpointFilter | None) -> float:
    """Return by how much a filter delays slow motion [s]."""
    if item is None:
        return 0.0
    shares = zip(item.impulses.delays, item.impulses.shares, strict=True)
    return sum(d * share for d, share in shares) + 0.5 * sum(item.averages)


def line_deviation(
    first: AxisAnswers, second: AxisAnswers, *, feed: float, acceleration: float, jerk: float
) -> float:
    """Return how far the tool leaves a line at most while it starts or stops on it [m].

    Both axes get their share of one motion, so that they leave it by |u_x u_y| times what their
    answers to the whole motion differ by: half of that at 45 degrees, the worst direction. Up to
    the feed [m/s], with path limits [m/s², m/s³].
    """
    sizes = feed * np.array(SHARES)
    full = np.full_like(sizes, acceleration)
    move = VelocityStep(velocity_step=feed)
    steps = jerk_steps(move, acceleration=full, jerk=np.full_like(sizes, jerk), size=sizes)
    duration = float(steps.duration.max())
    cycles = max(first.cycles(duration), second.cycles(duration))
    a, b = first.tool(steps, cycles), second.tool(steps, cycles)
    return float(0.5 * np.abs(a[:, None] - b[None]).max())
