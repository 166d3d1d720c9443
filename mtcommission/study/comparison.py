"""The paper's comparison: feedback-controlled setpoints beside the optimal controls.

Sec. 3 claims that a feedback-controlled setpoint overshoots at the end and takes much longer
than the least time; Sec. 5 and 6 show what optimal controls do. Here all of them do the same
move on the same plant, measured alike: whether a faster setpoint than the recommended one can
exist at all, and why the optimum itself is not fed to the drive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.judge import MoveResult
from mtcommission.limits.optima import Optima
from mtcommission.loop.simulate import simulate
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.machine.variations import NOMINAL
from mtcommission.messages.message import Message
from mtcommission.optimal.band.robust import RobustForce
from mtcommission.optimal.solution import (
    DampingOptimum,
    TimeOptimum,
    sample_trajectory,
)
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_within
from mtcommission.study.feedforward import FedForward, feed_forward, follow_setpoint

Array = NDArray[np.float64]

SAMPLES = 4000
"""Samples of an optimal motion for its integrals."""


ROBUST = Message("control-robust")
"""Name of the force that keeps the band on all machines of the spread."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedControl:
    """One way of doing the move."""

    name: Message  # what drives the axis
    transfer_time: float  # t_f of an optimal control (exact rest); settling time in the loop [s]
    overshoot: float  # of the tool's velocity or position over its target, relative to it [-]
    peaks: Array  # largest magnitude of each of ``Plant.signals``
    max_force: float  # largest |F_set| [N]
    heat: float  # integral of the squared motor force, the measure of motor heating [N² s]
    work: float  # integral of |motor force x rigid velocity| [J]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveComparison:
    """A move done in the loop and by optimal controls."""

    controls: tuple[ComparedControl, ...]  # the paper's comparison
    fed_forward: tuple[tuple[Message, tuple[FedForward, ...]], ...]  # and the recommended limits
    claims: tuple[Message, ...]  # overshoot and transfer time against the least time
    why_not_the_optimum: tuple[Message, ...]  # what it does fed forward, and beside its machine


def compare_move(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    optima: Optima,
    result: MoveResult,
    *,
    robust: RobustForce | None,
) -> MoveComparison:
    """Return what the optimal controls of a move do, on the plant and fed forward in the loop.

    ``robust``: the force that keeps the band on all machines of the spread, where there is one.
    """
    solutions = {
        "control-time-optimal": optima.time,
        "control-constrained": optima.constrained,
        "control-damping-optimal": optima.damping,
    }
    found = {Message(kind): item for kind, item in solutions.items() if item is not None}
    controls = compare_controls(
        machine,
        plant,
        tuned,
        optima.move,
        limits=result.setpoint.limits,
        optima=tuple(found.values()),
    )
    fed = (*found.items(), *([(ROBUST, robust.force)] if robust else []))
    fed_forward = (
        *((name, feed_forward(machine, plant, tuned, item)) for name, item in fed),
        (Message("recommended-limits"), follow_setpoint(machine, plant, tuned, result)),
    )
    return MoveComparison(
        controls=controls,
        fed_forward=fed_forward,
        claims=state_claims(controls),
        why_not_the_optimum=explain_why_not(machine, fed_forward),
    )


def compare_controls(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    move: Move,
    *,
    limits: MotionLimits,
    optima: Sequence[TimeOptimum | DampingOptimum],
) -> tuple[ComparedControl, ...]:
    """Return rectangular (F_max/m, no jerk limit) and trapezoidal acceleration, then the optima."""
    a = machine.drive.motion_force / plant.moving_mass
    rectangular = without_jerk_limit(machine, a)
    rows = [
        _in_loop(machine, plant, tuned, move, name=name, limits=chosen)
        for name, chosen in (
            (Message("rectangular-in-the-loop"), rectangular),
            (Message("trapezoidal-in-the-loop"), limits),
        )
    ]
    return (*rows, *(_optimal(plant, solution) for solution in optima))


def _in_loop(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    move: Move,
    *,
    name: Message,
    limits: MotionLimits,
) -> ComparedControl:
    setpoint = plan_within(machine, limits)(move)
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
        kind = "damping-optimal-on-the-plant"
    elif solution.bounds:
        kind = "constrained-on-the-plant"
    else:
        kind = "time-optimal-on-the-plant"
    return ComparedControl(
        name=Message(kind),
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


OVERSHOOT_SEEN = 5e-4
"""Overshoot below which it is none [-]."""


def state_claims(controls: Sequence[ComparedControl]) -> tuple[Message, ...]:
    """Return overshoot and transfer time of the setpoints in the loop, as sentences.

    ``controls``: rectangular and trapezoidal acceleration in the loop, then the time-optimal one.
    """
    rectangular, trapezoidal, optimal = controls[:3]
    least = optimal.transfer_time
    return tuple(
        Message(kind, overshoot=_overshoot_claim(control), transfer=_transfer_claim(control, least))
        for kind, control in (
            ("claim-rectangular", rectangular),
            ("claim-trapezoidal", trapezoidal),
        )
    )


def _overshoot_claim(control: ComparedControl) -> Message:
    if control.overshoot < OVERSHOOT_SEEN:
        return Message("claim-no-overshoot")
    return Message("claim-overshoot", overshoot=control.overshoot)


def _transfer_claim(control: ComparedControl, least: float) -> Message:
    if not isfinite(control.transfer_time):
        return Message("claim-not-settled", least=least)
    time = control.transfer_time
    return Message("claim-transfer", time=time, times=time / least, least=least)


def explain_why_not(
    machine: Machine, fed_forward: Sequence[tuple[Message, Sequence[FedForward]]]
) -> tuple[Message, ...]:
    """Return what the fed-forward optimum does on the nominal machine and beside it, as sentences.

    ``fed_forward``: the nominal machine first; last the setpoint with the recommended limits.
    """
    *optima, (_, ours) = fed_forward
    return (
        *(
            Message("fed-forward-outcome", name=name, outcome=_outcome(rows), left=_left(rows))
            for name, rows in optima
        ),
        Message("recommended-outcome", outcome=_outcome(ours), left=_left(ours)),
        Message(
            "why-controls-take-limits",
            band=machine.requirements.tcp_deviation,
            spread=max(abs(row.corner.frequency_factor - 1.0) for row in ours),
        ),
    )


def _outcome(rows: Sequence[FedForward]) -> Message:
    nominal = next(row for row in rows if row.corner == NOMINAL)
    return Message(
        "settles-on-both",
        nominal=_settles(nominal.settling_time),
        worst=_settles(max(row.settling_time for row in rows)),
    )


def _settles(time: float) -> Message:
    return Message("time-value", time=time) if isfinite(time) else Message("no-time-looked-at")


def _left(rows: Sequence[FedForward]) -> float:
    return max(row.residual_deviation for row in rows)
