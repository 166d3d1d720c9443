"""The sheet as one HTML file: offline, interactive plots, no request to any network."""

from __future__ import annotations

import re
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from mtcommission.sheet.document import Document, Formula, LinePlot
from mtcommission.sheet.what_if import Panel
from mtcommission.web import json_for_script, render_page

FOLDER = Path(__file__).parent
DIGITS = 5
"""Significant digits of plotted values; finer than a pixel, a third of the bytes."""

SCRIPTS = ("page.js", "engine.js", "what_if.js")
"""Of a page; the first one draws plots, the others are of its interactive part."""


def set_html(document: Document, *, decimal_mark: str, panel: Panel | None = None) -> str:
    """Return a document as a page; ``panel`` is its interactive part, behind the first section.

    All text is escaped; the content security policy admits only the page's own script and style,
    by their hashes, and no connection. The decimal mark is for the values under the cursor.
    """
    style = _read("page.css") + (_read("what_if.css") if panel else "")
    script = "".join(map(_read, SCRIPTS if panel else SCRIPTS[:1]))
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
        svg=Markup,
        set_formula=_set_formula,
        plots=json_for_script({"decimal_mark": decimal_mark, "plots": plots}),
        panel=panel,
        answers=json_for_script(panel.data) if panel else "",
    )


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


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
