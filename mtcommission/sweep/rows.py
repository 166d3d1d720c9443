"""What a row is: the columns of each quantity, and how their cells are filled."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from math import isnan

from mtcommission.machine.machine import Motion
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

Cell = float | int | str | bool | None
Row = tuple[Cell, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of the table: named as in the record, or by the dotted key of what varies."""

    name: str
    meaning: Message
    unit: str = ""  # SI
    kind: str = "float"  # or "int", "bool", "str"


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


PEAK = "peak_"


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
        for place, key in enumerate(axis.keys):
            words = any(isnan(si_number(row[place])) for row in axis.rows)
            unit = "" if words else _unit_of_key(key, plant, rotary=rotary)
            kind = "str" if words else "float"
            varied.append(
                Column(name=key, meaning=Message("sweep-column-key"), unit=unit, kind=kind)
            )
    return (
        Column(name="case", meaning=Message("sweep-column-case"), kind="int"),
        Column(name="inputs", meaning=Message("sweep-column-inputs"), kind="str"),
        *varied,
        *_result_columns(plan.quantity, plant, rotary=rotary),
        Column(name="outcome", meaning=Message("sweep-column-outcome"), kind="str"),
        Column(name="message", meaning=Message("sweep-column-message"), kind="str"),
    )


def _result_columns(quantity: Quantity, plant: Plant, *, rotary: bool) -> tuple[Column, ...]:
    """The columns that a quantity fills."""
    proof = (
        Column(name="t_f", meaning=Message("sweep-column-t-f"), unit="s"),
        Column(name="t_f_lower_bound", meaning=Message("sweep-column-t-f-lower-bound"), unit="s"),
        Column(name="relative_gap", meaning=Message("sweep-column-relative-gap")),
        Column(name="certified", meaning=Message("sweep-column-certified"), kind="bool"),
    )
    units = dict(zip(plant.signals, plant.signal_units, strict=True))
    peaks = tuple(
        Column(name=PEAK + name, meaning=Message("sweep-column-peak", name=name), unit=units[name])
        for name in peak_signals(plant)
    )
    if quantity is Quantity.OPTIMAL:
        times = Message("sweep-column-switching-times")
        return (
            *proof,
            Column(name="switches", meaning=Message("sweep-column-switches"), kind="int"),
            Column(name="switching_times", meaning=times, unit="s", kind="str"),
            *peaks,
        )
    length, force = ("rad", "N m") if rotary else ("m", "N")
    residual, peak = Message("sweep-column-residual"), Message("sweep-column-peak-deviation")
    found = (
        *proof,
        Column(
            name="acceleration", meaning=Message("sweep-column-acceleration"), unit=f"{length}/s^2"
        ),
        Column(name="jerk", meaning=Message("sweep-column-jerk"), unit=f"{length}/s^3"),
        Column(name="jerk_time", meaning=Message("sweep-column-jerk-time"), unit="s"),
        Column(name="settling_time", meaning=Message("sweep-column-settling-time"), unit="s"),
        Column(name="residual_deviation", meaning=residual, unit=length),
        Column(name="peak_deviation", meaning=peak, unit=length),
        *peaks,
        Column(name="peak_F_set", meaning=Message("sweep-column-peak", name="F_set"), unit=force),
        Column(name="requirements_met", meaning=Message("sweep-column-met"), kind="bool"),
        Column(name="bound_by", meaning=Message("sweep-column-bound-by"), kind="str"),
        Column(name="obstacle", meaning=Message("sweep-column-obstacle"), kind="str"),
    )
    record = Column(name="record", meaning=Message("sweep-column-record"), kind="str")
    return (*found, record) if quantity is Quantity.RUN else found


def _unit_of_key(key: str, plant: Plant, *, rotary: bool) -> str:
    name = key.removeprefix(PEAKS_KEY)
    if name != key and name in plant.signals:
        return plant.signal_units[plant.signals.index(name)]
    return key_unit(key, rotary=rotary)


def key_unit(key: str, *, rotary: bool) -> str:
    """Return the SI unit of a key of the profile; "SI" where it depends on the plant.

    Examples
    --------
    >>> key_unit("plant.slider_mass", rotary=False), key_unit("moves.0.distance", rotary=True)
    ('kg', 'rad')
    """
    unit = unit_of(plain_key(key).split("."), rotary=rotary)
    return "SI" if unit is None else unit


def proof_cells(t_f: float, lower_bound: float) -> Row:
    """Return the columns of a time and what proves it; certified up to 1e-9."""
    gap = (t_f - lower_bound) / t_f
    return (t_f, lower_bound, gap, gap <= GAP_TOLERANCE)


def switch_cells(times: Sequence[float]) -> Row:
    """Return the columns of the switching times."""
    return (len(times), " ".join(f"{time:.12g}" for time in times))
