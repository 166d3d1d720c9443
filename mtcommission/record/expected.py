"""Where the JSON of a record is of another form than the schema's."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints, is_typeddict

NAMES = {str: "a text", int: "a whole number", float: "a number", bool: "true or false"}


def find_unexpected(value: object, expected: Any, *, key: str = "") -> Iterator[str]:
    """Yield where a JSON value is of another form than expected, with what was got.

    Parameters
    ----------
    value
        As ``json`` reads it.
    expected
        A TypedDict of the schema, or what one is made of.
    key
        Where the value stands.

    Yields
    ------
    str

    Examples
    --------
    >>> list(find_unexpected({"a": [1.0, "x"]}, dict[str, list[float]]))
    ["a[2]: got 'x', expected a number"]
    """
    forms = get_args(expected) if get_origin(expected) in (Union, UnionType) else (expected,)
    form = next((one for one in forms if _fits(value, one)), None)
    if form is None:
        wanted = " or ".join(map(_name, forms))
        yield f"{key or 'record'}: got {_show(value)}, expected {wanted}"
    elif isinstance(value, dict):
        known = _hints(form) if is_typeddict(form) else {}
        required = form.__required_keys__ if known else frozenset()
        yield from (f"{_below(key, name)}: missing" for name in sorted(required - value.keys()))
        inner = get_args(form)[1] if get_args(form) else Any
        for name, item in value.items():
            yield from find_unexpected(item, known.get(name, inner), key=_below(key, name))
    elif isinstance(value, list) and get_args(form) and not _is_series(value):
        for number, item in enumerate(value, start=1):
            yield from find_unexpected(item, get_args(form)[0], key=f"{key}[{number}]")


@cache
def _hints(form: Any) -> dict[str, Any]:
    return get_type_hints(form)


def _is_series(value: list[Any]) -> bool:
    """Whether it is a list of numbers, of which a record has a hundred thousand."""
    return all(type(item) is float for item in value)


def _fits(value: object, form: Any) -> bool:
    origin = get_origin(form) or form
    if origin is Any:
        return True
    if origin is Literal:
        return value in get_args(form)
    if is_typeddict(origin):
        return isinstance(value, dict)
    if origin is float:  # infinities are null
        return value is None or (isinstance(value, int | float) and not isinstance(value, bool))
    if origin is int:
        return isinstance(value, int) and not isinstance(value, bool)
    return isinstance(value, origin)


def _name(form: Any) -> str:
    origin = get_origin(form) or form
    if origin is Literal:
        return " or ".join(map(repr, get_args(form)))
    if origin is NoneType:
        return "null"
    if origin is list:
        return "an array"
    return NAMES.get(origin, "an object")


def _show(value: object) -> str:
    if value is None:
        return "null"
    if isinstance(value, dict | list):
        return "an object" if isinstance(value, dict) else "an array"
    return repr(value) if len(repr(value)) <= 40 else f"{repr(value)[:40]}..."


def _below(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
