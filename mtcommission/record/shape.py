"""Entries of the record <-> JSON, by cattrs.

JSON knows no infinity: a number that is not finite is written as null, which is read as nan in an
array of numbers (a gap in a curve) and refused elsewhere, unless the entry may be null.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, field, fields, is_dataclass
from enum import Enum
from functools import cache
from math import isfinite, nan
from operator import attrgetter
from types import NoneType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from cattrs import BaseValidationError, Converter

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, from_json, to_json

Entry = TypeVar("Entry")


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


def of(
    path: str | Callable[[Any], object],
    *,
    by: Callable[[Any], object] | None = None,
    default: object = MISSING,
) -> Any:
    """Return the field of an entry that is found elsewhere in the result than at its own name.

    ``path``: attributes with dots between them, or a function of the result; ``by``: what is made
    of the value; ``default``: what a record means that does not have it.
    """
    return field(default=default, metadata={"of": path, "by": by})


def entry_of(form: type[Entry], /, *sources: object, **given: object) -> Entry:
    """Return an entry whose values are the attributes of the same names of some results.

    The first source that has the attribute gives it (``is_used`` gives ``used``; ``of`` names
    another); ``given`` has another form there. Arrays and tuples become lists, results within them
    entries, numbers that are not finite None, and what has a word or a key (a requirement) that.

    Examples
    --------
    >>> from mtcommission.record.moves import Segment
    >>> entry_of(Segment, Segment(duration=0.1, jerk=2.0), jerk=float("inf"))
    Segment(duration=0.1, jerk=None)
    """
    hints = _hints(form)  # type: ignore[arg-type]
    return form(
        **{
            one.name: _held(
                given[one.name] if one.name in given else _find(one, sources), hints[one.name]
            )
            for one in fields(form)  # type: ignore[arg-type]
        }
    )


def finite_or_none(value: float) -> float | None:
    """Return the number, or None for an infinite one or a nan."""
    return float(value) if isfinite(value) else None


def _find(one: Field[Any], sources: tuple[object, ...]) -> object:
    path, by = (one.metadata.get(key) for key in ("of", "by"))
    if callable(path):
        return path(sources[0])
    for source in sources:
        for attribute in filter(None, (path, one.name, f"is_{one.name}")):
            try:
                value = attrgetter(attribute)(source)
            except AttributeError:
                continue
            return by(value) if by else value
    raise AttributeError(f"{one.name} of {', '.join(type(source).__name__ for source in sources)}")


def _held(value: Any, hint: Any) -> object:
    """A value of a result as an entry holds it."""
    form = _without_none(hint)
    if isinstance(value, float):
        return finite_or_none(value)
    if form is str and not isinstance(value, str):
        return value.value if isinstance(value, Enum) else value.key
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, tuple | list):
        inner = get_args(form)[0] if get_origin(form) is list else form
        return [_held(item, inner) for item in value]
    if isinstance(form, type) and is_dataclass(form) and value is not None:
        return value if isinstance(value, form) else entry_of(form, value)
    return value


@cache
def _hints(form: Any) -> Mapping[str, Any]:
    """The type of each field."""
    hints = get_type_hints(form)
    return {field.name: hints[field.name] for field in fields(form)}


def _without_none(hint: Any) -> Any:
    parts = [part for part in get_args(hint) if part is not NoneType]
    return parts[0] if len(parts) == 1 < len(get_args(hint)) else hint


def _message(value: object, _: Any) -> Message:
    """A message that can be said: of a known kind, with all that its text speaks of."""
    found = from_json(value)
    if not isinstance(found, Message):
        raise WrongFormError(value)
    _english().say(found)
    return found


@cache
def _english() -> Catalogue:
    return Catalogue()


def _converter() -> Converter:
    made = Converter()
    made.register_unstructure_hook(float, lambda value: value if isfinite(value) else None)
    made.register_unstructure_hook(Message, to_json)
    made.register_structure_hook(Message, _message)
    made.register_structure_hook(
        Message | str, lambda value, _: value if isinstance(value, str) else _message(value, _)
    )
    made.register_structure_hook(float | str, lambda value, _: value)
    made.register_structure_hook_func(
        lambda form: form == list[float],
        lambda values, _: [nan if value is None else float(value) for value in values],
    )
    return made


_CONVERTER = _converter()
