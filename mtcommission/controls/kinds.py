"""Every control, by its key: one file of ``makers`` each."""

from __future__ import annotations

from collections.abc import Mapping

from mtcommission.controls.control import Control
from mtcommission.controls.kind import EARLIER, ControlKind
from mtcommission.controls.makers import (
    fanuc,
    fluidnc,
    free,
    grblhal,
    heidenhain,
    isg,
    klipper,
    linuxcnc,
    marlin,
    plcopen,
    ros2,
    sinumerik,
    twincat,
)

GENERIC, STATE_SPACE, FREE = free.GENERIC, free.STATE_SPACE, free.FREE

CONTROLS: Mapping[str, Control] = {
    control.key: control
    for control in (
        sinumerik.CONTROL,
        heidenhain.CONTROL,
        fanuc.CONTROL,
        isg.CONTROL,
        twincat.CONTROL,
        plcopen.CONTROL,
        free.CONTROL,
        free.FREE,
        linuxcnc.CONTROL,
        klipper.CONTROL,
        grblhal.CONTROL,
        fluidnc.CONTROL,
        marlin.CONTROL,
        ros2.CONTROL,
    )
}
"""All of them, in the order in which they are listed."""

KINDS: Mapping[str, ControlKind] = {key: control.kind for key, control in CONTROLS.items()}
"""What each of them has."""

ADDRESSES: Mapping[str, str] = {
    **sinumerik.ADDRESSES,
    **heidenhain.ADDRESSES,
    **isg.ADDRESSES,
    EARLIER: "taken over from the project's own list of what was read",
    **twincat.ADDRESSES,
    **plcopen.ADDRESSES,
    **linuxcnc.ADDRESSES,
    **klipper.ADDRESSES,
    **grblhal.ADDRESSES,
    **fluidnc.ADDRESSES,
    **marlin.ADDRESSES,
    **ros2.ADDRESSES,
}
"""Where each source was read, by its title."""
