"""How a field of the machine stands in a profile, and how what stands there is read.

A table of a profile is a frozen dataclass whose fields are made by ``keyed``: each says once what
may stand there, what it means and an example. Reading, faults, JSON schema, questions, the page of
keys and the list of data follow from that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, field, fields
from math import inf
from typing import Any

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits
from mtcommission.machine.readers import (
    Array,
    AxisRange,
    KeyPath,
    Reader,
    Reading,
    Word,
    find_close,
    must_be,
    one_of,
    propose,
    read_path,
)

Misfit = tuple[str, Message]
"""Key of a profile, below the table that it belongs to, and what is wrong with its value."""

REQUIRED: Any = MISSING
"""For ``left_out``: the key must be given, though a program may leave the field out."""

EMPTY: Any = object()
"""For ``left_out``: the table is read as if it stood there without a key."""

_AS_DEFAULT = object()


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """One key of a profile."""

    reader: Reader
    meaning: str  # for the schema and for remedies
    example: str = ""  # without quotes
    key: str = ""  # as the profile spells it; "" if as the field
    factor: float = 1.0  # value of the field per value of the key, SI
    left_out: Any = MISSING  # the field where the key is left out; MISSING: it must be given
    table: str = ""  # table in which it stands, where the field's dataclass is of several

    @property
    def example_toml(self) -> str:
        """The example as it stands in a file."""
        is_bare = re.fullmatch(r"[-+.\d]+|true|false|[\[{].*", self.example)
        return self.example if is_bare or not self.example else f'"{self.example}"'

    @property
    def default(self) -> float | str | bool | None:
        """What the profile means that leaves the key out, in SI or as a word; None: nothing."""
        if isinstance(self.reader, Word):
            words = self.reader.meanings.items()
            return next((word for word, one in words if one == self.left_out), None)
        if isinstance(self.left_out, float):
            return self.left_out / self.factor if self.left_out != inf else None
        return self.left_out if isinstance(self.left_out, bool | str) else None

    @property
    def is_required(self) -> bool:
        """Whether a profile without it is at fault."""
        return self.left_out is MISSING


def keyed(
    reader: Reader,
    meaning: str,
    example: str = "",
    *,
    default: Any = MISSING,
    left_out: Any = _AS_DEFAULT,
    **more: Any,
) -> Any:
    """Return a field that stands in the profile; ``more`` are further fields of its ``Key``.

    ``default`` is that of a machine built in a program; ``left_out`` what a profile means that says
    nothing, where that is something else.
    """
    left_out = default if left_out is _AS_DEFAULT else left_out
    about = Key(reader=reader, meaning=meaning, example=example, left_out=left_out, **more)
    return field(default=default, metadata={"key": about})


def list_keys(kind: type[Any], table: str = "") -> Iterator[tuple[str, Field[Any], Key]]:
    """Yield key, field and description of a dataclass's fields that have one, in its order."""
    for one in fields(kind):
        about: Key | None = one.metadata.get("key")
        if about is not None and about.table == table:
            yield about.key or one.name, one, about


def list_quantities(data: Any, place: str, axis: AxisUnits) -> Iterator[tuple[str, float, str]]:
    """Yield key, value and SI unit of every quantity, elements of arrays by their names.

    ``place``: where the dataclass stands in the profile, e.g. ``"plant"``.
    """
    for key, one, about in list_keys(type(data)):
        value, here, reader = getattr(data, one.name), f"{place}.{key}", about.reader
        if value is None:
            continue
        if isinstance(reader, AxisRange):
            yield here, value / about.factor, reader.on(axis).dimension.si or "-"
        elif isinstance(reader, Table):
            yield from list_quantities(value, here, axis)
        elif isinstance(reader, Array) and isinstance(reader.inner, Table):
            for part in value:
                yield from list_quantities(part, f"{here}.{part.name}", axis)


# Reading a table


ELSEWHERE: dict[type[Any], tuple[type[Any], str]] = {}
"""For a table: the one that stands in its place below the other kind of drive, and that kind."""


def read_table(
    kind: type[Any], value: object, place: KeyPath, reading: Reading, *, beside: Sequence[str] = ()
) -> Any:
    """Return a table of a profile as its dataclass.

    Its ``complete`` gives "left out" a meaning that hangs on other keys; its ``find_faults`` says
    what does not fit together, once every key by itself is right. ``beside``: further keys that
    somebody else reads.
    """
    before = len(reading.faults)
    values = read_values(kind, value, place, reading, beside=beside)
    return (
        build_table(kind, values, value, place, reading) if len(reading.faults) == before else None
    )


def build_table(
    kind: type[Any], values: dict[str, Any], stated: Any, place: KeyPath, reading: Reading
) -> Any:
    """Return the dataclass of values that are right by themselves."""
    if hasattr(kind, "complete"):
        values = kind.complete(values, stated, reading)
    found = kind(**values)
    if hasattr(kind, "find_faults"):
        for below, message in found.find_faults(stated, reading.axis):
            reading.refuse((*place, *read_path(below)), message)
    return found


def read_values(
    kind: type[Any],
    value: object,
    place: KeyPath,
    reading: Reading,
    *,
    table: str = "",
    beside: Sequence[str] = (),
    required: Sequence[str] = (),
) -> dict[str, Any]:
    """Return the values of a table by field; unknown and missing keys are noted.

    ``beside`` and ``required``: further keys that somebody else reads.
    """
    if not isinstance(value, dict):
        reading.refuse(place, must_be(value, Message("a-table")))
        return {}
    keys = {key: (one.name, about) for key, one, about in list_keys(kind, table)}
    needed = (*required, *(key for key, (_, about) in keys.items() if about.is_required))
    missing = [key for key in needed if key not in value]
    known = dict.fromkeys((*required, *beside, *keys))
    for name in value:
        if name in known:
            continue
        meant = find_close(name, missing)
        if meant:
            missing.remove(meant)
            reading.refuse((*place, name), Message("key-misspelt", meant=meant))
        else:
            reading.refuse((*place, name), _unknown(kind, (*place, name), known))
    for key in missing:
        example = keys[key][1].example_toml if key in keys else ""
        reading.refuse((*place, key), Message("key-missing", remedy=_add(key, example)))
    values = {}
    for key, (name, about) in keys.items():
        if key not in value and about.left_out is not EMPTY:
            values[name] = about.left_out
            continue
        found = about.reader.read(value.get(key, {}), (*place, key), reading)
        values[name] = found if about.factor == 1.0 or found is None else about.factor * found
    return values


def _add(key: str, example: str) -> Message:
    """What to add where a key is missing; the number is an example, not the user's."""
    if key == "schema":
        return Message("add-schema")
    if example:
        return Message("add-value", key=key, example=example)
    return Message("add-table", header="[[moves]]" if key == "moves" else f"[{key}]")


def _unknown(kind: type[Any], key: KeyPath, known: Iterable[str]) -> Message:
    *place, name = key
    other, drive = ELSEWHERE.get(kind, (None, ""))
    if other and name in {key for key, _, _ in list_keys(other)}:
        return Message("key-of-other-drive", drive=drive)
    return Message("key-unknown", hint=propose(str(name), known, below=tuple(place)))


def table_schema(
    kind: type[Any],
    tables: dict[str, Any],
    *,
    table: str = "",
    before: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the JSON schema of a table; ``before``: keys that stand before those of the kind."""
    properties, required = dict(before or {}), list(before or {})
    for key, _, about in list_keys(kind, table):
        own = about.reader.schema(tables) | {"description": about.meaning}
        if about.example:
            own["examples"] = [about.example_toml]
        if about.default is not None:
            own["default"] = about.default
        properties[key] = own
        if about.is_required:
            required.append(key)
    return {
        "type": "object",
        "description": (kind.__doc__ or "").partition("\n")[0],
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


@dataclass(frozen=True, slots=True)
class Table:
    """A table, as the dataclass that declares its keys."""

    kind: type[Any]

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return the dataclass."""
        return read_table(self.kind, value, place, reading)

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return a reference to the schema of the table."""
        tables[self.kind.__name__] = table_schema(self.kind, tables)
        return {"$ref": f"#/$defs/{self.kind.__name__}"}


@dataclass(frozen=True, slots=True)
class ByKind:
    """A table whose ``kind`` tells the dataclass that declares its other keys."""

    kinds: Callable[[bool], Mapping[str, type[Any]]]
    """By the word, where the motor follows its setpoint and where it does not."""
    meaning: str  # of ``kind``
    usual: str = ""  # where no kind is stated; "": it must be

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return the dataclass; a wrong kind does not hide what else is wrong."""
        kinds, key = self.kinds(reading.follows), (*place, "kind")
        table = value if isinstance(value, dict) else {}
        likely = find_kind(table, kinds, usual=self.usual)
        if value is table and "kind" not in table and not self.usual:
            remedy = Message("add-kind-of-keys", kind=likely)
            reading.refuse(key, Message("key-missing", remedy=remedy))
        elif "kind" in table and table["kind"] not in tuple(kinds):
            hint = Message("hint-did-you-mean", name=likely)
            reading.refuse(key, must_be(table["kind"], one_of(tuple(kinds)), hint))
        return read_table(kinds[likely], value, place, reading, beside=("kind",))

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: a table of any kind."""
        forms = {kind: word for held in (False, True) for word, kind in self.kinds(held).items()}
        for kind, word in forms.items():
            own = {"description": self.meaning, "const": word}
            tables[kind.__name__] = table_schema(kind, tables, before={"kind": own})
            if word == self.usual:
                tables[kind.__name__]["required"].remove("kind")
        return {"anyOf": [{"$ref": f"#/$defs/{kind.__name__}"} for kind in forms]}


def find_kind(table: Mapping[str, Any], kinds: Mapping[str, type[Any]], *, usual: str = "") -> str:
    """Return the kind that a table names, or the likeliest: else nothing could be read."""
    name = table.get("kind", usual)
    if isinstance(name, str) and name in kinds:
        return name
    shared = {
        word: sum(key in table for key, *_ in list_keys(kind)) for word, kind in kinds.items()
    }
    near = find_close(name, kinds) if isinstance(name, str) else ""
    return near or max(shared, key=lambda word: shared[word])
