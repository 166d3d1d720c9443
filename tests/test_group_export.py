"""Export of a group: one text, all axes, read back by readers of its own."""

from __future__ import annotations

import csv
import re
from dataclasses import replace

import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.group.export import export_group
from mtcommission.group.record import AxisEntry
from mtcommission.machine.profile.read import profile_text_hash
from tests.group_record import mill_record, write_mill
from tests.second_reader import lines

BELOW, ABOVE = 0.99, 1.0 + 1e-9
"""What rounding to the safe side may leave of a limit."""


@pytest.fixture(scope="module")
def record():
    return mill_record()


def lies_below(text: str, scale: float, value: float) -> bool:
    return BELOW * value <= float(text) * scale <= ABOVE * value


def parts(text: str) -> dict[str, str]:
    """The text below each heading."""
    pieces = re.split(r"^(?:;|#) ==== (.+?) ====$", text, flags=re.MULTILINE)
    return dict(zip(pieces[1::2], pieces[2::2], strict=True))


def test_a_sinumerik_gets_a_part_for_each_axis_and_one_for_the_path(record):
    exported = export_group(record, control="sinumerik")
    assert exported.meets_requirements
    assert all(one.is_same for one in exported.circles)
    text = exported.text
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


def test_a_wait_in_the_text_reaches_its_circles(record):
    late = [replace(record.axes[0], wait=4e-3), record.axes[1]]
    found = export_group(replace(record, axes=late), control="sinumerik")
    assert "N32910 $MA_DYN_MATCH_TIME[0]=0.004 " in found.text
    assert not any(one.is_same for one in found.circles)
    for one in found.circles:
        # Delays apart by d draw v d from largest to smallest radius.
        delays = [record.feedforward[name].delay for name in record.plane]
        planned = one.planned.feed * (4e-3 + delays[0] - delays[1])
        assert one.drawn.form_deviation == pytest.approx(planned, rel=0.01)
    assert not found.meets_requirements
    # A control that has no place for it says so, and is simulated without.
    found = export_group(replace(record, axes=late), control="fanuc")
    assert any("wait X 4 ms" in line for line in found.header)


@pytest.mark.parametrize("control", ["sinumerik", "twincat"])
def test_a_list_holds_the_same(control, record):
    listed = export_group(record, control=control, as_list=True)
    assert listed.circles == export_group(record, control=control).circles
    pieces = re.split(r'^"# ==== (.+?) ===="$', listed.text, flags=re.MULTILINE)
    assert pieces[1::2] == ["Axis X", "Axis Y", "Path of all axes"]
    for piece in pieces[2::2]:
        rows = list(csv.DictReader(one for one in piece.splitlines() if one))
        assert len({(row["section"], row["parameter"]) for row in rows}) == len(rows) > 0


def renamed(axis: AxisEntry, name: str) -> AxisEntry:
    text = axis.profile.text.replace(f'axis = "{axis.name}"', f'axis = "{name}"')
    profile = replace(axis.profile, text=text, sha256=profile_text_hash(text.encode()))
    return replace(axis, name=name, profile=profile, machine=replace(axis.machine, axis=name))


@pytest.mark.parametrize("control", ["linuxcnc", "twincat"])
def test_axes_that_a_control_cannot_tell_apart_are_refused(control, record):
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


def test_the_command_takes_a_group_in_german(tmp_path, run):
    group, out = write_mill(tmp_path), tmp_path / "group.txt"
    words = ("--control", "sinumerik", "-o", out, "--language", "de")
    assert run("export", group, *words)[0] == 0
    text = out.read_text("ascii")
    assert "; ==== Achse X ====" in text
    assert "; ==== Bahn aller Achsen ====" in text
