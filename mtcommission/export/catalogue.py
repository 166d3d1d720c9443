"""Which controls there are, by name: needs no computation, so that the list comes at once."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message

CONTROL_TITLES: Mapping[str, str] = {
    "sinumerik": "SINUMERIK 840D / 828D / ONE",
    "heidenhain": "HEIDENHAIN, NCK-based",
    "fanuc": "FANUC 16i / 18i / 30i",
    "isg": "ISG kernel / TwinCAT CNC",
    "twincat": "Beckhoff TwinCAT NC / NCI",
    "plcopen": "PLCopen motion blocks, CODESYS",
    "generic": "any control: SI values in neutral words",
    "linuxcnc": "LinuxCNC 2.10 and newer",
    "klipper": "Klipper",
    "grblhal": "grblHAL",
    "fluidnc": "FluidNC",
    "marlin": "Marlin",
    "ros2": "ROS 2 / MoveIt",
}
"""Maker and products by the name that ``--control`` takes."""


def control_keys() -> tuple[str, ...]:
    """Return the names that ``--control`` takes.

    Examples
    --------
    >>> control_keys()[:3]
    ('sinumerik', 'heidenhain', 'fanuc')
    """
    return tuple(CONTROL_TITLES)


def describe_controls() -> str:
    """Return name and title of every control, a line each.

    Examples
    --------
    >>> print(describe_controls().splitlines()[0])
    sinumerik   SINUMERIK 840D / 828D / ONE
    """
    width = max(map(len, CONTROL_TITLES)) + 2
    return "".join(f"{key:<{width}}{title}\n" for key, title in CONTROL_TITLES.items())


def find_control_key(name: str) -> str:
    """Return the key of a control as somebody typed it.

    Parameters
    ----------
    name
        In any case, with blanks around.

    Returns
    -------
    str

    Raises
    ------
    InputError
        If there is no such control; with the nearest name and the list.

    Examples
    --------
    >>> find_control_key(" Klipper")
    'klipper'
    """
    key = name.strip().lower()
    if key in CONTROL_TITLES:
        return key
    close = get_close_matches(key, CONTROL_TITLES, n=1)
    given, there_are = repr(name), tuple(CONTROL_TITLES)
    message = Message("export-no-control", given=given, there_are=there_are)
    if close:
        message = Message("export-no-control-but", given=given, meant=close[0], there_are=there_are)
    raise InputError([Fault(where="--control", message=message)])
