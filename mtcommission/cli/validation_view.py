"""The paper's numbers beside ours, as the terminal shows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.terminal import Line, heading, table
from mtcommission.validate.page import SOURCE, Validation, head_of, heading_of, key_of, name_of
from mtcommission.validate.paper import Row, Verdict, tell

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
        told = [tell(row, words) for row in numbers]
        yield from (f"  {one.quantity}: {one.reason}" for one in told if one.reason)
        for row in rows:
            if row.is_claim:
                yield from _claim(row, words)
    if not every_row:
        yield from ("", words.text("validate-all-rows"))


def _claim(row: Row, words: Catalogue) -> Iterator[Line]:
    verdict, told = words.text(f"validate-is-{key_of(row)}"), tell(row, words)
    yield f"{told.place}: {told.quantity}: {verdict}", STYLES[key_of(row)]
    sides = {
        "paper": told.printed,
        "correct": told.corrected,
        "ours": f"{told.ours} ({told.basis})",
    }
    for what, value in sides.items():
        if value:
            yield f"  {words.text('validate-told', what=what, value=value)}"
    if told.reason:
        yield f"  {told.reason}"


def _numbers(rows: Sequence[Row], words: Catalogue) -> list[Line]:
    heads = [
        head_of(one, words)
        for one in ("quantity", "printed", "ours", "difference", "tolerance", "verdict")
    ]
    cells = []
    for row in rows:
        told, plain = tell(row, words), words.format.plain
        figures = (plain(row.difference, 1, "e"), plain(row.tolerance, 0, "e"))
        cells.append(
            [
                name_of(told),
                told.printed,
                told.ours,
                *figures,
                words.text(f"validate-is-{key_of(row)}"),
            ]
        )
    return table(heads, cells, [STYLES[key_of(row)] for row in rows])
