"""Command line: argv -> files, texts and exit codes."""

from __future__ import annotations

import importlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from mtcommission import cli
from mtcommission.__main__ import main as start
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.optimum_view import describe_optimum
from mtcommission.limits.optima import find_time_optimum
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.shipped import read_shipped
from tests.independent_loop import axis_of
from tests.machines import paper_machine

PROFILES = Path(__file__).parent.parent / "profiles"
PAPER = PROFILES / "milling-manipulator.toml"
BELT = str(PROFILES / "printer-belt.toml")
HONING = PROFILES / "honing-z.toml"


@pytest.mark.parametrize(
    ("command", "left_out"),
    [
        (("--help",), ("numpy", "scipy", "ruckig")),
        (("check", BELT), ("scipy", "ruckig")),
        (("limits", BELT, "--page", "page.html"), ()),
    ],
    ids=" ".join,
)
def test_a_command_loads_what_it_computes_with(command, left_out, tmp_path):
    """Who tries ten variants an hour would wait for libraries longer than for the answer."""
    code = (
        "import sys\nfrom mtcommission import cli\n"
        f"sys.argv=['mtcommission',*{command!r}]\n"
        "try:\n    cli.main()\nexcept SystemExit:\n    print(*sys.modules, sep='\\n')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    loaded = set(done.stdout.splitlines())
    heavy = {
        "casadi", "control", "highspy", "matplotlib", "polars", "scipy.integrate",
        "scipy.interpolate", "scipy.optimize", "scipy.signal", "typst",
        "mtcommission.commission.commission", "mtcommission.optimal.control",
        "mtcommission.sheet.content",
    }  # fmt: skip
    assert "mtcommission.cli" in loaded
    assert not loaded & (heavy | set(left_out))


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize(
    "command",
    ["", "wizard", "identify", "check", "run", "limits", "optimal", "simulate", "export", "sheet",
     "verify", "sweep", "validate", "profiles", "profiles list", "profiles show", "profiles copy"],
)  # fmt: skip
def test_every_help_reads_whole_on_80_columns(run, command, language):
    """A summary that is cut, a line that wraps, or one in English hides what a command does."""
    code, out, err = run("--language", language, *command.split(), "--help")
    assert (code, err) == (0, "")
    assert max(map(len, out.splitlines())) <= 80
    english = {"Usage", "Show", "Options:", "[default:", "[required]", "Machine", "the"}
    assert bool(english & set(out.replace("\n", " ").split(" "))) == (language == "en")


def test_help_speaks_the_language_of_the_environment(run, monkeypatch):
    """Who works in German would have to say so at every call."""
    monkeypatch.delenv("LC_ALL", raising=False)
    monkeypatch.setenv("LANG", "de_DE.UTF-8")
    _, german, _ = run("--help")
    assert german.startswith("Aufruf: mtcommission [OPTIONEN] BEFEHL")
    _, english, _ = run("--help", "--language", "en")
    assert english.startswith("Usage: mtcommission [OPTIONS] COMMAND")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rum"], "there is no such command; there are: wizard, identify, check"),
        (["simulate", BELT], "--acceleration is missing; see mtcommission simulate --help"),
        (["limits", BELT, "--pge"], "there is no option --pge (there are: --page)"),
        (["optimal", BELT, "--kind", "time", "--move", "a"], "--move must be a whole number"),
        (["run", "--no-pdf=3", BELT], "--no-pdf takes a value just where --help shows one"),
        (["run", "--language", "de"], "PROFILE fehlt; siehe mtcommission run --help"),
    ],
)
def test_a_call_that_does_not_fit_is_answered_in_one_line(run, arguments, said):
    """The one who mistypes would read English about a framework."""
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert err.startswith(said)
    assert err.count("\n") == 1


def test_a_third_language_is_a_folder_of_texts(tmp_path):
    """A distributor would have to change the program to speak to his customers."""
    package = Path(cli.__file__).parent.parent
    copy = tmp_path / "mtcommission"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(package.parent / "profiles", tmp_path / "profiles")
    texts = copy / "base" / "messages" / "texts"
    shutil.copytree(texts / "de", texts / "fr")
    for name, german, french in (
        ("sheet.ftl", "\nmode = Eigenform", "\nmode = Mode propre"),
        ("help.ftl", "help-usage = Aufruf", "help-usage = Utilisation"),
    ):
        file = texts / "fr" / name
        text = file.read_text(encoding="utf-8")
        assert german in text
        file.write_text(text.replace(german, french), encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}

    def call(*arguments):
        command = [sys.executable, "-m", "mtcommission", *arguments, "--language", "fr"]
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
        )
        return done.stdout

    assert "Mode propre" in call("check", BELT)
    assert call("run", "--help").startswith("Utilisation: ")


def test_optimal_json_is_exact_when_somebody_else_integrates_it(run):
    """The printed arcs must end at 0.1 m/s and at rest to 1e-9 of each state's peak."""
    code, out, _ = run("optimal", PAPER, "--kind", "time", "--json", "-")
    assert code == 0
    found = json.loads(out)
    axis = axis_of(paper_machine())
    joint = np.zeros((8, 8))
    joint[:7, :7], joint[:7, 7] = axis.A, axis.B
    z = np.zeros(8)
    for arc in found["arcs"]:
        z[7] = {"+F_max": 2e3, "-F_max": -2e3}[arc["control"]]
        z = expm(joint * (arc["t_end"] - arc["t_start"])) @ z
    peaks = np.array([found["peaks"][s] for s in ("x_b", "x_s", "phi", "v_b", "v_s", "v_phi", "F")])
    target = np.array([0.0, z[1], 0.0, 0.0, 0.1, 0.0, 0.0])
    assert np.all(np.abs(z[:7] - target) <= 1e-9 * peaks)
    # Eq. (12) of the paper, right to its own discretisation (up to 6.3e-5 s).
    paper = [0.009337, 0.009668, 0.036552, 0.037653, 0.041942, 0.043505]
    assert np.allclose([*found["switching_times"], found["t_f"]], paper, atol=6.5e-5)
    assert found["certificate"]["switching_law_holds"]
    assert 0.0 <= found["certificate"]["relative_gap"] < 1e-9
    assert found["certificate"]["terminal_jacobian_rank"] == 6


def test_too_short_final_time_is_refused_with_the_least_one(run):
    """A time that is too short by a nanosecond does not look the same as the least one, and who
    types that in is not refused once more."""
    asked = ("optimal", PAPER, "--kind", "damping", "--t-f")
    code, _, err = run(*asked, "43.520364ms")
    assert code == 3
    assert "t_f = 43.520364 ms, but t_f,min = 43.5203644 ms" in err
    code, out, _ = run(*asked, "43.5203644ms")
    assert code == 0
    assert "t_f is that of --t-f." in out


def test_a_damping_optimal_control_tells_where_its_numbers_are_from(run):
    """A weight without its unit, or a time nobody asked for, cannot be checked."""
    asked = ("optimal", PROFILES / "rotary-table.toml", "--kind", "damping")
    said = [" ".join(run(*asked, *more)[1].split()) for more in ((), ("--t-f", "330ms"))]
    assert "t_f is 1.2 times t_f,min" in said[0]
    assert "max_velocity is no part of this optimum" not in said[0]
    assert re.search(r"no part of this optimum: \|v\| exceeds it by 15 %", said[1])
    assert "Weights, balanced: Deflection of mode plate" in said[1]
    assert "(N·m)²/(N·m·s²)²" in said[1]


def test_a_grid_does_not_pretend_to_a_proof(run):
    code, out, _ = run(
        "optimal", PAPER, "--kind", "time", "--method", "transcription", "--intervals", "50"
    )
    assert code == 0
    assert "A grid proves no lower bound of t_f" in out
    assert "nan" not in out


def test_a_law_that_does_not_hold_is_not_called_a_proof():
    """The arcs would look like the optimum, and be none."""
    profile = read_shipped("milling-manipulator").machine
    plant = build_plant(profile)
    found = find_time_optimum(plant, profile.moves[0], force_limit=2e3, bounds=())
    for holds in (True, False):
        proof = replace(found.certificate, switching_law_holds=holds)
        lines = describe_optimum(profile, plant, replace(found, certificate=proof), Catalogue())
        assert any("DOES NOT HOLD" in line for line in lines) is not holds


def test_options_report_all_faults_at_once(run):
    code, _, err = run(
        "optimal", PAPER, "--kind", "fast", "--limit", "v_phy=1", "--distance", "-2 mm"
    )
    assert code == 2
    assert "--kind: got 'fast'" in err
    assert 'did you mean "v_phi"' in err
    assert "--distance: got -2 mm" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", PAPER, "-o", "{file}"], "is a file"),
        (["simulate", PAPER, "--acceleration", "-2", "--jerk", "10"], "got -2, must be > 0 m/s^2"),
        (["limits", PAPER, "--json", "{file}/x.json"], "there is no folder"),
        (["simulate", PAPER, "--acceleration", "2", "--jerk", "9", "--csv", "."], "is a folder"),
        (["sweep", PAPER, "-o", "{file}", "--f-max", "1kN:2kN:3"], "is a file"),
    ],
)
def test_what_cannot_work_is_refused_before_computing(run, tmp_path, monkeypatch, arguments, words):
    """Else the user waits for a computation that is thrown away."""

    def compute(*_):
        raise AssertionError("computed before refusing")

    monkeypatch.setattr("mtcommission.machine.plant.plant.build_plant", compute)
    file = tmp_path / "file.txt"
    file.write_text("mine")
    code, out, err = run(*(str(text).replace("{file}", str(file)) for text in arguments))
    assert (code, out) == (2, "")
    assert words in err
    assert list(tmp_path.iterdir()) == [file]
    assert file.read_text() == "mine"


def test_a_bad_profile_leaves_nothing_behind(run, tmp_path):
    """A folder with half a result would be taken for one."""
    profile = tmp_path / "bad.toml"
    profile.write_text('schema = 1\n[plant]\nbase_mass = "-450 kg"\n', encoding="utf-8")
    code, out, err = run("run", profile, "-o", tmp_path / "out")
    assert (code, out) == (2, "")
    assert "bad.toml:3" in err
    assert not (tmp_path / "out").exists()


def test_run_warns_of_what_cannot_be_meant_however_full_the_screen_is(run, tmp_path):
    """Who typed mm for um would have read that all requirements are met, and nothing else."""
    profile = tmp_path / "wide.toml"
    text = Path(BELT).read_text("utf-8")
    profile.write_text(text.replace('tcp_deviation = "20 um"', 'tcp_deviation = "20 mm"'), "utf-8")
    code, out, _ = run("run", profile, "-o", tmp_path / "out", "--no-pdf")
    assert code == 0
    assert "20 mm is no usual accuracy" in out.replace("\u202f", " ")


@pytest.mark.parametrize(
    ("language", "missing", "no_record"),
    [
        ("en", "there is no such file; check the name", "its contents are not JSON"),
        ("de", "diese Datei gibt es nicht; den Namen prüfen", "der Inhalt ist kein JSON"),
    ],
)
def test_every_command_says_the_same_of_a_file_that_it_cannot_use(
    language, missing, no_record, run, tmp_path
):
    """One that read by itself told it in the words of the operating system."""
    none = tmp_path / "none"
    for command in (("run",), ("limits",), ("export", "--control", "fanuc"), ("sheet",)):
        behind = ("--language", language) if command == ("limits",) else (
            "--language", language, "-o", tmp_path / "out")  # fmt: skip
        assert run(*command, none, *behind) == (2, "", f"{none}: {missing}\n"), command
        if command[0] in ("export", "sheet"):
            code, out, err = run(*command, PAPER, *behind)
            assert (code, out) == (2, "")
            assert no_record in err


def test_a_terminal_in_german_has_no_english_words_and_breaks_none(run):
    """Names that JSON keeps in English must not be shown to a German reader."""
    german = ("--language", "de")
    bound = ("--limit", "v_phi=0.005")
    optimum = run("optimal", PAPER, "--kind", "time", *bound, *german)[1]
    assert "Verfahren exakt" in optimum
    assert "v_φ, obere Grenze" in optimum
    assert "exact," not in optimum
    assert "boundary" not in optimum
    limits = run("limits", HONING, *german)[1]
    for word in ("Begrenzt durch", "Inbetriebnahmeregel ", "Einschw. "):
        assert word in limits, word
    assert "surface" not in limits
    moved = run("simulate", HONING, "--acceleration", "1", "--jerk", "20", *german)[1]
    assert "zeta" not in moved
    assert run("export", "--control", "?", *german)[1].count("allgemeine Kaskade") == 1


def test_optimal_says_which_limits_act(run):
    """A limit that changes nothing must not look like one that was not read; and the law, which
    holds for the optimum, is known to one cell where a mesh shows it."""
    limits = ("--limit", "v_phi=0.005", "--limit", "v_s=0.2")
    said = run("optimal", PAPER, "--kind", "time", *limits)[1].replace("\u202f", " ")
    assert "Limit: Tower rotation rate v_φ at most 5 mrad/s, reached." in said
    assert "Limit: Slider velocity v_s at most 0.2 m/s, not reached." in said
    said = " ".join(run("optimal", PAPER, "--kind", "time", "--limit", "phi=5e-5")[1].split())
    assert "kept to one cell of a mesh" in said
    assert "DOES NOT HOLD" not in said


def test_a_damping_optimal_control_names_its_limits(run):
    """Cost and motion hold under these limits only: terminal and JSON must say so."""
    grid = ("--method", "transcription", "--intervals", "100", "--t-f", "60ms")
    asked = ("optimal", PAPER, "--kind", "damping", *grid, "--limit", "v_phi=0.005")
    # A hundred steps keep the limit at their ends only, and the terminal says so.
    told = " ".join(run(*asked)[1].replace("\u202f", " ").split())
    assert re.search(r"v_φ at most 5 mrad/s, exceeded by \S+ % between", told)
    assert json.loads(run(*asked, "--json", "-")[1])["limits"] == {"v_phi": 0.005}


def test_simulate_and_limits_agree_with_each_other(run, tmp_path):
    """The limits that are recommended must do in `simulate` what `limits` says."""
    profile = tmp_path / "plain.toml"
    text = HONING.read_text("utf-8")
    assert "[control]" in text
    profile.write_text(text.replace("[control]", '[control]\nsetpoint_filter = "none"'), "utf-8")
    best = json.loads(run("limits", profile, "--json", "-")[1])["recommended"]
    typed = ("--acceleration", repr(best["acceleration"]), "--jerk", repr(best["jerk"]))
    code, out, _ = run("simulate", profile, *typed, "--json", "-")
    found = json.loads(out)
    assert code == 0
    assert found["response"]["settling_time"] == pytest.approx(best["settling_time"], rel=1e-9)
    assert found["assessment"]["met"]
    # What qualifies the verdict stands beside it, not below all that follows.
    told = run("simulate", PAPER, *typed)[1]
    assert told.index("Warning: Simulated without") < told.index("Simulated: a ")
    assert "Payload" not in told  # the machine has none


def test_a_console_of_another_code_page(tmp_path):
    """A Windows console has no Greek letters: the text comes in UTF-8, and whole."""
    named = tmp_path / "Fräse ü.toml"
    text = (
        (PROFILES / "rotary-table.toml").read_text("utf-8").replace("Rotary table", "Drehtisch Ω")
    )
    named.write_text(text, "utf-8-sig", newline="\r\n")
    settings = {"PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0", "NO_COLOR": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "mtcommission", "check", named],
        capture_output=True,
        env=os.environ | settings,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert "Drehtisch Ω" in done.stdout.decode("utf-8")
    assert b"\x1b" not in done.stdout


def test_a_terminal_of_no_columns_shows_what_a_pipe_shows(run, monkeypatch):
    """Serial consoles and some editors say 0: nothing, or a word a line, would be shown."""
    piped = run("check", BELT)[1]
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setattr("os.get_terminal_size", lambda *_: os.terminal_size((0, 0)))
    for columns in ("", "0"):
        monkeypatch.setenv("COLUMNS", columns)
        shown = re.sub(r"\x1b\[[0-9;]*m", "", run("check", BELT)[1])
        assert shown == piped


def test_a_wrong_date_for_repeatable_output_is_named(run, monkeypatch):
    for date, code in (("yesterday", 2), ("9" * 20, 2), ("", 0)):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
        ended, _, err = run("check", BELT)
        assert ended == code
        assert err.startswith(f'SOURCE_DATE_EPOCH: got "{date}"') or not date


def test_typed_bytes_of_another_encoding_are_refused_at_their_question(tmp_path):
    """A piped file in Latin-1 once ended in an internal error, all answers lost."""
    done = subprocess.run(
        [sys.executable, "-m", "mtcommission", "wizard", "-o", tmp_path / "p.toml"],
        input="Fräse\nLathe\nZ\n".encode("latin-1"),
        capture_output=True,
        env=os.environ | {"PYTHONIOENCODING": "utf-8"},
        check=False,
    )
    assert done.returncode == 2
    assert b"bytes of another encoding; type plain text" in done.stdout
    kept = tomllib.loads((tmp_path / "p.toml.answers").read_text("utf-8"))
    assert (kept["machine.name"], kept["machine.axis"]) == ("Lathe", "Z")


def test_errors_of_a_rotary_axis_speak_its_units(tmp_path, run):
    """Gains in N s/m would be typed into the drive of a rotary table."""
    text = read_shipped("rotary-table").text
    gains = 'position_gain = "900 1/s"\nvelocity_gain = "60000 N m s/rad"\n'
    profile = tmp_path / "stiff.toml"
    profile.write_text(text.replace("[control]\n", f"[control]\n{gains}"), encoding="utf-8")
    code, _, errors = run("simulate", profile, "--acceleration", "40", "--jerk", "3000")
    assert code == 3
    assert "N m s/rad" in errors
    assert "N s/m" not in errors


def test_closed_streams_and_odd_texts_end_with_a_message(run, tmp_path):
    """Closed, sys.stderr is None; a quoted key once steered the terminal."""
    command = [sys.executable, "-m", "mtcommission", "check", "missing.toml"]
    closed = subprocess.run(
        ["sh", "-c", '"$@" 2>&- >&- <&-', "sh", *command], check=False, env={**os.environ}
    )
    assert closed.returncode == 2
    odd = tmp_path / "odd.toml"
    for text in ('schema = 1\n"a\\u001b[31m\\nb" = 1\n', "[" + ".".join("a" * 9999) + "]\n"):
        odd.write_text(text)
        code, _, err = run("check", odd)
        assert code == 2
        assert "\x1b" not in err
        assert all("odd.toml:" in line for line in err.splitlines())
    odd.write_text('{"schema": 9}')
    assert "is JSON, as the record of a run is" in run("check", odd)[2]


def test_a_control_without_jerk_limit_is_simulated_without_one(run):
    """Its engineer has no jerk to enter; whoever has one must say which. What ran is said."""
    tried = ("--acceleration", "50", "--filter", "none", "--move", "2", "--size", "20mm/s")
    code, out, _ = run("simulate", BELT, *tried)
    assert code == 1
    said = " ".join(out.split())
    assert "Simulated: a 50 m/s², j no limit, setpoint filter none; Move 2 (velocity step" in said
    code, out, error = run("simulate", PROFILES / "ball-screw.toml", "--acceleration", "5")
    assert (code, out) == (2, "")
    assert "--jerk" in error


def test_an_own_stream_that_leads_into_a_file_keeps_what_is_in_it(tmp_path):
    """``-o /dev/stdout >> log`` replaced the log."""
    log = tmp_path / "log"
    log.write_text("kept\n", "utf-8")
    begin = [sys.executable, "-m", "mtcommission", "optimal", str(PAPER), "--kind", "time"]
    with log.open("ab") as out:
        subprocess.run([*begin, "--csv", "/dev/stdout"], stdout=out, check=True)
    text = log.read_text("utf-8").replace("\u202f", " ")
    assert text.startswith("kept\nt,F_set,")
    assert "Time-optimal control\nMove 1 (velocity step 0.1 m/s): t_f" in text  # behind it


def test_a_terminal_shows_the_limits_before_what_takes_longer(run, monkeypatch):
    """Else one waits for rules and studies before one sees what was asked for."""
    _, piped, silent = run("limits", BELT)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    _, out, err = run("limits", BELT)
    assert out == piped
    assert "All requirements met; a = 20" in err
    assert "All requirements met; a = 20" not in silent


def test_ctrl_c_while_the_program_loads_is_no_traceback(monkeypatch, capsys):
    class Interrupted:
        def find_spec(self, name, *_):
            if name == "mtcommission.cli":
                raise KeyboardInterrupt

    for name in [name for name in sys.modules if name.startswith("mtcommission.cli")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [Interrupted(), *sys.meta_path])
    monkeypatch.delattr("mtcommission.cli")
    with pytest.raises(SystemExit) as stopped:
        start()
    assert stopped.value.code == 130
    assert capsys.readouterr().err == "interrupted before anything began\n"


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_library_that_loads_is_waited_for_before_the_program_stops(
    run, tmp_path, monkeypatch, name
):
    """Interrupted half-way it took Ctrl-C for a fault of its own, and the command went on."""
    code = f"import os, signal\nos.kill(os.getpid(), signal.{name})\nloaded = True\n"
    (tmp_path / f"fragile_{name}.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    found = []

    def load_and_wait(*_):
        found.append(importlib.import_module(f"fragile_{name}"))
        time.sleep(30.0)

    monkeypatch.setattr("mtcommission.machine.plant.plant.build_plant", load_and_wait)
    number = getattr(signal, name)
    before = signal.signal(number, signal.default_int_handler)  # a shell's "&" has it ignored
    try:
        ended, _, err = run("check", PAPER)
    finally:
        signal.signal(number, before)
    assert ended == 130
    assert err.startswith("interrupted; every file is whole")
    assert found[0].loaded
