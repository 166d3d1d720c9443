"""How the fields of a dataclass stand in a profile: key, meaning, range, and what it is printed in.

A description only: the profile's tables are built from it, and the record's list of data.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, Field, dataclass, field, fields
from typing import Any

from mtcommission.machine.ranges import AxisRange
from mtcommission.units.axis_units import AxisUnits


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """One key of a profile."""

    meaning: str  # for the profile's schema and for remedies
    example: str = ""
    allowed: AxisRange | None = None  # None for an identifier, and for an array of tables
    name: str = ""  # as the profile spells it; "" if as the field
    factor: float = 1.0  # value of the field per value of the key, SI
    parts: type[Any] | None = None  # dataclass of an array's elements
    most: int = 0  # largest number of elements


def keyed(
    allowed: AxisRange | None,
    meaning: str,
    example: str,
    *,
    key: str = "",
    factor: float = 1.0,
    default: Any = MISSING,
) -> Any:
    """Return a field that stands in the profile as a quantity, or as an identifier."""
    about = Key(meaning=meaning, example=example, allowed=allowed, name=key, factor=factor)
    return field(default=default, metadata={"key": about})


def keyed_array(parts: type[Any], meaning: str, *, most: int, key: str = "") -> Any:
    """Return a field that stands in the profile as an array of one to ``most`` tables."""
    return field(metadata={"key": Key(meaning=meaning, parts=parts, most=most, name=key)})


def list_keys(kind: type[Any]) -> Iterator[tuple[str, Field[Any], Key]]:
    """Yield key, field and description of a dataclass's fields that have one, in its order."""
    for one in fields(kind):
        about: Key | None = one.metadata.get("key")
        if about is not None:
            yield about.name or one.name, one, about


def list_quantities(data: Any, place: str, axis: AxisUnits) -> Iterator[tuple[str, float, str]]:
    """Yield key, value and SI unit of every quantity, elements of arrays by their names.

    ``place``: where the dataclass stands in the profile, e.g. ``"plant"``.
    """
    for key, one, about in list_keys(type(data)):
        value, here = getattr(data, one.name), f"{place}.{key}"
        if about.parts:
            for part in value:
                yield from list_quantities(part, f"{here}.{part.name}", axis)
        elif about.allowed:
            yield here, value / about.factor, about.allowed.on(axis).dimension.si or "-"
