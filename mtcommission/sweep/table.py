"""Rows on disk -> columns, and the files that others read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import polars as pl

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.sheet.document import Document, Paragraph, Section
from mtcommission.sheet.html import set_html
from mtcommission.sweep.plan import Plan, Quantity, piece_size, si_number, vary_profile
from mtcommission.sweep.solve import DONE, Column, columns
from mtcommission.sweep.store import Store, write_safely

TYPES = {"float": pl.Float64(), "int": pl.Int64(), "bool": pl.Boolean(), "str": pl.String()}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SweepTable:
    """The rows of a sweep as columns, in the order of the cases; null where a case gave none."""

    columns: tuple[Column, ...]
    frame: pl.DataFrame
    asked: Message  # what was computed for every case

    @property
    def flag(self) -> str:
        """The column that says whether a case is good."""
        names = self.frame.columns
        return "requirements_met" if "requirements_met" in names else "certified"

    @property
    def done(self) -> int:
        """How many cases have a result."""
        return int((self.frame["outcome"] == DONE).sum())

    @property
    def is_met(self) -> bool:
        """Whether every case has a result, certified or with its requirements met."""
        return int(self.frame[self.flag].sum() or 0) == self.frame.height


def read_table(plan: Plan, store: Store) -> SweepTable:
    """Return the rows of a plan's store: case, what varies, results, outcome.

    A piece that an interruption left twice appears once.
    """
    named, size = columns(plan), piece_size(plan)
    answers = {
        piece * size + place: answer
        for piece, found in store.pieces()
        for place, answer in enumerate(found)
    }
    kinds = [column.kind for column in named[1:]]
    nothing = (None,) * sum(column.of is not None for column in named)
    rows = []
    for case in sorted(answers):
        settings, answer = plan.settings(case), answers[case]
        varied = (
            text if kind == "str" else si_number(text)
            for (_, text), kind in zip(settings, kinds, strict=False)
        )
        cells = answer.cells or nothing
        rows.append((case, *varied, *cells, answer.outcome, answer.message))
    schema = {column.name: TYPES[column.kind] for column in named}
    frame = pl.DataFrame(rows, schema=schema, orient="row")
    return SweepTable(columns=named, frame=frame, asked=_describe_request(plan))


def _describe_request(plan: Plan) -> Message:
    """What was computed for every case."""
    parts: list[str | Message] = [plan.quantity.value]
    if plan.quantity is Quantity.OPTIMAL:
        machine = parse_profile(plan.profile_text, where=plan.where)
        plant = build_plant(machine)
        units = dict(zip(plant.signals, plant.signal_units, strict=True))
        parts.append(Message("sweep-asked-move", move=plan.move, of=len(machine.moves)))
        for item in plan.bounds:
            bound = f"{item.value:g} {units[item.name]}"
            parts.append(Message("sweep-asked-bound", name=item.name, bound=bound))
    return Message("sweep-asked", parts=tuple(parts))


def summarise(table: SweepTable, words: Catalogue) -> list[str]:
    """Return how many cases ended how, and a line for each outcome but "done" with its reason."""
    outcomes = table.frame["outcome"].value_counts(sort=True).rows()
    failed = table.frame.filter(pl.col("outcome") != DONE).unique("outcome", keep="first")
    ends = tuple(
        Message("sweep-count-done", count=count) if outcome == DONE else f"{count} {_said(outcome)}"
        for outcome, count in outcomes
    )
    met = int(table.frame[table.flag].sum() or 0)
    summary = Message(
        "sweep-summary", count=table.frame.height, ends=ends, kind=table.flag, met=met
    )
    reasons = [
        f"{_said(outcome)}, {words.text('sweep-first-in', case=case)}: {message}"
        for case, outcome, message in failed.sort("case")["case", "outcome", "message"].rows()
    ]
    return [words.say(summary), *_uncertified(table, words), *reasons]


def _uncertified(table: SweepTable, words: Catalogue) -> list[str]:
    """Which optimum is not proved, and how far it may be from the least time: the first of them."""
    if table.flag != "certified":
        return []
    found = table.frame.filter((pl.col("outcome") == DONE) & ~pl.col("certified"))
    rows = found.sort("case")["case", "relative_gap"].head(1).rows()
    return [words.text("sweep-not-certified", case=case, gap=gap) for case, gap in rows]


def _said(outcome: str) -> str:
    return outcome.replace("_", " ")


def write_table(table: SweepTable, folder: Path, words: Catalogue) -> None:
    """Write ``rows.parquet`` (units, meanings, bounds as metadata), ``rows.csv`` (units on top).

    Raises InputError: a file cannot be written.
    """
    heads = [
        f"{column.name} [{column.unit}]" if column.unit else column.name for column in table.columns
    ]
    titled = table.frame.rename(dict(zip(table.frame.columns, heads, strict=True)))
    metadata = {
        "asked": words.say(table.asked),
        "units": json.dumps({column.name: column.unit for column in table.columns}),
        "meanings": json.dumps({one.name: words.say(one.meaning) for one in table.columns}),
    }
    write_safely(
        folder / "rows.parquet", lambda file: table.frame.write_parquet(file, metadata=metadata)
    )
    write_safely(folder / "rows.csv", titled.write_csv)


# The page: offline, plots, trade-off, map, sortable rows


FOLDER = Path(__file__).parent
DIGITS = 7
"""Significant digits on the page; the files beside it have all."""
GAP_DIGITS = 2
"""Of gaps, which are far below 1e-9: a tenth less to load."""
UNPLOTTED = ("t_f_lower_bound", "relative_gap")
"""Proofs, which say yes or no; they stand in the table."""
LEFT_OUT = "switching_times"
"""Long texts of every row; they stand in the files."""
SAID = ("yes", "no", "case", "over", "over-two", "numbers", "page", "chosen", "front", "map")
"""Texts that the script says; %1 and %2 stand for its values."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepPanel:
    """What says the template's texts, and the columns that the script draws."""

    say: Callable[[str], str]
    marks: str
    scale: str
    data: Mapping[str, Any]
    template: Path = FOLDER / "sweep.html"
    scripts: tuple[Path, ...] = (FOLDER / "sweep.js",)


def print_sweep(plan: Plan, table: SweepTable, words: Catalogue, *, created: str) -> str:
    """Return the page of a sweep begun at a date (ISO 8601).

    HTML with all text escaped, admitted by hashes to run its own script only.
    """
    machine = parse_profile(plan.profile_text, where=plan.where)
    said = [*summarise(table, words), words.say(table.asked)]
    verdict = Section(
        key="verdict",
        heading=words.text("verdict"),
        blocks=tuple(Paragraph(text=line) for line in said),
    )
    good = words.text("sweep-page-good", kind=table.flag)
    document = Document(
        language=words.language,
        title=words.text("sweep-page-title", name=plan.where),
        machine=machine.name,
        axis=f"{words.text('axis')} {machine.axis}",
        identity=plan.where,
        created=created,
        disclaimer=words.text("sweep-page-units"),
        sections=(verdict,),
    )
    panel = SweepPanel(
        say=partial(words.own, "sweep-page"),
        marks=words.text("sweep-page-marks", good=good),
        scale=words.text("sweep-page-scale", good=good),
        data=_page_data(plan, table, words),
    )
    return set_html(document, panel=panel)


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
            if column.name != LEFT_OUT
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
