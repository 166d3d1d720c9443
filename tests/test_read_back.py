"""What a record says, as machine and filters again."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.machine import Datum, Profile
from mtcommission.record.read_back import read_machine
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry
from tests.sheet_record import example_record


def with_profile(name: str, data: list[Datum]) -> Record:
    text = read_shipped(name).text
    profile = Profile(name=f"{name}.toml", sha256="", text=text)
    return replace(to_entry(example_record(), Record), profile=profile, data=data)


@pytest.mark.parametrize(
    ("name", "key"),
    [("rotary-table", "drive.max_force"), ("printer-belt", "drive.max_acceleration")],
)
def test_the_force_limit_is_that_of_the_run(name: str, key: str) -> None:
    """If it failed, a run with --f-max would be exported and verified with the profile's force."""
    datum = Datum(key=key, value=12.5, unit="", source="")
    assert read_machine(with_profile(name, [datum])).drive.max_force == 12.5
