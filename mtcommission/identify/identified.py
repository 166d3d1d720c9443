"""Measurements -> an axis: modes of all its states, spreads, the check of itself, what is in doubt.

All of it is what the record holds; what was fitted stands beside it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.calibrate_shaper import propose_shapers
from mtcommission.identify.check import check_records
from mtcommission.identify.doubts import list_doubts
from mtcommission.identify.fit.fitted import Fitted, FittedResponse, FittedSpectrum
from mtcommission.identify.matching import find_spread, match_modes, middle_of
from mtcommission.identify.measurement import (
    Array,
    Evidence,
    Signal,
    Source,
    Spectrum,
)
from mtcommission.identify.states import find_states, fit_states
from mtcommission.machine.identified import MeasuredFile, ShaperProposal
from mtcommission.record.identified import IdentifiedPart, MeasuredResponseEntry

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
    measured = evidence.findings
    fits = [one.result for one in states if isinstance(one.result, Fitted)]
    _require_collocated(fits)
    modes, entries = match_modes([state.entry for state in states])
    inputs = {one.response.input for fit in fits for one in fit.responses}
    bands, misfits = [fit.band_hz for fit in fits], [fit.misfit for fit in fits]
    rotary = any(one.rotary for one in measured)
    # Its smoothing is a length: it means nothing to an axis that turns.
    spectra = [one for one in measured if isinstance(one, Spectrum) and not rotary]
    proposals = list(propose_shapers([s.all_directions for s in spectra if s.all_directions]))
    fit_again = partial(fit_states, band_hz=band_hz, count=count)
    part = IdentifiedPart(
        created=created,
        rotary=rotary,
        base_excited=not inputs or inputs == {Signal.ACCELERATION},
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
        checks=check_records(evidence, fits, force_per_unit or 1.0, fit_again),
        warnings=[],
        proposals=proposals,
        responses=[entry for state in states for entry in _points(state.result)],
    )
    remarks = [message for one in measured for message in one.remarks]
    doubts = list_doubts(part, fits, evidence.records)
    warnings = [*dict.fromkeys((*remarks, *doubts)), *_of_klipper(proposals)]
    files = {one.source.file: one.source for one in measured}
    return Identified(part=replace(part, warnings=warnings), files=files)


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


# Points and curves to be drawn


def _points(result: object) -> Iterator[MeasuredResponseEntry]:
    if isinstance(result, FittedSpectrum):
        yield _of_spectrum(result)
    elif isinstance(result, Fitted):
        for one in result.responses:
            yield _of_response(one, result)


def _of_response(one: FittedResponse, fit: Fitted) -> MeasuredResponseEntry:
    f, response = one.lines.frequency_hz, one.response
    curve, chosen = _places(f, fit)
    fitted = one.model(curve)
    # Phases beside each other where noise would let them jump by a turn.
    phase = np.unwrap(np.angle(fitted))
    phase -= 2 * np.pi * np.round(float(np.median(phase)) / (2 * np.pi))
    near = np.interp(f[chosen], curve, phase)
    values, error = one.lines.values[chosen], one.lines.error[chosen]
    coherence = None
    if response.coherence is not None:
        coherence = np.interp(f[chosen], response.frequency_hz, response.coherence)
    length, force = ("rad", "N m") if response.rotary else ("m", "N")
    rate = {Signal.POSITION: "", Signal.VELOCITY: "/s", Signal.ACCELERATION: "/s²"}
    by = force if response.input is Signal.FORCE else f"{length}/s²"
    return MeasuredResponseEntry(
        name=response.source.name,
        unit=f"{length}{rate[response.output]} / ({by})",
        misfit=fit.misfit,
        frequency_hz=_rounded(f[chosen]),
        magnitude=_rounded(np.abs(values)),
        error=_rounded(error),
        phase_deg=_rounded(np.degrees(near + np.angle(values * np.exp(-1j * near)))),
        coherence=None if coherence is None else _rounded(coherence),
        missed=_rounded(np.abs(one.model(f[chosen]) - values) / (np.sqrt(2.0) * error)),
        curve_hz=_rounded(curve),
        curve_magnitude=_rounded(np.abs(fitted)),
        curve_phase_deg=_rounded(np.degrees(phase)),
    )


def _of_spectrum(one: FittedSpectrum) -> MeasuredResponseEntry:
    spectrum = one.spectrum
    f, density = spectrum.frequency_hz[one.is_used], spectrum.density[one.is_used]
    _, chosen = _places(f, one)
    floor = 1e-6 * float(density.max())
    hertz = _rounded(f[chosen])
    return MeasuredResponseEntry(
        name=spectrum.source.name,
        unit="",
        misfit=None,
        frequency_hz=hertz,
        magnitude=_rounded(np.maximum(density[chosen], floor)),
        error=None,
        phase_deg=None,
        coherence=None,
        missed=None,
        curve_hz=hertz,
        curve_magnitude=_rounded(np.maximum(one.density[chosen], floor)),
        curve_phase_deg=None,
    )


def _places(lines_hz: Array, found: Fitted | FittedSpectrum) -> tuple[Array, NDArray[np.intp]]:
    """Frequencies that show every peak [Hz], and which lines stand nearest to them, each once.

    Even by octaves, and denser about the modes.
    """
    even = np.geomspace(lines_hz[0], lines_hz[-1], 8 * POINTS)
    density = np.full(even.size, (1.0 - NEAR) / even.size)
    for mode in found.modes:
        f, zeta = mode.frequency_hz.value, mode.damping_ratio.value
        about = 1.0 / (1.0 + (np.log(even / f) / max(zeta, 1e-4)) ** 2)
        density += NEAR * about / (about.sum() * len(found.modes))
    share = np.cumsum(density)
    share = (share - share[0]) / (share[-1] - share[0])
    wanted: Array = np.interp(np.linspace(0.0, 1.0, POINTS), share, even)
    if lines_hz.size <= POINTS:
        return wanted, np.arange(lines_hz.size)
    middles = 0.5 * (lines_hz[1:] + lines_hz[:-1])
    return wanted, np.unique(np.searchsorted(middles, wanted))


def _rounded(values: Array) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values.tolist()]
