"""Which axis Klipper's files belong to, by the names that it gives them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePath

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message

_NAME = re.compile(
    r"(?:resonances|calibration_data|raw_data|shaper_calibrate)_(?:axis=)?([xyz])(?![a-z])",
    re.IGNORECASE,
)
_BELT = re.compile(r"axis=-?[0-9.]+,-?[0-9.]+", re.IGNORECASE)
"""TEST_RESONANCES AXIS=1,1: a direction, as for comparing the belts of a CoreXY."""


def by_axis(files: Sequence[str]) -> dict[str, list[str]]:
    """Return the files of each axis that their names tell, in the order given.

    Raises
    ------
    InputError
        A file was recorded along a belt.

    Examples
    --------
    >>> by_axis(["resonances_x_1.csv", "resonances_y_1.csv"])
    {'X': ['resonances_x_1.csv'], 'Y': ['resonances_y_1.csv']}
    >>> by_axis(["drive.csv", "resonances_y_1.csv"])
    {'': ['drive.csv', 'resonances_y_1.csv']}
    """
    belts = [file for file in files if _BELT.search(PurePath(file).name)]
    if belts:
        raise InputError([Fault(where=one, message=Message("identify-of-belt")) for one in belts])
    told = [_NAME.search(PurePath(file).name) for file in files]
    found: dict[str, list[str]] = {}
    for file, name in zip(files, told, strict=True):
        axis = name[1].upper() if name and all(told) else ""
        found.setdefault(axis, []).append(file)
    return found


def of_axis(file: str, axis: str) -> str:
    """Return the name of a file that is written for one of several axes.

    Examples
    --------
    >>> of_axis("printer.toml", "X")
    'printer-x.toml'
    """
    path = PurePath(file)
    return str(path.with_name(f"{path.stem}-{axis.lower()}{path.suffix}")) if file else ""
