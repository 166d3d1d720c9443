"""The table of a sweep as one HTML page: offline, plots, trade-off, map, sortable rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import polars as pl

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.web import json_for_script, render_page
from mtcommission.sweep.columns import Column
from mtcommission.sweep.plan import Plan, vary_profile
from mtcommission.sweep.table import SweepTable, summarise

FOLDER = Path(__file__).parent
DIGITS = 7
"""Significant digits on the page; the files beside it have all."""
GAP_DIGITS = 2
"""Of gaps, which are far below 1e-9: a tenth less to load."""
UNPLOTTED = ("t_f_lower_bound", "relative_gap")
"""Proofs, which say yes or no; they stand in the table."""
LEFT_OUT = ("inputs", "switching_times")
"""Long texts of every row; they stand in the files."""
SAID = ("yes", "no", "case", "over", "over-two", "numbers", "page", "chosen", "front", "map")
"""Texts that the script says; %1 and %2 stand for its values."""


def print_sweep(plan: Plan, table: SweepTable, words: Catalogue, *, created: str) -> str:
    """Return the page of a sweep begun at a date (ISO 8601).

    HTML with all text escaped, admitted by hashes to run its own script only.
    """
    return render_page(
        FOLDER,
        style=(FOLDER / "page.css").read_text(encoding="utf-8"),
        script=(FOLDER / "page.js").read_text(encoding="utf-8"),
        name=plan.where,
        language=words.language,
        say=words.text,
        summary=summarise(table, words),
        asked=words.say(table.asked),
        created=created,
        good=words.text("sweep-page-good", kind=table.flag),
        data=json_for_script(_page_data(plan, table, words)),
    )


def _page_data(plan: Plan, table: SweepTable, words: Catalogue) -> dict[str, Any]:
    places = tuple((key, f"@@{place}@@") for place, key in enumerate(plan.keys))
    place = [column.name for column in table.columns].index("t_f")
    results = table.columns[place:-2]
    plotted = [
        column.name
        for column in results
        if column.kind in ("float", "int") and column.name not in UNPLOTTED
    ]
    return {
        "count": table.frame.height,
        "flag": table.flag,
        "plotted": plotted,
        "keys": plan.keys,
        "template": vary_profile(plan.profile_text, places, where=plan.where),
        "columns": [
            _column(column, table.frame[column.name], is_exact=column.name in plan.keys)
            | {
                "head": _head(column, words),
                "meaning": words.say(column.meaning),
                "varies": column.name in plan.keys,
                "result": column in results,
            }
            for column in table.columns
            if column.name not in LEFT_OUT
        ],
        "words": {name: words.own("sweep-page", name) for name in SAID},
    }


def _head(column: Column, words: Catalogue) -> str:
    """The column in words; a varied key by the name that messages give it."""
    meaning = column.meaning
    if column.varies:
        return words.name(column.name)
    return words.text(f"{meaning.kind}.head", **meaning.values)


def _column(column: Column, values: pl.Series, *, is_exact: bool) -> dict[str, Any]:
    # What varies goes into the profile of a case as it is.
    found: dict[str, Any] = {"name": column.name, "unit": column.unit, "kind": column.kind}
    if column.kind == "str":
        words = {word: code for code, word in enumerate(values.drop_nulls().unique().sort())}
        found["words"] = list(words)
        found["values"] = [None if word is None else words[word] for word in values]
    elif column.kind == "float":
        digits = GAP_DIGITS if column.name == "relative_gap" else DIGITS
        kept = values if is_exact else values.round_sig_figs(digits)
        found["values"] = kept.set(~kept.is_finite().fill_null(value=False), None).to_list()
    else:
        found["values"] = values.to_list()
    listed = found["values"]
    if len(listed) > 1 and listed.count(listed[0]) == len(listed):
        found["all"] = listed[0]
        del found["values"]
    return found
