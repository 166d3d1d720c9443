"""All responses of one state of the machine -> mass, delay and modes with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.identify.fit.band import (
    LEAST_LINES,
    Band,
    Trial,
    coherent_band,
    fit_describable,
    fit_in,
    inside,
)
from mtcommission.identify.fit.fitted import Fitted, FittedMode, FittedResponse
from mtcommission.identify.fit.lines import Lines, ends_of
from mtcommission.identify.fit.projection import Variances, find_variances
from mtcommission.identify.measurement import (
    FrequencyResponse,
    Signal,
)
from mtcommission.machine.identified import MOST_MISFIT, Estimate

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
    found, fit = trial.found, trial.found.fit
    factor = float(np.sqrt(max(fit.cost / trial.spare, 1.0) * found.correlation))
    plain = find_variances(found.lines, fit, curvature=CURVATURE)
    variances = Variances(factor**2 * plain.poles, factor**2 * plain.gains)
    friction = trial.friction
    fitted = tuple(_response(trial, place, variances, friction) for place in range(len(trial.used)))
    modes, drag = _modes(trial, fitted, variances, friction), variances.poles[0, 0]
    return Fitted(
        responses=fitted,
        modes=modes,
        drag=Estimate(value=fit.poles.drag, sigma=float(np.sqrt(drag))),
        band_hz=ends_of(trial.base),
        misfit=trial.misfit,
        model_error=found.model_error,
    )


def _response(
    trial: Trial, place: int, variances: Variances, friction: Sequence[int]
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
        delay=Estimate(value=delay, sigma=delay_sigma),
        lag=Estimate(value=lag, sigma=lag_sigma) if lag else None,
        poles=fit.poles,
        gains=gains,
        place=place,
    )


def _modes(
    trial: Trial, fitted: Sequence[FittedResponse], variances: Variances, friction: Sequence[int]
) -> tuple[FittedMode, ...]:
    poles, modes = trial.found.fit.poles, []
    by_omega, by_zeta = variances.of_modes
    for k in np.argsort(poles.omega).tolist():
        if not trial.found.is_mode[k] or k in friction:
            continue
        f, zeta = float(poles.frequency_hz[k]), float(poles.zeta[k])
        gains = tuple(
            Estimate(
                value=one.polarity * float(one.gains[1 + k]),
                sigma=float(variances.each_gain[one.place, 1 + k]),
            )
            for one in fitted
        )
        modes.append(
            FittedMode(
                frequency_hz=Estimate(value=f, sigma=float(by_omega[k]) * f),
                damping_ratio=Estimate(value=zeta, sigma=float(by_zeta[k]) * zeta),
                gains=gains,
            )
        )
    return tuple(modes)
