"""The comparison in a terminal of 80 columns."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mtcommission.validate.report import Part, Validation, count_verdicts
from mtcommission.validate.row import Row, Verdict

WORDS = {
    Verdict.AGREES: ("agrees", "green"),
    Verdict.CORRECTED: ("corrected", "yellow"),
    Verdict.DIFFERS: ("differs", "yellow"),
    Verdict.OUT: ("OUT", "bold red"),
}
"""Short words for a narrow column, and their colours."""


def describe_validation(validation: Validation) -> Group:
    """Return all rows: numbers as tables, claims as paragraphs."""
    parts: list[RenderableType] = [
        Text("Christiansen, Maurer, Zirn: Optimal Control of Machine Tool Manipulators"),
    ]
    for part in validation.parts:
        parts += [Text(), Text(part.heading, style="bold"), *_describe_part(part)]
    rows = validation.rows
    style = "bold green" if validation.is_met else "bold red"
    parts += [Text(), Text(f"{len(rows)} rows: {count_verdicts(rows)}.", style=style)]
    return Group(*parts)


def _describe_part(part: Part) -> list[RenderableType]:
    numbers = [row for row in part.rows if not row.is_claim]
    described: list[RenderableType] = []
    if numbers:
        described.append(_number_table(numbers))
        described += [_paragraph(f"{row.quantity}: {row.reason}") for row in numbers if row.reason]
    described += [item for row in part.rows if row.is_claim for item in _claim(row)]
    return described


def _number_table(rows: list[Row]) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("Quantity", overflow="fold", ratio=1)
    for head in ("Paper", "Ours", "Diff.", "Tol."):
        table.add_column(head, justify="right", no_wrap=True)
    table.add_column("Verdict", no_wrap=True)
    for row in rows:
        word, style = WORDS[row.verdict]
        unit = f" [{row.unit}]" if row.unit else ""
        table.add_row(
            Text(f"{row.quantity}{unit}"),
            row.printed,
            row.ours,
            f"{row.difference:.1e}",
            f"{row.tolerance:.0e}",
            Text(word, style=style),
        )
    return table


def _claim(row: Row) -> list[RenderableType]:
    word, style = WORDS[row.verdict]
    head = Text(f"{row.place}: {row.quantity}: ")
    head.append(word, style=style)
    lines = [f"paper: {row.printed}"]
    if row.corrected:
        lines.append(f"correct: {row.corrected}")
    lines.append(f"ours: {row.ours} ({row.basis})")
    if row.reason:
        lines.append(row.reason)
    return [head, *(_paragraph(line) for line in lines)]


def _paragraph(text: str) -> Padding:
    return Padding(Text(text), (0, 0, 0, 2))
