"""Entries of the record <-> JSON, by cattrs; every place of another form is found at once.

JSON is read strictly: a text is no number, and an array is no object. JSON knows no infinity:
a number that is not finite is written as null, which is read as nan in an array of numbers (a gap
in a curve) and refused elsewhere, unless the entry may be null.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from math import isfinite, nan
from types import NoneType
from typing import Any, TypeVar, get_origin

import numpy as np
from cattrs import ClassValidationError, Converter, IterableValidationError
from cattrs.cols import list_structure_factory, mapping_structure_factory
from cattrs.gen import make_dict_structure_fn

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message, from_json, to_json

Entry = TypeVar("Entry")

LARGEST = 1e100
"""Magnitude of a number; what is beyond overflows when it is squared."""

SHOWN = 40
"""Characters of a wrong value that a message shows."""


class WrongFormError(ValueError):
    """A value of JSON is of another form than the entry's.

    Parameters
    ----------
    got
        The value, as a text or as what it is.
    expected
        Key of the form's name in the catalogue.
    """

    def __init__(self, got: Message | str, expected: str) -> None:
        super().__init__(got, expected)
        self.message = Message("record-got", got=got, expected=Message(expected))


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

    Parameters
    ----------
    value
        As ``json`` reads it.
    form
        A class of the schema, or what one is made of.

    Raises
    ------
    WrongFormError, BaseValidationError
        It is of another form; ``find_faults`` tells where.
    """
    return _CONVERTER.structure(value, form)


def find_faults(error: Exception, *, key: str = "") -> Iterator[Message]:
    """Yield each place that was of another form, with what was got.

    Parameters
    ----------
    error
        From ``to_entry``.
    key
        Where the value stands that was read.

    Yields
    ------
    Message

    Examples
    --------
    >>> from cattrs import BaseValidationError
    >>> from mtcommission.messages.catalogue import Catalogue
    >>> try:
    ...     to_entry({"a": [1.0, "x"]}, dict[str, list[float]])
    ... except BaseValidationError as error:
    ...     [Catalogue().say(fault) for fault in find_faults(error)]
    ["a[2]: got 'x', expected a number"]
    """
    if isinstance(error, ClassValidationError):
        for inner, place in error.group_exceptions()[0]:
            yield from find_faults(inner, key=f"{key}.{place.name}" if key else place.name)
    elif isinstance(error, IterableValidationError):
        for inner, note in error.group_exceptions()[0]:
            index = note.index
            below = f"{key}[{index + 1}]" if isinstance(index, int) else f"{key}.{index}"
            yield from find_faults(inner, key=below.removeprefix("."))
    else:
        yield Message("record-wrong-at", key=key or "record", fault=_fault(error))


def entry_of(form: type[Entry], /, *sources: object, **given: object) -> Entry:
    """Return an entry whose values are the attributes of the same names of some results.

    Parameters
    ----------
    form
        A class of the schema.
    *sources
        Results; the first that has an attribute gives it.
    **given
        What has another name or form there.

    Returns
    -------
    Entry
        Arrays and tuples as lists; None for numbers that are not finite.

    Examples
    --------
    >>> from mtcommission.record.schema.moves import Segment
    >>> entry_of(Segment, Segment(duration=0.1, jerk=2.0), jerk=float("inf"))
    Segment(duration=0.1, jerk=None)
    """
    values = {}
    for field in fields(form):  # type: ignore[arg-type]
        name = field.name
        if name in given:
            value = given[name]
        else:
            owner = next((source for source in sources if hasattr(source, name)), sources[-1])
            value = getattr(owner, name)
        values[name] = _held(value)
    return form(**values)


def finite_or_none(value: float) -> float | None:
    """Return the number, or None for an infinite one or a nan."""
    return float(value) if isfinite(value) else None


def _held(value: object) -> object:
    """A value of a result as an entry holds it."""
    if isinstance(value, float):
        return finite_or_none(value)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return [_held(item) for item in value] if isinstance(value, tuple | list) else value


def _fault(error: Exception) -> Message:
    if isinstance(error, WrongFormError):
        return error.message
    return Message("record-missing" if isinstance(error, KeyError) else "record-of-no-known-form")


def _wrong(value: object, expected: str) -> WrongFormError:
    if isinstance(value, dict | list):
        form = "json-object" if isinstance(value, dict) else "json-array"
        return WrongFormError(Message(form), expected)
    shown = "null" if value is None else repr(value)
    return WrongFormError(shown if len(shown) <= SHOWN else f"{shown[:SHOWN]}...", expected)


def _plain(form: type, expected: str) -> Callable[[object, Any], object]:
    def read(value: object, _: Any) -> object:
        if type(value) is not form:
            raise _wrong(value, expected)
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
        raise _wrong(value, "json-message") from error
    raise _wrong(value, "json-message")


def _message_or_text(value: object, form: Any) -> Message | str:
    return value if isinstance(value, str) else _message(value, form)


@cache
def _english() -> Catalogue:
    return Catalogue()


def _number_or_gap(value: object, form: Any) -> float:
    return nan if value is None else _number(value, form)


def _number(value: object, _: Any) -> float:
    if not isinstance(value, float | int) or isinstance(value, bool) or abs(value) > LARGEST:
        raise _wrong(value, "json-number")
    return value


def _number_or_null(value: object, form: Any) -> float | None:
    if type(value) not in (float, int, NoneType):
        raise _wrong(value, "json-number-or-null")
    return None if value is None else _number(value, form)


def _number_or_text(value: object, form: Any) -> float | str:
    if isinstance(value, str):
        return value
    if type(value) not in (float, int):
        raise _wrong(value, "json-number-or-text")
    return _number(value, form)


def _strictly(
    form: type, expected: str, make: Callable[[Any, Converter], Callable[..., Any]]
) -> Callable[[Any, Converter], Callable[..., Any]]:
    """Hooks that first see whether the value is of this form of JSON at all."""

    def factory(entry: Any, converter: Converter) -> Callable[..., Any]:
        inner = make(entry, converter)

        def read(value: object, _: Any) -> Any:
            if not isinstance(value, form):
                raise _wrong(value, expected)
            return inner(value, entry)

        return read

    return factory


def _is_a(form: type) -> Callable[[Any], bool]:
    return lambda entry: get_origin(entry) is form


def _converter() -> Converter:
    gaps = Converter()
    gaps.register_structure_hook(float, _number_or_gap)
    gaps.register_structure_hook_factory(
        _is_a(list), _strictly(list, "json-array", list_structure_factory)
    )
    made = Converter()
    made.register_unstructure_hook(float, lambda value: value if isfinite(value) else None)
    made.register_unstructure_hook(Message, to_json)
    made.register_structure_hook(Message, _message)
    made.register_structure_hook(Message | str, _message_or_text)
    made.register_structure_hook(float, _number)
    made.register_structure_hook(float | None, _number_or_null)
    made.register_structure_hook(float | str, _number_or_text)
    for form, expected in (
        (int, "json-whole-number"),
        (str, "json-text"),
        (bool, "json-boolean"),
    ):
        made.register_structure_hook(form, _plain(form, expected))
    made.register_structure_hook_factory(
        is_dataclass, _strictly(dict, "json-object", make_dict_structure_fn)
    )
    made.register_structure_hook_factory(
        _is_a(dict), _strictly(dict, "json-object", mapping_structure_factory)
    )
    made.register_structure_hook_factory(
        _is_a(list), _strictly(list, "json-array", list_structure_factory)
    )
    made.register_structure_hook_func(lambda form: form == list[float], gaps.structure)
    return made


_CONVERTER = _converter()
