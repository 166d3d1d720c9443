"""The paper's numbers beside ours, as the terminal shows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mtcommission.cli.terminal import Line, heading, table
from mtcommission.messages.catalogue import Catalogue
from mtcommission.validate.page import SOURCE, Validation, head_of, heading_of, key_of, name_of
from mtcommission.validate.row import Row, Verdict

STYLES = {"agrees": "green", "corrected": "yellow", "differs": "yellow", "out": "bold red"}


def describe_validation(
    validation: Validation, words: Catalogue, *, every_row: bool
) -> Iterator[Line]:
    """Yield the verdict, then the rows that do not agree as printed, or all of them."""
    yield SOURCE
    yield validation.count(words), "bold green" if validation.is_met else "bold red"
    for part, all_rows in validation.parts.items():
        rows = [one for one in all_rows if every_row or one.verdict is not Verdict.AGREES]
        numbers = [row for row in rows if not row.is_claim]
        yield from ("", heading(heading_of(part, words))) if rows else ()
        yield from _numbers(numbers, words) if numbers else ()
        yield from (f"  {row.quantity}: {row.reason}" for row in numbers if row.reason)
        for row in rows:
            if row.is_claim:
                yield from _claim(row, words)
    if not every_row:
        yield from ("", words.text("validate-all-rows"))


def _claim(row: Row, words: Catalogue) -> Iterator[Line]:
    verdict = words.text(f"validate-is-{key_of(row)}")
    yield f"{row.place}: {row.quantity}: {verdict}", STYLES[key_of(row)]
    told = {"paper": row.printed, "correct": row.corrected, "ours": f"{row.ours} ({row.basis})"}
    for what, value in told.items():
        if value:
            yield f"  {words.text('validate-told', what=what, value=value)}"
    if row.reason:
        yield f"  {row.reason}"


def _numbers(rows: Sequence[Row], words: Catalogue) -> list[Line]:
    heads = [
        head_of(one, words)
        for one in ("quantity", "printed", "ours", "difference", "tolerance", "verdict")
    ]
    cells = []
    for row in rows:
        values = (row.printed, row.ours, f"{row.difference:.1e}", f"{row.tolerance:.0e}")
        shown = [value.replace(".", words.format.decimal_mark) for value in values]
        cells.append([name_of(row), *shown, words.text(f"validate-is-{key_of(row)}")])
    return table(heads, cells, [STYLES[key_of(row)] for row in rows])
