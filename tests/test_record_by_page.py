"""A record and docs/feedback-loop.md must be enough to simulate the loop again."""

from __future__ import annotations

import json
from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

from mtcommission.commission.commission import commission
from mtcommission.controls.kind import PositionLoop
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine
from mtcommission.machine.profile.read import read_profile
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.record.machine import Profile
from mtcommission.record.record import build_record
from mtcommission.record.shape import dump_json
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine
from tests.recorded_loop import judge_record, simulate_record

PROFILES = Path(__file__).parent.parent / "profiles"

NOTCH = ForceFilter(kind="notch", natural_frequency=2 * pi * 150.0, damping=0.2)
LOW_PASS = ForceFilter(kind="low_pass", natural_frequency=2 * pi * 900.0, damping=0.7)


def machine_of(name: str) -> Machine:
    """Between them every position loop and all that a loop may have."""
    if name == "state feedback in the control":
        return quiet_copy(paper_machine(), has_tcp_sensor=True)
    modal = read_profile(PROFILES / "modal-two-modes.toml")
    modal = replace(modal, moves=modal.moves[:1])
    if name == "filters, interpolated":
        return quiet_copy(
            modal,
            position_loop=PositionLoop.INTERPOLATED,
            force_filters=(NOTCH, LOW_PASS),
            reference_model_time=2e-3,
            velocity_feedforward=1.0,
        )
    return quiet_copy(modal, position_loop=PositionLoop.DRIVE, setpoint_filter=moving_average(7e-3))


NAMES = ("state feedback in the control", "filters, interpolated", "moving average in the drive")


@pytest.mark.parametrize("name", NAMES)
def test_record_and_page_give_what_the_record_claims(name: str) -> None:
    """An outsider could not check a recommendation, or would find another machine."""
    machine = machine_of(name)
    record = json.loads(
        dump_json(
            build_record(
                commission(machine),
                profile=Profile(name="p.toml", sha256="0" * 64, text=""),
                created="2026-01-01T00:00:00+00:00",
                warnings=[],
            )
        )
    )
    assert bool(record["loop"]["state_feedback"]) == (name == NAMES[0])
    tau, band = record["loop"]["reference_delay"], machine.requirements.tcp_deviation
    for move in record["moves"]:
        claimed = move["response"]
        motion = simulate_record(record, move, until=move["setpoint"]["duration"] + tau + 0.5)
        found = judge_record(motion, move, tau=tau, band=band)
        assert found.settling_time == pytest.approx(claimed["settling_time"], rel=1e-6)
        assert found.residual == pytest.approx(claimed["residual_deviation"], rel=1e-6)
        assert found.peak == pytest.approx(claimed["peak_deviation"], rel=1e-6)
        assert motion.asked == pytest.approx(claimed["max_force"], rel=1e-6)
