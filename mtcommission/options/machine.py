"""--f-max and --for: the machine of a profile with another force limit or other sizes."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.errors import Fault, InputError
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.options.texts import raise_all, read_positive, require_one_of

SIZES = {"every": True, "listed": False}
"""Words of ``--for``, and whether they ask for every smaller move."""


def with_sizes(machine: Machine, text: str) -> Machine:
    """Return the machine with other sizes of move that its limits must serve.

    Parameters
    ----------
    machine
        From its profile.
    text
        Of ``--for``: ``every`` or ``listed``.

    Raises
    ------
    InputError
        If the text is neither.
    """
    faults: list[Fault] = []
    require_one_of("--for", text, list(SIZES), faults)
    raise_all(faults)
    needs = replace(machine.requirements, every_size=SIZES[text])
    return replace(machine, requirements=needs)


def with_force(machine: Machine, text: str) -> Machine:
    """Return the machine with another force limit.

    Parameters
    ----------
    machine
        From its profile.
    text
        Of ``--f-max``, e.g. ``2kN``.

    Raises
    ------
    InputError
        If the text is no positive force, or leaves nothing beside the static load.
    """
    dimension = machine.axis_units.force
    faults: list[Fault] = []
    force = read_positive("--f-max", text, dimension, faults)
    raise_all(faults)
    taken = machine.drive.max_force - machine.drive.motion_force
    if force <= taken:
        message = Message(
            "option-force-below-static-load",
            force=force,
            load=taken,
            unit=dimension.si,
        )
        raise InputError([Fault(where="--f-max", message=message)])
    return replace(machine, drive=replace(machine.drive, max_force=force))
