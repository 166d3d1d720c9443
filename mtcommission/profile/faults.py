"""Validation errors of pydantic -> faults in our words, with file, line and remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from mtcommission.errors import Fault
from mtcommission.messages.message import Message
from mtcommission.profile.lines import KeyLines, KeyPath, show_key
from mtcommission.profile.model import (
    ControlTable,
    DampingOptimalTable,
    DriveTable,
    ForceFilterTable,
    MachineTable,
    ModeBands,
    MoveTable,
    ProfileTable,
    RequirementsTable,
    SetpointFilterTable,
)
from mtcommission.profile.plant_tables import PLANT_TABLES, element_tables
from mtcommission.profile.table import Table
from mtcommission.profile.values import Faults, describe, find_close, propose

_TABLES: Mapping[tuple[str, ...], type[Table]] = {
    (): ProfileTable,
    ("machine",): MachineTable,
    **{("plant", kind): table for kind, table in PLANT_TABLES.items()},
    **{
        ("plant", kind, key): element
        for kind, table in PLANT_TABLES.items()
        for key, element in element_tables(table).items()
    },
    ("drive",): DriveTable,
    ("moves",): MoveTable,
    ("requirements",): RequirementsTable,
    ("requirements", "modes"): ModeBands,
    ("damping_optimal",): DampingOptimalTable,
    ("control",): ControlTable,
    ("control", "setpoint_filter"): SetpointFilterTable,
    ("control", "force_filters"): ForceFilterTable,
}

MISSING = "missing; "


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
            message = f'unknown key; did you mean "{close}", which is missing?'
            found = [replace(fault, message=Message("verbatim", text=message)) for fault in found]
        faults += found
    gone = {show_key(_written(path)) for path in meant}
    kept = [
        f
        for f in faults
        if not (f.key in gone and str(f.message.values["text"]).startswith(MISSING))
    ]
    return sorted(kept, key=lambda fault: fault.line)


def find_unknown(path: Sequence[str]) -> str:
    """Return a proposal for the part of a key that no profile knows; "" if all are known.

    Parameters
    ----------
    path
        Names of tables and key; numbers of elements count as nothing.

    Returns
    -------
    str
        As ``propose`` words it. Names below a table of signals are free.

    Examples
    --------
    >>> find_unknown(["drive", "force_lg"])
    '; did you mean "force_lag"?'
    >>> find_unknown(["moves", "0", "distance"]), find_unknown(["requirements", "peaks", "x"])
    ('', '')
    """
    names = tuple(name for name in path if not name.isdigit())
    for depth, name in enumerate(names):
        fields = _fields_at(names[:depth])
        if fields and name not in fields:
            return propose(name, fields)
    return ""


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


def _written(loc: KeyPath) -> KeyPath:
    """The path as the file has it: pydantic puts the plant's kind into it."""
    if loc[:1] == ("plant",) and loc[1:2] and loc[1] in PLANT_TABLES:
        return (loc[0], *loc[2:])
    return loc


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
                message=message
                if isinstance(message, Message)
                else Message("verbatim", text=message),
            )
        )
    return faults


def _message(detail: ErrorDetails, loc: KeyPath) -> str:
    got = describe(detail["input"])
    context = detail.get("ctx", {})
    table = _TABLES.get(tuple(part for part in loc[:-1] if isinstance(part, str)), ProfileTable)
    fields = {field.alias or name: field for name, field in table.model_fields.items()}
    name = str(loc[-1]) if loc else ""
    match detail["type"]:
        case "extra_forbidden":
            return f"unknown key{propose(name, fields)}"
        case "missing":
            return f"{MISSING}{_remedy(name, fields[name].examples if name in fields else None)}"
        case "literal_error":
            return f"got {got}, must be {context['expected'].replace(chr(39), chr(34))}"
        case "union_tag_not_found":
            return MISSING + "add " + " or ".join(f'kind = "{kind}"' for kind in PLANT_TABLES)
        case "union_tag_invalid":
            return f'got "{context["tag"]}", must be {quote_kinds()}'
        case "bool_type":
            return f"got {got}, must be true or false"
        case "model_type" | "model_attributes_type":
            return f"got {got}, must be a table"
        case "list_type":
            hint = "; write the header as [[moves]]" if name == "moves" else ""
            return f"got {got}, must be an array{hint}"
        case "too_short":
            return (
                f"got {context['actual_length']} elements, at least {context['min_length']} needed"
            )
        case "too_long":
            return f"got too many elements, at most {context['max_length']} allowed"
    return f"got {got}: {detail['msg']}"


def quote_kinds() -> str:
    """Return the kinds of plant in quotes, for messages."""
    return " or ".join(f'"{kind}"' for kind in PLANT_TABLES)


def _remedy(name: str, examples: Sequence[object] | None) -> str:
    """What to add; the number in it is an example, not the user's."""
    if name == "schema":
        return "add schema = 1"
    if examples:
        return f"add the value of your machine, for example {name} = {examples[0]}"
    header = "[[moves]]" if name == "moves" else f"[{name}]"
    return f"add a table {header}"
