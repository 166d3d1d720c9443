"""FluidNC."""

from __future__ import annotations

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import LETTERS, Axis, Control, Corner, CornerRule, Typed
from mtcommission.controls.makers.stepping import make_up, sends_steps
from mtcommission.controls.row import Row, Values, at_corners
from mtcommission.controls.syntax import YAML


def _rows(axis: Axis, _loop: Values) -> list[Row]:
    letter = axis.letter(LETTERS[:6], "FluidNC").lower()
    return [axis.acceleration_row("acceleration_mm_per_sec2", section=f"axes/{letter}")]


def _notes(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    return (
        Message("fluidnc-no-jerk"),
        *make_up(axis, typed),
        Message("export-segments"),
        *((Message("fluidnc-degrees"),) if axis.is_rotary else ()),
    )


CONTROL = Control(
    kind=sends_steps(key="fluidnc"),
    rows=_rows,
    layout=YAML,
    names_axes=True,
    notes_of=_notes,
    group=(at_corners("junction_deviation_mm", "mm", "group-row-deviation"),),
    # wiki.fluidnc.com, config; the rule is that of Grbl (?)
    corner=CornerRule(kind=Corner.DEVIATION, is_verified=False, least=1e-5, most=1e-3),
)
