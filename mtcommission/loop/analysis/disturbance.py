"""The disturbance step response: a force on the axis while the loop holds its position."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.model.discrete import discretise_disturbance

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
    size, cycle, held = len(loop.states), loop.cycle, loop.held
    entry = np.zeros(size)
    entry[: loop.plant.order] = discretise_disturbance(loop.plant, loop.controller.velocity_cycle)
    X, tool = np.zeros(size), []
    for _ in range(ceil(duration / loop.controller.position_cycle)):
        handed_down = loop.handed_down[:, :size] @ X
        for _ in range(loop.controller.cycles):
            tool.append(float(loop.observation[0] @ X))
            X = cycle @ X + entry
        X[held : loop.own_size] = handed_down
    t = np.arange(len(tool), dtype=np.float64) * loop.controller.velocity_cycle
    return DisturbanceStep(t=t, deflection=np.array(tool))
