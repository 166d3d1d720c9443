"""Machines for tests, built without the profile reader so that faults do not hide each other."""

from __future__ import annotations

from math import pi

import numpy as np

from mtcommission.controls.kinds import STATE_SPACE
from mtcommission.machine.control import Control, StateFeedback
from mtcommission.machine.drive import Drive
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.requirements import Modes, Requirements

REQUIREMENTS = Requirements(
    tcp_deviation=5e-6, modes=Modes(surface=2e-6, accuracy=5e-6, speed=20e-6)
)


DAMPED = Control(kind=STATE_SPACE, state_feedback=StateFeedback.AUTO)
"""A free controller, since most that can go wrong in a loop goes wrong with state feedback."""


def paper_machine(*, max_force: float = 2e3) -> Machine:
    """Christiansen, Maurer & Zirn, Table 1, with the velocity step of eq. (3)."""
    return Machine(
        name="Milling machine workpiece manipulator",
        axis="X",
        source="Christiansen, Maurer, Zirn, Table 1",
        mechanics=Manipulator(
            base_mass=450.0,
            slider_mass=750.0,
            rotary_inertia=40.0,
            lever_arm=0.25,
            tcp_height=0.21,
            base_stiffness=44.41e6,
            base_damping=8500.0,
            rotary_stiffness=8.2e6,
            rotary_damping=1800.0,
        ),
        drive=Drive(force_lag=2.5e-3, max_force=max_force),
        moves=(VelocityStep(velocity_step=0.1),),
        requirements=REQUIREMENTS,
        control=DAMPED,
    )


def random_modal_machine(seed: int, *, n_modes: int) -> Machine:
    """A plausible axis: 50 ... 2000 kg, modes from 15 to 300 Hz, damping 0.5 ... 10 %."""
    generator = np.random.default_rng([seed, n_modes])
    mass = float(np.exp(generator.uniform(np.log(50.0), np.log(2000.0))))
    frequencies = np.sort(np.exp(generator.uniform(np.log(15.0), np.log(300.0), n_modes)))
    modes = tuple(
        FlexibleMode(
            name=f"m{i}",
            natural_frequency=2 * pi * float(frequency),
            damping_ratio=float(generator.uniform(0.005, 0.1)),
            tcp_gain=float(generator.uniform(-1.0, 1.0)) / mass,
            measured_gain=float(generator.choice([0.0, 1.0]))
            * float(generator.uniform(0, 1))
            / mass,
        )
        for i, frequency in enumerate(frequencies)
    )
    acceleration = float(np.exp(generator.uniform(np.log(0.5), np.log(20.0))))
    return Machine(
        name=f"random {seed}",
        axis="X",
        source="seeded generator",
        mechanics=Modal(moving_mass=mass, modes=modes),
        drive=Drive(
            force_lag=float(generator.uniform(0.5e-3, 4e-3)), max_force=mass * acceleration
        ),
        moves=(VelocityStep(velocity_step=float(generator.uniform(0.02, 1.0))),),
        requirements=REQUIREMENTS,
        control=DAMPED,
    )


def slowly_decaying_machine() -> Machine:
    """A soft axis whose mode still moves tenths of the band ten seconds after a move."""
    mode = FlexibleMode(
        name="frame",
        natural_frequency=2 * pi * 6.0,
        damping_ratio=0.01,
        tcp_gain=6e-4,
        measured_gain=1e-4,
    )
    return Machine(
        name="Soft axis",
        axis="X",
        source="invented",
        mechanics=Modal(moving_mass=1500.0, modes=(mode,)),
        drive=Drive(force_lag=3e-3, max_force=3e3),
        moves=(VelocityStep(velocity_step=0.2),),
        requirements=Requirements(
            tcp_deviation=50e-6, modes=Modes(surface=20e-6, accuracy=50e-6, speed=200e-6)
        ),
    )
