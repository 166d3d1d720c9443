"""The identified model against the time records that it comes from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit.fitted import Fitted, FittedResponse
from mtcommission.identify.measurement import (
    FORCES,
    Array,
    Channel,
    Evidence,
    FrequencyResponse,
    Signal,
    TimeRecord,
)
from mtcommission.record.identified import RecordCheckEntry

EDGE = 0.1
"""Share of a record that is faded in and out: what went before it is not known."""

Fit = Callable[[Sequence[FrequencyResponse]], Sequence[Fitted]]


def check_records(
    evidence: Evidence, fits: Sequence[Fitted], force_per_unit: float, fit: Fit
) -> list[RecordCheckEntry]:
    """Return how well each output of each record follows from its force.

    The last of several files is held back: a model of the others alone explains it once more.
    """
    records = evidence.records
    check = partial(_check, force_per_unit=force_per_unit)
    checked = [one for record in records for one in check(record, fits, held_back=False)]
    files = list(dict.fromkeys(record.source.file for record in records))
    last = [record for record in records if record.source.file == files[-1]]
    others = [one for one in evidence.responses if one.source.file not in files[-1:]]
    if len(files) > 1 and others:
        apart = fit(others)
        checked += [one for record in last for one in check(record, apart, held_back=True)]
    return checked


def _check(
    record: TimeRecord, fits: Sequence[Fitted], *, force_per_unit: float, held_back: bool
) -> Iterator[RecordCheckEntry]:
    force = next((one for one in record.channels if one.signal in FORCES), None)
    for channel in record.channels if force else ():
        if force and (found := _model_of(channel, record, fits)):
            scale = force_per_unit if force.signal is Signal.CURRENT else 1.0
            yield RecordCheckEntry(
                record=f"{record.source.file} [{channel.name}]",
                explained=_explained(record, scale * force.values, channel.values, *found),
                held_back=held_back,
            )


def _model_of(
    channel: Channel, record: TimeRecord, fits: Sequence[Fitted]
) -> tuple[FittedResponse, tuple[float, float]] | None:
    """The response from the same file, else the first one, that shows a channel, and its band."""
    fitting = [
        (one, fit.band_hz)
        for fit in fits
        for one in fit.responses
        if one.response.sensor is channel.sensor and one.response.output is channel.signal
    ]
    own = [pair for pair in fitting if pair[0].response.source.file == record.source.file]
    return next(iter(own or fitting), None)


def _explained(
    record: TimeRecord,
    force: Array,
    measured: Array,
    model: FittedResponse,
    band_hz: tuple[float, float],
) -> float:
    size, step = record.size, record.sample_time
    place = np.arange(size) / (size - 1)
    # Tukey's window.
    window = 0.5 - 0.5 * np.cos(np.pi * np.minimum(np.minimum(place, 1.0 - place) / EDGE, 1.0))
    f = np.asarray(np.fft.rfftfreq(size, step), dtype=np.float64)
    inside = (f >= band_hz[0]) & (f <= band_hz[1])
    # The force is not faded: what it did before the middle still rings there.
    spectrum = np.zeros(f.size, dtype=np.complex128)
    lines: NDArray[np.complex128] = np.fft.rfft(force - force.mean())[inside]
    spectrum[inside] = lines * model.model(f[inside])
    predicted = np.fft.irfft(spectrum, size) * window
    # A drifting position would leak into the band.
    flat = measured - np.polynomial.Polynomial.fit(np.arange(size), measured, 2)(np.arange(size))
    seen = np.fft.irfft(np.where(inside, np.fft.rfft(flat), 0.0), size) * window
    power = float(np.vdot(seen, seen))
    return 1.0 - float(np.sum((seen - predicted) ** 2)) / power if power > 0.0 else 0.0
