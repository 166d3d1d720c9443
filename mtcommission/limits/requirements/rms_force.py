"""How much the motor heats: the RMS force over move and dwell."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements.requirement import Mean, Requirement, Yields
from mtcommission.loop.disturbance import SIGMAS, EncoderNoise
from mtcommission.loop.poles import LoopPoles
from mtcommission.loop.respond import outputs_at, set_in_motion
from mtcommission.loop.simulate import rms_force, window_shares
from mtcommission.machine.machine import Machine, heaviest_mass
from mtcommission.machine.moves import Move
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]


def rms_forces(
    machine: Machine, poles: LoopPoles, move: Move, steps: JerkSteps, most_cycles: int
) -> Array:
    """Return the RMS motor force of one setpoint over [0, t_e + dwell] in every corner [N]."""
    window = float(steps.duration[0]) + move.dwell
    cycles = max(ceil(window / poles.dt), 1)
    n = np.unique(np.linspace(0, cycles, min(cycles, most_cycles) + 1).astype(np.int64))
    motor = np.eye(1, poles.outputs, poles.outputs - 1)  # the last of the plant's states
    force = outputs_at(set_in_motion(poles, steps), n[None], motor)[0, ..., 0]
    share = window_shares(n, window, step=poles.velocity_cycle, cycles=poles.cycles)
    return rms_force(
        (share * force).sum(axis=(1, 2)) * window / share.sum(),
        (share * force**2).sum(axis=(1, 2)) * window / share.sum(),
        window=window,
        static_load=machine.drive.static_load,
    )


def rigid_rms(machine: Machine, move: Move, steps: JerkSteps) -> Array:
    """Return the RMS force of the rigid axis, heaviest payload, shape (n_setpoints,) [N].

    The acceleration is a sum of steps w_i of its m-th integral, m = q - 1, that ends in rest, so by
    Parseval ∫ a² dt = (-1)^m / (2 (2m - 1)!) Σ_ij w_i w_j |t_i - t_j|^(2m - 1). Its mean is that of
    a velocity step, against which a static load counts.
    """
    m, t = steps.order - 1, steps.times
    gap = np.abs(t[:, :, None] - t[:, None, :])
    gaps = gap * np.square(gap) ** (m - 1)  # to the 2m - 1, without the costly general power
    both = np.einsum("si,sij,sj->s", steps.steps, gaps, steps.steps)
    square = np.maximum((-1) ** m / (2.0 * factorial(2 * m - 1)) * both, 0.0)
    age = steps.duration[:, None] - t
    velocity = np.sum(steps.steps * age**m, axis=1) / factorial(m)
    mass = heaviest_mass(machine)
    return rms_force(
        mass * velocity,
        mass**2 * square,
        window=steps.duration + move.dwell,
        static_load=machine.drive.static_load,
    )


def _with_force(machine: Machine, force: float) -> Machine:
    return replace(machine, drive=replace(machine.drive, continuous_force=force))


def _with_noise(value: Array, noise: EncoderNoise) -> Array:
    return np.hypot(value, noise.force / SIGMAS)


RMS_FORCE = Requirement(
    key="RMS force",
    message=Message("requirement-rms-force"),
    unit=lambda machine, _: machine.axis_units.force.si,
    bound=lambda machine: machine.drive.continuous_force,
    with_bound=_with_force,
    share=lambda reserve: reserve.force,
    value=lambda response, _: response.rms_force,
    with_noise=_with_noise,
    by_poles=lambda _: Mean(estimate=rigid_rms, exact=rms_forces),
    at_most=lambda machine, acceleration: float(
        np.hypot(heaviest_mass(machine) * acceleration, machine.drive.static_load)
    ),
    yields=Yields.IF_ASKED,
    rests_on=("moves[", "dwell"),
)
