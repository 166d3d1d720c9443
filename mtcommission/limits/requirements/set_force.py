"""How much force the loop asks for: what the drive has, less static load and friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements.requirement import Requirement, Swing, Yields
from mtcommission.loop.respond import FORCE, OUTPUTS, Signal
from mtcommission.machine.machine import Machine, heaviest_mass

SAFE = 2.5
"""Factor by which a loop may ask for more force than the rigid axis [-] (empirical: up to 2.03)."""


def _with_force(machine: Machine, force: float) -> Machine:
    drive = machine.drive
    taken = drive.max_force - drive.motion_force
    return replace(machine, drive=replace(drive, max_force=taken + force))


SET_FORCE = Requirement(
    key="set force",
    message=Message("requirement-set-force"),
    unit=lambda machine, _: machine.axis_units.force.si,
    bound=lambda machine: machine.drive.motion_force,
    with_bound=_with_force,
    share=lambda reserve: reserve.force,
    value=lambda response, _: response.max_force,
    with_noise=lambda value, noise: value + noise.force,
    by_poles=lambda plant: Swing(signal=Signal(row=np.eye(plant.order + OUTPUTS)[FORCE])),
    at_most=lambda machine, acceleration: SAFE * heaviest_mass(machine) * acceleration,
    yields=Yields.NEVER,
)
