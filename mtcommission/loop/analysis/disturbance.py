"""Answers of the loop at rest to what sets in: a force on the axis, an error of the encoder."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop, discretise_disturbance
from mtcommission.loop.nonlinear import march

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DisturbanceStep:
    """Response of the tool to a step of force on the line of the drive."""

    t: Array  # every velocity cycle from the step on, shape (n_samples,) [s]
    deflection: Array  # tool displacement per newton, shape (n_samples,) [m/N]

    @property
    def peak(self) -> float:
        """Largest displacement per newton [m/N]."""
        return float(np.max(np.abs(self.deflection)))


def simulate_disturbance(loop: SampledLoop, *, duration: float) -> DisturbanceStep:
    """Return how the tool gives way to a step of force, at rest before it, for a duration [s].

    The step begins with a position cycle; the setpoint rests, the force is not saturated.
    """
    push = np.zeros(loop.own_size)
    push[: loop.plant.order] = discretise_disturbance(loop.plant, loop.controller.velocity_cycle)
    nothing = np.zeros(loop.own_size - loop.held)
    tool = loop.observation[:1, : loop.own_size]
    found = step_response(loop, tool, entry=push, handed_down=nothing, duration=duration)
    t = np.arange(len(found), dtype=np.float64) * loop.controller.velocity_cycle
    return DisturbanceStep(t=t, deflection=found[:, 0])


def step_response(
    loop: SampledLoop, rows: Array, *, entry: Array, handed_down: Array, duration: float
) -> Array:
    """Return signals at every velocity cycle after a constant input sets in, (n, n_rows).

    ``rows``: over the loop's own states; ``entry``: what the input adds to these in a velocity
    cycle, ``handed_down``: to what is held, in a position cycle. It begins with a position cycle.
    """
    size = loop.own_size
    cycle, A = loop.cycle[:size, :size], loop.lifted.A[:size, :size]
    seen, added, state, pushed = [], [], np.eye(size), np.zeros(size)
    for _ in range(loop.controller.cycles):
        seen.append(rows @ state)
        added.append(rows @ pushed)
        state, pushed = cycle @ state, cycle @ pushed + entry
    pushed[loop.held :] = handed_down
    count = ceil(duration / loop.controller.position_cycle)
    states = march(A, np.zeros(size), np.tile(pushed, (count, 1)))
    found = states @ np.vstack(seen).T + np.concatenate(added)
    return np.asarray(found.reshape(-1, len(rows)))
