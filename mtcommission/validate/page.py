"""The comparison as one HTML page, with the look of the commissioning sheet."""

from __future__ import annotations

from mtcommission.sheet.html import set_html
from mtcommission.sheet.labels_en import Labels
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Document,
    Headline,
    Paragraph,
    Section,
    Table,
    Tone,
)
from mtcommission.validate.figures import paper_figures
from mtcommission.validate.report import Part, Validation, count_verdicts
from mtcommission.validate.row import Row, Verdict

SOURCE = "B. Christiansen, H. Maurer, O. Zirn: Optimal Control of Machine Tool Manipulators"


def print_validation(validation: Validation, *, created: str) -> str:
    """Return the comparison as one page that works offline.

    Parameters
    ----------
    validation
        The comparison.
    created
        When it was made (ISO 8601).

    Returns
    -------
    str
        HTML; every text is escaped.
    """
    labels = Labels()
    machine = validation.cases.machine
    sections = (
        _verdict(validation),
        *(_section(number, part) for number, part in enumerate(validation.parts, start=1)),
        Section(
            key="figures", heading="Figures 3 to 6 again", blocks=paper_figures(validation.cases)
        ),
    )
    document = Document(
        language="en",
        title="The paper's numbers beside ours",
        machine=machine.name,
        axis=f"{labels.axis} {machine.axis}",
        identity=SOURCE,
        created=created,
        disclaimer="Calculated, not measured.",
        contents_heading=labels.contents,
        skip_link=labels.skip,
        script_note="Plots: drag to zoom, double-click to reset, move the pointer to read values.",
        page_word=labels.page,
        sections=sections,
    )
    return set_html(document, decimal_mark=labels.decimal_mark)


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
    return Section(key="verdict", heading="Verdict", blocks=(headline, note))


def _section(number: int, part: Part) -> Section:
    blocks: list[Block] = []
    numbers = [row for row in part.rows if not row.is_claim]
    claims = [row for row in part.rows if row.is_claim]
    if numbers:
        blocks.append(_numbers(numbers))
        blocks.append(Bullets(items=(*_bases(numbers), *_reasons(numbers)), tone=Tone.NOTE))
    if claims:
        blocks.append(_claims(claims))
    if reasons := _reasons(claims):
        blocks.append(Bullets(items=reasons, tone=Tone.NOTE))
    return Section(key=f"part-{number}", heading=part.heading, blocks=tuple(blocks))


def _numbers(rows: list[Row]) -> Table:
    heads = ("Printed", "Correct", "Ours", "Difference", "Tolerance")
    return Table(
        caption="Numbers",
        columns=(
            Column(head="Place"),
            Column(head="Quantity", width=2.0),
            *(Column(head=head, is_number=True) for head in heads),
            Column(head="Verdict"),
        ),
        rows=tuple(
            (
                row.place,
                f"{row.quantity} [{row.unit}]" if row.unit else row.quantity,
                row.printed,
                row.corrected,
                row.ours,
                f"{row.difference:.2g}",
                f"{row.tolerance:.2g}",
                row.verdict.value,
            )
            for row in rows
        ),
        strong_rows=_unusual(rows),
    )


def _claims(rows: list[Row]) -> Table:
    heads = ("Place", "Claim", "Printed", "Correct", "Ours, and how it was tested", "Verdict")
    return Table(
        caption="Claims and formulas",
        columns=tuple(
            Column(head=head, width=1.0 if head in ("Place", "Verdict") else 2.0) for head in heads
        ),
        rows=tuple(
            (
                row.place,
                row.quantity,
                row.printed,
                row.corrected,
                f"{row.ours} ({row.basis})",
                row.verdict.value,
            )
            for row in rows
        ),
        strong_rows=_unusual(rows),
    )


def _bases(rows: list[Row]) -> tuple[str, ...]:
    """Return where the tolerances come from, each source once."""
    named: dict[str, list[str]] = {}
    for row in rows:
        named.setdefault(row.basis, []).append(row.quantity)
    return tuple(
        f"Tolerance of {'; '.join(quantities)}: {basis}." for basis, quantities in named.items()
    )


def _reasons(rows: list[Row]) -> tuple[str, ...]:
    return tuple(f"{row.quantity}: {row.reason}" for row in rows if row.reason)


def _unusual(rows: list[Row]) -> tuple[int, ...]:
    return tuple(i for i, row in enumerate(rows) if row.verdict is Verdict.OUT)
