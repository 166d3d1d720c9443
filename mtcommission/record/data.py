"""Machine, profile and time series -> the entries that several parts of a record share."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.keys import list_quantities
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.machine.readers import KeyPath
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message, printable
from mtcommission.plant.plant import Plant
from mtcommission.profile.lines import find_key_lines, show_key
from mtcommission.profile.read import ProfileSource
from mtcommission.record.schema.machine import Datum, MachineEntry
from mtcommission.record.schema.record import Profile
from mtcommission.record.schema.values import SetpointFilterEntry
from mtcommission.record.shape import entry_of

Array = NDArray[np.float64]

Row = tuple[str, float | str, str]
"""Key, value and SI unit."""

ILLUSTRATIVE = Message("source-illustrative")
ACCEPTED_DEFAULT = Message("source-accepted-default")
"""Sources of values that nobody measured."""


def describe_move(move: Move) -> dict[str, float]:
    """Return a move with the profile's keys; limits that were not set are left out."""
    if isinstance(move, VelocityStep):
        entry = {"velocity_step": move.velocity_step}
    else:
        entry = {"distance": move.distance}
        if isfinite(move.max_velocity):
            entry["max_velocity"] = move.max_velocity
    if move.dwell:
        entry["dwell"] = move.dwell
    return entry


def list_assumptions(machine: Machine) -> list[Message]:
    """Return what the computation assumes beyond the profile; printed on every sheet."""
    return [
        *([Message("assumption-illustrative")] if machine.illustrative else []),
        *machine.mechanics.assumptions(),
        Message(f"assumption-linear{'-with-friction' if machine.drive.has_friction else ''}"),
        Message("assumption-encoder"),
        Message("assumption-cycles"),
        Message("assumption-exact-rest"),
        Message("assumption-calculated"),
        *([Message("assumption-static-load")] if machine.drive.static_load else []),
    ]


def list_data(machine: Machine, plant: Plant, profile_text: str) -> list[Datum]:
    """Return every machine datum with its key, SI unit and source.

    What the text of the profile does not state is a default. Data of plant and drive have the
    machine's source, moves and requirements the profile itself, but for ``machine.assumed``.
    """
    rows = [
        *_control_rows(machine),
        *list_quantities(machine.mechanics, "plant", machine.axis_units),
        *_drive_rows(machine),
        *_move_rows(machine),
        *_requirement_rows(machine, plant),
    ]
    stated = find_key_lines(profile_text).lines
    given = {_spelt(machine, path) for path in stated}
    assumed = {_spelt(machine, path) for path in stated if machine.is_assumed(show_key(path))}
    return [
        Datum(key=key, value=value, unit=unit, source=_source(machine, key, given, assumed))
        for key, value, unit in rows
        if isinstance(value, str) or isfinite(value)
    ]


def _control_rows(machine: Machine) -> list[Row]:
    control, loops = machine.control, len(machine.control.kind.position_loops)
    has_choice = loops > 1 and not machine.drive.follows
    return [
        ("control.kind", control.kind.key, ""),
        *([("control.position_loop", control.position_loop.value, "")] if has_choice else []),
        ("control.position_cycle", control.position_cycle, "s"),
        ("control.velocity_cycle", control.velocity_cycle, "s"),
    ]


def _drive_rows(machine: Machine) -> list[Row]:
    drive, force = machine.drive, machine.axis_units.force.si
    length = machine.axis_units.length.si
    if drive.follows:
        return [
            ("drive.kind", drive.kind.value, ""),
            ("drive.max_acceleration", drive.max_force, force),
            ("drive.max_velocity", drive.max_velocity, machine.axis_units.velocity.si),
        ]
    stated = [
        ("drive.lead", drive.lead or 0.0, length),
        ("drive.gear", drive.gear if drive.lead else 0.0, ""),
        ("drive.encoder_resolution", drive.encoder_resolution, length),
        ("drive.coulomb_friction", drive.coulomb_friction, force),
        ("drive.viscous_friction", drive.viscous_friction, machine.axis_units.damping.si),
    ]
    return [
        ("drive.force_lag", drive.force_lag, "s"),
        ("drive.max_force", drive.max_force, force),
        ("drive.continuous_force", drive.continuous_force, force),
        ("drive.static_load", drive.static_load, force),
        *(row for row in stated if row[1]),
    ]


def _move_rows(machine: Machine) -> list[Row]:
    heats = isfinite(machine.drive.continuous_force)
    return [
        (key, value, unit)
        for number, move in enumerate(machine.moves, start=1)
        for key, value, unit in list_quantities(move, f"moves[{number}]", machine.axis_units)
        if value or heats or not key.endswith(".dwell")
    ]


def _requirement_rows(machine: Machine, plant: Plant) -> list[Row]:
    needs, mass = machine.requirements, machine.axis_units.mass.si
    units = dict(zip(plant.signals, plant.signal_units, strict=True))
    return [
        *list_quantities(needs, "requirements", machine.axis_units),
        ("requirements.payload (least)", needs.payload[0], mass),
        ("requirements.payload (largest)", needs.payload[1], mass),
        *((f"requirements.peaks.{p.name}", p.bound, units[p.name]) for p in needs.peaks),
    ]


def _spelt(machine: Machine, path: KeyPath) -> str:
    """A key of the profile as the list of data spells it."""
    match path:
        case ("moves", int(index), key):
            return f"moves[{index + 1}].{key}"
        case ("plant", "modes", int(index), key):
            return f"plant.modes.{machine.mechanics.modes[index].name}.{key}"
        case _:
            return ".".join(map(str, path))


def _source(machine: Machine, key: str, given: set[str], assumed: set[str]) -> Message | str:
    plain = key.partition(" (")[0]
    if plain in assumed:
        return ILLUSTRATIVE if machine.illustrative else ACCEPTED_DEFAULT
    if plain not in given:
        return Message("source-default")
    return machine.source if key.startswith(("plant.", "drive.")) else Message("source-stated")


def filter_entry(item: SetpointFilter | None) -> SetpointFilterEntry | None:
    """Return a setpoint filter as the record holds it."""
    return entry_of(SetpointFilterEntry, item, item.impulses) if item else None


def profile_entry(source: ProfileSource) -> Profile:
    """Return name, hash and text of a profile."""
    return Profile(name=printable(source.path.name), sha256=source.sha256, text=source.text)


def machine_entry(machine: Machine) -> MachineEntry:
    """Return what a machine is called, and where its data come from."""
    return entry_of(MachineEntry, machine, kind=machine.mechanics.kind, drive=machine.drive.kind)


def by_name(names: Sequence[str], values: Array) -> dict[str, float]:
    """Return values by the names of signals or states."""
    return dict(zip(names, values.tolist(), strict=True))


def by_mode(plant: Plant, values: Sequence[float] | Array) -> dict[str, float]:
    """Return values by the names of the plant's modes."""
    return {mode.name: float(value) for mode, value in zip(plant.modes, values, strict=True)}
