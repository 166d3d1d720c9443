"""What a row is: the columns of each quantity, and how their cells are filled."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from math import isnan

from mtcommission.machine.machine import Motion
from mtcommission.messages.catalogue import NAME
from mtcommission.messages.message import Message
from mtcommission.optimal.free.time_optimal import GAP_TOLERANCE
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.describe import unit_of
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.plan import (
    PEAKS_KEY,
    Plan,
    Quantity,
    Settings,
    piece_size,
    plain_key,
    si_number,
)

DONE = "done"
PEAK = "peak_"
"""What columns of the peaks of signals begin with."""

Cell = float | int | str | bool | None
Row = tuple[Cell, ...]


@dataclass(frozen=True, slots=True)
class Column:
    """One column of the table: named as in the record, or by the dotted key of what varies."""

    name: str
    unit: str = ""  # SI
    kind: str = "float"  # or "int", "bool", "str"
    varies: bool = False

    @property
    def meaning(self) -> Message:
        """What it holds."""
        if self.varies:
            return Message("sweep-column-key")
        if self.name.startswith(PEAK) and self.name != "peak_deviation":
            signal = Message(NAME, key=self.name.removeprefix(PEAK))
            return Message("sweep-column-peak", name=signal)
        return Message(f"sweep-column-{self.name.replace('_', '-')}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """Cases that are computed together, with all that this needs; goes to another process."""

    piece: int
    first: int  # number of the first case
    settings: tuple[Settings, ...]  # of each case
    base: Plan  # without its axes


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What was computed for a case: the result columns, or why there are none."""

    cells: Row = ()
    outcome: str = DONE
    message: str = ""
    record: str = ""  # ``record.json`` of a run, as text


def cut_work(plan: Plan, numbers: Iterable[int]) -> Iterator[Work]:
    """Yield pieces of a plan, by number from 0, with all that they need."""
    base, size = replace(plan, axes=()), piece_size(plan)
    for piece in numbers:
        cases = range(piece * size, min((piece + 1) * size, plan.count))
        settings = tuple(plan.settings(index) for index in cases)
        yield Work(piece=piece, first=cases.start, settings=settings, base=base)


def fill_rows(table: Sequence[Column], work: Work, answers: Sequence[Answer]) -> tuple[Row, ...]:
    """Return a piece's rows: case, hash of its inputs, what varies, results, how it ended."""
    kinds = [column.kind for column in table[2:]]
    digest, rows = work.base.base_digest, []
    for number, (settings, answer) in enumerate(zip(work.settings, answers, strict=True)):
        inputs = sha256(json.dumps([digest, settings]).encode()).hexdigest()
        values = [
            text if kind == "str" else si_number(text)
            for (_, text), kind in zip(settings, kinds, strict=False)
        ]
        cells = answer.cells or (None,) * (len(table) - len(values) - 4)
        row = (work.first + number, inputs, *values, *cells, answer.outcome, answer.message)
        rows.append(row)
    return tuple(rows)


def peak_signals(plant: Plant) -> tuple[str, ...]:
    """Return the signals whose peaks are in a row: modes' rates, TCP vibration, motor force."""
    rates = tuple(plant.states[mode.rate] for mode in plant.modes)
    return (*rates, "tcp_vibration", plant.states[plant.force])


def columns(plan: Plan) -> tuple[Column, ...]:
    """Return the columns of a plan's table; raise InputError if its profile cannot be read."""
    machine = parse_profile(plan.profile_text, where=plan.where)
    plant, rotary = build_plant(machine), machine.motion is Motion.ROTARY
    varied = []
    for axis in plan.axes:
        for key, texts in zip(axis.keys, zip(*axis.rows, strict=True), strict=True):
            if any(isnan(si_number(text)) for text in texts):
                varied.append(Column(key, kind="str", varies=True))
            else:
                varied.append(Column(key, _unit_of_key(key, plant, rotary=rotary), varies=True))
    return (
        Column("case", kind="int"),
        Column("inputs", kind="str"),
        *varied,
        *_result_columns(plan.quantity, plant, rotary=rotary),
        Column("outcome", kind="str"),
        Column("message", kind="str"),
    )


def _result_columns(quantity: Quantity, plant: Plant, *, rotary: bool) -> tuple[Column, ...]:
    """The columns that a quantity fills."""
    proof = (
        Column("t_f", "s"),
        Column("t_f_lower_bound", "s"),
        Column("relative_gap"),
        Column("certified", kind="bool"),
    )
    units = dict(zip(plant.signals, plant.signal_units, strict=True))
    peaks = tuple(Column(PEAK + name, units[name]) for name in peak_signals(plant))
    if quantity is Quantity.OPTIMAL:
        switches = Column("switches", kind="int"), Column("switching_times", "s", kind="str")
        return (*proof, *switches, *peaks)
    length, force = ("rad", "N m") if rotary else ("m", "N")
    found = (
        *proof,
        Column("acceleration", f"{length}/s^2"),
        Column("jerk", f"{length}/s^3"),
        Column("jerk_time", "s"),
        Column("settling_time", "s"),
        Column("residual_deviation", length),
        Column("peak_deviation", length),
        *peaks,
        Column("peak_F_set", force),
        Column("requirements_met", kind="bool"),
        Column("bound_by", kind="str"),
        Column("obstacle", kind="str"),
    )
    return (*found, Column("record", kind="str")) if quantity is Quantity.RUN else found


def _unit_of_key(key: str, plant: Plant, *, rotary: bool) -> str:
    """SI unit of a key of the profile; "SI" where nothing tells."""
    name = key.removeprefix(PEAKS_KEY)
    if name != key and name in plant.signals:
        return plant.signal_units[plant.signals.index(name)]
    unit = unit_of(plain_key(key).split("."), rotary=rotary)
    return "SI" if unit is None else unit


def proof_cells(t_f: float, lower_bound: float) -> Row:
    """Return the columns of a time and what proves it; certified up to 1e-9."""
    gap = (t_f - lower_bound) / t_f
    return (t_f, lower_bound, gap, gap <= GAP_TOLERANCE)


def switch_cells(times: Sequence[float]) -> Row:
    """Return the columns of the switching times."""
    return (len(times), " ".join(f"{time:.12g}" for time in times))
