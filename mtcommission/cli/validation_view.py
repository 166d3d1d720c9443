"""The paper's numbers beside ours, as the terminal shows them."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.terminal import Line, heading
from mtcommission.validate.page import SOURCE, Validation
from mtcommission.validate.paper import Verdict, sides, tell

STYLES = {
    Verdict.AGREES: "green",
    Verdict.CORRECTED: "yellow",
    Verdict.DIFFERS: "yellow",
    Verdict.OUT: "bold red",
}


def describe_validation(
    validation: Validation, words: Catalogue, *, every_row: bool
) -> Iterator[Line]:
    """Yield the verdict, then the rows that do not agree as printed, or all of them."""
    yield SOURCE
    yield validation.count(words), "bold green" if validation.is_met else "bold red"
    for part, all_rows in validation.parts.items():
        rows = [row for row in all_rows if every_row or row.verdict is not Verdict.AGREES]
        yield from ("", heading(words.text(f"validate-part-{part}"))) if rows else ()
        for row in rows:
            told = tell(row, words)
            yield f"{told.place}: {told.name}: {told.verdict}", STYLES[row.verdict]
            yield from (f"  {line}" for line in (*sides(told, words), told.reason) if line)
    if not every_row:
        yield from ("", words.text("validate-all-rows"))
