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

from mtcommission.identify.formats.contents import (
    NO_LINES,
    Column,
    FileContents,
    Item,
    ResponseContents,
    TimeContents,
    refuse,
)
from mtcommission.identify.measurement import Array, Output
from mtcommission.messages.message import Message

MARK = b"    -1"
MOST_SETS = 500

_FRF, _COHERENCE, _TIME = 4, 6, 1
_OUTPUTS = {8: Output.POSITION, 11: Output.VELOCITY, 12: Output.ACCELERATION}
_FORCES = frozenset({9, 13})
_PLAIN = {8: "m", 11: "m/s", 12: "m/s^2", 9: "N", 13: "N"}
_TURNING_FROM = 4
"""Directions 4 to 6 are rotations."""

Set = Mapping[str, Any]


def is_uff(data: bytes) -> bool:
    """Return whether the first line of some bytes opens a dataset."""
    return data.lstrip(b"\r\n")[:6] == MARK


def read_uff(data: bytes, *, where: str) -> FileContents:
    """Return the functions in a universal file.

    Raise InputError where pyuff cannot read it, or it has no function of use here.
    """
    sets = _sets(data, where=where)
    scale = next((one for one in sets if one.get("type") == 164), {})
    functions = [one for one in sets if one.get("type") == 58]
    coherences = {
        _ends(one): np.real(_data(one)).astype(np.float64)
        for one in functions
        if one.get("func_type") == _COHERENCE
    }
    items: list[Item] = [
        _response(one, coherences.get(_ends(one)), scale, where=where)
        for one in functions
        if one.get("func_type") == _FRF
    ]
    if not items:
        items = _records([one for one in functions if one.get("func_type") == _TIME], scale)
    if not items:
        kinds = tuple(sorted({str(one.get("func_type", one.get("type"))) for one in sets}))
        raise refuse(where, "identify-uff-nothing", found=kinds)
    on = str(functions[0].get("id3", "")).strip()
    return FileContents(
        format=Message("identify-format-uff"), items=tuple(items), measured_on=on[:40]
    )


def _sets(data: bytes, *, where: str) -> list[Set]:
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
            raise refuse(where, "identify-uff-broken", reason=str(error)[:200]) from error


def _ends(one: Set) -> tuple[int, ...]:
    names = ("rsp_node", "rsp_dir", "ref_node", "ref_dir")
    return tuple(int(one.get(name) or 0) for name in names)


def _label(one: Set) -> str:
    node, direction, reference, other = _ends(one)
    return f"{node}:{direction}/{reference}:{other}"


def _data(one: Set) -> np.ndarray[Any, Any]:
    return np.asarray(one.get("data", ()))


def _abscissa(one: Set) -> Array:
    return np.asarray(one.get("x", ()), dtype=np.float64)


def _response(one: Set, coherence: Array | None, scale: Set, *, where: str) -> ResponseContents:
    values, hertz = _data(one).astype(np.complex128), _abscissa(one)
    if values.size != hertz.size or values.size != int(one.get("num_pts") or 0):
        wanted = int(one.get("num_pts") or 0)
        raise refuse(
            where, "identify-series-short", name=_label(one), got=values.size, wanted=wanted
        )
    above, below = _kind(one, "ordinate"), _kind(one, "orddenom")
    unit, factor = _unit_of(one, scale)
    turns = max(abs(_ends(one)[1]), abs(_ends(one)[3])) >= _TURNING_FROM
    fits = coherence is not None and coherence.size == values.size
    return ResponseContents(
        label=_label(one),
        frequency_hz=hertz,
        values=values,
        unit=unit,
        scale=factor,
        input="force" if below in _FORCES else "acceleration" if below == 12 else "",
        output=_OUTPUTS.get(above),
        rotary=turns,
        coherence=coherence if fits else None,
        lines=NO_LINES,
    )


def _kind(one: Set, axis: str) -> int:
    return int(one.get(f"{axis}_spec_data_type") or 0)


def _unit_of(one: Set, scale: Set) -> tuple[str, float | None]:
    """Unit by the labels, else the factor by dataset 164; neither, and SI is not claimed."""
    labels = [
        str(one.get(f"{axis}_axis_units_lab") or "").strip() for axis in ("ordinate", "orddenom")
    ]
    if all(label and label.casefold() != "none" for label in labels):
        return f"({labels[0]})/({labels[1]})", None
    if labels[0] and "/" in labels[0]:
        return labels[0], None
    length, force = (float(scale.get(name) or 0.0) for name in ("length", "force"))
    if length > 0.0 and force > 0.0:
        return "", force / length if _kind(one, "orddenom") in _FORCES else 1.0
    return "", None


def _records(series: Sequence[Set], scale: Set) -> list[Item]:
    """Time responses with one clock as one record."""
    whole = [one for one in series if _abscissa(one).size == _data(one).size > 1]
    first = [one for one in whole if np.array_equal(_abscissa(one), _abscissa(whole[0]))]
    length, force = (float(scale.get(name) or 0.0) for name in ("length", "force"))
    columns = []
    for one in first:
        label = str(one.get("ordinate_axis_units_lab") or "").strip()
        kind = _kind(one, "ordinate")
        unit = "" if label.casefold() == "none" else label
        values = np.real(_data(one)).astype(np.float64)
        factor = force if kind in _FORCES else length
        if not unit and kind in _PLAIN and factor > 0.0:
            unit, values = _PLAIN[kind], values / factor
        columns.append(Column(name=_label(one), unit=unit, values=values))
    if not columns:
        return []
    return [TimeContents(clock=_abscissa(first[0]), columns=tuple(columns), lines=NO_LINES)]
