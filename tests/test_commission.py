"""The whole chain on every shipped profile, and the record as an outsider would check it."""

from __future__ import annotations

import json
from copy import deepcopy
from dataclasses import replace
from math import ceil

import numpy as np
import pytest

from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.cli.compute import ROWS_BELOW
from mtcommission.cli.limits_view import OF_LOOP, ROWS, describe_limits
from mtcommission.cli.terminal import fold
from mtcommission.machine.machine import Motion
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped, shipped_names
from mtcommission.record.limits import LimitsAnswer
from mtcommission.record.record import Record, load_record
from mtcommission.record.shape import to_entry, to_plain
from tests.independent_loop import Run, judge, profile_of_record, simulate_record
from tests.sheet_record import run_of


@pytest.fixture(scope="module", params=shipped_names())
def ran(request):
    """The record of an example machine, and what ``limits`` prints of it."""
    return run_of(read_shipped(request.param).text)


@pytest.fixture(scope="module")
def record(ran):
    record: Record = to_entry(ran[0], Record)
    return record


def test_every_shipped_profile_meets_its_requirements_after_certified_optima(record):
    """A shipped example that fails would teach users that a red verdict is normal.

    Exact rest in the least time: no setpoint through a loop can be ahead of it by much.
    """
    assert record.assessment.met, record.assessment.checks
    for optima, move in zip(record.optima, record.moves, strict=True):
        assert optima.time.certificate.relative_gap < 1e-6
        assert optima.time.t_f < move.response.settling_time


def test_record_alone_gives_a_second_program_the_loop(ran, record):
    """What a loop does must follow from its record: gains, cycles, delays, filters, observer."""
    if record.machine.follows:
        pytest.skip("no loop: tests/test_position_source.py integrates the equation itself")
    data = deepcopy(ran[0])
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


def test_record_simulated_again_by_an_outsider(ran):
    """Closed-loop matrices, segments and the filter alone must give what the record claims."""
    record = ran[0]
    loop = record["loop"]["closed_loop"]
    A, B, C, D = (np.array(loop[key]) for key in ("A", "B", "C", "D"))
    tau, dt, cycle = record["loop"]["reference_delay"], loop["dt"], record["loop"]["velocity_cycle"]
    band = next(item for item in record["data"] if item["key"].endswith("tcp_deviation"))["value"]
    assert isinstance(band, float)
    tool = [i for i, name in enumerate(loop["outputs"]) if name.startswith("tcp[")]
    force = [i for i, name in enumerate(loop["outputs"]) if name.startswith("force[")]
    for entry in record["moves"][:1]:  # the matrices are the same for all
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


def test_record_survives_its_file(ran, tmp_path):
    path = tmp_path / "record.json"
    path.write_text(json.dumps(ran[0]), "utf-8")
    assert to_plain(load_record(path)) == ran[0]


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_terminals_answer_fits_one_screen(ran, language):
    """If it failed, what was asked for would have scrolled away; 80 x 24, prompt included."""
    machine = parse_profile(ran[0]["profile"]["text"], where="record.json")
    words = Catalogue(language, rotary=machine.motion is Motion.ROTARY)
    answer: LimitsAnswer = to_entry(ran[1], LimitsAnswer)
    notes = ["a long note that wraps " * 20, "and a short one"]
    best, warned = (
        answer.recommended,
        [
            words.say(one)
            for one in answer.warnings
            if not (isinstance(one, Message) and one.kind in OF_LOOP)
        ],
    )
    for rows, rules in ((ROWS - ROWS_BELOW, []), (ROWS - 1, answer.rules)):
        shortened = replace(answer, rules=rules)
        shown_with = {"assumed": ["x = 1 kg"] * 40, "further": notes, "rows": rows}
        lines = fold(describe_limits(machine, shortened, words, **shown_with))
        assert len(lines) <= rows + (2 if warned else 0)  # none of them is left out
        assert max(map(len, lines)) <= 80
        shown = "\n".join(lines)
        for told in (
            *(one.split()[-1] for one in warned),
            machine.name,
            words.text("verdict-met"),
            words.say(best.bound_by),
            words.format.axis(best.acceleration, "m/s^2"),
            words.format.axis(best.peak_deviation, "m"),
            words.text("terminal-assumed", what="").split(":")[0],
        ):
            assert told in " ".join(shown.split("\n"))  # it may wrap


def test_recommendation_beats_every_rule_that_keeps_the_reserve(record):
    """If a rule of thumb met all that is wanted and were faster, nobody should use the tool."""
    best = record.limits.recommended.settling_time
    assert best is not None
    for rule in record.limits.rules:
        # Shapers are another function: beside a loop that leaves the mode alone they may be sooner.
        if rule.keeps_reserve and rule.name.kind not in ("shaper-for-mode",):
            assert rule.settling_time is not None
            assert rule.settling_time >= 0.99 * best
