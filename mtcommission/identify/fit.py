"""All responses of one state of the machine -> rigid mass, delay and modes with intervals.

Which lines tell of the machine: by coherence, then by misfit, then by what a low mode claims.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.order import BROADEST, Ordered, choose_modes, smooth_errors
from mtcommission.identify.projection import (
    ERROR_FLOOR,
    Lines,
    Poles,
    Variances,
    count_values,
    ends_of,
    find_variances,
    predict,
    see,
    share_frequencies,
)
from mtcommission.machine.identified import MOST_MISFIT, Estimate, MeasuredMode
from mtcommission.measured.measurement import (
    Array,
    ComplexArray,
    FrequencyResponse,
    Sensor,
    Signal,
    Spectrum,
)
from mtcommission.measured.regression import neighbours
from mtcommission.measured.signals import LEAST_LINES


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedResponse:
    """What a fit says of one response."""

    response: FrequencyResponse  # As measured
    is_used: NDArray[np.bool_]  # Which of its lines were fitted, shape (n_lines,)
    lines: Lines  # As the fit took them, with their standard errors
    polarity: int  # -1 where the sensor or the force counts the other way round, else 1
    inverse_mass: Estimate  # b = 1/m, polarity put right [1/kg]
    # Whether b stands for the mass that the force moves; else for what lies below the band.
    has_rigid_body: bool
    # Residue of each mode, polarity put right [1/kg; 1/(kg m²) on a rotary axis; - base-excited].
    residues: tuple[Estimate, ...]
    delay: Estimate  # tau [s]
    lag: Estimate | None  # T [s]; None where none shows
    # poles, gains: Of the model of this response alone, as measured.
    poles: Poles
    gains: Array

    def model(self, frequency_hz: Array) -> ComplexArray:
        """Return the model's response, as measured with its polarity, shape (n,)."""
        return predict(frequency_hz, self.poles, self.gains, self.response.output.derivative)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fitted:
    """One state of the machine: common poles, and each response."""

    responses: tuple[FittedResponse, ...]  # In the order given
    modes: tuple[MeasuredMode, ...]  # By frequency, with the surest gain of each sensor
    drag: float  # c = viscous friction by mass [1/s]
    band_hz: tuple[float, float]  # Lowest and highest line that was fitted [Hz]
    # Weighted rms of the residuals by the noise that the coherence tells; 1 = as good as that.
    misfit: float
    model_error: float  # Share of |H| that the model misses beyond noise [-]
    notes: tuple[Message, ...] = ()  # What was chosen, left out and doubtful

    @property
    def leading(self) -> FittedResponse:
        """The first response of the encoder, else of the tool."""
        return min(self.responses, key=lambda one: one.response.sensor is Sensor.TCP)

    @property
    def moving_mass(self) -> Estimate | None:
        """The mass that the force moves; None where no response shows one."""
        rigid = (one for one in self.responses if one.has_rigid_body)
        one = min(rigid, key=lambda one: one.response.sensor is Sensor.TCP, default=None)
        b = one and one.inverse_mass
        return Estimate(value=1 / b.value, sigma=b.sigma / b.value**2) if b else None

    def has(self, sensor: Sensor) -> bool:
        """Return whether one of the responses shows a sensor."""
        return any(one.response.sensor is sensor for one in self.responses)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedSpectrum:
    """The peaks of a spectrum."""

    spectrum: Spectrum  # As measured
    is_used: NDArray[np.bool_]  # Which of its lines were fitted
    # By frequency, with their shares at the tool; two within the window's width show as one.
    modes: tuple[MeasuredMode, ...]
    density: Array  # The model on the fitted lines


Band = tuple[float, float]

MOST_CUTS = 3
"""How often the ends of a band are cut."""
FEW_AVERAGES = 4.0
"""Of fewer a coherence tells little: it comes out near 1 by chance."""
MOST_ERROR = 0.1
"""Share of |H| that the model of a drive's response may miss, for the band to be left as it is."""
LEAST_COHERENCE = 0.5
"""Median over nine lines below which the ends of a response are left out (empirical)."""
EXCESS = 2.5
"""Misfit of a third of an octave at an end, in that of all lines, beyond which it is left out."""
LEAST_LINES_OF_STRETCH = 3
"""Of a stretch whose misfit is judged."""
LOW_END = 3.0
"""A mode below so many times the lowest line must show a rigid body below it."""
FRICTION_RATIO = 0.12
"""Damping beyond which a mode at the low end is taken for friction: sticking bodies spring."""
BELOW = 0.5
"""Friction lies below the lowest sharp mode times this."""
TOLERANCE = 1.05
"""Relative distance within which a pole sits on the end of the band."""
ABOVE = 1.8
"""Where a band begins whose lower end friction governs, in that false mode's frequency."""
LEAST_OCTAVES = 2.0
"""No cut leaves less than that."""
LEAST_OCTAVES_HALVED = 4.0
"""Of a band that is halved: a rigid body, a mode and what lies above it."""


def coherent_band(responses: Sequence[FrequencyResponse]) -> Band:
    """Return the band in which at least one response is coherent [Hz]."""
    ends: list[Band] = []
    for response in responses:
        good = f = response.frequency_hz
        if response.coherence is not None:
            median = np.median(neighbours(response.coherence, 9), axis=1)
            good = f[median >= LEAST_COHERENCE]
        if good.size:
            ends.append((float(good[0]), float(good[-1])))
    ends = ends or [(float(r.frequency_hz[0]), float(r.frequency_hz[-1])) for r in responses]
    return min(low for low, _ in ends), max(high for _, high in ends)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A fit in a band: the responses with enough lines there, these lines as coherence weighs."""

    band: Band
    used: list[FrequencyResponse]
    base: list[Lines]
    found: Ordered

    @property
    def by_drive(self) -> bool:
        """Whether the drive shakes, as far as one can tell: an encoder was recorded."""
        return any(one.sensor is Sensor.ENCODER for one in self.used)

    @property
    def spare(self) -> int:
        """Numbers that were measured beyond those that were fitted."""
        return max(count_values(self.base) - self.found.fit.parameters, 1)

    @property
    def is_described(self) -> bool:
        """Whether the model is near what was measured; a hammer's response may be farther."""
        is_near = self.found.model_error <= MOST_ERROR or not self.by_drive
        return self.misfit <= MOST_MISFIT and is_near

    @property
    def missed(self) -> list[Array]:
        """|model - measured|² of each response, line by line."""
        pairs = zip(self.found.fit.residuals, self.found.lines, strict=True)
        return [np.abs(residual * own.error) ** 2 for residual, own in pairs]

    @property
    def misfit(self) -> float:
        """Weighted rms of the residuals by their noise, by the free lines.

        The noise is what coherence and averages tell; where a file lacks them, or they are few, it
        is what neighbouring residuals differ by, which no smooth error of the model can make small.
        """
        squares = 0.0
        residuals, weighed = self.found.fit.residuals, self.found.lines
        smooth = smooth_errors(self.base)
        for response, missed, residual, own, lines in zip(
            self.used, self.missed, residuals, weighed, smooth, strict=True
        ):
            noise = lines.error
            if response.coherence is None or (response.averages or 0.0) < FEW_AVERAGES:
                scatter = 0.5 * float(np.sqrt(np.mean(np.abs(np.diff(residual)) ** 2)))
                noise = np.maximum(scatter * own.error, ERROR_FLOOR * np.abs(lines.values))
            squares += float(np.sum(missed / noise**2))
        return float(np.sqrt(squares / self.spare))

    @property
    def friction(self) -> list[int]:
        """Which poles stand for sticking friction, no mode.

        They lie below all sharp modes, and are strongly damped or show no free mass below them.
        """
        if not self.by_drive:
            return []
        poles, (low, _) = self.found.fit.poles, ends_of(self.found.lines)
        f, zeta = poles.frequency_hz, poles.zeta
        sharp = f[self.found.is_mode & (zeta < FRICTION_RATIO) & (f > LOW_END * low)]
        ceiling = min(LOW_END * low, BELOW * float(sharp.min(initial=np.inf)))
        return [
            k
            for k in np.flatnonzero(f < ceiling).tolist()
            if zeta[k] > FRICTION_RATIO or f[k] < TOLERANCE * low or not self._is_rigid_below(k)
        ]

    def _is_rigid_below(self, pole: int) -> bool:
        """Whether position lags force by half a turn below a pole, as that of a free mass does."""
        fit, signs = self.found.fit, list[float]()
        for lines, gains, delay in zip(
            self.found.lines, fit.gains, fit.poles.delays.tolist(), strict=True
        ):
            below = lines.frequency_hz < 0.8 * fit.poles.frequency_hz[pole]
            # Whether the sensor counts backwards shows above the pole, where friction has let go.
            turned = np.sign(gains[0] + gains[1 + pole]) * lines.position(delay)[below]
            signs += (turned.real / np.abs(turned)).tolist()
        return len(signs) >= 3 and float(np.median(signs)) < -0.5

    @property
    def background(self) -> list[float]:
        """Frequencies of broad terms within the band [Hz]."""
        poles = self.found.fit.poles
        broad = ~self.found.is_mode & (poles.zeta >= BROADEST)
        return [float(one) for one in poles.frequency_hz[broad]]

    @property
    def narrower(self) -> Band:
        """The band without ends that do not obey the model; the same where all do."""
        low, high = ends_of(self.base)
        f = self.found.fit.poles.frequency_hz
        friction = max((ABOVE * float(f[k]) for k in self.friction), default=0.0)
        if friction > low * TOLERANCE and np.log2(high / friction) >= LEAST_OCTAVES:
            return friction, high
        cut_low, cut_high = self._cut_by_misfit(low, high)
        return (low, high) if np.log2(cut_high / cut_low) < LEAST_OCTAVES else (cut_low, cut_high)

    def _cut_by_misfit(self, low: float, high: float) -> Band:
        edges = _edges(self.base, low, high * (1 + 1e-9))
        f = np.concatenate([lines.frequency_hz for lines in self.base])
        noise = np.concatenate([lines.error**2 for lines in self.base])
        sizes = np.concatenate([np.abs(lines.values) ** 2 for lines in self.base])
        squares = 0.5 * np.concatenate(self.missed)
        place = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, edges.size - 2)
        counts = np.bincount(place, minlength=edges.size - 1)

        def mean(values: Array) -> Array:
            sums = np.bincount(place, values, edges.size - 1)
            return np.asarray(sums / np.maximum(counts, 1))

        # What the model misses in most stretches: the worst ends must not excuse themselves.
        share = float(np.median(mean(np.maximum(squares - noise, 0.0) / sizes)[counts > 0]))
        share = min(share, self.found.model_error**2)
        rms = np.sqrt(mean(squares / (noise + share * sizes)))
        bad = rms > EXCESS * max(float(np.median(rms[counts > 0])), 1.0)
        first = _skipped(bad, counts)
        last = bad.size - _skipped(bad[::-1], counts[::-1])
        return (
            float(edges[first]) if bad[:first].any() else low,
            float(edges[last]) if bad[last:].any() else high,
        )


def _skipped(bad: NDArray[np.bool_], counts: NDArray[np.intp]) -> int:
    """How many stretches at the beginning, at most a third, are bad or empty."""
    good = np.flatnonzero(~bad & (counts > 0))
    return min(int(good[0]) if good.size else bad.size, bad.size // 3)


def _edges(base: Sequence[Lines], low: float, high: float) -> Array:
    """Ends of stretches of a third of an octave, or of enough lines where these are rarer."""
    f = np.sort(np.concatenate([lines.frequency_hz for lines in base]))
    edges = [low]
    for edge in np.geomspace(low, high, max(4, round(3 * np.log2(high / low))) + 1)[1:].tolist():
        if np.searchsorted(f, edge) - np.searchsorted(f, edges[-1]) >= LEAST_LINES_OF_STRETCH:
            edges.append(edge)
    return np.array([*edges[:-1], high]) if len(edges) > 1 else np.array([low, high])


def inside(response: FrequencyResponse, band: Band) -> NDArray[np.bool_]:
    """Return which lines of a response lie in a band and hold something."""
    f, slack = response.frequency_hz, 1e-9 * band[1]
    is_number = np.isfinite(response.values) & (np.abs(response.values) > 0.0)
    return np.asarray((f >= band[0] - slack) & (f <= band[1] + slack) & is_number)


def fit_in(
    responses: Sequence[FrequencyResponse], band: Band, count: int | None, *, narrow: bool
) -> Trial:
    """Return the fit in a band, or where its ends do not obey the model in a narrower one.

    Raise InputError if no response has enough lines there.
    """
    trial: Trial | None = None
    for _ in range(1 + (MOST_CUTS if narrow else 0)):
        used = [one for one in responses if inside(one, band).sum() >= LEAST_LINES]
        if trial and [one.source for one in used] != [one.source for one in trial.used]:
            break
        if not used:
            (low, high), lines = band, int(inside(responses[0], band).sum())
            few = {"lines": lines, "least": LEAST_LINES, "low": low, "high": high}
            message = Message("identify-too-few-in-band", **few)
            raise InputError([Fault(where=responses[0].source.name, message=message)])
        base = share_frequencies([see(one, inside(one, band)) for one in used])
        trial = Trial(band=band, used=used, base=base, found=choose_modes(base, count=count))
        if not narrow or (band := trial.narrower) == ends_of(base):
            break
    assert trial is not None
    return trial


def fit_describable(responses: Sequence[FrequencyResponse], band: Band, count: int | None) -> Trial:
    """Return the fit in the widest band, by octaves from above, that the model describes.

    A drive measures to half its sampling rate, where current loop and shafts have more modes than
    a model holds; the many lines there would outvote the few in which the axis swings. Where no
    band is described it is the fit in the whole one.
    """
    trial = whole = fit_in(responses, band, count, narrow=True)
    while not (trial.is_described and (trial is whole or trial.found.is_mode.any())):
        band = band[0], 0.5 * trial.band[1]  # what a poor fit cut at the low end may be good
        if np.log2(band[1] / band[0]) < LEAST_OCTAVES_HALVED:
            return whole
        trial = fit_in(responses, band, count, narrow=True)
    return trial


FAR = 0.5
"""Share of |H| that a model misses beyond which it does not describe what was measured: where a
file lacks the averages, its misfit hides behind its scatter."""
MOST_BROAD = 2
"""Broad terms with which a fit without a mode is no rigid body: they follow any smooth curve."""
FLAT = -0.25
"""Slope of a drive's velocity at the low end beyond which it is that of another response: -1 of a
free mass, 0 of a closed loop [decades/decade]."""
RIGID_SHARE = 0.4
"""Least share of the mass in the response at the low end, for it to be a mass."""
FREE_BODY = 0.4
"""Largest relative distance from b/s² at the low end where no drive shakes."""
CURVATURE = 0.3
"""Of the residual term at the high end of the band, from a mode at 1.3 to 2.5 times its frequency
(that is 0.16 to 0.6)."""
CERTAIN = 4.0
"""Least value of a mass or gain in its standard error."""


def fit_state(
    responses: Sequence[FrequencyResponse],
    *,
    band_hz: Band | None = None,
    count: int | None = None,
) -> Fitted:
    """Return mass, delay and modes of an axis from its responses in one state.

    Raise InputError if no response has enough lines in the band.
    """
    first, notes = band_hz or coherent_band(responses), []
    if band_hz:
        trial = fit_in(responses, first, count, narrow=False)
        notes.append(Message("identify-band-given", low=first[0], high=first[1]))
    else:
        trial = fit_describable(responses, first, count)
    (low, high), (new_low, new_high) = first, trial.band
    if trial.band != first:
        ends = {"low": low, "high": high, "new_low": new_low, "new_high": new_high}
        notes.append(Message("identify-band-cut", **ends))
    notes += [
        Message("identify-no-lines-in-band", file=one.source.name, low=new_low, high=new_high)
        for one in responses
        if all(one is not other for other in trial.used)
    ]
    if broad := trial.background:
        count, low, high = len(broad), min(broad), max(broad)
        notes.append(Message("identify-background", count=count, low=low, high=high))
    found = _collect(trial)
    is_drive = trial.by_drive and all(one.input is Signal.FORCE for one in trial.used)
    is_rigid = any(one.has_rigid_body for one in found.responses) and len(broad) < MOST_BROAD
    shows = bool(is_rigid or found.modes)
    is_far = trial.misfit > MOST_MISFIT or found.model_error > FAR
    if is_far or (is_drive and not shows):
        notes.insert(0, _not_described(trial, shows=shows))
    return replace(found, notes=tuple(notes))


def _not_described(trial: Trial, *, shows: bool) -> Message:
    """What does not fit, by where most of the misfit lies, in thirds of the band by octaves."""
    edges, squares = np.geomspace(*trial.band, 4), np.zeros(3)
    for missed, lines in zip(trial.missed, trial.base, strict=True):
        squares += np.histogram(lines.frequency_hz, edges, weights=missed / lines.error**2)[0]
    worst = int(np.argmax(squares))
    cause = ("friction", "feedback", "modes")[worst]
    if trial.by_drive and max(map(_low_slope, trial.base)) > FLAT:
        cause = "response"
    return Message(
        "identify-not-described",
        files=", ".join(dict.fromkeys(one.source.name for one in trial.used)),
        misfit=trial.misfit,
        most=MOST_MISFIT,
        missed=trial.found.model_error,
        far=FAR,
        shows="yes" if shows else "no",
        low=float(edges[worst]),
        high=float(edges[worst + 1]),
        cause=cause,
    )


def _low_slope(lines: Lines) -> float:
    """Median slope of the velocity over the lower half of the band's octaves [decades/decade]."""
    f = lines.frequency_hz
    size = np.abs(lines.values) * f ** (1.0 - lines.derivative)
    places = np.linspace(np.log(f[0]), np.log(f[0] * f[-1]) / 2, 4 * LEAST_LINES)
    course = np.interp(places, np.log(f), np.log(size))
    half = places.size // 2
    return float(np.median(course[half:] - course[:half]) / (places[half] - places[0]))


def _collect(trial: Trial) -> Fitted:
    found, fit, friction = trial.found, trial.found.fit, trial.friction
    factor = float(np.sqrt(max(fit.cost / trial.spare, 1.0) * found.correlation))
    plain = find_variances(found.lines, fit, curvature=CURVATURE)
    variances = Variances(factor**2 * plain.poles, factor**2 * plain.gains)
    ordered = np.argsort(fit.poles.omega).tolist()
    modes = [k for k in ordered if found.is_mode[k] and k not in friction]
    places = range(len(trial.used))
    responses = tuple(_response(trial, place, variances, friction, modes) for place in places)
    return Fitted(
        responses=responses,
        modes=tuple(_modes(fit.poles, responses, variances, modes)),
        drag=fit.poles.drag,
        band_hz=ends_of(trial.base),
        misfit=trial.misfit,
        model_error=found.model_error,
    )


def _response(
    trial: Trial,
    place: int,
    variances: Variances,
    friction: Sequence[int],
    modes: Sequence[int],
) -> FittedResponse:
    response, fit, lines = trial.used[place], trial.found.fit, trial.found.lines[place]
    gains, n = fit.gains[place], fit.poles.lags.size
    # Above the frequency at which friction lets go, its pole is part of the free mass.
    body = np.zeros(gains.size)
    body[[0, *(1 + k for k in friction)]] = 1
    inverse_mass, mass_sigma = float(body @ gains), variances.of_gains(place, body)
    delay, lag = float(fit.poles.delays[place]), float(fit.poles.lags[place])
    squares = np.diag(variances.poles)[[1 + place, 1 + n + place]]
    delay_sigma, lag_sigma = np.sqrt(np.maximum(squares, 0.0)).tolist()
    low = slice(max(3, lines.size // 50))
    s, size = lines.s[low], np.abs(lines.position()[low])
    share = float(np.median(abs(inverse_mass) / np.abs(s) ** 2 / size))
    is_rigid = abs(inverse_mass) > CERTAIN * mass_sigma and share > RIGID_SHARE
    if not trial.by_drive:
        # A hammer's response has a slope of its own; a mass must make nearly all of it.
        apart = np.abs(lines.position(delay, lag)[low] * s**2 / inverse_mass - 1.0)
        is_rigid = is_rigid and float(np.median(apart)) < FREE_BODY
    # Of a hammer test only the struck point tells the sign: nothing is turned.
    polarity = -1 if is_rigid and inverse_mass < 0.0 else 1
    return FittedResponse(
        response=response,
        is_used=inside(response, trial.band),
        lines=lines,
        polarity=polarity,
        inverse_mass=Estimate(value=polarity * inverse_mass, sigma=mass_sigma),
        has_rigid_body=is_rigid and response.input is Signal.FORCE,
        residues=tuple(
            Estimate(
                value=polarity * float(gains[1 + k]),
                sigma=float(variances.each_gain[place, 1 + k]),
            )
            for k in modes
        ),
        delay=Estimate(value=delay, sigma=delay_sigma),
        lag=Estimate(value=lag, sigma=lag_sigma) if lag else None,
        poles=fit.poles.of(place),
        gains=gains,
    )


def _modes(
    poles: Poles, responses: Sequence[FittedResponse], variances: Variances, modes: Sequence[int]
) -> Iterator[MeasuredMode]:
    by_omega, by_zeta = variances.of_modes
    for number, k in enumerate(modes):
        f, zeta = float(poles.frequency_hz[k]), float(poles.zeta[k])
        yield MeasuredMode(
            frequency_hz=Estimate(value=f, sigma=float(by_omega[k]) * f),
            damping_ratio=Estimate(value=zeta, sigma=float(by_zeta[k]) * zeta),
            measured_gain=_gain(responses, number, Sensor.ENCODER),
            tcp_gain=_gain(responses, number, Sensor.TCP),
        )


def _gain(responses: Sequence[FittedResponse], mode: int, sensor: Sensor) -> Estimate | None:
    """The surest gain of a sensor; base-excited, with the sign of the profile."""
    found = [
        replace(gain, value=-gain.value) if one.response.input is Signal.ACCELERATION else gain
        for one in responses
        if one.response.sensor is sensor
        for gain in [one.residues[mode]]
    ]
    return min(found, key=lambda gain: gain.relative, default=None)
