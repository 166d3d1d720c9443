"""Sweeps: what varies, rows that any interruption leaves the same, and their files."""

from __future__ import annotations

import html
import json
import multiprocessing
import os
import re
import resource
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import closing, suppress
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from mtcommission.base.errors import ComputationError, InputError, Outcome
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.commission.recommend import recommend
from mtcommission.limits.optima import find_optima
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.sweep import solve
from mtcommission.sweep.engine import run_sweep
from mtcommission.sweep.lanes import Engine, solve_pieces
from mtcommission.sweep.library import sweep
from mtcommission.sweep.plan import Axis, Plan, Quantity, read_axis, read_range, vary_profile
from mtcommission.sweep.request import check_plan, read_cases, read_plan
from mtcommission.sweep.solve import columns, solve_case
from mtcommission.sweep.store import LOCK, NAME, hold_folder
from mtcommission.sweep.table import SweepTable, print_sweep, read_table, summarise, write_table
from tests.machines import paper_machine
from tests.test_sheet_browser import CHROMIUM, TELL, browse

PAPER = Path(__file__).parent.parent / "profiles" / "milling-manipulator.toml"
SWEEPS = PAPER.parent.parent / "docs" / "sweeps.md"
WORDS = Catalogue()
TEXT = PAPER.read_text(encoding="utf-8")
MASSES = "plant.slider_mass=600:900:24"
SMALL_PIECES = "import mtcommission.sweep.plan as plan; plan.PIECE = 4"
"""So that these masses are six pieces."""


@pytest.fixture(autouse=True, scope="module")
def _small_pieces():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mtcommission.sweep.plan.PIECE", 4)
        yield


def plan_of(*axes: Axis, quantity: Quantity = Quantity.OPTIMAL) -> Plan:
    return Plan(profile_text=TEXT, where="paper.toml", axes=axes, quantity=quantity)


def values_of(key: str, *texts: str) -> Plan:
    return plan_of(Axis(keys=(key,), rows=tuple((text,) for text in texts)))


def frame_of(plan: Plan, folder: Path, **how: Any) -> pl.DataFrame:
    return read_table(plan, run_sweep(plan, folder=folder, **how)).frame


MASSES_PLAN = plan_of(read_axis(MASSES, where="--vary"))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The rows of the sweep over masses without any interruption."""
    return frame_of(MASSES_PLAN, tmp_path_factory.mktemp("whole"))


def data_of(page: str) -> Any:
    """What the page of a sweep draws."""
    return json.loads(page.partition('id="what-if-data">')[2].partition("</script>")[0])


def command(folder: Path, *more: str) -> list[str]:
    program = f"{SMALL_PIECES}; from mtcommission.cli import main; main()"
    line = [sys.executable, "-c", program, "sweep", str(PAPER), "--vary", MASSES]
    return [*line, "-o", str(folder), "--workers", "1", *more]


def lines_in(folder: Path) -> int:
    path = folder / NAME
    return path.read_bytes().count(b"\n") if path.exists() else 0


def resumed(folder: Path) -> pl.DataFrame:
    return frame_of(MASSES_PLAN, folder, resume=True)


# What varies


def test_ranges_are_what_they_say():
    """A range that is off by one point or in another unit would sweep other machines."""
    values = [row[0] for row in read_range("0.5kN:4kN:8", where="")]
    assert (values[0], values[1], values[-1]) == ("0.5 kN", "1.0 kN", "4.0 kN")
    ratios = [float(row[0]) for row in read_range("log:300:20e3:5", where="")]
    assert all(b / a == pytest.approx((20e3 / 300) ** 0.25) for a, b in pairwise(ratios))
    drawn, again = (
        [float(row[0]) for row in read_range("random:2:3:50:7", where="")] for _ in "ab"
    )
    assert drawn == again
    assert 2.0 <= min(drawn) < 2.2
    assert 2.8 < max(drawn) <= 3.0
    assert read_range("auto, 3 ms", where="") == (("auto",), ("3 ms",))


def test_grid_and_pairs_cover_what_they_should():
    """The last axis runs fastest; pairs go value by value."""
    a = Axis(keys=("plant.slider_mass",), rows=(("1",), ("2",)))
    b = Axis(keys=("drive.max_force", "drive.force_lag"), rows=(("5", "6"), ("7", "8")))
    grid = plan_of(a, b)
    found = [" ".join(text for _, text in grid.settings(i)) for i in range(grid.count)]
    assert found == ["1 5 6", "1 7 8", "2 5 6", "2 7 8"]
    pairs = replace(grid, is_paired=True)
    assert pairs.count == 2
    assert [text for _, text in pairs.settings(1)] == ["2", "7", "8"]
    longer = replace(pairs, axes=(a, replace(b, rows=(*b.rows, ("1", "2")))))
    with pytest.raises(InputError, match="needs as many values for each key"):
        check_plan(longer)
    with pytest.raises(InputError, match="varies twice"):
        check_plan(plan_of(a, a))


def test_profile_of_a_case_differs_in_its_keys_alone():
    """Comments, order and lines stay, so that the reader's messages name the right line, and any
    text arrives as it is."""
    word, text = 'a "quoted" \\1 \\ @1', TEXT.replace('axis = "X"', 'axis = "@0"', 1)
    settings = (("plant.slider_mass", "800 kg"), ("machine.name", word), ("machine.source", "@0"))
    changed = vary_profile(text, (*settings, ("moves.0.velocity_step", "0.2")), where="p")
    pairs = zip(text.splitlines(), changed.splitlines(), strict=True)
    assert len([1 for old, new in pairs if old != new]) == 4
    machine = parse_profile(changed, where="p")
    assert machine.mechanics.slider_mass == 800.0  # type: ignore[attr-defined]
    assert machine.moves[0].velocity_step == 0.2  # type: ignore[union-attr]
    assert (machine.name, machine.source, machine.axis) == (word, "@0", "@0")
    for key, message in (
        ("schema.dwell", "there is no such key"),
        ("moves.0", "there is no such key"),
        ("requirements.payload[2]", "has no such element"),
    ):
        with pytest.raises(InputError, match=message):
            vary_profile(TEXT, ((key, "1"),), where="p")


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_a_table_saved_by_a_spreadsheet_is_read(tmp_path, mark):
    """Semicolons, tabs, a byte order mark, empty lines at the end, units in the header."""
    lines = [["f_max [kN]", "plant.slider_mass [t]"], ["2", "0.7"], ["", ""], ["3", "0.8"], [""]]
    table = tmp_path / "cases.csv"
    table.write_text("\r\n".join(mark.join(line) for line in lines), encoding="utf-8-sig")
    (axis,) = read_plan(PAPER, cases=table).axes
    assert axis.keys == ("drive.max_force", "plant.slider_mass")
    assert axis.rows == (("2 kN", "0.7 t"), ("3 kN", "0.8 t"))
    assert axis.lines == (2, 4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f_max [kN]\n2\n500 N\n", 'c.csv:3: f_max: got "500 N" below a heading in kN'),
        ("f_max,drive.force_lag\n2 kN,1 ms\n3 kN,\n", "c.csv:3: drive.force_lag: has no value"),
        ("f_max\n2 kN\n\n-3 kN\n", "c.csv:4: drive.max_force: got -3 kN, must be > 0 N"),
        ("f_max [kN];drive.force_lag\n2,5;1 ms\n", 'f_max: got "2,5" below a heading in kN'),
        ("f_max,b\n1,2\n3\n", "c.csv:3: needs 2 values, got 1"),
        # Of numbers with one unit the ends are tried; the odd unit between them, too.
        ("plant.slider_mass\n7 kg\n.7 t\n7 g/m\n8 kg\n", 'c.csv:4: plant.slider_mass: got "7 g/m"'),
        ("f_max\n", "c.csv:1: needs a header of keys and at least one case"),
        ('f_max\n"' + "2" * 200_000 + '"\n', "c.csv:2: is no CSV"),
    ],
)
def test_a_wrong_table_names_its_line(tmp_path, text, message):
    """Nobody searches thousands of lines for the one that is refused, nor gets 500 kN for 500 N."""
    table = tmp_path / "c.csv"
    table.write_text(text, "utf-8")
    with pytest.raises(InputError) as refused:
        read_plan(PAPER, cases=table)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--f-max", "1:2"], "must be START:STOP:COUNT"),
        (["--f-max", "1:2:0"], "count must be 1 to"),
        (["--f-max", "log:0:2:5"], "needs ends > 0"),
        (["--f-max", "1kN:2N:5"], "same unit"),
        (["--f-max", "1,,2"], "empty value"),
        (["--vary", "plant.slider_mas=600:900:3"], 'unknown key; did you mean "plant.slider_mass"'),
        (["--vary", "plant.slider_mass=700,-7"], "must be > 0 kg"),
        (["--vary", "control.state_feedback=auto,of"], 'must be "auto" or "off"'),
        (["--vary", "moves[0].dwell=1,2"], "moves[0].dwell: unknown key"),
        (["--vary", "drive.static_load=0,5kN", "--f-max", "1kN:4kN:3"], "or no force is left"),
        (["--limit", "v_ph=1:2:3"], 'did you mean "v_phi"?'),
        (["--limit", "v_phi=1:2:3", "--quantity", "limits"], "only goes with --quantity optimal"),
    ],
)
def test_what_no_case_can_use_is_refused_before_anything_is_written(
    tmp_path, run, options, message
):
    """A misprint must not cost a night of rows that all say the same."""
    folder = tmp_path / "rows"
    code, _, told = run("sweep", PAPER, *options, "-o", folder)
    assert code == 2
    assert message in told
    assert len(told.splitlines()) == 1
    assert not folder.exists() or not any(folder.iterdir())


@pytest.mark.parametrize(
    ("table", "options"),
    [
        ("f_max,drive.static_load\n500,0\n4 kN,1.2 kN\n", {}),
        ("drive.static_load\n0\n2500\n", {"f_max": "0.5kN,4kN", "is_paired": True}),
    ],
)
def test_a_value_that_others_make_possible_is_not_refused(tmp_path, table, options):
    """A load above the least force is wrong in some cases only; the others must be computed."""
    (tmp_path / "cases.csv").write_text(table, encoding="utf-8")
    plan = read_plan(PAPER, cases=tmp_path / "cases.csv", **options)
    assert frame_of(plan, tmp_path)["outcome"].to_list() == ["done", "done"]


# Rows


def test_rows_are_those_of_single_solves(undisturbed, tmp_path):
    """Each row against the solver called alone on a machine built without the profile reader, and
    so of 120 forces that are computed together: proved, and t_f falls with F_max."""
    machine = paper_machine()
    axis = read_axis("drive.max_force=log:0.3kN:20kN:120", where="--vary")
    forces = frame_of(plan_of(axis), tmp_path)
    rows = (*undisturbed.gather_every(11).rows(named=True), *forces[::60].rows(named=True))
    for row in rows:
        mass, force = row.get("plant.slider_mass", 750.0), row.get("drive.max_force", 2e3)
        mechanics = replace(machine.mechanics, slider_mass=mass)
        plant = build_plant(replace(machine, mechanics=mechanics))
        alone = solve_time_optimal(plant, machine.moves[0], force_limit=force)
        assert row["t_f"] == pytest.approx(alone.t_f, rel=1e-12)
        assert row["switches"] == len(alone.switching_times)
        for name, peak in zip(plant.signals, alone.peaks, strict=True):
            assert row.get(f"peak_{name}", peak) == pytest.approx(peak, rel=1e-8), name
    for frame in (undisturbed, forces):
        assert frame["certified"].all()
        assert frame["relative_gap"].max() < 1e-9
    assert forces["t_f"].diff().drop_nulls().max() < 0.0
    excess = forces["peak_F"].to_numpy() / forces["drive.max_force"].to_numpy() - 1.0
    assert np.all(excess < 1e-12)


def test_a_failing_case_is_a_row_with_its_outcome(tmp_path):
    """A wrong case, among forces that are computed together, neither stops the others nor goes."""
    plan = values_of("drive.max_force", "1 kN", "2 kN", "1500 kg", "-5 kN", "3 kN")
    table = read_table(plan, run_sweep(plan, folder=tmp_path))
    bad, good = "wrong_input", "done"
    assert table.frame["outcome"].to_list() == [good, good, bad, bad, good]
    assert "must be in N, kN or MN" in table.frame["message"][2]
    assert "must be > 0 N" in table.frame["message"][3]
    assert table.frame["t_f"].is_null().to_list() == [False, False, True, True, False]
    assert (table.done, table.is_met) == (3, False)
    told = summarise(table, WORDS)
    assert len(told) == 2, "one reason for each outcome, however many cases share it"
    assert told[1].startswith("wrong input, first in case 2: ")
    page = print_sweep(plan, table, WORDS, created="2025-01-01")
    assert told[1] in html.unescape(page), "the reason stands above the plots"


def test_a_computation_that_ends_otherwise_names_its_outcome(tmp_path):
    """A bound that no move keeps is a result of the case, not an internal error."""
    frame = frame_of(replace(plan_of(), bounds=(SignalValue(name="v_s", value=0.05),)), tmp_path)
    assert frame["outcome"].to_list() == ["bound_cannot_hold"]
    assert "v_s" in frame["message"][0]


def test_rows_do_not_depend_on_the_threads_of_the_process(tmp_path, monkeypatch):
    """From Python, and on a cluster, the order of summation would change with the machine."""
    seen = []

    def count(work, number):
        seen.extend(library["num_threads"] for library in threadpool_info())
        return solve_case(work, number)

    monkeypatch.setattr(solve, "solve_case", count)
    with threadpool_limits(limits=2, user_api="blas"):
        run_sweep(values_of("drive.max_force", "2kN"), folder=tmp_path)
        assert {library["num_threads"] for library in threadpool_info()} == {2}
    assert set(seen) == {1}


def test_limits_of_a_case_are_those_of_the_command(tmp_path):
    """A sweep must recommend what ``limits`` recommends for the same machine, and must not count
    a certified optimum as requirements that are met."""
    gains = "position_gain = 12\nvelocity_gain = 9e4\nintegral_time = 0.05\n"
    text = TEXT.replace('state_feedback = "auto"\n', gains)  # no loop is to be searched for
    for old, new in (
        ("[damping_optimal]", "[requirements.peaks]\nv_phi = 0.1\n[damping_optimal]"),
        ('tcp_deviation = "5 um"', 'tcp_deviation = "5 um"\nmax_settling_time = 0.5'),
    ):
        text = text.replace(old, new)
    plan = replace(plan_of(quantity=Quantity.LIMITS), profile_text=text)
    plan = replace(plan, axes=(read_axis("drive.max_force=0.15kN,2kN", where="--f-max"),))
    table = read_table(plan, run_sweep(plan, folder=tmp_path))
    assert table.frame["certified"].all()
    assert table.frame["requirements_met"].to_list() == [False, True]
    assert table.frame["obstacle"].to_list() == ["settling time", ""]
    assert "requirements met: 1" in summarise(table, WORDS)[0]
    assert not table.is_met
    assert data_of(print_sweep(plan, table, WORDS, created=""))["flag"] == "requirements_met"
    row, machine = table.frame.row(1, named=True), parse_profile(text, where="p")
    found = recommend(machine)
    assert row["acceleration"] == found.choice.limits.acceleration
    assert row["jerk"] == found.choice.limits.jerk
    assert row["settling_time"] == found.choice.candidate.settling_time
    assert row["t_f"] == find_optima(machine, found.plant, machine.moves[0]).time.t_f
    responses = [response for move in found.choice.moves for response in move.responses]
    column = found.plant.signals.index("v_phi")
    assert row["peak_v_phi"] == max(response.peaks[column] for response in responses)
    assert row["peak_F_set"] == max(response.max_force for response in responses)


def test_a_bound_that_varies_trades_time_against_vibration(tmp_path):
    """c_phi as parameter: each control keeps its bound, and a wider one never costs time."""
    plan = plan_of(read_axis("requirements.peaks.v_phi=8mrad/s,30mrad/s", where="--limit"))
    seen: list[int] = []
    frame = frame_of(plan, tmp_path, progress=lambda done, *_: seen.append(done))
    assert seen == [1, 2], "each of these takes long, so each must be on disk at once"
    bound, peak = frame["requirements.peaks.v_phi"].to_numpy(), frame["peak_v_phi"].to_numpy()
    assert peak[0] == pytest.approx(bound[0], rel=1e-9)
    assert peak[1] < bound[1]
    assert frame["t_f"][0] > frame["t_f"][1] == pytest.approx(0.0435202, abs=1e-6)
    named = {column.name: column.unit for column in columns(plan)}
    assert named["requirements.peaks.v_phi"] == named["peak_v_phi"] == "rad/s"


# Files


def test_files_carry_units_and_their_rows_are_cases_of_the_next_sweep(tmp_path):
    """A table without units is read in millimetres sooner or later."""
    keys = ("drive.max_force", "plant.base_damping", "requirements.peaks.v_phi")
    plan = plan_of(Axis(keys=keys, rows=(("2500", "8.1 kN s/m", "20 mrad/s"),)))
    plan = replace(plan, bounds=(SignalValue(name="v_s", value=0.2),))
    table = read_table(plan, run_sweep(plan, folder=tmp_path))
    write_table(table, tmp_path, WORDS)
    frame = pl.read_parquet(tmp_path / "rows.parquet")
    assert frame.equals(table.frame)
    assert frame.select(keys).row(0) == (2500.0, 8100.0, 0.02)
    about = pl.read_parquet_metadata(tmp_path / "rows.parquet")
    asked = "Quantity: optimal, move 1 of 1, |v_s| at most 0.2 m/s."
    assert about["asked"] == WORDS.say(table.asked) == asked
    assert asked in html.unescape(print_sweep(plan, table, WORDS, created=""))
    units = json.loads(about["units"])
    assert (units["t_f"], units["drive.max_force"]) == ("s", "N")
    assert list(json.loads(about["meanings"])) == frame.columns
    text = pl.read_csv(tmp_path / "rows.csv")
    assert text["t_f [s]"].to_list() == frame["t_f"].to_list()
    # Whoever cuts the interesting lines out gets the same machines again.
    lines = (tmp_path / "rows.csv").read_text(encoding="utf-8").splitlines()
    cut = "\n".join(",".join(line.split(",")[1:4]) for line in lines)
    again = replace(plan, axes=(read_cases(cut, where="cut"),))
    assert frame_of(again, tmp_path / "again").equals(table.frame)


def test_the_page_of_the_document_does_what_it_says(tmp_path, monkeypatch, capsys):
    """Whoever copies its ranges is not refused, and its lines give the command's rows."""
    text = SWEEPS.read_text(encoding="utf-8")
    quoted = re.findall(r"`([^`]+)`", text.replace("\n", " "))
    ranges = [text for text in quoted if re.fullmatch(r"(log:|random:)?\d[\w.]*[:,]\S+", text)]
    assert [len(read_range(text, where="docs")) for text in ranges] == [7, 50, 100, 2]
    [lines] = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "profiles").symlink_to(PAPER.parent)
    names: dict[str, Any] = {}
    exec(lines, names)
    assert capsys.readouterr().out.endswith("True\n")
    axis = read_axis(names["forces"], where="--vary")
    assert names["table"].frame.equals(frame_of(plan_of(axis), tmp_path / "b"))


def test_the_library_takes_what_the_command_takes(tmp_path, run):
    """Limits, a table of cases and a later move are there from Python, too, with the same rows."""
    profile = Path(__file__).parent / "data" / "belt-servo.toml"
    table, folder = tmp_path / "cases.csv", tmp_path / "command"
    table.write_text("drive.force_lag\n1 ms\n2 ms\n", encoding="utf-8")
    varied = "plant.modes[1].damping_ratio=0.04,0.06"
    options = ["--cases", table, "--limit", "F=25", "--move", "2", "--vary", varied, "--paired"]
    assert run("sweep", profile, *options, "-o", folder)[0] == 0
    same: dict[str, Any] = {"vary": [varied], "cases": table, "limits": ["F=25"], "move": 2}
    found = sweep(profile, folder=tmp_path / "library", is_paired=True, **same)
    assert found.frame.height == 2
    assert (found.frame["peak_F"] <= 25.0 * (1 + 1e-9)).all()
    assert found.frame.equals(pl.read_parquet(folder / "rows.parquet"))


# Interruptions


@pytest.mark.parametrize("finished", [1, 4])
def test_killed_by_force_and_resumed(tmp_path, undisturbed, finished):
    """After kill -9 the rows on disk are kept as they are, and the rest is the same as ever."""
    line = [*command(tmp_path), "--workers", str(1 + finished % 2)]
    running = subprocess.Popen(line, stderr=subprocess.PIPE, text=True)
    while running.poll() is None and lines_in(tmp_path) < finished:
        time.sleep(0.002)
    running.kill()
    _, told = running.communicate()
    assert told == "", "Python's own complaints tell the user nothing"
    kept = (tmp_path / NAME).read_bytes()
    sound = kept[: kept.rindex(b"\n") + 1]
    assert sound.count(b"\n") >= finished
    assert resumed(tmp_path).equals(undisturbed)
    assert (tmp_path / NAME).read_bytes().startswith(sound)


@pytest.mark.parametrize(
    ("number", "workers"), [(signal.SIGINT, "2"), (signal.SIGTERM, "1"), (signal.SIGHUP, "1")]
)
def test_asked_to_end_and_resumed(tmp_path, undisturbed, number, workers):
    """Ctrl-C, a shutdown or a closed terminal ends a sweep with a sentence, and no work is lost."""
    # Under nohup and on some CI runners the signal is ignored, and children inherit that.
    running = subprocess.Popen(
        [*command(tmp_path), "--workers", workers], text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=partial(signal.signal, number, signal.SIG_DFL),
    )  # fmt: skip
    while running.poll() is None and lines_in(tmp_path) < 1:
        time.sleep(0.002)
    os.killpg(running.pid, number)
    _, told = running.communicate()
    assert running.returncode == 130
    assert re.fullmatch(r"stopped: \d+ of 24 cases are on disk in .* --resume\n", told), told
    assert resumed(tmp_path).equals(undisturbed)
    assert lines_in(tmp_path) == 6, "finished pieces must not be computed again"


def test_full_disk_and_resumed(tmp_path, undisturbed):
    """A limit on file size fails writes midway, as a quota does; nothing before may be lost."""

    def shrink():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))

    stopped = subprocess.run(
        command(tmp_path), preexec_fn=shrink, capture_output=True, text=True, check=False
    )
    assert stopped.returncode == 2, stopped.stderr
    assert "--resume" in stopped.stderr
    assert "Traceback" not in stopped.stderr
    assert (tmp_path / NAME).read_bytes().endswith(b"\n")
    assert lines_in(tmp_path) > 1
    assert resumed(tmp_path).equals(undisturbed)


@pytest.mark.parametrize("damage", ["all", "end", "first line", "last line"])
def test_what_a_disk_loses_is_computed_again_and_nothing_else(tmp_path, undisturbed, damage):
    """A power cut leaves any prefix of the file and rubbish behind it; a flipped bit once deleted
    all sound pieces, too."""
    path = run_sweep(MASSES_PLAN, folder=tmp_path).path
    lines = path.read_bytes().splitlines(keepends=True)
    whole, line = b"".join(lines), {"first line": 0, "last line": 5}.get(damage)
    kept = bytearray({"all": b"\0\0\0", "end": whole[:-20] + b"\0\0\0"}.get(damage, whole))
    if line is not None:
        kept[sum(map(len, lines[:line])) + 20] ^= 1
    path.write_bytes(bytes(kept))
    assert resumed(tmp_path).equals(undisturbed)
    # Beside the six pieces the line that is no longer read.
    assert lines_in(tmp_path) == (6 if damage == "all" else 7), "only the lost piece is computed"


def test_stopping_does_not_wait_for_cases_under_way(monkeypatch):
    """Cases may take half a minute each; whoever stops a sweep would think that it hangs."""
    bystander = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(200,))
    bystander.start()
    monkeypatch.setattr("mtcommission.sweep.lanes.solve_piece", time.sleep)
    works: Any = iter((0.0, 200.0))
    try:
        start = time.monotonic()
        with closing(solve_pieces(works, Engine(workers=2), notice=print)) as solved:
            next(solved)
        assert time.monotonic() - start < 60.0
        assert bystander.is_alive(), "only the sweep's own workers may be ended"
    finally:
        bystander.kill()
        bystander.join()


def test_lost_worker_and_any_number_of_workers(tmp_path, undisturbed):
    """A killed process costs its piece at most; two processes give the rows of one."""
    killed: list[int] = []

    def kill_one(done, total, failures):
        children = multiprocessing.active_children()
        if not killed and children:
            killed.append(children[0].pid or 0)
            os.kill(killed[0], signal.SIGKILL)

    found = frame_of(MASSES_PLAN, tmp_path, engine=Engine(workers=2), progress=kill_one)
    assert killed
    assert found.equals(undisturbed)


# Folders


def test_store_of_another_sweep_is_refused(tmp_path):
    """Mixed rows of two sweeps would look like one; what never began is begun anew."""

    def stop(done, *_):
        raise KeyboardInterrupt

    plan = values_of("drive.max_force", "2 kN")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mtcommission.sweep.lanes.solve_piece", stop)
        with pytest.raises(ComputationError):
            run_sweep(MASSES_PLAN, folder=tmp_path)
    run_sweep(plan, folder=tmp_path)
    with pytest.raises(InputError, match="holds a sweep already"):
        run_sweep(plan, folder=tmp_path)
    other = replace(plan, profile_text=TEXT.replace("750 kg", "751 kg"))
    with pytest.raises(InputError, match="holds another sweep"):
        run_sweep(other, folder=tmp_path, resume=True)


def test_a_second_sweep_into_the_same_folder_is_refused(tmp_path):
    """Two writers would compute everything twice and mix their lines."""
    with hold_folder(tmp_path):
        second = subprocess.run(
            command(tmp_path, "--resume"), capture_output=True, text=True, check=False
        )
        assert second.returncode == 2
        assert "another sweep is at work there" in second.stderr


@pytest.mark.parametrize(
    ("name", "is_link"), [("rows.csv", False), (NAME, False), (NAME, True), (LOCK, True)]
)
def test_files_of_others_are_left_alone(tmp_path, name, is_link):
    """The target of a link named .lock was once truncated."""
    theirs, folder = tmp_path / "theirs", tmp_path / "out"
    folder.mkdir()
    if is_link:
        (folder / name).symlink_to(theirs)
    else:
        theirs = folder / name
    theirs.write_text("mine\n")
    for resume in (False, True):
        with pytest.raises(InputError, match="give another folder" if is_link else name):
            run_sweep(MASSES_PLAN, folder=folder, resume=resume)
    assert theirs.read_text() == "mine\n"


# Page

LOOK = """
addEventListener("load", () => {
  const all = (selector) => [...document.querySelectorAll(selector)];
  const found = {
    x: document.querySelector("#wi-x").value,
    log: document.querySelector("#wi-log").checked,
    names: all("#wi-x option").map((option) => option.textContent),
    labels: showTicks([1.99995, 2]).map(([, text]) => text)};
  all("#wi-head button")[1].click();
  all("#wi-head button")[1].click();
  document.querySelector("#wi-cases button").click();
  found.sorted = all("#wi-cases button").map((one) => one.textContent);
  found.profile = document.querySelector("#wi-profile").textContent;
  found.paper = getComputedStyle(document.body).backgroundColor;
  const look = () => {
    const plots = all(".pictures svg");
    // On a busy machine the plots are drawn later.
    if (!plots.every((one) => one.childElementCount)) { setTimeout(look, 200); return; }
    const {fill} = getComputedStyle(document.querySelector("svg text"));
    const marks = all("#wi-plots .hit").map((one) => one.getAttribute("d").split("M").length - 1);
    const ink = Math.max(...fill.match(/[0-9]+/g).map(Number));
    tell({...found, drawn: plots.length, marks, ink});
  };
  setTimeout(look, 500);
});
"""

CASES = """\
f_max,plant.base_stiffness
1 kN,40N/um
9 kN,45N/um
3 kN,45N/um
100,0N/um
300,45N/um
"""


@pytest.mark.skipif(CHROMIUM is None, reason="needs the browser chromium")
def test_page_in_a_browser(tmp_path):
    """Sorting, the profile behind a row and the plots work where people will open the page.

    It begins with the key that has most values, in units as people write them; ticks that lie
    closer than four digits do not carry the same number; in the dark the numbers beside the axes
    are bright.
    """
    plan = plan_of(read_cases(CASES, where="c"))
    table = read_table(plan, run_sweep(plan, folder=tmp_path))
    page = print_sweep(plan, table, WORDS, created="2025-01-01")
    options = ("--blink-settings=preferredColorScheme=0", "--window-size=1300,4000")
    seen, console = browse(page, tmp_path, TELL + LOOK, *options)
    assert "Uncaught" not in console
    assert (seen["x"], seen["log"]) == ("drive.max_force", True)
    assert seen["names"] == ["Max force [kN]", "Base stiffness [MN/m]"]
    assert seen["labels"] == ["1.99995", "2"]
    assert seen["sorted"] == ["1", "2", "0", "4", "3"], "by F_max, down"
    expected = vary_profile(TEXT, plan.settings(1), where="p")
    assert parse_profile(seen["profile"], where="p") == parse_profile(expected, where="p")
    # One for each column, and two of several columns at once.
    assert seen["drawn"] == len(data_of(page)["plotted"]) + 2
    assert seen["paper"] == "rgb(22, 22, 22)"
    assert seen["ink"] > 140
    assert seen["marks"] == [table.done] * len(data_of(page)["plotted"])


def test_page_runs_nothing_but_its_own_script(tmp_path):
    """A profile from elsewhere must not bring a script, nor the page call any network."""
    hostile = TEXT.replace('name = "', 'name = "</script><script>alert(1)</script>', 1)
    plan = replace(plan_of(), profile_text=hostile, where="<b>x</b>")
    page = print_sweep(plan, read_table(plan, run_sweep(plan, folder=tmp_path)), WORDS, created="")
    assert page.count("<script") == 3, "the plots' data, the columns, the page's own"
    assert "<b>" not in page
    assert "default-src 'none'" in html.unescape(page)
    assert not re.search(r'src=|href=(?!"#)|https?://', page.split('id="plots"')[0])


# Clusters


def local_cluster(workers: int) -> Any:
    distributed = pytest.importorskip("distributed")
    return distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, dashboard_address=":0", silence_logs=50
    )


def test_cluster_gives_the_same_rows_and_survives_a_lost_worker(tmp_path, undisturbed):
    """A Dask cluster that loses a worker must neither lose nor change a row."""
    killed: list[int] = []
    with local_cluster(2) as cluster:

        def kill_one(done, total, failures):
            if not killed:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        engine = Engine(scheduler=cluster.scheduler_address)
        found = frame_of(MASSES_PLAN, tmp_path, engine=engine, progress=kill_one)
    assert killed
    assert found.equals(undisturbed)


def test_cluster_without_workers_says_so_and_goes_on_with_the_first(tmp_path):
    """A bar that stands still for ever tells nobody what to start."""
    told: list[str] = []
    with local_cluster(0) as cluster:

        def start_one(note):
            told.append(note.kind)
            cluster.scale(1)

        engine = Engine(scheduler=cluster.scheduler_address)
        found = frame_of(plan_of(), tmp_path, engine=engine, notice=start_one)
    assert told == ["sweep-waits"]
    assert found["certified"].to_list() == [True]


def test_lost_scheduler_names_resume(tmp_path, undisturbed):
    pytest.importorskip("distributed")
    with closing(socket.create_server(("127.0.0.1", 0))) as free:
        port = free.getsockname()[1]
    address, module = f"tcp://127.0.0.1:{port}", "distributed.cli.dask"
    begin = [sys.executable, "-m", f"{module}_scheduler", "--no-dashboard", "--port", str(port)]
    join = [sys.executable, "-m", f"{module}_worker", address, "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    scheduler = subprocess.Popen([*begin, "--host", "127.0.0.1"], **quiet)
    worker = subprocess.Popen([*join, "--nthreads", "1", "--nworkers", "1"], **quiet)
    how: Any = {"engine": Engine(scheduler=address), "progress": lambda *_: scheduler.kill()}
    try:
        _wait_for_port(port)
        with pytest.raises(ComputationError, match=r"of 24 cases are on disk.* --resume") as lost:
            run_sweep(MASSES_PLAN, folder=tmp_path, **how)
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()
    assert lost.value.outcome is Outcome.SCHEDULER_LOST
    assert resumed(tmp_path).equals(undisturbed)


def _wait_for_port(port: int) -> None:
    while True:
        with suppress(OSError), closing(socket.create_connection(("127.0.0.1", port))):
            return
        time.sleep(0.1)


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("http://127.0.0.1:1", r"must be an address.*tcp://HOST:PORT or tls://"),
        ("tls://127.0.0.1:1", r"no scheduler answers.*tls:// needs certificates"),
        ("tcp:nowhere", "no scheduler answers"),
    ],
)
def test_an_address_of_no_use_is_wrong_input(address, message, tmp_path):
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match=message):
        run_sweep(plan_of(), folder=tmp_path, engine=Engine(scheduler=address))


@pytest.mark.parametrize("said", [b"HTTP/1.1 400 Bad Request\r\n\r\nno Dask here", b""])
def test_what_is_no_scheduler_is_said_to_be_none(said, tmp_path, monkeypatch):
    """Foreign answers were internal errors, and silence was waited for without end."""
    pytest.importorskip("distributed")
    monkeypatch.setattr("mtcommission.sweep.lanes.PATIENCE", 5.0)
    with socket.create_server(("127.0.0.1", 0)) as server:
        port, held = server.getsockname()[1], []

        def answer():
            with suppress(OSError):
                while True:
                    held.append(server.accept()[0])
                    held[-1].sendall(said)

        threading.Thread(target=answer, daemon=True).start()
        engine = Engine(scheduler=f"tcp://127.0.0.1:{port}")
        with pytest.raises(InputError, match="no scheduler answers"):
            run_sweep(values_of("drive.max_force", "1kN"), folder=tmp_path, engine=engine)
        for one in held:
            one.close()


def test_an_optimum_that_is_not_proved_is_named_with_its_gap():
    """The command ended with 1 and did not say for which case."""
    rows = [(0, 1e-12, True), (1, 9.2e-8, False), (2, 3e-7, False)]
    frame = pl.DataFrame(rows, schema=["case", "relative_gap", "certified"], orient="row")
    frame = frame.with_columns(outcome=pl.lit("done"), message=pl.lit(""))
    table = SweepTable(columns=(), frame=frame, asked=Message("sweep-count-done", count=3))
    _, said = summarise(table, Catalogue())
    assert "case 1: at most 9.2e-08" in said
