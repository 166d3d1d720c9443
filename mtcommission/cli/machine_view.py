"""A machine as the terminal shows it: modes, rigid-body limits, warnings."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from mtcommission.cli.terminal import empty_table, heading, warn, words_for
from mtcommission.machine.basis import describe_kind, list_assumed, list_neglected
from mtcommission.machine.machine import Machine
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, kalman_rank

LOOP_KEYS = ("control.position_loop", "control.position_cycle", "control.velocity_cycle")


def describe_machine(machine: Machine, plant: Plant, warnings: Sequence[Message | str]) -> Group:
    """Return modes, rigid-body limits, what results rest on, and warnings of a profile.

    Parameters
    ----------
    machine, plant
        Nominal.
    warnings
        From the plausibility check.
    """
    spoken, axis = words_for(machine), machine.axis_units
    printed, length, force = spoken.format, axis.length.si, axis.force.si
    columns = ("mode", "frequency", "damping-ratio", "tool-per-force", "seen")
    modes = empty_table(spoken, *(columns[:-1] if machine.drive.follows else columns))
    for mode in plant.modes:
        compliance = mode.tcp_gain / mode.natural_frequency**2
        at_full = printed.quantity(abs(compliance) * machine.drive.motion_force, length)
        seen = spoken.text("yes" if mode.measured_gain else "no")
        modes.add_row(
            mode.name,
            printed.quantity(mode.frequency_hz, "Hz"),
            printed.number(mode.damping_ratio, digits=3),
            spoken.text("terminal-at-full-force", value=at_full),
            *(() if machine.drive.follows else (seen,)),
        )
    limits = empty_table(spoken, "rigid-body-limit", "value", "reason")
    a = machine.drive.motion_force / plant.moving_mass
    mass = printed.quantity(plant.moving_mass, axis.mass.si)
    limits.add_row(
        spoken.text("terminal-acceleration"),
        printed.quantity(a, f"{length}/s^2"),
        spoken.text("terminal-of-motor")
        if machine.drive.follows
        else spoken.text(
            "terminal-force-on-mass",
            force=printed.quantity(machine.drive.motion_force, force),
            mass=mass,
        ),
    )
    if isfinite(machine.drive.max_velocity):
        limits.add_row(
            spoken.text("terminal-velocity"),
            printed.quantity(machine.drive.max_velocity, axis.velocity.si),
            spoken.text("terminal-of-motor"),
        )
    for number, move in enumerate(machine.moves, start=1):
        limits.add_row(
            spoken.text("terminal-time-of-move", number=number),
            printed.quantity(least_motion_time(move, a), "s"),
            spoken.text("terminal-rigid-time"),
        )
    rank = kalman_rank(plant)
    parts: list[RenderableType] = [
        heading(spoken.text("terminal-machine", name=machine.name, axis_name=machine.axis)),
        Text(spoken.text("terminal-source", source=machine.source)),
        modes,
        limits,
        _basis(machine, spoken),
        Text(spoken.text("terminal-controllable", rank=rank, order=plant.order)),
    ]
    parts += warn(spoken, warnings)
    if not warnings:
        parts.append(Text(spoken.text("terminal-no-warnings")))
    return Group(*parts)


def _basis(machine: Machine, spoken: Catalogue) -> Table:
    """The control with its loop, what is assumed, and what is neglected."""
    control, printed = machine.control, spoken.format
    name = spoken.text(f"control-kind-{control.kind.key}")
    loop = spoken.text(
        "no-position-loop"
        if machine.drive.follows
        else f"position-loop-{control.position_loop.value}",
        position_cycle=printed.quantity(control.position_cycle, "s"),
        velocity_cycle=printed.quantity(control.velocity_cycle, "s"),
    )
    if any(map(machine.is_assumed, LOOP_KEYS)):
        loop = spoken.text("assumed", value=loop)
    has = spoken.say(describe_kind(control.kind, follows=machine.drive.follows))
    table = empty_table(spoken, "basis")
    table.add_column(overflow="fold")
    for label, sentences in (
        ("control", [f"{name}: {has}"]),
        ("loop", [loop]),
        ("assumed", [spoken.say(one) for one in list_assumed(machine)]),
        ("neglected", [spoken.say(one) for one in list_neglected(machine)]),
    ):
        for first, sentence in enumerate(sentences):
            table.add_row("" if first else spoken.text(f"terminal-basis-{label}"), sentence)
    return table
