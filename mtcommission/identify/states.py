"""Measurements -> states of the machine, the modes matched across them, and their spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from math import ceil, log
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.identify.fit import Fitted, FittedSpectrum, fit_state
from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.machine.machine import MOST_STATES
from mtcommission.measured.measurement import (
    Evidence,
    FreeVibration,
    FrequencyResponse,
    Sensor,
    Spectrum,
)
from mtcommission.record.identified import MeasuredStateEntry, SpreadEntry

FARTHEST = 0.25
"""Largest distance of one mode in two states that follow each other, in ln f (empirical): a bed at
24, 30 and 36 Hz with three payloads is one mode."""
FREQUENCY_FLOOR = 0.01
"""Least spread where several states were measured: the level alone shifts a mode by 0.8 %."""
FREQUENCY_FLOOR_OF_ONE = 0.03
"""Least spread where one state was measured: positions and payload are not in it (empirical)."""
DAMPING_FLOOR = 0.15
"""Least spread of damping where several states were measured (empirical)."""
DAMPING_FLOOR_OF_ONE = 0.3
"""Least spread of damping where one state was measured: that of a profile that states none."""
MOST_DAMPING = 0.95
"""Largest spread of damping: of a mode of which the lines show nothing but the frequency."""
APART = 3.0
"""Difference of two states in its standard errors from which each is judged by itself."""
STEP = 0.005
"""Spreads are rounded up to it."""
SAME = 3.0
"""Responses whose poles differ by less, in standard errors, are of one state."""
OUTLIER = 3.0
"""Model error of a point in the typical one beyond which it is left out."""
LARGEST_ERROR = 0.3
"""Model error that a point may have in any case [-]."""
Chain = dict[int, MeasuredMode]
"""One mode in each state where it was seen."""
_ESTIMATES = ("frequency_hz", "damping_ratio", "measured_gain", "tcp_gain")


def match_modes(
    states: Sequence[MeasuredStateEntry],
) -> tuple[list[MeasuredMode], list[MeasuredStateEntry]]:
    """Return the modes over all states, and the states with the modes named by them.

    The nearest two are one first, and never two of one state; states between lead from one to the
    other. Values are the middle of the states, with a standard error of at least a quarter of their
    range.
    """
    each = [(i, mode) for i, state in enumerate(states) for mode in state.modes]
    logs = [log(mode.frequency_hz.value) for _, mode in each]
    chains: list[Chain] = [{i: mode} for i, mode in each]  # of each mode
    pairs = ((abs(logs[a] - logs[b]), a, b) for a, b in combinations(range(len(each)), 2))
    for _, a, b in sorted(pair for pair in pairs if pair[0] < FARTHEST):
        one, other = chains[a], chains[b]
        if not one.keys() & other.keys():
            both = one | other
            chains = [both if own is one or own is other else own for own in chains]
    named: list[list[MeasuredMode]] = [[] for _ in states]
    found = []
    different = sorted({id(chain): chain for chain in chains}.values(), key=_centre)
    for number, chain in enumerate(different, start=1):
        seen = {i: replace(mode, name=f"mode{number}") for i, mode in chain.items()}
        for i, mode in seen.items():
            named[i].append(mode)
        values: dict[str, Any] = {
            key: middle_of([getattr(mode, key) for mode in seen.values()]) for key in _ESTIMATES
        }
        found.append(MeasuredMode(name=f"mode{number}", **values))
    return found, [replace(state, modes=own) for state, own in zip(states, named, strict=True)]


def _centre(chain: Chain) -> float:
    """Middle of a chain, in ln f."""
    logs = [log(mode.frequency_hz.value) for mode in chain.values()]
    return 0.5 * (min(logs) + max(logs))


def middle_of(estimates: Sequence[Estimate | None]) -> Estimate | None:
    """Middle of some estimates; two standard errors reach the outermost."""
    known = [one for one in estimates if one is not None]
    if not known:
        return None
    low, high = min(one.value for one in known), max(one.value for one in known)
    typical = float(np.sqrt(np.mean([one.sigma**2 for one in known])))
    return Estimate(value=0.5 * (low + high), sigma=typical + 0.25 * (high - low))


def find_spread(states: Sequence[MeasuredStateEntry], modes: Sequence[MeasuredMode]) -> SpreadEntry:
    """Return the spreads that the corners must hold: the worst mode, at least a floor.

    max(2 sigma, half of the range over the states, floor) by the middle, for each mode; without the
    range where the states differ so much that each is judged by itself.
    """
    n, apart = len(states), states_differ(states, modes)
    floors = {
        "frequency": FREQUENCY_FLOOR if n > 1 else FREQUENCY_FLOOR_OF_ONE,
        "damping": DAMPING_FLOOR if n > 1 else DAMPING_FLOOR_OF_ONE,
    }
    spreads, because = {}, []
    for kind, floor in floors.items():
        why = "identify-apart" if apart else "identify-floor"
        found = [(floor, Message(why, floor=floor, states=n))]
        for mode in modes:
            seen = [
                one.frequency_hz if kind == "frequency" else one.damping_ratio
                for state in states
                for one in state.modes
                if one.name == mode.name
            ]
            low, high = min(one.value for one in seen), max(one.value for one in seen)
            if not apart:
                by_range = (high - low) / (high + low)
                kind_of, count = f"identify-{kind}-range", len(seen)
                by_ends = Message(kind_of, mode=mode.name, low=low, high=high, states=count)
                found.append((by_range, by_ends))
            by_sigma = 2.0 * max(one.sigma for one in seen) / (0.5 * (low + high))
            because_of = Message("identify-sigma", mode=mode.name, spread=by_sigma)
            found.append((by_sigma, because_of))
        spread, message = max(found, key=lambda one: one[0])
        if kind == "damping" and spread > MOST_DAMPING:
            name, spread = message.values["mode"], MOST_DAMPING
            message = Message("identify-damping-unknown", mode=name, spread=spread)
        spreads[kind] = STEP * ceil(spread / STEP - 1e-9)
        because.append(message)
    return SpreadEntry(**spreads, because=because)


def is_assumed(why: Message, states: int) -> bool:
    """Return whether a spread, by what ``find_spread`` says of it, came from no measurement.

    That is the floor where one state alone was measured, or a damping that hardly shows.
    """
    is_floor = states <= 1 and why.kind == "identify-floor"
    return is_floor or why.kind == "identify-damping-unknown"


def states_differ(states: Sequence[MeasuredStateEntry], modes: Sequence[MeasuredMode]) -> bool:
    """Return whether a mode or the mass differs by more than its intervals: each is judged then."""
    if not 1 < len(states) <= MOST_STATES:
        return False
    masses = [state.moving_mass for state in states if state.moving_mass]
    seen = [mode for state in states for mode in state.modes]
    frequencies = ([one.frequency_hz for one in seen if one.name == mode.name] for mode in modes)
    return any(
        abs(one.value - other.value) > APART * float(np.hypot(one.sigma, other.sigma))
        for values in (masses, *frequencies)
        for one, other in combinations(values, 2)
    )


State = Fitted | FittedSpectrum | FreeVibration
"""What was found in one state of the machine."""


def find_states(
    evidence: Evidence, *, band_hz: tuple[float, float] | None = None, count: int | None = None
) -> list[State]:
    """Return what measurements show, state by state.

    Raise InputError if a response has too few lines in the band.
    """
    fits = fit_states(evidence.responses, band_hz=band_hz, count=count)
    spectra = [one for one in evidence.findings if isinstance(one, Spectrum)]
    vibrations = [one for one in evidence.findings if isinstance(one, FreeVibration)]
    return [*fits, *_fit_spectra(spectra), *vibrations]


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
    groups = _group(responses)
    fits = [fit_state(group, band_hz=band_hz, count=count) for group in groups]
    if len(groups) < 2 or all(group[0].source.state for group in groups):
        return fits
    is_hammer = not any(one.has_rigid_body for fit in fits for one in fit.responses)
    if not is_hammer and not all(_agree(*pair) for pair in combinations(fits, 2)):
        return fits
    failed = _failed(fits) if is_hammer else []
    kept = [group for group, fit in zip(groups, fits, strict=True) if fit not in failed]
    whole = fit_state([one for group in kept for one in group], band_hz=band_hz, count=count)
    if not is_hammer and len(whole.modes) < max(len(fit.modes) for fit in fits):
        return fits
    out = [one.response.source.name for fit in failed for one in fit.responses]
    notes = [Message("identify-point-left-out", file=name) for name in out]
    return [replace(whole, notes=(*whole.notes, *notes))]


def _failed(fits: Sequence[Fitted]) -> list[Fitted]:
    """Points of a hammer test that alone obey no model while most do."""
    errors = [fit.model_error if fit.modes else 1.0 for fit in fits]
    most = max(OUTLIER * float(np.median(errors)), LARGEST_ERROR)
    far = [fit for fit, error in zip(fits, errors, strict=True) if error > most]
    return far if len(fits) > 2 else []


def _group(responses: Sequence[FrequencyResponse]) -> list[list[FrequencyResponse]]:
    """By state or file; the n-th of encoders with the n-th of tools where there are as many."""
    by_state: dict[str, list[FrequencyResponse]] = {}
    for one in responses:
        by_state.setdefault(one.source.state or f"file {one.source.file}", []).append(one)
    groups = list(by_state.values())
    encoders, tools = (
        [group for group in groups if {one.sensor for one in group} == {sensor}]
        for sensor in (Sensor.ENCODER, Sensor.TCP)
    )
    if len(encoders) != len(tools) or len(encoders) + len(tools) != len(groups):
        return groups
    return [[*a, *b] for a, b in zip(encoders, tools, strict=True)]


def _agree(one: Fitted, other: Fitted) -> bool:
    """Whether two fits show the same poles within their errors."""
    return len(one.modes) == len(other.modes) and all(
        abs(x.value - y.value) <= SAME * float(np.hypot(x.sigma, y.sigma))
        for a, b in zip(one.modes, other.modes, strict=True)
        for x, y in ((a.frequency_hz, b.frequency_hz), (a.damping_ratio, b.damping_ratio))
    )


def describe_state(one: State) -> MeasuredStateEntry:
    """Return what was found in a state as the record holds it, its modes without names yet."""
    mass = None
    if isinstance(one, Fitted):
        source, mass = one.responses[0].response.source, one.moving_mass
        name = ", ".join(dict.fromkeys(own.response.source.file for own in one.responses))
    else:
        source = one.spectrum.source if isinstance(one, FittedSpectrum) else one.source
        name = source.name
    return MeasuredStateEntry(name=source.state or name, moving_mass=mass, modes=list(one.modes))


def _fit_spectra(spectra: Sequence[Spectrum]) -> list[FittedSpectrum]:
    """Of the directions in one file, the one with the most power: that was shaken."""
    if not spectra:
        return []
    from mtcommission.identify.peaks import fit_spectrum  # slow to load

    fitted = [one for one in map(fit_spectrum, spectra) if one.modes]
    fitted.sort(key=lambda one: float(one.spectrum.density[one.is_used].max()))
    loudest = {one.spectrum.source.file: one for one in fitted}
    files = dict.fromkeys(one.source.file for one in spectra)
    return [loudest[file] for file in files if file in loudest]
