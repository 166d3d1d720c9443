"""The whole comparison, as JSON and as one offline page."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from scipy.linalg import expm

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import TimeOptimum, sample_trajectory
from mtcommission.plant.plant import Plant
from mtcommission.sheet.document import (
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
from mtcommission.validate.row import Row, Told, Verdict, tell

SOURCE = "B. Christiansen, H. Maurer, O. Zirn: Optimal Control of Machine Tool Manipulators"
SIGNS = (
    (r"\blambda", "λ"),
    (r"phi\b", "φ"),
    (r"\bmu_", "µ_"),
    (r"<=", "≤"),
    (r">=", "≥"),
    (r"\^2\b", "²"),
)
"""What a terminal may not have, and how the page shows it."""
WIDTHS = {"quantity": 2.0, "printed": 1.5, "correct": 1.5, "ours": 2.5}
"""Of columns wider than the others [-]."""
FIGURES = ("printed_value", "ours_value", "difference", "tolerance")
"""Of a row, for machines."""
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
    parts: dict[str, list[Row]]  # rows by part of the paper, in its order

    @property
    def rows(self) -> list[Row]:
        """All rows."""
        return [row for rows in self.parts.values() for row in rows]

    @property
    def is_met(self) -> bool:
        """Whether no row is out of tolerance."""
        return all(row.verdict is not Verdict.OUT for row in self.rows)

    def count(self, words: Catalogue) -> str:
        """Return how many rows have each verdict, in words."""
        found = Counter(key_of(row) for row in self.rows)
        counts = {verdict.name.lower(): found[verdict.name.lower()] for verdict in Verdict}
        return words.text("validate-count", count=len(self.rows), **counts)


def key_of(row: Row) -> str:
    """Return a verdict as the texts name it: agrees, corrected, differs or out."""
    return row.verdict.name.lower()


def validate(progress: Callable[[Message], None] = lambda _: None) -> Validation:
    """Return the comparison of the paper with ours."""
    progress(Message("stage-optimal-controls"))
    cases = solve_cases()
    progress(Message("validate-stage-loops"))
    feedback, conclusions = loop_rows(cases)
    progress(Message("validate-stage-switches"))
    parts = {
        "plant": plant_rows(cases),
        "feedback": feedback,
        "time": time_rows(cases),
        "structure": structure_rows(cases),
        "bound": bounded_rows(cases),
        "damping": damping_rows(cases),
        "vibration": [*vibration_rows(cases), *peak_rows(cases)],
        "conclusion": conclusions,
    }
    return Validation(cases=cases, parts=parts)


def validation_entry(validation: Validation) -> dict[str, object]:
    """Return the comparison as it is written to JSON, in English."""
    words = Catalogue()
    return {
        "source": "Christiansen, Maurer, Zirn: Optimal Control of Machine Tool Manipulators",
        "met": validation.is_met,
        "rows": [
            {
                "part": heading_of(part, words),
                **asdict(tell(row, words)),
                **{name: getattr(row, name) for name in FIGURES},
                "verdict": row.verdict.value,
            }
            for part, rows in validation.parts.items()
            for row in rows
        ],
    }


def name_of(row: Told) -> str:
    """Return what a row compares, with its unit."""
    return f"{row.quantity} [{row.unit}]" if row.unit else row.quantity


def heading_of(part: str, words: Catalogue) -> str:
    """Return the heading of a part of the paper."""
    return words.known(f"validate-part-{part}", part)


def head_of(column: str, words: Catalogue) -> str:
    """Return the head of a column."""
    return words.own("validate-head", column)


def print_validation(validation: Validation, words: Catalogue, *, created: str) -> str:
    """Return the comparison as one page that works offline; what the paper prints stays English."""
    machine, say = validation.cases.machine, words.text
    parts = enumerate(validation.parts.items(), start=1)
    figures = Section(
        key="figures", heading=say("validate-figures"), blocks=_figures(validation.cases, words)
    )
    page = document(
        words,
        script_note="identify-script-note",
        title=say("validate-title"),
        machine=machine.name,
        axis=f"{say('axis')} {machine.axis}",
        identity=SOURCE,
        created=created,
        disclaimer=say("validate-disclaimer"),
        sections=(
            _verdict(validation, words),
            *(
                _section(f"part-{number}", heading_of(part, words), rows, words)
                for number, (part, rows) in parts
            ),
            figures,
        ),
    )
    return set_html(page, decimal_mark=words.format.decimal_mark)


def _verdict(validation: Validation, words: Catalogue) -> Section:
    say, is_met = words.text, validation.is_met
    headline = Headline(
        is_met=is_met,
        verdict=say("validate-explained" if is_met else "validate-unexplained"),
        detail=validation.count(words),
        values=(),
    )
    found = []
    for verdict in (Verdict.OUT, Verdict.DIFFERS, Verdict.CORRECTED):
        for row in validation.rows:
            if row.verdict is verdict:
                told = tell(row, words)
                line = say(
                    "validate-found",
                    verdict=key_of(row),
                    quantity=told.quantity,
                    place=told.place,
                    printed=told.printed,
                    value=told.corrected or told.ours,
                    **{"is": "correct" if told.corrected else "ours"},
                )
                found.append(_typeset(line))
    remark = note(say("validate-remark", source=SOURCE))
    blocks = (headline, Bullets(items=tuple(found)), remark)
    return Section(key="verdict", heading=say("verdict"), blocks=blocks)


def _section(key: str, heading: str, rows: Sequence[Row], words: Catalogue) -> Section:
    """Return a part, what matters most on the left: a telephone shows four columns."""
    told = [tell(row, words) for row in rows]
    columns = {
        "quantity": [name_of(one) for one in told],
        "printed": [one.printed for one in told],
        "correct": [one.corrected for one in told],
        "ours": [one.ours for one in told],
        "tolerance": [
            "" if row.is_claim else words.format.plain(row.tolerance, 2, "g") for row in rows
        ],
        "verdict": [words.text(f"validate-is-{key_of(row)}") for row in rows],
        "place": [one.place for one in told],
    }
    filled = {name: map(_typeset, texts) for name, texts in columns.items() if any(texts)}
    table = Table(
        caption=words.text("validate-title"),
        columns=tuple(
            Column(head=head_of(name, words), width=WIDTHS.get(name, 1.0)) for name in filled
        ),
        rows=tuple(zip(*filled.values(), strict=True)),
        strong_rows=tuple(
            i for i, row in enumerate(rows) if row.verdict in (Verdict.OUT, Verdict.DIFFERS)
        ),
    )
    bases: dict[str, list[str]] = {}
    for one in told:
        bases.setdefault(one.basis, []).append(one.quantity)
    remarks = (
        *(f"{one.quantity}: {one.reason}" for one in told if one.reason),
        *(
            words.text("validate-tested-by", names="; ".join(names), basis=basis)
            for basis, names in bases.items()
        ),
    )
    notes = Bullets(items=tuple(map(_typeset, remarks)), tone=Tone.NOTE)
    return Section(key=key, heading=heading, blocks=(table, notes))


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


def _figures(cases: Cases, words: Catalogue) -> tuple[LinePlot, ...]:
    """Return Figs. 4 and 5: the two time-optimal controls, free and under the bound."""
    free, bounded = (words.text("paper-figure", number=number) for number in (4, 5))
    return (
        _plot(
            cases.plant, cases.time, words, key="figure-4", caption=free, more=(_switching(cases),)
        ),
        _plot(
            cases.plant,
            cases.bounded,
            words,
            key="figure-5",
            caption=f"{bounded}, |v_φ| ≤ 0.005 rad/s",
        ),
    )


def _plot(
    plant: Plant,
    solution: TimeOptimum,
    words: Catalogue,
    *,
    key: str,
    caption: str,
    more: tuple[Panel, ...] = (),
) -> LinePlot:
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / SAMPLES)
    rate, force = 1e3 * RATE_BOUND, FORCE_LIMIT / 1e3
    borders = {
        "v_s": (Border(label=words.text("paper-target"), y=1e3 * VELOCITY_STEP),),
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
        key=key,
        caption=caption,
        alt=words.text("paper-figure-alt", t_f=solution.t_f, arcs=len(solution.arcs)),
        x_label="t in ms",
        x_is_log=False,
        link=key,
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
