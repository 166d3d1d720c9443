"""One case -> one row: the columns of each quantity, and how they are computed.

A case that fails is a row with its named outcome; nothing here stops a sweep.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from math import isnan
from typing import Any

from mtcommission.errors import ComputationError, InputError
from mtcommission.machine import Machine
from mtcommission.optima import find_time_optimum, require_force
from mtcommission.optimal.solution import Bound, TimeOptimum
from mtcommission.optimal.time_optimal import GAP_TOLERANCE
from mtcommission.plant import build_plant
from mtcommission.profile import parse_profile, profile_schema
from mtcommission.sweep.cases import Plan, Quantity, Settings, si_number, vary_profile
from mtcommission.sweep.store import Cell, Row

DONE = "done"
WRONG_INPUT = "wrong_input"
INTERNAL = "internal_error"


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


def result_columns(quantity: Quantity, *, rotary: bool) -> tuple[Column, ...]:
    """Return the columns that a quantity fills."""
    if quantity is Quantity.OPTIMAL:
        return (
            Column(name="t_f", unit="s"),
            Column(name="t_f_lower_bound", unit="s"),
            Column(name="relative_gap"),
            Column(name="certified", kind="bool"),
            Column(name="switches", kind="int"),
            Column(name="switching_times", unit="s", kind="str"),
        )
    length = "rad" if rotary else "m"
    found = (
        Column(name="t_f", unit="s"),
        Column(name="acceleration", unit=f"{length}/s^2"),
        Column(name="jerk", unit=f"{length}/s^3"),
        Column(name="jerk_time", unit="s"),
        Column(name="settling_time", unit="s"),
        Column(name="residual_deviation", unit=length),
        Column(name="peak_deviation", unit=length),
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
        Any plan.

    Returns
    -------
    tuple of Column
        Case, hash of its inputs, what varies, results, outcome and message.
    """
    varied = []
    rotary = tomllib.loads(plan.profile_text).get("machine", {}).get("motion") == "rotary"
    for axis in plan.axes:
        for place, key in enumerate(axis.keys):
            words = any(isnan(si_number(row[place])) for row in axis.rows)
            unit = "" if words else key_unit(key, rotary=rotary)
            varied.append(Column(name=key, unit=unit, kind="str" if words else "float"))
    results = result_columns(plan.quantity, rotary=rotary)
    return (*_COMMON, *varied, *results, *_ENDING)


def key_unit(key: str, *, rotary: bool) -> str:
    """Return the SI unit of a key of the profile; "SI" where it depends on the plant.

    Examples
    --------
    >>> key_unit("plant.slider_mass", rotary=False), key_unit("moves.0.distance", rotary=True)
    ('kg', 'rad')
    """
    schema = json.loads(profile_schema())
    places = [schema]
    for part in key.split("."):
        if part.isdigit():
            continue
        places = [
            below
            for place in places
            for table in _tables(place, schema["$defs"])
            if (below := table.get("properties", {}).get(part)) is not None
        ]
    name = "x-unit-rotary" if rotary else "x-unit"
    for place in places:
        for table in _tables(place, schema["$defs"]):
            if name in table:
                return "" if table[name] == "no unit" else str(table[name])
    return "SI"


def _tables(place: dict[str, Any], definitions: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """Return a schema with all that it refers to, alternatives and elements alike."""
    found = [place]
    reference = place.get("$ref")
    if isinstance(reference, str):
        found += _tables(definitions[reference.rsplit("/", 1)[1]], definitions)
    for name in ("anyOf", "oneOf", "items"):
        below = place.get(name, [])
        for item in below if isinstance(below, list) else [below]:
            found += _tables(item, definitions)
    return found


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


def solve_case(work: Work, number: int) -> Answer:
    """Return the row of one case, whatever happens to it.

    Parameters
    ----------
    work
        The piece that the case belongs to.
    number
        Its place there.

    Returns
    -------
    Answer
    """
    settings = work.settings[number]
    try:
        text = vary_profile(work.base.profile_text, settings, where=work.base.where)
        machine = parse_profile(text, where=work.base.where)
        return _compute(work, number, text, machine)
    except InputError as error:
        return failed(work, number, WRONG_INPUT, str(error))
    except ComputationError as error:
        return failed(work, number, error.outcome.name.lower(), str(error))
    except Exception as error:  # one case must not take the others with it
        return failed(work, number, INTERNAL, f"please report it with the profile: {error!r}")


def _compute(work: Work, number: int, text: str, machine: Machine) -> Answer:
    base = work.base
    require_force(machine)
    if base.quantity is Quantity.OPTIMAL:
        optimum = _time_optimum(machine, base.move, base.bounds)
        return done(work, number, optimum_cells(optimum))
    from mtcommission.sweep.chain import choose_case, run_case  # the loop's libraries take seconds

    if base.quantity is Quantity.LIMITS:
        return done(work, number, choose_case(machine))
    name = f"case-{work.first + number:06d}.json"
    found = run_case(machine, text=text, name=base.where, created=base.created)
    return done(work, number, (*found.cells, f"records/{name}"), record=found.record)


def _time_optimum(machine: Machine, move: int, bounds: tuple[Bound, ...]) -> TimeOptimum:
    if not 1 <= move <= len(machine.moves):
        raise IndexError(f"move {move} of {len(machine.moves)}")
    return find_time_optimum(
        build_plant(machine),
        machine.moves[move - 1],
        force_limit=machine.drive.motion_force,
        bounds=bounds,
    )


def optimum_cells(optimum: TimeOptimum) -> tuple[Cell, ...]:
    """Return the result columns of a time-optimal control."""
    proof = optimum.certificate
    return time_cells(optimum.t_f, proof.t_f_lower_bound, optimum.switching_times)


def time_cells(t_f: float, lower_bound: float, times: Sequence[float]) -> tuple[Cell, ...]:
    """Return the result columns of a time and what proves it; certified up to 1e-9."""
    gap = (t_f - lower_bound) / t_f
    listed = " ".join(f"{time:.12g}" for time in times)
    return (t_f, lower_bound, gap, gap <= GAP_TOLERANCE, len(times), listed)


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
