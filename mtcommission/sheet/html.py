"""The sheet as one HTML file: offline, interactive plots, no request to any network."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from markupsafe import Markup, escape

from mtcommission.base.messages.catalogue import Catalogue, decimal_mark_of
from mtcommission.base.web import fill_template, json_for_script, render_page
from mtcommission.sheet.document import Block, Document, Formula, LinePlot, Section

FOLDER = Path(__file__).parent
DIGITS = 5
"""Significant digits of plotted values; finer than a pixel, a third of the bytes."""


class Interactive(Protocol):
    """The interactive part of a page: its template and scripts, and what they show."""

    @property
    def template(self) -> Path: ...  # noqa: D102
    @property
    def scripts(self) -> tuple[Path, ...]: ...  # noqa: D102
    @property
    def data(self) -> Mapping[str, Any]: ...  # noqa: D102


def set_html(document: Document, *, panel: Interactive | None = None) -> str:
    """Return a document as a page; ``panel`` is its interactive part, behind the first section.

    All text is escaped; the content security policy admits only the page's own script and style,
    by their hashes, and no connection.
    """
    style = _read(FOLDER / "page.css") + (_read(FOLDER / "what_if.css") if panel else "")
    own = (FOLDER / "knobs.js", *panel.scripts) if panel else ()
    script = "".join(map(_read, (FOLDER / "kit.js", FOLDER / "page.js", *own)))
    plots = {
        block.key: _plot_data(block)
        for section in document.sections
        for block in section.blocks
        if isinstance(block, LinePlot)
    }
    return render_page(
        FOLDER,
        style=style,
        script=script,
        document=document,
        text=Catalogue(document.language).text,
        has_plots=bool(plots),
        svg=Markup,
        set_formula=_set_formula,
        plots=json_for_script({"decimal_mark": decimal_mark_of(document.language), "plots": plots}),
        panel=panel,
        interactive=Markup(fill_template(panel.template, FOLDER, panel=panel)) if panel else "",
        answers=json_for_script(panel.data) if panel else "",
    )


def set_parts(words: Catalogue, kind: str, parts: Mapping[str, Sequence[Block]], **own: str) -> str:
    """Return the page of a command: what is in it, by key of the headings ``KIND-part-KEY``.

    ``own``: machine, axis, identity, created and disclaimer of its head.
    """
    sections = tuple(
        Section(key=key, heading=words.own(f"{kind}-part", key), blocks=tuple(blocks))
        for key, blocks in parts.items()
        if blocks
    )
    title = words.text(f"{kind}-title")
    return set_html(Document(language=words.language, title=title, sections=sections, **own))


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _set_formula(formula: Formula) -> Markup:
    """Return a formula with its indices below the line."""
    marked = re.sub("_([A-Za-z]+)", r"<sub>\1</sub>", str(escape(formula.text)))
    return Markup(f'<span class="math">{marked}</span>')


def _plot_data(plot: LinePlot) -> dict[str, Any]:
    """Return a plot as page.js draws it."""
    return asdict(plot, dict_factory=lambda pairs: {key: _rounded(one) for key, one in pairs})


def _rounded(value: object) -> object:
    if not isinstance(value, np.ndarray):
        return value
    return [float(f"{one:.{DIGITS}g}") if isfinite(one) else None for one in value.tolist()]
