"""The identified model against the time records: those it came from, and one held back."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal.windows import tukey

from mtcommission.identify.fit.fitted import FittedResponse
from mtcommission.identify.identified import Identified
from mtcommission.identify.measurement import FORCES, Channel, Signal, TimeRecord
from mtcommission.identify.states import identify

Array = NDArray[np.float64]

EDGE = 0.1
"""Share of a record that is faded in and out: what went before it is not known."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    """How well a model explains a record."""

    record: str  # File and channel
    # 1 - |measured - predicted|²/|measured|² in the fitted band [-]; below 0: worse than nothing.
    explained: float
    is_held_back: bool  # Whether the model comes from other files


def check_records(
    found: Identified,
    *,
    force_per_unit: float | None,
    band_hz: tuple[float, float] | None,
    count: int | None,
) -> tuple[Checked, ...]:
    """Return how well each output of each record follows from its force.

    The last of several files is held back: a model of the others alone explains it once more.
    """
    evidence, scale = found.evidence, force_per_unit or 1.0
    checked = [
        one for record in evidence.records for one in _check(found, record, scale, is_apart=False)
    ]
    files = list(dict.fromkeys(record.source.file for record in evidence.records))
    if len(files) > 1:
        others = tuple(one for one in evidence.responses if one.source.file != files[-1])
        if others:
            less = replace(evidence, responses=others, spectra=(), vibrations=())
            apart = identify(less, band_hz=band_hz, count=count)
            checked += [
                one
                for record in evidence.records
                if record.source.file == files[-1]
                for one in _check(apart, record, scale, is_apart=True)
            ]
    return tuple(checked)


def _check(found: Identified, record: TimeRecord, scale: float, *, is_apart: bool) -> list[Checked]:
    force = next((one for one in record.channels if one.signal in FORCES), None)
    if force is None:
        return []
    factor = scale if force.signal is Signal.CURRENT else 1.0
    checked = []
    for channel in record.channels:
        for model, band in _models(channel, record, found):
            share = _explained(
                factor * force.values, channel.values, record.sample_time, model, band
            )
            checked.append(
                Checked(
                    record=f"{record.source.file} [{channel.name}]",
                    explained=share,
                    is_held_back=is_apart,
                )
            )
    return checked


def _models(
    channel: Channel, record: TimeRecord, found: Identified
) -> list[tuple[FittedResponse, tuple[float, float]]]:
    """The response from the same file, else the first one, that shows a channel, and its band."""
    fitting = [
        (one, fit.band_hz)
        for fit in found.fits
        for one in fit.responses
        if one.response.sensor is channel.sensor
        and one.response.output.value == channel.signal.value
    ]
    own = [pair for pair in fitting if pair[0].response.source.file == record.source.file]
    return (own or fitting)[:1]


def _explained(
    force: Array,
    measured: Array,
    step: float,
    model: FittedResponse,
    band_hz: tuple[float, float],
) -> float:
    size = force.size
    window = tukey(size, 2 * EDGE)
    f = np.asarray(np.fft.rfftfreq(size, step), dtype=np.float64)
    inside = (f >= band_hz[0]) & (f <= band_hz[1])
    # The force is not faded: what it did before the middle still rings there.
    spectrum = np.zeros(f.size, dtype=np.complex128)
    lines: NDArray[np.complex128] = np.fft.rfft(force - force.mean())[inside]
    spectrum[inside] = lines * model.model(f[inside])
    predicted = np.fft.irfft(spectrum, size) * window
    # A drifting position would leak into the band.
    flat = measured - np.polynomial.Polynomial.fit(np.arange(size), measured, 2)(np.arange(size))
    kept = np.where(inside, np.fft.rfft(flat), 0.0)
    seen = np.fft.irfft(kept, size) * window
    power = float(np.vdot(seen, seen))
    return 1.0 - float(np.sum((seen - predicted) ** 2)) / power if power > 0.0 else 0.0
