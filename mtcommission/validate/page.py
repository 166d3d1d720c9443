"""The comparison as one HTML page, with the look of the commissioning sheet."""

from __future__ import annotations

import re

from mtcommission.messages.catalogue import Catalogue
from mtcommission.sheet.document import (
    Block,
    Bullets,
    Column,
    Headline,
    Paragraph,
    Section,
    Table,
    Tone,
    document,
)
from mtcommission.sheet.html import set_html
from mtcommission.validate.figures import paper_figures
from mtcommission.validate.report import Part, Validation, count_verdicts
from mtcommission.validate.row import Row, Verdict

SIGNS = (
    (r"\blambda", "λ"),
    (r"phi\b", "φ"),
    (r"\bmu_", "µ_"),
    (r"<=", "≤"),
    (r">=", "≥"),
    (r"\^2\b", "²"),
)
"""What a terminal may not have, and how the page shows it."""
SOURCE = "B. Christiansen, H. Maurer, O. Zirn: Optimal Control of Machine Tool Manipulators"


def print_validation(validation: Validation, *, created: str) -> str:
    """Return the comparison as one page that works offline."""
    text = Catalogue().text
    machine = validation.cases.machine
    sections = (
        _verdict(validation),
        *(_section(number, part) for number, part in enumerate(validation.parts, start=1)),
        Section(
            key="figures", heading="Figures 4 and 5 again", blocks=paper_figures(validation.cases)
        ),
    )
    page = document(
        Catalogue(),
        script_note="identify-script-note",
        title="The paper's numbers beside ours",
        machine=machine.name,
        axis=f"{text('axis')} {machine.axis}",
        identity=SOURCE,
        created=created,
        disclaimer="Calculated, not measured.",
        sections=sections,
    )
    return set_html(page, decimal_mark=".")


def _verdict(validation: Validation) -> Section:
    rows = validation.rows
    headline = Headline(
        is_met=validation.is_met,
        verdict="Nothing unexplained" if validation.is_met else "Some rows are out of tolerance",
        detail=f"{len(rows)} rows: {count_verdicts(rows)}.",
        values=(),
    )
    note = Paragraph(
        text=(
            f"{SOURCE}. Each number and claim stands as printed. Where it is a misprint, the "
            "correction is given and judged; where a claim does not hold, the row says what "
            "disproves it."
        ),
        tone=Tone.NOTE,
    )
    found = tuple(
        _typeset(f"{word}: {row.quantity} ({row.place}): {_finding(row)}.")
        for verdict, word in (
            (Verdict.OUT, "Unexplained"),
            (Verdict.DIFFERS, "Does not hold"),
            (Verdict.CORRECTED, "Misprint"),
        )
        for row in rows
        if row.verdict is verdict
    )
    return Section(key="verdict", heading="Verdict", blocks=(headline, Bullets(items=found), note))


def _finding(row: Row) -> str:
    if row.corrected:
        return f"printed {row.printed}; correct {row.corrected}"
    return f"printed {row.printed}; ours {row.ours}"


def _section(number: int, part: Part) -> Section:
    blocks: list[Block] = []
    numbers = [row for row in part.rows if not row.is_claim]
    claims = [row for row in part.rows if row.is_claim]
    if numbers:
        blocks.append(_numbers(numbers))
        blocks.append(Bullets(items=(*_reasons(numbers), *_bases(numbers)), tone=Tone.NOTE))
    if claims:
        blocks.append(_claims(claims))
    if reasons := _reasons(claims):
        blocks.append(Bullets(items=reasons, tone=Tone.NOTE))
    return Section(key=f"part-{number}", heading=part.heading, blocks=tuple(blocks))


def _numbers(rows: list[Row]) -> Table:
    """Return the numbers, what matters most on the left: a telephone shows four columns."""
    cells: list[tuple[Column, list[str]]] = [
        (
            Column(head="Quantity", width=2.0),
            [
                _typeset(f"{row.quantity} [{row.unit}]" if row.unit else row.quantity)
                for row in rows
            ],
        ),
        (Column(head="Printed", is_number=True), [row.printed for row in rows]),
        (Column(head="Correct", is_number=True), [_typeset(row.corrected) for row in rows]),
        (Column(head="Ours", is_number=True), [row.ours for row in rows]),
        (Column(head="Difference", is_number=True), [f"{row.difference:.2g}" for row in rows]),
        (Column(head="Tolerance", is_number=True), [f"{row.tolerance:.2g}" for row in rows]),
        (Column(head="Verdict"), [row.verdict.value for row in rows]),
        (Column(head="Place"), [row.place for row in rows]),
    ]
    return _table("Numbers", cells, rows)


def _claims(rows: list[Row]) -> Table:
    cells: list[tuple[Column, list[str]]] = [
        (Column(head="Claim", width=1.5), [_typeset(row.quantity) for row in rows]),
        (Column(head="Verdict"), [row.verdict.value for row in rows]),
        (Column(head="Printed", width=1.5), [_typeset(row.printed) for row in rows]),
        (Column(head="Correct", width=1.5), [_typeset(row.corrected) for row in rows]),
        (
            Column(head="Ours, and how it was tested", width=3.0),
            [_typeset(f"{row.ours} ({row.basis})") for row in rows],
        ),
        (Column(head="Place"), [row.place for row in rows]),
    ]
    return _table("Claims and formulas", cells, rows)


def _table(caption: str, cells: list[tuple[Column, list[str]]], rows: list[Row]) -> Table:
    """Return a table without the columns that are empty throughout."""
    filled = [(column, texts) for column, texts in cells if any(texts)]
    return Table(
        caption=caption,
        columns=tuple(column for column, _ in filled),
        rows=tuple(zip(*(texts for _, texts in filled), strict=True)),
        strong_rows=tuple(
            i for i, row in enumerate(rows) if row.verdict in (Verdict.OUT, Verdict.DIFFERS)
        ),
    )


def _bases(rows: list[Row]) -> tuple[str, ...]:
    """Return where the tolerances come from, each source once."""
    named: dict[str, list[str]] = {}
    for row in rows:
        named.setdefault(row.basis, []).append(row.quantity)
    return tuple(
        _typeset(f"Tolerance of {'; '.join(quantities)}: {basis}.")
        for basis, quantities in named.items()
    )


def _reasons(rows: list[Row]) -> tuple[str, ...]:
    return tuple(_typeset(f"{row.quantity}: {row.reason}") for row in rows if row.reason)


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
