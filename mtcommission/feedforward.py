"""What happens when the optimal control itself is fed forward and the loop only corrects.

Users ask why they cannot simply use the optimum. Here the optimal set force goes to the drive
at every velocity cycle (its mean over the cycle, so that no impulse is lost), the controllers
compare with the optimal motion, and the machine is the nominal one or off by the spread.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.sampled import SampledLoop, build_loop
from mtcommission.loop.tuning import TunedLoop
from mtcommission.machine import NOMINAL, Corner, Machine, corners, vary
from mtcommission.optimal.solution import DampingOptimum, TimeOptimum, sample_evenly
from mtcommission.plant import Plant, build_plant

Array = NDArray[np.float64]

USUAL_SPREAD = 0.05
"""Frequency error shown where the profile states no spread [-] (empirical: measured
eigenfrequencies are rarely better known)."""

TAIL = 0.5
"""How long the motion after t_f is followed [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FedForward:
    """One optimal control fed forward on one machine.

    Parameters
    ----------
    corner
        The machine.
    settling_time
        Last time with the tool outside the band about the delayed optimal motion [s]; at least
        the end of the motion.
    residual_deviation, peak_deviation
        Of the tool from the delayed optimal motion, after its end and ever [m].
    saturated_share
        Share of the move during which the correction found no force left [-].
    """

    corner: Corner
    settling_time: float
    residual_deviation: float
    peak_deviation: float
    saturated_share: float


def feed_forward(
    machine: Machine, plant: Plant, tuned: TunedLoop, solution: TimeOptimum | DampingOptimum
) -> tuple[FedForward, ...]:
    """Return what the fed-forward optimum does on the nominal machine and in its corners.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    solution
        An optimal control of the nominal machine.

    Returns
    -------
    tuple of FedForward
        The nominal machine first; corners with ``USUAL_SPREAD`` where the profile states none.
    """
    places: Sequence[Corner] = corners(machine)
    if places == (NOMINAL,):
        needs = replace(machine.requirements, frequency_spread=USUAL_SPREAD)
        places = corners(replace(machine, requirements=needs))
    cycle = tuned.controller.velocity_cycle
    count = ceil((solution.t_f + TAIL) / cycle)
    wanted = sample_evenly(plant, solution.arcs, step=cycle, until=(count + 1) * cycle)
    found = []
    for corner in places:
        loop = build_loop(build_plant(vary(machine, corner)), tuned.controller, model=plant)
        found.append(_run(machine, plant, loop, wanted, corner=corner, t_f=solution.t_f))
    return tuple(found)


def _run(
    machine: Machine,
    plant: Plant,
    loop: SampledLoop,
    wanted: Array,
    *,
    corner: Corner,
    t_f: float,
) -> FedForward:
    """Advance the loop velocity cycle by velocity cycle with the optimal motion as reference.

    The force acts one velocity cycle late, so everything is compared with the motion wanted
    one cycle ago.
    """
    controller, limit = loop.controller, machine.drive.motion_force
    cycle, n = controller.velocity_cycle, loop.plant.order
    encoder = plant.row("encoder")
    # ∫ F_set over a cycle, from T F' = F_set - F and m v' = F.
    gain = np.zeros(n)
    gain[plant.force], gain[plant.velocity] = plant.force_lag, plant.moving_mass
    mean_force = np.diff(wanted @ gain) / cycle
    late = np.vstack([np.zeros(n), wanted[:-1]])
    position, rate = late @ encoder, late @ (encoder @ plant.A)
    target = late @ controller.state_gains
    X = np.zeros(len(loop.states))
    correction = asked = 0.0
    tool, saturated = np.empty(len(mean_force)), 0
    for i, force in enumerate(mean_force):
        if i % controller.cycles == 0:
            correction, asked = (
                asked,
                controller.position_gain * (position[i] - loop.plant.row("encoder") @ X[:n]),
            )
        tool[i] = loop.plant.row("tcp") @ X[:n]
        X[loop.held : loop.held + 3] = correction, rate[i], force + target[i]
        demand = float(loop.demand @ X)
        acting = min(max(demand, -limit), limit)
        increment = float(loop.integration @ X) if acting == demand else 0.0
        # Rounding of the mean may exceed the limit by a few parts in 1e9: no saturation.
        saturated += i * cycle <= t_f and abs(demand) > limit * (1.0 + 1e-6)
        X = loop.step @ X
        X[loop.integrator] += increment
        X[loop.integrator + 1] = acting
    deviation = np.abs(tool - late[: len(tool)] @ plant.row("tcp"))
    t = np.arange(len(tool)) * cycle
    end = t_f + cycle
    outside = np.flatnonzero(deviation > machine.requirements.tcp_deviation)
    last = float(t[outside[-1]]) if outside.size else 0.0
    return FedForward(
        corner=corner,
        settling_time=float("inf")
        if outside.size and outside[-1] == len(t) - 1
        else max(end, last),
        residual_deviation=float(np.max(deviation[t >= end])),
        peak_deviation=float(np.max(deviation)),
        saturated_share=saturated * cycle / t_f,
    )
