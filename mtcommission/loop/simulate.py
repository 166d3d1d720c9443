"""A setpoint through the loop, judged by the project's definitions.

e(t) = TCP position - x_ref(t - τ); t_e ends the setpoint. Residual deviation: max |e| for
t >= t_e + τ. Settling time: the later of t_e + τ and the last time with |e| above the band.
At every velocity cycle, in long stretches without a step at evenly spread ones, until every
closed-loop mode has decayed below 1 % of the band at the tool, and below 1 % of what the tool still
moves: a residual far within the band is followed to its peak, too, and no further where that lasts.
What takes longer than the horizon to decay so far is settled
if it can leave the band no more; else it is "not settled". By poles (``loop.free_motion``); stepped
where the force saturates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.free_motion import free_motion, last_crossing, lay_grid
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.motions import OUTPUTS, Motions, outputs_at, set_in_motion
from mtcommission.loop.nonlinear import step_linear, step_through
from mtcommission.loop.poles import Cycles, LoopPoles, find_poles
from mtcommission.machine.machine import Drive
from mtcommission.setpoint.setpoint import Setpoint, knots_of, sample_setpoint

Array = NDArray[np.float64]

DECAYED = 0.01
"""Share of the band, and of the motion itself, below which a mode counts as gone (the project's
definition)."""

HORIZON = 10.0
"""A response that may still leave the band this long after t_e is "not settled" [s] (empirical:
no commissioning engineer waits longer)."""

FOLLOWED = 2.0
"""Free motion is followed no longer than that once what is still to come can neither leave the band
nor exceed what was seen, or leaves it beyond the horizon in any case [s]."""

ROUNDING = 1e-9
"""Relative excess over the force limit that is none."""

SAMPLES = 24
"""Instants to a period at which the size of what is followed is looked at: to 1 %."""

LEAST_SIZE = 1e-6
"""Free motion below this share of the band is not followed to its own end: picometres."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopResponse:
    """What the machine does with a setpoint."""

    setpoint: Setpoint
    t: Array  # velocity cycles looked at: nearly always every one, shape (n_samples,) [s]
    deviation: Array  # e, shape (n_samples,) [m]
    force: Array  # F_set, shape (n_samples,) [N]
    states: Array  # of the plant, shape (n_samples, n)
    t_end: float  # t_e + τ [s]
    settling_time: float  # [s]; inf means "not settled"
    residual_deviation: float  # [m]; inf if it may leave the band even after the horizon
    peak_deviation: float  # [m]
    mode_amplitudes: Array
    """Of each mode at the tool at t_e + τ, about its quasi-static deflection, (n_modes,) [m]."""
    peaks: Array  # largest magnitude of each of ``Plant.signals``
    max_force: float  # largest |F_set| that the loop asks for, saturation apart [N]
    rms_force: float
    """Motor force over [0, t_e + dwell], static load included in its worse direction [N]."""
    saturated: bool
    """Whether it asks for more than the force limit; the motion shown is then the saturated one."""


def simulate(loop: SampledLoop, setpoint: Setpoint, *, drive: Drive, band: float) -> LoopResponse:
    """Return the response to a setpoint, at rest before it, that begins with a position cycle."""
    return simulate_corners((loop,), setpoint, drive=drive, band=band)[0]


def simulate_corners(
    loops: Sequence[SampledLoop], setpoint: Setpoint, *, drive: Drive, band: float
) -> list[LoopResponse]:
    """Return the response of the same controller on several machines; see ``simulate``.

    ``drive``: force limit and static load; ``band``: tcp_deviation of the requirements [m].
    """
    poles = find_poles(tuple(loops))
    motions = set_in_motion(poles, knots_of(setpoint))
    first = ceil((setpoint.duration + poles.delay) / poles.dt) + 1
    count, decayed = _follow(poles, motions, first, band=band)
    n = _looked_at(motions, first, first + count)
    outputs = np.empty((len(loops), len(n) * poles.cycles, poles.outputs))
    rows = np.eye(poles.outputs)
    for start in range(0, len(n), TOGETHER):
        some = n[start : start + TOGETHER]
        part = slice(start * poles.cycles, (start + len(some)) * poles.cycles)
        found = outputs_at(motions, some[None], rows)[0]
        outputs[:, part] = found.reshape(len(loops), -1, poles.outputs)
    max_force = np.max(np.abs(outputs[:, :, 2]), axis=1)
    saturated = max_force > drive.motion_force * (1.0 + ROUNDING)
    # An open-loop axis does not saturate: it loses steps, and no motion could be shown.
    is_steppable = not loops[0].controller.follows and first * poles.cycles <= STEPPED
    stepped = np.flatnonzero(saturated & is_steppable).tolist()
    limited = _step_saturated([loops[i] for i in stepped], setpoint, drive.motion_force, band)
    instead = dict(zip(stepped, limited, strict=True))
    linear = _watch(setpoint, poles, n)
    longest = max((len(own) for own, _ in limited), default=0)
    every = _watch(setpoint, poles, np.arange(longest // poles.cycles)) if longest else linear
    responses = []
    for corner, loop in enumerate(loops):
        asked, beyond = float(max_force[corner]), bool(saturated[corner])
        settles = bool(decayed[corner]) and not (beyond and not loops[0].controller.follows)
        own, settles = instead.get(corner, (outputs[corner], settles))
        at = every.begin(len(own) // poles.cycles) if corner in instead else linear
        found = _judge(loop, setpoint, at, own, settles=settles, drive=drive, band=band)
        responses.append(replace(found, max_force=asked, saturated=beyond))
    return responses


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Watched:
    """Cycles that are looked at, the same for all corners."""

    n: Cycles  # position cycles
    t: Array  # velocity cycles in them, (n, cycles) [s]
    late: Array  # position of the delayed setpoint then, (n, cycles) [m]

    def begin(self, count: int) -> _Watched:
        return _Watched(n=self.n[:count], t=self.t[:count], late=self.late[:count])


def _watch(setpoint: Setpoint, poles: LoopPoles, n: Cycles) -> _Watched:
    t = np.asarray((n[:, None] * poles.cycles + np.arange(poles.cycles)) * poles.velocity_cycle)
    late = sample_setpoint(setpoint, t.ravel() - poles.delay)[:, 0]
    return _Watched(n=n, t=t, late=late.reshape(t.shape))


TOGETHER = 200
"""Position cycles that are computed at once: keeps them in the cache."""


STEPPED = 80_000
"""Velocity cycles of a move that are stepped at most, and as many after it: ten seconds at 125 us.
A longer one that saturates is shown without that, and does not settle (empirical)."""

LOOKED_AT = 4000
"""Velocity cycles after each step of the setpoint that are all looked at, and of the rest until the
next one, evenly spread: half a second each at 125 us, so that no move makes many (empirical)."""


def _looked_at(motions: Motions, first: int, last: int) -> Cycles:
    """Position cycles that are looked at, from one on for longer after the setpoint's end."""
    poles = motions.poles
    steps = np.minimum(motions.first[0], first)
    ends = np.unique(np.concatenate([[0], steps, [first, last]])).tolist()
    parts = []
    for start, stop in pairwise(ends):
        every = FOLLOWED / poles.dt if start == first else LOOKED_AT / poles.cycles
        dense = min(start + ceil(every), stop)
        rest = min(stop - dense, ceil(LOOKED_AT / poles.cycles))
        parts += [np.arange(start, dense), np.linspace(dense, stop, rest, endpoint=False)]
    return np.concatenate(parts).astype(np.int64)


def _follow(
    poles: LoopPoles, motions: Motions, first: int, *, band: float
) -> tuple[int, NDArray[np.bool_]]:
    """How many cycles from one on are followed, and where the tool can leave the band no more."""
    usual, horizon = ceil(FOLLOWED / poles.dt), ceil(HORIZON / poles.dt)
    if not poles.factors.size:
        return min(poles.recent, horizon), np.ones(len(poles.loops), dtype=bool)
    begun = first - motions.first[:, -1] - poles.recent
    modal = motions.modal[-1, 0] * poles.power(np.maximum(begun, 0))[0]
    sizes = np.abs(poles.shapes[:, :, 0]).max(axis=1) * np.abs(modal)  # (n_corners, n_poles)
    radii = np.maximum(np.abs(poles.factors), 1e-9)
    residual = free_motion(motions, lay_grid(poles, SAMPLES)).residual[0]
    size = np.minimum(np.maximum(residual, LEAST_SIZE * band), band)
    longest, settles = 0, np.ones(len(radii), dtype=bool)
    # Cycles until every mode is below a share of that size; a pole outside the circle never is.
    small = DECAYED * size[:, None]
    decay = np.log(np.maximum(sizes / small, 1.0)) / -np.log(np.minimum(radii, 1.0 - 1e-15))
    wanted = np.minimum(decay.max(axis=1) + 1.0, horizon).astype(int).tolist()
    for corner, (amplitude, radius) in enumerate(zip(sizes, radii, strict=True)):
        needed = wanted[corner]
        settles[corner] = float(np.sum(amplitude * radius**horizon)) <= band or needed < horizon
        if needed > usual and settles[corner]:
            # No later swing is larger, and none leaves the band.
            left = np.sum(amplitude * radius ** np.arange(horizon + 1)[:, None], axis=1)
            seen = int(np.argmax(left <= size[corner]))
            needed = max(usual, min(seen or horizon, needed))
        longest = max(longest, needed if settles[corner] else usual)
    return longest, settles


def _step_saturated(
    loops: Sequence[SampledLoop], setpoint: Setpoint, limit: float, band: float
) -> list[tuple[Array, bool]]:
    """Outputs with saturation, stepped until the free motion stays within the limit in each loop.

    And whether the tool can leave the band no more when they end.
    """
    if not loops:
        return []
    T, delay = loops[0].lifted.dt, loops[0].controller.reference_delay
    X = np.zeros((len(loops), len(loops[0].lifted.A)))
    pieces: list[Array] = []
    k, stop = 0, ceil((setpoint.duration + delay) / T) + 1
    last = stop + min(ceil(HORIZON / T), STEPPED // loops[0].controller.cycles)
    found: dict[int, tuple[Array, bool]] = {}
    while k < last and len(found) < len(loops):
        references = sample_setpoint(setpoint, np.arange(k, stop, dtype=np.float64) * T)
        X, Y = step_through(loops, X, references, force_limit=limit)
        pieces.append(Y)
        moved = np.concatenate(pieces, axis=1)
        later = np.arange(stop, stop + ceil(FOLLOWED / T), dtype=np.float64) * T
        for i, loop in enumerate(loops):
            if i in found:
                continue
            free = step_linear(loop, X[i], sample_setpoint(setpoint, later))
            if np.max(np.abs(free[:, 2])) > limit:
                continue
            end = stop * T + (len(free) - 1) * loop.controller.velocity_cycle
            late = sample_setpoint(setpoint, np.array([end - delay]))[0, 0]
            rests = abs(float(free[-1, 0] - late)) <= band
            found[i] = np.vstack([moved[i], free]), rests
        k, stop = stop, min(2 * stop, last)
    return [found.get(i, (moved[i], False)) for i in range(len(loops))]


def _judge(
    loop: SampledLoop,
    setpoint: Setpoint,
    watched: _Watched,
    outputs: Array,
    *,
    settles: bool,
    drive: Drive,
    band: float,
) -> LoopResponse:
    tau = loop.controller.reference_delay
    until = setpoint.duration + tau
    cycles, T_v, t = loop.controller.cycles, loop.controller.velocity_cycle, watched.t.ravel()
    deviation, states = outputs[:, 0] - watched.late.ravel(), outputs[:, OUTPUTS:]
    signals = (states, states @ loop.plant.C.T)
    begin = int(np.argmax(t >= until - 1e-12))
    # The judgement begins between two samples: there the tool is interpolated against the
    # setpoint that by then rests or coasts.
    end, speed = sample_setpoint(setpoint, np.array([setpoint.duration]))[0, :2]
    before = outputs[begin - 1, 0] - end - speed * (t[begin - 1] - until)
    share = (until - t[begin - 1]) / (t[begin] - t[begin - 1])
    at_end = before + share * (deviation[begin] - before)
    judged = np.abs(np.concatenate([[at_end], deviation[begin:]]))
    settling = until
    if settles and np.max(judged) > band:
        at = np.concatenate([[until], t[begin:]])
        settling = float(last_crossing(at, judged[None], band, begin=at[:1])[1][0])
    peak, window = float(np.max(np.abs(deviation))), setpoint.duration + setpoint.move.dwell
    shares, motor = (
        window_shares(watched.n, window, step=T_v, cycles=cycles).ravel(),
        outputs[:, -1],
    )
    rms = rms_force(
        np.array(shares @ motor),
        np.array(shares @ motor**2),
        window=window,
        static_load=drive.static_load,
    )
    return LoopResponse(
        setpoint=setpoint,
        t=t,
        deviation=deviation,
        force=outputs[:, 2].copy(),  # a view would keep all outputs
        states=states,
        t_end=until,
        settling_time=settling if settles else inf,
        residual_deviation=float(np.max(judged)) if settles else inf,
        peak_deviation=peak,
        mode_amplitudes=_mode_amplitudes(loop, states[begin]),
        peaks=np.concatenate([np.abs(part).max(axis=0) for part in signals]),
        max_force=float(np.max(np.abs(outputs[:, 2]))),
        rms_force=float(rms),
        saturated=False,
    )


def _mode_amplitudes(loop: SampledLoop, state: Array) -> Array:
    """Amplitude of each mode's free vibration from this state on, at the tool [m]."""
    force = state[loop.plant.force]
    amplitudes = []
    for mode in loop.plant.modes:
        zeta, omega = mode.damping_ratio, mode.natural_frequency
        q = state[mode.deflection] / mode.scale - force / omega**2
        rate = state[mode.rate] / mode.scale
        quadrature = (rate + zeta * omega * q) / (omega * sqrt(1.0 - zeta**2))
        amplitudes.append(abs(mode.tcp_gain) * sqrt(q**2 + quadrature**2))
    return np.array(amplitudes)


def window_shares(n: Cycles, window: float, *, step: float, cycles: int) -> Array:
    """Return how much of a window from t = 0 on each velocity cycle stands for [s], (n, cycles).

    Of some position cycles ``n``, each standing for those until the next one; ``step``: a velocity
    cycle [s]. The window may end between two of them; it cuts the last one.

    Examples
    --------
    >>> window_shares(np.arange(4), 1.7, step=1.0, cycles=1).ravel()
    array([1. , 1. , 0.2, 0. ])
    """
    left = window / step - (n[:, None] * cycles + np.arange(cycles))
    return np.asarray(step * np.clip(left + 0.5, 0.0, 1.0) * np.gradient(n.astype(float))[:, None])


def rms_force(first: Array, square: Array, *, window: Array | float, static_load: float) -> Array:
    """Return the RMS force over a window [s], the static load in its worse direction [N].

    Of the integrals of force and square over it; the motion may go either way against the load.

    Examples
    --------
    >>> round(float(rms_force(np.array(2.0), np.array(8.0), window=2.0, static_load=-1.0)), 6)
    2.645751
    """
    load = abs(static_load)
    return np.asarray(np.sqrt(square / window + load**2 + 2.0 * load * np.abs(first / window)))
