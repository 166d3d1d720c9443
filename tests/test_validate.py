"""If these fail, the comparison with the paper says "agrees" without having looked."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from html import unescape
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from mtcommission import cli
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.terminal import fold
from mtcommission.cli.validation_view import describe_validation
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.optimal.control import follow_control
from mtcommission.validate import page
from mtcommission.validate.adjoint import (
    law_residual,
)
from mtcommission.validate.bounded import bounded_rows, damping_rows
from mtcommission.validate.free import printed_control_error, scan_forces, time_rows
from mtcommission.validate.page import Validation, name_of, print_validation, validate
from mtcommission.validate.paper import SWITCHING_TIMES, T_F, Row, Verdict, claim, number, tell
from tests.machines import paper_machine

Array = NDArray[np.float64]

STEP = VelocityStep(velocity_step=0.1)
M_B, M_S, J, R, T = 450.0, 750.0, 40.0, 0.25, 2.5e-3
K_B, D_B, K, D = 4.441e7, 8500.0, 8.2e6, 1800.0


@pytest.fixture(scope="module")
def found() -> Validation:
    return validate()


@pytest.fixture(scope="module")
def plant() -> Plant:
    return build_plant(paper_machine())


def rate(x: Array, force: float) -> list[float]:
    """Eq. (1), typed in from the paper."""
    x_b, _, phi, v_b, v_s, v_phi, F = x
    return [
        v_b,
        v_s,
        v_phi,
        -(K_B * x_b + D_B * v_b + F) / M_B,
        F / M_S,
        (R * F - K * phi - D * v_phi) / J,
        (force - F) / T,
    ]


def integrate(x: Array, force: float, length: float) -> Array:
    solved = solve_ivp(
        lambda _, y: rate(y, force), (0.0, length), x, method="DOP853", rtol=1e-12, atol=1e-16
    )
    return np.asarray(solved.y[:, -1])


def pick(rows: list[Row], key: str, **values: object) -> Row:
    (row,) = [row for row in rows if row.key == key and {**row.values, **values} == row.values]
    return row


def test_every_row_is_explained(found: Validation) -> None:
    """The command's exit code: an unexplained difference is a fault of ours."""
    assert [row.key for row in found.rows if row.verdict is Verdict.OUT] == []
    assert found.is_met
    assert {row.key for row in found.rows if row.verdict is Verdict.DIFFERS} == {
        "law-as-printed",
        "switches-everywhere",
        "bang-arcs",
        "hints",
    }
    for language in LANGUAGES:
        told = [(row, tell(row, Catalogue(language))) for row in found.rows]
        assert all(one.reason for row, one in told if row.verdict is not Verdict.AGREES)
        assert all(one.basis and one.ours and one.quantity for _, one in told)


def test_rows_read_in_the_language_that_is_asked_for(found: Validation) -> None:
    """A German sheet's rows were English; only what the paper prints stays as it prints it."""
    english, german = (
        [tell(row, Catalogue(language)) for row in found.rows] for language in ("en", "de")
    )
    for row, one, other in zip(found.rows, english, german, strict=True):
        assert one.printed == row.printed
        assert other.printed == (row.printed if row.is_claim else row.printed.replace(".", ","))
        assert one.basis != other.basis
        assert not one.reason or one.reason != other.reason
        assert not re.search(r" the | of | with |\d\.\d+ (ms|µs|m/s)", other.ours + other.reason)


def test_numbers_are_judged_by_their_tolerance() -> None:
    def verdict(printed: float, ours: float, **values: float) -> Verdict:
        return number("increase", printed, ours, 0.1, **values).verdict

    assert verdict(1.0, 1.09) is Verdict.AGREES
    assert verdict(1.0, 1.11) is Verdict.OUT
    assert verdict(1.0, float("nan")) is Verdict.OUT
    assert verdict(3.0, 1.05, corrected=1.0) is Verdict.CORRECTED
    assert verdict(3.0, 2.0, corrected=1.0) is Verdict.OUT
    assert verdict(3.0, 3.05, literal=0.0) is Verdict.CORRECTED
    assert verdict(3.0, 1.0, literal=0.0) is Verdict.OUT


def test_claims_need_confirmation_or_proof() -> None:
    assert claim("order", holds=True, refuted=True).verdict is Verdict.AGREES
    assert claim("order", holds=False, refuted=True).verdict is Verdict.DIFFERS
    assert claim("order", holds=False).verdict is Verdict.OUT
    assert claim("functional", holds=True).verdict is Verdict.CORRECTED
    assert claim("functional", holds=False).verdict is Verdict.OUT


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


def test_printed_control_integrated_by_a_general_solver(plant: Plant) -> None:
    """Eq. (12) ends with v_s = 0.100028 m/s, F = 3.5 N, v_b = 4e-5 m/s."""
    x, force = np.zeros(7), 2e3
    for start, end in pairwise((0.0, *SWITCHING_TIMES, T_F)):
        x, force = integrate(x, force, end - start), -force
    x[1], x[4] = 0.0, x[4] - 0.1
    assert printed_control_error(plant) == pytest.approx(x, rel=1e-6, abs=1e-12)
    assert x[[4, 6, 3]] == pytest.approx([2.8e-5, 3.47, 3.87e-5], rel=0.02)


def test_scan_finds_the_range_of_seven_switches(plant: Plant) -> None:
    scan = scan_forces(plant, STEP, lowest=1200.0, highest=1350.0, count=6)
    ((lowest, highest, optima),) = scan.ranges
    assert scan.gap < 1e-9
    assert {len(optimum.switching_times) for optimum in optima} == {7}
    assert (lowest, highest) == pytest.approx((1252.65, 1294.6), rel=2e-4)
    ((lowest, *_),) = scan_forces(plant, STEP, lowest=1270.0, highest=1350.0, count=3).ranges
    assert lowest == pytest.approx(1270.0)


def test_law_is_found_from_the_force_alone(found: Validation, plant: Plant) -> None:
    damping = found.cases.damping
    assert law_residual(plant, damping, samples=40_000) < 1e-7
    scaled = replace(
        damping, arcs=tuple(replace(arc, output=0.99 * arc.output) for arc in damping.arcs)
    )
    assert law_residual(plant, scaled, samples=4000) > 1e-4


def test_terminal_shows_80_columns(found: Validation) -> None:
    lines = fold(describe_validation(found, Catalogue(), every_row=True))
    assert max(map(len, lines)) <= 80
    german = fold(describe_validation(found, Catalogue("de"), every_row=True))
    assert max(map(len, german)) <= 80
    assert "Zeitoptimale Steuerung (Abschn. 5.1)" in german
    text = " ".join(" ".join(lines).split())
    for row in found.rows:
        assert tell(row, Catalogue()).ours.split()[0] in text


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
        row for rows in found.parts.values() for row in sorted(rows, key=lambda r: r.is_claim)
    ]
    assert len(documented) == len(expected)
    for cells, row in zip(documented, expected, strict=True):
        told = tell(row, Catalogue())
        assert cells[:4] == [told.place, name_of(told), told.printed, told.corrected]
        assert cells[-1] == row.verdict.value
        if not row.is_claim:
            rounding = row.tolerance if row.printed_value == 0.0 else 0.0
            assert float(cells[4]) == pytest.approx(row.ours_value, rel=1e-6, abs=rounding)


def test_page_names_first_what_does_not_hold(found: Validation) -> None:
    """A reader must not have to search 70 rows for what the paper got wrong."""
    printed = unescape(print_validation(found, Catalogue(), created="today"))
    head = printed[: printed.index('id="part-1"')]
    assert "for all F_max > 0 (sec. 5, (11)): printed 5 for all values of F_max > 0; ours" in head
    assert "relative (sec. 5.2): printed 0.23; correct 0.1998621" in head
    assert head.count("Does not hold:") == 4
    assert head.count("Misprint:") == 9
    assert "<th" not in head
    german = unescape(print_validation(found, Catalogue("de"), created="heute"))
    assert '<html lang="de">' in german
    assert german.count("Gilt nicht:") == 4
    assert "Toleranz oder Prüfung von" in german


@pytest.mark.parametrize("is_met", [True, False])
def test_command(
    found: Validation,
    is_met: bool,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: object,
) -> None:
    """argv -> JSON alone on standard output, the page in its folder, exit code by verdict."""
    row = number("increase", 1.0, 1.0 if is_met else 2.0, 0.0)
    shown = replace(found, parts=found.parts | {"more": [row]})
    monkeypatch.setattr(page, "validate", lambda progress: shown)
    monkeypatch.setattr(
        sys, "argv", ["mtcommission", "validate", "--json", "-", "-o", f"{tmp_path}/out"]
    )
    with pytest.raises(SystemExit) as stopped:
        cli.main()
    assert stopped.value.code == (0 if is_met else 1)
    entry = json.loads(capsys.readouterr().out)
    assert entry["met"] is is_met
    assert len(entry["rows"]) == len(found.rows) + 1
    assert entry["rows"][-1]["difference"] == (0.0 if is_met else 1.0)
    claims = [item for item in entry["rows"] if item["tolerance"] is None]
    assert len(claims) == sum(row.is_claim for row in found.rows)
    with open(f"{tmp_path}/out/validation.html", encoding="utf-8") as file:
        assert "Figures 4 and 5" in file.read()
