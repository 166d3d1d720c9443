"""Texts of options -> quantities and words, each with a fault where it is none."""

from __future__ import annotations

from collections.abc import Sequence

from mtcommission.errors import Fault, InputError, Refused
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.units.quantities import (
    Dimension,
    parse_quantity,
)


def read_within(
    where: str, text: str, unit: Dimension, ends: tuple[float, float], faults: list[Fault]
) -> float:
    """Return a quantity between two ends; 0 for "", or after noting a fault."""
    value = _read(where, text, unit, faults) if text else 0.0
    if text and value is not None and not ends[0] <= value <= ends[1]:
        message = Message("option-between", got=text.strip(), least=ends[0], most=ends[1])
        faults.append(Fault(where=where, message=message))
        return 0.0
    return value or 0.0


def _read(where: str, text: str, unit: Dimension, faults: list[Fault]) -> float | None:
    try:
        return parse_quantity(text, unit)
    except Refused as error:
        faults.append(Fault(where=where, message=error.message))
        return None


def read_positive(where: str, text: str, dimension: Dimension, faults: list[Fault]) -> float:
    """Return a positive quantity, or 1 after noting a fault.

    Parameters
    ----------
    where
        Option, for messages.
    text
        SI number, or number and unit.
    dimension
        Which units are allowed.
    faults
        Gets what is wrong with it.

    Returns
    -------
    float
        SI.
    """
    value = _read(where, text, dimension, faults)
    if value is None:
        return 1.0
    if value <= 0.0:
        message = Message("option-not-positive", got=text.strip(), unit=dimension.si)
        faults.append(Fault(where=where, message=message))
        return 1.0
    return value


def require_move(machine: Machine, number: int, faults: list[Fault]) -> None:
    """Note a fault where the profile has no move of this number, counted from 1."""
    count = len(machine.moves)
    if not 1 <= number <= count:
        message = Message("option-no-such-move", got=number, count=count)
        faults.append(Fault(where="--move", message=message))


def require_one_of(where: str, text: str, allowed: Sequence[str], faults: list[Fault]) -> None:
    """Note a fault where an option has none of the words that it takes."""
    if text not in allowed:
        words = Message("either", first=tuple(allowed[:-1]), last=allowed[-1])
        message = Message("option-one-of", got=repr(text), allowed=words)
        faults.append(Fault(where=where, message=message))


def raise_all(faults: list[Fault]) -> None:
    """Raise all that was noted, if anything was."""
    if faults:
        raise InputError(faults)
