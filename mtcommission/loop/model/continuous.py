"""The loop without sampling, for quick looks: every dead time and hold as a Padé delay.

What the sampled loop has and this one has not: the ripple of zero-order holds, the observer (state
feedback reads the true states), saturation. Nothing is judged by this approximation.
"""

from __future__ import annotations

import control
import numpy as np

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.model.assembly import INPUTS
from mtcommission.loop.model.controller import (
    Controller,
    filter_polynomials,
    reference_state,
)
from mtcommission.plant.plant import Plant

PADE_ORDER = 4
"""Order of each Padé approximation: the phase of 6 ms is right to 0.1 degrees up to 300 Hz
(measured)."""


def build_continuous(plant: Plant, controller: Controller, *, model: Plant) -> control.StateSpace:
    """Return the continuous loop from x_ref, v_ref, a_ref, j_ref to tcp, encoder, force.

    Parameters
    ----------
    plant, controller, model
        As for the sampled loop.

    Returns
    -------
    control.StateSpace
        4 inputs, 3 outputs. Where the motor follows its setpoint, of the delayed one.
    """
    if controller.follows:
        return _held_structure(plant)
    held = controller.handing_down_delay
    arrival = controller.reference_age + held
    in_drive = controller.position_loop is PositionLoop.DRIVE
    m = controller.feedforward_mass
    state = controller.state_gains @ reference_state(model, controller)
    encoder = plant.row("encoder")
    force = [
        0.0,
        0.0,
        controller.acceleration_feedforward * m,
        controller.jerk_feedforward * m * controller.force_lag,
    ]
    blocks = [
        control.ss(
            plant.A,
            plant.B[:, None],
            np.vstack([plant.row("tcp"), encoder, encoder @ plant.A, controller.state_gains]),
            np.zeros((4, 1)),
            name="plant",
            inputs=["force"],
            outputs=["tcp", "encoder", "velocity", "feedback"],
        ),
        _delay(0.5 * controller.velocity_cycle, "velocity", "rate"),
        _delay(arrival if in_drive else controller.reference_delay, "x_ref", "x_late"),
        control.ss(
            [],
            [],
            [],
            [[controller.position_gain, -controller.position_gain]],
            name="position",
            inputs=["x_late", "encoder"],
            outputs=["v_asked"],
        ),
        _delay(_correction_delay(controller), "v_asked", "v_held"),
        _delay(controller.velocity_age + held, "v_ref", "v_late"),
        _velocity_controller(controller),
        control.ss(
            [], [], [], [force], name="feedforward", inputs=list(INPUTS), outputs=["f_fed_forward"]
        ),
        _delay(held, "f_fed_forward", "f_held"),
        control.ss([], [], [], [state], name="target", inputs=list(INPUTS), outputs=["f_target"]),
        _delay(arrival, "f_target", "f_state"),
        control.summing_junction(
            ["f_velocity", "f_held", "f_state", "-feedback"], "f_asked", name="sum"
        ),
        _force_path(controller),
    ]
    return control.interconnect(
        blocks, inputs=list(INPUTS), outputs=["tcp", "encoder", "force"], check_unused=False
    )


def _held_structure(plant: Plant) -> control.StateSpace:
    """The modes below a motor that follows: driven by the acceleration itself, without cycles."""
    modal = [i for mode in plant.modes for i in (mode.deflection, mode.rate)]
    B, C, D = np.zeros((len(modal), 4)), np.zeros((3, len(modal))), np.zeros((3, 4))
    B[:, 2] = plant.A[modal, plant.force]
    C[0] = plant.row("tcp")[modal]
    D[:2, 0] = D[2, 2] = 1.0
    return control.ss(plant.A[np.ix_(modal, modal)], B, C, D, inputs=list(INPUTS))


def _correction_delay(controller: Controller) -> float:
    """From the position controller to the velocity controller [s]."""
    T_p, T_v = controller.position_cycle, controller.velocity_cycle
    return 0.0 if controller.position_loop is PositionLoop.DRIVE else T_p + 0.5 * (T_p - T_v)


def _velocity_controller(controller: Controller) -> control.StateSpace:
    """PI law; with a reference model the lagged correction is a second state."""
    Kp, Tn, T_r = (
        controller.velocity_gain,
        controller.integral_time,
        controller.reference_model_time,
    )
    correction = np.array([1.0, 0.0, 0.0])
    error = np.array([1.0, controller.velocity_feedforward, -1.0])
    if T_r:
        A = np.array([[0.0, 1.0], [0.0, -1.0 / T_r]])
        B = np.vstack([error - correction, correction / T_r])
        C = np.array([[Kp / Tn, 0.0]])
    else:
        A, B, C = np.zeros((1, 1)), error[None, :], np.array([[Kp / Tn]])
    return control.ss(
        A,
        B,
        C,
        Kp * error[None, :],
        name="velocity",
        inputs=["v_held", "v_late", "rate"],
        outputs=["f_velocity"],
    )


def _delay(time: float, source: str, target: str) -> control.StateSpace:
    if time == 0.0:
        return control.ss([], [], [], [[1.0]], name=target, inputs=[source], outputs=[target])
    system = control.ss(control.tf(*control.pade(time, PADE_ORDER)))
    return control.ss(system, name=target, inputs=[source], outputs=[target])


def _force_path(controller: Controller) -> control.StateSpace:
    """One velocity cycle of dead time, half a cycle of hold, and the set-force filters."""
    path = control.tf(*control.pade(1.5 * controller.velocity_cycle, 2))
    for item in controller.force_filters:
        path = path * control.tf(*filter_polynomials(item))
    return control.ss(control.ss(path), name="path", inputs=["f_asked"], outputs=["force"])
