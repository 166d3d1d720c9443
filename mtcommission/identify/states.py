"""Measurements -> states of the machine: which of them belong together, and what each shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.identify.fit.fit import fit_state
from mtcommission.identify.fit.fitted import Fitted, FittedMode, FittedSpectrum
from mtcommission.identify.measurement import (
    Evidence,
    FreeVibration,
    FrequencyResponse,
    Sensor,
    Signal,
    Source,
    Spectrum,
)
from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.record.identified import MeasuredStateEntry

SAME = 3.0
"""Responses whose poles differ by less, in standard errors, are of one state."""
OUTLIER = 3.0
"""Model error of a point in the typical one beyond which it is left out."""
LARGEST_ERROR = 0.3
"""Model error that a point may have in any case [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """What was found in one state of the machine."""

    entry: MeasuredStateEntry  # its modes by frequency, without names yet
    result: Fitted | FittedSpectrum | FreeVibration  # where they come from
    # delay, lag: None without phase; no lag where none shows.
    delay: Estimate | None = None
    lag: Estimate | None = None


def find_states(
    evidence: Evidence, *, band_hz: tuple[float, float] | None = None, count: int | None = None
) -> list[State]:
    """Return what measurements show, state by state.

    Raise InputError if a response has too few lines in the band.
    """
    fits = fit_states(evidence.responses, band_hz=band_hz, count=count)
    spectra = [one for one in evidence.findings if isinstance(one, Spectrum)]
    vibrations = [one for one in evidence.findings if isinstance(one, FreeVibration)]
    return [*map(_of_fit, fits), *_of_spectra(spectra), *map(_of_vibration, vibrations)]


def fit_states(
    responses: Sequence[FrequencyResponse],
    *,
    band_hz: tuple[float, float] | None = None,
    count: int | None = None,
) -> list[Fitted]:
    """Return a fit for each state of the machine that the responses show.

    Files that name their state belong to it. Of the others, one file is one state; the n-th
    encoder file and the n-th tool file are one; files of one kind of sensor whose fits agree in
    all poles are one, and so are the points of a hammer test.
    """
    groups = _group(responses)
    fits = [fit_state(group, band_hz=band_hz, count=count) for group in groups]
    if len(groups) < 2 or all(group[0].source.state for group in groups):
        return fits
    is_hammer = not any(one.has_rigid_body for fit in fits for one in fit.responses)
    if not is_hammer and not all(_agree(*pair) for pair in combinations(fits, 2)):
        return fits
    failed = _failed(fits) if is_hammer else []
    kept = [group for group, fit in zip(groups, fits, strict=True) if fit not in failed]
    whole = fit_state([one for group in kept for one in group], band_hz=band_hz, count=count)
    if not is_hammer and len(whole.modes) < max(len(fit.modes) for fit in fits):
        return fits
    out = [one.response.source.name for fit in failed for one in fit.responses]
    notes = [Message("identify-point-left-out", file=name) for name in out]
    return [replace(whole, notes=(*whole.notes, *notes))]


def _failed(fits: Sequence[Fitted]) -> list[Fitted]:
    """Points of a hammer test that alone obey no model while most do."""
    errors = [fit.model_error if fit.modes else 1.0 for fit in fits]
    most = max(OUTLIER * float(np.median(errors)), LARGEST_ERROR)
    far = [fit for fit, error in zip(fits, errors, strict=True) if error > most]
    return far if len(fits) > 2 else []


def _group(responses: Sequence[FrequencyResponse]) -> list[list[FrequencyResponse]]:
    """By state or file; the n-th of encoders with the n-th of tools where there are as many."""
    by_state: dict[str, list[FrequencyResponse]] = {}
    for one in responses:
        by_state.setdefault(one.source.state or f"file {one.source.file}", []).append(one)
    groups = list(by_state.values())
    encoders, tools = (
        [group for group in groups if {one.sensor for one in group} == {sensor}]
        for sensor in (Sensor.ENCODER, Sensor.TCP)
    )
    if len(encoders) != len(tools) or len(encoders) + len(tools) != len(groups):
        return groups
    return [[*a, *b] for a, b in zip(encoders, tools, strict=True)]


def _agree(one: Fitted, other: Fitted) -> bool:
    """Whether two fits show the same poles within their errors."""
    return len(one.modes) == len(other.modes) and all(
        abs(x.value - y.value) <= SAME * float(np.hypot(x.sigma, y.sigma))
        for a, b in zip(one.modes, other.modes, strict=True)
        for x, y in ((a.frequency_hz, b.frequency_hz), (a.damping_ratio, b.damping_ratio))
    )


def _of_fit(fit: Fitted) -> State:
    files = dict.fromkeys(one.response.source.file for one in fit.responses)
    responses = sorted(fit.responses, key=lambda one: one.response.sensor is Sensor.TCP)
    masses = [
        Estimate(value=1 / b.value, sigma=b.sigma / b.value**2)
        for b in (one.inverse_mass for one in responses if one.has_rigid_body)
    ]
    modes = [
        MeasuredMode(
            frequency_hz=mode.frequency_hz,
            damping_ratio=mode.damping_ratio,
            measured_gain=_gain(fit, mode, Sensor.ENCODER),
            tcp_gain=_gain(fit, mode, Sensor.TCP),
        )
        for mode in fit.modes
    ]
    name = fit.responses[0].response.source.state or ", ".join(files)
    entry = MeasuredStateEntry(name=name, moving_mass=masses[0] if masses else None, modes=modes)
    return State(entry=entry, result=fit, delay=responses[0].delay, lag=responses[0].lag)


def _gain(fit: Fitted, mode: FittedMode, sensor: Sensor) -> Estimate | None:
    """The surest gain of a sensor; base-excited, with the sign of the profile."""
    found = [
        replace(gain, value=-gain.value) if one.response.input is Signal.ACCELERATION else gain
        for one, gain in zip(fit.responses, mode.gains, strict=True)
        if one.response.sensor is sensor
    ]
    return min(found, key=lambda gain: gain.relative, default=None)


def _of_spectra(spectra: Sequence[Spectrum]) -> list[State]:
    """Of the directions in one file, the one with the most power: that was shaken."""
    if not spectra:
        return []
    from mtcommission.identify.fit.peaks import fit_spectrum  # slow to load

    best: dict[str, FittedSpectrum] = {}
    for one in map(fit_spectrum, spectra):
        other = best.get(one.spectrum.source.file)
        if one.modes and (other is None or one.power > other.power):
            best[one.spectrum.source.file] = one
    return [_without_mass(one.spectrum.source, one.modes, one) for one in best.values()]


def _of_vibration(one: FreeVibration) -> State:
    modes = [
        MeasuredMode(frequency_hz=mode.frequency_hz, damping_ratio=mode.damping_ratio)
        for mode in sorted(one.modes, key=lambda mode: mode.frequency_hz.value)
    ]
    return _without_mass(one.source, modes, one)


def _without_mass(
    source: Source, modes: Sequence[MeasuredMode], result: FittedSpectrum | FreeVibration
) -> State:
    name = source.state or source.name
    entry = MeasuredStateEntry(name=name, moving_mass=None, modes=list(modes))
    return State(entry=entry, result=result)
