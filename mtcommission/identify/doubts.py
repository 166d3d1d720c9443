"""What a measurement leaves open, as advice for the next one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mtcommission.identify.fit.fitted import Fitted
from mtcommission.identify.measurement import (
    FrequencyResponse,
    Input,
    Sensor,
    Signal,
    TimeRecord,
)
from mtcommission.messages.message import Message, Value
from mtcommission.record.identified import IdentifiedPart

MASS_TOLERANCE = 0.05
"""Relative difference of two sensors' masses that is told."""
LEAST_REVERSED = 0.01
"""Share of the time in which an axis moves backwards, below which friction kept its sign."""


def list_doubts(
    part: IdentifiedPart, fits: Sequence[Fitted], records: Sequence[TimeRecord]
) -> list[Message]:
    """Return what was chosen, left out, doubtful or unknown, as advice for the next measurement."""
    doubts = [note for fit in fits for note in fit.notes]
    for fit in fits:
        doubts += _of_polarity(fit) + _of_masses(fit) + _of_resolution(fit) + _of_misfit(fit)
        doubts += _of_friction(fit, records)
    for mode in part.modes:
        lacking = [
            one.name for one in part.states if mode.name not in [seen.name for seen in one.modes]
        ]
        if lacking:
            said = {"mode": mode.name, "states": ", ".join(lacking)}
            doubts.append(Message("identify-mode-not-everywhere", **said))
    masses = [state.moving_mass.value for state in part.states if state.moving_mass]
    if masses and max(masses) > (1.0 + MASS_TOLERANCE) * min(masses):
        doubts.append(Message("identify-mass-by-state", low=min(masses), high=max(masses)))
    if not part.modes and (part.moving_mass or part.base_excited):
        doubts.append(Message("identify-no-mode"))
    if part.moving_mass is None:
        doubts.append(Message(f"identify-no-{'force' if part.base_excited else 'rigid-body'}"))
    else:
        doubts.append(Message("identify-friction-small-amplitude"))
        if not any(fit.has(Sensor.TCP) for fit in fits):
            doubts.append(Message("identify-no-tool-sensor", bound=1.0 / part.moving_mass.value))
    return doubts


def _of_friction(fit: Fitted, records: Sequence[TimeRecord]) -> list[Message]:
    """How far friction that reverses may have shifted a mode, where that is beyond its interval.

    What friction takes shows as c, and as the low end that had to be cut. It need not act as a
    damper: all of it acting as a spring, m c ω or m ω_low², shifts ω by c/2 or ω_low²/(2 ω).
    """
    files = {one.response.source.file for one in fit.responses}
    swings = [swing for one in records if one.source.file in files for swing in _swings(one)]
    is_driven = fit.has(Sensor.ENCODER) and fit.responses[0].response.input is Input.FORCE
    if not is_driven or not fit.modes or (swings and max(s[0] for s in swings) < LEAST_REVERSED):
        return []
    is_cut = any(not one.is_used[0] for one in fit.responses)
    low = fit.band_hz[0] if is_cut else 0.0
    drag = fit.drag.value / (2 * np.pi)
    shifts = [
        (0.5 * max(drag / f.value, (low / f.value) ** 2), f)
        for f in (mode.frequency_hz for mode in fit.modes)
    ]
    shift, f = max(shifts, key=lambda one: one[0] * one[1].value / max(one[1].sigma, 1e-12))
    if shift * f.value <= 2.0 * f.sigma:
        return []
    values: dict[str, Value] = {
        "file": ", ".join(sorted(files)), "frequency": f.value, "shift": shift,
        "interval": 2.0 * f.sigma / f.value,
    }  # fmt: skip
    if not swings:
        return [Message("identify-friction-may-shift", **values)]
    reversed_, offset, swing = max(swings)
    return [
        Message(
            "identify-friction-shifts",
            **values,
            reversed=reversed_,
            offset=offset,
            swing=swing,
            wanted=3.0 * swing,
        )
    ]


def _swings(record: TimeRecord) -> list[tuple[float, float, float]]:
    """Share of the time in which an encoder goes against its mean velocity, that mean, and rms."""
    found = []
    for one in record.channels:
        if one.sensor is not Sensor.ENCODER or one.signal not in (Signal.VELOCITY, Signal.POSITION):
            continue
        v = one.values
        if one.signal is Signal.POSITION:
            v = np.diff(v) / record.sample_time
        mean = float(np.mean(v))
        share = float(np.mean(v * np.sign(mean) < 0.0)) if mean else 0.5
        found.append((share, abs(mean), float(np.std(v))))
    return found


def _of_polarity(fit: Fitted) -> list[Message]:
    return [
        Message("identify-polarity-reversed", file=one.response.source.name)
        for one in fit.responses
        if one.polarity < 0
    ]


def _of_masses(fit: Fitted) -> list[Message]:
    """Two sensors of one machine move the same mass."""
    masses = [
        (one.response.source.name, 1.0 / one.inverse_mass.value)
        for one in fit.responses
        if one.has_rigid_body
    ]
    return [
        Message("identify-masses-differ", file=name, mass=mass, other=masses[0][1])
        for name, mass in masses[1:]
        if abs(mass / masses[0][1] - 1.0) > MASS_TOLERANCE
    ]


def _of_resolution(fit: Fitted) -> list[Message]:
    """Trap 1: a window smears what is narrower; 0.8 ζ f is half a half-power width, less a bit."""
    doubts = []
    for mode in fit.modes:
        limit = 0.8 * mode.damping_ratio.value * mode.frequency_hz.value
        steps = [_spacing(one.response, mode.frequency_hz.value) for one in fit.responses]
        if min(steps) > limit:
            doubts.append(
                Message(
                    "identify-lines-too-far-apart",
                    frequency=mode.frequency_hz.value,
                    spacing=min(steps),
                    wanted=limit,
                    window=1.0 / limit,
                )
            )
    return doubts


def _spacing(response: FrequencyResponse, frequency_hz: float) -> float:
    """Distance of lines about a frequency, or width of the window if that is more [Hz]."""
    f = response.frequency_hz
    at = int(np.clip(np.searchsorted(f, frequency_hz), 1, f.size - 1))
    lobe = response.resolution_hz or 0.0
    return max(float(f[at] - f[at - 1]), 0.25 * lobe)


def _of_misfit(fit: Fitted) -> list[Message]:
    doubts = []
    if fit.model_error > 0.05:
        doubts.append(Message("identify-model-error", share=fit.model_error))
    for one in fit.responses:
        coherence = one.response.coherence
        if coherence is None:
            doubts.append(Message("identify-noise-from-misfit", file=one.response.source.name))
            continue
        share = float(np.mean(coherence[one.is_used] < 0.5))
        if share > 0.15:
            doubts.append(
                Message("identify-low-coherence", file=one.response.source.name, share=share)
            )
    return doubts
