"""The paper's numbers beside ours, as the terminal shows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mtcommission.cli.terminal import Line, heading, table
from mtcommission.validate.page import COUNTED, SOURCE, Validation, name_of
from mtcommission.validate.row import Row


def describe_validation(validation: Validation) -> Iterator[Line]:
    """Yield all rows: numbers as tables, claims as paragraphs."""
    yield SOURCE
    for name, rows in validation.parts.items():
        numbers = [row for row in rows if not row.is_claim]
        yield from ("", heading(name))
        yield from _numbers(numbers) if numbers else ()
        yield from (f"  {row.quantity}: {row.reason}" for row in numbers if row.reason)
        for row in rows:
            if row.is_claim:
                _, word, style = COUNTED[row.verdict]
                yield f"{row.place}: {row.quantity}: {word}", style
                told = [f"paper: {row.printed}", row.corrected and f"correct: {row.corrected}"]
                told += [f"ours: {row.ours} ({row.basis})", row.reason]
                yield from (f"  {line}" for line in told if line)
    yield ""
    yield validation.count, "bold green" if validation.is_met else "bold red"


def _numbers(rows: Sequence[Row]) -> list[Line]:
    cells = (
        [
            name_of(row),
            row.printed,
            row.ours,
            f"{row.difference:.1e}",
            f"{row.tolerance:.0e}",
            COUNTED[row.verdict][1],
        ]
        for row in rows
    )
    heads = ["Quantity", "Paper", "Ours", "Diff.", "Tol.", "Verdict"]
    return table(heads, cells, [COUNTED[row.verdict][2] for row in rows])
