"""What follows from the answers so far: modes, accelerations, deflections, contradictions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from math import inf, pi, sqrt

from mtcommission.machine.machine import MOST_MOVES
from mtcommission.messages.message import Message
from mtcommission.plant.modal import MOST_MODES
from mtcommission.units.quantities import (
    DAMPING,
    FREQUENCY,
    INERTIA,
    LENGTH,
    MASS,
    RATIO,
    ROTARY_DAMPING,
    ROTARY_STIFFNESS,
    STIFFNESS,
    TIME,
    Dimension,
)
from mtcommission.wizard.axis_units import (
    MODAL,
    PAIR_BY_FREQUENCY,
    PAIRS,
    TOWER_BY_FREQUENCY,
    TOWER_BY_STIFFNESS,
    axis_units,
    follows,
    motor_turn,
)
from mtcommission.wizard.convert import pair_modes
from mtcommission.wizard.mechanics import ROTOR
from mtcommission.wizard.question import Answers, si_value

CONTRADICTION = 0.1
"""Relative difference of two frequencies for one mode above which one of them is wrong: more
than masses and stiffnesses of data sheets are off together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Insight:
    """One line about the machine.

    Parameters
    ----------
    text
        With numbers and units.
    is_warning
        Whether something contradicts itself.
    """

    text: Message
    is_warning: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class _Mode:
    """What is known of a mode; the gain is None while it is not."""

    name: str | Message
    omega: float
    damping_ratio: float | None
    tcp_gain: float | None


def find_insights(answers: Answers) -> tuple[Insight, ...]:
    """Return what is known of the machine, in words.

    Parameters
    ----------
    answers
        As far as given.

    Examples
    --------
    >>> find_insights({"wizard.way": TOWER_BY_STIFFNESS, "plant.base_mass": "450 kg",
    ...     "plant.base_stiffness": "50 N/m"})[0].text.kind
    'insight-mode'
    """
    force = _motion_force(answers)
    found = []
    for mode in _modes(answers):
        kind = "insight-mode-damped" if mode.damping_ratio else "insight-mode"
        text = Message(
            kind,
            mode=mode.name,
            frequency=mode.omega / (2 * pi),
            damping_ratio=mode.damping_ratio,
        )
        found.append(Insight(text=text))
        if mode.tcp_gain is not None and force is not None and force > 0.0:
            by = "held" if follows(answers) else "free"
            found.append(_deflection(mode, force, by))
    mass = _moving_mass(answers)
    unit = axis_units(answers)
    if force is not None and force <= 0.0:
        text = Message("insight-no-force", force=force, unit=unit.force.si)
        found.append(Insight(text=text, is_warning=True))
    elif mass and force is not None:
        text = Message(
            "insight-acceleration",
            acceleration=force / mass,
            rate=unit.acceleration.si,
            force=force,
            unit=unit.force.si,
            mass=mass,
            mass_unit=unit.mass.si,
        )
        found.append(Insight(text=text))
    found += [*_rotor(answers), *_twice_measured(answers), *_rests(answers, mass, force)]
    return (*found, *_contradictions(answers))


def _rotor(answers: Answers) -> Iterator[Insight]:
    """What the rotor is at the axis: often more than all that moves in a line."""
    turn = motor_turn(answers)
    if not turn:
        return
    motor = si_value(answers, "pair.motor_mass", MASS)
    if answers.get("wizard.way") in PAIRS and motor:
        yield Insight(text=Message("insight-shaft", mass=motor, inertia=1e4 * motor / turn**2))
    if answers.get("wizard.way") != MODAL:
        return
    rotor, mass = si_value(answers, ROTOR, INERTIA), si_value(answers, "plant.moving_mass", MASS)
    if rotor and mass:
        own = rotor * turn**2
        kind = "insight-rotor-missing" if mass <= own else "insight-rotor"
        text = Message(kind, rotor=own, mass=mass, whole=own + mass, share=own / mass)
        yield Insight(text=text, is_warning=mass <= own)
    elif mass:
        yield Insight(text=Message("insight-rotor-unknown", mass=mass, each=1e-4 * turn**2))


def _twice_measured(answers: Answers) -> Iterator[Insight]:
    """Two measured frequencies so close that they may be one resonance."""
    is_pair = answers.get("wizard.way") in PAIRS
    found = [mode.frequency_hz for mode in pair_modes(answers)] if is_pair else []
    for first, second in combinations(found, 2):
        if abs(first - second) < CONTRADICTION * max(first, second):
            text = Message("insight-twice-measured", first=first, second=second)
            yield Insight(text=text, is_warning=True)


def _rests(answers: Answers, mass: float | None, force: float | None) -> Iterator[Insight]:
    """What the rest after each move leaves of the acceleration, where heat takes some of it."""
    unit = axis_units(answers)
    continuous = si_value(answers, "drive.continuous_force", unit.force)
    if not mass or not force or not continuous or min(mass, force, continuous) <= 0.0:
        return
    for i in range(MOST_MOVES):
        place = f"moves.{i}"
        rest = si_value(answers, f"{place}.dwell", TIME)
        distance = si_value(answers, f"{place}.distance", unit.length)
        step = si_value(answers, f"{place}.velocity_step", unit.velocity)
        top = step or si_value(answers, f"{place}.max_velocity", unit.velocity) or inf
        if rest is None or rest < 0.0 or not (distance or step) or top <= 0.0:
            continue
        work = _Work(mass=mass, distance=0.0 if step else abs(distance or 0.0), velocity=top)
        if work.heat(force / mass, rest) <= continuous:
            continue
        text = Message(
            "insight-rest",
            number=i + 1,
            rest=rest,
            acceleration=work.largest(continuous, rest, force / mass),
            most=force / mass,
            rate=unit.acceleration.si,
            enough=work.rest_for(force / mass, continuous),
        )
        yield Insight(text=text)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Work:
    """A move of a rigid mass [kg] over a distance [m], 0: only to its velocity [m/s]."""

    mass: float
    distance: float
    velocity: float

    def times(self, acceleration: float) -> tuple[float, float]:
        """Return for how long the mass is accelerated, and how long the move takes [s]."""
        if not self.distance:
            return self.velocity / acceleration, self.velocity / acceleration
        top = min(self.velocity, sqrt(self.distance * acceleration))
        return 2.0 * top / acceleration, self.distance / top + top / acceleration

    def heat(self, acceleration: float, rest: float) -> float:
        """Return the RMS force over move and rest [N]."""
        accelerated, whole = self.times(acceleration)
        return self.mass * acceleration * sqrt(accelerated / (whole + rest))

    def largest(self, allowed: float, rest: float, most: float) -> float:
        """Return the acceleration that heats as much as is allowed [m/s²], below the most."""
        low, high = 0.0, most
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.heat(middle, rest) > allowed else (middle, high)
        return 0.5 * (low + high)

    def rest_for(self, acceleration: float, allowed: float) -> float:
        """Return the rest with which an acceleration heats as much as is allowed [s]."""
        accelerated, whole = self.times(acceleration)
        return accelerated * (self.mass * acceleration / allowed) ** 2 - whole


BISECTIONS = 40


def _motion_force(answers: Answers) -> float | None:
    unit = axis_units(answers).force
    if follows(answers):
        return si_value(answers, "drive.max_acceleration", axis_units(answers).acceleration)
    force = si_value(answers, "drive.max_force", unit)
    if force is None:
        return None
    return force - abs(si_value(answers, "drive.static_load", unit) or 0.0)


def _moving_mass(answers: Answers) -> float | None:
    way, unit = answers.get("wizard.way"), axis_units(answers).mass
    if way in (TOWER_BY_STIFFNESS, TOWER_BY_FREQUENCY):
        return si_value(answers, "plant.slider_mass", unit)
    if way == MODAL:
        return si_value(answers, "plant.moving_mass", unit)
    motor = si_value(answers, "pair.motor_mass", unit)
    load = si_value(answers, "pair.load_mass", unit)
    return None if motor is None or load is None else motor + load


def _deflection(mode: _Mode, force: float, by: str) -> Insight:
    deflection = abs(mode.tcp_gain or 0.0) * force / mode.omega**2
    return Insight(text=Message("insight-deflection", mode=mode.name, deflection=deflection, by=by))


def _modes(answers: Answers) -> list[_Mode]:
    way = answers.get("wizard.way")
    if way in (TOWER_BY_STIFFNESS, TOWER_BY_FREQUENCY):
        return _tower_modes(answers, measured=way == TOWER_BY_FREQUENCY)
    if way == MODAL or follows(answers):
        return _bode_modes(answers)
    return [
        _Mode(
            name=f"mode{i + 1}" if i else Message("mode-of-pair"),
            omega=2.0 * pi * mode.frequency_hz,
            damping_ratio=mode.damping_ratio,
            tcp_gain=mode.tcp_gain,
        )
        for i, mode in enumerate(pair_modes(answers))
    ]


def _tower_modes(answers: Answers, *, measured: bool) -> list[_Mode]:
    found = []
    arm = si_value(answers, "plant.lever_arm", LENGTH)
    height = si_value(answers, "plant.tcp_height", LENGTH)
    for name, part, mass_key, unit, spring, damper in (
        ("base", "base", "plant.base_mass", MASS, STIFFNESS, DAMPING),
        ("rotation", "rotary", "plant.rotary_inertia", INERTIA, ROTARY_STIFFNESS, ROTARY_DAMPING),
    ):
        m = si_value(answers, mass_key, unit)
        omega, zeta = _measured(answers, part) if measured else _sprung(
            answers, part, m, spring, damper)  # fmt: skip
        if not m or omega is None:
            continue
        gain = 1.0 / m if name == "base" else None
        if name == "rotation" and arm is not None and height is not None:
            gain = arm * height / m
        found.append(_Mode(name=name, omega=omega, damping_ratio=zeta, tcp_gain=gain))
    return found


def _measured(answers: Answers, part: str) -> tuple[float | None, float | None]:
    f = si_value(answers, f"measured.{part}_frequency", FREQUENCY)
    zeta = si_value(answers, f"measured.{part}_damping_ratio", RATIO)
    return (2.0 * pi * f if f else None), zeta


def _sprung(
    answers: Answers, part: str, m: float | None, spring: Dimension, damper: Dimension
) -> tuple[float | None, float | None]:
    k = si_value(answers, f"plant.{part}_stiffness", spring)
    d = si_value(answers, f"plant.{part}_damping", damper)
    if not m or not k or m < 0.0 or k < 0.0:
        return None, None
    return sqrt(k / m), None if d is None else d / (2.0 * sqrt(k * m))


def _bode_modes(answers: Answers) -> list[_Mode]:
    found = []
    gain = RATIO if follows(answers) else axis_units(answers).gain
    for i in range(MOST_MODES):
        place = f"plant.modes.{i}"
        f = si_value(answers, f"{place}.frequency", FREQUENCY)
        if f:
            found.append(
                _Mode(
                    name=answers.get(f"{place}.name", str(i + 1)),
                    omega=2.0 * pi * f,
                    damping_ratio=si_value(answers, f"{place}.damping_ratio", RATIO),
                    tcp_gain=si_value(answers, f"{place}.tcp_gain", gain),
                )
            )
    return found


def _contradictions(answers: Answers) -> list[Insight]:
    """Measured frequencies against those of mass and stiffness."""
    unit, way = axis_units(answers), answers.get("wizard.way")
    cases = []
    if way == TOWER_BY_FREQUENCY:
        cases = [
            (Message("part-base"), "measured.base_frequency", "plant.base_mass", MASS,
             "measured.base_stiffness", STIFFNESS),
            (Message("part-tower"), "measured.rotary_frequency", "plant.rotary_inertia", INERTIA,
             "measured.rotary_stiffness", ROTARY_STIFFNESS),
        ]  # fmt: skip
    elif way == PAIR_BY_FREQUENCY:
        cases = [
            (Message("part-load"), "pair.frequency", "pair.load_mass", unit.mass,
             "pair.stiffness", unit.stiffness),
        ]  # fmt: skip
    found = []
    for name, f_key, m_key, mass, k_key, spring in cases:
        f = si_value(answers, f_key, FREQUENCY)
        m, k = si_value(answers, m_key, mass), si_value(answers, k_key, spring)
        if not f or not m or not k or m < 0.0 or k < 0.0:
            continue
        expected = sqrt(k / m) / (2.0 * pi)
        if abs(expected - f) > CONTRADICTION * f:
            text = Message("insight-contradiction", part=name, expected=expected, measured=f)
            found.append(Insight(text=text, is_warning=True))
    return found
