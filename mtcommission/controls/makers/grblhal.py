"""grblHAL."""

from __future__ import annotations

from mtcommission.controls.control import (
    LETTERS,
    Axis,
    Control,
    Corner,
    CornerRule,
    acceleration_row,
    jerk_row,
    letter_of,
)
from mtcommission.controls.kind import Jerk, read
from mtcommission.controls.makers.stepping import sends_steps
from mtcommission.controls.row import Row, Setting, Values
from mtcommission.controls.syntax import MACHINE_DATA

GRBLHAL_SOURCE = "grblHAL core at f80fc34d: settings, planner, stepper"

ADDRESSES = {GRBLHAL_SOURCE: "github.com/grblHAL/core"}
"""Where each source was read, November 2026."""

GRBLHAL = sends_steps(
    "grblhal",
    GRBLHAL_SOURCE,
    jerk=Jerk.LIMIT,
    features={
        "acceleration": read(GRBLHAL_SOURCE, "$120 + axis [mm/s^2, deg/s^2] 0.001"),
        "jerk": read(
            GRBLHAL_SOURCE,
            "$800 + axis [mm/s^3, deg/s^3] 0.001",
            "Only in builds with ENABLE_JERK_ACCELERATION. The acceleration changes once per "
            "segment of 10 ms (default): jerk times near that cannot be promised.",
        ),
        "position_cycle": read(
            GRBLHAL_SOURCE,
            "ACCELERATION_TICKS_PER_SECOND",
            "Velocity is a staircase of 10 ms segments, which is not simulated.",
        ),
    },
)


def _grblhal(axis: Axis, _loop: Values) -> list[Row]:
    index = LETTERS.index(letter_of(axis, LETTERS[:6], "grblHAL"))
    return [
        acceleration_row(axis, f"${120 + index}"),
        jerk_row(axis, f"${800 + index}", "limit-jerk"),
    ]


GROUP = (Row(Setting.TOGETHER, "$11", index="corner", unit="mm", meaning="group-row-deviation"),)

CONTROL = Control(
    kind=GRBLHAL,
    rows=_grblhal,
    layout=MACHINE_DATA,
    names_axes=True,
    group=GROUP,
    corner=CornerRule(kind=Corner.DEVIATION, source="grblHAL core at 030c8299, planner.c"),
    notes=("grblhal-builds", "grblhal-corners", "export-segments"),
)
