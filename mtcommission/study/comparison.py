"""The paper's comparison: feedback-controlled setpoints beside the optimal controls.

Sec. 3 claims that a feedback-controlled setpoint overshoots at the end and takes much longer
than the least time; Sec. 5 and 6 show what optimal controls do. Here all of them do the same
move on the same plant, measured alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.simulate.response import simulate
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.optimal.solution import (
    DampingOptimum,
    TimeOptimum,
    sample_trajectory,
)
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_setpoint

Array = NDArray[np.float64]

SAMPLES = 4000
"""Samples of an optimal motion for its integrals."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedControl:
    """One way of doing the move.

    Parameters
    ----------
    name
        What drives the axis.
    transfer_time
        t_f of an optimal control (exact rest); settling time in the loop [s].
    overshoot
        How far the tool's velocity (velocity step) or position (positioning) exceeds its
        target, relative to it [-].
    peaks
        Largest magnitude of each of ``Plant.signals``.
    max_force
        Largest |F_set| [N].
    heat
        Integral of the squared motor force, the measure of motor heating [N² s].
    work
        Integral of |motor force x rigid velocity| [J].
    """

    name: str
    transfer_time: float
    overshoot: float
    peaks: Array
    max_force: float
    heat: float
    work: float


def compare_controls(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    move: Move,
    *,
    limits: MotionLimits,
    optima: Sequence[TimeOptimum | DampingOptimum],
) -> tuple[ComparedControl, ...]:
    """Return rectangular and trapezoidal acceleration in the loop, beside the optima.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    move
        What is to be done.
    limits
        Of the trapezoidal acceleration setpoint.
    optima
        Optimal controls of the same move.

    Returns
    -------
    tuple of ComparedControl
        First the rectangular acceleration setpoint (F_max/m, no jerk limit), then the
        trapezoidal one, then the optima in their order.
    """
    a = machine.drive.motion_force / plant.moving_mass
    rectangular = without_jerk_limit(machine, a)
    rows = [
        _in_loop(machine, plant, tuned, move, name=name, limits=chosen)
        for name, chosen in (
            ("rectangular acceleration, in the loop", rectangular),
            ("trapezoidal acceleration, in the loop", limits),
        )
    ]
    return (*rows, *(_optimal(plant, solution) for solution in optima))


def _in_loop(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    move: Move,
    *,
    name: str,
    limits: MotionLimits,
) -> ComparedControl:
    setpoint = plan_setpoint(move, limits, moving_average=machine.control.moving_average_time)
    response = simulate(
        tuned.loops[0],
        setpoint,
        drive=machine.drive,
        band=machine.requirements.tcp_deviation,
    )
    return ComparedControl(
        name=name,
        transfer_time=response.settling_time,
        overshoot=_overshoot(plant, move, response.states),
        peaks=response.peaks,
        max_force=float(np.max(np.abs(response.force))),
        heat=float(np.trapezoid(response.states[:, plant.force] ** 2, response.t)),
        work=_work(plant, response.t, response.states),
    )


def _optimal(plant: Plant, solution: TimeOptimum | DampingOptimum) -> ComparedControl:
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / SAMPLES)
    if isinstance(solution, DampingOptimum):
        name = "damping-optimal control, on the plant"
    elif solution.bounds:
        name = "constrained time-optimal control, on the plant"
    else:
        name = "time-optimal control, on the plant"
    return ComparedControl(
        name=name,
        transfer_time=solution.t_f,
        overshoot=_overshoot(plant, solution.move, motion.states),
        peaks=solution.peaks,
        max_force=float(np.max(np.abs(motion.force))),
        heat=float(np.trapezoid(motion.states[:, plant.force] ** 2, motion.t)),
        work=_work(plant, motion.t, motion.states),
    )


def _overshoot(plant: Plant, move: Move, states: Array) -> float:
    tool = plant.row("tcp")
    if isinstance(move, VelocityStep):
        reached, target = states @ (tool @ plant.A), move.velocity_step
    else:
        reached, target = states @ tool, move.distance
    return max(float(np.max(reached)) / target - 1.0, 0.0)


def _work(plant: Plant, t: Array, states: Array) -> float:
    power = np.abs(states[:, plant.force] * states[:, plant.velocity])
    return float(np.trapezoid(power, t))
