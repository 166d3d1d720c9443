"""The following-error transient of one ramp over its length: the numbers behind the rule's 1.5.

    python -m benchmarks.following_error --count 70

Random machines keep their tuned cascade but lose their modes and their payload, so what is left
after a velocity step is the servo alone. Its deviation is printed over that of one jerk step by
the rule, j max(0.4 T², 0.18 T_p²)/ω_v.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from benchmarks.population import random_machine
from mtcommission.limits.commissioning_rule.estimate import HOLD_SHARE, LAG_SHARE
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, VelocityStep, moving_mass
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.plant.modal import Modal
from mtcommission.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verdict.evaluate import simulate_moves

RAMPS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
"""Lengths of the ramp times ω_v."""

COAST = 40.0
"""Constant acceleration between the ramps times ω_v: the first ramp is forgotten."""


def without_modes(machine: Machine, controller: Controller) -> tuple[Machine, TunedLoop]:
    """The machine as a rigid mass with lag, and its loop with the same ω_v, Kv and Tn."""
    mass = moving_mass(machine)
    rigid = FlexibleMode(name="s", natural_frequency=2500.0, damping_ratio=0.5, tcp_gain=1e-12)
    bare = replace(
        machine,
        mechanics=Modal(moving_mass=mass, modes=(rigid,)),
        drive=replace(machine.drive, max_force=1e12),
        requirements=replace(
            machine.requirements, tcp_deviation=1e-7, payload=(0.0, 0.0), frequency_spread=0.0
        ),
    )
    alike = replace(
        controller,
        feedforward_mass=mass,
        velocity_gain=controller.velocity_gain * mass / controller.feedforward_mass,
        state_gains=np.zeros(build_plant(bare).order),
    )
    return bare, close_loop(corner_plants(bare), alike)


def measure(seed: int) -> list[float]:
    """Tail over that of one jerk step, for each of the ramps."""
    machine = random_machine(seed)
    bare, tuned = without_modes(machine, tune_loop(machine).controller)
    controller = tuned.controller
    omega_v = controller.velocity_gain / controller.feedforward_mass
    step = max(LAG_SHARE * controller.force_lag**2, HOLD_SHARE * controller.position_cycle**2)
    found = []
    for ramp in RAMPS:
        jerk = omega_v / ramp  # a = 1 m/s²
        move = VelocityStep(velocity_step=(ramp + COAST) / omega_v)
        limits = MotionLimits(acceleration=1.0, jerk=jerk)
        (result,) = simulate_moves(replace(bare, moves=(move,)), tuned, limits)
        found.append(result.responses[0].residual_deviation * omega_v / (jerk * step))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=70)
    count = parser.parse_args().count
    transients = np.array([measure(seed) for seed in range(count)])
    print("| ω_v t_j | median | 95 % | largest |\n|---|---|---|---|")
    for ramp, column in zip(RAMPS, transients.T, strict=True):
        low, high = np.quantile(column, [0.5, 0.95])
        print(f"| {ramp:g} | {low:.2f} | {high:.2f} | {column.max():.2f} |")


if __name__ == "__main__":
    main()
