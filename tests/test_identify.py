"""The command identify: files in, profile, page and JSON out; a profile keeps its lines.

If one of these fails, a measured axis does not get into the profile, or a profile loses what its
owner wrote.
"""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.identify.gather import gather
from mtcommission.identify.identified import identify
from mtcommission.identify.profile import Writing, merge_profile, write_profile
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.measured.measurement import Given
from mtcommission.record.machine import list_data
from tests import identify_files as made
from tests.conftest import Run


def _how(*, tool_ratio: float | None = None) -> Writing:
    return Writing(
        file="machine.toml", tool_ratio=tool_ratio, words=lambda rotary: Catalogue(rotary=rotary)
    )


def table_file(path: Path, *, sensor: str = "encoder", seed: int = 0) -> str:
    f = made.LINES
    return made.save_response(path, f, made.response(f, sensor=sensor), noise=0.01, seed=seed)


def _both_files(folder: Path) -> list[str]:
    tool = table_file(folder / "t.csv", sensor="tcp", seed=1)
    return [table_file(folder / "e.csv"), f"{tool}@tcp"]


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    files = _both_files(tmp_path_factory.mktemp("measured"))
    return identify(gather(files, Given()), created="2026-11-22")


@pytest.fixture(scope="module")
def encoder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("measured")
    found = gather([table_file(folder / "e.csv")], Given())
    return identify(found, created="2026-11-22")


def test_a_new_profile_holds_what_was_measured_and_asks_for_the_rest(both) -> None:
    text = write_profile(both, _how()).profile
    data = tomllib.loads(text)
    assert float(data["plant"]["moving_mass"].split()[0]) == pytest.approx(made.MASS, rel=0.01)
    for mode, (hertz, zeta, own, tool) in zip(data["plant"]["modes"], made.MODES, strict=True):
        assert float(mode["frequency"].split()[0]) == pytest.approx(hertz, rel=2e-3)
        assert mode["damping_ratio"] == pytest.approx(zeta, rel=0.05)
        assert float(mode["measured_gain"].split()[0]) == pytest.approx(own, rel=0.03)
        assert float(mode["tcp_gain"].split()[0]) == pytest.approx(tool, rel=0.03)
    assert "#   drive.max_force" in text
    # One state of the machine says nothing of the others.
    spreads = ["requirements.frequency_spread", "requirements.damping_spread"]
    assert data["machine"]["assumed"] == spreads


def test_the_users_word_on_the_tool_scales_the_share_of_the_encoder(encoder) -> None:
    data = tomllib.loads(write_profile(encoder, _how(tool_ratio=-1.5)).profile)
    mode = data["plant"]["modes"][0]
    own, tool = (float(mode[key].split()[0]) for key in ("measured_gain", "tcp_gain"))
    assert tool == pytest.approx(-1.5 * own, rel=1e-3)


REAL = read_shipped("modal-two-modes").text.replace("illustrative = true\n", "")
"""A profile whose numbers somebody stands for."""


def test_merging_touches_no_other_line_and_keeps_names_and_unmeasured_gains(encoder) -> None:
    found = merge_profile(REAL, encoder, _how())
    machine = parse_profile(found.profile, where="merged.toml")
    changed = ("moving_mass", "frequency", "damping_ratio", "measured_gain", "damping_spread")
    kept = [
        line
        for line in REAL.splitlines()
        if not line.startswith((*changed, "frequency_spread"))
        and not any(word in line for word in ('name = "ram"', "-2.4e-3", "[[plant.modes]]"))
    ]
    lines = found.profile.splitlines()
    assert [line for line in kept if line not in lines] == []
    data = tomllib.loads(found.profile)
    assert data["plant"]["modes"][0]["name"] == "beam"
    assert data["plant"]["modes"][0]["tcp_gain"] == "1.9e-3 1/kg"
    assert len(data["plant"]["modes"]) == 2  # 81 Hz is in the band and does not show: it goes
    # What no sensor showed is said to be an assumption, on the terminal as in the profile.
    assert machine.is_assumed("plant.modes[1].tcp_gain")
    assert not machine.is_assumed("drive.max_force")
    (warning,) = (one for one in found.part.warnings if one.kind == "identify-gains-stay")
    assert warning.values["gains"] == ("plant.modes[1].tcp_gain = 1.9e-3 1/kg",)


def test_weights_and_bounds_of_states_that_are_no_more_go_with_a_remark(encoder) -> None:
    """The manipulator has other states: a profile that named them was refused afterwards."""
    old = read_shipped("milling-manipulator").text
    bounds = '[requirements.peaks]\nv_phi = "5 mrad/s"\ntcp = "1 mm"\n\n[damping_optimal]'
    text = old.replace("[damping_optimal]", bounds)
    found = merge_profile(text, encoder, _how())
    machine = parse_profile(found.profile, where="merged.toml")
    assert [one.name for one in machine.requirements.peaks] == ["tcp"]
    (warning,) = (one for one in found.part.warnings if one.kind == "identify-states-gone")
    weights = [f"damping_optimal.weights.{name}" for name in ("x_b", "phi", "v_b", "v_phi")]
    assert warning.values["keys"] == (*weights, "requirements.peaks.v_phi")


def test_an_example_whose_mass_and_modes_were_measured_is_one_no_more(encoder) -> None:
    """The gain at the tool is no knowledge of this machine, and its drive is assumed."""
    text = merge_profile(read_shipped("modal-two-modes").text, encoder, _how()).profile
    machine = parse_profile(text, where="merged.toml")
    assert not machine.illustrative
    assert machine.source == "identified from e.csv on 2026-11-22"
    sources = {
        one.key: one.source if isinstance(one.source, str) else one.source.kind
        for one in list_data(machine, build_plant(machine), text)
    }
    wanted = {
        "plant.moving_mass": "source-measured",
        "plant.modes.beam.frequency": "source-measured",
        "plant.modes.beam.measured_gain": "source-measured",
        "plant.modes.beam.tcp_gain": "source-accepted-default",
        "drive.max_force": "source-accepted-default",
        "moves[1].distance": "source-stated",
    }
    assert {key: sources[key] for key in wanted} == wanted


def test_a_record_is_explained_by_the_model_that_came_from_it(tmp_path) -> None:
    rng = np.random.default_rng(3)
    step = 1e-3
    files = []
    for place in range(2):
        force = 50 * rng.normal(size=12000)
        encoder, _ = made.positions(force, step)
        velocity = np.gradient(encoder, step)
        t = step * np.arange(force.size)
        path = tmp_path / f"record-{place}.csv"
        path.write_bytes(made.table(["t [s]", "force [N]", "velocity [m/s]"], [t, force, velocity]))
        files.append(str(path))
    checks = identify(gather(files, Given())).part.checks
    assert [one.held_back for one in checks] == [False, False, True]
    assert all(one.explained > 0.9 for one in checks)


def test_the_command_writes_profile_page_and_json(run: Run, tmp_path) -> None:
    files = _both_files(tmp_path)
    out, page, entry = (tmp_path / name for name in ("m.toml", "identify.html", "i.json"))
    written = ("-o", str(out), "--page", str(page), "--json", str(entry))
    code, _, errors = run("identify", *files, *written, "--language", "de")
    assert code == 0, errors
    found = json.loads(entry.read_text())
    assert found["profile"] == out.read_text()
    assert found["delay"]["value"] == pytest.approx(made.DELAY, rel=0.05)
    assert "Eigenformen" in page.read_text()


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--band", "300:8", '--band: got "300:8", must be LOW:HIGH'),
        ("--constant", "3 kg", '--constant: got "3 kg", must be a number other than 0 in N/A'),
        ("--columns", "force", '--columns: got "force", must be NAME=COLUMN'),
    ],
)
def test_a_wrong_option_is_named(run: Run, tmp_path, option: str, value: str, said: str) -> None:
    code, _, errors = run("identify", table_file(tmp_path / "e.csv"), option, value)
    assert code == 2
    assert said in errors


def test_a_measurement_given_twice_is_a_fault(run: Run, tmp_path) -> None:
    """As two measurements it halved every interval."""
    first = table_file(tmp_path / "e.csv")
    (tmp_path / "copy.csv").write_bytes(Path(first).read_bytes())
    code, _, errors = run("identify", first, f"{tmp_path / 'copy.csv'}@tcp")
    assert code == 2
    assert f"copy.csv: holds the same measurement as {first}" in errors


def test_a_sensor_at_the_load_is_not_taken_for_the_motors_encoder(run: Run) -> None:
    """Its mode swings against the force: as encoder it made the loop stable where it is not."""
    file = made.REAL / "fdi-motor-bench" / "frf-current-to-load-velocity.csv"
    code, _, errors = run("identify", str(file), "--constant", "1")
    assert code == 2
    assert "at 76.26 Hz the mode moves against the force (-1.005 of" in errors
    for said in ("tcp", "encoder"):
        code, printed, errors = run("identify", str(file), "--constant", "1", "--sensor", said)
        assert code == 0, errors
        assert "76.26" in printed
