"""Gains of a loop: of the cascade by rules with a source or of another shape, of state feedback.

- Delay of the force path T_σ = T + 2 T_v + filters (dead time, half for the hold, half for the
  velocity from differences); Kp = f m / (2 T_σ) (symmetrical optimum).
- ω_v = Kp/m; Tn = 4/ω_v (Yaskawa: Tn >= 4/ω_v); Kv = ω_v/4 (speed loop damping 1).
- State feedback damps the tool: LQR around the closed cascade, states by a Kalman observer.

Tuning asks for some forty regulators a machine, of one input and some ten states: too small for the
balancing and the pencils of ``scipy.linalg.solve_continuous_are``, which agrees to 4e-10, but takes
seven times as long and gives an oscillator that nothing damps gains instead of an error.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR
from math import isclose

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_discrete_are
from scipy.linalg.lapack import dgees

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import PositionLoop
from mtcommission.controls.row import round_number
from mtcommission.loop.model.assembly import discretise
from mtcommission.loop.model.controller import Controller, Observer
from mtcommission.loop.tuning.tuned import CLASSIC, TUNING, Shape
from mtcommission.machine.machine import Machine, mid_payload, moving_mass
from mtcommission.machine.plant.plant import Plant, PlantMode


def build_cascade(
    machine: Machine, plant: Plant, *, fraction: float, shape: Shape = CLASSIC
) -> Controller:
    """Return the cascade without state feedback: given gains as given, the rest by its shape.

    Machine and plant are nominal; ``fraction``: f, Kp over the symmetrical optimum [-]. What is not
    given has the digits that are typed in, rounded to the soft side.
    """
    given, mass = machine.control, believed_mass(machine)
    Kp, Tn, Kv = given.velocity_gain, given.integral_time, given.position_gain
    if Kp is None:
        Kp = float(round_number(fraction * symmetrical_optimum(machine), ROUND_FLOOR))
    if Kv is None:
        Kv = float(round_number(shape.position_ratio * Kp / mass, ROUND_FLOOR))
    if Tn is None:
        Tn = float(round_number(shape.integral_ratio * mass / Kp, ROUND_CEILING))
    controller = Controller(
        position_loop=given.position_loop,
        position_gain=Kv,
        velocity_gain=Kp,
        integral_time=Tn,
        reference_model_time=given.reference_model_time,
        velocity_feedforward=given.velocity_feedforward,
        acceleration_feedforward=given.acceleration_feedforward,
        jerk_feedforward=given.jerk_feedforward,
        feedforward_mass=mass if given.feedforward_mass is None else given.feedforward_mass,
        force_lag=machine.drive.force_lag,
        reference_delay=0.0,
        velocity_cycle=given.velocity_cycle,
        cycles=round(given.position_cycle / given.velocity_cycle),
        force_filters=given.force_filters,
        sensors=("encoder", "tcp") if given.has_tcp_sensor else ("encoder",),
        state_gains=np.zeros(plant.order),
    )
    tau = given.reference_delay
    tau = controller.feedforward_delay if tau is None else tau
    if given.position_loop is PositionLoop.DRIVE:
        tau = max(tau, controller.handing_down_delay)  # the drive knows no newer setpoint
    return replace(controller, reference_delay=tau)


def believed_mass(machine: Machine) -> float:
    """Return the moving mass at mid payload [kg]: what the controller is made for."""
    return moving_mass(machine) + mid_payload(machine)


def symmetrical_optimum(machine: Machine) -> float:
    """Return Kp = m / (2 T_σ) of a nominal machine with the mass at mid payload [N s/m].

    Source: symmetrical optimum (Kessler 1958), T_σ as the sum of the small time constants.
    """
    given = machine.control
    delay = machine.drive.force_lag + 2.0 * given.velocity_cycle
    delay += sum(item.delay for item in given.force_filters)
    return believed_mass(machine) / (2.0 * delay)


TN_REMARKS = "loop-tn-yaskawa", "loop-tn-searched"
KV_REMARKS = "loop-kv-damping-one", "loop-kv-searched"
"""By the classic rule, or by another ratio."""

TYPED = 2e-3
"""What two gains of four digits may lie beside their ratio [-]."""


def explain_cascade(machine: Machine, controller: Controller) -> tuple[Message, ...]:
    """Return by which rules the gains of a machine's controller were chosen."""
    given, mass, remarks = machine.control, believed_mass(machine), []
    Kp = controller.velocity_gain
    fraction = Kp / symmetrical_optimum(machine)
    if given.velocity_gain is None:
        is_optimum, found = (
            isclose(fraction, 1.0, rel_tol=TYPED),
            Message("loop-kp-largest", fraction=fraction),
        )
        remarks.append(Message("loop-kp-symmetrical-optimum") if is_optimum else found)
    integral, position = controller.integral_time * Kp / mass, controller.position_gain * mass / Kp
    for gain, ratio, classic, rule, searched in (
        (given.integral_time, integral, CLASSIC.integral_ratio, *TN_REMARKS),
        (given.position_gain, position, CLASSIC.position_ratio, *KV_REMARKS),
    ):
        if gain is None:
            found = Message(searched, ratio=ratio)
            remarks.append(Message(rule) if isclose(ratio, classic, rel_tol=TYPED) else found)
    if given.reference_delay is None:
        remarks.append(Message("loop-reference-delay"))
    return tuple(remarks)


Array = NDArray[np.float64]


def is_seen(mode: PlantMode, sensors: tuple[str, ...]) -> bool:
    """Return whether a mode shows in any of the sensors (names of measured outputs)."""
    return mode.measured_gain != 0.0 or ("tcp" in sensors and mode.tcp_gain != 0.0)


def moving_modes(plant: Plant, sensors: tuple[str, ...]) -> tuple[PlantMode, ...]:
    """Return the visible modes that move the tool, the one that moves it most first."""
    visible = [mode for mode in plant.modes if is_seen(mode, sensors) and mode.tcp_gain]
    return tuple(sorted(visible, key=_tool_share, reverse=True))


def _tool_share(mode: PlantMode) -> float:
    """How far the tool moves by the mode, over the rate q' that this takes."""
    return abs(mode.tcp_gain) / mode.natural_frequency


def given_state_feedback(machine: Machine, plant: Plant, cascade: Controller) -> Controller:
    """Return the cascade with the state gains that the profile gives; machine and plant nominal.

    Raises
    ------
    ComputationError
        NOT_OBSERVABLE if a gain needs a state that the sensors do not see;
        FEEDBACK_DESIGN_FAILED if the observer cannot be computed.
    """
    gains = np.zeros(plant.order)
    for item in machine.control.state_gains:
        gains[plant.states.index(item.name)] = item.value
    observer = design_observer(machine, plant, cascade)
    hidden = tuple(plant.states[i] for i in np.flatnonzero(gains) if i not in observer.states)
    if hidden:
        detail = Message("loop-hidden-states", states=hidden)
        raise ComputationError(Outcome.NOT_OBSERVABLE, detail)
    return replace(cascade, state_gains=gains, observer=observer)


def design_observer(machine: Machine, plant: Plant, cascade: Controller) -> Observer:
    """Return the stationary Kalman observer at the velocity cycle for all that the sensors see.

    Machine and plant are nominal.
    """
    modes = [mode for mode in plant.modes if is_seen(mode, cascade.sensors)]
    states = [plant.position, plant.velocity]
    states += [index for mode in modes for index in (mode.deflection, mode.rate)]
    states.append(plant.force)
    T_v, F_max = cascade.velocity_cycle, machine.drive.max_force
    A, B = discretise(plant, T_v)
    noises = np.zeros((plant.order, 1 + len(modes)))
    noises[:, 0] = TUNING.force_noise * F_max * B
    for column, mode in enumerate(modes, start=1):
        noises[mode.rate, column] = TUNING.mode_noise * F_max * mode.scale * T_v
    A, B, G = A[np.ix_(states, states)], B[states], noises[states]
    C = np.array([plant.row(sensor) for sensor in cascade.sensors])[:, states]
    # Noises of variance 1 and states in units of what they move by in a cycle under F_max, so
    # that the Riccati equation sees no extreme numbers.
    scale = np.abs(B) * F_max
    scaled = (A * scale / scale[:, None], G / scale[:, None], C * scale / TUNING.position_noise)
    with _riccati_errors("loop-observer-failed"):
        L = observer_gains(*scaled) * scale[:, None] / TUNING.position_noise
    return Observer(states=tuple(states), A=A, B=B, C=C, L=L)


def feedback_gains(
    machine: Machine, plant: Plant, cascade: Controller, *, weight: float, observed: tuple[int, ...]
) -> Array:
    """Return LQR gains on the observed plant states that damp what moves the tool, (n_plant,).

    Machine and plant are nominal, ``cascade`` is without state feedback. ``weight``: of the squared
    vibration of the tool against the squared force, in units of what F_max does to the mode that
    moves the tool most [-].

    The design model is the plant under its continuous cascade, with the integrator as last state,
    without the modes that no sensor sees (no gain can use them) and with a trace of damping on
    every mode: so its Riccati equation has a stabilising solution even where a mode is stated as
    undamped. The gain on the integrator is left out: the cost does not weigh it.
    """
    n, encoder = plant.order, plant.row("encoder")
    lag = encoder @ plant.A + cascade.position_gain * encoder
    A = np.zeros((n + 1, n + 1))
    A[:n, :n] = plant.A
    A[n, :n] = -lag / cascade.integral_time
    law, B = cascade.velocity_gain * np.append(lag, -1.0), np.append(plant.B, 0.0)
    # States in units of what F_max does at the first mode's frequency: all numbers near 1.
    damped = moving_modes(plant, cascade.sensors)
    force, omega = machine.drive.max_force, damped[0].natural_frequency
    scale = np.full(n + 1, force / (plant.moving_mass * omega**2))
    scale[[plant.velocity, n]] *= omega
    scale[plant.force] = force
    for item in plant.modes:
        scale[item.deflection] = abs(item.scale) * force / omega**2
        scale[item.rate] = abs(item.scale) * force / omega
        zeta = max(item.damping_ratio, LEAST_DAMPING)
        A[item.rate, item.rate] = -2.0 * zeta * item.natural_frequency
    A = (A - np.outer(B, law)) * scale / scale[:, None] / omega
    Q = np.zeros((n + 1, n + 1))
    for item in damped:
        Q[item.rate, item.rate] = weight * (_tool_share(item) / _tool_share(damped[0])) ** 2
    kept = [*observed, n]
    inside = np.ix_(kept, kept)
    B = (B * force / scale / omega)[kept]
    with _riccati_errors("loop-gains-failed"):
        K = regulator_gains(A[inside], B, Q[inside])
    gains = np.zeros(n)
    gains[kept[:-1]] = (K * force / scale[kept])[:-1]
    return gains


@contextmanager
def _riccati_errors(kind: str) -> Iterator[None]:
    """Name what scipy raises where a Riccati equation defeats them."""
    try:
        yield
    except (ValueError, np.linalg.LinAlgError) as error:
        detail = Message(kind, error=str(error))
        raise ComputationError(Outcome.FEEDBACK_DESIGN_FAILED, detail) from error


LEAST_DAMPING = 1e-4
"""Damping ratio that the design of the state feedback takes for granted (empirical: far below
any real joint, and enough for the Riccati solver)."""

LEAST_DECAY = 1e-7
"""What decays more slowly, in numbers near 1, is taken for undamped: rounding parts a double
eigenvalue on the imaginary axis by some 1e-8, the root of the machine accuracy."""


def regulator_gains(A: Array, B: Array, Q: Array) -> Array:
    """Return the K of u = -K x that minimises the integral of xᵀ Q x + u² under ẋ = A x + B u.

    All scaled to numbers near 1. K = Bᵀ X, shape (n,), where the columns of (I; X) span what of the
    Hamiltonian matrix H = (A, -B Bᵀ; -Q, -Aᵀ) decays: with an ordered Schur basis (U₁; U₂) of it,
    X = U₂ U₁⁻¹.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a number is not finite, or H has eigenvalues on the imaginary axis: what no input
        moves neither decays by itself, or what does not decay is not weighed.

    Source: Laub, A Schur method for solving algebraic Riccati equations, IEEE Trans. AC-24
    (1979), eqs. (5) to (8).
    """
    n, hamiltonian = len(A), np.block([[A, -np.outer(B, B)], [-Q, -A.T]])
    if not np.isfinite(hamiltonian).all():
        raise np.linalg.LinAlgError("a number is not finite")
    # LAPACK itself: it tells the eigenvalues, too.
    _, decaying, rates, _, basis, _, info = dgees(lambda rate, _: rate < 0.0, hamiltonian, sort_t=1)
    if info or decaying != n or np.max(rates[:n]) > -LEAST_DECAY:
        raise np.linalg.LinAlgError("no gain damps every state")
    # X is symmetric, so K = Bᵀ U₂ U₁⁻¹ solves U₁ᵀ Kᵀ = U₂ᵀ B.
    return np.asarray(np.linalg.solve(basis[:n, :n].T, basis[n:, :n].T @ B))


def observer_gains(A: Array, G: Array, C: Array) -> Array:
    """Return the L of x̂⁺ = A x̂ + L (y - C x̂) with the least error under white noises.

    The plant is x⁺ = A x + G w, y = C x + v, all noises have variance 1. L = A P Cᵀ (C P Cᵀ + I)⁻¹,
    shape (n, n_sensors), the predicting form, with P from the Riccati equation.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the equation has no stabilising solution.

    Source: Anderson & Moore, Optimal Filtering (1979), sec. 4.1.
    """
    P = solve_discrete_are(A.T, C.T, G @ G.T, np.eye(len(C)))
    return np.asarray(np.linalg.solve(C @ P @ C.T + np.eye(len(C)), C @ P @ A.T).T)
