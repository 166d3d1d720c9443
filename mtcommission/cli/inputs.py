"""What commands read before they compute: the machine, its profile's text, the date."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from mtcommission.cli.language import speak_of
from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message, printable

if TYPE_CHECKING:
    from mtcommission.machine.machine import Machine
    from mtcommission.record.schema import Profile


def read_machine(profile: Path, f_max: str, *, sizes: str = "") -> Machine:
    """Return the machine of a profile, with what ``--f-max`` and ``--for`` say in its place."""
    from mtcommission.options import with_sizes
    from mtcommission.profile.read import read_profile

    machine = _with_force(read_profile(profile), f_max)
    return with_sizes(machine, sizes) if sizes else machine


def parse_machine(source: Profile, f_max: str, *, where: Path, sizes: str = "") -> Machine:
    """Return the machine of a profile that was read already, so that record and machine agree."""
    from mtcommission.options import with_sizes
    from mtcommission.profile.read import parse_profile

    machine = _with_force(parse_profile(source.text, where=str(where)), f_max)
    return with_sizes(machine, sizes) if sizes else machine


def describe_profile(path: Path) -> Profile:
    """Return name, hash and text of a profile, as the record keeps them."""
    from mtcommission.profile.read import decode_profile, profile_text_hash, read_profile_bytes
    from mtcommission.record.schema import Profile

    data = read_profile_bytes(path)  # once: a pipe gives it only once
    text = decode_profile(data, where=str(path))
    return Profile(name=printable(path.name), sha256=profile_text_hash(data), text=text)


def _with_force(machine: Machine, f_max: str) -> Machine:
    from mtcommission.options import with_force

    speak_of(machine)
    return with_force(machine, f_max) if f_max else machine


def list_warnings(machine: Machine) -> list[Message]:
    """Return what is unusual about a machine."""
    from mtcommission.machine.plausibility import check_plausibility

    return [remark.with_key() for remark in check_plausibility(machine)]


def list_delays(machine: Machine) -> list[Message]:
    """Return what makes every computation of a machine take long."""
    from mtcommission.machine.plausibility import check_patience

    return [remark.with_key() for remark in check_patience(machine)]


def now() -> str:
    """Date and time of the record; SOURCE_DATE_EPOCH fixes it for repeatable builds."""
    from datetime import UTC, datetime

    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        moment = datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)
    except (ValueError, OverflowError, OSError) as error:
        message = Message("cli-no-epoch", got=str(fixed)[:40])
        raise InputError([Fault(where="SOURCE_DATE_EPOCH", message=message)]) from error
    return moment.isoformat(timespec="seconds")
