"""Questions -> profile: as a new user types, in a pipe, with slips, and left half-way."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mtcommission.base.errors import InputError, Refused
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.profile.read import parse_profile, read_profile
from mtcommission.machine.profile.shipped import read_shipped, shipped_names
from mtcommission.wizard.answers import (
    MODAL,
    PAIR_BY_FREQUENCY,
    PAIR_BY_STIFFNESS,
    PAIRS,
    TOWER,
    flatten,
    to_answers,
    to_profile,
)
from mtcommission.wizard.files import update_document
from mtcommission.wizard.question import Question, read_reply, title
from mtcommission.wizard.script import find_question, list_questions, list_settled
from mtcommission.wizard.session import Console, Ending, find_insights, run_wizard
from tests import identify_files as made

THIN = "\N{NARROW NO-BREAK SPACE}"
ENGLISH = Catalogue("en")
WAYS = (*PAIRS, MODAL, TOWER)


def mechanical(machine: Machine) -> Machine:
    """What the wizard asks for: not the paper's weights, nor what was assumed."""
    plain = read_shipped("modal-two-modes").machine.damping_optimal
    return replace(machine, assumed=(), damping_optimal=plain)


SHIPPED = mechanical(read_shipped("milling-manipulator").machine)

PAPER = """\
Milling machine workpiece manipulator
X



2 kN

4
450
0.75 t
40 kg m^2
0,25
210 mm
44,41 N/µm
8500
8.2e6
1800
0.1 m/s

5 um
state-space
control.state_feedback
auto
drive.force_lag
2,5 ms
machine.source
Christiansen, Maurer, Zirn, Table 1; max_force: sec. 5.1

"""
"""What is typed for the paper's machine: Enter for defaults, decimal commas, other units."""

SERVO = """\
Table
X


10 mm
14 kN


3000 kg
900 kg
41.5 Hz
300 mm
30 m/min

5 um
sinumerik

"""
"""A servo axis whose frequencies were measured."""

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

PAIR_ON_SCREW = {
    "wizard.way": PAIR_BY_FREQUENCY,
    "drive.lead": "10 mm",
    "pair.motor_mass": "3000 kg",
    "pair.load_mass": "900 kg",
    "pair.frequency": "41.5 Hz",
    "pair.damping_ratio": "0.03",
}


class Talk:
    """A scripted user: lines in, text out; who has no more to say leaves."""

    def __init__(self, text: str) -> None:
        self.said = ""
        self.lines: Iterator[str] = iter(text.splitlines())

    def read(self, prompt: str) -> str:
        self.said += prompt
        for line in self.lines:
            return line
        raise EOFError

    def write(self, text: str) -> None:
        self.said += text


def talk(
    output: Path, text: str, *, is_interactive: bool = False, **other: Any
) -> tuple[Ending, str]:
    user = Talk(text)
    console = Console(read=user.read, write=user.write, is_interactive=is_interactive)
    options = {"answers_file": None, "take_defaults": False, "offers_run": True} | other
    return run_wizard(output, console=console, **options), user.said


def from_answers(output: Path, text: str, *, take_defaults: bool = True, typed: str = "") -> str:
    file = output.with_suffix(".in")
    file.write_text(text, "utf-8")
    options = {"answers_file": file, "take_defaults": take_defaults, "offers_run": False}
    return talk(output, typed, **options)[1]


def said_of(answers: dict[str, str]) -> list[str]:
    return [ENGLISH.say(one) for one in find_insights(answers)]


# What is asked


def test_papers_machine_is_the_shipped_one(tmp_path):
    """Then its sheet is the shipped one's, too: the computation sees nothing but the Machine."""
    ending, said = talk(tmp_path / "paper.toml", PAPER)
    assert ending is Ending.WRITTEN
    machine = read_profile(tmp_path / "paper.toml")
    assert mechanical(machine) == SHIPPED
    assert not machine.is_assumed("drive.force_lag")
    said = said.replace(THIN, " ")
    assert "mode base at 50 Hz, damping ratio 0.0301" in said
    assert "mode rotation at 72.06 Hz" in said
    assert "2.667 m/s² (2 kN on 750 kg)" in said
    # 2 kN statically on the base spring: 2000 / 44.41e6 m.
    assert "bends the tool by 45.03 µm" in said
    text = (tmp_path / "paper.toml").read_text("utf-8")
    assert 'base_stiffness = "44.41 N/µm"' in text
    assert "# Base stiffness" in text
    assert list(tmp_path.iterdir()) == [tmp_path / "paper.toml"]


def test_a_servo_axis_takes_twenty_questions(tmp_path):
    """Else a colleague without the paper gives up."""
    path = tmp_path / "p.toml"
    ending, said = talk(path, SERVO)
    assert ending is Ending.WRITTEN
    assert SERVO.count("\n") <= 20
    machine = read_profile(path)
    assert [round(mode.frequency_hz, 1) for mode in machine.mechanics.modes] == [47.3]
    for key in ("drive.force_lag", "plant.modes[1].damping_ratio",
                "requirements.frequency_spread", "drive.static_load"):  # fmt: skip
        assert machine.is_assumed(key), key
    for key in ("frequency", "tcp_gain"):
        assert not machine.is_assumed(f"plant.modes[1].{key}")
    assert "Damping ratio of the load against the held motor: 0.03 (assumed)" in said


def test_an_identified_profile_takes_ten_questions(tmp_path):
    identified = tmp_path / "q.toml"
    values = made.response(made.LINES)
    heads = ["frequency_hz", "re [m/s/N]", "im [m/s/N]"]
    (tmp_path / "e.csv").write_bytes(made.table(heads, [made.LINES, values.real, values.imag]))
    command = [sys.executable, "-m", "mtcommission", "identify", tmp_path / "e.csv"]
    subprocess.run([*command, "-o", identified], check=True, capture_output=True)
    rest = "10 mm\n2 kN\n\n20 mm\n30 m/min\n\n5 um\n\n\n"
    assert rest.count("\n") <= 10
    assert talk(identified, rest)[0] is Ending.WRITTEN
    assert read_profile(identified).is_assumed("plant.modes[1].tcp_gain")
    assert "# ± " in identified.read_text("utf-8")


def test_what_is_settled_can_be_changed_by_number_and_by_any_key(tmp_path):
    path = tmp_path / "p.toml"
    begin = SERVO.removesuffix("\n")
    _, said = talk(path, f"{begin}no such key\n3\n3 ms\ncontrol.minimum_bandwidth\n15\n<\n\n\n")
    assert "  3  Time constant of the force loop T: 2 ms (assumed)" in said
    assert 'got "no such key"' in said
    machine = read_profile(path)
    assert machine.control.minimum_bandwidth_hz == 15.0
    # Whoever types a value has stated it; whoever only goes past it has not.
    assert machine.drive.force_lag == 3e-3
    assert not machine.is_assumed("drive.force_lag")


@given(m_1=st.floats(0.1, 100.0), ratio=st.floats(0.1, 10.0), f=st.floats(5.0, 200.0))
def test_two_masses_have_the_frequency_response_of_their_modal_form(m_1, ratio, f):
    """Force to both positions: the springs' own equations of motion against the modal sum."""
    m_2, omega_a = ratio * m_1, 2.0 * pi * f
    k, d = m_2 * omega_a**2, 2.0 * 0.02 * m_2 * omega_a
    masses = {"pair.motor_mass": f"{m_1} kg", "pair.load_mass": f"{m_2} kg"}
    spring = {"pair.stiffness": f"{k} N/m", "pair.damping_ratio": "0.02"}
    flat = flatten(to_profile({"wizard.way": PAIR_BY_STIFFNESS, **masses, **spring}, {}))
    mass, frequency, zeta, tool, seen = (
        float(flat[f"plant.{key}"].split()[0])
        for key in ("moving_mass", *(f"modes.0.{name}" for name in OF_MODE))
    )
    for s in (1j * 0.3 * omega_a, 1j * 1.7 * omega_a, 1.0 + 2j):
        coupling = k + d * s
        K = np.array([[m_1 * s**2 + coupling, -coupling], [-coupling, m_2 * s**2 + coupling]])
        x_1, x_2 = np.linalg.solve(K, [1.0, 0.0])
        omega = 2.0 * pi * frequency
        q = 1.0 / (s**2 + 2.0 * zeta * omega * s + omega**2)
        rigid = 1.0 / (mass * s**2)
        assert rigid + seen * q == pytest.approx(x_1, rel=1e-6)
        assert rigid + tool * q == pytest.approx(x_2, rel=1e-6)


OF_MODE = ("frequency", "damping_ratio", "tcp_gain", "measured_gain")


def test_rotary_axis_is_asked_in_rotary_units(tmp_path):
    _, said = talk(
        tmp_path / "table.toml",
        "Table\nC\nrotary\n\n800 N m\n420 N m\n2\n1.9\n6.4 kg m^2\n0.971e6\n"
        "90°\n60 rpm\n\n10 arcsec\n\nrequirements.payload.1\n0.2\nmoves.0.dwell\n0.5\n\n",
    )
    machine = read_profile(tmp_path / "table.toml")
    assert isinstance(machine.mechanics, Modal)
    assert machine.mechanics.moving_mass == pytest.approx(8.3)
    assert machine.moves[0].distance == pytest.approx(pi / 2.0)  # type: ignore[union-attr]
    assert machine.moves[0].dwell == 0.5
    assert machine.requirements.payload == (0.0, 0.2)
    assert "°/s² (800 N·m on 8.3 kg·m²)" in said.replace(THIN, " ")
    assert "tower" not in said


def test_values_at_the_motor_shaft_are_taken_for_those_at_the_axis(tmp_path):
    """F = M r, m = J r^2 with r = 2 pi / lead: nobody has to turn them by hand."""
    mechanics = "1\n0.0076 kg m^2\n900 kg\n41.5 Hz\n"
    typed = f"Table\nX\n\n\n10 mm\n22,5 N m\n4 kN\n{mechanics}20 mm\n\n\n5um\n\n\n"
    _, said = talk(tmp_path / "p.toml", typed)
    machine, r = read_profile(tmp_path / "p.toml"), 2.0 * pi / 0.01
    assert machine.drive.max_force == pytest.approx(22.5 * r, rel=1e-5)
    assert machine.drive.continuous_force == 4000.0
    assert machine.mechanics.moving_mass == pytest.approx(900.0 + 0.0076 * r**2, rel=1e-5)
    assert "taken as 3000.36 kg" in said


def test_modal_kind_takes_several_modes_and_several_moves(tmp_path):
    talk(
        tmp_path / "m.toml",
        "A\nX\n\n\n\n2 kN\n\n3\n320\n38\n81\n\n20 mm\n\n0.1 m/s\n\n5um\n\n"
        "plant.modes.1.tcp_gain\n-2.4e-3\n\n",
    )
    machine = read_profile(tmp_path / "m.toml")
    assert [mode.name for mode in machine.mechanics.modes] == ["mode1", "mode2"]
    assert [mode.tcp_gain for mode in machine.mechanics.modes] == [-0.003125, -2.4e-3]
    assert machine.is_assumed("plant.modes[1].tcp_gain")
    assert not machine.is_assumed("plant.modes[2].tcp_gain")
    assert len(machine.moves) == 2
    data = tomllib.loads((tmp_path / "m.toml").read_text("utf-8"))
    assert to_answers(data)["wizard.way"] == MODAL


FOLLOWS_TOML = """
machine.name = "Printer"
drive.kind = "position_source"
drive.max_acceleration = "20 m/s^2"
plant.modes = [{ name = "belt", frequency = "45 Hz", damping_ratio = "0.05" }]
moves = [{ distance = "20 mm", max_velocity = "300 mm/s" }]
requirements.tcp_deviation = "20 um"
"""


def test_an_open_loop_axis_is_asked_for_no_mass_and_no_loop(tmp_path):
    """Else a printer gets a free-free frequency and a loop that it does not have."""
    said = from_answers(tmp_path / "p.toml", FOLLOWS_TOML)
    machine = read_profile(tmp_path / "p.toml")
    assert machine.drive.follows
    assert machine.mechanics.modes[0].frequency_hz == pytest.approx(45.0)
    assert machine.control.kind.key == "klipper"
    assert machine.is_assumed("control.kind")
    assert "at full acceleration" in said
    asked = {one.key for one in asked_of({"drive.kind": "position_source"})}
    for key in ("drive.max_force", "drive.force_lag", "plant.moving_mass", "wizard.way",
                "control.position_gain", "requirements.payload.1"):  # fmt: skip
        assert key not in asked


# What follows from the answers


def test_what_would_mislead_is_said_at_once():
    """A load that takes all of the force, a mass that lacks its rotor."""
    told = said_of(PAIR_ON_SCREW | {"drive.max_force": "2 kN", "drive.static_load": "5 kN"})
    assert any(
        f"leave −3{THIN}kN of the drive's force: the axis cannot move" in one for one in told
    )
    assert not any("at most" in one for one in told)
    # 900 kg on a screw whose rotor alone is 2467 kg: 15.6 m/s^2 would be shown in place of 4.2.
    answers = {"wizard.way": MODAL, "drive.lead": "10 mm", "plant.moving_mass": "900 kg",
               "plant.modes.0.frequency": "40 Hz"}  # fmt: skip
    told = said_of(answers)
    rotor = f"must contain the rotor: each kg·cm² at the motor shaft is 39.48{THIN}kg"
    assert any(rotor in x for x in told)


# Answers from files, and what is assumed


def test_what_answers_put_in_place_of_an_edited_profile_is_said(tmp_path):
    """Else a value that somebody mended in the profile is lost at the next call, in silence."""
    said = from_answers(tmp_path / "m.toml", PAIR_TOML)
    assert "replaces" not in said
    profile = tmp_path / "m.toml"
    profile.write_text(profile.read_text("utf-8").replace("100 N", "80 N"), "utf-8")
    said = " ".join(from_answers(profile, PAIR_TOML).split())
    assert "m.in replaces what was stated before: drive.max_force 80 N → 100 N written:" in said


def test_missing_answers_are_named_all_at_once(tmp_path):
    with pytest.raises(InputError) as raised:
        from_answers(tmp_path / "m.toml", '[machine]\nname = "A"\n')
    keys = {fault.key for fault in raised.value.faults}
    assert {"drive.max_force", "pair.motor_mass", "requirements.tcp_deviation"} <= keys
    assert not (tmp_path / "m.toml").exists()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"100 N"', '"100 m"', "m.in:10: drive.max_force: got"),
        ('"20 mm"', '"20 mm"\n[[moves]]\ndistance = "2 km h"', "m.in:14: moves[2].distance: got"),
        # Seen only when both are known, by the reader of the whole profile.
        ('"100 N"', '"100 N"\nstatic_load = "200 N"', "m.in:11: drive.static_load: got"),
        ("max_force =", "maxforce =", 'did you mean "drive.max_force"'),
        ('"30 Hz"', '"30 Hz', "m.in:8: no TOML: "),
        ("motor_mass", "motor", 'did you mean "pair.motor_mass"'),
    ],
)
def test_wrong_answers_write_nothing_and_are_located_in_their_file(old, new, said, tmp_path):
    """The profile is not written: a line of it would lead nowhere."""
    with pytest.raises(InputError) as raised:
        from_answers(tmp_path / "m.toml", PAIR_TOML.replace(old, new))
    assert said in str(raised.value)
    assert not (tmp_path / "m.toml").exists()


# A profile that is there


def test_every_shipped_profile_survives_the_wizard(tmp_path):
    """Opened again without changes, a profile keeps every byte, and asks nothing."""
    for name in shipped_names():
        copy, text = tmp_path / f"{name}.toml", read_shipped(name).text
        copy.write_text(text, "utf-8", newline="")
        talk(copy, "\n")
        assert copy.read_bytes() == text.encode()


def test_an_assumed_key_goes_when_its_value_is_stated(tmp_path):
    """Windows line ends and all other lines stay; a table that was assumed falls into its keys."""
    path = tmp_path / "p.toml"
    text = read_shipped("modal-two-modes").text
    text = text.replace("illustrative = true", 'illustrative = true\nassumed = ["drive"] # mine')
    path.write_text(text, "utf-8", newline="\r\n")
    before = path.read_bytes()
    talk(path, "\n")
    assert path.read_bytes() == before
    talk(path, "drive.force_lag\n3 ms\n\n")
    after = path.read_bytes()
    assert b'force_lag = "3 ms"' in after
    assert b'assumed = ["drive.max_force", "drive.continuous_force"] # mine\r\n' in after
    assert len(set(before.split(b"\r\n")) ^ set(after.split(b"\r\n"))) == 4


def test_another_kind_of_mechanics_replaces_the_old_one():
    text = read_shipped("milling-manipulator").text
    answers = {key: value for key, value in to_answers(tomllib.loads(text)).items()
               if not key.startswith("damping_optimal.weights")}  # fmt: skip
    answers |= PAIR_ON_SCREW | {"wizard.way": PAIR_BY_STIFFNESS, "pair.stiffness": "1 N/um"}
    machine = parse_profile(changed := update_document(text, to_profile(answers, {})), where="c")
    assert isinstance(machine.mechanics, Modal)
    assert "# The reference machine: every mechanical number" in changed


def test_a_broken_profile_is_mended_by_the_wizard(tmp_path):
    """Opened with wrong values in it, the wizard says so and asks; it must not fail on them."""
    path = tmp_path / "p.toml"
    text = read_shipped("milling-manipulator").text
    path.write_text(text.replace('"450 kg"', '"450 m"').replace('"2 kN"', '"much"'), "utf-8")
    _, said = talk(path, "\n450 kg\n\n2 kN\n\n", is_interactive=True)
    assert "Not possible: drive.max_force" in said
    assert mechanical(read_profile(path)) == SHIPPED


# Leaving and coming back


def test_back_help_and_slips(tmp_path):
    ending, said = talk(tmp_path / "m.toml", "<\nA\nback\nB\nX\n?\nturning\nlinear\n<\nq\n")
    assert ending is Ending.QUIT
    assert "quit at machine.motion; answers kept in" in said
    assert "choose one of: 1 linear, 2 rotary" in said
    assert said.count("A rotary axis takes inertia for mass") > 1
    rest = "\n\n\n2 km\n-5 N\n2 kN\n\n3\n800\n40\n\n20 mm\n\n\n5um\n\n\n"
    _, said = talk(tmp_path / "m.toml", rest)
    assert read_profile(tmp_path / "m.toml").name == "B"
    assert 'got "2 km"' in said
    assert "got -5 N, must be > 0 N" in said


# Replies


@pytest.mark.parametrize(
    ("key", "typed", "kept", "taken_as"),
    [
        ("plant.base_mass", "450", "450 kg", "450 kg"),
        ("plant.base_mass", "0.45 t", "0.45 t", ""),
        ("plant.base_mass", "450,5kg", "450.5kg", "450.5kg"),
        # 20 for a distance is 20 m; Kv 40 is 40 1/s: who meant another unit must see it.
        ("control.position_gain", "66,7", "66.7 1/s", "66.7 1/s = 4.002 (m/min)/mm"),
        ("moves.0.distance", "20", "20 m", "20 m"),
        ("requirements.damping_spread", "0.3", "0.3", "0.3 = 30 %"),
    ],
)
def test_a_number_is_kept_with_its_unit_and_never_read_silently(key, typed, kept, taken_as):
    reply = read_reply(find_question(key, {"wizard.way": TOWER}), typed, ENGLISH)
    assert (reply.text, reply.taken_as) == (kept, taken_as)


def test_a_move_is_a_distance_or_a_velocity_by_its_unit():
    question = next(one for one in list_questions({}) if one.key == "moves.0.distance")
    assert read_reply(question, "20 mm", ENGLISH).key == "moves.0.distance"
    assert read_reply(question, "30 m/min", ENGLISH).key == "moves.0.velocity_step"
    with pytest.raises(Refused, match="must be in m, mm, um or nm"):
        read_reply(question, "3 kg", ENGLISH)


def asked_of(answers: dict[str, str]) -> tuple[Question, ...]:
    return (*list_questions(answers), *list_settled(answers))


def _all_questions() -> list[tuple[Question, bool]]:
    """Every question, and whether it is asked of a rotary axis."""
    given = {"plant.modes.0.frequency": "40 Hz", "moves.0.distance": "1 mm",
             "moves.1.velocity_step": "1", "drive.lead": "10 mm", "plant.moving_mass": "8",
             "drive.continuous_force": "1", "control.kind": "sinumerik"}  # fmt: skip
    found = {}
    for motion, way, kind in product(("linear", "rotary"), WAYS, ("", "position_source")):
        answers = given | {"machine.motion": motion, "wizard.way": way, "drive.kind": kind}
        if (motion, way) != ("rotary", TOWER):
            for question in asked_of(answers):
                found[motion, question.key, kind] = (question, motion == "rotary")
    return list(found.values())


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_every_question_fits_a_terminal_and_its_choices_are_read_in_any_language(language):
    """And a rotary table is sent to no lead, which whoever looks for it would guess."""
    for question, is_rotary in _all_questions():
        words = Catalogue(language, rotary=is_rotary)
        text, where = question.say(words), question.where(words)
        hint = f"{text}{question.hint(question.default, words)}: "
        assert question.choices or len(hint) <= 79, text
        for choice in question.choices:
            shown = title(choice, words)
            assert len(f"? {text} {shown}") <= 79, question.key
            assert read_reply(question, shown, words).text == choice
            assert read_reply(question, choice, words).text == choice
        for example in filter(None, (question.default, question.example)):
            assert read_reply(question, example, words).text, question.key
        if is_rotary and "where" not in question.key and question.key != "wizard.way":
            for linear in ("lead", "screw", "gantry", "belt", "mass on", "weight of"):
                assert language != "en" or linear not in (text + where).lower(), question.key


def test_the_wizard_speaks_german_and_writes_german_comments(tmp_path):
    """German replies to choices count, and the profile is the same machine."""
    _, said = talk(tmp_path / "p.toml", PAPER, language="de")
    assert mechanical(read_profile(tmp_path / "p.toml")) == SHIPPED
    assert "# Gestell" in (tmp_path / "p.toml").read_text("utf-8")
    assert f"Eigenform base bei 50{THIN}Hz, Dämpfungsgrad 0,0301" in said
    for english in ("Stiffness", "Mass of", "mode ", "assumed", "At every"):
        assert english not in said


@pytest.mark.parametrize("name", ['"""', "a\\u0041\\", "'''x'''", "# [x] = 1", "Ω漢👩 🔧 é"])
def test_any_name_survives_in_the_file(name, tmp_path):
    quoted = json.dumps(name, ensure_ascii=False)
    from_answers(tmp_path / "p.toml", PAIR_TOML.replace('"Table"', quoted))
    assert read_profile(tmp_path / "p.toml").name == name
