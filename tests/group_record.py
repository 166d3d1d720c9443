"""The record of the shipped pair of axes, computed once for all tests of a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from mtcommission.group.group import join
from mtcommission.group.record import GroupRecord, build_group_record, load_group
from mtcommission.group.task import read_task
from mtcommission.profile.read import parse_profile, read_source
from mtcommission.record.files import dump_json

PROFILES = Path(__file__).parent.parent / "profiles"


@cache
def _text() -> str:
    sources = [read_source(PROFILES / f"mill-{axis}.toml") for axis in "xy"]
    machines = [parse_profile(source.text, where=str(source.path)) for source in sources]
    group = join(read_task(machines, sources))
    return dump_json(build_group_record(group, created="2026-01-02T03:04:05+00:00"))


def write_printer(folder: Path) -> Path:
    """Write the printer's axis twice, as X and as Y, as ``group.json``."""
    text = (PROFILES / "printer-belt.toml").read_text("utf-8")
    for name in "XY":
        own = text.replace('axis = "X"', f'axis = "{name}"')
        (folder / f"{name}.toml").write_text(own, "utf-8")
    sources = [read_source(folder / f"{name}.toml") for name in "XY"]
    machines = [parse_profile(source.text, where=str(source.path)) for source in sources]
    group = join(read_task(machines, sources, tolerance="50um", feed="6m/min"))
    path = folder / "group.json"
    record = build_group_record(group, created="2026-01-02T03:04:05+00:00")
    path.write_text(dump_json(record), "utf-8")
    return path


def write_mill(folder: Path) -> Path:
    """Write X and Y of the small milling machine together as ``group.json``."""
    path = folder / "group.json"
    path.write_text(_text(), "utf-8")
    return path


def read_mill(folder: Path) -> GroupRecord:
    """Return them as they come back from the file."""
    return load_group(write_mill(folder))
