"""All responses of one state of the machine -> mass, delay and modes with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mtcommission.errors import Fault, InputError
from mtcommission.identify.fit.band import (
    Band,
    broad_poles,
    coherent_band,
    friction_poles,
    narrower_band,
)
from mtcommission.identify.fit.fitted import Fitted, FittedMode, FittedResponse
from mtcommission.identify.fit.lines import ERROR_FLOOR, Lines, see, share_frequencies
from mtcommission.identify.fit.noise import smooth_errors
from mtcommission.identify.fit.order import Ordered, choose_modes
from mtcommission.identify.fit.projection import Variances, count_parameters, find_variances
from mtcommission.identify.measurement import FrequencyResponse, Input, Sensor
from mtcommission.machine.identified import MOST_MISFIT, Estimate
from mtcommission.messages.message import Message

LEAST_LINES = 12
"""Fewer lines of a response in the band tell nothing."""
MOST_CUTS = 3
"""How often the ends of a band are cut."""
FEW_AVERAGES = 4.0
"""Of fewer a coherence tells little: it comes out near 1 by chance."""
FAR = 0.5
"""Share of |H| that a model misses beyond which it does not describe what was measured: where a
file lacks the averages, its misfit hides behind its scatter."""
MOST_BROAD = 2
"""Broad terms with which a fit without a mode is no rigid body: they follow any smooth curve."""
FLAT = -0.25
"""Slope of a drive's velocity at the low end beyond which it is that of another response: -1 of a
free mass, 0 of a closed loop [decades/decade]."""
MOST_ERROR = 0.1
"""Share of |H| that the model of a drive's response may miss, for the band to be left as it is."""
LEAST_OCTAVES = 4.0
"""Of a band that is halved: a rigid body, a mode and what lies above it."""
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
    first = band_hz or coherent_band(responses)
    if band_hz:
        trial = _fit_in(responses, first, count, narrow=False)
        notes = [Message("identify-band-given", low=first[0], high=first[1])]
    else:
        trial = _fit_describable(responses, first, count)
        notes = _of_band(first, trial.band)
    notes += [
        Message(
            "identify-no-lines-in-band",
            file=response.source.name,
            low=trial.band[0],
            high=trial.band[1],
        )
        for response in responses
        if all(response is not one for one in trial.used)
    ]
    if broad := broad_poles(trial.found):
        count, low, high = len(broad), min(broad), max(broad)
        notes.append(Message("identify-background", count=count, low=low, high=high))
    found = _collect(trial, notes)
    is_drive = _by_drive(trial.used) and all(one.input is Input.FORCE for one in trial.used)
    is_rigid = any(one.has_rigid_body for one in found.responses) and len(broad) < MOST_BROAD
    shows = is_rigid or found.modes
    is_far = trial.misfit > MOST_MISFIT or found.model_error > FAR
    if is_far or (is_drive and not shows):
        return replace(found, notes=(_not_described(trial, shows=bool(shows)), *found.notes))
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Trial:
    """A fit in a band: the responses with enough lines there, these lines as coherence weighs."""

    band: Band
    used: list[FrequencyResponse]
    base: list[Lines]
    found: Ordered

    @property
    def parameters(self) -> int:
        return count_parameters(self.found.fit)

    @property
    def size(self) -> int:
        return sum(2 * lines.size for lines in self.base)

    @property
    def is_described(self) -> bool:
        """Whether the model is near what was measured; a hammer's response may be farther."""
        is_near = self.found.model_error <= MOST_ERROR or not _by_drive(self.used)
        return self.misfit <= MOST_MISFIT and is_near

    @property
    def misfit(self) -> float:
        """Weighted rms of the residuals by their noise, by the free lines.

        The noise is what coherence and averages tell; where a file lacks them, or they are few, it
        is what neighbouring residuals differ by, which no smooth error of the model can make small.
        """
        squares = 0.0
        for response, residual, own, lines in zip(
            self.used,
            self.found.fit.residuals,
            self.found.lines,
            smooth_errors(self.base),
            strict=True,
        ):
            noise = lines.error
            if response.standard_error is None or (response.averages or 0.0) < FEW_AVERAGES:
                scatter = 0.5 * float(np.sqrt(np.mean(np.abs(np.diff(residual)) ** 2)))
                noise = np.maximum(scatter * own.error, ERROR_FLOOR * np.abs(lines.values))
            squares += float(np.sum(np.abs(residual * own.error / noise) ** 2))
        return float(np.sqrt(squares / max(self.size - self.parameters, 1)))


def _not_described(trial: _Trial, *, shows: bool) -> Message:
    """What does not fit, by where most of the misfit lies, in thirds of the band by octaves."""
    low, high = trial.band
    edges = np.geomspace(low, high, 4)
    squares = np.zeros(3)
    for residual, own, lines in zip(
        trial.found.fit.residuals, trial.found.lines, trial.base, strict=True
    ):
        missed = np.abs(residual * own.error / lines.error) ** 2
        squares += np.histogram(lines.frequency_hz, edges, weights=missed)[0]
    worst = int(np.argmax(squares))
    cause = ("friction", "feedback", "modes")[worst]
    if _by_drive(trial.used) and max(map(_low_slope, trial.base)) > FLAT:
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


def _fit_in(
    responses: Sequence[FrequencyResponse], band: Band, count: int | None, *, narrow: bool
) -> _Trial:
    """The fit in a band, or where its ends do not obey the model in a narrower one."""
    used, base = _cut(responses, band)
    found = choose_modes(base, count=count)
    for _ in range(MOST_CUTS if narrow else 0):
        narrower = narrower_band(found, base, by_drive=_by_drive(used))
        if narrower is None:
            break
        kept, fewer = _cut(responses, narrower)
        if [r.source for r in kept] != [r.source for r in used]:
            break
        band, base = narrower, fewer
        found = choose_modes(base, count=count)
    return _Trial(band=band, used=used, base=base, found=found)


def _fit_describable(
    responses: Sequence[FrequencyResponse], band: Band, count: int | None
) -> _Trial:
    """The fit in the widest band, by octaves from above, that the model describes; else the whole.

    A drive measures to half its sampling rate, where current loop and shafts have more modes than
    a model holds; the many lines there would outvote the few in which the axis swings.
    """
    trial = whole = _fit_in(responses, band, count, narrow=True)
    while not (trial.is_described and (trial is whole or any(trial.found.is_mode))):
        band = band[0], 0.5 * trial.band[1]  # what a poor fit cut at the low end may be good
        if np.log2(band[1] / band[0]) < LEAST_OCTAVES:
            return whole
        trial = _fit_in(responses, band, count, narrow=True)
    return trial


def _of_band(first: Band, band: Band) -> list[Message]:
    if band == first:
        return []
    return [
        Message("identify-band-cut", low=first[0], high=first[1], new_low=band[0], new_high=band[1])
    ]


def _cut(
    responses: Sequence[FrequencyResponse], band: Band
) -> tuple[list[FrequencyResponse], list[Lines]]:
    """Return the responses with enough lines in a band, and these lines."""
    kept, lines = [], []
    for response in responses:
        inside = _inside(response, band)
        if np.count_nonzero(inside) >= LEAST_LINES:
            kept.append(response)
            lines.append(see(response, inside))
    if not kept:
        first = responses[0]
        message = Message(
            "identify-too-few-in-band",
            lines=int(np.count_nonzero(_inside(first, band))),
            least=LEAST_LINES,
            low=band[0],
            high=band[1],
        )
        raise InputError([Fault(where=first.source.name, message=message)])
    return kept, share_frequencies(lines)


def _by_drive(responses: Sequence[FrequencyResponse]) -> bool:
    """Whether the drive shakes, as far as one can tell: an encoder was recorded."""
    return any(one.sensor is Sensor.ENCODER for one in responses)


def _inside(response: FrequencyResponse, band: Band) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    f = response.frequency_hz
    slack = 1e-9 * band[1]
    is_number = np.isfinite(response.values) & (np.abs(response.values) > 0.0)
    return (f >= band[0] - slack) & (f <= band[1] + slack) & is_number


def _collect(trial: _Trial, notes: list[Message]) -> Fitted:
    responses, base, found = trial.used, trial.base, trial.found
    fit = found.fit
    reduced = fit.cost / max(trial.size - trial.parameters, 1)
    factor = float(np.sqrt(max(reduced, 1.0) * found.correlation))
    variances = find_variances(found.lines, fit, curvature=CURVATURE)
    by_drive = _by_drive(responses)
    fitted = tuple(
        _response(response, lines, found, place, variances, factor, trial.band, by_drive=by_drive)
        for place, (response, lines) in enumerate(zip(responses, found.lines, strict=True))
    )
    return Fitted(
        responses=fitted,
        modes=_modes(found, fitted, variances, factor),
        drag=Estimate(value=fit.poles.drag, sigma=factor * float(np.sqrt(variances.poles[0, 0]))),
        band_hz=(
            min(float(lines.frequency_hz[0]) for lines in base),
            max(float(lines.frequency_hz[-1]) for lines in base),
        ),
        misfit=trial.misfit,
        model_error=found.model_error,
        notes=tuple(notes),
    )


def _response(
    response: FrequencyResponse,
    lines: Lines,
    found: Ordered,
    place: int,
    variances: Variances,
    factor: float,
    band: Band,
    *,
    by_drive: bool,
) -> FittedResponse:
    gains = found.fit.gains[place]
    sigmas = factor * np.sqrt(np.maximum(np.diag(variances.gains[place]), 0.0))
    # Above the frequency at which friction lets go, its pole is part of the free mass.
    body = np.zeros(gains.size)
    body[[0, *(1 + k for k in friction_poles(found, float(lines.frequency_hz[0])) if by_drive)]] = 1
    inverse_mass = float(body @ gains)
    mass_sigma = factor * variances.of_gains(place, body)
    delay, lag = float(found.fit.poles.delays[place]), float(found.fit.poles.lags[place])
    n = found.fit.poles.lags.size
    delay_sigma, lag_sigma = (
        factor * float(np.sqrt(variances.poles[at, at])) for at in (1 + place, 1 + n + place)
    )
    size = np.abs(lines.values / lines.s**lines.derivative)[: max(3, lines.size // 50)]
    share = abs(inverse_mass) / np.abs(lines.s[: size.size]) ** 2 / size
    is_rigid = abs(inverse_mass) > CERTAIN * mass_sigma and float(np.median(share)) > RIGID_SHARE
    if not by_drive:
        # A hammer's response has a slope of its own; a mass must make nearly all of it.
        low = lines.keep_first(size.size)
        position = low.values * np.exp(low.s * delay) * (1.0 + low.s * lag) / low.s**low.derivative
        apart = np.abs(position * low.s**2 / inverse_mass - 1.0)
        is_rigid = is_rigid and float(np.median(apart)) < FREE_BODY
    # Of a hammer test only the struck point tells the sign: nothing is turned.
    polarity = -1 if is_rigid and inverse_mass < 0.0 else 1
    return FittedResponse(
        response=response,
        is_used=_inside(response, band),
        lines=lines,
        polarity=polarity,
        inverse_mass=Estimate(value=polarity * inverse_mass, sigma=mass_sigma),
        has_rigid_body=is_rigid and response.input is Input.FORCE,
        delay=Estimate(value=delay, sigma=delay_sigma),
        lag=Estimate(value=lag, sigma=lag_sigma) if lag else None,
        residual=Estimate(value=polarity * float(gains[-1]), sigma=float(sigmas[-1])),
        poles=found.fit.poles,
        gains=gains,
        place=place,
    )


def _modes(
    found: Ordered, fitted: Sequence[FittedResponse], variances: Variances, factor: float
) -> tuple[FittedMode, ...]:
    poles = found.fit.poles
    low = min(float(lines.frequency_hz[0]) for lines in found.lines)
    by_drive = _by_drive([one.response for one in fitted])
    friction = friction_poles(found, low) if by_drive else []
    modes = []
    for k in np.argsort(poles.omega).tolist():
        if not found.is_mode[k] or k in friction:
            continue
        by_omega, by_zeta = variances.of_mode(k, poles.omega.size)
        f, zeta = float(poles.omega[k]) / (2 * np.pi), float(poles.zeta[k])
        gains = tuple(
            Estimate(
                value=one.polarity * float(one.gains[1 + k]),
                sigma=factor * float(np.sqrt(variances.gains[one.place, 1 + k, 1 + k])),
            )
            for one in fitted
        )
        modes.append(
            FittedMode(
                frequency_hz=Estimate(value=f, sigma=factor * by_omega * f),
                damping_ratio=Estimate(value=zeta, sigma=factor * by_zeta * zeta),
                gains=gains,
            )
        )
    return tuple(modes)
