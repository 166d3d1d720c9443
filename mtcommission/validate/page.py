"""The whole comparison, as JSON and as one offline page."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.optimal.control import sample_trajectory
from mtcommission.sheet.document import (
    Bullets,
    Column,
    Document,
    Headline,
    LinePlot,
    Section,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.html import set_html
from mtcommission.sheet.plots import MOST_POINTS, Curve, Signals, line_plot
from mtcommission.validate.adjoint import follow_adjoint
from mtcommission.validate.bounded import bounded_rows, damping_rows, peak_rows
from mtcommission.validate.cases import Cases, solve_cases
from mtcommission.validate.free import plant_rows, structure_rows, time_rows, vibration_rows
from mtcommission.validate.loops import loop_rows
from mtcommission.validate.paper import (
    FORCE_LIMIT,
    RATE_BOUND,
    VELOCITY_STEP,
    Row,
    Told,
    Verdict,
    tell,
)

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
DRAWN = ("x_b", "v_s", "phi", "v_phi", "F")
"""States that the paper draws, too."""


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
    parts = [
        _section(f"part-{number}", heading_of(part, words), rows, words)
        for number, (part, rows) in enumerate(validation.parts.items(), start=1)
    ]
    figures = _figures(validation.cases, words)
    drawn = Section(key="figures", heading=say("validate-figures"), blocks=figures)
    page = Document(
        language=words.language,
        title=say("validate-title"),
        machine=machine.name,
        axis=f"{say('axis')} {machine.axis}",
        identity=SOURCE,
        created=created,
        disclaimer=say("validate-disclaimer"),
        sections=(_verdict(validation, words), *parts, drawn),
    )
    return set_html(page)


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
    told, plain = [tell(row, words) for row in rows], words.format.plain
    columns = {
        "quantity": [name_of(one) for one in told],
        "printed": [one.printed for one in told],
        "correct": [one.corrected for one in told],
        "ours": [one.ours for one in told],
        "tolerance": ["" if row.is_claim else plain(row.tolerance, 2, "g") for row in rows],
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
    remarks = [f"{one.quantity}: {one.reason}" for one in told if one.reason]
    for basis in dict.fromkeys(one.basis for one in told):
        names = "; ".join(one.quantity for one in told if one.basis == basis)
        remarks.append(words.text("validate-tested-by", names=names, basis=basis))
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
    plant, best = cases.plant, cases.time
    limits = {"v_s": (VELOCITY_STEP,), "v_phi": (RATE_BOUND, -RATE_BOUND)}
    plots = []
    for number, solution in ((4, best), (5, cases.bounded)):
        motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / MOST_POINTS)
        force = Curve("F_set", motion.t, motion.force, stepped=True)
        panels = [Signals("F_set", plant.force_unit, (force,), (FORCE_LIMIT, -FORCE_LIMIT))]
        for name in DRAWN:
            at = plant.states.index(name)
            course = (Curve(_typeset(name), motion.t, motion.states[:, at]),)
            label, unit = _typeset(name), plant.signal_units[at]
            panels.append(Signals(label, unit, course, limits.get(name, ())))
        if solution is best:
            initial = best.certificate.adjoint_initial
            t, switching = follow_adjoint(plant, initial, t_f=best.t_f, way="back")
            switching = switching / abs(float(initial[plant.force]))
            panels.append(Signals("λ_F / |λ_F(0)|", "", (Curve("λ_F", t, switching),), (0.0,)))
        plot = line_plot(
            words,
            f"figure-{number}",
            panels,
            x=("t", "s"),
            text="paper-figure",
            number=number,
            t_f=solution.t_f,
            arcs=len(solution.arcs),
        )
        plots.append(plot)
    return tuple(plots)
