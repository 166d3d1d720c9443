"""Which controls there are, by name: needs no computation, so that the list comes at once."""

from __future__ import annotations

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.kinds import KINDS, STATE_SPACE
from mtcommission.controls.wording import name_control
from mtcommission.machine.readers import propose

CONTROL_KEYS = tuple(key for key in KINDS if key != STATE_SPACE.key)
"""What ``--control`` takes: every kind but the free controller, which has no syntax of its own."""


def describe_controls(words: Catalogue) -> str:
    """Return key and name of every control, a line each."""
    width = max(map(len, CONTROL_KEYS)) + 2
    return "".join(f"{key:<{width}}{words.say(name_control(key))}\n" for key in CONTROL_KEYS)


def find_control_key(name: str) -> str:
    """Return the key of a control as somebody typed it.

    Raises InputError if there is no such control; with the nearest name, or the list.

    Examples
    --------
    >>> find_control_key(" Klipper")
    'klipper'
    """
    key = name.strip().lower()
    if key in CONTROL_KEYS:
        return key
    message = Message("export-no-control", given=repr(name), hint=propose(key, CONTROL_KEYS))
    raise InputError.at("--control", message)
