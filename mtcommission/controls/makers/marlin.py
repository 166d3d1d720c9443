"""Marlin."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Control, Corner, CornerRule, Typed
from mtcommission.controls.kind import FilterChoice
from mtcommission.controls.makers.stepping import (
    PRINTER,
    USUAL_CORNER,
    corner_velocity,
    make_up,
    of_corner,
    sends_steps,
    shaper_values,
    written,
)
from mtcommission.controls.row import Row, Setting, Values, at_corners, fixed
from mtcommission.controls.syntax import G_CODE

SHAPERS = {
    "marlin_zv": "1",
    "marlin_mzv": "8",
    "marlin_zvd": "2",
    "marlin_zvdd": "3",
    "marlin_zvddd": "4",
    "marlin_ei": "5",
    "marlin_2hump_ei": "6",
    "marlin_3hump_ei": "7",
}
"""Values of M493 C."""

USUAL = ("marlin_zv", "marlin_zvd")
"""Shapers that are tried where the run's filter is none of the control's."""

LEAST_DEVIATION, MOST_DEVIATION = 1e-5, 3e-4
"""What Marlin takes as M205 J [m]; it refuses any other and keeps the old one
(M200-M205.cpp at 5ec63799)."""


def _rows(axis: Axis, _loop: Values) -> Iterator[Row]:
    axis.require_linear("Marlin")
    letter = axis.letter("XYZ", "Marlin")
    yield axis.acceleration_row(f"M201 {letter}")
    if axis.follows:
        yield _corner(axis, letter)
    yield fixed("M493 S", "1", "marlin-fixed-time")
    name = f"M493 {letter}"
    yield Row(Setting.SHAPER, f"{name} C", codes=SHAPERS, meaning="marlin-shaper")
    yield from shaper_values(axis, f"{name} A", f"{name} I")


def _corner(axis: Axis, letter: str) -> Row:
    """By junction deviation; by the step of velocity where J would be below what M205 takes."""
    if deviation := _junction_deviation(axis):
        return fixed("M205 J", f"{1e3 * deviation:.3g}", "marlin-corner", unit="mm")
    corner = f"{1e3 * corner_velocity(axis, USUAL):.3g}"
    return fixed(f"M205 {letter}", corner, "marlin-step", unit="mm/s")


def _junction_deviation(axis: Axis) -> float:
    """J = v² (sqrt(2) - 1)/a of a right angle that keeps the band [m]; 0: below what M205 takes."""
    kept, usual = (
        velocity**2 * (sqrt(2.0) - 1.0) / written(axis)
        for velocity in (axis.corner_velocity(USUAL), USUAL_CORNER)
    )
    if kept < LEAST_DEVIATION:
        return 0.0
    return min(max(LEAST_DEVIATION, usual), MOST_DEVIATION)


def _notes(axis: Axis, typed: Typed) -> Iterator[Message]:
    by_least = sqrt(LEAST_DEVIATION * written(axis) / (sqrt(2.0) - 1.0))
    fits = axis.follows and _junction_deviation(axis)
    bound = "marlin-corner-bound" if fits else "marlin-step-bound"
    yield Message("marlin-jerk")
    yield from make_up(axis, typed)
    yield from of_corner(axis, bound, USUAL, least=1e3 * by_least)
    yield Message("marlin-build")
    yield Message("marlin-grid")


CONTROL = Control(
    kind=sends_steps(
        key="marlin",
        largest_acceleration=PRINTER,
        setpoint_filters=tuple(
            FilterChoice(
                kind=shaper,
                least_frequency_hz=20.0,
                most_frequency_hz=500.0,
                least_damping=0.01,
                most_damping=0.25,
            )
            for shaper in SHAPERS
        ),
    ),
    rows=_rows,
    layout=G_CODE,
    names_axes=True,
    shapers=USUAL,
    notes_of=_notes,
    group=(at_corners("M205 J", "mm", "group-row-deviation"),),
    # Marlin 5ec63799, planner.cpp: junction deviation
    corner=CornerRule(kind=Corner.DEVIATION, least=LEAST_DEVIATION, most=MOST_DEVIATION),
)
