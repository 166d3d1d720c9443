"""No loop to tune: a motor that follows its setpoint, in every corner of the machine."""

from __future__ import annotations

from math import inf

import numpy as np

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.model.controller import Controller, no_observer
from mtcommission.loop.tuning.tuned import CornerPlants, TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message

LATE = 2.0
"""How late the motor follows [position cycles]: one until a setpoint acts, and one because between
two setpoints both must be known."""


def follow(machine: Machine, bench: CornerPlants) -> TunedLoop:
    """Return the motor following its setpoint on the machine in every corner.

    Between two setpoints it moves by the cubic that has position and velocity of both, so that no
    impulse gets lost, wherever in a cycle the acceleration steps.

    The machine has a position source; what comes out has no gains, responses and analyses: there is
    no loop whose margins could be told.
    """
    control = machine.control
    controller = Controller(
        position_loop=PositionLoop.DRIVE,
        position_gain=0.0,
        velocity_gain=0.0,
        integral_time=inf,
        reference_model_time=0.0,
        velocity_feedforward=1.0,
        acceleration_feedforward=1.0,
        jerk_feedforward=0.0,
        feedforward_mass=machine.mechanics.moving_mass,
        force_lag=0.0,
        reference_delay=LATE * control.position_cycle,
        velocity_cycle=control.velocity_cycle,
        cycles=round(control.position_cycle / control.velocity_cycle),
        force_filters=(),
        sensors=("encoder",),
        state_gains=np.zeros(bench.model.order),
        observer=no_observer(n_sensors=1),
        follows=True,
    )
    loops = (build_loop(plant, controller, model=bench.model) for plant in bench.plants)
    return TunedLoop(
        controller=controller,
        corners=bench.corners,
        loops=tuple(loops),
        responses=(),
        analyses=(),
        remarks=(Message("loop-motor-follows", delay=controller.reference_delay),),
    )
