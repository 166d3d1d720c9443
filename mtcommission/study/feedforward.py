"""What happens when the optimal control itself is fed forward and the loop only corrects.

Users ask why they cannot simply use the optimum. Here the optimal set force goes to the drive
at every velocity cycle (its mean over the cycle, so that no impulse is lost), the controllers
compare with the optimal motion, and the machine is the nominal one or off by the spread.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.limits.judge import MoveResult
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.simulate import simulate_corners
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import NOMINAL, Corner, corners, vary
from mtcommission.optimal.band.force import BandForce
from mtcommission.optimal.solution import DampingOptimum, TimeOptimum, sample_evenly
from mtcommission.plant.plant import Plant, build_plant

Array = NDArray[np.float64]

USUAL_SPREAD = 0.05
"""Frequency error shown where the profile states no spread [-] (empirical: measured
eigenfrequencies are rarely better known)."""

ROUNDING = 1e-6
"""By how much the mean of a bang-bang force may exceed its limit without being saturation."""

TAIL = 0.4
"""How long the motion after t_f is followed [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FedForward:
    """One optimal control fed forward, or a setpoint, on one machine."""

    corner: Corner  # the machine
    settling_time: float  # with the tool outside the band about the delayed motion wanted [s]
    residual_deviation: float  # of the tool from that, after its end [m]
    peak_deviation: float  # and ever [m]
    saturated_share: float  # of the move during which the correction found no force left [-]


def feed_forward(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    solution: TimeOptimum | DampingOptimum | BandForce,
) -> tuple[FedForward, ...]:
    """Return what the fed-forward optimum does on the nominal machine and in its corners.

    While it moves, the tool is compared with the optimal motion, and after its end with where
    that comes to rest; what leaves modes ringing within the band lets the reference lie beside.
    The nominal machine first; corners with ``USUAL_SPREAD`` where the profile states none.
    """
    places = _places(machine)
    cycle = tuned.controller.velocity_cycle
    count = ceil((solution.t_f + TAIL) / cycle)
    wanted = sample_evenly(plant, solution.arcs, step=cycle, until=(count + 1) * cycle)
    plants = [build_plant(vary(machine, corner)) for corner in places]
    if tuned.controller.follows:
        # The motor does what the optimum asks for, one cycle late like every force fed forward.
        moved = [sample_evenly(one, solution.arcs, step=cycle, until=(count + 1) * cycle)
                 @ one.row("tcp") for one in plants]  # fmt: skip
        tool = np.vstack([np.zeros(len(places)), np.column_stack(moved)[:-2]])
        saturated = np.zeros(tool.shape, dtype=np.bool_)
    else:
        whole = replace(tuned.controller, velocity_feedforward=1.0)
        loops = [build_loop(one, whole, model=plant) for one in plants]
        tool, saturated = _advance(plant, loops, wanted, limit=machine.drive.motion_force)
    aimed = wanted @ plant.row("tcp")
    if isinstance(solution, BandForce):
        after = ceil(solution.t_f / cycle)
        to_last = cycle * np.arange(after + 1 - len(aimed), 1)
        steady = wanted[-1, plant.position] + wanted[-1, plant.velocity] * to_last
        aimed[after:] = steady + solution.offset
    late = np.concatenate(([0.0], aimed[:-2]))
    t = np.arange(len(late)) * cycle
    end = solution.t_f + cycle
    found = []
    for i, corner in enumerate(places):
        deviation = np.abs(tool[:, i] - late)
        outside = np.flatnonzero(deviation > machine.requirements.tcp_deviation)
        last = float(t[outside[-1]]) if outside.size else 0.0
        found.append(
            FedForward(
                corner=corner,
                settling_time=inf if last == t[-1] else max(end, last),
                residual_deviation=float(np.max(deviation[t >= end])),
                peak_deviation=float(np.max(deviation)),
                saturated_share=float(np.mean(saturated[t <= solution.t_f, i])),
            )
        )
    return tuple(found)


def follow_setpoint(
    machine: Machine, plant: Plant, tuned: TunedLoop, result: MoveResult
) -> tuple[FedForward, ...]:
    """Return what a setpoint does on the same machines, beside the fed-forward optima."""
    places, responses, setpoint = _places(machine), result.responses, result.setpoint
    if places != tuned.corners:
        plants = [build_plant(vary(machine, place)) for place in places]
        loops = [build_loop(one, tuned.controller, model=plant) for one in plants]
        band = machine.requirements.tcp_deviation
        responses = tuple(simulate_corners(loops, setpoint, drive=machine.drive, band=band))
    limit = machine.drive.motion_force * (1.0 - ROUNDING)
    found = []
    for corner, response in zip(places, responses, strict=True):
        at_limit = response.saturated & (np.abs(response.force) >= limit)
        found.append(
            FedForward(
                corner=corner,
                settling_time=response.settling_time,
                residual_deviation=response.residual_deviation,
                peak_deviation=response.peak_deviation,
                saturated_share=float(np.mean(at_limit[response.t <= setpoint.duration])),
            )
        )
    return tuple(found)


def _places(machine: Machine) -> tuple[Corner, ...]:
    """The corners of a machine, with ``USUAL_SPREAD`` where its profile states none."""
    places = corners(machine)
    if places != (NOMINAL,):
        return places
    needs = replace(machine.requirements, frequency_spread=USUAL_SPREAD)
    return corners(replace(machine, requirements=needs))


def _advance(
    plant: Plant, loops: Sequence[SampledLoop], wanted: Array, *, limit: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Tool position and saturation at every velocity cycle, shapes (n_samples, n_loops).

    The force acts one velocity cycle late, so the controllers compare with the motion wanted
    one cycle ago, its velocity by differences as the encoder's. All loops have the same states
    and advance together.
    """
    controller, n = loops[0].controller, plant.order
    held, own, integrator = loops[0].held, loops[0].own_size, loops[0].integrator
    force_at = loops[0].states.index("held_force")
    in_drive = controller.position_loop is PositionLoop.DRIVE
    step = np.array([loop.step for loop in loops])
    demand_row = np.array([loop.demand for loop in loops])
    integration = np.array([loop.integration for loop in loops])
    encoder = np.array([loop.plant.row("encoder") for loop in loops])
    tool_row = np.array([loop.plant.row("tcp") for loop in loops])
    # ∫ F_set over a cycle, from T F' = F_set - F and m v' = F.
    momentum = np.zeros(n)
    momentum[plant.force], momentum[plant.velocity] = plant.force_lag, plant.moving_mass
    mean_force = np.diff(wanted @ momentum) / controller.velocity_cycle
    late = np.vstack([np.zeros(n), wanted[:-1]])
    position = late @ plant.row("encoder")
    rate = np.diff(position, prepend=0.0) / controller.velocity_cycle
    ahead = mean_force + late[:-1] @ controller.state_gains

    X = np.zeros((len(loops), len(loops[0].states)))
    first = asked = np.zeros(len(loops))
    tool = np.empty((len(mean_force), len(loops)))
    saturated = np.zeros(tool.shape, dtype=np.bool_)
    for i, force in enumerate(ahead):
        if in_drive:
            first = np.full(len(loops), position[i])
        elif i % controller.cycles == 0:
            error = position[i] - np.sum(encoder * X[:, :n], axis=1)
            first, asked = asked, controller.position_gain * error
        tool[i] = np.sum(tool_row * X[:, :n], axis=1)
        X[:, held:own] = 0.0
        X[:, held], X[:, held + 1], X[:, force_at] = first, rate[i], force
        demand = np.sum(demand_row * X, axis=1)
        acting = np.clip(demand, -limit, limit)
        increment = np.where(acting == demand, np.sum(integration * X, axis=1), 0.0)
        saturated[i] = np.abs(demand) > limit * (1.0 + ROUNDING)
        X = np.matmul(step, X[:, :, None])[:, :, 0]
        X[:, integrator] += increment
        X[:, integrator + 1] = acting
    return tool, saturated
