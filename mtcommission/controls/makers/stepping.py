"""What controls have in common that send steps."""

from __future__ import annotations

from functools import partial

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Typed
from mtcommission.controls.kind import ControlKind, Jerk, PositionLoop
from mtcommission.controls.row import Row, Setting

FREQUENCY_STEP, DAMPING_STEP = 0.01, 0.001
"""Decimals of a shaper's frequency [Hz] and damping ratio; Klipper and Marlin print as many."""

USUAL_CORNER = 5e-3
"""square_corner_velocity that Klipper takes unless told otherwise [m/s] (Config_Reference)."""

WHOLE = 0.999
"""Share of the recommended acceleration that is all of it, but for rounding."""

PRINTER = 20.0
"""The most that any of Klipper's sample configurations has as max_accel, most have 3 (config/ at
84104bbb) [m/s²]: what extruder, frame and driver of a printer take is not in the model. Marlin has
no such list; its printers are taken to be alike (assumed)."""

sends_steps = partial(
    ControlKind,
    follows_steps=True,
    jerk=Jerk.NONE,
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.DRIVE,),
    position_cycle=1e-3,
)
"""A control that sends steps has nothing of a loop; a stiff one in the drive stands in for it."""


def shaper_values(axis: Axis, frequency: str, damping: str, *, section: str = "") -> list[Row]:
    """Return the rows of frequency and damping ratio of a shaper, by their names."""
    if axis.has_own_filter:
        said = Message("shaper-of-run")
    else:
        said = Message("klipper-of-mode", mode=axis.mode_name)
    row = partial(Row, meaning=said, section=section)
    return [
        row(Setting.SHAPER_FREQUENCY, frequency, unit="Hz", step=FREQUENCY_STEP),
        row(Setting.SHAPER_DAMPING, damping, step=DAMPING_STEP),
    ]


def written(axis: Axis) -> float:
    """What the control is to get at most of the recommended acceleration [m/s²]."""
    return min(axis.acceleration, axis.kind.largest_acceleration)


def make_up(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    """What the acceleration had to give for the missing jerk limit; nothing if it gave none."""
    a = typed.acceleration
    share = a / axis.acceleration
    shaper = "yes" if (Setting.SHAPER, "") in typed.values else "no"
    if not typed.is_met:
        return (Message("export-least-vibration", share=share, shaper=shaper),)
    if a > WHOLE * written(axis):
        return ()
    return (Message("export-share-of-acceleration", share=share, shaper=shaper),)


def corner_velocity(axis: Axis, kinds: tuple[str, ...]) -> float:
    """Return Klipper's default, or less where that leaves the band behind some shapers [m/s]."""
    return min(axis.corner_velocity(kinds), USUAL_CORNER)


def of_corner(
    axis: Axis, kind: str, kinds: tuple[str, ...], **values: float
) -> tuple[Message, ...]:
    """What the model says of the corner, and what it does not."""
    if not axis.follows:
        return ()
    most = axis.corner_velocity(kinds)
    return (Message(kind, usual=1e3 * USUAL_CORNER, most=1e3 * most, **values),)
