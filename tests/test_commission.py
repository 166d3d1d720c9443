"""The whole chain on every shipped profile, and the record as an outsider would check it."""

from __future__ import annotations

import json
from dataclasses import replace
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.cli.compute import ROWS_BELOW
from mtcommission.cli.limits_view import OF_LOOP, ROWS, describe_limits
from mtcommission.cli.terminal import fold
from mtcommission.commission.commission import Commissioning, commission
from mtcommission.machine.machine import Motion
from mtcommission.machine.profile.read import parse_profile, read_profile
from mtcommission.record.limits import limits_answer
from mtcommission.record.machine import Profile
from mtcommission.record.record import Record, build_record, load_record
from mtcommission.record.shape import dump_json
from tests.independent_loop import Run, judge, profile_of_record, simulate_record

PROFILES = sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))


@pytest.fixture(scope="module", params=PROFILES, ids=lambda path: path.stem)
def path(request: pytest.FixtureRequest) -> Path:
    return Path(request.param)


@pytest.fixture(scope="module")
def found(path: Path) -> Commissioning:
    return commission(read_profile(path))


@pytest.fixture(scope="module")
def record(found: Commissioning, path: Path) -> Record:
    return build_record(
        found,
        profile=Profile(name="p.toml", sha256="0" * 64, text=path.read_text("utf-8")),
        created="2026-01-01T00:00:00+00:00",
        warnings=[],
    )


def test_every_shipped_profile_meets_its_requirements(found: Commissioning) -> None:
    """A shipped example that fails would teach users that a red verdict is normal."""
    assert found.assessment.is_met, found.assessment.checks


def test_optima_are_certified_and_faster_than_the_recommendation(found: Commissioning) -> None:
    """Exact rest in the least time: no setpoint through a loop can be ahead of it by much."""
    for optima, result in zip(found.optima, found.moves, strict=True):
        assert optima.time.certificate.relative_gap < 1e-6
        assert optima.time.t_f < result.responses[0].settling_time


def test_record_simulated_again_by_an_outsider(record: Record) -> None:
    """Closed-loop matrices, segments and the filter alone must give what the record claims."""
    _simulate_again(json.loads(dump_json(record)))


def test_record_alone_gives_a_second_program_the_loop(record: Record) -> None:
    """What a loop does must follow from its record: gains, cycles, delays, filters, observer."""
    if record.machine.follows:
        pytest.skip("no loop: tests/test_position_source.py integrates the equation itself")
    data = json.loads(dump_json(record))
    data["loop"]["encoder_resolution"] = 0.0  # its steps are counted beside the response
    tau = data["loop"]["reference_delay"]
    band = parse_profile(record.profile.text, where="record.json").requirements.tcp_deviation
    for move in data["moves"]:
        claimed, end = move["response"], move["setpoint"]["duration"]
        motion = simulate_record(data, move, until=end + tau + 0.4)
        found = judge(motion, profile_of_record(move), tau=tau, band=band)
        assert found.residual == pytest.approx(claimed["residual_deviation"], rel=1e-5)
        assert found.settling_time == pytest.approx(claimed["settling_time"], rel=1e-5)
        assert motion.asked == pytest.approx(claimed["max_force"], rel=1e-5)


def _simulate_again(record: dict[str, Any]) -> None:
    loop = record["loop"]["closed_loop"]
    A, B, C, D = (np.array(loop[key]) for key in ("A", "B", "C", "D"))
    tau, dt, cycle = record["loop"]["reference_delay"], loop["dt"], record["loop"]["velocity_cycle"]
    band = next(item for item in record["data"] if item["key"].endswith("tcp_deviation"))["value"]
    assert isinstance(band, float)
    tool = [i for i, name in enumerate(loop["outputs"]) if name.startswith("tcp[")]
    force = [i for i, name in enumerate(loop["outputs"]) if name.startswith("force[")]
    for entry in record["moves"]:
        claimed, t_e = entry["response"], entry["setpoint"]["duration"]
        setpoint, none = profile_of_record(entry), np.zeros(0)
        count = ceil((t_e + tau + 1.5) / dt)
        X, tcp, set_force = np.zeros(len(A)), [], []
        for k in range(count):
            r = setpoint.at(k * dt)
            Y = C @ X + D @ r
            tcp.append(Y[tool])
            set_force.append(Y[force])
            X = A @ X + B @ r
        position, asked = np.concatenate(tcp), float(np.max(np.abs(set_force)))
        t = np.arange(position.size) * cycle
        seen = Run(t, position, none, none, none, asked)
        found = judge(seen, setpoint, tau=tau, band=band)
        assert found.residual == pytest.approx(claimed["residual_deviation"], rel=1e-2)
        assert found.settling_time == pytest.approx(claimed["settling_time"], rel=1e-2)
        assert asked == pytest.approx(claimed["max_force"], rel=1e-2)


def test_record_survives_its_file(record: Record, tmp_path: Path) -> None:
    path = tmp_path / "record.json"
    path.write_text(dump_json(record), "utf-8")
    assert load_record(path) == record


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_terminals_answer_fits_one_screen(found: Commissioning, language: str) -> None:
    """If it failed, what was asked for would have scrolled away; 80 x 24, prompt included."""
    machine = found.machine
    words = Catalogue(language, rotary=machine.motion is Motion.ROTARY)
    answer, notes = limits_answer(found), ["a long note that wraps " * 20, "and a short one"]
    warned = [
        words.say(one)
        for one in answer.warnings
        if not (isinstance(one, Message) and one.kind in OF_LOOP)
    ]
    for rows, rules in ((ROWS - ROWS_BELOW, []), (ROWS - 1, answer.rules)):
        shortened = replace(answer, rules=rules)
        shown_with = {"assumed": ["x = 1 kg"] * 40, "further": notes, "rows": rows}
        lines = fold(describe_limits(machine, shortened, words, **shown_with))
        assert len(lines) <= rows + (2 if warned else 0)  # none of them is left out
        assert max(map(len, lines)) <= 80
        shown = "\n".join(lines)
        best = found.recommended
        for told in (
            *(one.split()[-1] for one in warned),
            machine.name,
            words.text("verdict-met" if found.assessment.is_met else "verdict-not-met"),
            words.say(found.choice.bound_by),
            words.format.axis(best.limits.acceleration, "m/s^2"),
            words.format.axis(best.peak_deviation, "m"),
            words.text("terminal-assumed", what="").split(":")[0],
        ):
            assert told in shown


def test_recommendation_beats_every_rule_that_keeps_the_reserve(record: Record) -> None:
    """If a rule of thumb met all that is wanted and were faster, nobody should use the tool."""
    best = record.limits.recommended.settling_time
    assert best is not None
    for rule in record.limits.rules:
        # Shapers are another function: beside a loop that leaves the mode alone they may be sooner.
        if rule.keeps_reserve and rule.name.kind not in ("shaper-for-mode",):
            assert rule.settling_time is not None
            assert rule.settling_time >= 0.99 * best
