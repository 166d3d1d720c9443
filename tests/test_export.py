"""Record -> parameters of a control: what is typed in must do what the record promises."""

from __future__ import annotations

import configparser
import csv
import io
import json
import re
import subprocess
import sys
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from decimal import Decimal
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mtcommission.commission import Commissioning, commission
from mtcommission.errors import InputError
from mtcommission.export.catalogue import control_keys
from mtcommission.export.rounding import Coding, round_down, round_up, type_limits
from mtcommission.export.shaping import TypedShaper
from mtcommission.export.subject import Gains, build_subject, with_gains
from mtcommission.export.write import CONTROLS, export_record, parameter_list
from mtcommission.limits.choose import SearchSettings
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Motion, Positioning, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.plant.plant import dominant_mode
from mtcommission.profile.read import parse_profile, profile_text_hash
from mtcommission.record.build import build_record
from mtcommission.record.data import ACCEPTED_DEFAULT
from mtcommission.record.files import dump_json, find_checksum, load_record
from mtcommission.record.schema import Profile, Record
from mtcommission.record.shape import to_entry
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT, MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint, sample_setpoint
from mtcommission.study.settings import Settings
from mtcommission.study.shapers import shape_setpoint
from mtcommission.verdict.evaluate import evaluate

from .sheet_record import Json, on_json

export_record, build_subject = on_json(export_record), on_json(build_subject)

PAPER = (Path(__file__).parent.parent / "profiles" / "milling-manipulator.toml").read_text()

ROTARY = """
schema = 1
[machine]
name = "Table *) ) # ; with marks"
axis = "C"
source = "illustrative numbers"
motion = "rotary"
[plant]
kind = "modal"
moving_mass = "8.3 kg m^2"
[[plant.modes]]
name = "plate"
frequency = "62 Hz"
damping_ratio = 0.03
tcp_gain = "-0.12 1/(kg m^2)"
[drive]
force_lag = "1 ms"
max_force = "800 N m"
[[moves]]
velocity_step = "20 rev/min"
[requirements]
tcp_deviation = "5 arcsec"
frequency_spread = "2 %"
[control]
position_cycle = "1 ms"
velocity_cycle = "125 us"
state_feedback = "off"
"""

COARSE = SearchSettings(grid=24, coarse_grid=6, seeds=8, refinements=4)

MOST_SHARE_OF_RECOMMENDED = 1.0 + 1e-9
"""Rounding to the safe side: never above the recommendation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A commissioning and its record, as it comes back from a file."""

    found: Commissioning
    record: Json


def _case(text: str, folder: Path) -> Case:
    found = commission(
        parse_profile(text, where="test.toml"), settings=Settings(search=COARSE, comparison=COARSE)
    )
    profile = Profile(name="test.toml", sha256=profile_text_hash(text.encode()), text=text)
    record = build_record(found, profile=profile, created="2026-01-02T03:04:05+00:00", warnings=[])
    path = folder / "record.json"
    path.write_text(dump_json(record), "utf-8")
    return Case(found=found, record=json.loads(path.read_text("utf-8")))


@pytest.fixture(scope="module")
def paper(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return _case(PAPER, tmp_path_factory.mktemp("paper"))


@pytest.fixture(scope="module")
def rotary(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return _case(ROTARY, tmp_path_factory.mktemp("rotary"))


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadBack:
    """What a control would make of a file, in SI."""

    limits: MotionLimits
    Kv: float | None = None
    Kp: float | None = None
    Tn: float | None = None
    shaper: TypedShaper | None = None


def _ini(text: str) -> configparser.ConfigParser:
    parser = configparser.ConfigParser(interpolation=None, strict=True)
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    parser.read_string(text)
    return parser


def _cells(text: str) -> dict[str, float]:
    """The rows of a table for entry by hand, the part above the alternatives."""
    found = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) == 5 and not line.startswith("#") and cells[0] != "Parameter":
            found[cells[0]] = float(cells[1])
    return found


def _lines(text: str, pattern: str) -> dict[str, float]:
    return {m[1]: float(m[2]) for m in re.finditer(pattern, text, re.MULTILINE)}


def read_back(control: str, text: str, *, rotary: bool, cycle: float) -> ReadBack:
    """Read a file as the control would, with a parser of its format and units from its manual."""
    small, turn_or_m = (pi / 180.0, 2.0 * pi) if rotary else (1e-3, 1.0)
    degree_or_m = pi / 180.0 if rotary else 1.0
    a: float
    j: float
    gain, Kp, Tn, shaper = None, None, None, None
    match control:
        case "sinumerik":
            found = _lines(text, r"^N\d+ \$MA_(\w+\[\d\])=([0-9.]+) ")
            a = found["MAX_AX_ACCEL[0]"] * turn_or_m
            j = found["MAX_AX_JERK[0]"] * turn_or_m
            gain = found["POSCTRL_GAIN[0]"] * 16.0 * (1.0 + 1.0 / 24.0)  # 16.667
            drive = _lines(text, r"^(p\d+)=([0-9.]+) ")
            Kp, Tn = drive["p1460"], drive["p1462"] * 1e-3
        case "heidenhain":
            found = _cells(text)
            a, j = found["maxAcceleration"] * degree_or_m, found["axPathJerk"] * degree_or_m
            gain = found["kvFactor"]
        case "fanuc":
            found = _cells(text)
            rapid = re.search(r"if 1420 = ([0-9.]+) (mm|deg)/min", text)
            assert rapid is not None
            v = float(rapid[1]) * (pi / 180.0 if rapid[2] == "deg" else 1e-3) / 60.0
            a = v / (found["1620"] * 1e-3)
            j = a / (found["1774"] * 1e-3)
            gain = found["1825"] / 100.0
        case "isg":
            found = _lines(text, r"^getriebe\[0\]\.([\w.]+) +([0-9.]+) +\(")
            a = found["slope_profil.a_beschl"] * small
            j = a / (found["slope_profil.tr_beschl_zu"] * 1e-6)
            gain = found["kv"] / 100.0
        case "twincat" | "plcopen":
            found = _lines(text, r"^ +c[A-Z]_(\w+) : LREAL := ([0-9]+\.[0-9]+);")
            a, j = found["Acceleration"] * small, found["Jerk"] * small
            assert found["Deceleration"] == found["Acceleration"]
        case "generic":
            found = _cells(text)
            a, j, gain = found["acceleration"], found["jerk"], found["Kv"]
            Kp, Tn = found["Kp"], found["Tn"] * 1e-6
        case "linuxcnc":
            ini = _ini(text)
            joint = next(name for name in ini.sections() if name.startswith("JOINT_"))
            assert ini["TRAJ"]["PLANNER_TYPE"] == "1"
            a = float(ini[joint]["MAX_ACCELERATION"]) * small
            j = float(ini[joint]["MAX_JERK"]) * small
        case "grblhal":
            found = _lines(text, r"^\$(\d+)=([0-9.]+) ")
            (a_key, a_value), (j_key, j_value) = sorted(found.items())
            assert int(j_key) - int(a_key) == 680
            a, j = a_value * small, j_value * small
        case "fluidnc":
            (axis,) = yaml.safe_load(text)["axes"].values()
            a = axis["acceleration_mm_per_sec2"] * small
            j = a / cycle
        case "klipper":
            ini = _ini(text)
            a = float(ini["printer"]["max_accel"]) * 1e-3
            j = a / cycle
            part = ini["input_shaper"]
            order = {"zv": 1, "zvd": 2}[part["shaper_type_x"]]
            shaper = TypedShaper(
                order=order,
                frequency_hz=float(part["shaper_freq_x"]),
                damping_ratio=float(part["damping_ratio_x"]),
            )
        case "marlin":
            words = [dict(re.findall(r"([A-Z])(-?[0-9.]*)", line.split(";")[0]))
                     for line in text.splitlines() if line.startswith("M")]  # fmt: skip
            assert [word["M"] for word in words] == ["201", "493", "493"]
            assert words[1]["S"] == "1"
            a = float(words[0]["X"]) * 1e-3
            j = a / cycle
            shaper = TypedShaper(
                order=int(words[2]["C"]),
                frequency_hz=float(words[2]["A"]),
                damping_ratio=float(words[2]["I"]),
            )
        case "ros2":
            (joint_limits,) = yaml.safe_load(text)["joint_limits"].values()
            assert joint_limits["has_jerk_limits"] is True
            a, j = joint_limits["max_acceleration"], joint_limits["max_jerk"]
    limits = MotionLimits(acceleration=a, jerk=j)
    return ReadBack(limits=limits, Kv=gain, Kp=Kp, Tn=Tn, shaper=shaper)


def _loop(case: Case, found: ReadBack) -> TunedLoop:
    """The loop with the gains that were typed in; none of them on the unsafe side."""
    if found.Kv is None:
        return case.found.tuned
    run = case.found.tuned.controller
    typed = Gains(
        position=found.Kv,
        velocity=run.velocity_gain if found.Kp is None else found.Kp,
        integral_time=run.integral_time if found.Tn is None else found.Tn,
    )
    assert typed.position <= run.position_gain * MOST_SHARE_OF_RECOMMENDED
    assert typed.velocity <= run.velocity_gain * MOST_SHARE_OF_RECOMMENDED
    assert typed.integral_time * MOST_SHARE_OF_RECOMMENDED >= run.integral_time
    return with_gains(build_subject(case.record), typed).tuned


def _meets(case: Case, found: ReadBack) -> bool:
    """The judgement of the run, not that of the export."""
    tuned = _loop(case, found)
    if found.shaper is None:
        verdict = evaluate(case.found.machine, case.found.plant, tuned, found.limits)
        return verdict.assessment.is_met
    from mtcommission.loop.simulate.response import simulate
    from mtcommission.verdict.assess import assess

    machine = case.found.machine
    rows = []
    for move in machine.moves:
        setpoint = shape_setpoint(plan_setpoint(move, found.limits), found.shaper.impulses)
        rows.append(
            [
                simulate(loop, setpoint, drive=machine.drive,
                         band=machine.requirements.tcp_deviation)
                for loop in tuned.loops
            ]
        )  # fmt: skip
    return assess(machine, case.found.plant, tuned.corners, rows).is_met


@pytest.mark.parametrize("control", control_keys())
@pytest.mark.parametrize("kind", ["paper", "rotary"])
def test_round_trip_what_is_typed_in_meets_the_requirements(
    control: str, kind: str, request: pytest.FixtureRequest
) -> None:
    """Else the engineer types in numbers whose vibration nobody looked at."""
    case: Case = request.getfixturevalue(kind)
    is_rotary = case.found.machine.motion is Motion.ROTARY
    if is_rotary and control in ("klipper", "marlin"):
        with pytest.raises(InputError, match="linear axes only"):
            export_record(case.record, control=control)
        return
    export = export_record(case.record, control=control)
    cycle = case.found.machine.control.position_cycle
    found = read_back(control, export.text, rotary=is_rotary, cycle=cycle)
    recommended = case.record["limits"]["recommended"]
    assert found.limits.acceleration <= recommended["acceleration"] * MOST_SHARE_OF_RECOMMENDED
    if control not in ("fluidnc", "klipper", "marlin"):
        assert found.limits.jerk <= recommended["jerk"] * MOST_SHARE_OF_RECOMMENDED
        assert found.limits.acceleration >= 0.9 * recommended["acceleration"]
        assert found.limits.jerk >= 0.8 * recommended["jerk"]
    assert found.limits.acceleration == pytest.approx(export.limits.acceleration, rel=1e-9)
    assert found.limits.jerk == pytest.approx(export.limits.jerk, rel=1e-9)
    assert export.meets_requirements
    assert _meets(case, found)


@pytest.mark.parametrize("control", control_keys())
def test_header_says_what_an_export_must_say(control: str, paper: Case) -> None:
    export = export_record(paper.record, control=control)
    head = " ".join(re.sub(r"^[;#(*]+|\*\)$", "", line).strip() for line in export.text.split("\n"))
    for words in (
        "2026-01-02T03:04:05",
        "mtcommission 0.",
        paper.record["profile"]["sha256"],
        "VERIFY BEFORE USE",
        "not an acceptance test (ISO 230)",
        "all requirements met",
        "check against the list manual of your software version",
        "old",
    ):
        assert words in head


@pytest.mark.parametrize(
    ("control", "names"),
    [
        (
            "sinumerik",
            {"N32431 $MA_MAX_AX_JERK[0]", "N32610 $MA_VELO_FFW_WEIGHT[0]", "p1462", "p1460"},
        ),
        ("isg", set()),
        ("fanuc", {"1825"}),
        ("marlin", {"M493 X C"}),
        ("linuxcnc", set()),
    ],
)
def test_only_names_that_nobody_read_are_marked(control: str, names: set[str], paper: Case) -> None:
    """A mark on everything is a mark on nothing."""
    blocks = export_record(paper.record, control=control).blocks
    marked = {entry.name for entry in blocks[0].entries if not entry.is_verified}
    assert {re.sub(r"JERK\[\d\]", "JERK[0]", name) for name in marked} == names


def test_rotary_axes_are_written_in_degrees_or_turns(rotary: Case) -> None:
    a = rotary.record["limits"]["recommended"]["acceleration"]
    degrees = yaml.safe_load(export_record(rotary.record, control="fluidnc").text)
    assert degrees["axes"]["c"]["acceleration_mm_per_sec2"] <= a * 180.0 / pi
    text = export_record(rotary.record, control="sinumerik").text
    assert "[rev/s^2]" in text
    assert "[m/s^2]" not in text


def test_marks_in_a_name_stay_inside_their_comment(rotary: Case) -> None:
    """The name holds an end of comment and other marks: none may open the fragment."""
    record = deepcopy(rotary.record)
    record["machine"]["name"] = "Table *) \n[TRAJ]\nMAX = 1\r\n$120=9 ; # ("
    assert "\n$120=9" not in export_record(record, control="grblhal").text
    ini = _ini(export_record(record, control="linuxcnc").text)
    assert set(ini["TRAJ"]) == {"PLANNER_TYPE"}
    for line in export_record(record, control="twincat").text.splitlines():
        if line.startswith("(*"):
            assert line.count("*)") == 1
            assert line.endswith("*)")


def test_parameter_list_has_room_for_old_entered_and_verified(paper: Case) -> None:
    export = export_record(paper.record, control="sinumerik")
    text = parameter_list(export)
    head = [line for line in text.splitlines() if line.startswith("# ")]
    assert len(head) == len(export.header)
    rows = list(csv.DictReader(io.StringIO(text[text.index("section,") :])))
    assert len(rows) == sum(len(block.entries) for block in export.blocks)
    for row in rows:
        assert row["old_value"] == row["entered"] == row["verified"] == ""
        assert float(row["new_value"]) > 0.0
    assert rows[0]["parameter"] == "N32300 $MA_MAX_AX_ACCEL[0]"


def test_machining_modes_get_their_own_columns(paper: Case) -> None:
    """Finishing must not get the limits of roughing."""
    text = export_record(paper.record, control="sinumerik").text
    found = _lines(text, r"^N\d+ \$MA_(\w+\[\d\])=([0-9.]+) ")
    by_name = {mode["name"]: mode for mode in paper.record["limits"]["modes"]}
    for index, name in ((2, "speed"), (3, "accuracy"), (4, "surface")):
        assert found[f"MAX_AX_ACCEL[{index}]"] == pytest.approx(
            by_name[name]["acceleration"], rel=0.02
        )
        assert found[f"MAX_AX_ACCEL[{index}]"] <= by_name[name]["acceleration"] * (1.0 + 1e-9)
        assert found[f"MAX_AX_JERK[{index}]"] <= by_name[name]["jerk"] * (1.0 + 1e-9)
    assert len({by_name[name]["jerk"] for name in by_name}) > 1


@pytest.mark.parametrize("control", ["sinumerik", "heidenhain"])
def test_machining_mode_without_limits_is_left_out_and_said(control: str, paper: Case) -> None:
    """Finishing must not get limits that vibrate more than it allows, nor the exit code of
    success."""
    record = deepcopy(paper.record)
    surface = next(mode for mode in record["limits"]["modes"] if mode["name"] == "surface")
    surface |= {"meets_requirements": False, "acceleration": None, "jerk": None}
    surface["attainable"] = 3.21e-6
    export = export_record(record, control=control)
    assert not export.meets_requirements
    header = " ".join(export.header)
    assert "REQUIREMENTS NOT MET: no limits for machining mode surface" in header
    flat = re.sub(r"\n[;#] ", " ", export.text)
    if control == "sinumerik":
        assert "DYNFINISH IS LEFT OUT: no limits keep the tool within the band" in flat
        assert "MAX_AX_ACCEL[3]" in export.text
        assert "[4]" not in export.text
    else:
        (block,) = [
            block
            for block in export.blocks
            if block.title == Message("heidenhain-mode", mode=Message("export-mode-surface"))
        ]
        assert not block.entries
        assert "LEFT OUT: no limits keep the tool within the band" in flat
    assert "machining mode surface, 2 um (3.21 um could be met)" in flat


def test_without_a_jerk_limit_the_fallback_is_the_one_that_vibrates_least(rotary: Case) -> None:
    """Full acceleration in one step is the worst that could be typed in."""
    record = deepcopy(rotary.record)
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


@pytest.mark.parametrize("control", control_keys())
def test_rotary_headers_speak_of_angles_in_the_control_s_own_unit(
    control: str, rotary: Case
) -> None:
    """Degrees in the values and radians in the verdict invite a slip by 57."""
    if control in ("klipper", "marlin"):
        return
    header = " ".join(export_record(rotary.record, control=control).header)
    si = control in ("ros2", "generic")
    assert bool(re.search(r"residual deviation [0-9.]+ urad", header)) == si
    assert bool(re.search(r"residual deviation [0-9.]+ deg", header)) == (not si)


def test_fanuc_rise_time_keeps_the_acceleration_at_another_rapid_traverse(rotary: Case) -> None:
    """What the note tells to enter for twice the rapid traverse must be the same deg/s^2."""
    export = export_record(rotary.record, control="fanuc")
    header = " ".join(export.header)
    found = re.search(
        r"1620 = (\d+) ms x 1420 / ([0-9.]+), .* acceleration stays ([0-9.]+) deg/s\^2", header
    )
    assert found is not None
    rise, rapid, a = (float(text) for text in found.groups())
    entered = rise * (2.0 * rapid) / rapid * 1e-3
    assert 2.0 * rapid / 60.0 / entered == pytest.approx(a, rel=1e-3)


def test_isg_gets_whole_numbers_and_comments_that_its_lists_know(rotary: Case) -> None:
    """P-AXIS-00001 and its neighbours are unsigned integers; a comment line begins with #, and a
    blank opens a comment behind a value (Beckhoff TF5200, ASCII list files)."""
    record = deepcopy(rotary.record)
    record["limits"]["recommended"]["acceleration"] = 12.39 * pi / 180.0
    record["assessment"]["met"] = False
    for line in filter(None, export_record(record, control="isg").text.splitlines()):
        assert re.fullmatch(r"# .*|getriebe\[0\]\.[\w.]+ +[1-9]\d* +\( .*", line), line
    assert "a_beschl  12 " in export_record(record, control="isg").text


def test_jerk_filter_of_the_control_is_offered_instead_of_the_jerk_limit(rotary: Case) -> None:
    """The moving average must be at least the ramp, in whole position cycles, and be switched on
    only in comments."""
    record = deepcopy(rotary.record)
    recommended = record["limits"]["recommended"]
    recommended["jerk"] = recommended["acceleration"] / 9.4e-3
    record["assessment"]["met"] = False  # so the pair is taken as it stands
    export = export_record(record, control="sinumerik")
    block = next(
        block for block in export.blocks if block.title == Message("sinumerik-jerk-filter")
    )
    values = {entry.name: float(entry.value) for entry in block.entries}
    time = values["N32410 $MA_AX_JERK_TIME"]
    assert values["N32402 $MA_AX_JERK_MODE"] == 2.0
    assert time >= export.limits.jerk_time * (1.0 - 1e-9)
    assert time - export.limits.jerk_time < 1e-3
    assert time / 1e-3 == pytest.approx(round(time / 1e-3), abs=1e-9)
    assert not re.search(r"^N32(400|402|410)", export.text, re.MULTILINE)
    # A moving average over a trapezoid of velocity is the jerk-limited profile itself.
    (move,) = rotary.found.machine.moves
    a = export.limits.acceleration
    limited = plan_setpoint(move, MotionLimits(acceleration=a, jerk=a / time))
    filtered = plan_setpoint(
        move, MotionLimits(acceleration=a, jerk=a / NO_JERK_LIMIT), moving_average=time
    )
    t = np.linspace(0.0, limited.duration, 101)
    a_limited, a_filtered = (sample_setpoint(s, t)[:, 2] for s in (limited, filtered))
    assert np.max(np.abs(a_limited - a_filtered)) < 2e-3 * a


def test_record_with_another_gain_than_its_loop_is_refused(paper: Case) -> None:
    """Limits judged in a loop that was never computed would be a wrong number."""
    record = deepcopy(paper.record)
    record["loop"]["Kv"] *= 1.01
    with pytest.raises(InputError, match="not the one that its profile and gains give"):
        export_record(record, control="fanuc")


def test_edited_profile_is_not_exported_under_the_old_hash(paper: Case) -> None:
    """The hash in the header would vouch for numbers that nobody computed."""
    record = deepcopy(paper.record)
    record["profile"]["text"] += "# just a remark\n"
    with pytest.raises(InputError, match=r"profile\.text: the profile in this record was edited"):
        export_record(record, control="fanuc")


@pytest.mark.parametrize(
    "edit",
    [
        lambda record: record["limits"]["recommended"].update(jerk=1e3),
        lambda record: record["limits"]["modes"][0].update(acceleration="much"),
        lambda record: record["machine"].update(name="Another machine"),
        lambda record: record["assessment"].update(met=[]),
        lambda record: record["profile"].update(sha256="0" * 64),
        lambda record: record.update(moves=None),
        lambda record: record.update(added=1),
        lambda record: record.pop("checksum"),
    ],
)
def test_edited_record_is_refused(
    edit: Callable[[Any], object], paper: Case, tmp_path: Path
) -> None:
    """Numbers changed by hand after the run would be printed as computed ones."""
    record = json.loads(json.dumps(paper.record))
    path = tmp_path / "record.json"
    path.write_text(json.dumps(record, indent=3), "utf-8")
    assert load_record(path) == to_entry(paper.record, Record)  # another layout is no edit
    edit(record)
    path.write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputError, match="checksum"):
        load_record(path)


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda record: record.update(moves=None), "moves: got null, expected an array"),
        (
            lambda record: record["limits"]["modes"][0].update(acceleration="much"),
            "limits.modes[1].acceleration: got 'much', expected a number or null",
        ),
        (lambda record: record["assessment"].update(met=[]), "got an array, expected true or"),
        (lambda record: record["plant"].pop("A"), "plant.A: missing"),
        (lambda record: record["loop"].update(Kv=float("nan")), "NaN is no number of JSON"),
        (lambda record: record.update(schema=1), "earlier version, this one reads 2; run the"),
        (lambda record: record["tool"].update(name="other"), "or damaged; change the profile"),
    ],
)
def test_a_damaged_record_names_what_was_expected(
    edit: Callable[[Any], object], words: str, paper: Case, tmp_path: Path
) -> None:
    record = json.loads(json.dumps(paper.record))
    edit(record)
    path = tmp_path / "record.json"
    path.write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputError, match=re.escape(words)):
        load_record(path)


def test_a_record_of_another_version_is_refused_by_name(paper: Case, tmp_path: Path) -> None:
    """Its checksum is right, and yet a number that is needed would be missing half-way."""
    record = json.loads(json.dumps(paper.record))
    del record["loop"]["Kv"]
    record["checksum"] = find_checksum(record)
    path = tmp_path / "record.json"
    path.write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputError, match=r"another version of mtcommission wrote it; loop\.Kv"):
        load_record(path)


def test_limits_that_miss_a_requirement_say_so(paper: Case) -> None:
    record = deepcopy(paper.record)
    record["limits"]["recommended"]["jerk"] *= 3.0
    record["assessment"]["met"] = False
    export = export_record(record, control="linuxcnc")
    assert not export.meets_requirements
    assert "REQUIREMENTS NOT MET: residual deviation" in " ".join(export.header)


def test_neighbours_are_tried_where_the_nearest_pair_misses(paper: Case) -> None:
    """With jerk in steps of a fifth the nearest pair vibrates; a pair that does not is found."""
    subject = build_subject(paper.record)
    coding = Coding(acceleration_unit=1.0, jerk_unit=1.0)
    raised = replace(subject, limits=replace(subject.limits, jerk=1.015 * subject.limits.jerk))
    nearest = evaluate(
        subject.machine,
        subject.plant,
        subject.tuned,
        MotionLimits(
            acceleration=subject.limits.acceleration,
            jerk=float(round_down(raised.limits.jerk)),
        ),
    )
    assert not nearest.assessment.is_met
    typed = type_limits(raised, coding)
    assert typed.verdict.assessment.is_met


@pytest.mark.parametrize("control", ["sinumerik", "klipper", "twincat"])
def test_doubts_of_the_run_reach_the_file(control: str, paper: Case) -> None:
    """Who types the numbers in may never have seen the sheet with its warnings."""
    record = deepcopy(paper.record)
    record["warnings"] = ["mode base: 50 Hz is *) a slip"]
    record["data"][3]["source"] = ACCEPTED_DEFAULT
    header = " ".join(export_record(record, control=control).header)
    assert "WARNING: mode base: 50 Hz is *) a slip" in header
    assert f"Default accepted, not measured: {record['data'][3]['key']}." in header
    text = export_record(paper.record, control=control).text
    assert "accepted, not measured" not in text


def test_unknown_control_is_refused_with_a_proposal(paper: Case) -> None:
    with pytest.raises(InputError, match="did you mean sinumerik"):
        export_record(paper.record, control="sinumerick")


def test_axis_that_a_control_cannot_name_is_refused(paper: Case) -> None:
    record = deepcopy(paper.record)
    text = PAPER.replace('axis = "X"', 'axis = "Loader"')
    record["profile"] |= {"text": text, "sha256": profile_text_hash(text.encode())}
    with pytest.raises(InputError, match="--control generic"):
        export_record(record, control="klipper")
    assert "cLoader_Jerk" in export_record(record, control="plcopen").text


@given(
    value=st.floats(min_value=1e-6, max_value=1e9),
    digits=st.integers(min_value=2, max_value=6),
)
def test_rounding_down_never_exceeds_and_stays_close(value: float, digits: int) -> None:
    rounded = round_down(value, digits=digits)
    assert rounded <= Decimal(value) * (1 + Decimal("2e-9"))
    assert rounded >= Decimal(value) * (1 - Decimal(10) ** (1 - digits))
    assert len(rounded.normalize().as_tuple().digits) <= digits


@given(value=st.floats(min_value=1e-3, max_value=1e6), step=st.integers(1, 50))
def test_rounding_up_gives_the_next_whole_multiple(value: float, step: int) -> None:
    rounded = round_up(value, step=step)
    assert rounded % step == 0
    assert rounded >= value * (1.0 - 2e-9)
    assert rounded - step < value


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("damping", [0.0, 0.03, 0.2])
def test_shapers_cancel_their_mode(order: int, damping: float) -> None:
    """Singer & Seering's condition: the sum of the impulse responses of the mode vanishes, for
    ZVD with its derivative by frequency."""
    shaper = TypedShaper(order=order, frequency_hz=40.0, damping_ratio=damping).impulses
    times, amplitudes = np.array(shaper.times), np.array(shaper.amplitudes)

    def left(frequency_hz: float) -> complex:
        omega = 2.0 * pi * frequency_hz
        p = complex(-damping * omega, omega * np.sqrt(1.0 - damping**2))
        return complex(np.sum(amplitudes * np.exp(-p * times)))

    assert amplitudes.sum() == pytest.approx(1.0)
    assert abs(left(40.0)) < 1e-12
    slope = abs(left(40.001) - left(39.999)) / 0.002
    assert (slope < 1e-6) == (order == 2)


@pytest.mark.parametrize("move", [VelocityStep(velocity_step=0.1), Positioning(distance=0.01)])
def test_a_shaped_setpoint_arrives_where_the_move_ends(move: VelocityStep | Positioning) -> None:
    plain = plan_setpoint(move, MotionLimits(acceleration=2.0, jerk=200.0))
    typed = TypedShaper(order=2, frequency_hz=50.0, damping_ratio=0.03)
    shaped = shape_setpoint(plain, typed.impulses)
    assert shaped.duration == pytest.approx(plain.duration + 0.02 / np.sqrt(1.0 - 0.03**2))
    before_end = shaped.duration - 1e-9
    x, v, a, _ = sample_setpoint(shaped, np.array([before_end]))[0]
    if isinstance(move, Positioning):
        assert x == pytest.approx(move.distance, abs=1e-9)
        assert v == pytest.approx(0.0, abs=1e-6)
    else:
        assert v == pytest.approx(move.velocity_step, abs=1e-6)
    assert a == pytest.approx(0.0, abs=1e-5)


def test_rebuilt_loop_is_the_one_of_the_run(paper: Case, rotary: Case) -> None:
    """The export judges in this loop: it must answer as the run's did, in every corner."""
    for case in (paper, rotary):
        subject = build_subject(case.record)
        assert dominant_mode(subject.plant).name == dominant_mode(case.found.plant).name
        for mine, theirs in zip(subject.tuned.loops, case.found.tuned.loops, strict=True):
            for name in ("A", "C"):
                again, first = getattr(mine.lifted, name), getattr(theirs.lifted, name)
                assert np.allclose(again, first, rtol=0.0, atol=1e-9 * np.max(np.abs(first)))


def test_command_line_writes_a_file_and_tells_the_verdict_by_its_exit_code(
    paper: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from mtcommission import cli

    record = tmp_path / "record.json"
    record.write_text(json.dumps(paper.record), "utf-8")

    def run(*arguments: str | Path) -> int:
        monkeypatch.setattr("sys.argv", ["mtcommission", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        return int(stopped.value.code or 0)

    out = tmp_path / "axis.ini"
    assert run("export", record, "--control", "linuxcnc", "-o", out) == 0
    assert "MAX_JERK" in _ini(out.read_text("utf-8"))["JOINT_0"]
    capsys.readouterr()
    assert run("export", "--control", "?") == 0  # nobody has a record yet who asks this
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == list(control_keys())
    assert run("export", "--control", "isg") == 2
    assert "got no record" in capsys.readouterr().err
    assert run("export", record, "--control", "nothing") == 2
    assert run("export", tmp_path / "none.json", "--control", "isg") == 2
    record.write_text("{}", "utf-8")
    assert run("export", record, "--control", "isg") == 2
    assert "Traceback" not in capsys.readouterr().err


def test_the_list_of_controls_comes_without_the_libraries_of_the_loop() -> None:
    """Else who asks for a name waits seconds for it, and longer on an old laptop."""
    code = (
        "import sys\nfrom mtcommission import cli\n"
        "sys.argv=['mtcommission','export','--control','?']\n"
        "try:\n    cli.main()\nexcept SystemExit:\n    pass\n"
        "heavy={'numpy','scipy','casadi','control','ruckig','typst'}\n"
        "sys.exit(', '.join(sorted(heavy & set(sys.modules))) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "klipper" in done.stdout


def test_every_listed_control_can_be_exported() -> None:
    """If not, a listed name would end in an internal error, or a control would stay hidden."""
    assert set(control_keys()) == set(CONTROLS)


@pytest.mark.parametrize("control", control_keys())
def test_a_file_in_german_has_letters_that_every_control_reads(control: str, paper: Case) -> None:
    """An umlaut or a µ in a comment stops some controls from reading the file."""
    record = deepcopy(paper.record)
    record["warnings"] = [Message("assumption-linear"), Message("assumption-static-load")]
    english, german = (
        export_record(record, control=control, language=code) for code in ("en", "de")
    )
    assert german.text.isascii()
    assert "WARNUNG: Die Achse ist linear: eine starre Masse" in " ".join(german.header)
    assert [entry.value for block in german.blocks for entry in block.entries] == [
        entry.value for block in english.blocks for entry in block.entries
    ]
