"""What a record says, as machine and filters again."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.shapers import shape
from mtcommission.record.machine import Datum, Profile
from mtcommission.record.read_back import read_filter, read_machine
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry
from mtcommission.record.values import SetpointFilterEntry
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


def test_filters_come_back_as_they_were() -> None:
    """If it failed, the loop of an export or a verification would be another one."""
    impulses = shape("zv", frequency_hz=40.0, damping_ratio=0.05)
    zv = read_filter(SetpointFilterEntry(
        kind="zv", time=0.0, second_time=0.0, frequency_hz=40.0, damping_ratio=0.05,
        delays=list(impulses.delays), shares=list(impulses.shares), duration=impulses.delays[-1],
    ))  # fmt: skip
    assert zv.impulses == impulses
    fir = read_filter(SetpointFilterEntry(
        kind="fir", time=0.0, second_time=0.0, frequency_hz=0.0, damping_ratio=0.0,
        delays=[0.0, 0.002, 0.004], shares=[0.25, 0.5, 0.25], duration=0.004,
    ))  # fmt: skip
    assert (fir.impulses.delays, fir.impulses.shares) == ((0.0, 0.002, 0.004), (0.25, 0.5, 0.25))
