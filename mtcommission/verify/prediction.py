"""The loop of a record, rebuilt in every corner, and what it makes of a recorded setpoint."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis import mode_poles, share_out, unfold
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.simulate import drive_loop, find_friction
from mtcommission.loop.tuning.tuned import corner_plants, follow
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.measured.measurement import Array
from mtcommission.record.read_back import held_controller, read_held
from mtcommission.record.record import Record
from mtcommission.verify.setpoint import Motion

ComplexArray = NDArray[np.complex128]

LEAD_IN = 2
"""Position cycles of rest before the setpoint moves."""

TOOL, ENCODER, FORCE = 0, 1, 2
"""Columns of a prediction."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rebuilt:
    """The machine and the loop of a record."""

    machine: Machine  # as the record's profile states it, with the force limit of the run
    loops: tuple[SampledLoop, ...]  # in every corner, the nominal machine first
    poles: ComplexArray  # that each mode has become, shape (n_corners, n_modes) [1/s]
    servo_poles: tuple[complex, ...]  # all other poles of the nominal loop, one of each pair [1/s]

    @property
    def plant(self) -> Plant:
        """The nominal plant."""
        return self.loops[0].plant

    @property
    def controller(self) -> Controller:
        """All gains."""
        return self.loops[0].controller


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """What the loop makes of one move of a setpoint."""

    t: Array  # every velocity cycle, in the trace's time [s]
    outputs: Array  # tool, encoder, force relative to rest before, shape (n_corners, n_samples, 3)

    def at(self, t: Array, column: int) -> Array:
        """Return one output at some times in every corner, shape (n_corners, n)."""
        return np.array([np.interp(t, self.t, rows[:, column]) for rows in self.outputs])


def rebuild(record: Record) -> Rebuilt:
    """Return machine and loop of a record, as they were when it was made."""
    machine = read_held(record)
    bench = corner_plants(machine)
    if machine.drive.follows:
        return _with_poles(machine, follow(machine, bench).loops)
    controller = held_controller(machine, bench.model)
    loops = tuple(build_loop(plant, controller, model=bench.model) for plant in bench.plants)
    return _with_poles(machine, loops)


def on_machine(rebuilt: Rebuilt, machine: Machine) -> Rebuilt:
    """Return the same controller, unchanged, on another machine alone."""
    loop = build_loop(build_plant(machine), rebuilt.controller, model=rebuilt.plant)
    return _with_poles(machine, (loop,))


def _with_poles(machine: Machine, loops: tuple[SampledLoop, ...]) -> Rebuilt:
    poles = np.array([mode_poles(loop) for loop in loops])
    plant, dt = loops[0].plant, loops[0].lifted.dt
    own = list(zip(plant.modes, poles[0], strict=True))
    others = tuple(
        complex(pole)
        for pole in share_out(loops[0]).poles
        if pole.imag >= 0.0
        and all(abs(unfold(pole, mode, dt) - one) >= 1e-6 * abs(one) for mode, one in own)
    )
    return Rebuilt(machine=machine, loops=loops, poles=poles, servo_poles=others)


def predict(rebuilt: Rebuilt, motion: Motion) -> Prediction:
    """Return what the loop makes of a recorded move."""
    t, references = cycles_of(rebuilt, motion)
    drive = rebuilt.machine.drive
    outputs = []
    for loop in rebuilt.loops:
        friction = find_friction(
            loop.plant,
            coulomb=drive.coulomb_friction,
            viscous=drive.viscous_friction,
            step=rebuilt.controller.velocity_cycle,
        )
        rows = drive_loop(loop, references, force_limit=drive.usable_force, friction=friction)
        outputs.append(rows[:, [0, 1, 3 + loop.plant.force]])
    return Prediction(t=t, outputs=np.array(outputs))


def cycles_of(rebuilt: Rebuilt, motion: Motion) -> tuple[Array, Array]:
    """Return every velocity cycle of a move [s], and its setpoint at each position cycle."""
    controller = rebuilt.controller
    T_p = controller.position_cycle
    count = ceil((motion.until - motion.begin + controller.reference_delay) / T_p) + LEAD_IN + 2
    start = motion.begin - LEAD_IN * T_p
    references = motion.sample(start + T_p * np.arange(count, dtype=np.float64))
    t = start + controller.velocity_cycle * np.arange(count * controller.cycles, dtype=np.float64)
    return t, references
