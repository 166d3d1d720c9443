"""Machine -> remarks: what is allowed, but so unusual that it may be a slip.

A remark never stops anything. The bounds are empirical: the range of machine tool axes in the
literature, widened generously.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, log

from mtcommission.machine.machine import (
    FlexibleMode,
    Machine,
    Manipulator,
    Motion,
    VelocityStep,
    moving_mass,
)
from mtcommission.machine.mechanics import flexible_modes, frequency_hz
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.units.quantities import convert_to

DAMPING_RATIOS = (0.002, 0.3)
LOWEST_FREQUENCY_HZ = 1.0
SAMPLES_PER_PERIOD = 3.0
"""Empirical: below 2 the mode is folded to a lower frequency (sampling theorem), below 3 its
phase is too uncertain to be used."""
POSITION_CYCLES_PER_PERIOD = 5.0
ACCELERATIONS = {Motion.LINEAR: (0.01, 1e3), Motion.ROTARY: (0.01, 1e5)}
DEVIATIONS = {Motion.LINEAR: (1e-8, 1e-2), Motion.ROTARY: (1e-8, 1e-2)}
VELOCITIES = {Motion.LINEAR: 10.0, Motion.ROTARY: 1e3}
LEAST_POSITION_GAIN = 6.0
"""Below 0.36 (m/min)/mm somebody has left out that unit."""
LOAD_SHARE = 0.5
PAYLOAD_RATIO = 3.0
DEFLECTION_RATIO = 1e3
GAIN_RATIO = 100.0
FEEDFORWARD_RATIO = 1.5
LONGEST_FORCE_LAG = 0.02
LONGEST_MOVE = 60.0
LONGEST_RINGING = 10.0
SHORTEST_VELOCITY_CYCLE = 20e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Remark:
    """Something unusual in a machine.

    Parameters
    ----------
    key
        Key of the profile, elements of arrays counted from 1.
    message
        What was found, with numbers and units, and what it means.
    """

    key: str
    message: str


def check_plausibility(machine: Machine) -> tuple[Remark, ...]:
    """Return what a commissioning engineer would ask about.

    Parameters
    ----------
    machine
        Nominal machine, valid.

    Returns
    -------
    tuple of Remark
        Empty if nothing is unusual.

    Examples
    --------
    >>> from mtcommission.machine.machine import Drive, Modal, Modes, Requirements, VelocityStep
    >>> axis = Machine(name="a", axis="X", source="example",
    ...     mechanics=Modal(moving_mass=100.0, modes=(FlexibleMode(name="column",
    ...         natural_frequency=250.0, damping_ratio=0.5, tcp_gain=0.01),)),
    ...     drive=Drive(force_lag=2e-3, max_force=1e3), moves=(VelocityStep(velocity_step=0.1),),
    ...     requirements=Requirements(tcp_deviation=1e-5,
    ...         modes=Modes(surface=4e-6, accuracy=1e-5, speed=4e-5)))
    >>> [remark.key for remark in check_plausibility(axis)]
    ['plant.modes[1]']
    """
    modes = flexible_modes(machine)
    return (
        *(remark for i, mode in enumerate(modes) for remark in _check_mode(machine, mode, i)),
        *_check_drive(machine),
        *_check_moves(machine),
        *_check_requirements(machine),
        *_check_control(machine),
    )


def check_patience(machine: Machine) -> tuple[Remark, ...]:
    """Return what makes every computation take long: slow modes, and very short cycles.

    Parameters
    ----------
    machine
        Nominal machine, valid.

    Returns
    -------
    tuple of Remark
        Empty if every mode has decayed to 1 % within 10 s, exp(-zeta omega t) = 0.01, and the
        velocity cycle is at least 20 us.
    """
    remarks = []
    for i, mode in enumerate(flexible_modes(machine)):
        decay = mode.damping_ratio * mode.natural_frequency
        ringing = log(100.0) / decay if decay > 0.0 else inf
        if ringing > LONGEST_RINGING:
            lasts = f"for {ringing:.3g} s until 1 % is left" if decay > 0.0 else "for ever"
            message = (
                f"mode {mode.name}: {frequency_hz(mode):.3g} Hz at a damping ratio of "
                f"{mode.damping_ratio:.3g} rings {lasts}; limits, simulate and run follow it that "
                "long and may take minutes"
            )
            remarks.append(Remark(key=_mode_key(machine, i), message=message))
    cycle = machine.control.velocity_cycle
    if cycle < SHORTEST_VELOCITY_CYCLE:
        message = (
            f"{1e6 * cycle:.3g} us is shorter than drives have, 31.25 us to 1 ms; limits, "
            "simulate and run follow every cycle and may take minutes"
        )
        remarks.append(Remark(key="control.velocity_cycle", message=message))
    return tuple(remarks)


def _mode_key(machine: Machine, index: int) -> str:
    is_manipulator = isinstance(machine.mechanics, Manipulator)
    return "plant" if is_manipulator else f"plant.modes[{index + 1}]"


def _check_mode(machine: Machine, mode: FlexibleMode, index: int) -> list[Remark]:
    is_manipulator = isinstance(machine.mechanics, Manipulator)
    key = _mode_key(machine, index)
    f, zeta, control = frequency_hz(mode), mode.damping_ratio, machine.control
    low, high = DAMPING_RATIOS
    remarks = []

    def add(text: str) -> None:
        remarks.append(Remark(key=key, message=f"mode {mode.name}: {text}"))

    if not low <= zeta <= high:
        side = "below" if zeta < low else "above"
        add(f"damping ratio {zeta:.3g} is {side} what machine structures show, {low:g} to {high:g}")
    if f < LOWEST_FREQUENCY_HZ:
        add(f"{f:.3g} Hz is slower than any machine structure; check stiffness and mass")
    in_velocity, in_position = (
        1.0 / (f * cycle) for cycle in (control.velocity_cycle, control.position_cycle)
    )
    if in_velocity < SAMPLES_PER_PERIOD:
        add(
            f"{f:.3g} Hz is above a third of the velocity loop's sampling rate, "
            f"{1.0 / control.velocity_cycle:.4g} Hz; no feedback can damp it"
        )
    if in_position < SAMPLES_PER_PERIOD:
        add(
            f"{f:.3g} Hz is above a third of the position loop's sampling rate, "
            f"{1.0 / control.position_cycle:.4g} Hz; setpoints at that cycle cannot shape it"
        )
    elif in_position < POSITION_CYCLES_PER_PERIOD:
        add(
            f"one period has only {in_position:.2g} position cycles of "
            f"{1e3 * control.position_cycle:.3g} ms; a jerk time can only be set that coarsely"
        )
    if mode.tcp_gain == 0.0 and mode.measured_gain == 0.0:
        add("neither tool nor encoder sees it; it costs time in the optimum for nothing")
    reach = max(abs(mode.tcp_gain), abs(mode.measured_gain)) * moving_mass(machine)
    if not is_manipulator and reach > GAIN_RATIO:
        add(f"its gain is {reach:.3g} times 1/moving_mass; check the unit of the gains")
    return [*remarks, *_check_deflection(machine, mode, key=key)]


def _check_deflection(machine: Machine, mode: FlexibleMode, *, key: str) -> list[Remark]:
    unit = machine.axis_units.length.si
    deflection = abs(mode.tcp_gain) * machine.drive.motion_force / mode.natural_frequency**2
    band = machine.requirements.tcp_deviation
    if deflection <= DEFLECTION_RATIO * band:
        return []
    message = (
        f"mode {mode.name}: the full force bends the tool by {deflection:.3g} {unit}, "
        f"{deflection / band:.3g} times tcp_deviation = {band:.3g} {unit}; "
        "check the stiffness and the band"
    )
    return [Remark(key=key, message=message)]


def _check_drive(machine: Machine) -> list[Remark]:
    drive, m = machine.drive, moving_mass(machine)
    axis = machine.axis_units
    force, mass, rate = axis.force.si, axis.mass.si, axis.acceleration.si
    low, high = ACCELERATIONS[machine.motion]
    a = drive.motion_force / m
    remarks = []
    if not low <= a <= high:
        side = "hardly moves the axis" if a < low else "is more than a machine axis bears"
        message = (
            f"{drive.motion_force:.4g} {force} on {m:.4g} {mass} give {a:.3g} {rate}, "
            f"which {side}; check both units"
        )
        remarks.append(Remark(key="drive.max_force", message=message))
    if abs(drive.static_load) > LOAD_SHARE * drive.max_force:
        message = (
            f"{abs(drive.static_load):.4g} {force} take more than half of max_force = "
            f"{drive.max_force:.4g} {force}; consider a counterbalance"
        )
        remarks.append(Remark(key="drive.static_load", message=message))
    if isfinite(drive.continuous_force) and drive.continuous_force > drive.max_force:
        message = (
            f"{drive.continuous_force:.4g} {force} is above max_force = {drive.max_force:.4g} "
            f"{force}, so it limits nothing; the two may be swapped"
        )
        remarks.append(Remark(key="drive.continuous_force", message=message))
    if drive.force_lag > LONGEST_FORCE_LAG:
        message = (
            f"{1e3 * drive.force_lag:.3g} ms is long for a force loop (servo drives: 0.5 to 5 ms)"
        )
        remarks.append(Remark(key="drive.force_lag", message=message))
    return remarks


def _check_moves(machine: Machine) -> list[Remark]:
    remarks = []
    a, unit = machine.drive.motion_force / moving_mass(machine), machine.axis_units.velocity.si
    for i, move in enumerate(machine.moves):
        time = least_motion_time(move, a)
        if time > LONGEST_MOVE:
            message = (
                f"a rigid axis would need {time:.3g} s for this move; "
                "check distance, velocity and force"
            )
            remarks.append(Remark(key=f"moves[{i + 1}]", message=message))
        name, velocity = (
            ("velocity_step", move.velocity_step)
            if isinstance(move, VelocityStep)
            else ("max_velocity", move.max_velocity)
        )
        if VELOCITIES[machine.motion] < velocity < inf:
            message = (
                f"{velocity:.4g} {unit} is faster than machine axes move, "
                f"{VELOCITIES[machine.motion]:g} {unit}; check the unit"
            )
            remarks.append(Remark(key=f"moves[{i + 1}].{name}", message=message))
    return remarks


def _check_requirements(machine: Machine) -> list[Remark]:
    needs, m, unit = machine.requirements, moving_mass(machine), machine.axis_units.length.si
    low, high = DEVIATIONS[machine.motion]
    remarks = []
    if not low <= needs.tcp_deviation <= high:
        side = "finer than encoders resolve" if needs.tcp_deviation < low else "no accuracy at all"
        message = f"{needs.tcp_deviation:.3g} {unit} is {side}; check the unit"
        remarks.append(Remark(key="requirements.tcp_deviation", message=message))
    if needs.payload[1] > PAYLOAD_RATIO * m:
        mass = machine.axis_units.mass.si
        message = (
            f"{needs.payload[1]:.4g} {mass} is more than three times the moving mass, "
            f"{m:.4g} {mass}; one set of limits will be slow for the empty axis"
        )
        remarks.append(Remark(key="requirements.payload", message=message))
    bands = needs.modes
    if not bands.surface <= bands.accuracy <= bands.speed:
        message = (
            f"surface {bands.surface:.3g}, accuracy {bands.accuracy:.3g} and speed "
            f"{bands.speed:.3g} {unit} do not widen in this order; they may be swapped"
        )
        remarks.append(Remark(key="requirements.modes", message=message))
    return remarks


def _check_control(machine: Machine) -> list[Remark]:
    control, m = machine.control, moving_mass(machine)
    low, high = (m + payload for payload in machine.requirements.payload)
    remarks = []
    mass = control.feedforward_mass
    if mass is not None and not low / FEEDFORWARD_RATIO <= mass <= high * FEEDFORWARD_RATIO:
        unit = machine.axis_units.mass.si
        message = (
            f"{mass:.4g} {unit} is far from the moving mass, {low:.4g} to {high:.4g} {unit}; "
            "the feed-forward will push too little or too much"
        )
        remarks.append(Remark(key="control.feedforward_mass", message=message))
    gain = control.position_gain
    if gain is not None and gain < LEAST_POSITION_GAIN:
        message = (
            f"Kv = {gain:.4g} 1/s is only {convert_to(gain, '(m/min)/mm'):.3g} (m/min)/mm; "
            f'if {gain:.4g} (m/min)/mm is meant, write the unit: "{gain:.4g} (m/min)/mm"'
        )
        remarks.append(Remark(key="control.position_gain", message=message))
    if control.minimum_bandwidth_hz * control.velocity_cycle * SAMPLES_PER_PERIOD > 1.0:
        message = (
            f"{control.minimum_bandwidth_hz:.4g} Hz is above a third of the velocity loop's "
            f"sampling rate, {1.0 / control.velocity_cycle:.4g} Hz"
        )
        remarks.append(Remark(key="control.minimum_bandwidth", message=message))
    return remarks
