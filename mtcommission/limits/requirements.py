"""What is required of a move: what a requirement is, each of them, and those that a machine has.

Judge, search, studies and sheet go through ``requirements_of`` a machine and know none by name: a
new one is an object here, and a line in ``REGISTER``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from math import ceil, factorial, inf, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.loop.disturbance import SIGMAS, EncoderNoise
from mtcommission.loop.poles import LoopPoles
from mtcommission.loop.respond import (
    FORCE,
    OUTPUTS,
    Signal,
    extremes,
    lay_grid,
    output_of_states,
    outputs_at,
    set_in_motion,
    tool_deviation,
    where_signals_lead,
)
from mtcommission.loop.simulate import LoopResponse, rms_force, window_shares
from mtcommission.machine.machine import Machine, heaviest_mass
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.requirements import NO_RESERVE, Reserve
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]


class Yields(Enum):
    """How far a requirement gives way where no limits meet all of them."""

    FIRST = auto()
    """Limits are named that miss it as little as possible: how far the tool is off."""

    MINIMISED = auto()
    """The search makes it as small as the others allow: the time."""

    IF_ASKED = auto()
    """Limits that miss it are never sought, but what could be met instead is said."""

    NEVER = auto()
    """More is not to be had: what the drive can do."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Swing:
    """The largest magnitude of a signal of the linear loop.

    ``is_after``: from t_e + τ on only. Such a signal comes to rest with the setpoint; what is left
    of it is in proportion to the jerk, all times of the setpoint kept.
    """

    signal: Signal
    is_after: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mean:
    """A mean over move and dwell.

    ``estimate``: of the rigid axis, of each setpoint, shape (n_setpoints,) [own unit]. ``exact``:
    of one setpoint, from so many position cycles at most, shape (n_corners,) [own unit].
    """

    estimate: Callable[[Machine, Move, JerkSteps], Array]
    exact: Callable[[Machine, LoopPoles, Move, JerkSteps, int], Array]


@dataclass(frozen=True, slots=True)
class Settling:
    """When the tool stays in the band of the definitions: sought as soon as can be."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """What is bounded in every corner, by its key alone equal to another.

    A plant is the nominal one: units and rows are the same on all of them.
    """

    key: str  # name in records, e.g. "set force" or "peak v_phi"
    message: Message = field(compare=False)  # its text in every language
    unit: Callable[[Machine, Plant], str] = field(compare=False)  # SI unit of value and bound
    bound: Callable[[Machine], float] = field(compare=False)  # inf: not asked for
    with_bound: Callable[[Machine, float], Machine] = field(compare=False)  # the same else
    share: Callable[[Reserve], float] = field(compare=False)  # that recommendations may use [-]
    value: Callable[[LoopResponse, Plant], float] = field(compare=False)  # inf: not settled
    by_poles: Callable[[Plant], Swing | Mean | Settling] = field(compare=False)
    """What of the linear loop it bounds: so many setpoints are looked at at once."""
    yields: Yields = field(compare=False)
    judged: Callable[[Machine, Move], Move] = field(default=lambda _, move: move, compare=False)
    """The move at which it must hold, where that is a slower one."""
    with_noise: Callable[[Array, EncoderNoise], Array] = field(
        default=lambda value, _: value, compare=False
    )
    """Values, with what the steps of the encoder add to them."""
    at_most: Callable[[Machine, float], float] = field(default=lambda *_: inf, compare=False)
    """What limits with an acceleration [m/s²] are not expected to exceed: where that is below the
    bound the search does not look, and the judge decides; inf: only a response tells."""
    whole_move: tuple[str, str] = field(default=("", ""), compare=False)
    """Where it bounds the tool while it moves: keys that ask for it, and up to which velocity."""
    rests_on: tuple[str, str] = field(default=("", ""), compare=False)
    """Beginning and end of the keys of data that decide it where nobody stated them; "": none."""

    def noisy(self, values: Array, noises: Sequence[EncoderNoise]) -> Array:
        """Return values in every corner with the noise of each, shape (..., n_corners)."""
        columns = [self.with_noise(values[..., i], noise) for i, noise in enumerate(noises)]
        return np.stack(columns, axis=-1)


def _with_need(key: str) -> Callable[[Machine, float], Machine]:
    """How a machine gets another bound that stands in its requirements."""

    def with_bound(machine: Machine, bound: float) -> Machine:
        changed: dict[str, Any] = {key: bound}
        return replace(machine, requirements=replace(machine.requirements, **changed))

    return with_bound


RESIDUAL_DEVIATION = Requirement(
    key="residual deviation",
    message=Message("requirement-residual-deviation"),
    unit=lambda machine, _: machine.axis_units.length.si,
    bound=lambda machine: machine.requirements.tcp_deviation,
    with_bound=_with_need("tcp_deviation"),
    share=lambda reserve: reserve.band,
    value=lambda response, _: response.residual_deviation,
    with_noise=lambda value, noise: value + noise.tool,
    by_poles=lambda plant: Swing(signal=tool_deviation(plant.order), is_after=True),
    yields=Yields.FIRST,
    rests_on=("requirements.frequency_spread", "spread"),
)
"""How far the tool is off once the move has ended: within the band, from t_e + τ on."""

SETTLING_TIME = Requirement(
    key="settling time",
    message=Message("requirement-settling-time"),
    unit=lambda *_: "s",
    bound=lambda machine: machine.requirements.max_settling_time,
    with_bound=_with_need("max_settling_time"),
    share=lambda _: 1.0,  # a time is wanted as it is
    value=lambda response, _: response.settling_time,
    by_poles=lambda _: Settling(),
    yields=Yields.MINIMISED,
)
"""When the tool stays in its band at last, of the listed moves."""


def _slow_to_feed(machine: Machine, move: Move) -> Move:
    """The move at which the contour must hold: no faster than contours are followed."""
    feed = machine.requirements.contour_feed
    if isinstance(move, VelocityStep):
        return replace(move, velocity_step=min(move.velocity_step, feed))
    return replace(move, max_velocity=min(move.max_velocity, feed))


CONTOUR_DEVIATION = Requirement(
    key="contour deviation",
    message=Message("requirement-contour-deviation"),
    unit=lambda machine, _: machine.axis_units.length.si,
    bound=lambda machine: machine.requirements.contour_deviation,
    with_bound=_with_need("contour_deviation"),
    share=lambda reserve: reserve.band,
    judged=_slow_to_feed,
    value=lambda response, _: response.peak_deviation,
    with_noise=lambda value, noise: value + noise.tool,
    by_poles=lambda plant: Swing(signal=tool_deviation(plant.order)),
    yields=Yields.FIRST,
    whole_move=("requirements.contour_deviation", "requirements.contour_feed"),
)
"""How far the tool is off during the whole move, no faster than contours are followed."""


def peak_of(signal: str) -> Requirement:
    """Return the requirement on the largest magnitude of a state or output."""

    def bound(machine: Machine) -> float:
        peaks = machine.requirements.peaks
        return next((peak.value for peak in peaks if peak.name == signal), inf)

    def with_bound(machine: Machine, bound: float) -> Machine:
        peaks = tuple(
            replace(peak, value=bound) if peak.name == signal else peak
            for peak in machine.requirements.peaks
        )
        return replace(machine, requirements=replace(machine.requirements, peaks=peaks))

    return Requirement(
        key=f"peak {signal}",
        message=Message("requirement-peak", signal=signal),
        unit=lambda _, plant: plant.unit(signal),
        bound=bound,
        with_bound=with_bound,
        share=lambda reserve: reserve.band,
        value=lambda response, plant: float(response.peaks[plant.signals.index(signal)]),
        by_poles=lambda plant: Swing(signal=Signal(row=output_of_states(plant.row(signal)))),
        yields=Yields.IF_ASKED,
    )


def _peaks_of(machine: Machine) -> Iterator[Requirement]:
    """One for each bounded state or output, in the profile's order."""
    return (peak_of(peak.name) for peak in machine.requirements.peaks)


SAFE = 2.5
"""Factor by which a loop may ask for more force than the rigid axis [-] (empirical: up to 2.03)."""


def _with_force(machine: Machine, force: float) -> Machine:
    drive = machine.drive
    taken = drive.max_force - drive.motion_force
    return replace(machine, drive=replace(drive, max_force=taken + force))


SET_FORCE = Requirement(
    key="set force",
    message=Message("requirement-set-force"),
    unit=lambda machine, _: machine.axis_units.force.si,
    bound=lambda machine: machine.drive.motion_force,
    with_bound=_with_force,
    share=lambda reserve: reserve.force,
    value=lambda response, _: response.max_force,
    with_noise=lambda value, noise: value + noise.force,
    by_poles=lambda plant: Swing(signal=Signal(row=np.eye(plant.order + OUTPUTS)[FORCE])),
    at_most=lambda machine, acceleration: SAFE * heaviest_mass(machine) * acceleration,
    yields=Yields.NEVER,
)
"""How much force the loop asks for: what the drive has, less static load and friction."""


def rms_forces(
    machine: Machine, poles: LoopPoles, move: Move, steps: JerkSteps, most_cycles: int
) -> Array:
    """Return the RMS motor force of one setpoint over [0, t_e + dwell] in every corner [N]."""
    window = float(steps.duration[0]) + move.dwell
    cycles = max(ceil(window / poles.dt), 1)
    n = np.unique(np.linspace(0, cycles, min(cycles, most_cycles) + 1).astype(np.int64))
    motor = np.eye(1, poles.outputs, poles.outputs - 1)  # the last of the plant's states
    force = outputs_at(set_in_motion(poles, steps), n[None], motor)[0, ..., 0]
    share = window_shares(n, window, step=poles.velocity_cycle, cycles=poles.cycles)
    return rms_force(
        (share * force).sum(axis=(1, 2)) * window / share.sum(),
        (share * force**2).sum(axis=(1, 2)) * window / share.sum(),
        window=window,
        static_load=machine.drive.static_load,
    )


def _rigid_rms(machine: Machine, move: Move, steps: JerkSteps) -> Array:
    """RMS force of the rigid axis, heaviest payload, shape (n_setpoints,) [N].

    The acceleration is a sum of steps w_i of its m-th integral, m = q - 1, that ends in rest, so by
    Parseval ∫ a² dt = (-1)^m / (2 (2m - 1)!) Σ_ij w_i w_j |t_i - t_j|^(2m - 1). Its mean is that of
    a velocity step, against which a static load counts.
    """
    m, t = steps.order - 1, steps.times
    gap = np.abs(t[:, :, None] - t[:, None, :])
    gaps = gap * np.square(gap) ** (m - 1)  # to the 2m - 1, without the costly general power
    both = np.einsum("si,sij,sj->s", steps.steps, gaps, steps.steps)
    square = np.maximum((-1) ** m / (2.0 * factorial(2 * m - 1)) * both, 0.0)
    age = steps.duration[:, None] - t
    velocity = np.sum(steps.steps * age**m, axis=1) / factorial(m)
    mass = heaviest_mass(machine)
    return rms_force(
        mass * velocity,
        mass**2 * square,
        window=steps.duration + move.dwell,
        static_load=machine.drive.static_load,
    )


RMS_FORCE = Requirement(
    key="RMS force",
    message=Message("requirement-rms-force"),
    unit=lambda machine, _: machine.axis_units.force.si,
    bound=lambda machine: machine.drive.continuous_force,
    with_bound=lambda machine, force: replace(
        machine, drive=replace(machine.drive, continuous_force=force)
    ),
    share=lambda reserve: reserve.force,
    value=lambda response, _: response.rms_force,
    with_noise=lambda value, noise: np.hypot(value, noise.force / SIGMAS),
    by_poles=lambda _: Mean(estimate=_rigid_rms, exact=rms_forces),
    at_most=lambda machine, acceleration: float(
        np.hypot(heaviest_mass(machine) * acceleration, machine.drive.static_load)
    ),
    yields=Yields.IF_ASKED,
    rests_on=("moves[", "dwell"),
)
"""How much the motor heats: the RMS force over move and dwell."""

REGISTER: tuple[Requirement | Callable[[Machine], Iterable[Requirement]], ...] = (
    RESIDUAL_DEVIATION,
    SETTLING_TIME,
    CONTOUR_DEVIATION,
    _peaks_of,
    SET_FORCE,
    RMS_FORCE,
)
"""All there are, in the order of records; a function: one for each of what a machine names."""


def requirements_of(machine: Machine) -> tuple[Requirement, ...]:
    """Return what a machine asks for."""
    return tuple(
        requirement
        for entry in REGISTER
        for requirement in ((entry,) if isinstance(entry, Requirement) else entry(machine))
        if isfinite(requirement.bound(machine))
    )


def read_requirement(key: str) -> Requirement:
    """Return the requirement of a record's name for it; ValueError: there is none.

    >>> read_requirement("RMS force").message
    Message('requirement-rms-force')
    """
    kind, _, signal = key.partition(" ")
    if kind == "peak" and signal:
        return peak_of(signal)
    for entry in REGISTER:
        if isinstance(entry, Requirement) and entry.key == key:
            return entry
    raise ValueError(key)


def keep_reserve(machine: Machine) -> Machine:
    """Return the machine with requirements as much stricter as its reserve; itself without one."""
    reserve, strict = machine.requirements.reserve, machine
    if reserve == NO_RESERVE:
        return machine
    for item in requirements_of(machine):
        strict = item.with_bound(strict, item.share(reserve) * item.bound(machine))
    return replace(strict, requirements=replace(strict.requirements, reserve=NO_RESERVE))


COARSELY = 12
"""Samples to a period, of free motion and of free times (empirical: 3 % of a swing's peak)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Swings:
    """Requirements on signals of the same moves, less the same derivative of the setpoint."""

    requirements: tuple[Requirement, ...]
    rows: Array  # over the outputs of a velocity cycle, (n_requirements, n_outputs)
    less: int | None  # see ``Signal``
    moves: tuple[Move, ...]  # each listed one, as it is judged

    def where_to_look(self, poles: LoopPoles) -> tuple[LoopPoles, NDArray[np.int64]]:
        """Return corners, and velocity cycles; what follows the setpoint may be off most in any."""
        if self.less is None:
            return where_signals_lead(poles, self.rows)
        return poles, np.zeros(1, np.int64)

    def largest(self, poles: LoopPoles, steps: JerkSteps) -> Array:
        """Return the largest magnitudes where it is looked, (n_setpoints, n_requirements)."""
        own, parts = self.where_to_look(poles)
        motions, grid = set_in_motion(own, steps), lay_grid(own, COARSELY)
        found = extremes(motions, grid, self.rows, parts=parts, less=self.less)
        return np.asarray(found.max(axis=1))

    def at(self, poles: LoopPoles, steps: JerkSteps, times: Array) -> Array:
        """Return the largest magnitudes at some times of each, (n_setpoints, n_requirements).

        ``times``: shape (n_setpoints, n_times) [s].
        """
        own, parts = self.where_to_look(poles)
        n, motions = (times / own.dt).astype(np.int64), set_in_motion(own, steps)
        found = outputs_at(motions, n, self.rows, parts=parts, less=self.less)
        return np.asarray(np.abs(found).max(axis=(1, 2, 3)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Asked:
    """The requirements of a machine, each sort in the order of records."""

    settling: tuple[Requirement, ...]
    after: tuple[tuple[Requirement, Signal], ...]  # from t_e + τ on only
    during: tuple[Swings, ...]
    means: tuple[tuple[Requirement, Mean], ...]


def sort_requirements(machine: Machine, plant: Plant) -> Asked:
    """Return what a machine asks for."""
    ways = [(one, one.by_poles(plant)) for one in requirements_of(machine)]
    swings = [(one, way) for one, way in ways if isinstance(way, Swing)]
    during: dict[tuple[int | None, tuple[Move, ...]], dict[Requirement, Array]] = {}
    for one, way in swings:
        if not way.is_after:
            place = way.signal.less, tuple(one.judged(machine, move) for move in machine.moves)
            during.setdefault(place, {})[one] = way.signal.row
    return Asked(
        settling=tuple(one for one, way in ways if isinstance(way, Settling)),
        after=tuple((one, way.signal) for one, way in swings if way.is_after),
        during=tuple(
            Swings(
                requirements=tuple(own), rows=np.array(list(own.values())), less=less, moves=moves
            )
            for (less, moves), own in during.items()
        ),
        means=tuple((one, way) for one, way in ways if isinstance(way, Mean)),
    )


def bounded_states(machine: Machine, plant: Plant) -> Iterator[tuple[Requirement, Swing]]:
    """Yield what bounds the plant's states, not the tool's deviation or the set force."""
    for requirement in requirements_of(machine):
        swing = requirement.by_poles(plant)
        if isinstance(swing, Swing) and swing.signal.row[OUTPUTS:].any():
            yield requirement, swing
