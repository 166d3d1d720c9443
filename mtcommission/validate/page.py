"""The whole comparison, as JSON and as one offline page."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from scipy.linalg import expm

from mtcommission.messages.catalogue import Catalogue
from mtcommission.optimal.solution import TimeOptimum, sample_trajectory
from mtcommission.sheet.document import (
    Block,
    Border,
    Bullets,
    Column,
    Headline,
    Line,
    LinePlot,
    Panel,
    Section,
    Table,
    Tone,
    document,
    note,
)
from mtcommission.sheet.html import set_html
from mtcommission.validate.bounded import bounded_rows, damping_rows, peak_rows
from mtcommission.validate.free import plant_rows, structure_rows, time_rows, vibration_rows
from mtcommission.validate.loops import loop_rows
from mtcommission.validate.paper import FORCE_LIMIT, RATE_BOUND, VELOCITY_STEP, Cases, solve_cases
from mtcommission.validate.row import Row, Verdict

SOURCE = "B. Christiansen, H. Maurer, O. Zirn: Optimal Control of Machine Tool Manipulators"
COUNTED = {
    Verdict.AGREES: ("agree", "agrees", "green"),
    Verdict.CORRECTED: ("agree with the correction", "corrected", "yellow"),
    Verdict.DIFFERS: ("differ with reason", "differs", "yellow"),
    Verdict.OUT: ("out of tolerance", "OUT", "bold red"),
}
"""Words of a count, words for a narrow column, and their colours."""
SIGNS = (
    (r"\blambda", "λ"),
    (r"phi\b", "φ"),
    (r"\bmu_", "µ_"),
    (r"<=", "≤"),
    (r">=", "≥"),
    (r"\^2\b", "²"),
)
"""What a terminal may not have, and how the page shows it."""
SAMPLES = 800
"""Points of a curve; more are not seen."""
SOLID = 4
"""Line style of the sheet."""
STATES = (
    ("x_b", "x_b in µm", 1e6),
    ("v_s", "v_s in mm/s", 1e3),
    ("phi", "φ in µrad", 1e6),
    ("v_phi", "v_φ in mrad/s", 1e3),
    ("F", "F in kN", 1e-3),
)
"""Panels: state, label, factor from SI."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Validation:
    """The whole comparison."""

    cases: Cases
    parts: dict[str, list[Row]]  # Rows by heading, in the paper's order

    @property
    def rows(self) -> list[Row]:
        """All rows."""
        return [row for rows in self.parts.values() for row in rows]

    @property
    def is_met(self) -> bool:
        """Whether no row is out of tolerance."""
        return all(row.verdict is not Verdict.OUT for row in self.rows)

    @property
    def count(self) -> str:
        """How many rows have each verdict, in words."""
        found = [row.verdict for row in self.rows]
        counts = ", ".join(f"{found.count(key)} {words[0]}" for key, words in COUNTED.items())
        return f"{len(found)} rows: {counts}."


def validate(progress: Callable[[str], None] = lambda _: None) -> Validation:
    """Return the comparison of the paper with ours."""
    progress("optimal controls")
    cases = solve_cases()
    progress("feedback loops")
    feedback, conclusions = loop_rows(cases)
    progress("switches over the force")
    parts = {
        "Plant (sec. 2)": plant_rows(cases),
        "Feedback control (sec. 3)": feedback,
        "Time-optimal control (sec. 5.1)": time_rows(cases),
        "Structure of the control (sec. 5)": structure_rows(cases),
        "Bound on the tower's rate (sec. 5.2)": bounded_rows(cases),
        "Damping-optimal control (sec. 6)": damping_rows(cases),
        "Vibration (secs. 4 to 6)": [*vibration_rows(cases), *peak_rows(cases)],
        "Conclusion (sec. 7)": conclusions,
    }
    return Validation(cases=cases, parts=parts)


def validation_entry(validation: Validation) -> dict[str, object]:
    """Return the comparison as it is written to JSON."""
    return {
        "source": "Christiansen, Maurer, Zirn: Optimal Control of Machine Tool Manipulators",
        "met": validation.is_met,
        "rows": [
            {"part": heading, **asdict(row), "verdict": row.verdict.value}
            for heading, rows in validation.parts.items()
            for row in rows
        ],
    }


def name_of(row: Row) -> str:
    """Return what a row compares, with its unit."""
    return f"{row.quantity} [{row.unit}]" if row.unit else row.quantity


def print_validation(validation: Validation, *, created: str) -> str:
    """Return the comparison as one page that works offline."""
    machine, words = validation.cases.machine, Catalogue()
    parts = enumerate(validation.parts.items(), start=1)
    figures = Section(
        key="figures", heading="Figures 4 and 5 again", blocks=_figures(validation.cases)
    )
    page = document(
        words,
        script_note="identify-script-note",
        title="The paper's numbers beside ours",
        machine=machine.name,
        axis=f"{words.text('axis')} {machine.axis}",
        identity=SOURCE,
        created=created,
        disclaimer="Calculated, not measured.",
        sections=(
            _verdict(validation),
            *(_section(f"part-{number}", heading, rows) for number, (heading, rows) in parts),
            figures,
        ),
    )
    return set_html(page, decimal_mark=".")


def _verdict(validation: Validation) -> Section:
    is_met = validation.is_met
    headline = Headline(
        is_met=is_met,
        verdict="Nothing unexplained" if is_met else "Some rows are out of tolerance",
        detail=validation.count,
        values=(),
    )
    remark = note(
        f"{SOURCE}. Each number and claim stands as printed. Where it is a misprint, the "
        "correction is given and judged; where a claim does not hold, the row says what "
        "disproves it."
    )
    found = []
    for verdict, word in (
        (Verdict.OUT, "Unexplained"),
        (Verdict.DIFFERS, "Does not hold"),
        (Verdict.CORRECTED, "Misprint"),
    ):
        for row in validation.rows:
            if row.verdict is verdict:
                ours = f"correct {row.corrected}" if row.corrected else f"ours {row.ours}"
                place = f"{row.quantity} ({row.place})"
                found.append(_typeset(f"{word}: {place}: printed {row.printed}; {ours}."))
    blocks = (headline, Bullets(items=tuple(found)), remark)
    return Section(key="verdict", heading="Verdict", blocks=blocks)


def _section(key: str, heading: str, rows: Sequence[Row]) -> Section:
    """Return a part, what matters most on the left: a telephone shows four columns."""
    blocks: list[Block] = []
    numbers, claims = ([row for row in rows if row.is_claim is kind] for kind in (False, True))
    if numbers:
        cells = [
            (Column(head="Quantity", width=2.0), [name_of(row) for row in numbers]),
            (Column(head="Printed", is_number=True), [row.printed for row in numbers]),
            (Column(head="Correct", is_number=True), [row.corrected for row in numbers]),
            (Column(head="Ours", is_number=True), [row.ours for row in numbers]),
            (Column(head="Difference", is_number=True), [f"{r.difference:.2g}" for r in numbers]),
            (Column(head="Tolerance", is_number=True), [f"{r.tolerance:.2g}" for r in numbers]),
        ]
        bases: dict[str, list[str]] = {}
        for row in numbers:
            bases.setdefault(row.basis, []).append(row.quantity)
        told = [f"Tolerance of {'; '.join(names)}: {basis}." for basis, names in bases.items()]
        blocks += _table("Numbers", cells, numbers, told)
    if claims:
        tested = [f"{row.ours} ({row.basis})" for row in claims]
        cells = [
            (Column(head="Claim", width=1.5), [row.quantity for row in claims]),
            (Column(head="Printed", width=1.5), [row.printed for row in claims]),
            (Column(head="Correct", width=1.5), [row.corrected for row in claims]),
            (Column(head="Ours, and how it was tested", width=3.0), tested),
        ]
        blocks += _table("Claims and formulas", cells, claims, [])
    return Section(key=key, heading=heading, blocks=tuple(blocks))


def _table(
    caption: str, cells: list[tuple[Column, list[str]]], rows: list[Row], told: list[str]
) -> list[Block]:
    """Return a table without the columns that are empty throughout, and its remarks."""
    cells.append((Column(head="Verdict"), [row.verdict.value for row in rows]))
    cells.append((Column(head="Place"), [row.place for row in rows]))
    filled = [(column, map(_typeset, texts)) for column, texts in cells if any(texts)]
    loud = (Verdict.OUT, Verdict.DIFFERS)
    table = Table(
        caption=caption,
        columns=tuple(column for column, _ in filled),
        rows=tuple(zip(*(texts for _, texts in filled), strict=True)),
        strong_rows=tuple(i for i, row in enumerate(rows) if row.verdict in loud),
    )
    reasons = [f"{row.quantity}: {row.reason}" for row in rows if row.reason]
    remarks = tuple(_typeset(text) for text in (*reasons, *told))
    return [table, Bullets(items=remarks, tone=Tone.NOTE)] if remarks else [table]


def _typeset(text: str) -> str:
    """Return a text with the signs that not every terminal has.

    Examples
    --------
    >>> _typeset("|v_phi| <= 0.005, lambda_vphi(0), mu_1 J^2")
    '|v_φ| ≤ 0.005, λ_vφ(0), µ_1 J²'
    """
    for plain, sign in SIGNS:
        text = re.sub(plain, sign, text)
    return text


def _figures(cases: Cases) -> tuple[LinePlot, ...]:
    """Return Figs. 4 and 5: the two time-optimal controls, free and under the bound."""
    caption = "time-optimal solution, F_max = 2 kN"
    free = _plot(cases, cases.time, 4, f"Fig. 4: {caption}", (_switching(cases),))
    bounded = f"Fig. 5: {caption}, |v_φ| ≤ 0.005 rad/s"
    return free, _plot(cases, cases.bounded, 5, bounded, ())


def _plot(
    cases: Cases, solution: TimeOptimum, number: int, caption: str, more: tuple[Panel, ...]
) -> LinePlot:
    plant = cases.plant
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / SAMPLES)
    rate, force = 1e3 * RATE_BOUND, FORCE_LIMIT / 1e3
    borders = {
        "v_s": (Border(label="target", y=1e3 * VELOCITY_STEP),),
        "v_phi": (Border(label="c", y=rate), Border(label="c", y=-rate)),
    }
    set_force = Panel(
        y_label="F_set in kN",
        lines=(_line(motion.t, motion.force / 1e3, is_stepped=True),),
        borders=(Border(label="F_max", y=force), Border(label="F_max", y=-force)),
    )
    states = (
        Panel(
            y_label=label,
            lines=(_line(motion.t, factor * motion.states[:, plant.states.index(name)]),),
            borders=borders.get(name, ()),
        )
        for name, label, factor in STATES
    )
    return LinePlot(
        key=f"figure-{number}",
        caption=caption,
        alt=f"Set force and states over time up to t_f = {1e3 * solution.t_f:.3f} ms; "
        f"{len(solution.arcs)} arcs.",
        x_label="t in ms",
        x_is_log=False,
        link=f"figure-{number}",
        panels=(set_force, *states, *more),
    )


def _line(t: np.ndarray, y: np.ndarray, *, is_stepped: bool = False) -> Line:
    return Line(label="optimal", x=1e3 * t, y=y, style=SOLID, is_stepped=is_stepped)


def _switching(cases: Cases) -> Panel:
    """Return λ_F over its magnitude at t = 0, the switching function of Fig. 4 (d).

    Followed backwards from t_f, where errors decay, with H = 0 there.
    """
    plant, solution = cases.plant, cases.time
    initial = solution.certificate.adjoint_initial
    row = initial @ expm(-plant.A * solution.t_f)
    row[plant.force] = -plant.force_lag / float(solution.arcs[-1].output[0])
    transition, values = expm(plant.A * (solution.t_f / SAMPLES)), []
    for _ in range(SAMPLES + 1):
        values.append(row[plant.force] / abs(float(initial[plant.force])))
        row = row @ transition
    t = np.linspace(0.0, solution.t_f, SAMPLES + 1)
    lines = (_line(t, np.array(values[::-1])),)
    return Panel(y_label="λ_F / |λ_F(0)|", lines=lines, borders=(Border(label="0", y=0.0),))
