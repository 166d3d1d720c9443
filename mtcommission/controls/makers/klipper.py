"""Klipper."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Control, Corner, CornerRule, Typed
from mtcommission.controls.kind import KLIPPER_SHAPERS, FilterChoice
from mtcommission.controls.makers.stepping import (
    PRINTER,
    corner_velocity,
    make_up,
    of_corner,
    sends_steps,
    shaper_values,
)
from mtcommission.controls.row import Row, Setting, Values, at_corners, fixed, on_path
from mtcommission.controls.syntax import CONFIG

MOST_DAMPING = {"ei": 0.4, "2hump_ei": 0.3, "3hump_ei": 0.2}
"""Largest damping ratios that Klipper takes, where it is not 0.99."""

USUAL = ("zv", "zvd")
"""Shapers that are tried where the run's filter is none of the control's."""

HEAD, SHAPER, CORNER = "printer", "input_shaper", "square_corner_velocity"
"""Sections, and the step of velocity at right angles."""


def _rows(axis: Axis, _loop: Values) -> Iterator[Row]:
    axis.require_linear("Klipper")
    letter = axis.letter("XYZ", "Klipper").lower()
    unit, said = "mm/s^2", "klipper-tool-head"
    yield Row(Setting.ACCELERATION, "max_accel", unit=unit, meaning=said, section=HEAD)
    if axis.follows:
        corner = f"{1e3 * corner_velocity(axis, USUAL):.3g}"
        yield fixed(CORNER, corner, "klipper-corner", unit="mm/s", section=HEAD)
    codes = {kind: kind for kind in KLIPPER_SHAPERS}
    for row in (
        Row(Setting.SHAPER, f"shaper_type_{letter}", codes=codes, section=SHAPER),
        *shaper_values(axis, f"shaper_freq_{letter}", f"damping_ratio_{letter}", section=SHAPER),
    ):
        yield replace(row, is_verified=letter != "z")


def _notes(axis: Axis, typed: Typed) -> Iterator[Message]:
    yield Message("klipper-no-jerk")
    yield from make_up(axis, typed)
    yield from of_corner(axis, "klipper-corner-bound", USUAL)
    yield Message("klipper-cruise")
    yield Message("klipper-shaper")
    if typed.values.get((Setting.SHAPER, "")) == "3hump_ei":
        yield Message("klipper-three-humps")


CONTROL = Control(
    kind=sends_steps(
        key="klipper",
        largest_acceleration=PRINTER,
        setpoint_filters=tuple(
            FilterChoice(kind=shaper, most_damping=MOST_DAMPING.get(shaper, 0.99))
            for shaper in KLIPPER_SHAPERS
        ),
    ),
    rows=_rows,
    layout=CONFIG,
    shapers=USUAL,
    notes_of=_notes,
    names_axes=True,
    group=(
        on_path("acceleration", "max_accel", "mm/s^2", "klipper-tool-head", section=HEAD),
        at_corners(CORNER, "mm/s", "group-row-speed", section=HEAD),
    ),
    axes_hold=(),
    corner=CornerRule(kind=Corner.JUNCTION),  # Klipper 84104bbb, toolhead.py
)
