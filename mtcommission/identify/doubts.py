"""What a measurement leaves open, as advice for the next one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.identify.fit.fitted import Fitted
from mtcommission.identify.fit.lines import spacing_at
from mtcommission.identify.measurement import (
    FrequencyResponse,
    Sensor,
    Signal,
    TimeRecord,
)
from mtcommission.record.identified import IdentifiedPart

MASS_TOLERANCE = 0.05
"""Relative difference of two sensors' masses that is told."""
LEAST_REVERSED = 0.01
"""Share of the time in which an axis moves backwards, below which friction kept its sign."""
LARGEST_MODEL_ERROR = 0.05
"""Share of |H| that the model may miss without a word."""
MOST_INCOHERENT = 0.15
"""Share of the lines that may have a coherence below one half."""


def list_doubts(
    part: IdentifiedPart, fits: Sequence[Fitted], records: Sequence[TimeRecord]
) -> Iterator[Message]:
    """Yield what was chosen, left out, doubtful or unknown, as advice for the next measurement."""
    for fit in fits:
        yield from fit.notes
    for fit in fits:
        yield from _of_fit(fit)
        yield from _of_friction(fit, records)
    for mode in part.modes:
        lacking = [one.name for one in part.states if mode.name not in [m.name for m in one.modes]]
        if lacking:
            said = {"mode": mode.name, "states": ", ".join(lacking)}
            yield Message("identify-mode-not-everywhere", **said)
    masses = [state.moving_mass.value for state in part.states if state.moving_mass]
    if masses and max(masses) > (1.0 + MASS_TOLERANCE) * min(masses):
        yield Message("identify-mass-by-state", low=min(masses), high=max(masses))
    if not part.modes and (part.moving_mass or part.base_excited):
        yield Message("identify-no-mode")
    if part.moving_mass is None:
        yield Message(f"identify-no-{'force' if part.base_excited else 'rigid-body'}")
        return
    yield Message("identify-friction-small-amplitude")
    if not any(fit.has(Sensor.TCP) for fit in fits):
        yield Message("identify-no-tool-sensor", bound=1.0 / part.moving_mass.value)


def _of_fit(fit: Fitted) -> Iterator[Message]:
    """Sensors that disagree, lines too far apart, and what the model misses."""
    for one in fit.responses:
        if one.polarity < 0:
            yield Message("identify-polarity-reversed", file=one.response.source.name)
    masses = [(one.response.source.name, one.inverse_mass.value)
              for one in fit.responses if one.has_rigid_body]  # fmt: skip
    for name, inverse in masses[1:]:  # two sensors of one machine move the same mass
        if abs(masses[0][1] / inverse - 1.0) > MASS_TOLERANCE:
            both = {"mass": 1.0 / inverse, "other": 1.0 / masses[0][1]}
            yield Message("identify-masses-differ", file=name, **both)
    for mode in fit.modes:
        # A window smears what is narrower; 0.8 ζ f is half a half-power width, less a bit.
        f = mode.frequency_hz.value
        limit = 0.8 * mode.damping_ratio.value * f
        spacing = min(_resolution(one.response, f) for one in fit.responses)
        if spacing > limit:
            lines = {"frequency": f, "spacing": spacing, "wanted": limit, "window": 1.0 / limit}
            yield Message("identify-lines-too-far-apart", **lines)
    if fit.model_error > LARGEST_MODEL_ERROR:
        yield Message("identify-model-error", share=fit.model_error)
    for one in fit.responses:
        file, coherence = one.response.source.name, one.response.coherence
        if coherence is None:
            yield Message("identify-noise-from-misfit", file=file)
            continue
        share = float(np.mean(coherence[one.is_used] < 0.5))
        if share > MOST_INCOHERENT:
            yield Message("identify-low-coherence", file=file, share=share)


def _resolution(response: FrequencyResponse, frequency_hz: float) -> float:
    """Distance of lines about a frequency, or width of the window if that is more [Hz]."""
    return max(
        spacing_at(response.frequency_hz, frequency_hz), 0.25 * (response.resolution_hz or 0.0)
    )


def _of_friction(fit: Fitted, records: Sequence[TimeRecord]) -> Iterator[Message]:
    """How far friction that reverses may have shifted a mode, where that is beyond its interval.

    What friction takes shows as c, and as the low end that had to be cut. It need not act as a
    damper: all of it acting as a spring, m c ω or m ω_low², shifts ω by c/2 or ω_low²/(2 ω).
    """
    files = {one.response.source.file for one in fit.responses}
    swings = [swing for one in records if one.source.file in files for swing in _swings(one)]
    is_driven = fit.has(Sensor.ENCODER) and fit.responses[0].response.input is Signal.FORCE
    if not is_driven or not fit.modes or (swings and max(swings)[0] < LEAST_REVERSED):
        return
    low = fit.band_hz[0] if any(not one.is_used[0] for one in fit.responses) else 0.0
    drag = fit.drag.value / (2 * np.pi)
    shifts = [
        (0.5 * max(drag / f.value, (low / f.value) ** 2), f)
        for f in (mode.frequency_hz for mode in fit.modes)
    ]
    shift, f = max(shifts, key=lambda one: one[0] * one[1].value / max(one[1].sigma, 1e-12))
    if shift * f.value <= 2.0 * f.sigma:
        return
    file, values = ", ".join(sorted(files)), {"frequency": f.value, "shift": shift}
    values["interval"] = 2.0 * f.sigma / f.value
    if not swings:
        yield Message("identify-friction-may-shift", file=file, **values)
        return
    reversed_, offset, swing = max(swings)
    values |= {"reversed": reversed_, "offset": offset, "swing": swing, "wanted": 3.0 * swing}
    yield Message("identify-friction-shifts", file=file, **values)


def _swings(record: TimeRecord) -> Iterator[tuple[float, float, float]]:
    """Share of the time in which an encoder goes against its mean velocity, that mean, and rms."""
    for one in record.channels:
        if one.sensor is not Sensor.ENCODER or one.signal not in (Signal.VELOCITY, Signal.POSITION):
            continue
        v = one.values
        if one.signal is Signal.POSITION:
            v = np.diff(v) / record.sample_time
        mean = float(np.mean(v))
        share = float(np.mean(v * np.sign(mean) < 0.0)) if mean else 0.5
        yield share, abs(mean), float(np.std(v))
