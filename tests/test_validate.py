"""If these fail, the comparison with the paper says "agrees" without having looked."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.optimal.control import follow_control
from mtcommission.validate import page
from mtcommission.validate.damping import damping_rows
from mtcommission.validate.page import Validation, print_validation, validate
from mtcommission.validate.paper import T_F, Claim, Number, Row, Verdict, tell
from mtcommission.validate.state_bound import bounded_rows
from mtcommission.validate.time_optimal import scan_forces, time_rows
from tests.conftest import Run
from tests.machines import paper_machine

STEP = VelocityStep(velocity_step=0.1)


@pytest.fixture(scope="module")
def found() -> Validation:
    return validate()


@pytest.fixture(scope="module")
def plant() -> Plant:
    return build_plant(paper_machine())


def pick(rows: list[Row], key: str, **values: object) -> Row:
    of_key = [row for row in rows if row.source.key == key]
    (row,) = [row for row in of_key if {**row.values, **values} == row.values]
    return row


def test_every_row_is_explained(found: Validation) -> None:
    """The command's exit code: an unexplained difference is a fault of ours."""
    assert [row.source.key for row in found.rows if row.verdict is Verdict.OUT] == []
    assert found.is_met
    assert {row.source.key for row in found.rows if row.verdict is Verdict.DIFFERS} == {
        "law-as-printed",
        "switches-everywhere",
        "bang-arcs",
        "hints",
    }
    for language in LANGUAGES:
        told = [(row, tell(row, Catalogue(language))) for row in found.rows]
        assert all(one.reason for row, one in told if row.verdict is not Verdict.AGREES)
        assert all(one.basis and one.ours and one.quantity for _, one in told)


def test_numbers_are_judged_by_their_tolerance() -> None:
    def verdict(printed: float, ours: float, correct: float | str = "") -> Verdict:
        return Number("increase", "5.2", printed, correct=correct).beside(ours, 0.1).verdict

    assert verdict(1.0, 1.09) is Verdict.AGREES
    assert verdict(1.0, 1.11) is Verdict.OUT
    assert verdict(1.0, float("nan")) is Verdict.OUT
    assert verdict(3.0, 1.05, correct=1.0) is Verdict.CORRECTED
    assert verdict(3.0, 2.0, correct=1.0) is Verdict.OUT
    assert verdict(3.0, 3.05, "another name") is Verdict.CORRECTED
    assert verdict(3.0, 1.0, "another name") is Verdict.OUT


def test_a_wrong_solver_is_caught(found: Validation) -> None:
    """Solutions off by little more than the tolerances must not pass."""
    cases = found.cases
    late = replace(cases, time=replace(cases.time, t_f=T_F + 1.1e-4))
    assert pick(time_rows(late), "final-time").verdict is Verdict.OUT
    slow = replace(cases, bounded=replace(cases.bounded, t_f=0.0522 + 1.1e-4))
    assert pick(bounded_rows(slow), "bounded-time").verdict is Verdict.OUT
    motion = follow_control(cases.plant, cases.damping.arcs)
    louder = replace(motion, peaks=cases.damping.peaks * 1.003)
    loud = replace(cases, damping=replace(cases.damping, motion=louder))
    assert pick(damping_rows(loud), "peak-rate", control="damping").verdict is Verdict.OUT
    certificate = replace(cases.bounded.certificate, relative_gap=1e-6)
    unproved = replace(cases, bounded=replace(cases.bounded, certificate=certificate))
    arcs = pick(bounded_rows(unproved), "bang-arcs")
    assert arcs.verdict is Verdict.OUT


def test_scan_finds_the_range_of_seven_switches(plant: Plant) -> None:
    scan = scan_forces(plant, STEP, np.geomspace(1200.0, 1350.0, 6).tolist())
    assert scan.gap < 1e-9
    assert {len(optimum.switching_times) for optimum in scan.exceptions} == {7}
    (found,) = scan.ranges
    assert found == pytest.approx((7, 1252.65, 1294.6), rel=2e-4)
    ((_, lowest, _),) = scan_forces(plant, STEP, [1270.0, 1310.0, 1350.0]).ranges
    assert lowest == pytest.approx(1270.0)


def documented_rows() -> list[list[str]]:
    """The cells of every row of docs/validation.md, without markdown's escapes."""
    text = (Path(__file__).parent.parent / "docs" / "validation.md").read_text(encoding="utf-8")
    lines = [line for line in text[text.index("### Plant") :].splitlines() if line[:1] == "|"]
    cells = [re.split(r"(?<!\\)\|", line)[1:-1] for line in lines]
    plain = [[unescape(re.sub(r"\\(.)", r"\1", cell)).strip() for cell in row] for row in cells]
    return [row for row in plain if row[0] not in ("place", "---")]


def test_documentation_holds_the_rows_of_the_command(found: Validation) -> None:
    """docs/validation.md is read by those who do not run the command."""
    documented = documented_rows()
    expected = [
        row
        for rows in found.parts.values()
        for row in sorted(rows, key=lambda row: isinstance(row.source, Claim))
    ]
    assert len(documented) == len(expected)
    for cells, row in zip(documented, expected, strict=True):
        told = tell(row, Catalogue())
        assert cells[:4] == [told.place, told.name, told.printed, told.corrected]
        assert cells[-1] == told.verdict
        if isinstance(row.source, Number):
            rounding = 0.0 if row.source.printed else row.tolerance
            assert float(cells[4]) == pytest.approx(row.ours, rel=1e-6, abs=rounding)


def test_page_names_first_what_does_not_hold(found: Validation) -> None:
    """A reader must not have to search 70 rows for what the paper got wrong."""
    printed = unescape(print_validation(found, Catalogue(), created="today"))
    head = printed[: printed.index('id="plant"')]
    assert "relative: agrees with the correction; paper: 0.23; correct: 0.1998621" in head
    assert head.count("differs, with reason;") == 4
    assert head.count("agrees with the correction;") == 9
    german = unescape(print_validation(found, Catalogue("de"), created="heute"))
    assert german.count("weicht begründet ab;") == 4


@pytest.mark.parametrize("is_met", [True, False])
def test_command(
    found: Validation, is_met: bool, monkeypatch: pytest.MonkeyPatch, run: Run, tmp_path: Path
) -> None:
    """argv -> JSON alone on standard output, the page in its folder, exit code by verdict."""
    row = Number("increase", "5.2", 1.0).beside(1.0 if is_met else 2.0, 0.0, own=1.0)
    parts = found.parts | {"conclusion": [*found.parts["conclusion"], row]}
    shown = replace(found, parts=parts)
    monkeypatch.setattr(page, "validate", lambda progress: shown)
    code, said, _ = run("validate", "--json", "-", "-o", tmp_path / "out")
    assert code == (0 if is_met else 1)
    entry = json.loads(said)
    assert entry["met"] is is_met
    assert len(entry["rows"]) == len(found.rows) + 1
    assert entry["rows"][-1]["difference"] == (0.0 if is_met else 1.0)
    assert (tmp_path / "out" / "validation.html").exists()
