"""Machine -> what is said of it: remarks on what may be a slip, and on what its results rest.

A remark never stops anything. The bounds are empirical: the range of machine tool axes in the
literature, widened generously.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf, isinf, log, pi

from mtcommission.base.messages.catalogue import NAME, Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import convert_to
from mtcommission.controls.kind import LOW_PASS, ControlKind
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.identified import MOST_MISFIT
from mtcommission.machine.machine import Machine, Motion, moving_mass
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import VelocityStep, largest_velocity, least_motion_time
from mtcommission.machine.setpoint_filter import SetpointFilter, name_shaper

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


Found = Iterator[tuple[bool, str | Message, Message]]
"""Whether something is unusual, what is meant by it, a key of the profile or in words ("" where the
rest says so), and what is unusual about it."""


def check_plausibility(machine: Machine) -> tuple[Message, ...]:
    """Return what a commissioning engineer would ask about a machine; empty if nothing is unusual.

    The machine is nominal and valid.
    """
    checks = (
        _check_modes,
        _check_drive,
        _check_moves,
        _check_requirements,
        _check_control,
        _check_measurement,
    )
    return tuple(
        Message("remark", of=Message(NAME, key=of) if isinstance(of, str) else of, what=what)
        if of
        else what
        for check in checks
        for is_unusual, of, what in check(machine)
        if is_unusual
    )


def _check_modes(machine: Machine) -> Found:
    for index, mode in enumerate(machine.mechanics.modes):
        is_stated = machine.mechanics.mode_key(index) != "plant"
        for is_unusual, what in _doubts(machine, mode, is_stated=is_stated):
            yield is_unusual, Message("mode-named", mode=mode.name), what


def _doubts(
    machine: Machine, mode: FlexibleMode, *, is_stated: bool
) -> Iterator[tuple[bool, Message]]:
    """What may be unusual about a mode; only a gain that was stated can have the wrong unit."""
    f, zeta, control = mode.frequency_hz, mode.damping_ratio, machine.control
    low, high = DAMPING_RATIOS
    unusual = Message("mode-damping-unusual", damping_ratio=zeta, low=low, high=high)
    yield not low <= zeta <= high, unusual
    yield f < LOWEST_FREQUENCY_HZ, Message("mode-slow", frequency=f)
    decay = zeta * mode.natural_frequency
    ringing = log(100.0) / decay if decay > 0.0 else inf  # exp(-zeta omega t) = 0.01
    kind = "mode-rings-long" if decay > 0.0 else "mode-rings-for-ever"
    rings = Message(kind, frequency=f, damping_ratio=zeta, time=ringing)
    yield ringing > LONGEST_RINGING, rings
    for loop, cycle in (
        ("velocity", control.velocity_cycle),
        ("position", control.position_cycle),
    ):
        is_folded = 1.0 / (f * cycle) < SAMPLES_PER_PERIOD
        yield is_folded, Message(f"mode-above-{loop}-sampling", frequency=f, rate=1.0 / cycle)
    cycle = control.position_cycle
    cycles = 1.0 / (f * cycle)
    few = Message("mode-of-few-position-cycles", cycles=cycles, cycle=cycle)
    yield SAMPLES_PER_PERIOD <= cycles < POSITION_CYCLES_PER_PERIOD, few
    yield mode.tcp_gain == 0.0 and mode.measured_gain == 0.0, Message("mode-unseen")
    reach = max(abs(mode.tcp_gain), abs(mode.measured_gain)) * moving_mass(machine)
    yield is_stated and reach > GAIN_RATIO, Message("mode-gain-large", ratio=reach)
    deflection = abs(mode.tcp_gain) * machine.drive.motion_force / mode.natural_frequency**2
    band = machine.requirements.tcp_deviation
    far = Message("mode-bends-far", deflection=deflection, ratio=deflection / band, band=band)
    yield deflection > DEFLECTION_RATIO * band, far


def _check_drive(machine: Machine) -> Found:
    drive, m = machine.drive, moving_mass(machine)
    low, high = ACCELERATIONS[machine.motion]
    force, most, load, heat = (
        drive.motion_force,
        drive.max_force,
        abs(drive.static_load),
        drive.continuous_force,
    )
    moves = Message("acceleration-unusual", force=force, mass=m, acceleration=force / m)
    yield not low <= force / m <= high, "drive.max_force", moves
    loaded = Message("static-load-large", load=load, max_force=most)
    yield load > LOAD_SHARE * most, "drive.static_load", loaded
    heated = Message("continuous-force-above-max", force=heat, max_force=most)
    yield most < heat < inf, "drive.continuous_force", heated
    steps = machine.control.kind.follows_steps and not drive.follows
    yield steps, "drive.kind", Message("drive-kind-steps")
    lag = drive.force_lag
    yield lag > LONGEST_FORCE_LAG, "drive.force_lag", Message("force-lag-long", lag=lag)


def _check_moves(machine: Machine) -> Found:
    a, fastest = machine.drive.motion_force / moving_mass(machine), VELOCITIES[machine.motion]
    for number, move in enumerate(machine.moves, start=1):
        time, named = least_motion_time(move, a), Message("move", number=number)
        yield time > LONGEST_MOVE, named, Message("move-lasts-long", time=time)
        name = "velocity_step" if isinstance(move, VelocityStep) else "max_velocity"
        velocity = largest_velocity(move)
        fast = Message("move-fast", velocity=velocity, fastest=fastest)
        yield fastest < velocity < inf, f"moves[{number}].{name}", fast


def _check_requirements(machine: Machine) -> Found:
    needs, m = machine.requirements, moving_mass(machine)
    low, high = DEVIATIONS[machine.motion]
    band, payload, bands = needs.tcp_deviation, needs.payload[1], needs.modes
    unusual = Message("band-unusual", band=band)
    yield not low <= band <= high, "requirements.tcp_deviation", unusual
    yield payload > PAYLOAD_RATIO * m, "", Message("payload-large", payload=payload, mass=m)
    widen = bands.surface <= bands.accuracy <= bands.speed
    each = {"surface": bands.surface, "accuracy": bands.accuracy, "speed": bands.speed}
    yield not widen, "", Message("bands-not-widening", **each)


def _check_control(machine: Machine) -> Found:
    control, m = machine.control, moving_mass(machine)
    cycle, rate = control.velocity_cycle, 1.0 / control.velocity_cycle
    short = Message("cycle-shorter-than-drives-have", cycle=cycle)
    yield cycle < SHORTEST_VELOCITY_CYCLE, "control.velocity_cycle", short
    low, high = (m + payload for payload in machine.requirements.payload)
    mass = low if control.feedforward_mass is None else control.feedforward_mass
    far = Message("feedforward-mass-far", mass=mass, low=low, high=high)
    yield not low / FEEDFORWARD_RATIO <= mass <= high * FEEDFORWARD_RATIO, "", far
    gain = LEAST_POSITION_GAIN if control.position_gain is None else control.position_gain
    in_custom = convert_to(gain, "(m/min)/mm")
    slow = Message("position-gain-without-unit", gain=gain, in_custom=in_custom)
    yield gain < LEAST_POSITION_GAIN, "", slow
    bandwidth = control.minimum_bandwidth_hz
    above = Message("bandwidth-above-sampling", bandwidth=bandwidth, rate=rate)
    yield bandwidth * SAMPLES_PER_PERIOD > rate, "", above


def _check_measurement(machine: Machine) -> Found:
    misfit = (machine.identified and machine.identified.misfit) or 0.0
    what = Message("measured-not-described", misfit=misfit, most=MOST_MISFIT)
    yield misfit > MOST_MISFIT, "", what


# On what results rest: what the control has, what is assumed, what is neglected


OF_LOOP = ("control.position_loop", "control.position_cycle", "control.velocity_cycle")


OF_SETPOINT = ("jerk", "setpoint-filters", "modes")
"""What a control has that shapes its setpoint."""


def describe_kind(kind: ControlKind, *, follows: bool = False) -> Message:
    """Return what a kind of control has and what it lacks; "(?)" marks what was not read.

    Where the motor ``follows`` its setpoint, only what shapes the setpoint counts.
    """
    counts: dict[str, int] = {
        "jerk": int(kind.has_jerk_limit),
        "setpoint-filters": bool(kind.setpoint_filters),
        "velocity-feedforward": kind.velocity_feedforward,
        "acceleration-feedforward": kind.acceleration_feedforward,
        "jerk-feedforward": kind.jerk_feedforward,
        "reference-delay": kind.reference_delay,
        "force-filters": kind.force_filters,
        "state-feedback": kind.state_feedback,
        **({"modes": True} if kind.modes else {}),
    }
    if follows:
        counts = {name: count for name, count in counts.items() if name in OF_SETPOINT}
    has, lacks = list[Message](), list[Message]()
    for name, count in counts.items():
        said = Message(f"has-{name}")
        if count > 1:
            said = Message("feature-counted", count=count, feature=said)
        if name.replace("-", "_") in kind.unread:
            said = Message("feature-unread", feature=said)
        (has if count else lacks).append(said)
    if not lacks:
        return Message("kind-has-all", has=tuple(has))
    return Message("kind-has", has=tuple(has), lacks=tuple(lacks))


def list_neglected(machine: Machine) -> Iterator[Message]:
    """Yield what the model leaves out, with what to do where it matters."""
    if machine.drive.follows:
        yield Message("neglected-lost-steps")
        if machine.drive.force_velocity is None:
            yield Message("neglected-acceleration-over-speed")
    else:
        if machine.control.kind.follows_steps:
            yield Message("neglected-steps")
        yield Message("neglected-force-over-speed")
        if isinf(machine.drive.continuous_force):
            yield Message("neglected-heat")
    yield Message("neglected-friction")
    if not machine.drive.encoder_resolution and not machine.drive.follows:
        yield Message("neglected-encoder")
    yield Message("neglected-travel")


def filter_rows(item: SetpointFilter | None, words: Catalogue) -> list[tuple[str, str]]:
    """Return a setpoint filter as it is entered: its kind, then each of its numbers."""
    text, f = words.text, words.format
    if item is None:
        return [(text("setpoint-filter"), text("no-setpoint-filter"))]
    shaper, count = name_shaper(item.kind), len(item.taps)
    name = text("filter-name", kind=item.kind, shaper=shaper, count=count)
    rows = [(text("setpoint-filter"), name)]
    if item.frequency_hz:
        return [
            *rows,
            (text("filter-of-frequency"), f.quantity(item.frequency_hz, "Hz")),
            (text("filter-of-damping"), f"ζ {f.number(item.damping_ratio)}"),
        ]
    times = (item.time or item.duration, item.second_time)
    labels = ("filter-of-length", "filter-of-second-length")
    named = zip(labels, times, strict=True)
    return [*rows, *((text(label), f.quantity(time, "s")) for label, time in named if time)]


def say_filter(item: SetpointFilter | None, words: Catalogue) -> str:
    """Return a setpoint filter with its numbers; None is "none"."""
    (_, kind), *numbers = filter_rows(item, words)
    return " ".join([kind, *([", ".join(value for _, value in numbers)] if numbers else [])])


def name_filter(item: ForceFilter) -> Message:
    """Return what a filter of the set force is called, with its numbers."""
    frequency = item.natural_frequency / (2.0 * pi)
    if item.kind == LOW_PASS:
        return Message("loop-filter-low-pass", frequency=frequency, damping=item.damping)
    return Message("loop-filter-notch", frequency=frequency, damping=item.damping, width=item.width)


def say_jerk(
    acceleration: float | None, jerk: float | None, shortest: float, words: Catalogue
) -> str:
    """Return a jerk limit; in words where its ramp is shorter than the shortest [s].

    Shapers and steps of acceleration have a jerk that limits nothing.
    """
    if jerk is None or (acceleration is not None and acceleration < shortest * jerk):
        return words.text("no-jerk-limit")
    return words.format.axis(jerk, "m/s^3")


def say_loop(place: str, position_cycle: float, velocity_cycle: float, words: Catalogue) -> str:
    """Return where the position loop closes, "" for nowhere, and the cycles [s]."""
    return words.text(
        "position-loop-at",
        place=place or "none",
        position_cycle=words.format.quantity(position_cycle, "s"),
        velocity_cycle=words.format.quantity(velocity_cycle, "s"),
    )


def mark_assumed(said: str, keys: Sequence[str], assumed: Sequence[str], words: Catalogue) -> str:
    """Return what rests on some keys of the profile, and which of them nobody stated."""
    if not assumed:
        return said
    if len(assumed) == len(keys):
        return words.text("assumed", value=said)
    return words.text("assumed-of", value=said, names=", ".join(map(words.name, assumed)))
