"""What commands read before they compute: the machine, its profile's text, the date."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from mtcommission.cli.language import speak_of

if TYPE_CHECKING:
    from mtcommission.machine.machine import Machine
    from mtcommission.messages.message import Message
    from mtcommission.record.schema import Profile


def read_machine(profile: Path, f_max: str) -> Machine:
    """Return the machine of a profile, with the force limit of ``--f-max`` if one is given."""
    from mtcommission.profile.read import read_profile

    return _with_force(read_profile(profile), f_max)


def parse_machine(source: Profile, f_max: str, *, where: Path) -> Machine:
    """Return the machine of a profile that was read already, so that record and machine agree."""
    from mtcommission.profile.read import parse_profile

    return _with_force(parse_profile(source.text, where=str(where)), f_max)


def describe_profile(path: Path) -> Profile:
    """Return name, hash and text of a profile, as the record keeps them."""
    from mtcommission.profile.read import profile_text_hash, read_profile_text
    from mtcommission.record.schema import Profile

    text = read_profile_text(path)  # first: it says what is wrong with a file
    return Profile(name=path.name, sha256=profile_text_hash(path.read_bytes()), text=text)


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
    moment = datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)
    return moment.isoformat(timespec="seconds")
