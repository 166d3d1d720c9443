"""Record -> parameters of a control: what is typed in must do what the record promises."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from functools import cache
from math import isfinite, pi

import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.kinds import CONTROLS
from mtcommission.controls.syntax import LIST, _harmless
from mtcommission.export.catalogue import CONTROL_KEYS
from mtcommission.export.subject import build_subject
from mtcommission.export.write import export_record, read_text, write_body
from mtcommission.machine.machine import Machine
from mtcommission.machine.profile.read import parse_profile, profile_text_hash
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.exported import Export
from mtcommission.record.machine import ACCEPTED_DEFAULT
from mtcommission.record.record import Record, load_record
from mtcommission.record.shape import find_checksum, to_entry

from .second_reader import ini_file, lines, simulate_file
from .sheet_record import Json, on_json, run_of

export_record, build_subject = on_json(export_record), on_json(build_subject)

PAPER = read_shipped("milling-manipulator").text

CYCLES = 'position_cycle = "1 ms"\nvelocity_cycle = "125 us"\n'

ROTARY = f"""
schema = 1
[machine]
name = "Table *) ) # ; with marks"
axis = "C"
source = "illustrative numbers"
motion = "rotary"
[plant]
kind = "modal"
moving_mass = "8.3 kg m^2"
modes = [
    {{ name = "plate", frequency = "62 Hz", damping_ratio = 0.03, tcp_gain = "-0.12 1/(kg m^2)" }},
]
[drive]
force_lag = "1 ms"
max_force = "800 N m"
[[moves]]
velocity_step = "20 rev/min"
[requirements]
tcp_deviation = "5 arcsec"
move_sizes = "listed"
frequency_spread = "2 %"
damping_spread = "0 %"
[control]
position_loop = "interpolated"
{CYCLES}
"""

BELT = """
schema = 1
machine = { name = "Gantry with a belt", axis = "X", source = "illustrative numbers" }
[plant]
kind = "modal"
moving_mass = "420 kg"
[[plant.modes]]
name = "Säule"
frequency = "48 Hz"
damping_ratio = 0.03
tcp_gain = "-0.0011 1/kg"
measured_gain = "0.0004 1/kg"
[drive]
force_lag = "1 ms"
max_force = "6 kN"
lead = "20 mm"
gear = 2
[[moves]]
distance = "20 mm"
max_velocity = "0.4 m/s"
[requirements]
tcp_deviation = "20 um"
move_sizes = "listed"
frequency_spread = "2 %"
damping_spread = "0 %"
"""

FILTERED = f"""{BELT}
[today]
acceleration = "2 m/s^2"
jerk = "40 m/s^3"
position_gain = "25 1/s"
velocity_gain = "30 kN s/m"
integral_time = "30 ms"
[control]
position_loop = "drive"
setpoint_filter = {{ kind = "moving_average", time = "8 ms" }}
force_filters = [
    {{ kind = "notch", frequency = "310 Hz", damping = 0.2 }},
    {{ kind = "low_pass", frequency = "900 Hz", damping = 0.7 }},
]
{CYCLES}
"""
"""A rotary motor with screw and gear, filters of every kind, the position loop in the drive."""

LINEAR_MOTOR = (
    BELT.replace('lead = "20 mm"\ngear = 2\n', "")
    .replace("20 um", "5 um")
    .replace('frequency_spread = "2 %"', 'frequency_spread = "1 %"\npayload = ["0 kg", "10 kg"]')
)
"""No screw stated, the position loop in the control; a payload."""


# With every size the loop leans on state feedback so much that no other control can hold it.
# So it does where a shaper takes the vibration off the loop's hands.
LEANING = PAPER.replace("[requirements]\n", '[requirements]\nmove_sizes = "listed"\n').replace(
    'kind = "state-space"\n', 'kind = "state-space"\nsetpoint_filter = "none"\n'
)
CASES = {"paper": LEANING, "filtered": FILTERED, "linear_motor": LINEAR_MOTOR, "rotary": ROTARY}


def machine_of(name: str) -> Machine:
    return parse_profile(CASES[name], where="test.toml")


def record_of(name: str) -> Json:
    """A record, anew at each call."""
    return run_of(CASES[name])[0]


@cache
def exported(kind: str, control: str, *, as_list: bool = False) -> Export:
    """The text of a record as its run wrote it."""
    export: Export = export_record(record_of(kind), control=control, as_list=as_list)
    return export


SECOND = [
    *(("filtered", control) for control in CONTROL_KEYS),
    *(("rotary", control) for control in ("sinumerik", "heidenhain", "fanuc", "isg", "ros2")),
    *(("linear_motor", control) for control in ("sinumerik", "twincat", "linuxcnc", "generic")),
    *(("paper", control) for control in ("sinumerik", "klipper")),
]
"""Every syntax, and every way in which rows differ by the axis or the loop."""


@pytest.mark.parametrize(("kind", "control"), SECOND)
def test_a_second_program_gets_the_header_s_numbers_from_the_file(kind, control):
    """Else the header promises what the file does not contain: linear_motors break on that."""
    machine = machine_of(kind)
    export = exported(kind, control)
    promised, header = export.verdict, " ".join(export.header)
    settling, residual, saturates = simulate_file(control, export.text, machine)
    assert residual == pytest.approx(promised.residual_deviation, rel=5e-3)
    if isfinite(promised.settling_time):
        assert settling == pytest.approx(promised.settling_time, rel=5e-3)
        assert f"settling time {1e3 * promised.settling_time:.4g} ms, " in header
    assert ("all requirements met" in header) == export.meets_requirements
    if export.verdict.assessment.is_met:
        assert residual <= machine.requirements.tcp_deviation * 1.0001
        assert not saturates


@pytest.mark.parametrize("control", ["sinumerik", "isg", "twincat", "linuxcnc"])
@pytest.mark.parametrize("as_list", [False, True], ids=["text", "list"])
def test_every_row_is_read(control, as_list):
    """A row that changes nothing when its first digit changes is not simulated."""
    export = exported("filtered", control, as_list=as_list)
    layout = LIST if as_list else CONTROLS[control].layout
    rows = [entry.row for entry in export.entries]
    values = read_text(layout, rows, export.text, Catalogue())
    for number, entry in enumerate(export.entries):
        other = {"0": "1", "1": "2"}.get(entry.value[0], "1") + entry.value[1:]
        changed = [*export.entries]
        changed[number] = replace(entry, value=other)
        text = "\n".join(write_body(layout, changed, Catalogue()))
        assert other in text
        try:
            assert read_text(layout, rows, text, Catalogue()) != values, entry.row.name
        except InputError:
            continue  # refused: it was read, too


def test_what_the_control_lacks_is_neither_written_nor_simulated():
    """State feedback has no row, so its result may not stand in the header."""
    export = exported("paper", "sinumerik")
    header = " ".join(export.header)
    assert record_of("paper")["loop"]["state_feedback"]
    for said in ("LEFT OUT OR CHANGED", "too little margin", "state feedback"):
        assert said in header
    residual = record_of("paper")["limits"]["recommended"]["residual_deviation"]
    assert export.verdict.residual_deviation != pytest.approx(residual, rel=1e-2)
    assert not export.meets_requirements


def test_today_s_values_stand_in_the_old_column():
    """Who types the new ones in must see what they replace, in the same unit."""
    rows = {entry.row.name: entry for entry in exported("filtered", "sinumerik").entries}
    assert rows["N32300 $MA_MAX_AX_ACCEL[0]"].old == "2"
    assert rows["N32300 $MA_MAX_AX_ACCEL[2]"].old == ""
    assert rows["N32431 $MA_MAX_AX_JERK[0]"].old == "40"
    assert float(rows["N32200 $MA_POSCTRL_GAIN[0]"].old) == pytest.approx(1.5)
    assert float(rows["p1460"].old) == pytest.approx(30e3 * (0.01 / (2 * pi)) ** 2, rel=1e-3)
    assert rows["p1462"].old == "30"


@pytest.mark.parametrize("control", CONTROL_KEYS)
def test_header_says_what_an_export_must_say_in_letters_that_every_control_reads(control):
    """An umlaut or a µ in a comment stops some controls from reading the file."""
    record = record_of("filtered")
    export = exported("filtered", control)
    head = " ".join(re.sub(r"^[;#(*]+|\*\)$", "", line).strip() for line in export.text.split("\n"))
    for words in (
        record["created"],
        "mtcommission 0.",
        record["profile"]["sha256"],
        "VERIFY BEFORE USE",
        "not an acceptance test (ISO 230)",
        "Simulated from this text, read back row by row",
        "Judged for frequencies +- 2 %",
        "old",
    ):
        assert words in head
    record["warnings"] = [Message("assumption-linear"), "mode base: 50 Hz is *) a slip"]
    record["data"][3]["source"] = ACCEPTED_DEFAULT
    german = export_record(record, control=control, language="de")
    assert german.text.isascii()
    # Who types the numbers in may never have seen the sheet with its warnings.
    assert "WARNUNG: Die Achse ist linear: eine starre Masse" in " ".join(german.header)
    assert "WARNUNG: mode base: 50 Hz is *) a slip" in " ".join(german.header)
    assert record["data"][3]["key"] in " ".join(german.header)
    assert [entry.value for entry in german.entries] == [entry.value for entry in export.entries]
    # Names of our own are German; those of a control stay.
    own = r"(velocity|position) (cycle|loop)|(velocity|force) feed-forward|> force filters"
    assert re.search(own, export.text) is None or "reglertakt" in german.text
    assert not re.search(own, german.text)


def test_marks_in_a_name_stay_inside_their_comment():
    """The name holds an end of comment and other marks: none may open the fragment."""
    record = record_of("rotary")
    record["machine"]["name"] = "Table *) \n[TRAJ]\nMAX = 1\r\n$120=9 ; # ("
    assert "\n$120=9" not in export_record(record, control="grblhal").text
    ini = ini_file(export_record(record, control="linuxcnc").text)
    assert set(ini["TRAJ"]) == {"PLANNER_TYPE"}
    for line in export_record(record, control="twincat").text.splitlines():
        if line.startswith("(*"):
            assert line.count("*)") == 1
            assert line.endswith("*)")


def test_parameter_list_has_room_for_entered_and_verified():
    """The list says the same as the file, and holds today's values."""
    export = exported("filtered", "sinumerik", as_list=True)
    plain = exported("filtered", "sinumerik")
    assert export.header == plain.header
    rows = list(csv.DictReader(io.StringIO(export.text[export.text.index("section,") :])))
    assert [row["parameter"] for row in rows] == [entry.row.name for entry in plain.entries]
    assert [row["new_value"] for row in rows] == [entry.value for entry in plain.entries]
    assert [row["old_value"] for row in rows] == [entry.old for entry in plain.entries]
    assert all(row["entered"] == row["verified"] == "" for row in rows)


def test_machining_modes_get_their_own_columns():
    """Finishing must not get the limits of roughing."""
    text = exported("linear_motor", "sinumerik").text
    typed = lines(text, r"^N\d+ \$MA_(\w+\[\d\])=([0-9.]+) ")
    found = {name: float(value) for name, value in typed.items()}
    by_name = {mode["name"]: mode for mode in record_of("linear_motor")["limits"]["modes"]}
    for index, name in ((2, "speed"), (3, "accuracy"), (4, "surface")):
        assert found[f"MAX_AX_ACCEL[{index}]"] == pytest.approx(
            by_name[name]["acceleration"], rel=0.02
        )
        assert found[f"MAX_AX_ACCEL[{index}]"] <= by_name[name]["acceleration"] * (1.0 + 1e-9)
        assert found[f"MAX_AX_JERK[{index}]"] <= by_name[name]["jerk"] * (1.0 + 1e-9)
    assert len({by_name[name]["jerk"] for name in by_name}) > 1


@pytest.mark.parametrize("control", ["sinumerik", "heidenhain"])
def test_machining_mode_without_limits_is_left_out_and_said(control):
    """Finishing must not get limits that vibrate more than it allows, nor the exit code of
    success."""
    record = record_of("linear_motor")
    surface = next(mode for mode in record["limits"]["modes"] if mode["name"] == "surface")
    surface |= {"meets_requirements": False, "acceleration": None, "jerk": None}
    surface["attainable"] = 3.21e-6
    export = export_record(record, control=control)
    assert not export.meets_requirements
    header = " ".join(export.header)
    assert "BUT INCOMPLETE: no limits for machining mode Surface (finishing)" in header
    assert "machining mode Surface (finishing), 2 um (3.21 um could be met)" in header
    names = {entry.row.name for entry in export.entries}
    assert not names & {"N32300 $MA_MAX_AX_ACCEL[4]", "maxAcceleration, surface"}
    assert names & {"N32300 $MA_MAX_AX_ACCEL[3]", "maxAcceleration, accuracy"}


def test_without_a_jerk_limit_the_fallback_is_the_one_that_vibrates_least():
    """Full acceleration in one step is the worst that could be typed in."""
    record = record_of("rotary")
    text = record["profile"]["text"].replace('"5 arcsec"', '"0.0001 arcsec"')
    record["profile"] |= {"text": text, "sha256": profile_text_hash(text.encode())}
    export = export_record(record, control="fluidnc")
    assert not export.meets_requirements
    recommended = record["limits"]["recommended"]["acceleration"]
    assert export.limits.acceleration < 0.5 * recommended
    header = " ".join(export.header)
    share = 100.0 * export.limits.acceleration / recommended
    assert f"NO ACCELERATION MEETS THE REQUIREMENTS HERE: the value is the one of those tried, "\
        f"{share:.3g} % of the recommendation" in header  # fmt: skip
    assert "a rotary axis counts in degrees: the value is in deg/s^2" in header


def test_isg_gets_whole_numbers_and_comments_that_its_lists_know():
    """P-AXIS-00001 and its neighbours are unsigned integers; a comment line begins with #, and a
    blank opens a comment behind a value (Beckhoff TF5200, ASCII list files)."""
    record = record_of("rotary")
    record["limits"]["recommended"]["acceleration"] = 12.39 * pi / 180.0
    record["assessment"]["met"] = False
    for line in filter(None, export_record(record, control="isg").text.splitlines()):
        slope = r"getriebe\[0\]\.slope_profil\.\w+ +[1-9]\d* +\( .*"
        pattern = rf"# .*|{slope}|(?!.*slope_profil)[a-z][\w.\[\]]+ +[\w.]+ +\( .*"
        assert re.fullmatch(pattern, line), line
    assert "a_beschl  12 " in export_record(record, control="isg").text


def test_a_record_that_contradicts_itself_is_not_exported(tmp_path):
    """Limits judged in a loop that nobody computed would be wrong numbers."""
    record, path = record_of("paper"), tmp_path / "record.json"
    path.write_text(json.dumps(record, indent=3), "utf-8")
    assert load_record(path) == to_entry(record_of("paper"), Record)  # another layout is no edit
    record["loop"]["Kv"] *= 1.01
    with pytest.raises(InputError, match="not the one that its profile and gains give"):
        export_record(record, control="fanuc")
    path.write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputError, match="checksum"):
        load_record(path)


def test_axis_that_a_control_cannot_name_is_refused():
    record = record_of("paper")
    text = PAPER.replace('axis = "X"', 'axis = "Loader"')
    record["profile"] |= {"text": text, "sha256": profile_text_hash(text.encode())}
    with pytest.raises(InputError, match="--control generic"):
        export_record(record, control="klipper")
    assert "cLoader_Jerk" in export_record(record, control="plcopen").text


FILTERS_OF_KINDS = [
    ("sinumerik", 'kind = "two_moving_averages", time = "12 ms", second_time = "8 ms"'),
    ("klipper", 'kind = "ei", frequency = "48 Hz", damping = 0.03'),
    ("marlin", 'kind = "marlin_mzv", frequency = "48 Hz", damping = 0.03'),
]


@pytest.mark.parametrize(("control", "table"), FILTERS_OF_KINDS, ids=lambda value: value[:9])
def test_the_filter_of_a_run_is_written_and_does_what_the_run_promised(control, table):
    """Limits without their filter leave the band; another filter is another motion."""
    text = f'{BELT}[control]\nkind = "{control}"\nsetpoint_filter = {{ {table} }}\n'
    machine, record = parse_profile(text, where="test.toml"), run_of(text)[0]
    export, recommended = export_record(record, control=control), record["limits"]["recommended"]
    assert export.limits.setpoint_filter == machine.control.setpoint_filter
    assert "LEFT OUT" not in " ".join(export.header)
    assert export.verdict.settling_time == pytest.approx(recommended["settling_time"], rel=0.03)
    settling, residual, saturates = simulate_file(control, export.text, machine)
    assert settling == pytest.approx(export.verdict.settling_time, rel=5e-3)
    assert residual == pytest.approx(export.verdict.residual_deviation, rel=5e-3)
    assert not saturates
    other = "klipper" if control != "klipper" else "sinumerik"
    assert "setpoint filter" in " ".join(export_record(record, control=other).header)


def test_command_line_writes_a_file_and_tells_the_verdict_by_its_exit_code(tmp_path, run):
    record, out = tmp_path / "record.json", tmp_path / "axis.txt"
    record.write_text(json.dumps(record_of("linear_motor")), "utf-8")
    code, said, _ = run("export", record, "--control", "sinumerik", "-o", out)
    assert (code, said.replace("\n", "")) == (0, f"written: {out}")
    assert "\np1462=" in out.read_text("utf-8")
    missed = record_of("linear_motor")
    missed["limits"]["recommended"]["acceleration"] *= 30.0
    missed["assessment"]["met"] = False
    missed["checksum"] = find_checksum(missed)
    record.write_text(json.dumps(missed), "utf-8")
    code, said, error = run("export", record, "--control", "sinumerik", "-o", out)
    assert code == 1
    assert "REQUIREMENTS NOT MET: " in said.replace("\n", " ")
    assert not error
    _, listed, _ = run("export", "--control", "?")  # nobody has a record yet who asks this
    assert [line.split()[0] for line in listed.splitlines()] == list(CONTROL_KEYS)
    record.write_text("{}", "utf-8")
    for words, said in (
        (["--control", "isg"], "got no record"),
        ([record, "--control", "sinumerick"], 'did you mean "sinumerik"'),
        ([tmp_path / "none.json", "--control", "isg"], "no such file"),
        ([record, "--control", "isg"], "record.json"),
    ):
        code, _, error = run("export", *words)
        assert code == 2
        assert said in error


def test_no_cell_of_a_list_is_a_formula():
    assert [_harmless(cell) for cell in ("=1+1", "@x", "-1.5e3")] == ["'=1+1", "'@x", "-1.5e3"]
