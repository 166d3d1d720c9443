"""Klipper's resonance tests: power by frequency, and raw accelerations.

Formats read in klippy/extras/shaper_calibrate.py (``freq,psd_x,psd_y,psd_z,psd_xyz``, names of
chips where there are several, then ``shapers:`` and their transfer functions; older files lack the
word) and klippy/extras/adxl345.py (``#time,accel_x,accel_y,accel_z``: s, mm/s^2 with gravity).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.measured.formats.table import read_table, words_of
from mtcommission.measured.measurement import (
    AllDirections,
    Array,
    Column,
    FileContents,
    Sensor,
    SpectrumContents,
    TimeContents,
    broken,
)

HALF_POWER_BINS = 1.41
"""Half-power width of Klipper's window, Kaiser's with β = 6, in its bins (computed)."""
ROUNDING_HZ = 0.06
"""Half of the last decimal with which frequencies are printed, and a bit [Hz]."""
RESPONSE_WORDS = frozenset({"re", "im", "real", "imag", "magnitude", "mag", "phase", "gain"})
"""Words of another table that begins with a frequency."""
_AXES = ("psd_x", "psd_y", "psd_z")
_SUM = "psd_xyz"
_NO_SPECTRA = (_SUM, "accel_per_hz")
_RAW = "time,accel_x,accel_y,accel_z"


def header_of(lines: Sequence[str]) -> str:
    """Return the first line of names, as Klipper writes it; "" if it is none of Klipper's."""
    for line in lines[:20]:
        plain = line.strip()
        if plain.startswith("##") or not plain:
            continue
        names = plain.lstrip("#")
        others = set(words_of(names.partition(",")[2]))
        is_power = names.startswith("freq,") and not others & RESPONSE_WORDS
        return names if is_power or names.startswith(_RAW) else ""
    return ""


def read_klipper(lines: Sequence[str]) -> FileContents:
    """Return the spectra or accelerations of a file of Klipper's."""
    names = [name.strip().strip('"') for name in header_of(lines).split(",")]
    return _raw(lines) if names[0] == "time" else _power(lines, names)


def _power(lines: Sequence[str], names: Sequence[str]) -> FileContents:
    ends = [place for place, name in enumerate(names) if name == "shapers:" or "(" in name]
    width = ends[0] if ends else len(names)
    start = next(n for n, line in enumerate(lines) if line.lstrip("#").startswith("freq,")) + 1
    cut = [",".join(line.split(",")[:width]) for line in lines[start:]]
    table = read_table(cut, first_line=start + 1, columns=width)
    frequency, power = _evened(table.values[:, 0]), table.values[:, 1:]
    if (power < 0.0).any():
        row = int(np.argmax((power < 0.0).any(axis=1)))
        raise broken("identify-negative-power", line=int(table.lines[row]))
    spectra, remarks = dict(zip(names[1:width], power.T, strict=True)), list(table.remarks)
    kept = [name for name in spectra if name not in _NO_SPECTRA]
    axes = [name for name in kept if name in _AXES]
    if axes:
        kept = [max(axes, key=lambda name: float(spectra[name].max()))]
        remarks.append(Message("identify-loudest-axis", name=kept[0]))
    if not kept:
        raise broken("identify-no-response", found=tuple(names))
    spacing = (frequency[-1] - frequency[0]) / max(frequency.size - 1, 1)
    items = tuple(
        SpectrumContents(
            label=name,
            frequency_hz=frequency,
            density=spectra[name],
            resolution_hz=HALF_POWER_BINS * spacing if axes else None,
            lines=table.lines,
            all_directions=AllDirections(
                frequency_hz=table.values[:, 0],
                density=spectra.get(_SUM, spectra[name]),
                is_divided=bool(ends),
            ),
        )
        for name in kept
    )
    return FileContents(items=items, remarks=tuple(remarks))


def _evened(frequency_hz: Array) -> Array:
    """Lines of a Fourier transform, which are printed with one decimal only."""
    number = np.arange(frequency_hz.size)
    even = np.polyval(np.polyfit(number, frequency_hz, 1), number) if number.size > 1 else number
    is_even = bool(np.all(np.abs(even - frequency_hz) <= ROUNDING_HZ))
    return np.asarray(np.maximum(even, 0.0) if is_even else frequency_hz)


def _raw(lines: Sequence[str]) -> FileContents:
    table = read_table(lines, columns=4)
    columns = tuple(
        Column(name=f"accel_{axis}", unit="mm/s^2", values=values, sensor=Sensor.TCP)
        for axis, values in zip("xyz", table.values.T[1:], strict=True)
    )
    record = TimeContents(clock=table.values[:, 0], columns=columns, lines=table.lines)
    return FileContents(items=(record,), remarks=table.remarks, is_klipper_raw=True)
