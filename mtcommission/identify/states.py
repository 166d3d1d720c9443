"""States of a machine -> one description: modes matched across positions, payloads and levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, log

import numpy as np
from scipy.optimize import linear_sum_assignment

from mtcommission.identify.fit.fit import fit_state
from mtcommission.identify.fit.fitted import Estimate, Fitted
from mtcommission.identify.fit.peaks import FittedSpectrum, fit_spectrum
from mtcommission.identify.measurement import (
    Evidence,
    FreeVibration,
    FrequencyResponse,
    Input,
    Sensor,
)
from mtcommission.messages.message import Message

FARTHEST = 0.25
"""Largest distance of one mode in two states, in ln f; payloads shift modes by less (empirical)."""
FREQUENCY_FLOOR = 0.01
"""Least spread where several states were measured: the level alone shifts a mode by 0.8 %."""
FREQUENCY_FLOOR_OF_ONE = 0.03
"""Least spread where one state was measured: positions and payload are not in it (empirical)."""
DAMPING_FLOOR = 0.15
"""Least spread of damping where several states were measured (empirical)."""
DAMPING_FLOOR_OF_ONE = 0.3
"""Least spread of damping where one state was measured: that of a profile that states none."""
STEP = 0.005
"""Spreads are rounded up to it."""
SAME = 3.0
"""Responses whose poles differ by less, in standard errors, are of one state."""
OUTLIER = 3.0
"""Misfit of a point in the typical one beyond which it is left out."""
MASS_TOLERANCE = 0.05
"""Relative difference of two sensors' masses that is told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """A mode in one state.

    Parameters
    ----------
    frequency_hz, damping_ratio
        f [Hz] and ζ [-].
    measured_gain, tcp_gain
        Of encoder and tool; None where no sensor with a force tells.
    """

    frequency_hz: Estimate
    damping_ratio: Estimate
    measured_gain: Estimate | None = None
    tcp_gain: Estimate | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """What was found in one state of the machine.

    Parameters
    ----------
    name
        Position, payload or level where a file names it, else the files.
    modes
        By frequency.
    moving_mass
        None without a rigid body in the band.
    delay
        None without phase.
    result
        Where the modes come from.
    """

    name: str
    modes: tuple[Seen, ...]
    moving_mass: Estimate | None
    delay: Estimate | None
    result: Fitted | FittedSpectrum | FreeVibration


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedMode:
    """A mode over all states; the intervals hold the states.

    Parameters
    ----------
    name
        For the profile.
    frequency_hz, damping_ratio, measured_gain, tcp_gain
        Middle of the states, with a standard error of at least a quarter of their range.
    seen
        For each state, which of its modes it is; None where it was not seen.
    """

    name: str
    frequency_hz: Estimate
    damping_ratio: Estimate
    measured_gain: Estimate | None
    tcp_gain: Estimate | None
    seen: tuple[int | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """What the corners must hold.

    Parameters
    ----------
    frequency, damping
        Relative [-].
    because
        For frequency and for damping.
    """

    frequency: float
    damping: float
    because: tuple[Message, Message]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identified:
    """An axis as measured.

    Parameters
    ----------
    evidence
        From which it comes.
    rotary
        Whether lengths are angles.
    states
        In the order of the files.
    modes
        By frequency.
    moving_mass, delay
        Over all states; None where nothing tells.
    spread
        Of frequencies and damping.
    warnings
        What was chosen, left out, doubtful or not known.
    """

    evidence: Evidence
    rotary: bool
    states: tuple[State, ...]
    modes: tuple[IdentifiedMode, ...]
    moving_mass: Estimate | None
    delay: Estimate | None
    spread: Spread
    warnings: tuple[Message, ...]

    @property
    def fits(self) -> tuple[Fitted, ...]:
        """The states that have responses."""
        return tuple(one.result for one in self.states if isinstance(one.result, Fitted))

    @property
    def is_base_excited(self) -> bool:
        """Whether no force was measured anywhere, only accelerations."""
        inputs = {one.response.input for fit in self.fits for one in fit.responses}
        return inputs == {Input.ACCELERATION} or not inputs


def identify(
    evidence: Evidence,
    *,
    band_hz: tuple[float, float] | None = None,
    count: int | None = None,
) -> Identified:
    """Return the axis that measurements show.

    Parameters
    ----------
    evidence
        Responses, spectra and free vibrations.
    band_hz
        Lowest and highest line; None: chosen.
    count
        Number of modes; None: by evidence.

    Raises
    ------
    InputError
        If a response has too few lines in the band.
    """
    fits = fit_states(evidence.responses, band_hz=band_hz, count=count)
    spectra = [fit_spectrum(spectrum) for spectrum in evidence.spectra]
    states = (
        *(_of_fit(fit) for fit in fits),
        *(_of_spectrum(one) for one in _best_of_files(spectra)),
        *(_of_vibration(one) for one in evidence.vibrations),
    )
    modes = match_modes(states)
    sources = (*evidence.responses, *evidence.spectra, *evidence.vibrations)
    found = Identified(
        evidence=evidence,
        rotary=any(one.rotary for one in sources),
        states=states,
        modes=modes,
        moving_mass=_over([state.moving_mass for state in states]),
        delay=_over([state.delay for state in states]),
        spread=find_spread(states, modes),
        warnings=tuple(message for one in sources for message in one.remarks),
    )
    return replace(found, warnings=(*found.warnings, *list_doubts(found)))


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
    groups = _pair_sensors(_group(responses))
    fits = [fit_state(group, band_hz=band_hz, count=count) for group in groups]
    if len(groups) < 2 or all(group[0].source.state for group in groups):
        return fits
    pooled = [response for group in groups for response in group]
    is_hammer = not any(one.has_rigid_body for fit in fits for one in fit.responses)
    if not is_hammer and not _agree(fits):
        return fits
    whole = fit_state(pooled, band_hz=band_hz, count=count)
    if is_hammer:
        return [_without_outliers(whole, pooled, band_hz, count)]
    return [whole] if len(whole.modes) >= max(len(fit.modes) for fit in fits) else fits


def _group(responses: Sequence[FrequencyResponse]) -> list[list[FrequencyResponse]]:
    groups: dict[str, list[FrequencyResponse]] = {}
    for one in responses:
        groups.setdefault(one.source.state or f"file {one.source.file}", []).append(one)
    return list(groups.values())


def _pair_sensors(groups: list[list[FrequencyResponse]]) -> list[list[FrequencyResponse]]:
    """Join the n-th group of encoders with the n-th of tool sensors where there are as many."""
    encoders = [group for group in groups if {one.sensor for one in group} == {Sensor.ENCODER}]
    tools = [group for group in groups if {one.sensor for one in group} == {Sensor.TCP}]
    if len(encoders) != len(tools) or len(encoders) + len(tools) != len(groups):
        return groups
    return [[*a, *b] for a, b in zip(encoders, tools, strict=True)]


def _agree(fits: Sequence[Fitted]) -> bool:
    """Whether all fits show the same poles within their errors."""
    return all(len(one.modes) == len(other.modes) for one, other in pairwise(fits)) and all(
        _same(a.frequency_hz, b.frequency_hz) and _same(a.damping_ratio, b.damping_ratio)
        for i, one in enumerate(fits)
        for other in fits[:i]
        for a, b in zip(one.modes, other.modes, strict=True)
    )


def _same(one: Estimate, other: Estimate) -> bool:
    return abs(one.value - other.value) <= SAME * float(np.hypot(one.sigma, other.sigma))


def _without_outliers(
    whole: Fitted,
    responses: Sequence[FrequencyResponse],
    band_hz: tuple[float, float] | None,
    count: int | None,
) -> Fitted:
    """Fit again without points that do not obey what the others show."""
    misfits = []
    for one in whole.responses:
        f = one.response.frequency_hz[one.is_used]
        measured = one.response.values[one.is_used]
        misfits.append(float(np.linalg.norm(one.model(f) - measured) / np.linalg.norm(measured)))
    typical = float(np.median(misfits))
    bad = [
        one.response
        for one, misfit in zip(whole.responses, misfits, strict=True)
        if len(misfits) > 2 and misfit > max(OUTLIER * typical, 0.5)
    ]
    if not bad:
        return whole
    kept = [one for one in responses if all(one is not other for other in bad)]
    again = fit_state(kept, band_hz=band_hz, count=count)
    notes = tuple(Message("identify-point-left-out", file=one.source.name) for one in bad)
    return replace(again, notes=(*again.notes, *notes))


def _best_of_files(spectra: Sequence[FittedSpectrum]) -> list[FittedSpectrum]:
    """Of the directions in one file, the one with the most power: that was shaken."""
    best: dict[str, FittedSpectrum] = {}
    for one in spectra:
        file = one.spectrum.source.file
        other = best.get(file)
        if one.modes and (other is None or _power(one) > _power(other)):
            best[file] = one
    return list(best.values())


def _power(one: FittedSpectrum) -> float:
    return float(one.spectrum.density[one.is_used].max())


def _of_fit(fit: Fitted) -> State:
    first = fit.responses[0].response.source
    files = dict.fromkeys(one.response.source.file for one in fit.responses)
    masses = [
        Estimate(
            value=1.0 / one.inverse_mass.value,
            sigma=one.inverse_mass.sigma / one.inverse_mass.value**2,
        )
        for one in sorted(fit.responses, key=lambda one: one.response.sensor is Sensor.TCP)
        if one.has_rigid_body
    ]
    delays = sorted(fit.responses, key=lambda one: one.response.sensor is Sensor.TCP)
    return State(
        name=first.state or ", ".join(files),
        modes=tuple(
            Seen(
                frequency_hz=mode.frequency_hz,
                damping_ratio=mode.damping_ratio,
                measured_gain=_gain(fit, k, Sensor.ENCODER),
                tcp_gain=_gain(fit, k, Sensor.TCP),
            )
            for k, mode in enumerate(fit.modes)
        ),
        moving_mass=masses[0] if masses else None,
        delay=delays[0].delay,
        result=fit,
    )


def _gain(fit: Fitted, mode: int, sensor: Sensor) -> Estimate | None:
    """The surest gain of a sensor; base-excited, with the sign of the profile."""
    found = [
        replace(gain, value=-gain.value) if one.response.input is Input.ACCELERATION else gain
        for one, gain in zip(fit.responses, fit.modes[mode].gains, strict=True)
        if one.response.sensor is sensor
    ]
    return min(found, key=lambda gain: gain.relative, default=None)


def _of_spectrum(one: FittedSpectrum) -> State:
    return State(
        name=one.spectrum.source.state or one.spectrum.source.name,
        modes=tuple(
            Seen(frequency_hz=peak.frequency_hz, damping_ratio=peak.damping_ratio)
            for peak in one.modes
        ),
        moving_mass=None,
        delay=None,
        result=one,
    )


def _of_vibration(one: FreeVibration) -> State:
    modes = sorted(one.modes, key=lambda mode: mode.frequency_hz)
    return State(
        name=one.source.state or one.source.name,
        modes=tuple(
            Seen(
                frequency_hz=Estimate(value=mode.frequency_hz, sigma=mode.frequency_sigma_hz),
                damping_ratio=Estimate(value=mode.damping_ratio, sigma=mode.damping_sigma),
            )
            for mode in modes
        ),
        moving_mass=None,
        delay=None,
        result=one,
    )


def match_modes(states: Sequence[State]) -> tuple[IdentifiedMode, ...]:
    """Return the modes of all states, each matched to the nearest in frequency.

    The state with most modes leads; modes that it does not have are added.

    Parameters
    ----------
    states
        Each with its modes by frequency.
    """
    order = sorted(range(len(states)), key=lambda i: -len(states[i].modes))
    chains: list[dict[int, int]] = []
    for i in order:
        modes = states[i].modes
        centres = [_centre(chain, states) for chain in chains]
        taken: set[int] = set()
        if modes and centres:
            cost = np.array(
                [[abs(log(c / mode.frequency_hz.value)) for mode in modes] for c in centres]
            )
            for row, column in zip(*linear_sum_assignment(np.minimum(cost, 1.0)), strict=True):
                if cost[row, column] < FARTHEST:
                    chains[row][i] = int(column)
                    taken.add(int(column))
        chains += [{i: k} for k in range(len(modes)) if k not in taken]
    chains.sort(key=lambda chain: _centre(chain, states))
    return tuple(
        _identified(f"mode{number}", chain, states) for number, chain in enumerate(chains, start=1)
    )


def _centre(chain: dict[int, int], states: Sequence[State]) -> float:
    logs = [log(states[i].modes[k].frequency_hz.value) for i, k in chain.items()]
    return float(np.exp(0.5 * (min(logs) + max(logs))))


def _identified(name: str, chain: dict[int, int], states: Sequence[State]) -> IdentifiedMode:
    seen = [states[i].modes[k] for i, k in chain.items()]
    frequency = _over([mode.frequency_hz for mode in seen])
    damping = _over([mode.damping_ratio for mode in seen])
    assert frequency is not None
    assert damping is not None
    return IdentifiedMode(
        name=name,
        frequency_hz=frequency,
        damping_ratio=damping,
        measured_gain=_over([mode.measured_gain for mode in seen]),
        tcp_gain=_over([mode.tcp_gain for mode in seen]),
        seen=tuple(chain.get(i) for i in range(len(states))),
    )


def _over(estimates: Sequence[Estimate | None]) -> Estimate | None:
    """Middle of some estimates; two standard errors reach the outermost."""
    known = [one for one in estimates if one is not None]
    if not known:
        return None
    low, high = min(one.value for one in known), max(one.value for one in known)
    typical = float(np.sqrt(np.mean([one.sigma**2 for one in known])))
    return Estimate(value=0.5 * (low + high), sigma=float(np.hypot(typical, 0.25 * (high - low))))


def find_spread(states: Sequence[State], modes: Sequence[IdentifiedMode]) -> Spread:
    """Return the spreads that the corners must hold: the worst mode, at least a floor.

    max(2 sigma, half of the range over the states, floor) by the middle, for each mode.
    """
    is_one = len(states) < 2
    frequency, why_frequency = _worst(
        states, modes, "frequency", FREQUENCY_FLOOR_OF_ONE if is_one else FREQUENCY_FLOOR
    )
    damping, why_damping = _worst(
        states, modes, "damping", DAMPING_FLOOR_OF_ONE if is_one else DAMPING_FLOOR
    )
    return Spread(frequency=frequency, damping=damping, because=(why_frequency, why_damping))


def _worst(
    states: Sequence[State], modes: Sequence[IdentifiedMode], what: str, floor: float
) -> tuple[float, Message]:
    spread = floor
    because = Message(f"identify-{what}-floor", floor=floor, states=len(states))
    for mode in modes:
        middle = mode.frequency_hz if what == "frequency" else mode.damping_ratio
        values = [
            (seen.frequency_hz if what == "frequency" else seen.damping_ratio)
            for state, k in zip(states, mode.seen, strict=True)
            if k is not None
            for seen in [state.modes[k]]
        ]
        low, high = min(one.value for one in values), max(one.value for one in values)
        by_range = (high - low) / (high + low)
        by_sigma = 2.0 * max(one.sigma for one in values) / middle.value
        if by_range > max(spread, by_sigma):
            because = Message(
                f"identify-{what}-range", mode=mode.name, low=low, high=high, states=len(values)
            )
        elif by_sigma > spread:
            because = Message(f"identify-{what}-sigma", mode=mode.name, spread=by_sigma)
        spread = max(spread, by_range, by_sigma)
    return STEP * ceil(spread / STEP - 1e-9), because


def list_doubts(found: Identified) -> tuple[Message, ...]:
    """Return what was chosen, left out, doubtful or not known, as advice for the next measurement.

    Parameters
    ----------
    found
        All but its warnings.
    """
    doubts = [note for fit in found.fits for note in fit.notes]
    for fit in found.fits:
        doubts += _of_polarity(fit) + _of_masses(fit) + _of_resolution(fit) + _of_misfit(fit)
    for mode in found.modes:
        missing = [
            state.name for state, k in zip(found.states, mode.seen, strict=True) if k is None
        ]
        if missing:
            doubts.append(
                Message("identify-mode-not-everywhere", mode=mode.name, states=", ".join(missing))
            )
    if not found.modes:
        doubts.append(Message("identify-no-mode"))
    if found.moving_mass is None:
        has_force = not found.is_base_excited
        doubts.append(Message("identify-no-rigid-body" if has_force else "identify-no-force"))
    else:
        doubts.append(Message("identify-friction-small-amplitude"))
        if not any(fit.has(Sensor.TCP) for fit in found.fits):
            doubts.append(Message("identify-no-tool-sensor", bound=1.0 / found.moving_mass.value))
    return tuple(dict.fromkeys(doubts))


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
                    "identify-window-too-short",
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
            doubts.append(Message("identify-no-coherence", file=one.response.source.name))
            continue
        share = float(np.mean(coherence[one.is_used] < 0.5))
        if share > 0.15:
            doubts.append(
                Message("identify-low-coherence", file=one.response.source.name, share=share)
            )
    return doubts
