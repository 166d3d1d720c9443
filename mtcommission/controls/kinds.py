"""Every control, by its key: one file of ``makers`` each."""

from __future__ import annotations

from collections.abc import Mapping

from mtcommission.controls.control import Control
from mtcommission.controls.kind import ControlKind
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

GENERIC, STATE_SPACE = free.GENERIC, free.STATE_SPACE

MACHINE_TOOLS = (sinumerik, heidenhain, fanuc, isg, twincat, plcopen)
OTHERS = (linuxcnc, klipper, grblhal, fluidnc, marlin, ros2)

CONTROLS: Mapping[str, Control] = {
    control.key: control
    for control in (
        *(maker.CONTROL for maker in MACHINE_TOOLS),
        *(free.CONTROL, free.FREE),
        *(maker.CONTROL for maker in OTHERS),
    )
}
"""All of them, in the order in which they are listed."""

KINDS: Mapping[str, ControlKind] = {key: control.kind for key, control in CONTROLS.items()}
"""What each of them has."""
