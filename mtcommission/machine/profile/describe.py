"""What a profile may say: JSON schema, questions, and what is known of a key."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mtcommission.machine.plant  # noqa: F401  registers its kinds
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import LINEAR, ROTARY, AxisUnits
from mtcommission.machine.drive import Drive, PositionSource
from mtcommission.machine.keys import Table, list_keys, table_schema
from mtcommission.machine.machine import ABOUT, Machine
from mtcommission.machine.mechanics import HELD, KINDS
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.readers import Array, AxisRange, Range, Word, propose

Schema = dict[str, Any]


def profile_schema() -> str:
    """Return the JSON schema of profiles, as JSON text.

    Quantities carry their SI unit as ``x-unit`` and ``x-unit-rotary``.
    """
    return json.dumps(_schema(tuple(KINDS)), indent=2)


@cache
def _schema(kinds: tuple[str, ...]) -> Schema:
    """The schema with these kinds of plant: others may be registered later."""
    about = table_schema(Machine, {}, table=ABOUT)
    tables = {"About": about | {"description": "[machine]: what the sheet calls the axis."}}
    first = {
        "schema": {"const": 1, "description": "Version of the format.", "examples": ["1"]},
        ABOUT: {"$ref": "#/$defs/About", "description": "What the sheet calls the axis."},
    }
    whole = table_schema(Machine, tables, before=first)
    return {"title": "Profile", **whole, "$defs": tables}


def schemas_at(path: Sequence[str]) -> list[Schema]:
    """Return the schemas of what may stand at a key, one for each kind of table around it.

    Numbers of elements count as nothing.
    """
    whole = _schema(tuple(KINDS))
    places = [whole]
    for part in path:
        if not part.isdigit():
            tables = (table for place in places for table in _tables(place, whole["$defs"]))
            places = [table["properties"][part] for table in tables if part in table["properties"]]
    return places


def _tables(place: Schema, definitions: dict[str, Schema]) -> list[Schema]:
    """The tables that a schema allows, alternatives and elements alike."""
    if "properties" in place:
        return [place]
    below = [*place.get("anyOf", ()), *([place["items"]] if "items" in place else ())]
    if "$ref" in place:
        below.append(definitions[place["$ref"].rsplit("/", 1)[1]])
    return [table for one in below for table in _tables(one, definitions)]


def tables_at(path: Sequence[str]) -> list[Schema]:
    """Return the schemas of the tables that may stand at a key; none: it is no table."""
    definitions = _schema(tuple(KINDS))["$defs"]
    return [table for place in schemas_at(path) for table in _tables(place, definitions)]


def find_unknown(path: Sequence[str]) -> Message | None:
    """Return a proposal for the part of a key that no profile knows; None if all are known.

    Names below a table of signals are free.
    """
    for depth, name in enumerate(path):
        known = [key for table in tables_at(path[:depth]) for key in table["properties"]]
        if known and not name.isdigit() and name not in known:
            return propose(name, dict.fromkeys(known), below=tuple(path[:depth]))
    return None


def unit_of_key(path: Sequence[str], *, rotary: bool) -> str | None:
    """Return the SI unit of a key, "" for none; None where it depends on the plant."""
    name = "x-unit-rotary" if rotary else "x-unit"
    units = (place[name] for place in schemas_at(path) if name in place)
    unit = next(units, None)
    return "" if unit == "no unit" else unit


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyQuestion:
    """A key of a profile as it may be asked for."""

    key: str  # dotted; elements of arrays are asked for as number 0
    example: str  # as one types it
    default: float | str | bool | None  # SI, or a word; None where there is none
    is_required: bool
    allowed: Range | None  # what a number may be, and its unit; None for texts and words
    words: tuple[str, ...]  # what may be chosen; empty for free input


def questions(
    kind: str = "modal", *, follows: bool = False, rotary: bool = False
) -> tuple[KeyQuestion, ...]:
    """Return every key of a profile in the order in which one finds the data.

    ``kind`` of plant; ``follows``: with a motor that follows its setpoint.
    """
    plant = HELD[KINDS[kind]] if follows else KINDS[kind]
    own: list[tuple[str, type[Any], bool]] = [
        ("drive", PositionSource if follows else Drive, True),
        ("plant", plant, True),
        ("moves.0", Positioning, True),
        ("moves.0", VelocityStep, True),
    ]
    for key, _, about in list_keys(Machine):
        if isinstance(about.reader, Table):
            own.append((key, about.reader.kind, about.left_out is not None))
    axis = ROTARY if rotary else LINEAR
    found = _ask(ABOUT, Machine, axis, ABOUT)
    for place, kind_of_table, is_needed in own:
        found += _ask(place, kind_of_table, axis, is_needed=is_needed)
    return tuple({one.key: one for one in found}.values())


def _ask(
    place: str, kind: type[Any], axis: AxisUnits, table: str = "", *, is_needed: bool = True
) -> list[KeyQuestion]:
    """The questions of a table, and of those in it; an array is asked for its first element."""
    found = []
    for name, _, about in list_keys(kind, table):
        reader, key, is_required = about.reader, f"{place}.{name}", is_needed and about.is_required
        if isinstance(reader, Array) and isinstance(reader.inner, Table):
            found += _ask(f"{key}.0", reader.inner.kind, axis, is_needed=is_required)
        elif isinstance(reader, Table):
            found += _ask(key, reader.kind, axis, is_needed=is_required)
        else:
            question = KeyQuestion(
                key=key,
                example=about.example,
                default=about.default,
                is_required=is_required,
                allowed=reader.on(axis) if isinstance(reader, AxisRange) else None,
                words=reader.choices if isinstance(reader, Word) else (),
            )
            found.append(question)
    return found
