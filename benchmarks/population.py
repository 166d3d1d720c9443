"""Random but plausible machines from a seed, to test rules on more than a few examples.

The ranges are wide on purpose: from a soft milling column to a stiff linear axis. They are the
generator's statement of what a rule was tried on, not a survey of machines in the field.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import exp, inf, log, pi

import numpy as np

from mtcommission.machine.control import Control, StateFeedback
from mtcommission.machine.drive import Drive
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import Move, Positioning, VelocityStep, peak_velocity
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.readers import SignalValue
from mtcommission.machine.requirements import Modes, Requirements, Reserve

MODE_KEYS = ("damping_ratio", "tcp_gain", "measured_gain")
NEED_KEYS = ("tcp_deviation", "max_settling_time", "frequency_spread")
"""Of the profile, and of what it becomes, under the same names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """Where a quantity is drawn from, uniformly or, over decades, logarithmically.

    Parameters
    ----------
    low, high
        Ends, in the SI unit of the quantity.
    logarithmic
        Whether its logarithm is uniform.
    """

    low: float
    high: float
    logarithmic: bool = False

    def draw(self, generator: np.random.Generator) -> float:
        """Return one value."""
        if self.logarithmic:
            return exp(generator.uniform(log(self.low), log(self.high)))
        return float(generator.uniform(self.low, self.high))


@dataclass(frozen=True, slots=True, kw_only=True)
class Population:
    """The ranges of random machines; every draw is independent.

    Parameters
    ----------
    moving_mass
        [kg].
    acceleration
        F_max / moving mass [m/s²].
    force_lag
        T [s].
    frequency_hz, damping_ratio
        Of each mode [Hz, -].
    closest_frequencies
        Least ratio of two neighbouring eigenfrequencies [-].
    tool_share
        Moving mass x tcp_gain [-], the sign is drawn too.
    encoder_share
        Moving mass x measured_gain [-]; half of the modes are invisible to the encoder.
    most_modes
        Up to so many modes, each number equally likely.
    velocity_step, distance, max_velocity
        Half of the machines do a velocity step [m/s], half a positioning move [m, m/s].
    tcp_deviation
        The band [m].
    frequency_spreads
        Spreads, each equally likely [-].
    payload_share
        Largest payload over moving mass [-]; half of the machines carry none.
    cycles
        Position and velocity cycle, each pair equally likely [s].
    """

    moving_mass: Range = Range(low=50.0, high=3000.0, logarithmic=True)
    acceleration: Range = Range(low=1.0, high=15.0, logarithmic=True)
    force_lag: Range = Range(low=0.5e-3, high=4e-3, logarithmic=True)
    frequency_hz: Range = Range(low=15.0, high=200.0, logarithmic=True)
    damping_ratio: Range = Range(low=0.005, high=0.1, logarithmic=True)
    closest_frequencies: float = 1.15
    tool_share: Range = Range(low=0.05, high=2.0, logarithmic=True)
    encoder_share: Range = Range(low=0.02, high=1.0, logarithmic=True)
    most_modes: int = 3
    velocity_step: Range = Range(low=0.02, high=1.0, logarithmic=True)
    distance: Range = Range(low=5e-3, high=0.5, logarithmic=True)
    max_velocity: Range = Range(low=0.1, high=1.5, logarithmic=True)
    tcp_deviation: Range = Range(low=2e-6, high=50e-6, logarithmic=True)
    frequency_spreads: tuple[float, ...] = (0.0, 0.02, 0.05, 0.1)
    payload_share: Range = Range(low=0.0, high=0.3)
    cycles: tuple[tuple[float, float], ...] = (
        (1e-3, 125e-6),
        (2e-3, 125e-6),
        (2e-3, 250e-6),
        (4e-3, 500e-6),
    )


def random_machine(seed: int, *, population: Population | None = None) -> Machine:
    """Return the machine that belongs to a seed.

    The cascade is left to the tool's own tuning, without state feedback: a rule of thumb
    must do without an observer.

    Parameters
    ----------
    seed
        Any whole number >= 0; the same seed gives the same machine.
    population
        Ranges; None: the defaults.

    Returns
    -------
    Machine

    Examples
    --------
    >>> random_machine(7) == random_machine(7), random_machine(7) == random_machine(8)
    (True, False)
    """
    ranges = population or Population()
    generator = np.random.default_rng([2024, seed])
    mass = ranges.moving_mass.draw(generator)
    acceleration = ranges.acceleration.draw(generator)
    band = ranges.tcp_deviation.draw(generator)
    payload = mass * ranges.payload_share.draw(generator) * float(generator.integers(2))
    position_cycle, velocity_cycle = ranges.cycles[int(generator.integers(len(ranges.cycles)))]
    spread = ranges.frequency_spreads[int(generator.integers(len(ranges.frequency_spreads)))]
    return Machine(
        name=f"random machine {seed}",
        axis="X",
        source="seeded generator",
        mechanics=Modal(moving_mass=mass, modes=tuple(_draw_modes(generator, ranges, mass))),
        drive=Drive(force_lag=ranges.force_lag.draw(generator), max_force=mass * acceleration),
        moves=(_draw_move(generator, ranges),),
        requirements=Requirements(
            tcp_deviation=band,
            modes=Modes(surface=0.4 * band, accuracy=band, speed=4.0 * band),
            frequency_spread=spread,
            payload=(0.0, payload),
        ),
        control=Control(
            state_feedback=StateFeedback.OFF,
            position_cycle=position_cycle,
            velocity_cycle=velocity_cycle,
        ),
    )


def _draw_modes(
    generator: np.random.Generator, ranges: Population, mass: float
) -> Iterator[FlexibleMode]:
    for number, frequency in enumerate(_draw_frequencies(generator, ranges), start=1):
        is_seen = bool(generator.integers(2))
        tool = ranges.tool_share.draw(generator) * float(generator.choice([-1.0, 1.0]))
        encoder = ranges.encoder_share.draw(generator)
        yield FlexibleMode(
            name=f"m{number}",
            natural_frequency=2 * pi * frequency,
            damping_ratio=ranges.damping_ratio.draw(generator),
            tcp_gain=tool / mass,
            measured_gain=encoder / mass if is_seen else 0.0,
        )


def _draw_frequencies(generator: np.random.Generator, ranges: Population) -> list[float]:
    """Distinct eigenfrequencies in rising order: drawn again until far enough apart [Hz]."""
    count = int(generator.integers(1, ranges.most_modes + 1))
    while True:
        found = sorted(ranges.frequency_hz.draw(generator) for _ in range(count))
        if all(high >= ranges.closest_frequencies * low for low, high in pairwise(found)):
            return found


def _draw_move(generator: np.random.Generator, ranges: Population) -> Move:
    if generator.integers(2):
        return VelocityStep(velocity_step=ranges.velocity_step.draw(generator))
    return Positioning(
        distance=ranges.distance.draw(generator), max_velocity=ranges.max_velocity.draw(generator)
    )


def demanding_machine(seed: int) -> Machine:
    """Return a machine of the population that is asked for everything that can be asked for.

    Up to three moves with dwell, payload, spreads, reserve; each with an even chance a limit of
    the RMS force, a peak of a mode's rate, a contour (perhaps at a feed), a settling time.

    Parameters
    ----------
    seed
        Any whole number >= 0; the same seed gives the same machine.

    Returns
    -------
    Machine
    """
    machine, ranges = random_machine(seed), Population()
    generator = np.random.default_rng([2025, seed])

    def share(low: float, high: float) -> float:
        return Range(low=low, high=high, logarithmic=True).draw(generator)

    def chance() -> bool:
        return bool(generator.integers(2))

    others = [_draw_move(generator, ranges) for _ in range(int(generator.integers(3)))]
    moves = tuple(replace(move, dwell=share(0.02, 1.5)) for move in (*machine.moves, *others))
    force_per_mass = machine.drive.max_force / moving_mass(machine)
    fastest = max(peak_velocity(move, force_per_mass) for move in moves)
    mechanics, force = machine.mechanics, machine.drive.max_force
    assert isinstance(mechanics, Modal)
    mode = mechanics.modes[int(generator.integers(len(mechanics.modes)))]
    bound = share(0.03, 1.0) * force / mode.natural_frequency
    needs = replace(
        machine.requirements,
        damping_spread=0.3,
        reserve=Reserve(),
        peaks=(SignalValue(name=f"v_{mode.name}", value=bound),) if chance() else (),
        contour_deviation=share(5e-6, 1e-3) if chance() else inf,
        contour_feed=share(0.05, 1.0) * fastest if chance() else inf,
        max_settling_time=share(0.1, 3.0) if chance() else inf,
    )
    drive = replace(machine.drive, continuous_force=share(0.05, 0.8) * force if chance() else inf)
    return replace(machine, requirements=needs, drive=drive, moves=moves)


def profile_text(machine: Machine, *, kind: str, filters_force: bool) -> str:
    """Return a machine of the population as a profile for a kind of control, in SI.

    Its cycles are those that are usual for the kind; only the generic one takes the machine's own.
    """
    mechanics, drive, needs = machine.mechanics, machine.drive, machine.requirements
    assert isinstance(mechanics, Modal)
    lines = ["schema = 1", "[machine]", f"name = '{machine.name}'", f"axis = '{machine.axis}'"]
    lines += [f"source = '{machine.source}'", "[plant]", "kind = 'modal'"]
    lines.append(f"moving_mass = {mechanics.moving_mass!r}")
    for mode in mechanics.modes:
        lines += ["[[plant.modes]]", f"name = '{mode.name}'"]
        lines.append(f"frequency = {mode.natural_frequency / (2 * pi)!r}")
        lines += [f"{key} = {getattr(mode, key)!r}" for key in MODE_KEYS]
    lines.append("[drive]")
    lines += _finite(drive, ("force_lag", "max_force", "continuous_force"))
    for move in machine.moves:
        lines += ["[[moves]]", f"dwell = {move.dwell!r}"]
        is_step = isinstance(move, VelocityStep)
        lines += _finite(move, ("velocity_step",) if is_step else ("distance", "max_velocity"))
    lines.append("[requirements]")
    lines += _finite(needs, NEED_KEYS)
    if needs.contour_deviation < inf:
        lines += _finite(needs, ("contour_deviation", "contour_feed"))
    lines.append(f"payload = {list(needs.payload)!r}")
    if needs.peaks:
        lines.append("[requirements.peaks]")
        lines += [f"{peak.name} = {peak.value!r}" for peak in needs.peaks]
    lines += ["[control]", f"kind = '{kind}'"]
    if kind == "generic":
        lines += _finite(machine.control, ("position_cycle", "velocity_cycle"))
    if kind == "state-space":
        lines.append("state_feedback = 'auto'")
    elif filters_force:
        lines.append("force_filters = 'auto'")
    return "\n".join(lines) + "\n"


def _finite(holder: object, keys: tuple[str, ...]) -> list[str]:
    return [f"{key} = {getattr(holder, key)!r}" for key in keys if getattr(holder, key) < inf]
