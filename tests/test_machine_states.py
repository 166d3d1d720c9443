"""If these fail, limits that one position of the machine bears are typed in for all of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.errors import InputError
from mtcommission.limits.judge import evaluate
from mtcommission.loop.tuning.tuned import close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Corner, Machine, corners, vary
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.setpoint.motion_limits import MotionLimits
from tests import identify_files as made

PROFILE = read_shipped("ball-screw").text
FAR = """
[[machine_states]]
name = "far end"
moving_mass = "2700 kg"
[[machine_states.modes]]
name = "screw"
frequency = "105 Hz"
"""


def parse(more: str) -> Machine:
    return parse_profile(PROFILE + more, where="axis.toml")


def test_a_state_is_the_plant_with_what_differs():
    machine = parse(FAR)
    plain, far = machine.mechanics, vary(machine, Corner(state="far end")).mechanics
    assert far.moving_mass == 2700.0
    (mode,), (own,) = far.modes, plain.modes
    assert mode.frequency_hz == pytest.approx(105.0)
    assert replace(mode, natural_frequency=own.natural_frequency) == own
    known = corners(parse(""))
    assert corners(machine)[: len(known)] == known
    assert corners(machine)[len(known) :] == tuple(
        replace(corner, state="far end") for corner in known[1:]
    )


def test_limits_are_judged_in_a_state_as_on_the_machine_that_is_always_in_it():
    machine = parse(FAR)
    plant, tuned = build_plant(machine), tune_loop(machine)
    limits = MotionLimits(acceleration=7.0, jerk=200.0)
    alone = replace(machine, mechanics=machine.mechanics_in("far end"), states=())
    bench = corner_plants(alone)
    bench = replace(bench, corners=(Corner(), *bench.corners), plants=(plant, *bench.plants))
    apart = evaluate(alone, close_loop(bench, tuned.controller), limits)
    without = corner_plants(replace(machine, states=()))
    near = evaluate(machine, close_loop(without, tuned.controller), limits)
    both = evaluate(machine, tuned, limits)
    for whole, *parts in zip(
        both.assessment.checks, apart.assessment.checks, near.assessment.checks, strict=True
    ):
        # Of what is far above its bound sizes are laid no closer than needed to tell so.
        rel = 1e-9 if whole.is_met else 2e-3
        assert whole.value == pytest.approx(max(one.value for one in parts), rel=rel)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (FAR + FAR, 'machine_states[2].name: got "far end" twice, names must differ'),
        (FAR.replace("screw", "skrew"), 'modes[1]: names none of the modes of [plant], must be "s'),
        (FAR.replace("moving_mass", "mass"), "machine_states[1].mass: unknown key"),
        (FAR.replace("105 Hz", "-5 Hz"), "machine_states[1].modes[1].frequency: got -5 Hz"),
        (FAR.replace('name = "far end"', ""), "machine_states[1].name"),
        ("machine_states = 3", "machine_states"),
    ],
)
def test_what_cannot_be_is_said_at_its_place(more, said):
    with pytest.raises(InputError) as refused:
        parse_profile(more + "\n" + PROFILE if "= 3" in more else PROFILE + more, where="axis.toml")
    assert any(said in str(fault) for fault in refused.value.faults)


def measure(path: Path, mass: float, frequency_hz: float, seed: int) -> str:
    """Velocity per force of a rigid mass with one mode."""
    f = np.arange(2.0, 300.0, 0.5)
    s, omega = 2j * np.pi * f, 2 * np.pi * frequency_hz
    H = s * (1.0 / (mass * s**2) + 9e-4 / (s**2 + 0.06 * omega * s + omega**2))
    return made.save_response(path, f, H, noise=0.025, seed=seed)


def test_two_measured_payloads_become_states_and_the_sheet_names_the_one_that_binds(run, tmp_path):
    files = [
        measure(tmp_path / "empty.csv", 800.0, 42.0, 1),
        measure(tmp_path / "full.csv", 1000.0, 34.0, 2),
    ]
    profile = tmp_path / "axis.toml"
    assert run("identify", *files, "-o", profile)[0] == 0
    more = """
[drive]
max_force = "4 kN"
force_lag = "1 ms"
[[moves]]
distance = "100 mm"
max_velocity = "0.5 m/s"
"""
    text = profile.read_text("utf-8") + more
    profile.write_text(text.replace("[requirements]", '[requirements]\ntcp_deviation = "20 um"'))
    code, out, _ = run("limits", profile)
    assert code == 0
    told = " ".join(out.split())
    code, again, _ = run("identify", files[0], "--profile", profile)
    assert code == 0
    assert "one alone: empty.csv, full.csv." in " ".join(again.split())
    assert "Bound by: residual deviation (state full.csv) and set force (state full.csv)" in told
