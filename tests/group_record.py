"""The shipped pair of axes as a group, computed once for all tests of a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from mtcommission.group.group import Group, join
from mtcommission.group.record import GroupRecord, build_group_record
from mtcommission.group.task import read_task
from mtcommission.machine.machine import vary
from mtcommission.machine.profile.read import (
    ProfileSource,
    parse_profile,
    profile_text_hash,
    read_source,
)
from mtcommission.record.shape import dump_json
from tests.independent_circle import Driven

PROFILES = Path(__file__).parent.parent / "profiles"


@cache
def mill() -> Group:
    """Return X and Y of the small milling machine together."""
    return _join([read_source(PROFILES / f"mill-{axis}.toml") for axis in "xy"])


@cache
def mill_record() -> GroupRecord:
    """Return their record."""
    return build_group_record(mill(), created="2026-01-02T03:04:05+00:00")


def write_mill(folder: Path) -> Path:
    """Write it as ``group.json``."""
    path = folder / "group.json"
    path.write_text(dump_json(mill_record()), "utf-8")
    return path


@cache
def printer_record() -> GroupRecord:
    """Return the record of the printer's axis twice, as X and as Y."""
    source = read_source(PROFILES / "printer-belt.toml")
    sources = []
    for name in "XY":
        text = source.text.replace('axis = "X"', f'axis = "{name}"')
        sources.append(
            ProfileSource(path=source.path, sha256=profile_text_hash(text.encode()), text=text)
        )
    group = _join(sources, tolerance="50um", feed="6m/min")
    return build_group_record(group, created="2026-01-02T03:04:05+00:00")


def driven(group: Group, corners: tuple[int, int] = (0, 0)) -> list[Driven]:
    """Return the axes of the plane for the second program, in one corner of each."""
    found = []
    for axis, corner in zip(group.drawn, corners, strict=True):
        machine, tuned = axis.machine, axis.follower.tuned
        place = vary(machine, tuned.corners[corner])
        found.append((place, machine, tuned.controller, axis.follower.wait))
    return found


def _join(sources: list[ProfileSource], **options: str) -> Group:
    machines = [parse_profile(source.text, where=str(source.path)) for source in sources]
    return join(read_task(machines, sources, **options))
