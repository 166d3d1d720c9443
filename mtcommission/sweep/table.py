"""Rows on disk -> columns, and the files that others read."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import polars as pl

from mtcommission.files import replace_file
from mtcommission.sweep.cases import Plan
from mtcommission.sweep.meanings import describe_request, meaning_of
from mtcommission.sweep.pieces import piece_size
from mtcommission.sweep.rows import DONE, Column, columns
from mtcommission.sweep.store import Opened, disk_full, read_finished

TYPES = {"float": pl.Float64(), "int": pl.Int64(), "bool": pl.Boolean(), "str": pl.String()}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SweepTable:
    """The rows of a sweep as columns, in the order of the cases.

    Parameters
    ----------
    columns
        Names, units and kinds.
    frame
        The values; null where a case gave none.
    asked
        What was computed for every case, as a sentence.
    """

    columns: tuple[Column, ...]
    frame: pl.DataFrame
    asked: str


def read_table(plan: Plan, store: Opened) -> SweepTable:
    """Return the rows of a store as columns.

    Parameters
    ----------
    plan
        The plan that the store belongs to.
    store
        With finished rows.

    Returns
    -------
    SweepTable
        Sorted by case; a case that an interruption left twice appears once.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.sweep.cases import read_axis
    >>> from mtcommission.sweep.engine import run_sweep
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
    frames, size = {}, piece_size(plan)
    for finished in read_finished(store):
        frames[finished.piece * size] = pl.DataFrame(finished.rows, schema=schema, orient="row")
    parts = [frames[first] for first in sorted(frames)]
    frame = pl.concat(parts) if parts else pl.DataFrame(schema=schema)
    return SweepTable(columns=named, frame=frame, asked=describe_request(plan))


def write_table(table: SweepTable, folder: Path) -> None:
    """Write ``rows.parquet`` (units, meanings, bounds as metadata), ``rows.csv`` (units on top).

    Parameters
    ----------
    table
        Rows.
    folder
        Exists.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    units = {column.name: column.unit for column in table.columns}
    heads = [
        f"{column.name} [{column.unit}]" if column.unit else column.name for column in table.columns
    ]
    titled = table.frame.rename(dict(zip(table.frame.columns, heads, strict=True)))
    meanings = {column.name: meaning_of(column) for column in table.columns}
    metadata = {
        "asked": table.asked,
        "units": json.dumps(units),
        "meanings": json.dumps(meanings),
    }
    write_safely(
        folder / "rows.parquet", lambda file: table.frame.write_parquet(file, metadata=metadata)
    )
    write_safely(folder / "rows.csv", titled.write_csv)


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """What a sweep came to.

    Parameters
    ----------
    text
        For people: one line, and one more for each outcome of cases that failed, with its reason.
    done
        Cases with a result.
    is_met
        Whether every case has one, certified or with its requirements met.
    """

    text: str
    done: int
    is_met: bool


def summarise_table(table: SweepTable) -> Summary:
    """Return how many cases have a result, how many are met, and how the others ended.

    Parameters
    ----------
    table
        Rows.
    """
    frame = table.frame
    outcomes = frame["outcome"].value_counts(sort=True).rows()
    name = "requirements_met" if "requirements_met" in frame.columns else "certified"
    met = int(frame[name].sum() or 0)
    done = sum(count for outcome, count in outcomes if outcome == DONE)
    ends = [f"{count} {outcome.replace('_', ' ')}" for outcome, count in outcomes]
    text = f"{frame.height} cases: {', '.join(ends)}; {name.replace('_', ' ')}: {met}"
    return Summary(text="\n".join([text, *_reasons(frame)]), done=done, is_met=met == frame.height)


def _reasons(frame: pl.DataFrame) -> list[str]:
    """One line for each outcome but "done", in the order in which they first come."""
    failed = frame.filter(pl.col("outcome") != DONE).unique("outcome", keep="first")
    return [
        f"{outcome.replace('_', ' ')}, first in case {case}: {message}"
        for case, outcome, message in failed.sort("case")["case", "outcome", "message"].rows()
    ]


def write_safely(path: Path, fill: Callable[[BinaryIO], object]) -> None:
    """Write a file as a whole; raise InputError, which says that the rows are kept, if it fails."""
    try:
        replace_file(path, fill)
    except OSError as error:
        raise disk_full(path, error) from error
