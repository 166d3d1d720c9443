"""Measurements -> an axis: modes of all its states, spreads, the check of itself, what is in doubt.

All of it is what the record holds; what was fitted stands beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import Fault, InputError
from mtcommission.identify.calibrate_shaper import propose_shapers
from mtcommission.identify.check import check_record
from mtcommission.identify.doubts import list_doubts
from mtcommission.identify.fit.fitted import Fitted, FittedResponse, FittedSpectrum
from mtcommission.identify.matching import find_spread, match_modes, middle_of
from mtcommission.identify.measurement import Evidence, Input, Output, Source
from mtcommission.identify.states import State, find_states
from mtcommission.machine.identified import MeasuredFile, ShaperProposal
from mtcommission.messages.message import Message
from mtcommission.record.identified import (
    IdentifiedPart,
    MeasuredResponseEntry,
    RecordCheckEntry,
)

Array = NDArray[np.float64]

NOT_DESCRIBED = "identify-not-described"
"""Kind of the message of a fit that misses what was measured."""
SENSOR_ASSUMED = "identify-sensor-assumed"
"""Kind of the remark on a response of which nobody said where its sensor sits."""
OPPOSITE, SURE = -0.1, 4.0
"""Share of a mode, by that of the rigid body and by its standard error, that no motor's encoder
shows."""
POINTS = 300
"""Measured points of a response, and points of its curve, at most."""
NEAR = 0.5
"""Share of them that stands within some widths of the modes."""
DIGITS = 6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identified:
    """An axis as measured."""

    part: IdentifiedPart  # as record, page and JSON hold it
    fits: tuple[Fitted, ...]  # of the states that have responses
    files: dict[str, Source]  # by name, in their order

    @property
    def doubt(self) -> Message | None:
        """Why the model does not describe what was measured; None where it does."""
        return next((one for one in self.part.warnings if one.kind == NOT_DESCRIBED), None)


def identify(
    evidence: Evidence,
    *,
    created: str = "",
    force_per_unit: float | None = None,
    band_hz: tuple[float, float] | None = None,
    count: int | None = None,
) -> Identified:
    """Return the axis that measurements show.

    Raise InputError if a response has too few lines in the band.
    """
    states = find_states(evidence, band_hz=band_hz, count=count)
    measured = evidence.measurements
    fits = tuple(one.result for one in states if isinstance(one.result, Fitted))
    _require_collocated(fits)
    modes, entries = match_modes([state.entry for state in states])
    inputs = {one.response.input for fit in fits for one in fit.responses}
    bands, misfits = [fit.band_hz for fit in fits], [fit.misfit for fit in fits]
    rotary = any(one.rotary for one in measured)
    # Its smoothing is a length: it means nothing to an axis that turns.
    klipper = [one.all_directions for one in evidence.spectra if one.all_directions]
    proposals = [] if rotary else list(propose_shapers(klipper))
    part = IdentifiedPart(
        created=created,
        rotary=rotary,
        base_excited=not inputs or inputs == {Input.ACCELERATION},
        sources=[
            MeasuredFile(name=one.source.name, sensor=one.sensor.value, sha256=one.source.sha256)
            for one in measured
        ],
        formats={one.source.name: one.source.format for one in measured},
        band_hz=[min(low for low, _ in bands), max(high for _, high in bands)] if bands else None,
        moving_mass=middle_of([state.entry.moving_mass for state in states]),
        delay=middle_of([state.delay for state in states]),
        lag=middle_of([state.lag for state in states]),
        modes=modes,
        states=entries,
        spread=find_spread(entries, modes),
        misfit=float(np.sqrt(np.mean(np.square(misfits)))) if misfits else None,
        checks=_check(evidence, fits, force_per_unit or 1.0, band_hz, count),
        warnings=[],
        proposals=proposals,
        responses=[entry for state in states for entry in _responses(state)],
    )
    remarks = [message for one in measured for message in one.remarks]
    doubts = list_doubts(part, fits, evidence.records)
    warnings = [*dict.fromkeys((*remarks, *doubts)), *_of_klipper(proposals)]
    files = {one.source.file: one.source for one in measured}
    return Identified(part=replace(part, warnings=warnings), fits=fits, files=files)


def _require_collocated(fits: Sequence[Fitted]) -> None:
    """Refuse what was only assumed to be the motor's encoder where it shows no such response.

    Force and motion of one place: every mode takes power up there, so every share is positive.
    """
    faults = []
    for fit in fits:
        for place, one in enumerate(fit.responses):
            kinds = {remark.kind for remark in one.response.remarks}
            if not one.has_rigid_body or SENSOR_ASSUMED not in kinds:
                continue
            for mode in fit.modes:
                gain, f = mode.gains[place], mode.frequency_hz.value
                share, sigma = (x / one.inverse_mass.value for x in (gain.value, gain.sigma))
                if share < OPPOSITE and share < -SURE * sigma:
                    said = Message("identify-not-collocated", frequency=f, share=share)
                    faults.append(Fault(where=one.response.source.file, message=said))
    if faults:
        raise InputError(faults)


def _check(
    evidence: Evidence,
    fits: Sequence[Fitted],
    force_per_unit: float,
    band_hz: tuple[float, float] | None,
    count: int | None,
) -> list[RecordCheckEntry]:
    """How well each output of each record follows from its force.

    The last of several files is held back: a model of the others alone explains it once more.
    """
    if not evidence.records:
        return []
    checked = [
        one
        for record in evidence.records
        for one in check_record(record, fits, force_per_unit, is_held_back=False)
    ]
    files = list(dict.fromkeys(record.source.file for record in evidence.records))
    others = tuple(one for one in evidence.responses if one.source.file != files[-1])
    if len(files) > 1 and others:
        less = replace(evidence, responses=others, spectra=(), vibrations=())
        apart = [
            one.result
            for one in find_states(less, band_hz=band_hz, count=count)
            if isinstance(one.result, Fitted)
        ]
        for record in evidence.records:
            if record.source.file == files[-1]:
                checked += check_record(record, apart, force_per_unit, is_held_back=True)
    return checked


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


def _responses(state: State) -> list[MeasuredResponseEntry]:
    if isinstance(state.result, FittedSpectrum):
        return [_of_spectrum(state.result)]
    if not isinstance(state.result, Fitted):
        return []
    fit = state.result
    at = np.array([(m.frequency_hz.value, m.damping_ratio.value) for m in fit.modes])
    return [_of_response(one, at, fit.misfit) for one in fit.responses]


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
