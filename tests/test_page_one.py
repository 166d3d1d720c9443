"""Page 1 of the sheet shows what the export writes: the same parameters, the same values.

If one of these fails, an engineer finds two values for one parameter, or types one in that nobody
judged.
"""

from __future__ import annotations

import re
from typing import Any

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.kinds import KINDS
from mtcommission.export.catalogue import CONTROL_KEYS
from mtcommission.export.write import export_record
from mtcommission.machine.profile.read import profile_text_hash
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry
from mtcommission.sheet.document import Headline, Table

from .sheet_record import Json, compose, example_record, own_export, print_html, run_of

LANGUAGES = ("en", "de")
AVERAGE = {"kind": "moving_average", "time": 0.016, "second_time": 0.0, "frequency_hz": 0.0,
           "damping_ratio": 0.0, "delays": [0.0], "shares": [1.0], "duration": 0.016}  # fmt: skip

SCREW = read_shipped("ball-screw").text
"""A rotary motor with a screw, and a SINUMERIK."""
BELT = read_shipped("printer-belt").text
"""A motor that follows its setpoint, and Klipper; Marlin takes the same."""


CASES = {
    "sinumerik": SCREW,
    "generic": read_shipped("rack-gantry").text,
    "klipper": BELT,
    "marlin": BELT.replace('kind = "klipper"', 'kind = "marlin"'),
}


def _record(kind: str, old: str = "", new: str = "", **recommended: Any) -> Json:
    """A run's record, with another text of the profile and other limits: unless they promise to
    hold, the export tries no others."""
    record, _ = run_of(CASES[kind])
    changed = record["profile"]["text"].replace(old, new) if old else record["profile"]["text"]
    record["profile"] |= {"text": changed, "sha256": profile_text_hash(changed.encode())}
    if KINDS[kind].find_filter("moving_average"):
        record["limits"]["recommended"]["setpoint_filter"] = AVERAGE
    record["limits"]["recommended"] |= recommended
    record["assessment"]["met"] = False
    return record


def _page_one(record: Json, language: str = "en") -> tuple[Headline, Table]:
    blocks = compose(record, language).sections[0].blocks
    head = next(block for block in blocks if isinstance(block, Headline))
    return head, next(block for block in blocks if isinstance(block, Table))


def _rows(record: Json, language: str) -> dict[str, tuple[str, ...]]:
    """By the export's names, which are the page's in English."""
    _, table = _page_one(record, language)
    rows = {}
    entries = own_export(record).entries
    for entry, (shown, *others) in zip(entries, table.rows, strict=True):
        name, section = entry.row.name, entry.row.section
        name = f"[{section}] {name}" if section else name
        assert language != "en" or str(shown).removeprefix("> ") == name
        rows[name] = tuple(map(str, others))
    assert len(rows) == len(table.rows), "a parameter has two values"
    return rows


IN_WORDS = {
    "control": {"en": "in the control", "de": "in der Steuerung"},
    "drive": {"en": "in the drive (DSC)", "de": "im Antrieb (DSC)"},
    "notch": {"en": "notch", "de": "Bandsperre"},
}
"""What is no control's own word is said in the language of the page."""


@pytest.mark.parametrize("kind", CASES)
def test_every_row_is_the_export_s(kind):
    """What stands in the export's file is held to a second reader by tests/test_export.py."""
    record = _record(kind)
    export = own_export(record)
    if kind in CONTROL_KEYS:
        export = export_record(to_entry(record, Record), control=kind)
    written = [one.value for one in export.entries]
    assert written
    for language in LANGUAGES:
        # The value stands before the meaning, behind the old one where there is one.
        shown = [row[-2].split("\u202f")[0] for row in _rows(record, language).values()]
        if language == "de":
            assert not any(re.fullmatch(r"-?\d+\.\d+", one) for one in shown)
            shown = [re.sub(r"^(-?\d+),(\d+)$", r"\1.\2", one) for one in shown]
        assert shown == [IN_WORDS.get(one, {}).get(language, one) for one in written]


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(("kind", "has_doubt"), [("sinumerik", True), ("klipper", False)])
def test_a_mark_of_doubt_is_explained_where_it_stands(kind, has_doubt, language):
    record = _record(kind)
    assert any("(?)" in row[-1] for row in _rows(record, language).values()) == has_doubt
    _, entries = _page_one(record, language)
    assert ("(?)" in entries.columns[-1].head) == has_doubt


@pytest.mark.parametrize("language", LANGUAGES)
def test_machining_modes_stand_on_page_1_as_in_the_export(language):
    """Three columns of limits; a mode without limits is said where the verdict is."""
    record = _record("sinumerik")
    rows = _rows(record, language)
    modes = {"[2]": "speed", "[3]": "accuracy", "[4]": "surface"}
    for index, mode in modes.items():
        name = f"N32300 $MA_MAX_AX_ACCEL{index}"
        said = Catalogue(language).text(f"machining-{mode}")
        assert (name in rows) == (said not in _page_one(record, language)[0].detail)
        if name in rows:
            assert said in rows[name][-1]


def test_the_verdict_of_page_1_is_that_of_the_export():
    record, _ = run_of(SCREW)
    assert own_export(record).meets_requirements
    assert _page_one(record)[0].verdict == "All requirements met"
    record["limits"]["modes"][0] |= {"meets_requirements": False, "band": 8e-6}
    head, _ = _page_one(record)
    assert head.verdict == "Requirements met, BUT INCOMPLETE"
    assert head.is_met
    left_out = "the band of machining mode Surface (finishing), 8\u202fµm"
    assert f"LEFT OUT: no limits keep the tool within {left_out}" in head.detail
    rude = {"acceleration": 14.0, "jerk": 1.4e4, "jerk_time": 1e-3}
    record["limits"]["recommended"] |= rude
    head, _ = _page_one(record)
    assert not head.is_met
    assert "REQUIREMENTS NOT MET: residual deviation" in head.detail


def test_sinumerik_can_be_typed_in():
    """One value for each parameter, the filter on, the delay at one place, a cycle one can set."""
    rows = _rows(_record("sinumerik"), "en")
    assert rows["N32400 $MA_AX_JERK_ENABLE"][-2] == "1"
    assert rows["N32410 $MA_AX_JERK_TIME"][-2] == "0.016\u202fs"
    two = AVERAGE | {"kind": "two_moving_averages", "time": 0.012, "second_time": 0.008}
    both = _rows(_record("sinumerik", setpoint_filter=two), "en")
    names = ("N32402 $MA_AX_JERK_MODE", "N32410 $MA_AX_JERK_TIME", "N32411 $MA_AX_JERK_TIME_ADD")
    assert [both[name][-2] for name in names] == ["4", "0.012\u202fs", "0.008\u202fs"]
    delays = [name for name in rows if "EQUIV" in name]
    assert delays == ["N32800 $MA_EQUIV_CURRCTRL_TIME[0]"]
    assert rows["N32620 $MA_FFW_MODE"][-2] == "4"
    assert "see MD10061" in rows["N10050 x N10060"][-1]
    assert rows["N32431 $MA_MAX_AX_JERK[0]"][-1].endswith("unit (?)")


def test_today_s_values_stand_beside_the_new_ones():
    today = '[today]\nacceleration = 2.5\njerk = 40\nposition_gain = "25 1/s"\n[control]'
    rows = _rows(_record("sinumerik", "[control]", today), "de")
    assert rows["N32300 $MA_MAX_AX_ACCEL[0]"][0] == "2,5\u202fm/s²"
    assert rows["N32200 $MA_POSCTRL_GAIN[0]"][0] == "1,5\u202f[1000/min]"
    assert rows["p1462"][0] == ""


def test_a_record_whose_profile_was_edited_says_why_there_are_no_rows():
    record = example_record()
    printed = print_html(record)
    assert "No values to type in here: " in printed
    assert "Requirements met, BUT INCOMPLETE" in printed


@pytest.mark.parametrize("kind", ["klipper", "marlin"])
def test_a_printer_has_one_acceleration_in_record_page_and_file(kind):
    """The axis of the model would take 50 m/s²: nobody types that, and nothing may promise it."""
    ran = run_of(CASES[kind])[0]
    record, export, words = to_entry(ran, Record), own_export(ran), Catalogue()
    best = record.limits.recommended
    name = {"klipper": "max_accel", "marlin": "M201 X"}[kind]
    typed = next(float(one.value) for one in export.entries if one.row.name == name)
    assert best.acceleration == pytest.approx(1e-3 * typed)
    assert best.acceleration <= 20.0
    assert export.verdict.settling_time == pytest.approx(best.settling_time, rel=1e-3)
    head = next(b for b in compose(ran, "en").sections[0].blocks if isinstance(b, Headline))
    assert head.values[0].value == "20\u202fm/s²"
    assert "a practical ceiling for printers, 20\u202fm/s² (assumed)" in words.say(best.bound_by)
    (said,) = [
        one for one in map(words.say, record.warnings) if "practical ceiling, assumed" in one
    ]
    assert ("No sample configuration of Klipper has more" in said) == (kind == "klipper")
    assert "CEILING" not in " ".join(export.header)


@pytest.mark.parametrize(("own", "kind"), [("marlin", "klipper"), ("klipper", "marlin")])
def test_another_printer_s_record_is_written_up_to_its_ceiling(own, kind):
    record = to_entry(_record(own, acceleration=50.3, jerk=2e5), Record)
    export = export_record(record, control=kind)
    assert export.limits.acceleration <= 20.0
    header = " ".join(export.header)
    assert "PRACTICAL CEILING, assumed: 20000 mm/s^2" in header


def test_marlin_gets_a_corner_that_it_takes():
    """M205 J below 0.01 mm is refused, and the old value stays (M200-M205.cpp)."""
    shaper = AVERAGE | {"kind": "marlin_zvd", "time": 0.0, "frequency_hz": 48.0,
                        "damping_ratio": 0.05}  # fmt: skip
    swift = {"acceleration": 50.3, "jerk": 2e5, "jerk_time": 2.5e-4, "setpoint_filter": shaper}
    rows = _rows(_record("marlin", **swift), "en")
    assert rows["M205 J"][0] == "0.01\u202fmm"
    narrow = _record("marlin", 'deviation = "20 um"', 'deviation = "0.5 um"', **swift)
    export = own_export(narrow)
    assert "M205 J" not in "".join(export.text.split("\n\n")[1])
    assert "refuses less than 0.01 mm" in " ".join(export.text.replace("\n; ", " ").split())
    assert re.search(r"^M205 X[\d.]+ .*\[mm/s\]", export.text, re.MULTILINE)
