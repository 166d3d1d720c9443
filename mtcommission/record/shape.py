"""Results <-> entries of a record <-> JSON, in files that are sealed by a checksum.

JSON knows no infinity: a number that is not finite is written as null, which is read as nan in an
array of numbers (a gap in a curve) and refused elsewhere, unless the entry may be null.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, asdict, field, fields, is_dataclass
from enum import Enum
from functools import cache
from hashlib import sha256
from math import isfinite, nan
from operator import attrgetter
from pathlib import Path
from typing import Any, NoReturn, TypeAlias, TypeVar, get_type_hints

from cattrs import BaseValidationError, Converter
from cattrs.gen import make_dict_structure_fn

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.files import read_bytes
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, from_json, to_json
from mtcommission.controls.kind import FIR
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter

Entry = TypeVar("Entry")

Words: TypeAlias = Message | str
"""What the catalogue says, or the user's own words."""

Matrix: TypeAlias = list[list[float]]

LARGEST_FILE = 50_000_000
"""Bytes; a record of many moves has a few million."""


class WrongFormError(ValueError):
    """JSON is of another form than the entry's."""


def to_plain(entry: object) -> Any:
    """Return what ``json`` writes: objects, arrays, texts and finite numbers.

    Examples
    --------
    >>> to_plain({"a": [1.5, float("inf")]})
    {'a': [1.5, None]}
    """
    return _CONVERTER.unstructure(entry)


def to_entry(value: object, form: type[Entry]) -> Entry:
    """Return an entry from the JSON that ``to_plain`` made of one.

    Checksums tell that nobody edited it; a text of digits is taken for a number here.

    Raises
    ------
    WrongFormError
        It is of another form.

    Examples
    --------
    >>> to_entry({"a": [1.0, None]}, dict[str, list[float]])
    {'a': [1.0, nan]}
    >>> to_entry({"a": 1.0}, dict[str, list[float]])
    Traceback (most recent call last):
    ...
    mtcommission.record.shape.WrongFormError: ...
    """
    try:
        return _CONVERTER.structure(value, form)
    except (BaseValidationError, TypeError, ValueError) as error:
        raise WrongFormError(str(error)) from error


def of(path: str | Callable[[Any], object], *, default: object = MISSING) -> Any:
    """Return the field of an entry that is found elsewhere in the result than at its own name.

    ``path``: attributes with dots between them, or a function of the result; ``default``: what a
    record means that does not have it.
    """
    return field(default=default, metadata={"of": path})


def entry_of(form: type[Entry], /, *sources: object, **given: object) -> Entry:
    """Return an entry whose values are the attributes of the same names of some results.

    The first source that has the attribute gives it (``is_used`` gives ``used``; ``of`` names
    another); ``given`` has another form there. Arrays and tuples become lists, results within them
    entries, numbers that are not finite None, and what has a word or a key (a requirement) that.

    Examples
    --------
    >>> from mtcommission.record.moves import Segment
    >>> entry_of(Segment, Segment(duration=0.1, jerk=2.0), jerk=3)
    Segment(duration=0.1, jerk=3.0)
    """
    found = {}
    for one, hint in _fields(form):  # type: ignore[arg-type]
        value = given[one.name] if one.name in given else _find(one, sources)
        if value is not MISSING:
            found[one.name] = _CONVERTER.structure(value, hint)
    return form(**found)


def finite_or_none(value: float) -> float | None:
    """Return the number, or None for an infinite one or a nan."""
    return float(value) if isfinite(value) else None


def dump_json(value: object) -> str:
    """Return JSON text without infinities (they are null), ready to be written."""
    return json.dumps(to_plain(value), allow_nan=False, ensure_ascii=False, indent=1) + "\n"


def find_checksum(record: Mapping[str, object]) -> str:
    """Return the SHA-256 of everything in a record but its checksum, in hexadecimal digits.

    Whoever exports a record or prints it again must know that nobody edited it since the run.

    Examples
    --------
    >>> find_checksum({"a": 1, "b": 2}) == find_checksum({"b": 2, "checksum": "", "a": 1})
    True
    """
    rest = {key: value for key, value in record.items() if key != "checksum"}
    return sha256(json.dumps(rest, sort_keys=True, allow_nan=False).encode()).hexdigest()


def load_json(path: Path) -> Any:
    """Return what a file of JSON holds; JSON's own numbers alone.

    Raises
    ------
    InputError
        If it is too large or no JSON.
    """
    most = LARGEST_FILE
    content = read_bytes(path, folder=Message("record-is-directory"), most=most + 1)
    if len(content) > most:
        raise fault(path, Message("file-too-large", most=most))
    try:
        return json.loads(
            content.decode("utf-8-sig"), parse_constant=_refuse, parse_float=_read_float
        )
    except _NoNumberError as error:
        why = Message("json-no-number", constant=str(error))
        raise fault(path, Message("record-not-readable", why=why)) from error
    except (ValueError, RecursionError) as error:
        raise fault(path, Message("record-not-json")) from error


def names_group(path: Path) -> bool:
    """Return whether a file is the record of a group, not of one axis."""
    data = load_json(path)
    return isinstance(data, dict) and {"axes", "path"} <= data.keys()


def fault(path: Path, message: Message, key: str = "") -> InputError:
    """Return the error that something is wrong in a file."""
    return InputError([Fault(where=str(path), key=key, message=message)])


class _NoNumberError(ValueError):
    """What Python writes for a number that JSON does not know."""


def _read_float(text: str) -> float:
    value = float(text)
    return value if isfinite(value) else _refuse(text)


def _refuse(constant: str) -> NoReturn:
    raise _NoNumberError(constant)


@cache
def _fields(form: Any) -> tuple[tuple[Field[Any], Any], ...]:
    hints = get_type_hints(form)
    return tuple((one, hints[one.name]) for one in fields(form))


def _find(one: Field[Any], sources: tuple[object, ...]) -> object:
    """The value of a field; ``MISSING`` where no source has it and the entry may do without."""
    path = one.metadata.get("of")
    if callable(path):
        return path(sources[0])
    for source in sources:
        for attribute in filter(None, (path, one.name, f"is_{one.name}")):
            try:
                return attrgetter(attribute)(source)
            except AttributeError:
                continue
    if one.default is MISSING and one.default_factory is MISSING:
        names = ", ".join(type(source).__name__ for source in sources)
        raise AttributeError(f"{one.name} of {names}")
    return MISSING


def _message(value: object, _: Any) -> Message:
    """A message that can be said: of a known kind, with all that its text speaks of."""
    if isinstance(value, Message):
        return value
    found = from_json(value)
    if not isinstance(found, Message):
        raise WrongFormError(value)
    _english().say(found)
    return found


@cache
def _english() -> Catalogue:
    return Catalogue()


def _write_filter(item: SetpointFilter) -> dict[str, Any]:
    """A setpoint filter with the copies that it sends, in place of taps."""
    plain = asdict(item)
    del plain["taps"], plain["spacing"]
    delays, shares = map(list, item.impulses)
    return plain | {"delays": delays, "shares": shares, "duration": item.duration}


def _read_filter(value: Any, _: Any) -> SetpointFilter:
    if isinstance(value, SetpointFilter):
        return value
    delays, shares = (_CONVERTER.structure(value[key], list[float]) for key in ("delays", "shares"))
    plain = {key: one for key, one in value.items() if key not in ("delays", "shares", "duration")}
    if value["kind"] == FIR:
        plain |= {"taps": tuple(shares), "spacing": delays[1]}
    return SetpointFilter(**plain)


def _write_move(move: Move) -> dict[str, float]:
    """A move with the profile's keys; limits that were not set are left out."""
    return {key: value for key, value in asdict(move).items() if value and isfinite(value)}


def _read_move(value: Any, _: Any) -> Move:
    if isinstance(value, Move):
        return value
    stated = _CONVERTER.structure(value, dict[str, float])
    return VelocityStep(**stated) if "velocity_step" in stated else Positioning(**stated)


def _converter() -> Converter:
    made = Converter()
    made.register_unstructure_hook(float, lambda value: value if isfinite(value) else None)
    made.register_unstructure_hook(Message, to_json)
    made.register_unstructure_hook(SetpointFilter, _write_filter)
    made.register_unstructure_hook(VelocityStep, _write_move)
    made.register_unstructure_hook(Positioning, _write_move)

    def reader(form: Any) -> Callable[[Any, Any], Any]:
        """From JSON, or from a result."""
        from_plain = make_dict_structure_fn(form, made)

        def read(value: Any, _: Any) -> Any:
            if isinstance(value, Mapping):
                return from_plain(value, form)
            return value if isinstance(value, form) else entry_of(form, value)

        return read

    made.register_structure_hook_factory(is_dataclass, reader)
    made.register_structure_hook(SetpointFilter, _read_filter)
    made.register_structure_hook(Move, _read_move)
    made.register_structure_hook(Message, _message)
    made.register_structure_hook(
        Words, lambda value, _: value if isinstance(value, str) else _message(value, _)
    )
    made.register_structure_hook(float | str, lambda value, _: value)
    made.register_structure_hook(
        float | None, lambda value, _: None if value is None else finite_or_none(float(value))
    )
    made.register_structure_hook(
        str, lambda value, _: value if isinstance(value, str) else _word(value)
    )
    made.register_structure_hook_func(
        lambda form: form == list[float],
        lambda values, _: [nan if value is None else float(value) for value in values],
    )
    return made


def _word(value: Any) -> str:
    return str(value.value if isinstance(value, Enum) else value.key)


_CONVERTER = _converter()
