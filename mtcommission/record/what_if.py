"""All that a page needs to run a record's loop again with other values."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from mtcommission.controls.kind import MOVING_AVERAGE
from mtcommission.limits.requirements import Yields, bounded_states, requirements_of
from mtcommission.loop.disturbance import encoder_noise
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.respond import OUTPUTS
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.machine.variations import Corner, vary
from mtcommission.record.shape import entry_of, of
from mtcommission.record.values import (
    InCorner,
    Matrix,
    SetpointFilterEntry,
    describe_move,
)
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.rules import TodaysValues

PAYLOAD = 1.0
"""At which the share of a payload in a mode's inertia is read [kg]: it is linear in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SampledEntry:
    """The nominal loop at the velocity cycle, for whoever closes it on other machines.

    X over ``states``: the plant's first, F_set at ``pending``, what the position cycle hands down
    from ``held`` on. X⁺ = ``cycle`` X in a velocity cycle; after ``cycles`` of these the states
    from ``held`` on become ``by_state`` X, X from before them, plus ``by_setpoint`` times (x_ref,
    v_ref, a_ref, j_ref) at that time, then one position cycle earlier, and so on. Where the motor
    follows, what is handed down are its position, velocity, acceleration and jerk.
    """

    follows: bool
    velocity_cycle: float
    cycles: int
    reference_delay: float
    states: list[str]
    pending: int
    held: int
    cycle: Matrix
    by_state: Matrix
    by_setpoint: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedModeEntry:
    """Where a mode stands in the plant; payload p divides its terms by 1 + p ``payload_share``."""

    deflection: int
    rate: int
    payload_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalEntry:
    """A row over the plant's states whose largest magnitude counts, from t_e + τ on or always."""

    name: str
    unit: str
    row: list[float]
    less: int | None  # less that derivative of the delayed setpoint, 0: position; None: as it is
    is_after: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedPlantEntry:
    """The nominal plant, and what payload, frequency and damping change in it.

    The force moves the state ``velocity`` by 1/(``moving_mass`` + payload); where the motor
    follows, the last state is its acceleration and B the jerk's. ``signals``: the motor's force,
    then each that a check of the same name bounds.
    """

    A: Matrix
    B: list[float]
    tcp: list[float]
    signals: list[SignalEntry]
    position: int
    velocity: int
    moving_mass: float
    modes: list[VariedModeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class NoisyCornerEntry(InCorner):
    """A corner, and what the steps of the encoder add there either way."""

    tool_noise: float = of("tool")
    force_noise: float = of("force")


@dataclass(frozen=True, slots=True, kw_only=True)
class StateEntry:
    """The plant in a state in which it was measured, and the loop around it."""

    name: str
    plant: VariedPlantEntry
    loop: SampledEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitEntry:
    """A requirement; ``of_listed``: smaller moves than the listed ones need not keep it."""

    name: str
    unit: str
    limit: float
    of_listed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedsEntry:
    """What moves are judged by; None: not stated. ``every_size``: smaller moves count, too."""

    checks: list[LimitEntry]
    tcp_deviation: float
    contour_feed: float | None
    motion_force: float
    static_load: float
    every_size: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownLimitsEntry:
    """Limits to begin with; ``loop`` where it is another one, ``states``: in each state."""

    name: str
    acceleration: float
    jerk: float
    setpoint_filter: SetpointFilterEntry | None
    loop: SampledEntry | None
    states: list[StateEntry] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class WhatIfPart:
    """All that it takes to run other limits, moves and machines through the loop again."""

    jerk: str
    loop: SampledEntry
    plant: VariedPlantEntry
    corners: list[NoisyCornerEntry]
    moves: list[dict[str, float]]
    requirements: NeedsEntry
    limits: list[KnownLimitsEntry]
    force_filters: list[ForceFilter]
    states: list[StateEntry] = field(default_factory=list)
    averages: list[float] | None  # least and longest moving average; None: the control has none


def what_if_part(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    today: TodaysValues | None,
) -> WhatIfPart:
    """Return what a page needs to answer for other limits, moves and machines.

    The values now in the control first, where they are stated and their loop is stable.
    """
    controller, control = tuned.controller, machine.control
    given = limits.setpoint_filter or control.setpoint_filter
    known = [_known("recommended", limits, given)]
    if today is not None and today.judged is not None:
        own = build_loop(plant, today.controller, model=plant) if today.stated else None
        given = today.today.setpoint_filter
        states = _states(machine, plant, today.controller) if today.stated else []
        known.insert(0, _known("today", today.limits, given, own, states))
    average = control.kind.find_filter(MOVING_AVERAGE)
    return WhatIfPart(
        jerk=control.kind.jerk.value,
        loop=sampled_entry(tuned.loops[0]),
        plant=_plant_entry(machine, plant),
        states=_states(machine, plant, controller),
        corners=[
            entry_of(
                NoisyCornerEntry,
                corner,
                encoder_noise(loop, resolution=machine.drive.encoder_resolution),
            )
            for corner, loop in zip(tuned.corners, tuned.loops, strict=True)
        ],
        moves=[describe_move(move) for move in machine.moves],
        requirements=entry_of(
            NeedsEntry,
            machine.requirements,
            machine.drive,
            checks=[
                LimitEntry(
                    name=item.key,
                    unit=item.unit(machine, plant),
                    limit=item.bound(machine),
                    of_listed=item.yields is Yields.MINIMISED,
                )
                for item in requirements_of(machine)
            ],
        ),
        limits=known,
        force_filters=list(controller.force_filters),
        averages=list(average.times(controller.position_cycle)) if average else None,
    )


def sampled_entry(loop: SampledLoop) -> SampledEntry:
    """Return a loop without the kept setpoint samples, which follow from the setpoint alone."""
    size, rows = loop.own_size, loop.handed_down
    # Kept samples stand before the current one in ``handed_down``: newest first from here on.
    return entry_of(
        SampledEntry,
        loop.controller,
        loop,
        states=loop.states[:size],
        pending=loop.integrator + 1,
        cycle=loop.cycle[:size, :size],
        by_state=rows[:, :size],
        by_setpoint=np.hstack([rows[:, -4:], rows[:, size:-4]]),
    )


def _plant_entry(machine: Machine, plant: Plant) -> VariedPlantEntry:
    radius = machine.requirements.payload_radius
    return entry_of(
        VariedPlantEntry,
        plant,
        tcp=plant.row("tcp"),
        signals=[_motor_force(plant), *_bounded_signals(machine, plant)],
        modes=[
            VariedModeEntry(
                deflection=mode.deflection,
                rate=mode.rate,
                payload_share=_payload_share(machine, mode.name, radius),
            )
            for mode in plant.modes
        ],
    )


def _states(machine: Machine, model: Plant, controller: Controller) -> list[StateEntry]:
    found = []
    for state in machine.states:
        own = vary(machine, Corner(state=state.name))
        plant = build_plant(own)
        loop = sampled_entry(build_loop(plant, controller, model=model))
        found.append(StateEntry(name=state.name, plant=_plant_entry(own, plant), loop=loop))
    return found


def _motor_force(plant: Plant) -> SignalEntry:
    name = plant.states[plant.force]
    row = plant.row(name).tolist()
    return SignalEntry(name=name, unit=plant.unit(name), row=row, less=None, is_after=False)


def _bounded_signals(machine: Machine, plant: Plant) -> Iterator[SignalEntry]:
    for requirement, swing in bounded_states(machine, plant):
        yield SignalEntry(
            name=requirement.key,
            unit=requirement.unit(machine, plant),
            row=swing.signal.row[OUTPUTS:].tolist(),
            less=swing.signal.less,
            is_after=swing.is_after,
        )


def _payload_share(machine: Machine, mode: str, radius: float) -> float:
    ratio = machine.mechanics.inertia_ratio(mode, np.array([PAYLOAD]), radius)
    return float(1.0 / ratio[0] - 1.0) / PAYLOAD


def _known(
    name: str,
    limits: MotionLimits,
    given: SetpointFilter | None,
    loop: SampledLoop | None = None,
    states: Sequence[StateEntry] = (),
) -> KnownLimitsEntry:
    return entry_of(
        KnownLimitsEntry,
        limits,
        name=name,
        setpoint_filter=given,
        loop=sampled_entry(loop) if loop else None,
        states=states,
    )
