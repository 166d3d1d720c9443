"""Kp, Tn, Kv and τ of the cascade: by rules with a source, or of another shape.

- Delay of the force path T_σ = T + 2 T_v + filters (dead time, half for the hold, half for the
  velocity from differences); Kp = f m / (2 T_σ) (symmetrical optimum).
- ω_v = Kp/m; Tn = 4/ω_v (Yaskawa: Tn >= 4/ω_v); Kv = ω_v/4 (speed loop damping 1).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose

import numpy as np

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.model.controller import (
    Controller,
    feedforward_delay,
    filter_delay,
    handing_down_delay,
    no_observer,
)
from mtcommission.machine.control import TcpSensor
from mtcommission.machine.machine import Machine, mid_payload, moving_mass
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """What a loop is beside its Kp; the defaults are the classic rule."""

    position_ratio: float = 0.25  # Kv m / Kp [-]; 1/4: speed loop damping 1
    integral_ratio: float = 4.0  # Tn Kp / m [-]; 4: Yaskawa's lower bound for the speed loop
    mode_weight: float = 0.0
    """Of the state feedback, see ``state_feedback.add_state_feedback`` [-]; 0: none."""


CLASSIC = Shape()


def build_cascade(
    machine: Machine, plant: Plant, *, fraction: float, shape: Shape = CLASSIC
) -> Controller:
    """Return the cascade without state feedback: given gains as given, the rest by its shape.

    Machine and plant are nominal; ``fraction``: f, Kp over the symmetrical optimum [-].
    """
    given, drive = machine.control, machine.drive
    mass = moving_mass(machine) + mid_payload(machine)
    Kp = given.velocity_gain
    if Kp is None:
        Kp = fraction * symmetrical_optimum(machine)
    Tn, Kv = given.integral_time, given.position_gain
    if Tn is None:
        Tn = shape.integral_ratio * mass / Kp
    if Kv is None:
        Kv = shape.position_ratio * Kp / mass
    handing_down = handing_down_delay(
        given.position_loop,
        position_cycle=given.position_cycle,
        velocity_cycle=given.velocity_cycle,
    )
    tau = given.reference_delay
    if tau is None:
        tau = feedforward_delay(
            handing_down=handing_down,
            velocity_cycle=given.velocity_cycle,
            force_lag=drive.force_lag,
            jerk_feedforward=given.jerk_feedforward,
            force_filters=given.force_filters,
        )
    if given.position_loop is PositionLoop.DRIVE:
        tau = max(tau, handing_down)  # the drive knows no newer setpoint
    sensors = ("encoder", "tcp") if given.tcp_sensor is TcpSensor.POSITION else ("encoder",)
    return Controller(
        position_loop=given.position_loop,
        position_gain=Kv,
        velocity_gain=Kp,
        integral_time=Tn,
        reference_model_time=given.reference_model_time,
        velocity_feedforward=given.velocity_feedforward,
        acceleration_feedforward=given.acceleration_feedforward,
        jerk_feedforward=given.jerk_feedforward,
        feedforward_mass=mass if given.feedforward_mass is None else given.feedforward_mass,
        force_lag=drive.force_lag,
        reference_delay=tau,
        velocity_cycle=given.velocity_cycle,
        cycles=round(given.position_cycle / given.velocity_cycle),
        force_filters=given.force_filters,
        sensors=sensors,
        state_gains=np.zeros(plant.order),
        observer=no_observer(n_sensors=len(sensors)),
    )


def symmetrical_optimum(machine: Machine) -> float:
    """Return Kp = m / (2 T_σ) of a nominal machine with the mass at mid payload [N s/m].

    Source: symmetrical optimum (Kessler 1958), T_σ as the sum of the small time constants.
    """
    given = machine.control
    delay = machine.drive.force_lag + 2.0 * given.velocity_cycle
    delay += sum(filter_delay(item) for item in given.force_filters)
    return (moving_mass(machine) + mid_payload(machine)) / (2.0 * delay)


def explain_cascade(machine: Machine, controller: Controller) -> tuple[Message, ...]:
    """Return by which rules the gains of a machine's controller were chosen."""
    given, remarks = machine.control, []
    Kp = controller.velocity_gain
    mass = moving_mass(machine) + mid_payload(machine)
    if given.velocity_gain is None:
        fraction = Kp / symmetrical_optimum(machine)
        if isclose(fraction, 1.0):
            remarks.append(Message("loop-kp-symmetrical-optimum"))
        else:
            remarks.append(Message("loop-kp-largest", fraction=fraction))
    if given.integral_time is None:
        ratio = controller.integral_time * Kp / mass
        is_classic = isclose(ratio, CLASSIC.integral_ratio)
        found = Message("loop-tn-searched", ratio=ratio)
        remarks.append(Message("loop-tn-yaskawa") if is_classic else found)
    if given.position_gain is None:
        ratio = controller.position_gain * mass / Kp
        is_classic = isclose(ratio, CLASSIC.position_ratio)
        found = Message("loop-kv-searched", ratio=ratio)
        remarks.append(Message("loop-kv-damping-one") if is_classic else found)
    if given.reference_delay is None:
        remarks.append(Message("loop-reference-delay"))
    return tuple(remarks)
