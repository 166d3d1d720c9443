"""Rows on disk -> columns, and the files that others read."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import polars as pl

from mtcommission.files import replace_file
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.plan import Plan, Quantity
from mtcommission.sweep.rows import DONE, Column, columns
from mtcommission.sweep.store import Store, disk_full

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
    """Return the rows of a plan's store as columns.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.sweep.engine import run_sweep
    >>> from mtcommission.sweep.plan import read_axis
    >>> forces = read_axis("drive.max_force=1kN:4kN:4", where="example")
    >>> text = read_shipped("milling-manipulator").text
    >>> plan = Plan(profile_text=text, where="machine.toml", axes=(forces,))
    >>> with TemporaryDirectory() as folder:
    ...     frame = read_table(plan, run_sweep(plan, folder=Path(folder))).frame
    >>> [round(t_f, 6) for t_f in frame["t_f"].to_list()], frame["certified"].all()
    ([0.082396, 0.04352, 0.036119, 0.026324], True)
    """
    named = columns(plan)
    schema = {column.name: TYPES[column.kind] for column in named}
    # A piece that an interruption left twice appears once.
    frames = {
        piece: pl.DataFrame(rows, schema=schema, orient="row") for piece, rows in store.pieces()
    }
    parts = [frames[piece] for piece in sorted(frames)]
    frame = pl.concat(parts) if parts else pl.DataFrame(schema=schema)
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
    return [words.say(summary), *reasons]


def _said(outcome: str) -> str:
    return outcome.replace("_", " ")


def write_table(table: SweepTable, folder: Path, words: Catalogue) -> None:
    """Write ``rows.parquet`` (units, meanings, bounds as metadata), ``rows.csv`` (units on top).

    Raises
    ------
    InputError
        A file cannot be written.
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


def write_safely(path: Path, fill: Callable[[BinaryIO], object]) -> None:
    """Write a file as a whole; raise InputError, which says that the rows are kept, if it fails."""
    try:
        replace_file(path, fill)
    except OSError as error:
        raise disk_full(path, error) from error
