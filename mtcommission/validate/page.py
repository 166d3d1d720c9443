"""The whole comparison, as JSON and as one offline page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.commission.recommend import recommend
from mtcommission.optimal.control import TimeOptimum
from mtcommission.sheet.document import Block, Bullets, Headline, LinePlot, Tone, note
from mtcommission.sheet.html import set_parts
from mtcommission.sheet.plots import MOST_POINTS, Curve, Signals, line_plot
from mtcommission.sheet.tables import Quantity, table
from mtcommission.validate.cases import Cases, solve_cases, symbol
from mtcommission.validate.damping import damping_rows, vibration_rows
from mtcommission.validate.feedback import conclusion_rows, feedback_rows
from mtcommission.validate.paper import (
    FORCE_LIMIT,
    RATE_BOUND,
    VELOCITY_STEP,
    Number,
    Row,
    Verdict,
    sides,
    tell,
)
from mtcommission.validate.state_bound import bounded_rows
from mtcommission.validate.time_optimal import follow_adjoint, plant_rows, structure_rows, time_rows

SOURCE = "B. Christiansen, H. Maurer, O. Zirn: Optimal Control of Machine Tool Manipulators"
COLUMNS = (
    Quantity("quantity", "name", width=2.0),
    Quantity("validate-head-printed", "printed", width=1.5),
    Quantity("validate-head-correct", "corrected", width=1.5),
    Quantity("validate-head-ours", "ours", width=2.5),
    Quantity("validate-head-tolerance", "tolerance"),
    Quantity("verdict", "verdict"),
    Quantity("validate-head-place", "place"),
)
"""What matters most on the left: a telephone shows four columns."""
DRAWN = {"x_b": (), "v_s": (VELOCITY_STEP,), "phi": (), "v_phi": (RATE_BOUND, -RATE_BOUND), "F": ()}
"""States that the paper draws, too, with the limits of its text."""


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
        found = Counter(row.verdict for row in self.rows)
        counts = {verdict.value: found[verdict] for verdict in Verdict}
        return words.text("validate-count", count=len(self.rows), **counts)


def validate(progress: Callable[[Message], None] = lambda _: None) -> Validation:
    """Return the comparison of the paper with ours."""
    progress(Message("stage-optimal-controls"))
    cases = solve_cases()
    progress(Message("validate-stage-loops"))
    ours = recommend(cases.machine)
    feedback = feedback_rows(cases, ours)
    progress(Message("validate-stage-switches"))
    parts = {
        "plant": plant_rows(cases),
        "feedback": feedback,
        "time": time_rows(cases),
        "structure": structure_rows(cases),
        "bound": bounded_rows(cases),
        "damping": damping_rows(cases),
        "vibration": vibration_rows(cases),
        "conclusion": conclusion_rows(cases, ours),
    }
    return Validation(cases=cases, parts=parts)


def validation_entry(validation: Validation) -> dict[str, object]:
    """Return the comparison as it is written to JSON, in English."""
    words = Catalogue()
    return {
        "source": SOURCE,
        "met": validation.is_met,
        "rows": [
            {
                "part": words.text(f"validate-part-{part}"),
                **asdict(tell(row, words)),
                "printed_value": row.source.printed if isinstance(row.source, Number) else None,
                "ours_value": row.ours,
                "difference": row.difference,
                "tolerance": row.tolerance,
            }
            for part, rows in validation.parts.items()
            for row in rows
        ],
    }


def print_validation(validation: Validation, words: Catalogue, *, created: str) -> str:
    """Return the comparison as one page that works offline; what the paper prints stays English."""
    machine, say = validation.cases.machine, words.text
    parts = {part: _part(rows, words) for part, rows in validation.parts.items()}
    return set_parts(
        words,
        "validate",
        {
            "verdict": _verdict(validation, words),
            **parts,
            "figures": _figures(validation.cases, words),
        },
        machine=machine.name,
        axis=f"{say('axis')} {machine.axis}",
        identity=SOURCE,
        created=created,
        disclaimer=say("validate-disclaimer"),
    )


def _verdict(validation: Validation, words: Catalogue) -> Sequence[Block]:
    is_met = validation.is_met
    headline = Headline(
        is_met=is_met,
        verdict=words.text("validate-explained" if is_met else "validate-unexplained"),
        detail=validation.count(words),
        values=(),
    )
    wrong = [
        tell(row, words)
        for verdict in (Verdict.OUT, Verdict.DIFFERS, Verdict.CORRECTED)
        for row in validation.rows
        if row.verdict is verdict
    ]
    found = [
        "; ".join([f"{one.place}: {one.name}: {one.verdict}", *sides(one, words)]) for one in wrong
    ]
    remark = note(words.text("validate-remark", source=SOURCE))
    return headline, Bullets(items=tuple(found)), remark


def _part(rows: Sequence[Row], words: Catalogue) -> Sequence[Block]:
    """Return the rows of a part, what to know of them, and what they were judged by."""
    told = [tell(row, words) for row in rows]
    refused = [words.text(f"validate-is-{one.value}") for one in (Verdict.OUT, Verdict.DIFFERS)]
    notes = [f"{one.quantity}: {one.reason}" for one in told if one.reason]
    for basis in dict.fromkeys(one.basis for one in told):
        names = "; ".join(one.quantity for one in told if one.basis == basis)
        notes.append(words.text("validate-tested-by", names=names, basis=basis))
    columns = [one for one in COLUMNS if any(map(one.of, told))]
    return (
        table(words, "", columns, told, strong=lambda one: one.verdict in refused),
        Bullets(items=tuple(notes), tone=Tone.NOTE),
    )


def _figures(cases: Cases, words: Catalogue) -> tuple[LinePlot, LinePlot]:
    """Return Figs. 4 and 5: the two time-optimal controls, free and under the bound."""
    plant, best = cases.plant, cases.time
    initial = best.certificate.adjoint_initial
    t, switching = follow_adjoint(plant, initial, t_f=best.t_f, way="back")
    curve = Curve("λ_F", t, switching / abs(float(initial[plant.force])))
    adjoint = Signals("λ_F / |λ_F(0)|", "", (curve,), (0.0,))
    return _figure(cases, 4, best, words, adjoint), _figure(cases, 5, cases.bounded, words)


def _figure(
    cases: Cases, number: int, best: TimeOptimum, words: Catalogue, *more: Signals
) -> LinePlot:
    plant, motion = cases.plant, cases.sample(best, count=MOST_POINTS)
    force = Curve("F_set", motion.t, motion.force, stepped=True)
    panels = [Signals("F_set", plant.force_unit, (force,), (FORCE_LIMIT, -FORCE_LIMIT))]
    for name, limits in DRAWN.items():
        at, sign = plant.states.index(name), symbol(name)
        course = (Curve(sign, motion.t, motion.states[:, at]),)
        panels.append(Signals(sign, plant.signal_units[at], course, limits))
    return line_plot(
        words,
        f"figure-{number}",
        [*panels, *more],
        x=("t", "s"),
        text="paper-figure",
        number=number,
        t_f=best.t_f,
        arcs=len(best.arcs),
    )
