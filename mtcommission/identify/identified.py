"""Measurements -> an axis: modes of all its states, spreads, the check of itself, what is in doubt.

All of it is what the record holds; what was fitted stands beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.calibrate_shaper import propose_shapers
from mtcommission.identify.fit import Fitted, FittedResponse, FittedSpectrum
from mtcommission.identify.projection import spacing_at
from mtcommission.identify.states import (
    State,
    describe_state,
    find_spread,
    find_states,
    fit_states,
    match_modes,
    middle_of,
)
from mtcommission.machine.identified import MeasuredFile, ShaperProposal
from mtcommission.measured.measurement import (
    Array,
    Channel,
    Evidence,
    FrequencyResponse,
    Sensor,
    Signal,
    Source,
    Spectrum,
    TimeRecord,
)
from mtcommission.record.identified import IdentifiedPart, MeasuredResponseEntry, RecordCheckEntry
from mtcommission.record.shape import dump_json, to_plain

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
    profile: str = ""  # TOML; lacks what no response tells; "" where no model describes the files

    @property
    def json(self) -> str:
        """Points, fit and advice, which the profile names as its evidence."""
        entry: dict[str, Any] = {
            "files": list(self.files),
            "sensor": {one.name: one.sensor for one in self.part.sources},
            **to_plain(self.part),
            "profile": self.profile,
        }
        return dump_json(entry)

    @property
    def doubt(self) -> Message | None:
        """Why the model does not describe what was measured; None where it does."""
        return next((one for one in self.part.warnings if one.kind == NOT_DESCRIBED), None)


def identify(
    evidence: Evidence,
    *,
    created: str = "",
    band_hz: tuple[float, float] | None = None,
    count: int | None = None,
) -> Identified:
    """Return the axis that measurements show.

    Raise InputError if a response has too few lines in the band.
    """
    states = find_states(evidence, band_hz=band_hz, count=count)
    measured = evidence.findings
    fits = [one for one in states if isinstance(one, Fitted)]
    _require_collocated(fits)
    modes, entries = match_modes(list(map(describe_state, states)))
    inputs = {one.response.input for fit in fits for one in fit.responses}
    bands, misfits = [fit.band_hz for fit in fits], [fit.misfit for fit in fits]
    rotary = any(one.rotary for one in measured)
    # Its smoothing is a length: it means nothing to an axis that turns.
    spectra = [one for one in measured if isinstance(one, Spectrum) and not rotary]
    proposals = list(propose_shapers([s.all_directions for s in spectra if s.all_directions]))

    def fit_again(others: Sequence[FrequencyResponse]) -> Sequence[Fitted]:
        return fit_states(others, band_hz=band_hz, count=count)

    part = IdentifiedPart(
        created=created,
        rotary=rotary,
        base_excited=not inputs or inputs == {Signal.ACCELERATION},
        sources=[
            MeasuredFile(name=one.source.name, sensor=one.sensor.value, sha256=one.source.sha256)
            for one in measured
        ],
        band_hz=[min(low for low, _ in bands), max(high for _, high in bands)] if bands else None,
        moving_mass=middle_of([fit.moving_mass for fit in fits]),
        delay=middle_of([fit.leading.delay for fit in fits]),
        lag=middle_of([fit.leading.lag for fit in fits]),
        modes=modes,
        states=entries,
        spread=find_spread(entries, modes),
        misfit=float(np.sqrt(np.mean(np.square(misfits)))) if misfits else None,
        checks=_check_records(evidence, fits, fit_again),
        warnings=[],
        proposals=proposals,
        responses=[entry for state in states for entry in _points(state)],
    )
    remarks = [message for one in measured for message in one.remarks]
    doubts = _list_doubts(part, fits, evidence.records)
    warnings = [*dict.fromkeys((*remarks, *doubts)), *_of_klipper(proposals)]
    files = {one.source.file: one.source for one in measured}
    return Identified(part=replace(part, warnings=warnings), files=files)


def _require_collocated(fits: Sequence[Fitted]) -> None:
    """Refuse what was only assumed to be the motor's encoder where it shows no such response.

    Force and motion of one place: every mode takes power up there, so every share is positive.
    """
    faults = []
    for fit in fits:
        for one in fit.responses:
            kinds = {remark.kind for remark in one.response.remarks}
            if not one.has_rigid_body or SENSOR_ASSUMED not in kinds:
                continue
            for mode, gain in zip(fit.modes, one.residues, strict=True):
                f = mode.frequency_hz.value
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


def _points(result: State) -> Iterator[MeasuredResponseEntry]:
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
    rates = {Signal.POSITION: "", Signal.VELOCITY: "/s", Signal.ACCELERATION: "/s²"}
    rate = f"{length}{rates[response.output]}"
    by = force if response.input is Signal.FORCE else f"{length}/s²"
    shown, over = (f"({one})" if set(one) & set("/ ") else one for one in (rate, by))
    return MeasuredResponseEntry(
        name=response.source.name,
        unit=f"{shown}/{over}",
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
        curve_hz=hertz,
        curve_magnitude=_rounded(np.maximum(one.density[chosen], floor)),
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


EDGE = 0.1
"""Share of a record that is faded in and out: what went before it is not known."""


def _check_records(
    evidence: Evidence,
    fits: Sequence[Fitted],
    fit: Callable[[Sequence[FrequencyResponse]], Sequence[Fitted]],
) -> list[RecordCheckEntry]:
    """How well each output of each record follows from its force.

    The last of several files is held back: a model of the others alone explains it once more.
    """
    records = evidence.records
    checked = [one for record in records for one in _check(record, fits, held_back=False)]
    files = list(dict.fromkeys(record.source.file for record in records))
    last = [record for record in records if record.source.file == files[-1]]
    others = [one for one in evidence.responses if one.source.file not in files[-1:]]
    if len(files) > 1 and others:
        apart = fit(others)
        checked += [one for record in last for one in _check(record, apart, held_back=True)]
    return checked


def _check(
    record: TimeRecord, fits: Sequence[Fitted], *, held_back: bool
) -> Iterator[RecordCheckEntry]:
    """By the response from the same file, else the first one, that shows a channel."""
    for channel in record.channels if record.force else ():
        fitting = [
            (one, fit.band_hz)
            for fit in fits
            for one in fit.responses
            if one.response.sensor is channel.sensor and one.response.output is channel.signal
        ]
        own = [pair for pair in fitting if pair[0].response.source.file == record.source.file]
        if record.force and fitting:
            yield RecordCheckEntry(
                record=f"{record.source.file} [{channel.name}]",
                explained=_explained(record.force.values, channel, *(own or fitting)[0]),
                held_back=held_back,
            )


def _explained(
    force: Array, measured: Channel, model: FittedResponse, band_hz: tuple[float, float]
) -> float:
    size, step = force.size, measured.step
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
    drift = np.polynomial.Polynomial.fit(np.arange(size), measured.values, 2)
    flat = measured.values - drift(np.arange(size))
    seen = np.fft.irfft(np.where(inside, np.fft.rfft(flat), 0.0), size) * window
    power = float(np.vdot(seen, seen))
    return 1.0 - float(np.sum((seen - predicted) ** 2)) / power if power > 0.0 else 0.0


MASS_TOLERANCE = 0.05
"""Relative difference of two sensors' masses that is told."""
LEAST_REVERSED = 0.01
"""Share of the time in which an axis moves backwards, below which friction kept its sign."""
LEAST_SHIFT = 3e-3
"""Of a frequency: repeats of one set-up differ by 0.4 %, so that less is not worth a word."""
LARGEST_MODEL_ERROR = 0.05
"""Share of |H| that the model may miss without a word."""
MOST_INCOHERENT = 0.15
"""Share of the lines that may have a coherence below one half."""


def _list_doubts(
    part: IdentifiedPart, fits: Sequence[Fitted], records: Sequence[TimeRecord]
) -> Iterator[Message]:
    """What was chosen, left out, doubtful or unknown, as advice for the next measurement."""
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
    apart = float(spacing_at(response.frequency_hz, np.array(frequency_hz)))
    return max(apart, 0.25 * (response.resolution_hz or 0.0))


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
    drag = fit.drag / (2 * np.pi)
    shifts = [
        (0.5 * max(drag / f.value, (low / f.value) ** 2), f)
        for f in (mode.frequency_hz for mode in fit.modes)
    ]
    shift, f = max(shifts, key=lambda one: one[0] * one[1].value / max(one[1].sigma, 1e-12))
    if shift < LEAST_SHIFT or shift * f.value <= 2.0 * f.sigma:
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
