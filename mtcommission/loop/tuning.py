"""What the profile leaves out of the controller, by rules with a source.

One of two doors to python-control (LQR, Kalman observer, margins).

Rules
-----
- Delay of the force path T_σ = T + 1.5 T_v + filters; Kp = f m / (2 T_σ) (symmetrical optimum),
  with f <= 1 lowered until the margins hold in every corner.
- ω_v = Kp/m; Tn = 4/ω_v (Yaskawa: Tn >= 4/ω_v); Kv = ω_v/4 (speed loop damping 1).
- State feedback: LQR around the closed cascade, whose cost is the rate of the dominant mode that
  the sensors see; its weight is the one that damps that mode best with the margins kept. A
  stationary Kalman observer supplies the states.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import control
import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.analysis import (
    FrequencyResponse,
    LoopAnalysis,
    analyse_loop,
    frequency_response,
)
from mtcommission.loop.controller import (
    Controller,
    Observer,
    feedforward_delay,
    filter_delay,
    no_observer,
)
from mtcommission.loop.sampled import LiftedLoop, SampledLoop, build_loop, discretise, lift_loop
from mtcommission.machine import (
    NOMINAL,
    Corner,
    Machine,
    StateFeedback,
    TcpSensor,
    corners,
    mid_payload,
    moving_mass,
    vary,
)
from mtcommission.plant import Plant, PlantMode, build_plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningSettings:
    """What a tuned loop must reach, and how its observer sees noise.

    Parameters
    ----------
    gain_margin_db, phase_margin_deg, sensitivity_peak
        Required in every corner; Åström & Hägglund recommend 6 ... 14 dB, 30 ... 60 degrees and
        1.2 ... 2.0.
    reserve_deg
        Phase that the cascade alone keeps above that, for the state feedback to spend (empirical).
    mode_weights
        Weights of the dominant mode's squared rate against the squared force, both in units of
        what F_max does to the mode; the best one with margins is taken.
    reduction
        Factor from one try of Kp to the next.
    force_noise, position_noise
        Standard deviations that the observer assumes: unknown force relative to F_max [-] and
        encoder error [m] (empirical: they set its bandwidth, not the loop's accuracy).
    """

    gain_margin_db: float = 6.0
    phase_margin_deg: float = 30.0
    reserve_deg: float = 5.0
    sensitivity_peak: float = 2.0
    mode_weights: tuple[float, ...] = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
    reduction: float = 0.92
    force_noise: float = 0.05
    position_noise: float = 1e-7


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TunedLoop:
    """A controller in every corner of the machine.

    Parameters
    ----------
    controller
        With every gain resolved.
    corners
        The nominal machine first.
    loops, lifted, responses, analyses
        One for each corner.
    remarks
        What was chosen, by which rule, and what could not be done; sentences for the sheet.
    """

    controller: Controller
    corners: tuple[Corner, ...]
    loops: tuple[SampledLoop, ...]
    lifted: tuple[LiftedLoop, ...]
    responses: tuple[FrequencyResponse, ...]
    analyses: tuple[LoopAnalysis, ...]
    remarks: tuple[str, ...]

    @property
    def nominal(self) -> LoopAnalysis:
        """Analysis of the nominal machine."""
        return self.analyses[0]


def tune_loop(machine: Machine, *, settings: TuningSettings | None = None) -> TunedLoop:
    """Return the controller of a machine, given gains as given and the rest by rule.

    Parameters
    ----------
    machine
        Machine with its control block.
    settings
        Required margins; None: the defaults.

    Returns
    -------
    TunedLoop

    Raises
    ------
    ComputationError
        UNSTABLE_LOOP if given gains are unstable in a corner; BANDWIDTH_OUT_OF_REACH if no
        stable loop has the margins and the minimum bandwidth; NOT_OBSERVABLE if a given state
        gain needs a state that the sensors do not see.
    """
    settings = settings or TuningSettings()
    cascade = _tune_cascade(machine, settings)
    given = machine.control.state_feedback
    if given is StateFeedback.OFF:
        return cascade
    if given is StateFeedback.GIVEN:
        return _with_given_gains(machine, cascade, settings)
    return _with_active_damping(machine, cascade, settings)


def _tune_cascade(machine: Machine, settings: TuningSettings) -> TunedLoop:
    given = machine.control
    fixed = given.velocity_gain is not None and given.position_gain is not None
    reserved = settings
    if given.state_feedback is StateFeedback.AUTO:
        reserved = replace(
            settings, phase_margin_deg=settings.phase_margin_deg + settings.reserve_deg
        )
    fraction = 1.0
    while True:
        controller = _cascade(machine, fraction)
        tuned = _close(machine, controller, remarks=_cascade_remarks(machine, fraction, controller))
        if fixed and given.integral_time is not None:
            return _judge_given(tuned, settings)
        if _has_margins(tuned, reserved):
            break
        fraction *= settings.reduction
        slowest = min(analysis.bandwidth_hz for analysis in tuned.analyses)
        if fraction < LEAST_FRACTION or slowest < given.minimum_bandwidth_hz:
            if fixed:
                return _judge_given(tuned, settings)
            detail = (
                f"at Kp = {controller.velocity_gain:.4g} N s/m the bandwidth is {slowest:.3g} Hz "
                f"(minimum_bandwidth {given.minimum_bandwidth_hz:.3g} Hz) and the margins are "
                f"{_margins(tuned)}"
            )
            raise ComputationError(Outcome.BANDWIDTH_OUT_OF_REACH, detail)
    slowest = min(analysis.bandwidth_hz for analysis in tuned.analyses)
    if slowest < given.minimum_bandwidth_hz:
        detail = (
            f"the fastest loop with the margins has {slowest:.3g} Hz, "
            f"wanted {given.minimum_bandwidth_hz:.3g} Hz"
        )
        raise ComputationError(Outcome.BANDWIDTH_OUT_OF_REACH, detail)
    return tuned


LEAST_FRACTION = 0.01
"""Below a hundredth of the symmetrical optimum a loop is not tuned but given up (empirical)."""


def _cascade(machine: Machine, fraction: float) -> Controller:
    given, drive = machine.control, machine.drive
    mass = moving_mass(machine) + mid_payload(machine)
    delay = drive.force_lag + 1.5 * given.velocity_cycle
    delay += sum(filter_delay(item) for item in given.force_filters)
    Kp = given.velocity_gain if given.velocity_gain is not None else fraction * mass / (2 * delay)
    omega_v = Kp / mass
    # Where Kp is given, the fraction slows the outer loops instead.
    slowed = omega_v * (fraction if given.velocity_gain is not None else 1.0)
    Tn = given.integral_time if given.integral_time is not None else 4.0 / slowed
    Kv = given.position_gain if given.position_gain is not None else slowed / 4.0
    tau = given.reference_delay
    if tau is None:
        tau = feedforward_delay(
            position_cycle=given.position_cycle,
            velocity_cycle=given.velocity_cycle,
            force_lag=drive.force_lag,
            jerk_feedforward=given.jerk_feedforward,
            force_filters=given.force_filters,
        )
    sensors = ("encoder", "tcp") if given.tcp_sensor is TcpSensor.POSITION else ("encoder",)
    plant = build_plant(machine)
    return Controller(
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


def _close(machine: Machine, controller: Controller, *, remarks: tuple[str, ...]) -> TunedLoop:
    """Put the controller on the machine in every corner."""
    places = corners(machine)
    model = build_plant(machine)
    plants = [build_plant(vary(machine, corner)) for corner in places]
    loops = tuple(build_loop(plant, controller, model=model) for plant in plants)
    lifted = tuple(lift_loop(loop) for loop in loops)
    responses = tuple(frequency_response(plant, controller) for plant in plants)
    return TunedLoop(
        controller=controller,
        corners=places,
        loops=loops,
        lifted=lifted,
        responses=responses,
        analyses=tuple(map(analyse_loop, plants, responses, lifted)),
        remarks=remarks,
    )


def _has_margins(tuned: TunedLoop, settings: TuningSettings) -> bool:
    return all(
        analysis.is_stable
        and analysis.gain_margin_db >= settings.gain_margin_db
        and analysis.phase_margin_deg >= settings.phase_margin_deg
        and analysis.sensitivity_peak <= settings.sensitivity_peak
        for analysis in tuned.analyses
    )


def _margins(tuned: TunedLoop) -> str:
    gain = min(analysis.gain_margin_db for analysis in tuned.analyses)
    phase = min(analysis.phase_margin_deg for analysis in tuned.analyses)
    peak = max(analysis.sensitivity_peak for analysis in tuned.analyses)
    return f"{gain:.3g} dB, {phase:.3g} degrees, sensitivity peak {peak:.3g} (worst corner)"


def _judge_given(tuned: TunedLoop, settings: TuningSettings) -> TunedLoop:
    unstable = [
        corner
        for corner, analysis in zip(tuned.corners, tuned.analyses, strict=True)
        if not analysis.is_stable
    ]
    if unstable:
        where = "the nominal machine" if unstable[0] == NOMINAL else str(unstable[0])
        detail = (
            f"with Kv = {tuned.controller.position_gain:.4g} 1/s, "
            f"Kp = {tuned.controller.velocity_gain:.4g} N s/m, "
            f"Tn = {tuned.controller.integral_time:.4g} s on {where}"
        )
        raise ComputationError(Outcome.UNSTABLE_LOOP, detail)
    if _has_margins(tuned, settings):
        return tuned
    poor = (
        f"The given gains are used as given, but their margins are poor: {_margins(tuned)}; "
        f"wanted are {settings.gain_margin_db:g} dB, {settings.phase_margin_deg:g} degrees, "
        f"sensitivity peak at most {settings.sensitivity_peak:g}."
    )
    return replace(tuned, remarks=(*tuned.remarks, poor))


def _cascade_remarks(machine: Machine, fraction: float, controller: Controller) -> tuple[str, ...]:
    given, remarks = machine.control, []
    if given.velocity_gain is None:
        share = "" if fraction == 1.0 else f" x {fraction:.2f} (lowered until the margins hold)"
        remarks.append(f"Kp by the symmetrical optimum, m / (2 T_sigma){share}.")
    if given.integral_time is None:
        remarks.append("Tn = 4 m / Kp (Yaskawa's lower bound for the speed loop).")
    if given.position_gain is None:
        remarks.append("Kv = Kp / (4 m): speed loop damping 1.")
    if given.reference_delay is None:
        remarks.append(
            "Reference delay: 1.5 position cycles + 1 velocity cycle + the force lag that the "
            "jerk feed-forward leaves + the filters, so that feed-forward and feedback meet."
        )
    return tuple(remarks)


def _with_active_damping(
    machine: Machine, cascade: TunedLoop, settings: TuningSettings
) -> TunedLoop:
    """Add the state feedback that damps the dominant visible mode best and keeps the margins."""
    plant, sensors = build_plant(machine), cascade.controller.sensors
    unseen = [mode.name for mode in plant.modes if not _is_seen(mode, sensors)]
    blind = (
        f" The sensors do not see mode {', '.join(unseen)}: no feedback can damp it."
        if unseen
        else ""
    )
    mode = _dominant_mode(plant, sensors)
    if mode is None:
        return replace(cascade, remarks=(*cascade.remarks, f"No state feedback.{blind}"))
    observer = _design_observer(machine, plant, cascade.controller, settings)
    index = plant.modes.index(mode)
    before = float(cascade.nominal.mode_damping[index])
    best, reached = cascade, before
    for weight in settings.mode_weights:
        gains = _mode_gains(machine, plant, cascade.controller, mode, weight, observer.states)
        controller = replace(cascade.controller, state_gains=gains, observer=observer)
        tuned = _close(machine, controller, remarks=cascade.remarks)
        damping = float(tuned.nominal.mode_damping[index])
        if damping > reached and _has_margins(tuned, settings):
            best, reached = tuned, damping
    if best is cascade:
        remark = (
            f"No state feedback: none damps mode {mode.name} better than the cascade alone "
            f"(damping ratio {before:.3g}) with the margins kept.{blind}"
        )
    else:
        remark = (
            f"State feedback (LQR around the cascade, Kalman observer on {' and '.join(sensors)}): "
            f"damping ratio of mode {mode.name} {mode.damping_ratio:.3g} without control, "
            f"{before:.3g} with the cascade, {reached:.3g} with state feedback.{blind}"
        )
    return replace(best, remarks=(*cascade.remarks, remark))


def _with_given_gains(machine: Machine, cascade: TunedLoop, settings: TuningSettings) -> TunedLoop:
    plant = build_plant(machine)
    gains = np.zeros(plant.order)
    for item in machine.control.state_gains:
        gains[plant.states.index(item.state)] = item.value
    observer = _design_observer(machine, plant, cascade.controller, settings)
    hidden = [plant.states[i] for i in np.flatnonzero(gains) if i not in observer.states]
    if hidden:
        raise ComputationError(Outcome.NOT_OBSERVABLE, f"state feedback of {', '.join(hidden)}")
    controller = replace(cascade.controller, state_gains=gains, observer=observer)
    return _judge_given(_close(machine, controller, remarks=cascade.remarks), settings)


def _is_seen(mode: PlantMode, sensors: tuple[str, ...]) -> bool:
    return mode.measured_gain != 0.0 or ("tcp" in sensors and mode.tcp_gain != 0.0)


def _dominant_mode(plant: Plant, sensors: tuple[str, ...]) -> PlantMode | None:
    """The visible mode with the largest static deflection of the tool per newton."""
    seen = [mode for mode in plant.modes if _is_seen(mode, sensors)]
    if not seen:
        return None
    return max(seen, key=lambda mode: abs(mode.tcp_gain) / mode.natural_frequency**2)


def _mode_gains(
    machine: Machine,
    plant: Plant,
    controller: Controller,
    mode: PlantMode,
    weight: float,
    observed: tuple[int, ...],
) -> Array:
    """LQR gains on the observed plant states, shape (n_plant,).

    The design model is the plant under its continuous cascade, with the integrator as last
    state, without the modes that no sensor sees (no gain can use them) and with a trace of
    damping on every mode: so its Riccati equation has a stabilising solution even where a
    mode is stated as undamped. The gain on the integrator is left out: the cost does not
    weigh it.
    """
    n, Kp = plant.order, controller.velocity_gain
    encoder = plant.row("encoder")
    A = np.zeros((n + 1, n + 1))
    A[:n, :n] = plant.A
    A[n, :n] = -(encoder @ plant.A + controller.position_gain * encoder) / controller.integral_time
    law = Kp * np.concatenate([encoder @ plant.A + controller.position_gain * encoder, [-1.0]])
    B = np.append(plant.B, 0.0)[:, None]
    # States in units of what F_max does at the mode's frequency: all numbers near 1.
    force, omega = machine.drive.max_force, mode.natural_frequency
    scale = np.full(n + 1, force / (plant.moving_mass * omega**2))
    scale[[plant.velocity, n]] *= omega
    scale[plant.force] = force
    for item in plant.modes:
        scale[item.deflection] = abs(item.scale) * force / omega**2
        scale[item.rate] = abs(item.scale) * force / omega
        zeta = max(item.damping_ratio, LEAST_DESIGN_DAMPING)
        A[item.rate, item.rate] = -2.0 * zeta * item.natural_frequency
    A = (A - B * law) * scale / scale[:, None] / omega
    Q = np.zeros((n + 1, n + 1))
    Q[mode.rate, mode.rate] = weight
    kept = [*observed, n]
    inside = np.ix_(kept, kept)
    K, _, _ = control.lqr(
        A[inside], (B * force / scale[:, None] / omega)[kept], Q[inside], np.eye(1)
    )
    gains = np.zeros(n)
    gains[kept[:-1]] = (K[0] * force / scale[kept])[:-1]
    return gains


LEAST_DESIGN_DAMPING = 1e-4
"""Damping ratio that the design of the state feedback takes for granted (empirical: far below
any real joint, and enough for the Riccati solver)."""


def _design_observer(
    machine: Machine, plant: Plant, controller: Controller, settings: TuningSettings
) -> Observer:
    """Stationary Kalman observer at the velocity cycle for everything that the sensors see."""
    modes = [mode for mode in plant.modes if _is_seen(mode, controller.sensors)]
    states = [plant.position, plant.velocity]
    states += [index for mode in modes for index in (mode.deflection, mode.rate)]
    states.append(plant.force)
    A, B = discretise(plant, controller.velocity_cycle)
    A, B = A[np.ix_(states, states)], B[states]
    C = np.array([plant.row(sensor) for sensor in controller.sensors])[:, states]
    # Noises of variance 1, so that the Riccati equation sees no extreme weights.
    force = settings.force_noise * machine.drive.max_force
    noise = settings.position_noise
    G, unit = force * B[:, None], np.eye(1)
    L, _, _ = control.dlqe(A, G, C / noise, unit, np.eye(len(controller.sensors)))
    # control.dlqe gives the gain of the filter form; the predicting form needs A L.
    return Observer(states=tuple(states), A=A, B=B, C=C, L=A @ L / noise)
