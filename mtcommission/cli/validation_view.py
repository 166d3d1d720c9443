"""The paper's numbers beside ours, as the terminal shows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mtcommission.cli.terminal import Line, heading, table
from mtcommission.messages.catalogue import Catalogue
from mtcommission.validate.page import SOURCE, Validation, heading_of, key_of, name_of
from mtcommission.validate.row import Row

STYLES = {"agrees": "green", "corrected": "yellow", "differs": "yellow", "out": "bold red"}


def describe_validation(validation: Validation, words: Catalogue) -> Iterator[Line]:
    """Yield all rows: numbers as tables, claims as paragraphs."""
    yield SOURCE
    for part, rows in validation.parts.items():
        numbers = [row for row in rows if not row.is_claim]
        yield from ("", heading(heading_of(part, words)))
        yield from _numbers(numbers, words) if numbers else ()
        yield from (f"  {row.quantity}: {row.reason}" for row in numbers if row.reason)
        for row in rows:
            if row.is_claim:
                yield from _claim(row, words)
    yield ""
    yield validation.count(words), "bold green" if validation.is_met else "bold red"


def _claim(row: Row, words: Catalogue) -> Iterator[Line]:
    verdict = words.text(f"validate-short-{key_of(row)}")
    yield f"{row.place}: {row.quantity}: {verdict}", STYLES[key_of(row)]
    told = {"paper": row.printed, "correct": row.corrected, "ours": f"{row.ours} ({row.basis})"}
    for what, value in told.items():
        if value:
            yield f"  {words.text('validate-told', what=what, value=value)}"
    if row.reason:
        yield f"  {row.reason}"


def _numbers(rows: Sequence[Row], words: Catalogue) -> list[Line]:
    cells = (
        [
            name_of(row),
            *(
                text.replace(".", words.format.decimal_mark)
                for text in (
                    row.printed,
                    row.ours,
                    f"{row.difference:.1e}",
                    f"{row.tolerance:.0e}",
                )
            ),
            words.text(f"validate-short-{key_of(row)}"),
        ]
        for row in rows
    )
    names = ("head-quantity", "head-printed", "head-ours", "short-difference", "short-tolerance")
    heads = [words.text(f"validate-{name}") for name in (*names, "head-verdict")]
    return table(heads, cells, [STYLES[key_of(row)] for row in rows])
