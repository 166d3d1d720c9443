"""FluidNC."""

from __future__ import annotations

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import (
    LETTERS,
    Axis,
    Control,
    Corner,
    CornerRule,
    Typed,
    acceleration_row,
    letter_of,
)
from mtcommission.controls.kind import read
from mtcommission.controls.makers.stepping import make_up, sends_steps
from mtcommission.controls.row import Row, Setting, Values
from mtcommission.controls.syntax import YAML

FLUIDNC_SOURCE = "FluidNC at e952f33f: Axis.cpp, StepperPrivate.h"

ADDRESSES = {FLUIDNC_SOURCE: "github.com/bdring/FluidNC"}
"""Where each source was read, November 2026."""

FLUIDNC = sends_steps(
    "fluidnc",
    FLUIDNC_SOURCE,
    features={
        "acceleration": read(FLUIDNC_SOURCE, "acceleration_mm_per_sec2 0.001..100 000, float"),
        "jerk": read(FLUIDNC_SOURCE, note="None; the word stands in one comment of the source."),
        "position_cycle": read(
            FLUIDNC_SOURCE,
            note="Velocity is a staircase of 10 ms segments, which is not simulated.",
        ),
    },
)


def _fluidnc(axis: Axis, _loop: Values) -> list[Row]:
    letter = letter_of(axis, LETTERS[:6], "FluidNC").lower()
    return [acceleration_row(axis, "acceleration_mm_per_sec2", section=f"axes/{letter}")]


def _fluidnc_notes(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    return (
        Message("fluidnc-no-jerk"),
        *make_up(axis, typed),
        Message("export-segments"),
        *((Message("fluidnc-degrees"),) if axis.is_rotary else ()),
    )


GROUP = (
    Row(
        Setting.TOGETHER,
        "junction_deviation_mm",
        index="corner",
        unit="mm",
        meaning="group-row-deviation",
    ),
)

CONTROL = Control(
    kind=FLUIDNC,
    rows=_fluidnc,
    layout=YAML,
    names_axes=True,
    notes_of=_fluidnc_notes,
    group=GROUP,
    corner=CornerRule(
        kind=Corner.DEVIATION,
        source="wiki.fluidnc.com, config; the rule is that of Grbl (?)",
        is_verified=False,
        least=1e-5,
        most=1e-3,
    ),
)
