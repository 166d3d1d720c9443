"""Results -> CSV texts, SI."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import AnyOptimum, sample_trajectory
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

if TYPE_CHECKING:  # the loop and its libraries take seconds, and writing a text needs none of them
    from mtcommission.limits.judge import MoveResult

Array = NDArray[np.float64]

MOTION_SAMPLES = 2000
"""Samples of an optimal control in its CSV file, besides the switches."""


def setpoint_csv(setpoint: Setpoint, *, step: float) -> str:
    """Return a setpoint as CSV, t, x_ref, v_ref, a_ref, j_ref (SI), each position cycle ``step``.

    The last row is the first one at or after the end.
    """
    times = np.arange(int(np.ceil(setpoint.duration / step - 1e-9)) + 1, dtype=np.float64) * step
    return _csv(
        ("t", "x_ref", "v_ref", "a_ref", "j_ref"),
        np.column_stack([times, sample_setpoint(setpoint, times)]),
    )


def motion_csv(plant: Plant, solution: AnyOptimum) -> str:
    """Return the motion under an optimal control as CSV: t, F_set, every state (SI)."""
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / MOTION_SAMPLES)
    return _csv(
        ("t", "F_set", *plant.states), np.column_stack([motion.t, motion.force, motion.states])
    )


def response_csv(plant: Plant, result: MoveResult) -> str:
    """Return the nominal response to a move as CSV: t, deviation, F_set, every state (SI)."""
    nominal = result.responses[0]
    columns = np.column_stack([nominal.t, nominal.deviation, nominal.force, nominal.states])
    return _csv(("t", "deviation", "F_set", *plant.states), columns)


def _csv(names: tuple[str, ...], columns: Array) -> str:
    rows = (",".join(f"{value:.12g}" for value in row) for row in columns.tolist())
    return "\n".join([",".join(names), *rows]) + "\n"
