"""Loop, machine and requirements as data: enough to simulate any other move from the record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mtcommission.control_kinds.kind import MOVING_AVERAGE
from mtcommission.loop.disturbance import encoder_noise
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.respond import OUTPUTS
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Corner, vary
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.record.data import describe_move, filter_entry
from mtcommission.record.schema.values import SetpointFilterEntry
from mtcommission.record.schema.what_if import (
    KnownLimitsEntry,
    LimitEntry,
    NeedsEntry,
    NoisyCornerEntry,
    SampledEntry,
    SignalEntry,
    StateEntry,
    VariedModeEntry,
    VariedPlantEntry,
    WhatIfPart,
)
from mtcommission.record.shape import entry_of
from mtcommission.requirements.register import requirements_of
from mtcommission.requirements.requirement import Yields
from mtcommission.requirements.together import bounded_states
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.rules import TodaysValues

PAYLOAD = 1.0
"""At which the share of a payload in a mode's inertia is read [kg]: it is linear in it."""


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
    known = [_known("recommended", limits, entry=filter_entry(given))]
    if today is not None and today.judged is not None:
        own = build_loop(plant, today.controller, model=plant) if today.stated else None
        entry = filter_entry(today.today.setpoint_filter)
        states = _states(machine, plant, today.controller) if today.stated else []
        known.insert(0, _known("today", today.limits, entry=entry, loop=own, states=states))
    average = control.kind.find_filter(MOVING_AVERAGE)
    return WhatIfPart(
        jerk=control.kind.jerk.value,
        loop=sampled_entry(tuned.loops[0]),
        plant=_plant_entry(machine, plant),
        states=_states(machine, plant, controller),
        corners=[
            _corner_entry(machine, corner, loop)
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


def _corner_entry(machine: Machine, corner: Corner, loop: SampledLoop) -> NoisyCornerEntry:
    noise = encoder_noise(loop, resolution=machine.drive.encoder_resolution)
    return entry_of(NoisyCornerEntry, corner, tool_noise=noise.tool, force_noise=noise.force)


def _known(
    name: str,
    limits: MotionLimits,
    *,
    entry: SetpointFilterEntry | None,
    loop: SampledLoop | None = None,
    states: Sequence[StateEntry] = (),
) -> KnownLimitsEntry:
    return entry_of(
        KnownLimitsEntry,
        limits,
        name=name,
        setpoint_filter=entry,
        loop=sampled_entry(loop) if loop else None,
        states=list(states),
    )
