"""The sheet as PDF: A4, tagged, fonts embedded, the same bytes for the same record."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, fields
from datetime import datetime
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typst

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.sheet.document import (
    Block,
    Diagram,
    Document,
    LinePlot,
    Section,
)
from mtcommission.sheet.figures import PANEL, draw_svg

HEIGHTS = (124.0, 100.0, 80.0, 64.0, 50.0, 39.0, 39.0)
"""Heights of a panel [pt], among which a page takes the largest that fits; sheet.typ has as many
steps."""

TEMPLATE = Path(__file__).with_name("sheet.typ")

FONT = "DejaVuSans.ttf"
"""Of matplotlib; the template names it."""

LATIN = "\u024f"
"""Last character that every font of ours has, with all letters of Europe's Latin scripts."""


def set_pdf(document: Document) -> bytes:
    """Return a document as PDF/UA-1.

    Raises
    ------
    ComputationError
        PRINTING_FAILED with the compiler's message.
    """
    pictures: dict[str, list[str]] = {}
    words = Catalogue(document.language)
    sections = [
        {
            "heading": section.heading,
            "is_appendix": section.is_appendix,
            "blocks": [
                _data(block, section, words.format.decimal_mark, pictures)
                for block in section.blocks
            ],
        }
        for section in document.sections
    ]
    shown = {item.name: getattr(document, item.name) for item in fields(document)}
    shown |= {"sections": sections, "page": words.text("page"), "appendix": words.text("appendix")}
    try:
        pdf = typst.compile(
            TEMPLATE,
            font_paths=[_font_folder()],
            ignore_system_fonts=True,
            sys_inputs={
                "document": json.dumps(shown, ensure_ascii=False),
                "plots": json.dumps(pictures),
            },
            format="pdf",
            pdf_standards=["ua-1"],
            timestamp=datetime.fromisoformat(document.created),
        )
    except typst.TypstError as error:
        raise ComputationError(
            Outcome.PRINTING_FAILED, Message("foreign", text=str(error))
        ) from error
    return pdf


def _data(
    block: Block, section: Section, decimal_mark: str, pictures: dict[str, list[str]]
) -> dict[str, Any]:
    """Return a block for the template; a picture as key, caption and alt, and as SVG apart.

    On a page a plot is drawn in each of the heights among which the template chooses.
    """
    if isinstance(block, LinePlot | Diagram):
        if isinstance(block, Diagram):
            pictures[block.key] = [block.svg]
        else:
            heights = (PANEL,) if section.is_appendix else HEIGHTS
            pictures[block.key] = [
                draw_svg(block, decimal_mark=decimal_mark, panel_height=height)
                for height in heights
            ]
        return {"type": "Plot", "key": block.key, "caption": block.caption, "alt": block.alt}
    values = asdict(
        block,
        dict_factory=lambda pairs: {
            name: value.value if isinstance(value, Enum) else value for name, value in pairs
        },
    )
    return {"type": type(block).__name__} | values


def find_boxes(texts: Iterable[str]) -> str:
    """Return what the sheet's font lacks of the user's texts, and prints as boxes; each once."""
    foreign = dict.fromkeys(sign for text in texts for sign in text if sign > LATIN)
    if not foreign:
        return ""  # most sheets; the font takes a while to read
    from fontTools.ttLib import TTFont

    with TTFont(_font_folder() / FONT, lazy=True) as font:
        known = font.getBestCmap()
    return "".join(sign for sign in foreign if ord(sign) not in known)


def _font_folder() -> Path:
    """Where matplotlib brings DejaVu Sans along; the fonts inside typst have no sans-serif.

    It is found without being loaded, which would take as long as the typesetting.
    """
    package = find_spec("matplotlib")
    assert package is not None
    assert package.origin is not None
    return Path(package.origin).with_name("mpl-data") / "fonts" / "ttf"
