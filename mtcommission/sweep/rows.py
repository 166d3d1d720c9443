"""What a row is: the columns of each quantity, and how their cells are filled."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from math import isnan

from mtcommission.machine.machine import Motion
from mtcommission.optimal.free.time_optimal import GAP_TOLERANCE
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.describe import unit_of
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.cases import (
    PEAKS_KEY,
    Plan,
    Quantity,
    Settings,
    plain_key,
    si_number,
)
from mtcommission.sweep.store import Cell, Row

DONE = "done"


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of the table.

    Parameters
    ----------
    name
        As in the record, or the dotted key of what varies.
    unit
        SI; "" for none.
    kind
        ``"float"``, ``"int"``, ``"bool"`` or ``"str"``.
    """

    name: str
    unit: str = ""
    kind: str = "float"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What was computed for a case.

    Parameters
    ----------
    row
        Its row.
    record
        ``record.json`` of a run, as text; "" otherwise.
    """

    row: Row
    record: str = ""


_COMMON = (Column(name="case", kind="int"), Column(name="inputs", kind="str"))
_ENDING = (Column(name="outcome", kind="str"), Column(name="message", kind="str"))


PEAK = "peak_"


def peak_signals(plant: Plant) -> tuple[str, ...]:
    """Return the signals whose peaks are in a row: rate of each mode, TCP vibration, motor force.

    Parameters
    ----------
    plant
        Of the case.

    Returns
    -------
    tuple of str
        From ``plant.signals``.
    """
    rates = tuple(plant.states[mode.rate] for mode in plant.modes)
    return (*rates, "tcp_vibration", plant.states[plant.force])


def result_columns(quantity: Quantity, plant: Plant, *, rotary: bool) -> tuple[Column, ...]:
    """Return the columns that a quantity fills.

    Parameters
    ----------
    quantity
        What is computed.
    plant
        Of the profile as it is.
    rotary
        Whether rad stands for m.
    """
    proof = (
        Column(name="t_f", unit="s"),
        Column(name="t_f_lower_bound", unit="s"),
        Column(name="relative_gap"),
        Column(name="certified", kind="bool"),
    )
    units = dict(zip(plant.signals, plant.signal_units, strict=True))
    peaks = tuple(Column(name=PEAK + name, unit=units[name]) for name in peak_signals(plant))
    if quantity is Quantity.OPTIMAL:
        return (
            *proof,
            Column(name="switches", kind="int"),
            Column(name="switching_times", unit="s", kind="str"),
            *peaks,
        )
    length, force = ("rad", "N m") if rotary else ("m", "N")
    found = (
        *proof,
        Column(name="acceleration", unit=f"{length}/s^2"),
        Column(name="jerk", unit=f"{length}/s^3"),
        Column(name="jerk_time", unit="s"),
        Column(name="settling_time", unit="s"),
        Column(name="residual_deviation", unit=length),
        Column(name="peak_deviation", unit=length),
        *peaks,
        Column(name="peak_F_set", unit=force),
        Column(name="requirements_met", kind="bool"),
        Column(name="bound_by", kind="str"),
        Column(name="obstacle", kind="str"),
    )
    return (*found, Column(name="record", kind="str")) if quantity is Quantity.RUN else found


def columns(plan: Plan) -> tuple[Column, ...]:
    """Return the columns of a plan's table.

    Parameters
    ----------
    plan
        Any plan whose profile can be read as it is.

    Returns
    -------
    tuple of Column
        Case, hash of its inputs, what varies, results, outcome and message.

    Raises
    ------
    InputError
        If the profile cannot be read.
    """
    machine = parse_profile(plan.profile_text, where=plan.where)
    plant, rotary = build_plant(machine), machine.motion is Motion.ROTARY
    varied = []
    for axis in plan.axes:
        for place, key in enumerate(axis.keys):
            words = any(isnan(si_number(row[place])) for row in axis.rows)
            unit = "" if words else _unit_of_key(key, plant, rotary=rotary)
            varied.append(Column(name=key, unit=unit, kind="str" if words else "float"))
    results = result_columns(plan.quantity, plant, rotary=rotary)
    return (*_COMMON, *varied, *results, *_ENDING)


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """Cases that are computed together, with all that this needs; goes to another process.

    Parameters
    ----------
    piece
        Its number.
    first
        Number of the first case.
    settings
        Of each case.
    base
        The plan without its axes.
    base_digest
        Hash of what all cases share.
    columns
        Of the table.
    """

    piece: int
    first: int
    settings: tuple[Settings, ...]
    base: Plan
    base_digest: str
    columns: tuple[Column, ...]


def input_hash(work: Work, settings: Settings) -> str:
    """Return the SHA-256 of all that the row of a case depends on."""
    return sha256(json.dumps([work.base_digest, settings]).encode()).hexdigest()


def proof_cells(t_f: float, lower_bound: float) -> tuple[Cell, ...]:
    """Return the columns of a time and what proves it; certified up to 1e-9."""
    gap = (t_f - lower_bound) / t_f
    return (t_f, lower_bound, gap, gap <= GAP_TOLERANCE)


def switch_cells(times: Sequence[float]) -> tuple[Cell, ...]:
    """Return the columns of the switching times."""
    return (len(times), " ".join(f"{time:.12g}" for time in times))


def done(work: Work, number: int, cells: tuple[Cell, ...], *, record: str = "") -> Answer:
    """Return a row with results."""
    return Answer(row=(*_begin(work, number), *cells, DONE, ""), record=record)


def failed(work: Work, number: int, outcome: str, message: str) -> Answer:
    """Return a row without results that names why."""
    begin = _begin(work, number)
    empty = (None,) * (len(work.columns) - len(begin) - len(_ENDING))
    return Answer(row=(*begin, *empty, outcome, message))


def _begin(work: Work, number: int) -> tuple[Cell, ...]:
    settings = work.settings[number]
    kinds = [column.kind for column in work.columns[len(_COMMON) :]]
    values = [
        text if kind == "str" else si_number(text)
        for (_, text), kind in zip(settings, kinds, strict=False)
    ]
    return (work.first + number, input_hash(work, settings), *values)
