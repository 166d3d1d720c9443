"""Validation errors of pydantic -> faults in our words, with file, line and remedy."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from mtcommission.errors import Fault
from mtcommission.messages.message import Message
from mtcommission.plant.kinds import KINDS
from mtcommission.profile.control_tables import ControlTable, TodayTable
from mtcommission.profile.drive_tables import (
    POSITION_SOURCE,
    SERVO,
    DriveTable,
    PositionSourceTable,
)
from mtcommission.profile.filter_tables import ForceFilterTable, SetpointFilterTable
from mtcommission.profile.identified_tables import (
    IdentifiedTable,
    MeasuredFileTable,
    MeasuredModeTable,
)
from mtcommission.profile.lines import KeyLines, KeyPath, show_key
from mtcommission.profile.model import (
    DampingOptimalTable,
    MachineTable,
    ModeBands,
    MoveTable,
    ProfileTable,
    RequirementsTable,
    ReserveTable,
)
from mtcommission.profile.plant_tables import MOTOR_HELD, PLANT_TABLES, element_tables
from mtcommission.profile.table import Table
from mtcommission.profile.values import Faults, describe, find_close, one_of, propose

_TABLES: Mapping[tuple[str, ...], type[Table]] = {
    (): ProfileTable,
    ("machine",): MachineTable,
    **{("plant", kind): table for kind, table in PLANT_TABLES.items()},
    **{
        ("plant", kind, key): element
        for kind, table in PLANT_TABLES.items()
        for key, element in element_tables(table).items()
    },
    ("drive", SERVO): DriveTable,
    ("drive", POSITION_SOURCE): PositionSourceTable,
    ("moves",): MoveTable,
    ("requirements",): RequirementsTable,
    ("requirements", "modes"): ModeBands,
    ("requirements", "reserve"): ReserveTable,
    ("damping_optimal",): DampingOptimalTable,
    ("control",): ControlTable,
    ("control", "setpoint_filter"): SetpointFilterTable,
    ("control", "force_filters"): ForceFilterTable,
    ("today",): TodayTable,
    ("today", "setpoint_filter"): SetpointFilterTable,
    ("identified",): IdentifiedTable,
    ("identified", "files"): MeasuredFileTable,
    ("identified", "modes"): MeasuredModeTable,
}


def list_faults(error: ValidationError, *, where: str, lines: KeyLines) -> list[Fault]:
    """Return every fault behind a validation error, ordered by line.

    Parameters
    ----------
    error
        From the profile's tables.
    where
        Name of the profile for messages.
    lines
        Where its keys stand.

    Returns
    -------
    list of Fault
        A misspelt key and the one that is missing for it are one fault.
    """
    details = error.errors()
    missing = [detail["loc"] for detail in details if detail["type"] == "missing"]
    faults: list[Fault] = []
    meant: set[KeyPath] = set()
    for detail in details:
        loc = detail["loc"]
        beside = {str(path[-1]): path for path in missing if path[:-1] == loc[:-1]}
        close = find_close(str(loc[-1]), beside) if detail["type"] == "extra_forbidden" else ""
        found = _translate(detail, where, lines)
        if close:
            meant.add(beside[close])
            message = Message("key-misspelt", meant=close)
            found = [replace(fault, message=message) for fault in found]
        faults += found
    gone = {show_key(_written(path)) for path in meant}
    kept = [f for f in faults if not (f.key in gone and f.message.kind == "key-missing")]
    return sorted(kept, key=lambda fault: fault.line)


def find_unknown(path: Sequence[str]) -> Message | None:
    """Return a proposal for the part of a key that no profile knows; None if all are known.

    Parameters
    ----------
    path
        Names of tables and key; numbers of elements count as nothing.

    Returns
    -------
    Message or None
        From ``propose``. Names below a table of signals are free.

    Examples
    --------
    >>> find_unknown(["drive", "force_lg"])
    Message('hint-did-you-mean', name='force_lag')
    >>> find_unknown(["moves", "0", "distance"]), find_unknown(["requirements", "peaks", "x"])
    (None, None)
    """
    names = tuple(name for name in path if not name.isdigit())
    for depth, name in enumerate(names):
        fields = _fields_at(names[:depth])
        if fields and name not in fields:
            return propose(name, fields)
    return None


def may_be_left_out(path: Sequence[str]) -> bool:
    """Return whether a profile without this key means the same as with its default.

    Examples
    --------
    >>> may_be_left_out(["moves", "0", "dwell"]), may_be_left_out(["drive", "max_force"])
    (True, False)
    """
    *tables, name = (name for name in path if not name.isdigit())
    field = _fields_at(tuple(tables)).get(name)
    return field is not None and not field.is_required()


def _fields_at(names: tuple[str, ...]) -> dict[str, FieldInfo]:
    """The keys of the tables of this name; a plant of either kind."""
    return {
        field.alias or key: field
        for place, table in _TABLES.items()
        if _written(place) == names
        for key, field in table.model_fields.items()
    }


TAGS = {"plant": tuple(PLANT_TABLES), "drive": (SERVO, POSITION_SOURCE)}
"""What tells the kinds of a table apart."""


def _written(loc: KeyPath) -> KeyPath:
    """The path as the file has it: pydantic puts the kind of plant or drive into it."""
    if loc[1:2] and loc[1] in TAGS.get(str(loc[0]), ()):
        return (loc[0], *loc[2:])
    return loc


def _of_other_drive(name: str, loc: KeyPath) -> Message | None:
    """That a key belongs to the other kind of drive; None if neither knows it."""
    for ours, theirs, drive in (
        (("drive", SERVO), ("drive", POSITION_SOURCE), POSITION_SOURCE),
        (("drive", POSITION_SOURCE), ("drive", SERVO), SERVO),
        (("plant", MOTOR_HELD), ("plant", "modal"), SERVO),
        (("plant", MOTOR_HELD, "modes"), ("plant", "modal", "modes"), SERVO),
    ):
        if loc == ours and name in _TABLES[theirs].model_fields:
            return Message("key-of-other-drive", drive=drive)
    return None


def _translate(detail: ErrorDetails, where: str, lines: KeyLines) -> list[Fault]:
    """Return the faults behind one pydantic error."""
    loc: KeyPath = detail["loc"]
    path = _written(loc)
    cause = detail.get("ctx", {}).get("error")
    items = cause.items if isinstance(cause, Faults) else (("", _message(detail, loc)),)
    if detail["type"] in ("union_tag_not_found", "union_tag_invalid"):
        path = (*path, "kind")
    faults = []
    for below, message in items:
        parts = [int(part) if part.isdigit() else part for part in below.split(".") if part]
        key = (*path, *parts)
        faults.append(
            Fault(
                where=where,
                line=lines.line_of(key),
                key=show_key(key),
                message=message,
            )
        )
    return faults


def _message(detail: ErrorDetails, loc: KeyPath) -> Message:
    got = describe(detail["input"])
    context = detail.get("ctx", {})
    table = _TABLES.get(tuple(part for part in loc[:-1] if isinstance(part, str)), ProfileTable)
    fields = {field.alias or name: field for name, field in table.model_fields.items()}
    name = str(loc[-1]) if loc else ""
    match detail["type"]:
        case "extra_forbidden":
            place = tuple(part for part in loc[:-1] if isinstance(part, str))
            other = _of_other_drive(name, place)
            return other or Message("key-unknown", hint=propose(name, fields))
        case "missing":
            return Message("key-missing", remedy=_remedy(name, fields.get(name)))
        case "literal_error":
            return Message("got-other-word", got=got, words=_words(context["expected"]))
        case "union_tag_not_found":
            *first, last = (f'kind = "{kind}"' for kind in KINDS)
            kinds = Message("one-or-other", first=", ".join(first), last=last)
            return Message("key-missing", remedy=Message("add-kind", kinds=kinds))
        case "union_tag_invalid":
            words = one_of(TAGS["drive"] if loc[0] == "drive" else tuple(KINDS))
            return Message("got-other-word", got=f'"{context["tag"]}"', words=words)
        case "bool_type":
            return Message("got-no-boolean", got=got)
        case "model_type" | "model_attributes_type":
            return Message("got-no-table", got=got)
        case "list_type":
            hint = Message("hint-moves-header") if name == "moves" else None
            return Message("got-no-array", got=got, hint=hint)
        case "too_short":
            return Message(
                "array-too-short", length=context["actual_length"], least=context["min_length"]
            )
        case "too_long":
            return Message("array-too-long", most=context["max_length"])
    return Message("value-refused", got=got, reason=detail["msg"])


def _words(expected: str) -> Message | str:
    """The words of a Literal, which pydantic lists as 'a', 'b' or 'c'; a number stands alone."""
    words = re.findall(r"'([^']*)'", expected)
    return one_of(words) if words else expected


def _remedy(name: str, field: FieldInfo | None) -> Message:
    """What to add; the number in it is an example, not the user's."""
    if name == "schema":
        return Message("add-schema")
    if field is not None and field.examples:
        return Message("add-value", key=name, example=str(field.examples[0]))
    return Message("add-table", header="[[moves]]" if name == "moves" else f"[{name}]")
