"""A machine as the terminal shows it: modes, rigid-body limits, warnings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.cli.terminal import Line, heading, heads, table, warn
from mtcommission.controls.wording import name_control
from mtcommission.machine.checks import (
    OF_LOOP,
    describe_kind,
    list_neglected,
    mark_assumed,
    say_loop,
)
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import least_motion_time
from mtcommission.machine.plant.plant import Plant


def describe_machine(
    machine: Machine,
    plant: Plant,
    warnings: Sequence[Message | str],
    assumed: Sequence[str],
    spoken: Catalogue,
) -> list[Line]:
    """Return modes, rigid-body limits, what results rest on, and warnings of a profile."""
    text = spoken.text
    columns = ["mode", "name-frequency", "name-damping-ratio", "tool-at-full-force", "seen"]
    return [
        heading(text("terminal-machine", name=machine.name, axis_name=machine.axis)),
        text("terminal-source", source=machine.source),
        *table(
            heads(spoken, *columns[: 4 if machine.drive.follows else 5]),
            _modes(machine, plant, spoken),
        ),
        *table(
            heads(spoken, "rigid-body-limit", "value", "reason"), _limits(machine, plant, spoken)
        ),
        *table([*heads(spoken, "basis"), ""], _basis(machine, assumed, spoken)),
        *(warn(spoken, warnings) or [text("terminal-no-warnings")]),
    ]


def _modes(machine: Machine, plant: Plant, spoken: Catalogue) -> Iterator[list[str]]:
    printed, length = spoken.format, machine.axis_units.length.si
    for mode in plant.modes:
        compliance = mode.tcp_gain / mode.natural_frequency**2
        row = [
            mode.name,
            printed.quantity(mode.frequency_hz, "Hz"),
            printed.number(mode.damping_ratio, digits=3),
            printed.quantity(abs(compliance) * machine.drive.motion_force, length),
        ]
        seen = spoken.text("yes" if mode.measured_gain else "no")
        yield row if machine.drive.follows else [*row, seen]


def _limits(machine: Machine, plant: Plant, spoken: Catalogue) -> Iterator[list[str]]:
    text, printed, axis, drive = spoken.text, spoken.format, machine.axis_units, machine.drive
    a, of_motor = drive.motion_force / plant.moving_mass, text("terminal-of-motor")
    on_mass = text(
        "terminal-force-on-mass",
        force=printed.quantity(drive.motion_force, axis.force.si),
        mass=printed.quantity(plant.moving_mass, axis.mass.si),
    )
    acceleration = printed.quantity(a, f"{axis.length.si}/s^2")
    yield [text("acceleration"), acceleration, of_motor if drive.follows else on_mass]
    if isfinite(drive.max_velocity):
        velocity = printed.quantity(drive.max_velocity, axis.velocity.si)
        yield [text("velocity"), velocity, of_motor]
    for number, move in enumerate(machine.moves, start=1):
        least = printed.quantity(least_motion_time(move, a), "s")
        reason = text("terminal-rigid-time") if number == 1 else ""
        yield [text("terminal-time-of-move", number=number), least, reason]


def _basis(machine: Machine, assumed: Sequence[str], spoken: Catalogue) -> Iterator[list[str]]:
    """The control with its loop, what is assumed, and what is neglected."""
    control = machine.control
    name = spoken.say(name_control(control.kind.key))
    where = "" if machine.drive.follows else control.position_loop.value
    loop = say_loop(where, control.position_cycle, control.velocity_cycle, spoken)
    keys = OF_LOOP[1:2] if machine.drive.follows else OF_LOOP
    loop = mark_assumed(loop, keys, list(filter(machine.is_assumed, keys)), spoken)
    has = spoken.say(describe_kind(control.kind, follows=machine.drive.follows))
    for label, sentences in (
        ("control", [f"{name}: {has}"]),
        ("terminal-basis-loop", [loop]),
        ("basis-assumed", assumed),
        ("terminal-basis-neglected", map(spoken.say, list_neglected(machine))),
    ):
        for place, sentence in enumerate(sentences):
            yield ["" if place else spoken.text(label), sentence]
