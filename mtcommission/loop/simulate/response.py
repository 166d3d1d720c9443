"""A setpoint through the loop, judged by the project's definitions.

e(t) = TCP position - x_ref(t - τ); t_e ends the setpoint. Residual deviation: max |e| for
t >= t_e + τ. Settling time: the later of t_e + τ and the last time with |e| above the band.
Simulated at every velocity cycle until every closed-loop mode has decayed below 1 % of the
band at the tool, and below 1 % of what the tool still moves: a residual far within the band is
followed to its peak, too, and no further where that lasts. What takes longer than the horizon to
decay so far is settled if it can leave the band no more; else it is "not settled".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import spend
from mtcommission.loop.model.assembly import LiftedLoop, SampledLoop, advance_cycle
from mtcommission.loop.simulate.decay import find_decay
from mtcommission.loop.simulate.mean_force import rms_force, sum_free_force, window_shares
from mtcommission.machine.machine import Drive
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

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

LEAST_SIZE = 1e-6
"""Free motion below this share of the band is not followed to its own end: picometres."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopResponse:
    """What the machine does with a setpoint.

    Parameters
    ----------
    t
        Every velocity cycle, shape (n_samples,) [s].
    deviation
        e, shape (n_samples,) [m].
    force
        F_set, shape (n_samples,) [N].
    states
        Plant states, shape (n_samples, n).
    t_end
        t_e + τ [s].
    settling_time
        [s]; inf means "not settled".
    residual_deviation, peak_deviation
        [m]; residual inf if the response may leave the band even after the horizon.
    contour_deviation
        Largest |e| along the path [m]: its own peak, unless contours are followed more slowly.
    mode_amplitudes
        Amplitude of each plant mode at the tool at t_e + τ, about its quasi-static
        deflection, shape (n_modes,) [m].
    peaks
        Largest magnitude of each of ``Plant.signals``.
    max_force
        Largest |F_set| that the loop asks for, saturation apart [N].
    rms_force
        Motor force over [0, t_e + dwell], static load included in its worse direction [N].
    saturated
        Whether it asks for more than the force limit; the motion shown is then the saturated one.
    tool_noise, force_noise
        What the steps of the encoder add to the tool's position and to F_set, where that was
        looked at [m, N]; in none of the values above.
    """

    t: Array
    deviation: Array
    force: Array
    states: Array
    t_end: float
    settling_time: float
    residual_deviation: float
    peak_deviation: float
    contour_deviation: float
    mode_amplitudes: Array
    peaks: Array
    max_force: float
    rms_force: float
    saturated: bool
    tool_noise: float = 0.0
    force_noise: float = 0.0


def simulate(loop: SampledLoop, setpoint: Setpoint, *, drive: Drive, band: float) -> LoopResponse:
    """Return the response to a setpoint, at rest before it.

    Parameters
    ----------
    loop
        Under its controller.
    setpoint
        From t = 0, in step with a position cycle.
    drive
        Force limit and static load.
    band
        tcp_deviation of the requirements [m].
    """
    tau = loop.controller.reference_delay
    until = setpoint.duration + tau
    motion = _run_linear(loop, setpoint, until=until, band=band)
    max_force = float(np.max(np.abs(motion.outputs[:, 2])))
    saturated = max_force > drive.motion_force * (1.0 + ROUNDING)
    # A motor that follows does not saturate: it loses steps, and no motion could be shown.
    if saturated and not loop.controller.follows:
        motion = _run_saturated(loop, setpoint, limit=drive.motion_force, until=until, band=band)
    outputs, decayed = motion.outputs, motion.decayed
    t: Array = np.arange(len(outputs), dtype=np.float64) * loop.controller.velocity_cycle
    reference = sample_setpoint(setpoint, t - tau)[:, 0]
    deviation = outputs[:, 0] - reference
    states = outputs[:, 3:]
    signals = np.hstack([states, states @ loop.plant.C.T])
    after = t >= until - 1e-12
    begin = int(np.argmax(after))
    # The judgement begins between two samples: there the tool is interpolated against the
    # setpoint that by then rests or coasts.
    end, speed = sample_setpoint(setpoint, np.array([setpoint.duration]))[0, :2]
    before = outputs[begin - 1, 0] - end - speed * (t[begin - 1] - until)
    share = (until - t[begin - 1]) / (t[begin] - t[begin - 1])
    at_end = before + share * (deviation[begin] - before)
    judged_t = np.concatenate([[until], t[begin:]])
    judged = np.abs(np.concatenate([[at_end], deviation[begin:]]))
    peak = float(np.max(np.abs(deviation)))
    return LoopResponse(
        t=t,
        deviation=deviation,
        force=outputs[:, 2].copy(),  # a view would keep all outputs
        states=states,
        t_end=until,
        settling_time=_settling_time(judged_t, judged, band) if decayed else inf,
        residual_deviation=float(np.max(judged)) if decayed else inf,
        peak_deviation=peak,
        contour_deviation=peak,
        mode_amplitudes=_mode_amplitudes(loop, states[begin]),
        peaks=np.max(np.abs(signals), axis=0),
        max_force=max_force,
        rms_force=_rms_force(loop, motion, setpoint, drive.static_load),
        saturated=saturated,
    )


def steady_state(lifted: LiftedLoop) -> Array:
    """Return the loop state that belongs to rest or coasting, shape (n, 2).

    X = result @ (x_ref, v_ref) solves X⁺ = A X + B r with x_ref⁺ = x_ref + T_p v_ref.

    Parameters
    ----------
    lifted
        A stable loop.
    """
    eye = np.eye(len(lifted.A))
    at_rest = np.linalg.solve(eye - lifted.A, lifted.B[:, 0])
    coasting = np.linalg.solve(eye - lifted.A, lifted.B[:, 1] - lifted.dt * at_rest)
    return np.column_stack([at_rest, coasting])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Motion:
    """What was simulated.

    Parameters
    ----------
    outputs
        At every velocity cycle, shape (n_samples, n_outputs).
    decayed
        Whether the free motion can leave the band no more.
    left
        Loop state less that of rest or coasting after the last sample, shape (n,).
    """

    outputs: Array
    decayed: bool
    left: Array


def _run_linear(loop: SampledLoop, setpoint: Setpoint, *, until: float, band: float) -> _Motion:
    lifted = loop.lifted
    first = ceil(until / lifted.dt) + 1
    X, moving = _advance_linear(lifted, np.zeros(len(lifted.A)), setpoint, 0, first)
    free = _run_free(loop, X, setpoint, start=first, band=band)
    outputs = np.vstack([moving.reshape(-1, len(loop.outputs)), free.outputs])
    return replace(free, outputs=outputs)


def _run_saturated(
    loop: SampledLoop, setpoint: Setpoint, *, limit: float, until: float, band: float
) -> _Motion:
    """The same with saturation, cycle by cycle, until the free motion stays within the limit."""
    lifted = loop.lifted
    X = np.zeros((len(lifted.A), 1))
    pieces: list[Array] = []
    stop, k = ceil(until / lifted.dt) + 1, 0
    last = stop + ceil(HORIZON / lifted.dt)
    while k < last:
        references = sample_setpoint(setpoint, np.arange(k, stop, dtype=np.float64) * lifted.dt)
        for r in references:
            X, Y = advance_cycle(loop, X, r[:, None], force_limit=limit)
            pieces.append(Y[:, :, 0])
        free = _run_free(loop, X[:, 0], setpoint, start=stop, band=band)
        if np.max(np.abs(free.outputs[:, 2])) <= limit:
            return replace(free, outputs=np.vstack([*pieces, free.outputs]))
        k, stop = stop, min(2 * stop, last)
    return _Motion(outputs=np.vstack(pieces), decayed=False, left=np.zeros(len(lifted.A)))


def _run_free(
    loop: SampledLoop, X: Array, setpoint: Setpoint, *, start: int, band: float
) -> _Motion:
    """The motion from a cycle on until all modes have decayed."""
    lifted = loop.lifted

    def transient(X: Array, cycle: int) -> Array:
        reference = sample_setpoint(setpoint, np.array([cycle * lifted.dt]))[0]
        return np.asarray(X - steady_state(lifted) @ reference[:2])

    def size_of(outputs: Array, cycle: int) -> float:
        tool = outputs.reshape(-1, len(loop.outputs))[:, 0]
        own: Array = np.arange(len(tool), dtype=np.float64) * loop.controller.velocity_cycle
        delayed = cycle * lifted.dt + own - loop.controller.reference_delay
        return float(np.max(np.abs(tool - sample_setpoint(setpoint, delayed)[:, 0])))

    decay = find_decay(lifted, transient(X, start))
    until = decay.cycles(DECAYED * band, longest=HORIZON)
    is_lost = until * lifted.dt > HORIZON and decay.left(until) > band
    usual = ceil(FOLLOWED / lifted.dt)
    done, stop, size, pieces = 0, min(until, usual), LEAST_SIZE * band, []
    while True:
        X, outputs = _advance_linear(lifted, X, setpoint, start + done, start + stop)
        pieces.append(outputs)
        size, done = max(size, size_of(outputs, start + done)), stop
        if until * lifted.dt <= HORIZON:
            until = max(until, decay.cycles(DECAYED * size, longest=HORIZON))
        # No later swing is larger, and none leaves the band.
        is_seen = decay.left(done) <= min(band, size)
        if done >= until or (done >= usual and (is_seen or is_lost)):
            break
        stop = min(until, max(usual, 2 * done))
    return _Motion(
        outputs=np.vstack(pieces).reshape(-1, len(loop.outputs)),
        decayed=is_seen or until * lifted.dt <= HORIZON,
        left=transient(X, start + done),
    )


def _advance_linear(
    lifted: LiftedLoop, X: Array, setpoint: Setpoint, start: int, stop: int
) -> tuple[Array, Array]:
    """Loop state at cycle ``stop`` and the lifted outputs of all cycles before it."""
    values = (stop - start) * 0.25 * (lifted.A.size + lifted.C.size + 500.0)
    spend(values, calls=0.25 * (stop - start))
    times = np.arange(start, stop, dtype=np.float64) * lifted.dt
    references = sample_setpoint(setpoint, times)
    drive = references @ lifted.B.T
    history = np.empty((len(references), len(X)))
    for k, pushed in enumerate(drive):
        history[k] = X
        X = lifted.A @ X + pushed
    return X, history @ lifted.C.T + references @ lifted.D.T


def _settling_time(t: Array, deviation: Array, band: float) -> float:
    """Last crossing into the band, of samples that begin at t_e + τ."""
    outside = np.flatnonzero(deviation > band)
    if not outside.size:
        return float(t[0])
    last = int(outside[-1])
    if last == len(t) - 1:
        return inf
    here, following = deviation[last], deviation[last + 1]
    return float(t[last] + (t[last + 1] - t[last]) * (here - band) / (here - following))


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


def _rms_force(loop: SampledLoop, motion: _Motion, setpoint: Setpoint, static_load: float) -> float:
    """RMS over [0, t_e + dwell]."""
    step, cycles = loop.controller.velocity_cycle, loop.controller.cycles
    force, window = motion.outputs[:, -1], setpoint.duration + setpoint.move.dwell
    times: Array = step * np.arange(len(force), dtype=np.float64)
    share = window_shares(times, window, step=step)
    left = np.array([window - step * len(force)])
    after = sum_free_force(loop.lifted, motion.left[:, None], left, cycles=cycles)
    return float(
        rms_force(
            share @ force + after.first,
            share @ force**2 + after.square,
            window=window,
            static_load=static_load,
        )[0]
    )
