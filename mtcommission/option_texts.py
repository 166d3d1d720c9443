"""One text of the command line -> one quantity; faults are gathered, to be raised together."""

from __future__ import annotations

from difflib import get_close_matches

from mtcommission.errors import Fault
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import Bound
from mtcommission.plant.plant import Plant
from mtcommission.units.quantities import (
    ANGLE,
    ANGULAR_VELOCITY,
    FORCE,
    LENGTH,
    MODAL_DEFLECTION,
    MODAL_RATE,
    ROTARY_MODAL_DEFLECTION,
    ROTARY_MODAL_RATE,
    TORQUE,
    VELOCITY,
    Dimension,
    parse_quantity,
)

BY_UNIT = {
    "m": LENGTH,
    "m/s": VELOCITY,
    "rad": ANGLE,
    "rad/s": ANGULAR_VELOCITY,
    "N": FORCE,
    "N m": TORQUE,
    "N s^2": MODAL_DEFLECTION,
    "N s": MODAL_RATE,
    "N m s^2": ROTARY_MODAL_DEFLECTION,
    "N m s": ROTARY_MODAL_RATE,
}


def read_bound(plant: Plant, text: str, faults: list[Fault]) -> Bound:
    """Return what ``--limit NAME=VALUE`` asks for, or any bound after noting a fault.

    Parameters
    ----------
    plant
        Its signals may be bounded.
    text
        Name and value.
    faults
        Gets what is wrong with it.

    Returns
    -------
    Bound
    """
    name, separator, value = text.partition("=")
    name = name.strip()
    if not separator:
        faults.append(
            Fault(
                where="--limit",
                message=Message("verbatim", text=f"got {text!r}, must be NAME=VALUE"),
            )
        )
    elif name not in plant.signals:
        close = get_close_matches(name, plant.signals, n=1)
        hint = f"; did you mean {close[0]}?" if close else ""
        message = f"no state or output {name!r}{hint}; there are: {', '.join(plant.signals)}"
        faults.append(Fault(where="--limit", message=Message("verbatim", text=message)))
    else:
        dimension = BY_UNIT[plant.signal_units[plant.signals.index(name)]]
        found = read_positive(f"--limit {name}", value, dimension, faults)
        return Bound(name=name, value=found)
    return Bound(name=name, value=1.0)


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
    try:
        value = parse_quantity(text, dimension)
    except ValueError as error:
        faults.append(Fault(where=where, message=Message("verbatim", text=str(error))))
        return 1.0
    if value <= 0.0:
        message = f"got {text.strip()}, must be > 0 {dimension.si}"
        faults.append(Fault(where=where, message=Message("verbatim", text=message)))
        return 1.0
    return value
