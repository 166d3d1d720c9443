"""What the sheet prints, what is typed in and what is judged are one set of numbers.

If one of these fails, a control drives lines or circles with other limits than were judged.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from mtcommission.cli.group_view import describe_group
from mtcommission.controls.control import Control
from mtcommission.controls.kinds import CONTROLS
from mtcommission.controls.row import AT_CORNERS, PATH_ACCELERATION, PATH_JERK, WAIT, Key
from mtcommission.group.contours import line_deviation
from mtcommission.group.export import GroupExport, export_group
from mtcommission.group.group import Group, join
from mtcommission.group.record import GroupRecord, build_group_record, load_group, read_pair
from mtcommission.group.sheet import compose_group, words_of
from mtcommission.group.task import read_task
from mtcommission.machine.profile.read import parse_profile, profile_text_hash, read_source
from mtcommission.record.shape import dump_json
from mtcommission.sheet.document import Headline, Table

PROFILES = Path(__file__).parent.parent / "profiles"

GIVEN = """kind = "{}"
position_gain = "{} 1/s"
velocity_gain = "{} kN s/m"
integral_time = "20 ms"
"""

FEWER = (
    ('payload = ["0 kg", "60 kg"]', 'move_sizes = "listed"'),
    ('frequency_spread = "5 %"', 'frequency_spread = "2 %"\ndamping_spread = "0 %"'),
)
"""Changes of the profiles with which less is to be computed."""


@cache
def joined(kind: str) -> Group:
    """The small milling machine under a kind of control, its gains given, or two printer's axes."""
    follows, sources = CONTROLS[kind].kind.follows_steps, []
    for number, axis in enumerate("XY"):
        name = "printer-belt.toml" if follows else f"mill-{axis.lower()}.toml"
        source = read_source(PROFILES / name)
        text = source.text.replace('axis = "X"', f'axis = "{axis}"')
        own = GIVEN.format(kind, 60, 150 - 20 * number)
        text = re.sub(r'^kind = "klipper".*$', f'kind = "{kind}"', text, flags=re.MULTILINE)
        for old, new in (('kind = "sinumerik"\n', own), *FEWER):
            text = text.replace(old, new)
        sources.append(replace(source, text=text, sha256=profile_text_hash(text.encode())))
    machines = [parse_profile(one.text, where=str(one.path)) for one in sources]
    assert [one.control.kind.key for one in machines] == [kind, kind]
    return join(read_task(machines, sources, tolerance="20um", feed="6m/min"))


@cache
def recorded(kind: str) -> GroupRecord:
    return build_group_record(joined(kind), created="today")


@cache
def exported(kind: str) -> GroupExport:
    return export_group(recorded(kind), control=kind)


EVERY = ("sinumerik", "heidenhain", "fanuc", "twincat", "klipper", "marlin")
"""One of each rule at corners, and of each place that path limits have, or have not."""


@pytest.mark.parametrize("kind", EVERY)
def test_file_terminal_sheet_and_text_hold_the_numbers_that_were_judged(kind, tmp_path):
    record, control = recorded(kind), CONTROLS[kind]
    file = tmp_path / "group.json"
    file.write_text(dump_json(record), encoding="utf-8")
    assert load_group(file) == record
    words = words_of(record, "en")
    terminal = " ".join(str(line) for line in describe_group(record, words))
    first, *_ = compose_group(record, read_pair(record), words).sections
    tables = [block for block in first.blocks if isinstance(block, Table)]
    entered = {row[0]: row for row in tables[0].rows}
    (headline,) = (block for block in first.blocks if isinstance(block, Headline))
    large = {one.label: one.value for one in headline.values}
    for key, unit, label in (
        (PATH_ACCELERATION, "m/s^2", "Path acceleration"),
        (PATH_JERK, "m/s^3", "Path jerk"),
    ):
        told = getattr(record.path, key[1])
        in_text = typed(exported(kind).text, control, key)
        if told is None:
            assert in_text is None
            continue
        assert in_text == pytest.approx(told, rel=1e-9)
        shown = words.format.quantity(told, unit)
        assert shown in terminal
        assert large[label] == shown
        row = control.place_of(key)
        assert row is not None
        assert float(str(entered[label][-1])) * row.scale == pytest.approx(told, rel=1e-9)
    corner = typed(exported(kind).text, control, AT_CORNERS)
    told = record.corner_rule.value if control.corner_name else 0.0
    assert (corner or 0.0) == pytest.approx(told, rel=5e-3)
    assert (corner or 0.0) <= told * (1.0 + 1e-9)
    for axis in record.axes:
        if control.place_of(WAIT) is None:
            assert axis.wait == 0.0
    assert record.limits == joined(kind).path
    line = next(check for check in record.assessment.checks if check.name == "line")
    again, _ = line_deviation(read_pair(record), feed=record.feed, limits=record.limits)
    assert again + joined(kind).encoder_noise == pytest.approx(line.value, rel=1e-6, abs=1e-9)
    # Rounding to the safe side, and what a control lacks of a jerk limit, may lessen it.
    if control.kind.jerk.value == "limit":
        assert exported(kind).line <= (line.value or 0.0) * 1.02
    if record.assessment.met:
        assert exported(kind).meets_requirements


def typed(text: str, control: Control, key: Key) -> float | None:
    """What the text holds for the path, by the name in the control's own words; None: nothing."""
    row = control.place_of(key)
    if row is None:
        return None
    if "paramPathDynamics" in row.name:
        numbers = re.findall(r"#set paramPathDynamics\((\S+);(\S+);(\S+)\)#", text)
        return float(numbers[0][1 if key == PATH_ACCELERATION else 2]) * 1e-3
    found = re.findall(
        rf"^.{{0,6}}?{re.escape(row.name)} *(?:=|:|\|) *(?:\S+ *= *)?([0-9.]+)", text, re.MULTILINE
    )
    return float(found[-1]) * row.scale if found else None
