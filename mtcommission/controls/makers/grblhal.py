"""grblHAL."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.controls.control import LETTERS, Axis, Control, Corner, CornerRule
from mtcommission.controls.kind import Jerk
from mtcommission.controls.makers.stepping import sends_steps
from mtcommission.controls.row import Row, Values, at_corners
from mtcommission.controls.syntax import MACHINE_DATA


def _rows(axis: Axis, _loop: Values) -> Iterator[Row]:
    index = LETTERS.index(axis.letter(LETTERS[:6], "grblHAL"))
    yield axis.acceleration_row(f"${120 + index}")
    yield axis.jerk_row(f"${800 + index}", "jerk")


CONTROL = Control(
    kind=sends_steps(key="grblhal", jerk=Jerk.LIMIT),
    rows=_rows,
    layout=MACHINE_DATA,
    names_axes=True,
    group=(at_corners("$11", "mm", "group-row-deviation"),),
    corner=CornerRule(kind=Corner.DEVIATION),  # grblHAL core at 030c8299, planner.c
    notes=("grblhal-builds", "grblhal-corners", "export-segments"),
)
