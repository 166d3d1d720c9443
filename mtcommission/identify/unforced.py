"""Records without a force: what rings after a move or a step, else the power by frequency.

Decaying oscillations are fitted one after the other, each from the largest peak of what the others
leave; their number comes from the Bayesian information criterion, intervals from the Jacobian and
the correlation of the residuals; power by Welch's method.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt
from typing import Any

import numpy as np
from scipy.signal import decimate, welch

from mtcommission.base.messages.message import Message
from mtcommission.identify.averaged import HALF_POWER_BINS, HIGHEST_SHARE
from mtcommission.machine.identified import MeasuredMode
from mtcommission.measured.measurement import (
    AllDirections,
    Array,
    Channel,
    FreeVibration,
    Sensor,
    Signal,
    Spectrum,
    TimeRecord,
)
from mtcommission.measured.regression import (
    Damped,
    FreeMode,
    correlation_length,
    fit_damped,
    information_criterion,
)

MOST_SAMPLES = 1500
MOST_MODES = 6
LEAST_GAIN = 10.0
"""Fall of the information criterion for which a further mode is kept."""
BAND_SHARE = 0.99
"""Share of the energy of a signal's rate below the frequency up to which it is looked at."""
LARGEST_DAMPING = 0.3
FIRST_DAMPING = 0.02
"""Damping ratio at which a mode begins to be fitted."""
ENDS = (0.3, 3.0)
"""Factors on a starting frequency between which it is fitted."""
SMALLEST_AMPLITUDE = 0.02
"""Share of the largest amplitude below which a mode is left out."""
FEWEST_CYCLES = 2.0
LEAST_DECAY = 3.0
"""Factor by which what rings must fall from the first quarter of the record to the last."""
CALM = 0.3
"""Share of the vibration that may be there before it, if it is a free one."""
SIGNIFICANT = 4.0
"""Amplitude over its standard error."""
FEWEST = 64
"""Samples of a decay."""
KLIPPER_WINDOW, KLIPPER_KAISER = 0.5, 6.0
"""Least length of Klipper's window [s], rounded up to a power of two of samples, and its shape:
klippy/extras/shaper_calibrate.py at 84104bbb."""
WINDOW = 1.0
"""Length of the window [s], if the record has four of them: lines 1 Hz apart."""


def find_unforced(
    record: TimeRecord, motions: Sequence[Channel]
) -> tuple[FreeVibration | Spectrum, ...]:
    """Return what each motion says: a decay, or the spectrum of an acceleration.

    Of several accelerations, one sensor's directions, the one that shakes most.
    """
    vibrations, spectra = list[FreeVibration](), list[Spectrum]()
    for motion in motions:
        if ringing := _find_ringing(record, motion):
            vibrations.append(ringing)
        elif motion.signal is Signal.ACCELERATION:
            spectra.append(_find_power(record, motion))
    if len(spectra) > 1:
        loudest = max(spectra, key=lambda one: float(one.density.max()))
        whole = power_as_klipper(record) if record.source.is_klipper_raw else None
        spectra = [replace(loudest, all_directions=whole)]
    return (*vibrations, *spectra)


def _find_ringing(record: TimeRecord, motion: Channel) -> FreeVibration | None:
    reference = record.reference
    start = _find_start(reference, motion.values)
    rest = motion.values[start:]
    is_free = reference is not None or _begins(motion.values, start)
    if rest.size < FEWEST or not is_free or not _is_decay(rest):
        return None
    modes, said = _fit_ringing(rest, record.sample_time, start)
    if not modes:
        return None
    if reference is not None:
        said.append(Message("identify-loop-in-decay"))
    return FreeVibration(
        source=record.source_of(motion),
        sensor=motion.sensor or Sensor.ENCODER,
        rotary=bool(motion.rotary),
        modes=tuple(
            MeasuredMode(frequency_hz=one.frequency_hz, damping_ratio=one.damping_ratio)
            for one in sorted(modes, key=lambda one: one.frequency_hz.value)
        ),
        remarks=(*record.remarks, *said),
    )


def _find_start(reference: Array | None, values: Array) -> int:
    """The sample at which a signal is left to itself."""
    if reference is not None:
        steps = np.abs(np.diff(reference))
        if steps.max() > 0.0:
            moving = np.flatnonzero(steps > 1e-3 * steps.max())
            return int(moving[-1]) + 1
    width = _width(values)
    power = np.convolve(np.diff(values, n=2) ** 2, np.ones(width), "same")
    return min(int(np.argmax(power)) + width, values.size - 1)


def _width(values: Array) -> int:
    """Samples over which shaking is averaged."""
    return max(values.size // 100, 8)


def _begins(values: Array, start: int) -> bool:
    """Whether a signal was calm just before it is left to itself.

    What is driven through a resonance, by a sweep, swells before it fades.
    """
    shakes, width = np.diff(values, n=2), _width(values)
    before = shakes[max(start - 4 * width, 0) : max(start - 2 * width, 0)]
    if before.size < width:  # it rings from the first sample on
        return True
    return float(before.std()) < CALM * float(shakes[start - width : start + width].std())


def _is_decay(values: Array) -> bool:
    part = values.size // 4
    first, last = float(values[:part].std()), float(values[-part:].std())
    return first > LEAST_DECAY * last > 0.0


def _fit_ringing(values: Array, step: float, begin: int) -> tuple[list[FreeMode], list[Message]]:
    """The modes in a free vibration, and how much they explain."""
    told = {"start": begin * step}
    y, step = _thinned(values - values[-max(values.size // 10, 1) :].mean(), step)
    t = step * np.arange(y.size, dtype=np.float64)
    duration, total = float(t[-1]), float(((y - y.mean()) ** 2).sum())
    best, least = Damped(modes=(), errors=(), rest=y - y.mean()), np.inf
    for order in range(1, MOST_MODES + 1):
        if total == 0.0 or y.size <= 2 * (4 * order + 1):
            break
        known = [one.pole for one in best.modes]
        try:
            fit = fit_damped(t, y, [*known, _strongest(best.rest, step)], ends=ENDS)
        except (ValueError, np.linalg.LinAlgError):
            break
        cost = max(float(fit.rest @ fit.rest), 1e-24 * total)
        correlated = correlation_length(fit.rest)
        criterion = information_criterion(cost, y.size, 4 * order + 1, correlated)
        if criterion > least - LEAST_GAIN:
            break
        best, least = fit, criterion
    largest = max((mode.amplitude for mode in best.modes), default=0.0)
    modes = [
        mode
        for mode, error in zip(best.modes, best.errors, strict=True)
        if 0.0 < mode.damping_ratio.value < LARGEST_DAMPING
        and mode.amplitude > max(SIGNIFICANT * error, SMALLEST_AMPLITUDE * largest)
        and mode.frequency_hz.value * duration > FEWEST_CYCLES
    ]
    explained = 1.0 - float(best.rest @ best.rest) / total if best.modes else 0.0
    told |= {"duration": duration, "explained": explained}
    return modes, [Message("identify-by-decay", **told)]


def _thinned(values: Array, step: float) -> tuple[Array, float]:
    """The signal with no more samples than its band needs."""
    power = np.abs(np.fft.rfft(np.diff(values) * np.hanning(values.size - 1))) ** 2
    share = np.cumsum(power) / max(float(power.sum()), np.finfo(float).tiny)
    top = float(np.searchsorted(share, BAND_SHARE) + 1) / ((values.size - 1) * step)
    factor = max(int(1.0 / (step * 6.0 * top)), 1)
    while factor > 1:
        once = min(factor, 10)
        values = np.asarray(decimate(values, once, ftype="fir"), dtype=np.float64)
        step, factor = step * once, factor // once
    return values[:MOST_SAMPLES], step


def _strongest(rest: Array, step: float) -> complex:
    """A pole at the largest peak of a signal's spectrum, to start with [1/s]."""
    power = np.abs(np.fft.rfft(rest * np.hanning(2 * rest.size)[rest.size :])) ** 2
    place = max(int(np.argmax(power[2:])) + 2, 2)
    omega = 2.0 * np.pi * place / (rest.size * step)
    return omega * complex(-FIRST_DAMPING, sqrt(1.0 - FIRST_DAMPING**2))


def _find_power(record: TimeRecord, motion: Channel) -> Spectrum:
    step, values = record.sample_time, motion.values
    length = max(min(int(WINDOW / step), values.size // 4), 32)
    frequency, density = welch(values, 1.0 / step, nperseg=length, noverlap=length - length // 2)
    kept = (frequency <= HIGHEST_SHARE / step) & (np.arange(frequency.size) >= 2)
    return Spectrum(
        source=record.source_of(motion),
        frequency_hz=frequency[kept],
        density=density[kept],
        resolution_hz=HALF_POWER_BINS / (length * step),
        sensor=motion.sensor or Sensor.ENCODER,
        rotary=bool(motion.rotary),
        remarks=(*record.remarks, Message("identify-by-power")),
    )


def power_as_klipper(record: TimeRecord) -> AllDirections | None:
    """Return the power of all channels together, as Klipper does; None of too short a record."""
    length = 1 << int(KLIPPER_WINDOW / record.sample_time - 1).bit_length()
    if record.size <= length:
        return None
    window: Any = np.kaiser(length, KLIPPER_KAISER)
    rate = 1.0 / record.sample_time
    signals = np.array([channel.values for channel in record.channels])
    frequency, density = welch(signals, rate, window, nperseg=length, noverlap=length // 2)
    return AllDirections(frequency_hz=frequency, density=density.sum(axis=0), is_divided=False)
