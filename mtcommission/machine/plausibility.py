"""Machine -> remarks: what is allowed, but so unusual that it may be a slip.

A remark never stops anything. The bounds are empirical: the range of machine tool axes in the
literature, widened generously.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite, log

from mtcommission.machine.identified import MOST_MISFIT
from mtcommission.machine.machine import Machine, Motion, moving_mass
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.messages.catalogue import NAME
from mtcommission.messages.message import Message
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


Found = Iterator[tuple[str | Message, Message]]
"""What is meant, a key of the profile or in words ("" where the rest says so), and what is unusual
about it."""


def check_plausibility(machine: Machine) -> tuple[Message, ...]:
    """Return what a commissioning engineer would ask about a machine; empty if nothing is unusual.

    The machine is nominal and valid.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> check_plausibility(read_shipped("ball-screw").machine)
    ()
    """
    checks = (
        _check_modes,
        _check_drive,
        _check_moves,
        _check_requirements,
        _check_control,
        _check_measurement,
    )
    found = (one for check in checks for one in check(machine))
    return tuple(
        Message("remark", of=Message(NAME, key=of) if isinstance(of, str) else of, what=what)
        if of
        else what
        for of, what in found
    )


def _check_modes(machine: Machine) -> Found:
    for index, mode in enumerate(machine.mechanics.modes):
        is_stated = machine.mechanics.mode_key(index) != "plant"
        for what in _doubts(machine, mode, is_stated=is_stated):
            yield Message("mode-named", mode=mode.name), what


def _doubts(machine: Machine, mode: FlexibleMode, *, is_stated: bool) -> Iterator[Message]:
    """What is unusual about a mode; only a gain that was stated can have the wrong unit."""
    f, zeta, control = mode.frequency_hz, mode.damping_ratio, machine.control
    low, high = DAMPING_RATIOS
    if zeta < low:
        yield Message("mode-damping-low", damping_ratio=zeta, low=low, high=high)
    if zeta > high:
        yield Message("mode-damping-high", damping_ratio=zeta, low=low, high=high)
    if f < LOWEST_FREQUENCY_HZ:
        yield Message("mode-slow", frequency=f)
    decay = zeta * mode.natural_frequency
    ringing = log(100.0) / decay if decay > 0.0 else inf  # exp(-zeta omega t) = 0.01
    if ringing > LONGEST_RINGING:
        kind = "mode-rings-long" if decay > 0.0 else "mode-rings-for-ever"
        yield Message(kind, frequency=f, damping_ratio=zeta, time=ringing)
    in_velocity, in_position = (
        1.0 / (f * cycle) for cycle in (control.velocity_cycle, control.position_cycle)
    )
    if in_velocity < SAMPLES_PER_PERIOD:
        rate = 1.0 / control.velocity_cycle
        yield Message("mode-above-velocity-sampling", frequency=f, rate=rate)
    if in_position < SAMPLES_PER_PERIOD:
        rate = 1.0 / control.position_cycle
        yield Message("mode-above-position-sampling", frequency=f, rate=rate)
    elif in_position < POSITION_CYCLES_PER_PERIOD:
        cycle = control.position_cycle
        yield Message("mode-of-few-position-cycles", cycles=in_position, cycle=cycle)
    if mode.tcp_gain == 0.0 and mode.measured_gain == 0.0:
        yield Message("mode-unseen")
    reach = max(abs(mode.tcp_gain), abs(mode.measured_gain)) * moving_mass(machine)
    if is_stated and reach > GAIN_RATIO:
        yield Message("mode-gain-large", ratio=reach)
    deflection = abs(mode.tcp_gain) * machine.drive.motion_force / mode.natural_frequency**2
    band = machine.requirements.tcp_deviation
    if deflection > DEFLECTION_RATIO * band:
        yield Message("mode-bends-far", deflection=deflection, ratio=deflection / band, band=band)


def _check_drive(machine: Machine) -> Found:
    drive, m = machine.drive, moving_mass(machine)
    low, high = ACCELERATIONS[machine.motion]
    a = drive.motion_force / m
    if not low <= a <= high:
        kind = "force-hardly-moves-axis" if a < low else "force-beyond-axis"
        message = Message(kind, force=drive.motion_force, mass=m, acceleration=a)
        yield "drive.max_force", message
    if abs(drive.static_load) > LOAD_SHARE * drive.max_force:
        message = Message(
            "static-load-large", load=abs(drive.static_load), max_force=drive.max_force
        )
        yield "drive.static_load", message
    if isfinite(drive.continuous_force) and drive.continuous_force > drive.max_force:
        message = Message(
            "continuous-force-above-max", force=drive.continuous_force, max_force=drive.max_force
        )
        yield "drive.continuous_force", message
    if machine.control.kind.follows_steps and not drive.follows:
        yield "drive.kind", Message("drive-kind-steps")
    if drive.force_lag > LONGEST_FORCE_LAG:
        yield "drive.force_lag", Message("force-lag-long", lag=drive.force_lag)


def _check_moves(machine: Machine) -> Found:
    a, fastest = machine.drive.motion_force / moving_mass(machine), VELOCITIES[machine.motion]
    for i, move in enumerate(machine.moves):
        time = least_motion_time(move, a)
        if time > LONGEST_MOVE:
            yield Message("move", number=i + 1), Message("move-lasts-long", time=time)
        name, velocity = (
            ("velocity_step", move.velocity_step)
            if isinstance(move, VelocityStep)
            else ("max_velocity", move.max_velocity)
        )
        if fastest < velocity < inf:
            message = Message("move-fast", velocity=velocity, fastest=fastest)
            yield f"moves[{i + 1}].{name}", message


def _check_requirements(machine: Machine) -> Found:
    needs, m = machine.requirements, moving_mass(machine)
    low, high = DEVIATIONS[machine.motion]
    if not low <= needs.tcp_deviation <= high:
        kind = "band-finer-than-encoders" if needs.tcp_deviation < low else "band-no-accuracy"
        message = Message(kind, band=needs.tcp_deviation)
        yield "requirements.tcp_deviation", message
    if needs.payload[1] > PAYLOAD_RATIO * m:
        message = Message("payload-large", payload=needs.payload[1], mass=m)
        yield "", message
    bands = needs.modes
    if not bands.surface <= bands.accuracy <= bands.speed:
        message = Message(
            "bands-not-widening", surface=bands.surface, accuracy=bands.accuracy, speed=bands.speed
        )
        yield "", message


def _check_control(machine: Machine) -> Found:
    control, m = machine.control, moving_mass(machine)
    if control.velocity_cycle < SHORTEST_VELOCITY_CYCLE:
        message = Message("cycle-shorter-than-drives-have", cycle=control.velocity_cycle)
        yield "control.velocity_cycle", message
    low, high = (m + payload for payload in machine.requirements.payload)
    mass = control.feedforward_mass
    if mass is not None and not low / FEEDFORWARD_RATIO <= mass <= high * FEEDFORWARD_RATIO:
        message = Message("feedforward-mass-far", mass=mass, low=low, high=high)
        yield "", message
    gain = control.position_gain
    if gain is not None and gain < LEAST_POSITION_GAIN:
        in_custom = convert_to(gain, "(m/min)/mm")
        message = Message("position-gain-without-unit", gain=gain, in_custom=in_custom)
        yield "", message
    if control.minimum_bandwidth_hz * control.velocity_cycle * SAMPLES_PER_PERIOD > 1.0:
        message = Message(
            "bandwidth-above-sampling",
            bandwidth=control.minimum_bandwidth_hz,
            rate=1.0 / control.velocity_cycle,
        )
        yield "", message


def _check_measurement(machine: Machine) -> Found:
    misfit = machine.identified.misfit if machine.identified else None
    if misfit is not None and misfit > MOST_MISFIT:
        message = Message("measured-not-described", misfit=misfit, most=MOST_MISFIT)
        yield "", message
