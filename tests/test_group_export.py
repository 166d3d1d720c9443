"""Export of a group: one text, all axes, read back by readers of its own."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from pathlib import Path

import pytest

from mtcommission import cli
from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.group.export import GroupExport, export_group
from mtcommission.group.record import AxisEntry, GroupRecord
from mtcommission.machine.profile.read import profile_text_hash
from tests.group_record import mill_record, printer_record, write_mill
from tests.second_reader import ini_file, lines

BELOW, ABOVE = 0.99, 1.0 + 1e-9
"""What rounding to the safe side may leave of a limit."""


@pytest.fixture(scope="module")
def record() -> GroupRecord:
    return mill_record()


CHECKED = ("sinumerik", "linuxcnc", "klipper", "twincat", "generic")
"""One of each layout."""


@pytest.fixture(scope="module")
def exports(record: GroupRecord) -> dict[str, GroupExport]:
    return {key: export_group(record, control=key) for key in CHECKED}


def lies_below(text: str, scale: float, value: float) -> bool:
    return BELOW * value <= float(text) * scale <= ABOVE * value


def parts(text: str) -> dict[str, str]:
    """The text below each heading."""
    pieces = re.split(r"^(?:;|#) ==== (.+?) ====$", text, flags=re.MULTILINE)
    return dict(zip(pieces[1::2], pieces[2::2], strict=True))


def cells(text: str) -> dict[str, str]:
    rows = [[cell.strip() for cell in line.split("|")] for line in text.splitlines()]
    return {row[0]: row[1] for row in rows if len(row) == 5 and row[0] != "Parameter"}


def test_a_sinumerik_gets_a_part_for_each_axis_and_one_for_the_path(
    record: GroupRecord, exports: dict[str, GroupExport]
) -> None:
    text = exports["sinumerik"].text
    found = parts(text)
    assert list(found) == ["Axis X", "Axis Y", "Path of all axes"]
    for axis in record.axes:
        data = lines(found[f"Axis {axis.name}"], r"^N(\d+) \$\w+(?:\[\d\])?=(\S+)")
        # Of an array the last one stands: DYNPOS, the same as DYNNORM.
        assert lies_below(data["32300"], 1.0, axis.limits.recommended.acceleration)
        assert lies_below(data["32431"], 1.0, axis.limits.recommended.jerk)
        assert lies_below(data["32200"], 1000.0 / 60.0, axis.loop.Kv)
        assert record.filter is not None
        assert float(data["32410"]) == pytest.approx(record.filter.time, abs=1e-7)
        assert data["32900"] == "1"
        assert float(data["32910"]) == pytest.approx(axis.wait, abs=1e-9)
    path = lines(found["Path of all axes"], r"^N(\d+) \$\w+(?:\[\d\])?=(\S+)")
    # The path jerk for each mode that gets the axes' jerk: DYNNORM and DYNPOS.
    modes = [
        re.findall(rf"^{name}\[(\d)\]", text, re.MULTILINE)
        for name in (r"N20600 \$MC_MAX_PATH_JERK", r"N32431 \$MA_MAX_AX_JERK")
    ]
    assert modes == [["0", "1"], ["0", "1"] * 2]
    marked = [
        line.endswith("(?)") for line in found["Path of all axes"].splitlines() if line[:1] == "N"
    ]
    assert marked == [False, True, True, True]
    assert path["42502"] == "1"
    assert lies_below(path["42500"], 1.0, record.path.acceleration)
    assert float(path["20600"]) > max(axis.limits.recommended.jerk for axis in record.axes)


def test_a_linuxcnc_gets_one_ini(record: GroupRecord, exports: dict[str, GroupExport]) -> None:
    found = ini_file(exports["linuxcnc"].text)
    for axis, joint in zip(record.axes, ("JOINT_0", "JOINT_1"), strict=True):
        for section in (joint, f"AXIS_{axis.name}"):
            limit = found[section]["MAX_ACCELERATION"]
            assert lies_below(limit, 1e-3, axis.limits.recommended.acceleration)
    assert lies_below(found["TRAJ"]["MAX_LINEAR_ACCELERATION"], 1e-3, record.path.acceleration)
    jerk = min(axis.limits.recommended.jerk for axis in record.axes)
    assert lies_below(found["TRAJ"]["MAX_LINEAR_JERK"], 1e-3, jerk)
    remarks = re.findall(r"^# > ([XY]): Kv = (\S+)", exports["linuxcnc"].text, re.MULTILINE)
    assert [name for name, _ in remarks] == ["X", "Y"]


@pytest.mark.parametrize("control", ["sinumerik", "generic"])
def test_circles_of_the_text_are_the_records(
    control: str, exports: dict[str, GroupExport], record: GroupRecord
) -> None:
    found = exports[control]
    assert [one.planned.feed for one in found.circles] == pytest.approx([1.0 / 60.0, record.feed])
    assert all(one.is_same for one in found.circles)
    assert sum("as in the record but" in line for line in found.header) == 2
    assert found.meets_requirements


def test_a_wait_in_the_text_reaches_its_circles(record: GroupRecord) -> None:
    late = [replace(record.axes[0], wait=4e-3), record.axes[1]]
    found = export_group(replace(record, axes=late), control="sinumerik")
    assert "N32910 $MA_DYN_MATCH_TIME[0]=0.004 " in found.text
    assert not any(one.is_same for one in found.circles)
    for one in found.circles:
        # Delays apart by d draw v d from largest to smallest radius.
        delays = [record.feedforward[name].delay for name in record.plane]
        planned = one.planned.feed * (4e-3 + delays[0] - delays[1])
        assert one.form_deviation == pytest.approx(planned, rel=0.01)
    assert not found.meets_requirements
    # A control that has no place for it says so, and is simulated without.
    found = export_group(replace(record, axes=late), control="fanuc")
    assert any("wait X 4 ms" in line for line in found.header)


def test_a_control_that_lacks_something_draws_its_own_circles(
    exports: dict[str, GroupExport],
) -> None:
    found = exports["klipper"]
    assert not any(one.is_same for one in found.circles)
    assert any("NOT AS IN THE RECORD" in line for line in found.header)
    assert [one.kind for one in found.missed].count("group-export-other-circle") == 2


@pytest.mark.parametrize("control", ["sinumerik", "twincat"])
def test_a_list_holds_the_same(
    control: str, record: GroupRecord, exports: dict[str, GroupExport]
) -> None:
    listed = export_group(record, control=control, as_list=True)
    assert listed.circles == exports[control].circles
    pieces = re.split(r'^"# ==== (.+?) ===="$', listed.text, flags=re.MULTILINE)
    assert pieces[1::2] == ["Axis X", "Axis Y", "Path of all axes"]
    for piece in pieces[2::2]:
        rows = list(csv.DictReader(one for one in piece.splitlines() if one))
        assert len({(row["section"], row["parameter"]) for row in rows}) == len(rows) > 0


def test_a_printer_keeps_its_circles_and_asks_for_no_jerk(tmp_path: Path) -> None:
    record = printer_record()
    found = export_group(record, control="klipper")
    assert found.meets_requirements
    assert all(one.is_same for one in found.circles)
    assert not any("jerk" in line and "NOT IN THIS TEXT" in line for line in found.header)
    told = ini_file(found.text.replace(": ", " = "))
    assert {"shaper_type_x", "shaper_type_y"} <= set(told["input_shaper"])
    printer = told["printer"]
    assert lies_below(printer["max_accel"], 1e-3, record.path.acceleration)
    assert lies_below(printer["square_corner_velocity"], 1e-3, record.corner_rule.value)
    # Its own default of 5 mm/s is not what a group gets.
    assert not any("5 mm/s" in line for line in found.header)


def renamed(axis: AxisEntry, name: str) -> AxisEntry:
    text = axis.profile.text.replace(f'axis = "{axis.name}"', f'axis = "{name}"')
    profile = replace(axis.profile, text=text, sha256=profile_text_hash(text.encode()))
    return replace(axis, name=name, profile=profile, machine=replace(axis.machine, axis=name))


@pytest.mark.parametrize("control", ["linuxcnc", "twincat"])
def test_axes_that_a_control_cannot_tell_apart_are_refused(
    control: str, record: GroupRecord
) -> None:
    names = ("X-1", "X.1") if control == "twincat" else ("X1", "X2")
    axes = [renamed(axis, name) for axis, name in zip(record.axes, names, strict=True)]
    group = replace(record, axes=axes, plane=list(names))
    with pytest.raises(InputError) as refused:
        export_group(group, control=control)
    (fault,) = refused.value.faults
    said = Catalogue().say(fault.message)
    assert all(name in said for name in names)
    assert "machine.axis" in said
    assert export_group(group, control="sinumerik").meets_requirements


def test_the_command_takes_a_group_in_german(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    group, out = write_mill(tmp_path), tmp_path / "group.txt"
    words = ["mtcommission", "export", group, "--control", "sinumerik", "-o", out]
    monkeypatch.setattr("sys.argv", [*map(str, words), "--language", "de"])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    assert stopped.value.code in (0, None)
    text = out.read_text("ascii")
    assert "; ==== Achse X ====" in text
    assert "; ==== Bahn aller Achsen ====" in text
    assert "wie im Protokoll" in " ".join(re.sub(r"\n;", "", text).split())
