"""Questions -> profile: as a new user types, in a pipe, with slips, and left half-way."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.commission import commission
from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.control_kinds.kinds import KINDS
from mtcommission.errors import InputError
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.languages import LANGUAGES
from mtcommission.messages.message import Message
from mtcommission.plant.manipulator import Manipulator
from mtcommission.plant.modal import Modal
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import parse_profile, profile_text_hash, read_profile
from mtcommission.record.build import build_record
from mtcommission.record.data import ACCEPTED_DEFAULT, list_data
from mtcommission.record.schema.record import Profile
from mtcommission.record.shape import to_plain
from mtcommission.wizard.axis_units import (
    MODAL,
    PAIR_BY_FREQUENCY,
    PAIR_BY_STIFFNESS,
    TOWER_BY_FREQUENCY,
    TOWERS,
    WAYS,
)
from mtcommission.wizard.console import LineConsole, RichConsole, fold, hint, introduce
from mtcommission.wizard.convert import (
    MOST_SHARE,
    couple,
    flatten,
    nest,
    share_out,
    to_answers,
    to_profile,
)
from mtcommission.wizard.document import update_document, write_document
from mtcommission.wizard.insight import find_insights
from mtcommission.wizard.question import Question, read_reply, title
from mtcommission.wizard.script import list_questions
from mtcommission.wizard.session import Ending, Session, run_wizard
from tests import identify_files as made

PROFILES = Path(__file__).parent.parent / "profiles"
ENGLISH = Catalogue("en")
SHIPPED = replace(read_profile(PROFILES / "milling-manipulator.toml"), assumed=())

PAPER = """\

Milling machine workpiece manipulator
X

Christiansen, Maurer, Zirn, Table 1; max_force: sec. 5.1


2 kN
2,5 ms


5
450
0.75 t
40 kg m^2
0,25
210 mm
44,41 N/µm
8500
8.2e6
1800
2
0.1 m/s

5 um





state-space










yes
52.2 ms
1.8858e15
1.0961e15
8.6070e10
2.8505e10
"""
"""What is typed for the paper's machine: Enter for defaults, decimal commas, other units."""

PAIR_TOML = """
"wizard.way" = "motor and load: masses and measured eigenfrequency"
[machine]
name = "Table"
[pair]
motor_mass = "2 kg"
load_mass = "6 kg"
frequency = "30 Hz"
[drive]
max_force = "100 N"
[[moves]]
distance = "20 mm"
[requirements]
tcp_deviation = "10 um"
"""


class Talk:
    """A scripted user: lines in, text out; a line may be an exception to raise."""

    def __init__(self, text: str, *, leaves_with: type[BaseException] | None = None) -> None:
        self.said = ""
        self.lines: Iterator[str] = iter(text.splitlines(keepends=True))
        self.leaves_with = leaves_with

    def read(self) -> str:
        line = next(self.lines, "")
        if not line and self.leaves_with is not None:
            raise self.leaves_with
        return line

    def write(self, text: str) -> None:
        self.said += text


def talk(
    output: Path,
    text: str,
    *,
    is_interactive: bool = False,
    leaves_with: type[BaseException] | None = None,
) -> tuple[Session, str]:
    user = Talk(text, leaves_with=leaves_with)
    console = LineConsole(read=user.read, write=user.write, is_interactive=is_interactive)
    session = run_wizard(
        output, console=console, answers_file=None, take_defaults=False, offers_run=True
    )
    return session, user.said


def from_answers(output: Path, text: str, *, take_defaults: bool = True, typed: str = "") -> str:
    file = output.with_suffix(".in")
    file.write_text(text, "utf-8")
    user = Talk(typed)
    console = LineConsole(read=user.read, write=user.write, is_interactive=False)
    run_wizard(
        output,
        console=console,
        answers_file=file,
        take_defaults=take_defaults,
        offers_run=False,
    )
    return user.said


def test_papers_machine_is_the_shipped_one(tmp_path: Path) -> None:
    """Then its sheet is the shipped one's, too: the computation sees nothing but the Machine."""
    session, said = talk(tmp_path / "paper.toml", PAPER)
    assert session.ending is Ending.WRITTEN
    assert replace(read_profile(tmp_path / "paper.toml"), assumed=()) == SHIPPED
    assert "mode base at 50 Hz, damping ratio 0.0301" in said
    assert "mode rotation at 72.06 Hz" in said
    assert "2.667 m/s^2 (2000 N on 750 kg)" in said
    # 2 kN statically on the base spring: 2000 / 44.41e6 m.
    assert "bends the tool by 45.03 um" in said
    typed = sum(len(line) for line in PAPER.splitlines())
    assert typed < 240  # two minutes at two characters a second
    assert list(tmp_path.iterdir()) == [tmp_path / "paper.toml"]


def test_papers_record_is_the_shipped_one(tmp_path: Path) -> None:
    """Number by number, as the sheet prints them; only sources and texts of the profile differ."""
    mine, shipped = tmp_path / "paper.toml", PROFILES / "milling-manipulator.toml"
    talk(mine, PAPER)
    numbers = []
    for path in (mine, shipped):
        found = commission(read_profile(path))
        profile = Profile(
            name="p", sha256=profile_text_hash(path.read_bytes()), text=path.read_text("utf-8")
        )
        record = build_record(found, profile=profile, created="2026-01-02", warnings=[])
        numbers.append(list(_numbers(to_plain(record))))
    assert numbers[0] == numbers[1]
    assert len(numbers[0]) > 20_000


def _numbers(value: object, path: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _numbers(item, f"{path}.{key}")
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _numbers(item, f"{path}.{i}")
    elif isinstance(value, int | float):
        yield path, value


def test_profile_is_commented_and_valid_toml(tmp_path: Path) -> None:
    talk(tmp_path / "paper.toml", PAPER)
    text = (tmp_path / "paper.toml").read_text("utf-8")
    assert 'base_stiffness = "44.41 N/µm"' in text
    assert "# Stiffness of the base" in text
    assert "(empty" not in text
    lines = [line for line in text.splitlines() if " = " in line and "kind" not in line]
    assert sum("#" in line for line in lines) >= len(lines) - 2


def test_measured_frequencies_give_stiffness_and_damping(tmp_path: Path) -> None:
    """k = m (2 pi f)^2 and d = 2 zeta m 2 pi f: else the profile has another machine's modes."""
    talk(
        tmp_path / "tower.toml",
        "\nTower\nX\n\n\n\n\n2 kN\n\n\n\n4\n450\n750\n40\n0.25\n0.21\n"
        "50 Hz\n3 %\n60 N/um\n72\n0,05\n\n1\n20 mm\n30 m/min\n\n\n5 um\n" + "\n" * 20,
    )
    machine = read_profile(tmp_path / "tower.toml")
    found = [(m.frequency_hz, m.damping_ratio) for m in machine.mechanics.modes]
    assert np.allclose(found, [(50.0, 0.03), (72.0, 0.05)], rtol=1e-9)
    text = (tmp_path / "tower.toml").read_text("utf-8")
    assert "#   base_frequency = 50 Hz" in text


def test_contradicting_values_are_pointed_at(tmp_path: Path) -> None:
    """60 N/um on 450 kg are 58.1 Hz, not 50 Hz."""
    answers = {
        "wizard.way": TOWER_BY_FREQUENCY,
        "plant.base_mass": "450 kg",
        "measured.base_frequency": "50 Hz",
        "measured.base_stiffness": "60 N/um",
    }
    (warning,) = [insight for insight in find_insights(answers) if insight.is_warning]
    assert "58.12 Hz, measured are 50 Hz" in ENGLISH.say(warning.text)
    answers["measured.base_stiffness"] = "44.41 N/um"
    assert not any(insight.is_warning for insight in find_insights(answers))


@given(m_1=st.floats(0.1, 100.0), ratio=st.floats(0.1, 10.0), f=st.floats(5.0, 200.0))
def test_two_masses_have_the_frequency_response_of_their_modal_form(
    m_1: float, ratio: float, f: float
) -> None:
    """Force to both positions: the springs' own equations of motion against the modal sum."""
    m_2, omega_a = ratio * m_1, 2.0 * pi * f
    k, d = m_2 * omega_a**2, 2.0 * 0.02 * m_2 * omega_a
    pair = couple(motor_mass=m_1, load_mass=m_2, stiffness=k, damping_ratio=0.02)
    for s in (1j * 0.3 * omega_a, 1j * 1.7 * omega_a, 1.0 + 2j):
        spring = k + d * s
        K = np.array([[m_1 * s**2 + spring, -spring], [-spring, m_2 * s**2 + spring]])
        x_1, x_2 = np.linalg.solve(K, [1.0, 0.0])
        omega = 2.0 * pi * pair.frequency_hz
        q = 1.0 / (s**2 + 2.0 * pair.damping_ratio * omega * s + omega**2)
        rigid = 1.0 / (pair.moving_mass * s**2)
        assert rigid + pair.measured_gain * q == pytest.approx(x_1, rel=1e-9)
        assert rigid + pair.tcp_gain * q == pytest.approx(x_2, rel=1e-6)


def test_pair_of_masses_from_a_file_of_answers(tmp_path: Path) -> None:
    from_answers(tmp_path / "pair.toml", PAIR_TOML)
    machine = read_profile(tmp_path / "pair.toml")
    (mode,) = machine.mechanics.modes
    assert mode.frequency_hz == pytest.approx(30.0 * sqrt(1.0 + 6.0 / 2.0))
    assert machine.requirements.frequency_spread == 0.05  # as a profile that leaves it out
    assert build_plant(machine).order == 5


def test_rotary_axis_is_asked_in_rotary_units(tmp_path: Path) -> None:
    _, said = talk(
        tmp_path / "table.toml",
        "\nTable\nC\nrotary\n\n\n\n800 N m\n\n420 N m\n\n2\n1.9\n6.4 kg m^2\n0.971e6\n\n\n"
        "1\n90°\n60 rpm\n0.5\n\n10 arcsec\n\n\n\n0.2\n" + "\n" * 20,
    )
    machine = read_profile(tmp_path / "table.toml")
    assert isinstance(machine.mechanics, Modal)
    assert machine.mechanics.moving_mass == pytest.approx(8.3)
    assert machine.moves[0].distance == pytest.approx(pi / 2.0)  # type: ignore[union-attr]
    assert machine.requirements.payload == (0.0, 0.2)
    assert "rad/s^2 (800 N m on 8.3 kg m^2)" in said
    assert "tower" not in said


def test_control_contour_and_todays_values_are_asked_in_turn(tmp_path: Path) -> None:
    """Each opens what belongs to it: a feed, a gear, a jerk where the control limits one."""
    path = tmp_path / "table.toml"
    begin = (
        "\nTable\nX\n\n\n\n10 mm\n2\n2 kN\n\n\n\n"
        "2\n20\n300\n20 N/um\n\n\n1\n20 mm\n\n\n\n5um\n\n\n\n\n"
    )
    talk(
        path,
        begin + "20 um\n2 m/min\nsinumerik\n\n\n\n0.1 um\n\n\n\n2\n40\n1 (m/min)/mm\n" + "\n" * 9,
    )
    machine = read_profile(path)
    assert machine.control.kind is KINDS["sinumerik"]
    assert (machine.drive.lead, machine.drive.gear) == (0.01, 2.0)
    assert machine.drive.encoder_resolution == 1e-7
    needs, today = machine.requirements, machine.today
    assert needs.contour_deviation == 20e-6
    assert needs.contour_feed == pytest.approx(1 / 30)
    assert today is not None
    assert (today.acceleration, today.jerk, today.integral_time) == (2.0, 40.0, None)
    assert today.position_gain == pytest.approx(1000 / 60)
    assert not machine.is_assumed("control.kind")
    keys = {q.key for q in list_questions({"today.acceleration": "2", "control.kind": "fluidnc"})}
    assert "today.jerk" not in keys
    assert "drive.gear" not in keys


def test_every_shipped_profile_survives_the_wizard(tmp_path: Path) -> None:
    """Opened again without changes, a profile keeps every byte."""
    for path in sorted(PROFILES.glob("*.toml")):
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes())
        talk(copy, "\n" * 80)
        assert copy.read_bytes() == path.read_bytes()


def test_an_accepted_default_is_nobodys_measurement(tmp_path: Path) -> None:
    """Else the sheet credits what nobody knows to the data sheet that the user named."""
    path = tmp_path / "p.toml"
    _, said = talk(path, PAPER)
    text, machine = path.read_text("utf-8"), read_profile(path)
    sources = {item.key: item.source for item in list_data(machine, build_plant(machine), text)}
    accepted = ("drive.static_load", "requirements.frequency_spread", "requirements.damping_spread")
    for key in accepted:
        assert sources[key] == ACCEPTED_DEFAULT
        assert key in " ".join(said.partition("Assumed, neither stated nor measured:")[2].split())
    assert sources["drive.force_lag"] == sources["plant.base_mass"] == machine.source
    assert sources["requirements.tcp_deviation"] == Message("source-stated")
    # Whoever types the default has stated it; whoever only goes past it has not.
    answers = "\n" * 10 + "0 N\n" + "\n" * 80
    talk(path, answers)
    changed = path.read_text("utf-8")
    (line,) = (line for line in changed.split("\n") if line not in text.split("\n"))
    assert line.startswith(
        'assumed = ["requirements.frequency_spread", "requirements.damping_spread", '
    )


def test_a_default_behind_a_derived_value_is_marked_there(tmp_path: Path) -> None:
    """The damping of the free pair is derived from the one that nobody measured."""
    from_answers(tmp_path / "pair.toml", PAIR_TOML)
    text = (tmp_path / "pair.toml").read_text("utf-8")
    assert "#   damping_ratio = 0.03 (default accepted, not measured)" in text
    assert 'damping_ratio = "0.06"' in text
    assumed = parse_profile(text, where="pair.toml").assumed
    assert "plant.modes[1].damping_ratio" in assumed
    assert "plant.modes[1].frequency" not in assumed


def test_what_was_only_accepted_is_known_after_a_break(tmp_path: Path) -> None:
    path = tmp_path / "p.toml"
    lines = PAPER.splitlines(keepends=True)
    with pytest.raises(InputError, match="answers kept"):
        talk(path, "".join(lines[:20]))
    talk(path, "".join(lines[20:]))
    assert "drive.static_load" in read_profile(path).assumed


def test_an_assumed_key_goes_when_its_value_is_stated(tmp_path: Path) -> None:
    """Windows line ends and all other lines stay; a table that was assumed falls into its keys."""
    path = tmp_path / "p.toml"
    text = (PROFILES / "modal-two-modes.toml").read_text("utf-8")
    text = text.replace("illustrative = true", 'illustrative = true\nassumed = ["drive"] # mine')
    path.write_text(text, "utf-8", newline="\r\n")
    before = path.read_bytes()
    talk(path, "\n" * 80)
    assert path.read_bytes() == before
    talk(path, "\n" * 8 + "3 ms\n" + "\n" * 80)
    after = path.read_bytes()
    assert b'force_lag = "3 ms"' in after
    assert b'assumed = ["drive.max_force", "drive.continuous_force"] # mine\r\n' in after
    assert len(set(before.split(b"\r\n")) ^ set(after.split(b"\r\n"))) == 4
    inline = re.sub(r"\[\[plant\.modes\]\][\s\S]*?(?=\n\[(?!\[plant))", "", text)
    mode = '{ name = "a", frequency = "40 Hz", tcp_gain = "0.001 1/kg" }'
    inline = inline.replace("[plant]\n", f"[plant]\nmodes = [{mode}]\n")
    path.write_text(inline, "utf-8")
    talk(path, "\n" * 80)
    machine = read_profile(path)
    assert machine.mechanics.modes[0].damping_ratio == 0.03  # type: ignore[union-attr]
    assert "plant.modes[1].damping_ratio" in machine.assumed


def test_changed_values_keep_the_users_comments(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text((PROFILES / "milling-manipulator.toml").read_text("utf-8"), "utf-8")
    talk(path, "\n\n\n\n\n\n\n4 kN\n" + "\n" * 80)
    text = path.read_text("utf-8")
    assert 'max_force = "4 kN"               # sec. 5.1; the mechanics allow up to 4 kN' in text
    assert "# h. The paper lists it, but uses it in no equation and gives no sign." in text
    assert read_profile(path).drive.max_force == 4000.0


def test_another_kind_of_mechanics_replaces_the_old_one() -> None:
    text = (PROFILES / "milling-manipulator.toml").read_text("utf-8")
    answers = to_answers(tomllib.loads(text))
    answers["wizard.way"] = PAIR_BY_STIFFNESS
    answers |= {
        "pair.motor_mass": "2 kg",
        "pair.load_mass": "6 kg",
        "pair.stiffness": "1 N/um",
        "pair.damping_ratio": "0.03",
    }
    del answers["damping_optimal.weights.x_b"], answers["damping_optimal.weights.phi"]
    del answers["damping_optimal.weights.v_b"], answers["damping_optimal.weights.v_phi"]
    changed = update_document(text, to_profile(answers))
    machine = parse_profile(changed, where="changed.toml")
    assert isinstance(machine.mechanics, Modal)
    assert "# The reference machine: every mechanical number" in changed


def test_back_help_and_slips(tmp_path: Path) -> None:
    _, said = talk(
        tmp_path / "m.toml",
        "\nA\nback\nB\nX\n?\nturning\nlinear\n<\nlinear\n\n\n\n2 km\n-5 N\n2 kN\n"
        + "\n" * 3
        + "3\n"
        "800\ncolumn\n40\n\n0.002\n\n\n1\n20 mm\n\n\n\n5um\n" + "\n" * 20,
    )
    assert read_profile(tmp_path / "m.toml").name == "B"
    assert 'got "2 km"' in said
    assert "choose one of: 1 linear, 2 rotary" in said
    assert "A rotary axis takes inertia for mass" in said
    assert "got -5 N, must be > 0 N" in said


def test_fault_of_the_whole_leads_back_to_its_question(tmp_path: Path) -> None:
    """A static load above the force is seen only when both are known."""
    begin = "\nA\nX\n\n\n\n\n2 kN\n\n\n3 kN\n3\n800\ncolumn\n40\n\n0.002\n\n\n1\n20 mm\n\n\n\n5um\n"
    _, said = talk(
        tmp_path / "m.toml", begin + "\n" * 15 + "1 kN\n" + "\n" * 40, is_interactive=True
    )
    assert "Not possible: drive.static_load" in said
    assert read_profile(tmp_path / "m.toml").drive.static_load == 1000.0


@pytest.mark.parametrize("count", range(0, PAPER.count("\n"), 3))
@pytest.mark.parametrize("leaves_with", [None, KeyboardInterrupt])
def test_leaving_at_any_point_keeps_the_answers_and_goes_on_from_there(
    count: int, leaves_with: type[BaseException] | None, tmp_path: Path
) -> None:
    path = tmp_path / "p.toml"
    lines = PAPER.splitlines(keepends=True)
    with pytest.raises(InputError, match=r"answers kept in .*p\.toml\.answers"):
        talk(path, "".join(lines[:count]), leaves_with=leaves_with)
    assert not path.exists()
    tomllib.loads((tmp_path / "p.toml.answers").read_text("utf-8"))
    talk(path, "".join(lines[count:]))
    assert replace(read_profile(path), assumed=()) == SHIPPED
    assert list(tmp_path.iterdir()) == [path]


def test_quit_keeps_the_answers(tmp_path: Path) -> None:
    session, said = talk(tmp_path / "p.toml", "\nA\nX\nq\n")
    assert session.ending is Ending.QUIT
    assert "answers kept in" in said
    kept = tomllib.loads((tmp_path / "p.toml.answers").read_text("utf-8"))
    assert kept == {
        "wizard.measured": "",
        "machine.name": "A",
        "machine.axis": "X",
        "wizard.place": "machine.motion",
    }


def test_missing_answers_are_named_all_at_once(tmp_path: Path) -> None:
    with pytest.raises(InputError) as raised:
        from_answers(tmp_path / "m.toml", '[machine]\nname = "A"\n')
    keys = {fault.key for fault in raised.value.faults}
    assert {"drive.max_force", "pair.motor_mass", "requirements.tcp_deviation"} <= keys
    assert not (tmp_path / "m.toml").exists()


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        (PAIR_TOML.replace("100 N", "100 m"), "which is a length"),
        (PAIR_TOML + '[control]\nposition_gian = "60 1/s"\n', 'did you mean "position_gain"'),
        (PAIR_TOML.replace('"30 Hz"', '"30 Hz'), "m.in:8: TOML syntax: .* stand in quotes"),
        (PAIR_TOML.replace("motor_mass", "motor"), 'did you mean "pair.motor_mass"'),
        (PAIR_TOML.replace("motor_mass", "#"), "pair.motor_mass: an answer is needed"),
        (PAIR_TOML.replace("[drive]", "[drive]\nmaxforce = 1"), 'did you mean "max_force"'),
        (PAIR_TOML.replace("[drive]", "[drives]"), 'did you mean "drive"'),
    ],
)
def test_wrong_answers_write_nothing(answers: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        from_answers(tmp_path / "m.toml", answers)
    assert not (tmp_path / "m.toml").exists()


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('max_force = "100 N"', 'max_force = "100 m"', "m.in:10: drive.max_force: got"),
        ('max_force = "100 N"', 'max_forse = "100 N"', "m.in:10: drive.max_forse: unknown key"),
        (
            'distance = "20 mm"',
            'distance = "20 mm"\n[[moves]]\ndistance = "2 furlong"',
            "m.in:14: moves[2].distance: got",
        ),
        # Seen only when both are known, by the reader of the whole profile.
        (
            'max_force = "100 N"',
            'max_force = "100 N"\nstatic_load = "200 N"',
            "m.in:11: drive.static_load: got",
        ),
    ],
)
def test_a_fault_in_the_answers_is_located_in_their_file(
    old: str, new: str, place: str, tmp_path: Path
) -> None:
    """The profile is not written: a line of it would lead nowhere."""
    with pytest.raises(InputError) as raised:
        from_answers(tmp_path / "m.toml", PAIR_TOML.replace(old, new))
    (fault,) = str(raised.value).splitlines()
    assert f"/{place}" in fault


def test_going_back_and_leaving_goes_on_from_there(tmp_path: Path) -> None:
    """Whoever went back to mend an answer must not be put behind it the next day."""
    path = tmp_path / "p.toml"
    session, _ = talk(path, "\nA\nX\n\nsheet 12\n\n\n2 kN\n<\n<\n<\n<\nq\n")
    assert session.ending is Ending.QUIT
    rest = PAPER.split("\n", 5)[5]
    _, said = talk(path, f"sheet 13\n{rest}")
    machine = read_profile(path)
    assert (machine.name, machine.source) == ("A", "sheet 13")
    assert said.index("Where the numbers come from [sheet 12]") < said.index("Largest force")


def test_a_broken_profile_is_mended_by_the_wizard(tmp_path: Path) -> None:
    """Opened with wrong values in it, the wizard asks; it must not fail on them."""
    path = tmp_path / "p.toml"
    text = (PROFILES / "milling-manipulator.toml").read_text("utf-8")
    path.write_text(text.replace('"450 kg"', '"450 m"').replace('"2 kN"', '"much"'), "utf-8")
    _, said = talk(path, "\n" * 7 + "2 kN\n" + "\n" * 4 + "450 kg\n" + "\n" * 60)
    assert replace(read_profile(path), assumed=()) == SHIPPED
    assert "mode base at 50 Hz" in said


def test_answers_may_hold_keys_that_are_not_asked(tmp_path: Path) -> None:
    extra = '[requirements.peaks]\ntcp = "50 mm"\n[[control.force_filters]]\nkind = "low_pass"\n'
    from_answers(tmp_path / "m.toml", PAIR_TOML + extra + 'frequency = "300 Hz"\ndamping = 0.7\n')
    machine = read_profile(tmp_path / "m.toml")
    assert machine.requirements.peaks[0].bound == 0.05
    assert machine.control.force_filters[0].damping == 0.7


@pytest.mark.parametrize(
    ("typed", "kept"),
    [
        ("450", "450 kg"),
        ("450 kg", "450 kg"),
        ("0.45 t", "0.45 t"),
        ("450,5kg", "450.5kg"),
        (" 4.5e2 ", "4.5e2 kg"),
    ],
)
def test_what_people_type_for_a_mass(typed: str, kept: str) -> None:
    question = next(
        q for q in list_questions({"wizard.way": TOWERS[0]}) if q.key == "plant.base_mass"
    )
    assert read_reply(question, typed).text == kept


@pytest.mark.parametrize(
    ("typed", "kept"), [("4 (m/min)/mm", "4 (m/min)/mm"), ("66,7", "66.7 1/s")]
)
def test_what_people_type_for_a_gain(typed: str, kept: str) -> None:
    question = next(q for q in list_questions({}) if q.key == "control.position_gain")
    assert read_reply(question, typed).text == kept


def test_units_unusual_for_the_place_are_warned_of() -> None:
    question = next(q for q in list_questions({}) if q.key == "drive.force_lag")
    assert not read_reply(question, "2.5 ms").warning
    warning = read_reply(question, "2.5").warning  # seconds
    assert warning is not None
    assert "is unusual" in ENGLISH.say(warning)


@pytest.mark.parametrize(
    ("key", "typed", "said"),
    [
        ("drive.max_force", "2000", "2000 N"),
        ("drive.max_force", "1,000 kN", "1.000 kN"),  # nobody shall enter a thousandth unawares
        ("moves.0.distance", "20", "20 m"),
        ("control.position_gain", "40", "40 1/s = 2.4 (m/min)/mm"),
        ("requirements.damping_spread", "0.3", "0.3 = 30 %"),
        ("drive.max_force", "2 kN", ""),
    ],
)
def test_a_number_without_a_unit_is_never_read_silently(key: str, typed: str, said: str) -> None:
    """20 for a distance is 20 m; Kv 40 is 40 1/s: who meant another unit must see it."""
    question = next(q for q in list_questions({}) if q.key == key)
    assert read_reply(question, typed).taken_as == said


def test_kv_in_metres_per_minute_without_the_unit_is_warned_of() -> None:
    """4 is the commonest Kv of a milling machine, in (m/min)/mm; 4 1/s is a seventeenth of it."""
    question = next(q for q in list_questions({}) if q.key == "control.position_gain")
    warning = read_reply(question, "4").warning
    assert warning is not None
    assert ENGLISH.say(warning).startswith("4 1/s is unusual; common are 6 1/s to")


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("5", 'got 5, which is 500 %; must be below 100 %; did you mean "5 %"?'),
        ("120 %", "got 120 %; must be below 100 %"),
    ],
)
def test_percent_without_its_sign_is_refused_at_its_own_question(typed: str, words: str) -> None:
    """Else the refusal comes after the last question, with the whole profile."""
    question = next(q for q in list_questions({}) if q.key == "requirements.frequency_spread")
    with pytest.raises(ValueError, match="below 100 %") as caught:
        read_reply(question, typed)
    assert str(caught.value) == words


def test_no_line_ends_between_a_number_and_its_unit() -> None:
    words = ("wide " * 14).strip()
    for quantity in ("1 N s/m", "100 MN s/m", "5 kg m^2", "30 %", "4 (m/min)/mm", "12 um"):
        for cut in range(len(words)):
            assert quantity in fold(f"{words[cut:]} {quantity} more.")


def _all_questions() -> list[tuple[Question, bool]]:
    """Every question, and whether it is asked of a rotary axis."""
    found = {}
    for motion in ("linear", "rotary"):
        for way in WAYS:
            answers = {"machine.motion": motion, "wizard.way": way, "wizard.experts": "yes",
                       "plant.modes.0.more": "yes", "moves.0.more": "yes",
                       "pair.further": "yes", "plant.moving_mass": "8",
                       "moves.0.kind": "acceleration to a velocity", "drive.lead": "10 mm",
                       "requirements.contour_deviation": "1 um", "control.kind": "state-space",
                       "today.acceleration": "1"}  # fmt: skip
            for question in list_questions(answers):
                found[(motion, question.key)] = (question, motion == "rotary")
    return list(found.values())


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_every_question_fits_a_terminal_and_tells_where_to_look(language: str) -> None:
    for question, is_rotary in _all_questions():
        words, default = Catalogue(language, rotary=is_rotary), question.default
        text = words.say(question.text)
        assert question.choices or len(f"{text}{hint(question, default, words)}: ") <= 79, text
        titles = [words.say(title(choice)) for choice in question.choices]
        for shown, choice in zip(titles, question.choices, strict=True):
            assert len(f"? {text} {shown}") <= 79, question.key
            assert read_reply(question, shown, titles=titles).text == choice
            assert read_reply(question, choice, titles=titles).text == choice
        assert words.say(question.where).endswith((".", "!")), question.key
        assert len(introduce(question, words)) <= 3 * 78
        if question.dimension is not None:
            assert question.default or question.example, question.key


def test_a_rotary_axis_is_never_sent_to_leads_and_gantries() -> None:
    """A table with a torque motor has no lead: whoever looks for one gives up, or guesses."""
    catalogue = Catalogue("en", rotary=True)
    for way in set(WAYS) - set(TOWERS):
        for question in list_questions({"machine.motion": "rotary", "wizard.way": way}):
            words = catalogue.say(question.text) + catalogue.say(question.where)
            for linear in ("lead", "screw", "gantry", "belt", "mass on", "weight of"):
                assert linear not in words.lower(), question.key


def test_the_wizard_speaks_german_and_writes_german_comments(tmp_path: Path) -> None:
    """German replies to choices count, and the profile is the same machine."""
    user = Talk(PAPER)
    console = LineConsole(read=user.read, write=user.write, is_interactive=False)
    run_wizard(
        tmp_path / "p.toml",
        console=console,
        answers_file=None,
        take_defaults=False,
        offers_run=True,
        language="de",
    )
    assert replace(read_profile(tmp_path / "p.toml"), assumed=()) == SHIPPED
    assert "# Steifigkeit des Gestells" in (tmp_path / "p.toml").read_text("utf-8")
    assert "Eigenform base bei 50 Hz, Dämpfungsgrad 0,0301" in user.said
    for english in ("Stiffness", "Mass of", "mode ", "Common", "At every"):
        assert english not in user.said


def test_every_default_and_example_is_accepted_without_warning() -> None:
    """An example that is refused teaches the wrong thing."""
    for question, _ in _all_questions():
        for text in filter(None, (question.default, question.example)):
            assert not read_reply(question, text).warning, question.key


NAMES = st.text("abcxyz_", min_size=1, max_size=6)
TREES = st.recursive(
    st.text(st.characters(blacklist_categories=["C"]), min_size=1, max_size=12),
    lambda inner: st.one_of(
        st.dictionaries(NAMES, inner, min_size=1, max_size=3),
        st.lists(inner, min_size=1, max_size=3),
    ),
    max_leaves=12,
)


@given(data=st.dictionaries(NAMES, TREES, max_size=4))
def test_nesting_reverses_flattening(data: dict[str, object]) -> None:
    assert nest(flatten(data)) == data


@settings(max_examples=50)
@given(
    name=st.text(st.characters(blacklist_categories=["C"]), min_size=1, max_size=40).filter(
        lambda text: text.strip()
    )
)
def test_any_name_survives_in_the_file(name: str) -> None:
    answers = {
        **to_answers(tomllib.loads((PROFILES / "modal-two-modes.toml").read_text("utf-8"))),
        "machine.name": name,
    }
    text = write_document(to_profile(answers), answers, ENGLISH)
    assert parse_profile(text, where="a.toml").name == name


@pytest.fixture
def command() -> list[str]:
    code = "import sys; sys.argv[0] = 'mtcommission'; from mtcommission.cli import main; main()"
    return [sys.executable, "-c", code, "wizard"]


def test_pipe_without_a_terminal(command: list[str], tmp_path: Path) -> None:
    """As a program would call it: no terminal, answers on standard input."""
    done = subprocess.run(
        [*command, "-o", tmp_path / "p.toml"],
        input=PAPER,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert isinstance(read_profile(tmp_path / "p.toml").mechanics, Manipulator)
    short = subprocess.run(
        [*command, "-o", tmp_path / "q.toml"],
        input=PAPER[:60],
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert short.returncode == 2
    assert "answers kept in" in short.stderr
    assert "Traceback" not in short.stdout + short.stderr
    assert not (tmp_path / "q.toml").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")
def test_real_terminal_with_questionary(command: list[str], tmp_path: Path) -> None:
    """On a terminal of 80 x 24: line editing, a choice by arrow key, Ctrl-C in between."""
    import fcntl
    import pty
    import struct
    import termios

    pid, terminal = pty.fork()
    if pid == 0:
        os.environ |= {"TERM": "xterm", "PYTHONPATH": str(PROFILES.parent)}
        os.chdir(tmp_path)
        os.execv(command[0], [*command, "-o", "p.toml"])
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    seen = b""

    def until(words: bytes) -> None:
        nonlocal seen
        begun = time.monotonic()
        while words not in seen:
            assert time.monotonic() - begun < 30.0, seen.decode(errors="replace")
            seen += os.read(terminal, 4096)
        seen = seen[seen.index(words) + len(words) :]

    until(b"Files with a measured response")
    os.write(terminal, b"\r")
    until(b"Name of the machine")
    os.write(terminal, b"Tablex\x7f\r")  # backspace takes the x away
    until(b"Name of the axis")
    os.write(terminal, b"C\r")
    until(b"Linear or rotary")
    os.write(terminal, b"\x1b[B\r")  # arrow down
    until(b"Where the numbers")
    os.write(terminal, b"\x03")
    rest = b""
    try:
        while piece := os.read(terminal, 4096):
            rest += piece
    except OSError:  # Linux reports the end of a pseudo-terminal as an error
        pass
    _, status = os.waitpid(pid, 0)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(status) == 130
    assert b"interrupted at machine.source" in rest
    assert b"Traceback" not in rest
    kept = tomllib.loads((tmp_path / "p.toml.answers").read_text("utf-8"))
    assert kept == {
        "wizard.measured": "",
        "machine.name": "Table",
        "machine.axis": "C",
        "machine.motion": "rotary",
        "wizard.place": "machine.source",
    }


def test_a_load_that_takes_all_of_the_force_is_said_at_once() -> None:
    """Else "at most -4 m/s^2" stands there as if it were a fact."""
    answers = {"drive.max_force": "2 kN", "drive.static_load": "5 kN"}
    (insight,) = find_insights(answers)
    assert insight.is_warning
    assert "leave -3000 N of the drive's force: the axis cannot move" in ENGLISH.say(insight.text)
    answers |= {"wizard.way": TOWERS[1], "plant.slider_mass": "750 kg", "plant.base_mass": "1 kg"}
    assert find_insights(answers) == (insight,)


def test_modal_kind_takes_several_modes(tmp_path: Path) -> None:
    talk(
        tmp_path / "m.toml",
        "\nA\nX\n\n\n\n\n2 kN\n\n\n\n3\n320\nbeam\n38\n\n1.9e-3\n0.7e-3\nyes\nram\n81\n"
        "\n-2.4e-3\n\n\n"
        "1\n20 mm\n\n2\n2\n0.1\n\n5um\n" + "\n" * 20,
    )
    machine = read_profile(tmp_path / "m.toml")
    assert [mode.name for mode in machine.mechanics.modes] == ["beam", "ram"]
    assert len(machine.moves) == 2
    data = tomllib.loads((tmp_path / "m.toml").read_text("utf-8"))
    assert to_answers(data)["wizard.way"] == MODAL


PAIR_ON_SCREW = {
    "wizard.way": PAIR_BY_FREQUENCY,
    "drive.lead": "10 mm",
    "pair.motor_mass": "3000 kg",
    "pair.load_mass": "900 kg",
    "pair.frequency": "41.5 Hz",
    "pair.damping_ratio": "0.03",
}


def test_what_engineers_have_most_often_is_offered_first() -> None:
    for motion in ("linear", "rotary"):
        questions = list_questions({"machine.motion": motion})
        way = next(question for question in questions if question.key == "wizard.way")
        assert way.choices[0] == way.default == PAIR_BY_FREQUENCY
        assert (way.choices[-2:] == TOWERS) is (motion == "linear")


@pytest.mark.parametrize("way", WAYS)
def test_the_lead_is_known_before_what_needs_it(way: str) -> None:
    keys = [question.key for question in list_questions({"wizard.way": way, "drive.lead": "1 mm"})]
    needing = [key for key in keys if key.startswith(("drive.max", "pair.", "plant.", "wizard.ro"))]
    assert keys.index("drive.lead") < keys.index("drive.gear") < keys.index(needing[0])


def test_values_at_the_motor_shaft_are_taken_for_those_at_the_axis(tmp_path: Path) -> None:
    """F = M r, m = J r^2 with r = 2 pi gear / lead: nobody has to turn them by hand."""
    typed = (
        "\nTable\nX\n\n\n\n10 mm\n2\n22,5 N m\n\n4 kN\n\n1\n0.0076 kg m^2\n900 kg\n41.5 Hz\n"
        "\n\n\n1\n20 mm\n\n\n\n5 um\n"
    )
    _, said = talk(tmp_path / "p.toml", typed + "\n" * 30)
    machine, r = read_profile(tmp_path / "p.toml"), 2.0 * pi * 2.0 / 0.01
    assert machine.drive.max_force == pytest.approx(22.5 * r, rel=1e-5)
    assert machine.drive.continuous_force == 4000.0
    assert machine.mechanics.moving_mass == pytest.approx(900.0 + 0.0076 * r**2, rel=1e-5)
    assert "taken as 12001.4 kg" in said
    assert "are 76 kg cm^2 at its shaft" in said
    # Without a lead, and on a rotary axis, an inertia is no mass and a torque no force.
    for answers in ({}, {"drive.lead": "10 mm", "machine.motion": "rotary"}):
        assert not any(question.motor_turn for question in list_questions(answers))


def test_a_rigid_mass_without_its_rotor_is_pointed_at() -> None:
    """900 kg on a screw whose rotor alone is 2467 kg: 15.6 m/s^2 would be shown in place of 4.2."""
    answers = {"wizard.way": MODAL, "drive.lead": "10 mm", "plant.moving_mass": "900 kg"}
    said = [ENGLISH.say(insight.text) for insight in find_insights(answers)]
    assert said == [
        "the 900 kg must contain the rotor: each kg cm^2 at the motor shaft is 39.48 kg at the axis"
    ]
    answers["wizard.rotor"] = "62.5 kg cm^2"
    (warning,) = find_insights(answers)
    assert warning.is_warning
    assert "are 2467 kg at the axis, more than the whole" in ENGLISH.say(warning.text)
    assert "the whole is 3367 kg" in ENGLISH.say(warning.text)
    answers["plant.moving_mass"] = "3400 kg"
    (insight,) = find_insights(answers)
    assert not insight.is_warning


def test_further_resonances_need_no_more_than_their_frequency(tmp_path: Path) -> None:
    """Motor, load and two frequencies: shares are derived, and all of them are assumed."""
    further = "[[pair.modes]]\nfrequency = '110 Hz'\n"
    from_answers(tmp_path / "p.toml", PAIR_TOML + further)
    machine = read_profile(tmp_path / "p.toml")
    first, second = machine.mechanics.modes
    assert (first.frequency_hz, second.frequency_hz) == pytest.approx((60.0, 110.0))
    assert second.damping_ratio == 0.03
    # The motor of 2 kg alone moves at first; at the tool no mode does less than 1/M.
    assert first.measured_gain + second.measured_gain == pytest.approx(1.0 / 2.0 - 1.0 / 8.0)
    assert first.tcp_gain == pytest.approx(-(110.0**2) / (110.0**2 - 60.0**2) / 8.0)
    assert second.tcp_gain == pytest.approx(1.0 / 8.0)
    for number in (1, 2):
        for key in ("tcp_gain", "measured_gain", "damping_ratio"):
            assert machine.is_assumed(f"plant.modes[{number}].{key}")
    assert not machine.is_assumed("plant.modes[2].frequency")
    # Of motor and load alone nothing but the damping is assumed.
    from_answers(tmp_path / "q.toml", PAIR_TOML)
    assert not read_profile(tmp_path / "q.toml").is_assumed("plant.modes[1].tcp_gain")


@given(
    parts=st.lists(st.floats(0.05, 10.0), min_size=3, max_size=5),
    springs=st.lists(st.floats(0.05, 10.0), min_size=4, max_size=4),
)
def test_no_chain_of_masses_does_more_at_the_tool_than_its_frequencies_tell(
    parts: list[float], springs: list[float]
) -> None:
    """From the eigenvalue problem of any chain, motor at one end, tool at the other."""
    count, total = len(parts), sum(parts)
    K = np.zeros((count, count))
    for i, k in enumerate(springs[: count - 1]):
        K[i : i + 2, i : i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    root = np.sqrt(parts)
    squares, vectors = np.linalg.eigh(K / np.outer(root, root))
    shapes = vectors / root[:, None]
    frequencies = np.sqrt(squares[1:])
    shares = share_out(frequencies.tolist(), motor_mass=parts[0], moving_mass=total)
    assert sum(seen for _, seen in shares) == pytest.approx(1.0 / parts[0] - 1.0 / total)
    assert all(seen > 0.0 for _, seen in shares)
    for (share, _), own in zip(shares, shapes[0, 1:] * shapes[-1, 1:], strict=True):
        assert np.sign(share) == np.sign(own)
        assert abs(share) >= min(abs(own), MOST_SHARE / total) * (1.0 - 1e-6)


def test_one_resonance_given_twice_is_pointed_at() -> None:
    """Whoever gives the peak of motor and load again would have it counted twice."""
    answers = PAIR_ON_SCREW | {
        "pair.further": "yes",
        "pair.modes.0.frequency": "47 Hz",
        "pair.modes.0.damping_ratio": "0.03",
    }
    (warning,) = [insight for insight in find_insights(answers) if insight.is_warning]
    assert "47.32 Hz and 47 Hz are less than 10 % apart" in ENGLISH.say(warning.text)
    answers["pair.modes.0.frequency"] = "110 Hz"
    assert not any(insight.is_warning for insight in find_insights(answers))


def test_what_a_rest_decides_is_said_at_its_question() -> None:
    """A triangle of 0.3 m with 3.6 of 14 kN: RMS over move and rest by hand."""
    answers = PAIR_ON_SCREW | {
        "drive.max_force": "14 kN",
        "drive.continuous_force": "4.7 kN",
        "moves.0.distance": "300 mm",
        "moves.0.max_velocity": "30 m/min",
    }
    assert not any(insight.text.kind == "insight-rest" for insight in find_insights(answers))
    (found,) = [
        insight.text
        for insight in find_insights(answers | {"moves.0.dwell": "0 s"})
        if insight.text.kind == "insight-rest"
    ]
    a, most = found.values["acceleration"], 14e3 / 3900.0
    enough = found.values["enough"]
    assert isinstance(a, float)
    assert isinstance(enough, float)
    for acceleration, rest in ((a, 0.0), (most, enough)):
        ramps = 2.0 * 0.5 / acceleration
        rms = 3900.0 * acceleration * sqrt(ramps / (0.3 / 0.5 + 0.5 / acceleration + rest))
        assert rms == pytest.approx(4.7e3, rel=1e-6)
    rested = answers | {"moves.0.dwell": f"{enough + 0.01} s"}
    assert not any(insight.text.kind == "insight-rest" for insight in find_insights(rested))


def test_the_place_of_the_position_loop_is_asked_where_there_is_a_choice(tmp_path: Path) -> None:
    """Who does not know it must see on the sheet that DSC was assumed."""
    path = tmp_path / "p.toml"
    from_answers(path, f"{PAIR_TOML}[control]\nkind = 'sinumerik'\n")
    machine = read_profile(path)
    assert machine.control.position_loop is PositionLoop.DRIVE
    assert machine.is_assumed("control.position_loop")
    loop = "[control]\nkind = 'sinumerik'\nposition_loop = 'control'\n"
    from_answers(path := tmp_path / "q.toml", PAIR_TOML + loop)
    machine = read_profile(path)
    assert machine.control.position_loop is PositionLoop.CONTROL
    assert not machine.is_assumed("control.position_loop")
    asked = {q.key for q in list_questions({"control.kind": "fanuc"})}
    assert "control.position_loop" not in asked


def test_a_rest_that_was_only_accepted_is_assumed(tmp_path: Path) -> None:
    path = tmp_path / "p.toml"
    hot = PAIR_TOML.replace("[drive]\n", "[drive]\ncontinuous_force = '40 N'\n")
    from_answers(path, hot)
    assert read_profile(path).is_assumed("moves[1].dwell")
    from_answers(
        path := tmp_path / "q.toml", hot.replace("[[moves]]\n", "[[moves]]\ndwell = '0 s'\n")
    )
    assert not read_profile(path).is_assumed("moves[1].dwell")


def test_a_mode_from_a_bode_plot_may_lack_its_share_at_the_tool(tmp_path: Path) -> None:
    bode = PAIR_TOML.replace('"motor and load: masses and measured eigenfrequency"', f'"{MODAL}"')
    bode += "[plant]\nmoving_mass = '800 kg'\n[[plant.modes]]\nname = 'a'\nfrequency = '40 Hz'\n"
    from_answers(tmp_path / "p.toml", bode)
    machine = read_profile(tmp_path / "p.toml")
    assert machine.mechanics.modes[0].tcp_gain == pytest.approx(-1.0 / 800.0)
    assert machine.is_assumed("plant.modes[1].tcp_gain")


def test_a_gear_is_no_percentage() -> None:
    gear = next(q for q in list_questions({"drive.lead": "10 mm"}) if q.key == "drive.gear")
    assert introduce(gear, ENGLISH).endswith("Common: 0.01 to 1000.")


@pytest.mark.parametrize("sign", ["<", "?", "q"])
def test_signs_act_in_a_list_of_choices(sign: str) -> None:
    """ "At every question: ? help, < back, q quit": a list that ignores them seems to hang."""
    from prompt_toolkit.application import create_app_session
    from prompt_toolkit.input import create_pipe_input
    from prompt_toolkit.output import DummyOutput

    plain = LineConsole(read=lambda: "", write=lambda _: None, is_interactive=True)
    question = next(question for question in list_questions({}) if question.choices)
    with create_pipe_input() as keys, create_app_session(input=keys, output=DummyOutput()):
        keys.send_text(f"{sign}\r")
        assert RichConsole(plain).ask(question, default="", words=ENGLISH) == sign


def test_measured_pair_shows_the_mode_as_soon_as_it_is_known() -> None:
    answers = {
        "wizard.way": PAIR_BY_FREQUENCY,
        "pair.motor_mass": "2 kg",
        "pair.load_mass": "6 kg",
        "pair.frequency": "30 Hz",
    }
    assert not find_insights(answers)
    answers["pair.damping_ratio"] = "0.03"
    first = ENGLISH.say(find_insights(answers)[0].text)
    assert first.startswith("mode drive (motor and load free) at 60 Hz")


def test_end_of_input_leaves_a_list_of_choices() -> None:
    """Else Ctrl-D, which ends every other question, seems to hang at this one."""
    from prompt_toolkit.application import create_app_session
    from prompt_toolkit.input import create_pipe_input
    from prompt_toolkit.output import DummyOutput

    plain = LineConsole(read=lambda: "", write=lambda _: None, is_interactive=True)
    question = next(question for question in list_questions({}) if question.choices)
    with create_pipe_input() as keys, create_app_session(input=keys, output=DummyOutput()):
        keys.send_text("\x04\r")  # Enter would take the first choice, were the key ignored
        with pytest.raises(EOFError):
            RichConsole(plain).ask(question, default="", words=ENGLISH)


def _response(path: Path) -> str:
    values = made.response(made.LINES)
    heads = ["frequency_hz", "re [m/s/N]", "im [m/s/N]"]
    path.write_bytes(made.table(heads, [made.LINES, values.real, values.imag]))
    return str(path)


def test_a_measured_response_answers_for_the_mechanics(tmp_path: Path) -> None:
    """Only the rest is asked, the share at the tool with its worst case; intervals stay."""
    file, path = _response(tmp_path / "e.csv"), tmp_path / "p.toml"
    typed = f"nothing.csv\n{file}@encoder\nMill\nX\n\n\n2 kN\n\n\n\n0.002\n\n\n20 mm\n\n\n\n5 um\n"
    session, said = talk(path, typed + "\n" * 30, is_interactive=True)
    assert session.ending is Ending.WRITTEN
    assert "nothing.csv" in said
    assert "2 modes" in said
    assert "Mass" not in said.partition("Name of the machine")[2].partition("Largest force")[0]
    machine, text = read_profile(path), path.read_text("utf-8")
    modes = machine.mechanics.modes
    assert [mode.frequency_hz for mode in modes] == pytest.approx([38.0, 117.0], rel=1e-3)
    assert (machine.name, modes[0].tcp_gain) == ("Mill", 0.002)
    assert machine.is_assumed("plant.modes[2].tcp_gain")
    assert not machine.is_assumed("plant.modes[1].tcp_gain")
    assert "# ± " in text
    assert "#   drive.max_force" not in text


@pytest.mark.parametrize("take_defaults", [True, False])
def test_answers_may_name_a_measured_response(tmp_path: Path, take_defaults: bool) -> None:
    file = _response(tmp_path / "e.csv")
    answers = f"""
wizard.measured = ["{file}"]
drive.max_force = "2 kN"
moves = [{{ distance = "20 mm" }}]
requirements.tcp_deviation = "5 um"
"""
    path = tmp_path / "p.toml"
    said = from_answers(path, answers, take_defaults=take_defaults, typed="\n" * 60)
    assert "2 modes" in said
    machine = read_profile(path)
    assert len(machine.mechanics.modes) == 2
    assert machine.drive.max_force == 2000.0
    assert machine.is_assumed("plant.modes[1].tcp_gain")
    assert machine.is_assumed("drive.force_lag")


def test_a_missing_measurement_in_the_answers_writes_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.csv"):
        from_answers(tmp_path / "p.toml", 'wizard.measured = ["none.csv"]')
    assert not (tmp_path / "p.toml").exists()


FOLLOWS_TOML = """
machine.name = "Printer"
drive.kind = "position_source"
drive.max_acceleration = "20 m/s^2"
plant.modes = [{ name = "belt", frequency = "45 Hz", damping_ratio = "0.05" }]
moves = [{ distance = "20 mm", max_velocity = "300 mm/s" }]
requirements.tcp_deviation = "20 um"
"""


def test_a_motor_that_simply_follows_is_asked_for_no_mass_and_no_loop(tmp_path: Path) -> None:
    """Else a printer gets a free-free frequency and a loop that it does not have."""
    from_answers(tmp_path / "p.toml", FOLLOWS_TOML)
    machine = read_profile(tmp_path / "p.toml")
    assert machine.drive.follows
    assert machine.mechanics.modes[0].frequency_hz == pytest.approx(45.0)
    assert machine.control.kind.key == "klipper"
    asked = [question.key for question in list_questions({"drive.kind": "position_source"})]
    for key in ("drive.max_force", "drive.force_lag", "plant.moving_mass", "wizard.way",
                "control.position_gain", "requirements.payload.1"):  # fmt: skip
        assert key not in asked
    told = [item.text.kind for item in find_insights(to_answers(tomllib.loads(FOLLOWS_TOML)))]
    assert "insight-deflection" not in told  # its share is a default nobody accepted yet
    assert "insight-mode-damped" in told
    asked_for = {q.key: q for q in list_questions({"drive.kind": "position_source"})}
    for language, held in (("en", "motor held"), ("de", "gehaltenem Motor")):
        words = Catalogue(language)
        assert held in words.say(asked_for["plant.modes.0.frequency"].where)
        for name in ("frequency", "tcp_gain", "more"):  # no force and no loop to speak of
            said = words.say(asked_for[f"plant.modes.0.{name}"].where)
            assert not re.search("force|loop|kg|Kraft|Regelkreis", said), said


@pytest.mark.parametrize("name", ["ball-screw", "honing-z"])
def test_a_profile_with_assumed_keys_is_a_file_of_answers(name: str, tmp_path: Path) -> None:
    """``wizard.accepted: unknown key`` was said of a key that the file does not have."""
    shipped = PROFILES / f"{name}.toml"
    from_answers(tmp_path / "m.toml", shipped.read_text("utf-8"))
    assumed = tomllib.loads(shipped.read_text("utf-8"))["machine"]["assumed"]
    assert set(assumed) <= set(read_profile(tmp_path / "m.toml").assumed)
