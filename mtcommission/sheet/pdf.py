"""The sheet as PDF: A4, tagged, fonts embedded, the same bytes for the same record."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict
from datetime import UTC, datetime
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typst
from fontTools.ttLib import TTFont

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.sheet.diagram import draw_diagram
from mtcommission.sheet.figures import PANEL, draw_svg
from mtcommission.sheet.model import Block, Document, Section
from mtcommission.sheet.plot_model import Diagram, HeatMap, LinePlot, Plot, PointPlot

PLOTS = (LinePlot, PointPlot, HeatMap)

HEIGHTS = (124.0, 106.0, 90.0, 76.0, 64.0, 54.0, 46.0, 39.0)
"""Heights of a panel [pt], among which a page takes the largest that fits; sheet.typ has as many
steps."""

TEMPLATE = Path(__file__).with_name("sheet.typ")

FONT = "DejaVuSans.ttf"
"""Of matplotlib; the template names it."""

LATIN = "\u024f"
"""Last character that every font of ours has, with all letters of Europe's Latin scripts."""

MISSING_DATE = datetime(2000, 1, 1, tzinfo=UTC)
"""Date of a PDF whose record states none that can be read."""


def set_pdf(document: Document, *, decimal_mark: str = ".") -> bytes:
    """Return a document as PDF/UA-1.

    Parameters
    ----------
    document
        From ``content.compose``.
    decimal_mark
        For the numbers at the axes.

    Raises
    ------
    ComputationError
        PRINTING_FAILED with the compiler's message.
    """
    plots = {
        block.key: _drawn(block, section, decimal_mark)
        for section in document.sections
        for block in section.blocks
        if isinstance(block, (*PLOTS, Diagram))
    }
    try:
        pdf = typst.compile(
            TEMPLATE,
            font_paths=[_font_folder()],
            ignore_system_fonts=True,
            sys_inputs={"document": _as_json(document), "plots": json.dumps(plots)},
            format="pdf",
            pdf_standards=["ua-1"],
            timestamp=_timestamp(document.created),
        )
    except typst.TypstError as error:
        raise ComputationError(
            Outcome.PRINTING_FAILED, Message("foreign", text=str(error))
        ) from error
    return pdf


def _drawn(block: Plot | Diagram, section: Section, decimal_mark: str) -> list[str]:
    """Return a picture as SVG: on a page in each of the heights among which it chooses."""
    if isinstance(block, Diagram):
        return [draw_diagram(block)]
    heights = (PANEL,) if section.is_appendix else HEIGHTS
    return [
        draw_svg(block, decimal_mark=decimal_mark, panel_height=height).decode()
        for height in (heights if isinstance(block, LinePlot) else heights[:1])
    ]


def find_boxes(texts: Iterable[str]) -> str:
    """Return the characters of some texts that the sheet's font lacks and prints as boxes.

    Parameters
    ----------
    texts
        Of the user; our own texts are covered.

    Returns
    -------
    str
        Each once, in their order.

    Examples
    --------
    >>> find_boxes(["Fräse ζ", "机床 机"])
    '机床'
    """
    foreign = dict.fromkeys(sign for text in texts for sign in text if sign > LATIN)
    if not foreign:
        return ""  # most sheets; the font takes a while to read
    with TTFont(_font_folder() / FONT, lazy=True) as font:
        known = font.getBestCmap()
    return "".join(sign for sign in foreign if ord(sign) not in known)


def _font_folder() -> Path:
    """Where matplotlib brings DejaVu Sans along; the fonts inside typst have no sans-serif.

    It is found without being loaded, which would take as long as the typesetting.
    """
    package = find_spec("matplotlib")
    if package is None or package.origin is None:
        raise ComputationError(Outcome.PRINTING_FAILED, Message("fonts-missing"))
    return Path(package.origin).with_name("mpl-data") / "fonts" / "ttf"


def _timestamp(created: str) -> datetime:
    try:
        moment = datetime.fromisoformat(created)
    except ValueError:
        return MISSING_DATE
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


def _as_json(document: Document) -> str:
    """Return the document as data for the template; plots shrink to key, caption and alt."""
    sections = [
        {
            "heading": section.heading,
            "is_appendix": section.is_appendix,
            "blocks": [_as_data(block) for block in section.blocks],
        }
        for section in document.sections
    ]
    names = ("language", "title", "machine", "axis", "identity", "disclaimer", "page_word")
    data = {name: getattr(document, name) for name in (*names, "appendix_heading")}
    return json.dumps(data | {"sections": sections}, ensure_ascii=False)


def _as_data(block: Block) -> dict[str, Any]:
    if isinstance(block, (*PLOTS, Diagram)):
        return {"type": "Plot", "key": block.key, "caption": block.caption, "alt": block.alt}
    values = asdict(
        block,
        dict_factory=lambda pairs: {
            name: value.value if isinstance(value, Enum) else value for name, value in pairs
        },
    )
    return {"type": type(block).__name__} | values
