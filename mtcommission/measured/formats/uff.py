"""Universal File Format, dataset 58: functions at nodal degrees of freedom, by pyuff.

Source: SDRC, Universal File Dataset 58 and 164. Frequency responses, coherences and time responses
are taken; units come from the labels of the axes, else from the factors of dataset 164.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from mtcommission.measured.measurement import (
    Array,
    Column,
    FileContents,
    Given,
    Item,
    ResponseContents,
    Signal,
    TimeContents,
    broken,
)

MARK = b"    -1"
MOST_SETS = 500

_FRF, _COHERENCE, _TIME = 4, 6, 1
_OUTPUTS = {8: Signal.POSITION, 11: Signal.VELOCITY, 12: Signal.ACCELERATION}
_INPUTS = {9: "force", 13: "force", 12: "acceleration"}
_PLAIN = {8: "m", 11: "m/s", 12: "m/s^2", 9: "N", 13: "N"}
_FORCES = (9, 13)
_TURNING_FROM = 4
"""Directions 4 to 6 are rotations."""
Set = Mapping[str, Any]


def is_uff(data: bytes) -> bool:
    """Return whether the first line of some bytes opens a dataset."""
    return data.lstrip(b"\r\n")[:6] == MARK


def read_uff(data: bytes) -> FileContents:
    """Return the functions in a universal file."""
    sets = _sets(data)
    units = next((one for one in sets if one.get("type") == 164), {})
    length, force = (float(units.get(name) or 0.0) for name in ("length", "force"))
    functions = [one for one in sets if one.get("type") == 58]

    def of_kind(kind: int) -> list[Set]:
        return [one for one in functions if one.get("func_type") == kind]

    coherences = {
        _ends(one): np.real(_series(one)[1]).astype(np.float64) for one in of_kind(_COHERENCE)
    }
    items: list[Item] = [
        _response(one, coherences.get(_ends(one)), length, force) for one in of_kind(_FRF)
    ]
    if not items:
        items = _records(of_kind(_TIME), length, force)
    if not items:
        kinds = tuple(sorted({str(one.get("func_type", one.get("type"))) for one in sets}))
        raise broken("identify-uff-nothing", found=kinds)
    on = str(functions[0].get("id3", "")).strip()
    return FileContents(items=tuple(items), measured_on=on[:40])


def _sets(data: bytes) -> list[Set]:
    import pyuff

    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.uff"
        path.write_bytes(data)
        try:
            file = pyuff.UFF(str(path))
            types = [int(one) for one in file.get_set_types()]
            wanted = [place for place, one in enumerate(types) if one in (58, 164)]
            return [file.read_sets(place) for place in wanted[:MOST_SETS]]
        except Exception as error:  # pyuff raises nothing narrower
            raise broken("identify-uff-broken", reason=str(error)[:200]) from error


def _ends(one: Set) -> tuple[int, ...]:
    names = ("rsp_node", "rsp_dir", "ref_node", "ref_dir")
    return tuple(int(one.get(name) or 0) for name in names)


def _label(one: Set) -> str:
    node, direction, reference, other = _ends(one)
    return f"{node}:{direction}/{reference}:{other}"


def _series(one: Set) -> tuple[Array, np.ndarray[Any, Any]]:
    return np.asarray(one.get("x", ()), dtype=np.float64), np.asarray(one.get("data", ()))


def _kind(one: Set, axis: str) -> int:
    return int(one.get(f"{axis}_spec_data_type") or 0)


def _unit(one: Set, axis: str) -> str:
    unit = str(one.get(f"{axis}_axis_units_lab") or "").strip()
    return "" if unit.casefold() == "none" else unit


def _response(one: Set, coherence: Array | None, length: float, force: float) -> ResponseContents:
    """A response; its unit by the labels, else by the factors; neither, and SI is not claimed."""
    (hertz, values), wanted = _series(one), int(one.get("num_pts") or 0)
    if values.size != hertz.size or values.size != wanted:
        raise broken("identify-series-short", name=_label(one), got=values.size, wanted=wanted)
    below, factor = _kind(one, "orddenom"), None
    unit, per = (_unit(one, axis) for axis in ("ordinate", "orddenom"))
    if unit and per:
        unit = f"({unit})/({per})"
    elif "/" not in unit:
        unit = ""
        if length > 0.0 and force > 0.0:
            factor = force / length if below in _FORCES else 1.0
    return ResponseContents(
        label=_label(one),
        frequency_hz=hertz,
        values=values.astype(np.complex128),
        unit=unit,
        scale=factor,
        said=Given(input=_INPUTS.get(below, ""), output=_OUTPUTS.get(_kind(one, "ordinate"))),
        rotary=max(abs(_ends(one)[1]), abs(_ends(one)[3])) >= _TURNING_FROM,
        coherence=coherence if coherence is not None and coherence.size == values.size else None,
    )


def _records(series: Sequence[Set], length: float, force: float) -> list[Item]:
    """Time responses with one clock as one record."""
    clock, columns = None, []
    for one in series:
        t, data = _series(one)
        if t.size != data.size or t.size < 2 or not (clock is None or np.array_equal(t, clock)):
            continue
        clock = t
        kind, unit = _kind(one, "ordinate"), _unit(one, "ordinate")
        values = np.real(data).astype(np.float64)
        factor = force if kind in _FORCES else length
        if not unit and kind in _PLAIN and factor > 0.0:
            unit, values = _PLAIN[kind], values / factor
        columns.append(Column(name=_label(one), unit=unit, values=values))
    return [TimeContents(clock=clock, columns=tuple(columns))] if columns else []
