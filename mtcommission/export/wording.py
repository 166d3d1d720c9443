"""SI values in the units that an export speaks in."""

from __future__ import annotations

from math import isfinite, pi

MILLI, MICRO = 1e-3, 1e-6
DEGREE, TURN = pi / 180.0, 2.0 * pi


def show_value(value: float, unit: str, *, in_degrees: bool) -> str:
    """Return an SI value with a unit that people read.

    Parameters
    ----------
    value
        SI; inf means that the axis never settles.
    unit
        SI unit.
    in_degrees
        Whether angles are shown in degrees, as most controls have them.

    Returns
    -------
    str
        Four digits.

    Examples
    --------
    >>> show_value(5e-6, "m", in_degrees=True), show_value(4.848e-5, "rad", in_degrees=True)
    ('5 um', '0.002778 deg')
    >>> show_value(float("inf"), "s", in_degrees=False)
    'not settled'
    """
    if not isfinite(value):
        return "not settled"
    if in_degrees and unit.split("/")[0] == "rad":
        return f"{value / DEGREE:.4g} {unit.replace('rad', 'deg', 1)}"
    size, prefix = {"m": (MICRO, "u"), "rad": (MICRO, "u"), "s": (MILLI, "m")}.get(unit, (1.0, ""))
    return f"{value / size:.4g} {prefix}{unit}"
