"""What commands read before they compute: the machine of a profile."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mtcommission.cli.language import speak_of

if TYPE_CHECKING:
    from mtcommission.machine.machine import Machine
    from mtcommission.profile.read import ProfileSource


def read_machine(profile: Path, f_max: str, *, sizes: str = "") -> Machine:
    """Return the machine of a profile, with what ``--f-max`` and ``--for`` say in its place."""
    from mtcommission.options.machine import with_sizes
    from mtcommission.profile.read import read_profile

    machine = _with_force(read_profile(profile), f_max)
    return with_sizes(machine, sizes) if sizes else machine


def parse_machine(source: ProfileSource, f_max: str, *, where: Path, sizes: str = "") -> Machine:
    """Return the machine of a profile that was read already, so that record and machine agree."""
    from mtcommission.options.machine import with_sizes
    from mtcommission.profile.read import parse_profile

    machine = _with_force(parse_profile(source.text, where=str(where)), f_max)
    return with_sizes(machine, sizes) if sizes else machine


def _with_force(machine: Machine, f_max: str) -> Machine:
    from mtcommission.options.machine import with_force

    speak_of(machine)
    return with_force(machine, f_max) if f_max else machine
