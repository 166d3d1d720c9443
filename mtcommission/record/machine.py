"""The machine of a record: its profile, its data as the sheet shows them, and its plant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isclose, isfinite

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, printable
from mtcommission.machine.drive import PositionSource
from mtcommission.machine.identified import Identification
from mtcommission.machine.keys import list_quantities
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import SOURCE
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.profile.read import find_key_lines
from mtcommission.machine.readers import KeyPath, show_key
from mtcommission.record.shape import Matrix, Words, of

ILLUSTRATIVE = Message("source-illustrative")
ACCEPTED_DEFAULT = Message("source-accepted-default")
"""Sources of values that nobody measured."""

SAME = 1e-3
"""Relative difference up to which a value is the one that was measured: profiles round."""

NOT_STATED = {"source-default", ILLUSTRATIVE.kind, ACCEPTED_DEFAULT.kind}
"""Sources of values that nobody stated for this machine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The machine profile as read."""

    name: str = of(lambda source: printable(source.path.name))
    sha256: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineEntry:
    """What the machine is called, and where its data come from."""

    name: str
    axis: str
    motion: str
    source: str
    kind: str = of("mechanics.kind")
    drive: str = of(lambda machine: SOURCE if machine.drive.follows else "servo")

    @property
    def follows(self) -> bool:
        """Whether the motor follows its setpoint."""
        return self.drive == SOURCE


@dataclass(frozen=True, slots=True, kw_only=True)
class Datum:
    """One machine datum as the sheet shows it: its key in the profile, value and SI unit."""

    key: str
    value: float | str
    unit: str
    source: Words

    @property
    def is_assumed(self) -> bool:
        """Whether nobody stated it for this machine."""
        return isinstance(self.source, Message) and self.source.kind in NOT_STATED


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeEntry:
    """A flexible mode of the plant."""

    name: str
    frequency_hz: float
    damping_ratio: float
    tcp_gain: float
    measured_gain: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantEntry:
    """The plant: x' = A x + B F_set and its outputs, rows over the states.

    Where the motor follows its setpoint, F is its acceleration and B the column of its jerk.
    """

    states: list[str]
    units: dict[str, str] = of(lambda plant: _units(plant))
    A: Matrix
    B: list[float]
    outputs: dict[str, list[float]] = of(
        lambda plant: dict(zip(plant.outputs, plant.C, strict=True))
    )
    modes: list[ModeEntry]
    moving_mass: float


def list_assumptions(machine: Machine) -> list[Message]:
    """Return what the computation assumes beyond the profile; printed on every sheet."""
    return [
        *([Message("assumption-illustrative")] if machine.illustrative else []),
        *machine.mechanics.assumptions(),
        Message(f"assumption-linear{'-with-friction' if machine.drive.has_friction else ''}"),
        Message("assumption-encoder"),
        Message("assumption-cycles"),
        *([Message("assumption-static-load")] if machine.drive.static_load else []),
    ]


def list_data(machine: Machine, plant: Plant, profile_text: str) -> list[Datum]:
    """Return every machine datum with its key, SI unit and source.

    What the text of the profile does not state is a default. Data of plant and drive have the
    machine's source, moves and requirements the profile itself, but for ``machine.assumed`` and
    what still has the value that [identified] holds.
    """
    stated = find_key_lines(profile_text)
    given = {_spelt(machine, path) for path in stated}
    assumed = {_spelt(machine, path) for path in stated if machine.is_assumed(show_key(path))}
    said = machine.identified
    measured = dict(_measured(said)) if said else {}

    def source(key: str, value: float | str) -> Message | str:
        known = measured.get(key) if key not in assumed else None
        if known is not None and isclose(float(value), known, rel_tol=SAME):
            return Message("source-measured", date=said.date if said else "")
        return _source(machine, key, given, assumed)

    return [
        Datum(key=key, value=value, unit=unit, source=source(key, value))
        for key, value, unit in _rows(machine, plant, given)
        if isinstance(value, str) or isfinite(value)
    ]


def _measured(said: Identification) -> Iterator[tuple[str, float]]:
    """Key and value of what was measured of the plant."""
    if said.moving_mass:
        yield "plant.moving_mass", said.moving_mass.value
    for mode in said.modes:
        for name in ("frequency_hz", "damping_ratio", "measured_gain", "tcp_gain"):
            if one := getattr(mode, name):
                yield f"plant.modes.{mode.name}.{name.removesuffix('_hz')}", one.value


def _rows(
    machine: Machine, plant: Plant, given: set[str]
) -> Iterator[tuple[str, float | str, str]]:
    drive, needs, axis = machine.drive, machine.requirements, machine.axis_units
    motor: object = drive
    yield "control.kind", machine.control.kind.key, ""
    if len(machine.control.kind.position_loops) > 1 and not drive.follows:
        yield "control.position_loop", machine.control.position_loop.value, ""
    if drive.follows:
        yield "drive.kind", SOURCE, ""
        motor = PositionSource(max_acceleration=drive.max_force, max_velocity=drive.max_velocity)
    own = ["drive.max_velocity", *(["drive.gear"] if drive.lead else [])]
    shown = {*given, *machine.assumed, *own}
    tables = [("control", machine.control), ("plant", machine.mechanics), ("drive", motor)]
    tables += [(f"moves[{number}]", move) for number, move in enumerate(machine.moves, start=1)]
    for place, part in [*tables, ("requirements", needs)]:
        for key, value, unit in list_quantities(part, place, axis):
            is_reserve = ".reserve." in key and "requirements.reserve" in shown
            if place == "plant" or key in shown or is_reserve:
                yield key, value, unit
    yield "requirements.payload (least)", needs.payload[0], axis.mass.si
    yield "requirements.payload (largest)", needs.payload[1], axis.mass.si
    units = _units(plant)
    yield from ((f"requirements.peaks.{p.name}", p.value, units[p.name]) for p in needs.peaks)


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


ASSUMED_FIRST = (
    *("requirements.frequency", "requirements.damping", "requirements.", "control."),
    *("drive.", "moves", "plant."),
)
"""In which order one reads what was assumed: what is asked of the limits before the machine."""

UNSAID = ("requirements.payload", "drive.gear")
"""What is nothing, or one, on most machines."""


def list_assumed(machine: Machine, plant: Plant, profile_text: str, words: Catalogue) -> list[str]:
    """Return what nobody stated of a machine, and what its model assumes, in words.

    That a machine is an example is said once, not of each value that its profile states; whose
    control it has is said.
    """
    data = list_data(machine, plant, profile_text)
    ordered = sorted(
        (
            item
            for item in data
            if item.source != ILLUSTRATIVE or item.key.startswith("control.")
            if not item.key.startswith(UNSAID)
        ),
        key=lambda item: [item.key.startswith(begin) for begin in ASSUMED_FIRST].index(True),
    )
    known = [Message("assumed-illustrative")] if machine.illustrative else []
    model = list(machine.mechanics.assumptions())
    if machine.drive.force_velocity is not None:
        both = {"acceleration": machine.drive.max_force, "velocity": machine.drive.force_velocity}
        model.append(Message("assumed-acceleration-at", **both))
    said = say_assumed(ordered, _units(plant), words)
    return [*map(words.say, known), *said, *map(words.say, model)]


def _units(plant: Plant) -> dict[str, str]:
    return dict(zip(plant.signals, plant.signal_units, strict=True))


def say_assumed(data: Iterable[Datum], units: dict[str, str], words: Catalogue) -> list[str]:
    """Return each value that nobody stated, by its name; ``units`` of the plant's signals."""
    return [
        f"{datum_name(item, words)} = {datum(item, units, words)}"
        for item in data
        if item.is_assumed
    ]


def datum_name(item: Datum, words: Catalogue) -> str:
    """Return the name of a datum, with the number of its move or the name of its mode."""
    *path, last = item.key.split(".")
    name = words.name(last)
    number = ".".join(path).removeprefix("moves[").removesuffix("]")
    if number.isdecimal():
        return f"{words.text('move', number=number)}: {name}"
    if path[:2] == ["plant", "modes"]:
        return words.text("of-mode", name=name, mode=".".join(path[2:]))
    return words.text("peak-bound", name=name) if path == ["requirements", "peaks"] else name


def datum(item: Datum, units: dict[str, str], words: Catalogue) -> str:
    """Return the value of a datum with its unit; ``units`` are those of the plant's signals."""
    key, value = item.key, item.value
    if isinstance(value, str):
        return words.known(f"choice-{value}", value)
    if key.endswith(("_spread", "damping_ratio")) or key.startswith("requirements.reserve."):
        return words.format.percent(value)
    if key.startswith("requirements.peaks."):
        return words.format.quantity(value, units.get(key.rpartition(".")[2], item.unit))
    return words.format.quantity(value, item.unit)
