"""Everything that the paper prints, beside ours: the whole comparison."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from mtcommission.validate.bounded_rows import bounded_rows
from mtcommission.validate.cases import Cases, Progress, solve_cases
from mtcommission.validate.damping_rows import damping_rows
from mtcommission.validate.loop_rows import conclusion_rows, loop_rows
from mtcommission.validate.plant_rows import plant_rows
from mtcommission.validate.row import Row, Verdict
from mtcommission.validate.structure import structure_rows
from mtcommission.validate.time_rows import time_rows
from mtcommission.validate.vibration_rows import vibration_rows

PARTS: tuple[tuple[str, Callable[[Cases], tuple[Row, ...]]], ...] = (
    ("Plant (sec. 2)", plant_rows),
    ("Feedback control (sec. 3)", loop_rows),
    ("Time-optimal control (sec. 5.1)", time_rows),
    ("Structure of the control (sec. 5)", structure_rows),
    ("Bound on the tower's rate (sec. 5.2)", bounded_rows),
    ("Damping-optimal control (sec. 6)", damping_rows),
    ("Vibration (secs. 4 to 6)", vibration_rows),
    ("Conclusion (sec. 7)", conclusion_rows),
)
"""Parts of the comparison in the paper's order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Rows that belong together."""

    heading: str  # What they are about
    rows: tuple[Row, ...]  # In the paper's order


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Validation:
    """The whole comparison."""

    cases: Cases  # Solutions behind it
    parts: tuple[Part, ...]  # Rows by part

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows."""
        return tuple(row for part in self.parts for row in part.rows)

    @property
    def is_met(self) -> bool:
        """Whether no row is out of tolerance."""
        return all(row.verdict is not Verdict.OUT for row in self.rows)


def validate(progress: Progress = lambda _: None) -> Validation:
    """Return the comparison of the paper with ours."""
    cases = solve_cases(progress)
    parts = []
    for heading, rows_of in PARTS:
        progress(heading)
        parts.append(Part(heading=heading, rows=rows_of(cases)))
    return Validation(cases=cases, parts=tuple(parts))


def count_verdicts(rows: Sequence[Row]) -> str:
    """Return how many rows have each verdict, in words.

    Examples
    --------
    >>> count_verdicts(())
    '0 agree, 0 agree with the correction, 0 differ with reason, 0 out of tolerance'
    """
    words = {
        Verdict.AGREES: "agree",
        Verdict.CORRECTED: "agree with the correction",
        Verdict.DIFFERS: "differ with reason",
        Verdict.OUT: "out of tolerance",
    }
    return ", ".join(
        f"{sum(row.verdict is verdict for row in rows)} {word}" for verdict, word in words.items()
    )


def validation_entry(validation: Validation) -> dict[str, object]:
    """Return the comparison as it is written to JSON."""
    return {
        "source": "Christiansen, Maurer, Zirn: Optimal Control of Machine Tool Manipulators",
        "met": validation.is_met,
        "rows": [
            {"part": part.heading, **asdict(row), "verdict": row.verdict.value}
            for part in validation.parts
            for row in part.rows
        ],
    }
