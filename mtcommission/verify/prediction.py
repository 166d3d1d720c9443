"""The loop of a record, rebuilt in every corner, and what it makes of a recorded setpoint."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.analysis import mode_poles, share_out, unfold
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.model.controller import Controller, Observer
from mtcommission.loop.simulate import drive_loop, find_friction
from mtcommission.loop.tuning.tuned import corner_plants, follow
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Corner
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.record.loop import LoopPart
from mtcommission.record.read_back import read_machine
from mtcommission.record.record import Record
from mtcommission.verify.setpoint import Motion
from mtcommission.verify.trace import Array

ComplexArray = NDArray[np.complex128]

LEAD_IN = 2
"""Position cycles of rest before the setpoint moves."""

TOOL, ENCODER, FORCE = 0, 1, 2
"""Columns of a prediction."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rebuilt:
    """The machine and the loop of a record."""

    machine: Machine  # As the record's profile states it, with the force limit of the run
    # corners, loops: The nominal machine first.
    corners: tuple[Corner, ...]
    loops: tuple[SampledLoop, ...]
    # Closed-loop pole that each mode has become, shape (n_corners, n_modes) [1/s].
    poles: ComplexArray
    servo_poles: tuple[complex, ...]  # All other poles of the nominal loop, one of each pair [1/s]

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

    t: Array  # Every velocity cycle, in the trace's time [s]
    # Tool, encoder and motor force relative to rest before, shape (n_corners, n_samples, 3).
    outputs: Array

    def at(self, t: Array, column: int) -> Array:
        """Return one output at some times in every corner, shape (n_corners, n)."""
        return np.array([np.interp(t, self.t, rows[:, column]) for rows in self.outputs])


def rebuild(record: Record) -> Rebuilt:
    """Return machine and loop of a record, as they were when it was made."""
    return close_again(read_machine(record), record.loop)


def close_again(machine: Machine, entry: LoopPart) -> Rebuilt:
    """Return the loop of a record on a machine, in every corner."""
    bench = corner_plants(machine)
    if machine.drive.follows:
        return _with_poles(machine, bench.corners, follow(machine, bench).loops)
    controller = _controller(entry, bench.model)
    loops = tuple(build_loop(plant, controller, model=bench.model) for plant in bench.plants)
    return _with_poles(machine, bench.corners, loops)


def on_machine(rebuilt: Rebuilt, machine: Machine) -> Rebuilt:
    """Return the same controller, unchanged, on another machine alone."""
    loop = build_loop(build_plant(machine), rebuilt.controller, model=rebuilt.plant)
    return _with_poles(machine, rebuilt.corners[:1], (loop,))


def _with_poles(
    machine: Machine, corners: tuple[Corner, ...], loops: tuple[SampledLoop, ...]
) -> Rebuilt:
    poles = np.array([mode_poles(loop) for loop in loops])
    plant, dt = loops[0].plant, loops[0].lifted.dt
    others = [
        complex(pole)
        for pole in share_out(loops[0]).poles
        if pole.imag >= 0.0
        and not any(
            abs(unfold(pole, mode, dt) - own) < 1e-6 * abs(own)
            for mode, own in zip(plant.modes, poles[0], strict=True)
        )
    ]
    return Rebuilt(
        machine=machine, corners=corners, loops=loops, poles=poles, servo_poles=tuple(others)
    )


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


def _controller(entry: LoopPart, plant: Plant) -> Controller:
    states, observer = plant.states, entry.observer
    n = len(observer.states)
    if entry.Kv is None or entry.Kp is None or entry.Tn is None:
        raise AssertionError("the record of a servo has its gains")
    return Controller(
        position_loop=PositionLoop(entry.position_loop),
        position_gain=entry.Kv,
        velocity_gain=entry.Kp,
        integral_time=entry.Tn,
        reference_model_time=entry.reference_model_time,
        velocity_feedforward=entry.feedforward.velocity,
        acceleration_feedforward=entry.feedforward.acceleration,
        jerk_feedforward=entry.feedforward.jerk,
        feedforward_mass=entry.feedforward.mass,
        force_lag=entry.force_lag,
        reference_delay=entry.reference_delay,
        velocity_cycle=entry.velocity_cycle,
        cycles=round(entry.position_cycle / entry.velocity_cycle),
        force_filters=tuple(entry.force_filters),
        sensors=tuple(entry.sensors),
        state_gains=np.array([entry.state_feedback.get(name, 0.0) for name in states]),
        observer=Observer(
            states=tuple(states.index(name) for name in observer.states),
            A=np.array(observer.A).reshape(n, n),
            B=np.array(observer.B).reshape(n),
            C=np.array(observer.C).reshape(len(entry.sensors), n),
            L=np.array(observer.L).reshape(n, len(entry.sensors)),
        ),
    )
