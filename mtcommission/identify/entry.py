"""What was identified -> JSON of ``identify``, which the sheet and the page print."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.calibrate_shaper import judged_by_klipper, propose_shapers
from mtcommission.identify.check import Checked
from mtcommission.identify.fit.fitted import Fitted, FittedResponse
from mtcommission.identify.fit.peaks import FittedSpectrum
from mtcommission.identify.identified import Identified
from mtcommission.identify.measurement import Input, Output
from mtcommission.machine.identified import MeasuredFile, MeasuredMode, ShaperProposal
from mtcommission.messages.message import Message
from mtcommission.record.identified import (
    IdentifiedPart,
    MeasuredResponseEntry,
    MeasuredStateEntry,
    RecordCheckEntry,
    SpreadEntry,
)
from mtcommission.record.shape import entry_of, to_plain

Array = NDArray[np.float64]

POINTS = 300
"""Measured points of a response, and points of its curve, at most."""
NEAR = 0.5
"""Share of them that stands within some widths of the modes."""
DIGITS = 6


def identified_part(
    found: Identified, *, checks: Sequence[Checked], created: str
) -> IdentifiedPart:
    """Return all about an identified axis, with its measured points and fitted curves."""
    bands = [fit.band_hz for fit in found.fits]
    misfits = [fit.misfit for fit in found.fits]
    # Its smoothing is a length: it means nothing to an axis that turns.
    proposals = () if found.rotary else propose_shapers(judged_by_klipper(found.evidence))
    return IdentifiedPart(
        created=created,
        rotary=found.rotary,
        base_excited=found.is_base_excited,
        sources=[
            MeasuredFile(name=one.source.name, sensor=one.sensor.value, sha256=one.source.sha256)
            for one in found.measurements
        ],
        formats={one.source.name: one.source.format for one in found.measurements},
        band_hz=[min(b[0] for b in bands), max(b[1] for b in bands)] if bands else None,
        moving_mass=found.moving_mass,
        delay=found.delay,
        lag=found.lag,
        modes=[entry_of(MeasuredMode, mode) for mode in found.modes],
        states=[
            MeasuredStateEntry(
                name=state.name,
                moving_mass=state.moving_mass,
                modes=[
                    replace(state.modes[k], name=mode.name)
                    for mode in found.modes
                    if (k := mode.seen[place]) is not None
                ],
            )
            for place, state in enumerate(found.states)
        ],
        spread=entry_of(SpreadEntry, found.spread),
        misfit=float(np.sqrt(np.mean(np.square(misfits)))) if misfits else None,
        checks=[
            RecordCheckEntry(record=one.record, explained=one.explained, held_back=one.is_held_back)
            for one in checks
        ],
        warnings=[*found.warnings, *_of_klipper(proposals)],
        proposals=list(proposals),
        responses=_responses(found),
    )


def _of_klipper(proposals: Sequence[ShaperProposal]) -> list[Message]:
    """What Klipper would choose, and for which axes its shapers are."""
    chosen = [
        Message(
            "identify-klipper-choice",
            shaper=one.shaper.upper(),
            frequency=one.frequency_hz,
            acceleration=1e3 * one.max_acceleration,
            vibration=one.vibration,
        )
        for one in proposals
        if one.is_recommended
    ]
    return [*chosen, Message("identify-core-xy")] if chosen else []


def identified_json(part: IdentifiedPart, *, profile: str) -> dict[str, Any]:
    """Return the JSON of ``identify``: a part, its files by name, and the profile's text."""
    return {
        "files": list(dict.fromkeys(one.name.partition(" [")[0] for one in part.sources)),
        "sensor": {one.name: one.sensor for one in part.sources},
        **to_plain(part),
        "profile": profile,
    }


def _responses(found: Identified) -> list[MeasuredResponseEntry]:
    entries = []
    for state in found.states:
        if isinstance(state.result, Fitted):
            fit = state.result
            at = np.array([(m.frequency_hz.value, m.damping_ratio.value) for m in fit.modes])
            entries += [_of_response(one, at, fit.misfit) for one in fit.responses]
        elif isinstance(state.result, FittedSpectrum):
            entries.append(_of_spectrum(state.result))
    return entries


def _of_response(one: FittedResponse, modes: Array, misfit: float) -> MeasuredResponseEntry:
    f = one.lines.frequency_hz
    curve = _places(f[0], f[-1], modes)
    chosen = _nearest(f, curve)
    fitted = one.model(curve)
    # Phases beside each other where noise would let them jump by a turn.
    phase = np.unwrap(np.angle(fitted))
    phase -= 2 * np.pi * np.round(float(np.median(phase)) / (2 * np.pi))
    near = np.interp(f[chosen], curve, phase)
    values = one.lines.values[chosen]
    measured = near + np.angle(values * np.exp(-1j * near))
    missed = np.abs(one.model(f[chosen]) - values) / (np.sqrt(2.0) * one.lines.error[chosen])
    response = one.response
    coherence = None
    if response.coherence is not None:
        coherence = np.interp(f[chosen], response.frequency_hz, response.coherence)
    return MeasuredResponseEntry(
        name=response.source.name,
        unit=_unit_of(one),
        misfit=misfit,
        frequency_hz=_rounded(f[chosen]),
        magnitude=_rounded(np.abs(values)),
        error=_rounded(one.lines.error[chosen]),
        phase_deg=_rounded(np.degrees(measured)),
        coherence=None if coherence is None else _rounded(coherence),
        missed=_rounded(missed),
        curve_hz=_rounded(curve),
        curve_magnitude=_rounded(np.abs(fitted)),
        curve_phase_deg=_rounded(np.degrees(phase)),
    )


def _of_spectrum(one: FittedSpectrum) -> MeasuredResponseEntry:
    spectrum = one.spectrum
    f, density = spectrum.frequency_hz[one.is_used], spectrum.density[one.is_used]
    at = np.array([(m.frequency_hz.value, m.damping_ratio.value) for m in one.modes])
    chosen = _nearest(f, _places(f[0], f[-1], at)) if f.size else np.zeros(0, dtype=np.intp)
    floor = 1e-6 * float(density.max(initial=0.0))
    return MeasuredResponseEntry(
        name=spectrum.source.name,
        unit="",
        misfit=None,
        frequency_hz=_rounded(f[chosen]),
        magnitude=_rounded(np.maximum(density[chosen], floor)),
        error=None,
        phase_deg=None,
        coherence=None,
        missed=None,
        curve_hz=_rounded(f[chosen]),
        curve_magnitude=_rounded(np.maximum(one.density[chosen], floor)),
        curve_phase_deg=None,
    )


def _places(low: float, high: float, modes: Array) -> Array:
    """Frequencies that show every peak: even by octaves, and denser about the modes [Hz]."""
    even = np.geomspace(low, high, 8 * POINTS)
    density = np.full(even.size, (1.0 - NEAR) / even.size)
    for f, zeta in modes.reshape(-1, 2).tolist():
        about = 1.0 / (1.0 + (np.log(even / f) / max(zeta, 1e-4)) ** 2)
        density += NEAR * about / (about.sum() * len(modes))
    share = np.cumsum(density)
    share = (share - share[0]) / (share[-1] - share[0])
    found: Array = np.interp(np.linspace(0.0, 1.0, POINTS), share, even)
    return found


def _nearest(frequency_hz: Array, wanted: Array) -> NDArray[np.intp]:
    """Which lines stand nearest to some frequencies, each once."""
    if frequency_hz.size <= POINTS:
        return np.arange(frequency_hz.size)
    middles = 0.5 * (frequency_hz[1:] + frequency_hz[:-1])
    return np.unique(np.searchsorted(middles, wanted))


def _rounded(values: Array) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values.tolist()]


def _unit_of(one: FittedResponse) -> str:
    length, force = ("rad", "N m") if one.response.rotary else ("m", "N")
    rate = {Output.POSITION: "", Output.VELOCITY: "/s", Output.ACCELERATION: "/s²"}
    if one.response.input is Input.ACCELERATION:
        return f"{length}{rate[one.response.output]} / ({length}/s²)"
    return f"{length}{rate[one.response.output]} / ({force})"
