"""What a record says, as machine and filters again."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.machine import Datum, Profile
from mtcommission.record.read_back import read_machine
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry, to_plain
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


@pytest.mark.parametrize(
    "item",
    [
        SetpointFilter(kind="zv", frequency_hz=40.0, damping_ratio=0.05),
        SetpointFilter(kind="fir", taps=(0.25, 0.5, 0.25), spacing=0.002),
    ],
)
def test_filters_come_back_as_they_were(item: SetpointFilter) -> None:
    """If it failed, the loop of an export or a verification would be another one."""
    plain = to_plain(item)
    assert (plain["delays"], plain["shares"]) == tuple(map(list, item.impulses))
    assert plain["duration"] == item.duration
    assert to_entry(json.loads(json.dumps(plain)), SetpointFilter) == item
