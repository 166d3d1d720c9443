"""Entries of the record <-> JSON, by cattrs; every place of another form is found at once.

JSON is read strictly: a text is no number, and an array is no object. JSON knows no infinity:
a number that is not finite is written as null, which is read as nan in an array of numbers (a gap
in a curve) and refused elsewhere, unless the entry may be null.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, Field, field, fields, is_dataclass
from enum import Enum
from functools import cache
from math import isfinite, nan
from operator import attrgetter
from types import NoneType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from cattrs import (
    BaseValidationError,
    ClassValidationError,
    Converter,
    IterableValidationError,
    IterableValidationNote,
)
from cattrs.cols import list_structure_factory, mapping_structure_factory
from cattrs.gen import make_dict_structure_fn

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message, from_json, to_json

Entry = TypeVar("Entry")

SHOWN = 40
"""Characters of a wrong value that a message shows."""


class WrongFormError(ValueError):
    """A value of JSON is of another form than the entry's, which JSON calls ``expected``."""

    def __init__(self, value: object, expected: str) -> None:
        got = "null" if value is None else repr(value)
        if len(got) > SHOWN:
            got = f"{got[:SHOWN]}..."
        super().__init__(got, expected)
        self.message = Message("record-got", got=got, expected=expected)


WRONG = (WrongFormError, BaseValidationError)
"""What ``to_entry`` raises."""


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

    Raises
    ------
    one of WRONG
        It is of another form; ``find_faults`` tells where.
    """
    return _CONVERTER.structure(value, form)


def find_faults(error: Exception, *, key: str = "") -> Iterator[Message]:
    """Yield each place that ``to_entry`` found of another form, with what was got.

    Examples
    --------
    >>> from mtcommission.messages.catalogue import Catalogue
    >>> try:
    ...     to_entry({"a": [1.0, "x"]}, dict[str, list[float]])
    ... except WRONG as error:
    ...     [Catalogue().say(fault) for fault in find_faults(error)]
    ["a[2]: got 'x', expected number"]
    """
    if isinstance(error, ClassValidationError | IterableValidationError):
        for inner, note in error.group_exceptions()[0]:
            place = note.index if isinstance(note, IterableValidationNote) else note.name
            below = f"{key}[{place + 1}]" if isinstance(place, int) else f"{key}.{place}"
            yield from find_faults(inner, key=below.removeprefix("."))
    elif isinstance(error, WrongFormError):
        yield Message("record-wrong-at", key=key or "record", fault=error.message)
    else:
        kind = "record-missing" if isinstance(error, KeyError) else "record-of-no-known-form"
        yield Message("record-wrong-at", key=key or "record", fault=Message(kind))


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


def _scalar(expected: str, *forms: type) -> Callable[[object, Any], object]:
    def read(value: object, _: Any) -> object:
        if type(value) not in forms:
            raise WrongFormError(value, expected)
        return value

    return read


def _message(value: object, _: Any) -> Message:
    """A message that can be said: of a known kind, with all that its text speaks of."""
    try:
        found = from_json(value)
        if isinstance(found, Message):
            _english().say(found)
            return found
    except (KeyError, ValueError, RecursionError) as error:
        raise WrongFormError(value, "message") from error
    raise WrongFormError(value, "message")


def _message_or_text(value: object, form: Any) -> Message | str:
    return value if isinstance(value, str) else _message(value, form)


@cache
def _english() -> Catalogue:
    return Catalogue()


def _word(value: object, form: type[Enum]) -> Enum:
    try:
        return form(value)
    except ValueError as error:
        words = " | ".join(str(word.value) for word in form)
        raise WrongFormError(value, words) from error


def _strictly(
    form: type, expected: str, make: Callable[[Any, Converter], Callable[..., Any]]
) -> Callable[[Any, Converter], Callable[..., Any]]:
    """Hooks that first see whether the value is of this form of JSON at all."""

    def factory(entry: Any, converter: Converter) -> Callable[..., Any]:
        inner = make(entry, converter)

        def read(value: object, _: Any) -> Any:
            if not isinstance(value, form):
                raise WrongFormError(value, expected)
            return inner(value, entry)

        return read

    return factory


def _is_a(form: type) -> Callable[[Any], bool]:
    return lambda entry: get_origin(entry) is form


def _converter() -> Converter:
    number = _scalar("number", float, int)
    array = _strictly(list, "array", list_structure_factory)
    gaps = Converter()
    gaps.register_structure_hook(float, lambda v, form: nan if v is None else number(v, form))
    gaps.register_structure_hook_factory(_is_a(list), array)
    made = Converter()
    made.register_unstructure_hook(float, lambda value: value if isfinite(value) else None)
    made.register_unstructure_hook(Message, to_json)
    for form, read in (
        (Message, _message),
        (Message | str, _message_or_text),
        (float, number),
        (float | None, _scalar("number | null", float, int, NoneType)),
        (float | str, _scalar("number | string", float, int, str)),
        (int, _scalar("whole number", int)),
        (str, _scalar("string", str)),
        (bool, _scalar("true | false", bool)),
    ):
        made.register_structure_hook(form, read)
    made.register_structure_hook_func(
        lambda form: isinstance(form, type) and issubclass(form, Enum), _word
    )
    for predicate, factory in (
        (is_dataclass, _strictly(dict, "object", make_dict_structure_fn)),
        (_is_a(dict), _strictly(dict, "object", mapping_structure_factory)),
        (_is_a(list), array),
    ):
        made.register_structure_hook_factory(predicate, factory)
    made.register_structure_hook_func(lambda form: form == list[float], gaps.structure)
    return made


_CONVERTER = _converter()
