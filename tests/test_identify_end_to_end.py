"""Measure, identify, choose limits, and judge them on the axis that was measured.

If this fails, a user follows the program from his measurement to limits, and the tool leaves the
band on his machine.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import Candidate, evaluate
from mtcommission.loop.tuning.tuned import CornerPlants, TunedLoop, close_loop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import NOMINAL, Machine
from mtcommission.machine.plant.plant import OUTPUTS, Plant, build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.setpoint.motion_limits import MotionLimits
from tests import identify_files as made
from tests import measured_example

TRUE = read_shipped("modal-two-modes").text.replace('"38 Hz"', '"33.7 Hz"')
"""What nobody knows."""

KNOWN = {
    "drive": {"max_force": "2.4 kN"},
    "moves": [{"distance": "15 mm", "max_velocity": "0.4 m/s"}],
    "requirements": {"tcp_deviation": "8 um", "max_settling_time": "0.5 s"},
    "control": {"position_cycle": "1 ms", "velocity_cycle": "125 us"},
}
"""What the machine's papers say."""

LAG = 0.6e-3
"""Of the force [s]; a response from the set force holds it, and shows it as delay."""

LINES = np.linspace(1.0, 500.0, 500)


def _complete(profile: str, *, force_lag: float) -> Machine:
    document = tomlkit.parse(profile)
    for name, table in KNOWN.items():
        if isinstance(table, dict):
            document.setdefault(name, tomlkit.table()).update(table)
        else:
            document[name] = table
    document["drive"]["force_lag"] = f"{force_lag:.9g} s"  # type: ignore[index]
    return parse_profile(tomlkit.dumps(document), where="axis.toml")


def _measure(path: Path, plant: Plant, *, sensor: str, seed: int) -> str:
    """Velocity per force, as an analyser writes it."""
    s, eye = 2j * np.pi * LINES, np.eye(plant.A.shape[0])
    row = plant.C[OUTPUTS.index(sensor)]
    H = s * [row @ np.linalg.solve(one * eye - plant.A, plant.B.ravel()) for one in s]
    how = {"noise": 0.02, "averages": 25, "comments": f"# sensor = {sensor}\n"}
    return made.save_response(path, LINES, H, seed=seed, **how)


def _judge(true: Machine, machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> Candidate:
    """Limits on the true axis, in the loop that was tuned on the identified one."""
    plant = build_plant(true)
    both = CornerPlants(corners=(NOMINAL, NOMINAL), plants=(build_plant(machine), plant))
    closed = close_loop(both, tuned.controller)
    alone = replace(
        closed,
        corners=closed.corners[1:],
        loops=closed.loops[1:],
        responses=closed.responses[1:],
        analyses=closed.analyses[1:],
    )
    return evaluate(true, alone, limits)


def test_readme_s_example_is_what_its_program_makes_and_its_commands_run(
    run, tmp_path, monkeypatch
):
    root = Path(__file__).parent.parent
    example = root / "profiles" / "modal-two-modes.csv"
    assert example.stat().st_size < 60_000
    shown, made_now = (
        np.loadtxt(text.splitlines(), delimiter=",", skiprows=5)
        for text in (example.read_text(encoding="utf-8"), measured_example.table())
    )
    np.testing.assert_allclose(shown, made_now, rtol=1e-4, atol=1e-6 * np.abs(shown[:, 1]).max())
    readme = (root / "README.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "profiles").symlink_to(root / "profiles")
    for command in ("identify", "check"):
        (line,) = re.findall(rf"^mtcommission ({command} .*\.toml)$", readme, re.MULTILINE)
        code, _, errors = run(*line.split())
        assert code == 0, errors
    known = parse_profile(
        Path("identified.toml").read_text(encoding="utf-8"), where="new"
    ).identified
    assert known is not None
    assert known.moving_mass is not None
    pairs = [(known.moving_mass, measured_example.MASS)]
    for seen, true in zip(known.modes, measured_example.MODES, strict=True):
        own = seen.frequency_hz, seen.damping_ratio, seen.measured_gain
        pairs += [(one, value) for one, value in zip(own, true, strict=True) if one]
    assert len(pairs) == 7
    for one, value in pairs:
        assert abs(one.value - value) < 3.5 * one.sigma


def test_limits_of_the_identified_axis_hold_on_the_true_one(run, tmp_path):
    true = _complete(TRUE, force_lag=LAG)
    files = [
        _measure(tmp_path / f"{sensor}.csv", build_plant(true), sensor=sensor, seed=seed)
        for seed, sensor in enumerate(("encoder", "tcp"))
    ]
    profile, entry = tmp_path / "axis.toml", tmp_path / "axis.json"
    code, _, errors = run("identify", *files, "-o", str(profile), "--json", str(entry))
    assert code == 0, errors
    found = json.loads(entry.read_text())
    # Who measured from the set force sees the lag.
    lag = found["delay"]["value"] + found["lag"]["value"]
    assert lag == pytest.approx(LAG, rel=0.05)
    machine = _complete(profile.read_text(), force_lag=lag)
    tuned = tune_loop(machine)
    assert len(tuned.corners) == 5  # the intervals are corners
    choice = choose_limits(machine, tuned)
    said, limits = choice.candidate, choice.limits
    assert said.assessment.is_met
    candidate = _judge(true, machine, tuned, limits)
    assert candidate.assessment.is_met
    assert candidate.settling_time <= 1.02 * said.settling_time
    # The judge is one that refuses: a jerk that no longer suits the modes shakes them.
    steep = MotionLimits(acceleration=limits.acceleration, jerk=3.0 * limits.jerk)
    assert not _judge(true, machine, tuned, steep).assessment.is_met
