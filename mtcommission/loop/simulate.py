"""A setpoint through the loop, judged by the project's definitions.

e(t) = TCP position - x_ref(t - τ); t_e ends the setpoint. Residual deviation: max |e| for
t >= t_e + τ. Settling time: the later of t_e + τ and the last time with |e| above the band.
At every velocity cycle, in long stretches without a step at evenly spread ones, until every
closed-loop mode has decayed below 1 % of the band at the tool, and below 1 % of what the tool still
moves: a residual far within the band is followed to its peak, too, and no further where that lasts.
What takes longer than the horizon to decay so far is settled
if it can leave the band no more; else it is "not settled". By poles (``loop.respond``); stepped
where the force saturates.

Friction on the line of the drive is a law between force and velocity over one cycle:

    F = -F_c sign(v) - d v,   |F| <= F_c at rest

v is the velocity between motor and guide, i.e. that of the encoder. The law is solved at the end
of the cycle together with the motion (time stepping after Moreau): the force of the cycle is the
one with which the velocity obeys the law, or stops. So the axis sticks exactly, at any cycle, and
without the slope at zero velocity of a tanh model, which lets a loaded axis creep.

Source: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, CISM 302,
1988; D. Karnopp, ASME J. Dyn. Sys. 107 (1985) 100-103 for stick as a state of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop, discretise_disturbance
from mtcommission.loop.poles import Cycles, LoopPoles, find_poles
from mtcommission.loop.respond import (
    FORCE,
    OUTPUTS,
    TOOL,
    Motions,
    free_motion,
    last_crossing,
    lay_grid,
    outputs_at,
    set_in_motion,
)
from mtcommission.machine.drive import Drive
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.setpoint import Setpoint, knots_of, sample_setpoint

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Friction:
    """Friction of a plant over one velocity cycle."""

    coulomb: float  # F_c [N]
    viscous: float  # d [N s/m]
    velocity: Array  # that rubs, as a row over the plant's states, shape (n,)
    push: Array  # what 1 N over the cycle adds to the state, shape (n,)

    def force(self, free: Array) -> Array:
        """Return the force of the cycle, of plant states at its end without friction, (n, m)."""
        v, gain = self.velocity @ free, float(self.velocity @ self.push)
        sliding = (v - np.sign(v) * gain * self.coulomb) / (1.0 + gain * self.viscous)
        after = np.where(np.abs(v) <= gain * self.coulomb, 0.0, sliding)
        return np.asarray((after - v) / gain)


def find_friction(plant: Plant, *, coulomb: float, viscous: float, step: float) -> Friction | None:
    """Return the friction of a plant over a velocity cycle [s]; None where there is none."""
    if coulomb == 0.0 and viscous == 0.0:
        return None
    return Friction(
        coulomb=coulomb,
        viscous=viscous,
        velocity=plant.row("encoder") @ plant.A,
        push=discretise_disturbance(plant, step),
    )


def step_through(
    loops: Sequence[SampledLoop],
    X: Array,
    references: Array,
    *,
    force_limit: float,
    friction: Friction | None = None,
) -> tuple[Array, Array]:
    """Return the same controller on several machines some position cycles later, and its outputs.

    The set force saturates at ``force_limit`` [N], and the integrator stands still meanwhile.
    ``X``: states, shape (n_loops, n); ``references``: x_ref, v_ref, a_ref, j_ref at each position
    cycle, shape (n_cycles, 4); ``friction``: of the one plant. The outputs at every velocity cycle
    have the shape (n_loops, n_samples, n_outputs).
    """
    first = loops[0]
    z, held, own, seen = first.integrator, first.held, first.own_size, len(first.outputs)
    rows = np.array([loop.rows for loop in loops])
    # What is handed down by the encoder differs from machine to machine.
    handing = np.array([loop.handed_down for loop in loops])
    outputs = np.empty((len(loops), len(references), first.controller.cycles, seen))
    size, lifted = X.shape[1], [loop.lifted for loop in loops]
    # State after a position cycle, and outputs during it, over state and references.
    whole = np.array([np.block([[one.A, one.B], [one.C, one.D]]) for one in lifted])
    # Pending forces of a position cycle, in what ``whole`` makes of it.
    pending = size + seen * np.arange(1, first.controller.cycles) + FORCE
    forces = np.append(z + 1, pending)
    entering = np.empty((len(loops), size + references.shape[1], 1))
    for k, r in enumerate(np.tile(references[:, None], (1, len(loops), 1))):
        entering[:, :size, 0], entering[:, size:, 0] = X, r
        # A position cycle in which nothing saturates or rubs is one product.
        Y = (whole @ entering)[:, :, 0]
        if friction is None and np.abs(Y[:, forces]).max() <= force_limit:
            outputs[:, k], X = Y[:, size:].reshape(outputs[:, k].shape), Y[:, :size]
            continue
        handed_down = (handing @ entering)[:, :, 0]
        for i in range(first.controller.cycles):
            Y = (rows @ X[:, :, None])[:, :, 0]
            outputs[:, k, i] = Y[:, :seen]
            demand, increment, X = Y[:, seen], Y[:, seen + 1], Y[:, seen + 2 :]
            force = np.minimum(np.maximum(demand, -force_limit), force_limit)
            X[:, z] += np.where(force == demand, increment, 0.0)
            X[:, z + 1] = force
            if friction:
                rubbed = X[:, : first.plant.order]
                rubbed += np.outer(friction.force(rubbed.T), friction.push)
        X = np.hstack([X[:, :held], handed_down, r, X[:, own:]])[:, : X.shape[1]]
    return X, outputs.reshape(len(loops), -1, seen)


def step_linear(loop: SampledLoop, X: Array, references: Array) -> Array:
    """Return the outputs at every velocity cycle without saturation, from a state on, (n, n_out).

    ``references``: at each position cycle, shape (n_cycles, 4).
    """
    lifted = loop.lifted
    states = _march(lifted.A, X, references @ lifted.B.T)
    outputs = states @ lifted.C.T + references @ lifted.D.T
    return np.asarray(outputs.reshape(-1, len(loop.outputs)))


def _march(A: Array, X: Array, pushes: Array) -> Array:
    """The states X⁺ = A X + push, the first one included, shape of ``pushes``."""
    # In blocks side by side, each from rest; what each begins with is added afterwards.
    n, length = len(A), ceil(sqrt(len(pushes)))
    blocks = ceil(len(pushes) / length)
    padded = np.zeros((blocks * length, n))
    padded[: len(pushes)] = pushes
    pushed = padded.reshape(blocks, length, n)
    from_rest, powers = np.zeros((length + 1, blocks, n)), np.empty((length + 1, n, n))
    powers[0] = np.eye(n)
    for k in range(length):
        from_rest[k + 1] = from_rest[k] @ A.T + pushed[:, k]
        powers[k + 1] = A @ powers[k]
    begins = np.empty((blocks, n))
    for k in range(blocks):
        begins[k] = X
        X = powers[-1] @ X + from_rest[-1, k]
    states = from_rest[:-1] + begins @ powers[:-1].transpose(0, 2, 1)
    return np.asarray(states.swapaxes(0, 1).reshape(-1, n)[: len(pushes)])


def drive_loop(
    loop: SampledLoop,
    references: Array,
    *,
    force_limit: float = inf,
    friction: Friction | None = None,
) -> Array:
    """Return the outputs at every velocity cycle of any setpoint, at rest before it, (n, n_out).

    ``references``: at each position cycle, shape (n_cycles, 4); ``force_limit``: of the set force
    [N]; ``friction``: of the loop's plant.
    """
    rest = np.zeros(len(loop.states))
    if friction is None:
        outputs = step_linear(loop, rest, references)
        if float(np.max(np.abs(outputs[:, 2]))) <= force_limit:
            return outputs
    _, stepped = step_through(
        (loop,), rest[None], references, force_limit=force_limit, friction=friction
    )
    return np.asarray(stepped[0])


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
    motions, limit = set_in_motion(poles, knots_of(setpoint)), drive.motion_force
    first, cycles = ceil((setpoint.duration + poles.delay) / poles.dt) + 1, poles.cycles
    count, decayed = _follow(poles, motions, first, band=band)
    n = _looked_at(motions, first, first + count)
    outputs = np.empty((len(loops), len(n) * cycles, poles.outputs))
    for start in range(0, len(n), TOGETHER):
        some = n[start : start + TOGETHER]
        found = outputs_at(motions, some[None], np.eye(poles.outputs))[0]
        part = slice(start * cycles, (start + len(some)) * cycles)
        outputs[:, part] = found.reshape(len(loops), -1, poles.outputs)
    max_force = np.max(np.abs(outputs[:, :, FORCE]), axis=1)
    saturated = max_force > limit * (1.0 + ROUNDING)
    # An open-loop axis does not saturate: it loses steps, and no motion could be shown.
    follows = loops[0].controller.follows
    is_steppable = not follows and first * cycles <= STEPPED
    stepped = np.flatnonzero(saturated & is_steppable).tolist()
    limited = _step_saturated([loops[i] for i in stepped], setpoint, limit, band)
    instead = dict(zip(stepped, limited, strict=True))
    linear = _watch(setpoint, poles, n)
    longest = max((len(own) for own, _ in limited), default=0)
    every = _watch(setpoint, poles, np.arange(longest // cycles))
    responses = []
    for corner, loop in enumerate(loops):
        settles, at = bool(decayed[corner] and (follows or not saturated[corner])), linear
        own, settles = instead.get(corner, (outputs[corner], settles))
        if corner in instead:
            at = every[0][: len(own) // cycles], every[1][: len(own) // cycles]
        found = _judge(loop, setpoint, *at, own, settles=settles, drive=drive, band=band)
        asked = float(max_force[corner])
        responses.append(replace(found, max_force=asked, saturated=bool(saturated[corner])))
    return responses


def _watch(setpoint: Setpoint, poles: LoopPoles, n: Cycles) -> tuple[Cycles, Array]:
    """Position cycles that are looked at, and where the delayed setpoint is in each of theirs."""
    t = np.asarray((n[:, None] * poles.cycles + np.arange(poles.cycles)) * poles.velocity_cycle)
    late = sample_setpoint(setpoint, t.ravel() - poles.delay)[:, 0]
    return n, late.reshape(t.shape)


TOGETHER = 200
"""Position cycles that are computed at once: keeps them in the cache."""


STEPPED = 80_000
"""Velocity cycles of a move that are stepped at most, and as many after it: ten seconds at 125 us.
A longer one that saturates is shown without that, and does not settle (empirical)."""

LOOKED_AT = 2000
"""Velocity cycles after each step of the setpoint that are all looked at, and of the rest until the
next one, evenly spread: a quarter of a second each at 125 us, so that no move makes many
(empirical)."""


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
    sizes = np.abs(poles.shapes[:, :, TOOL]).max(axis=1) * np.abs(modal)  # (n_corners, n_poles)
    radii = np.maximum(np.abs(poles.factors), 1e-9)
    residual = free_motion(motions, lay_grid(poles, SAMPLES)).residual[0]
    size = np.minimum(np.maximum(residual, LEAST_SIZE * band), band)
    # Cycles until every mode is below a share of that size; a pole outside the circle never is.
    small = DECAYED * size[:, None]
    decay = np.log(np.maximum(sizes / small, 1.0)) / -np.log(np.minimum(radii, 1.0 - 1e-15))
    needed = np.minimum(decay.max(axis=1) + 1.0, horizon).astype(int)
    settles = ((sizes * radii**horizon).sum(axis=1) <= band) | (needed < horizon)
    longest = usual if not settles.all() else 0
    for corner in np.flatnonzero(settles):
        count = int(needed[corner])
        if count > usual:
            # No later swing is larger, and none leaves the band.
            left = sizes[corner] @ radii[corner][:, None] ** np.arange(horizon + 1)
            seen = int(np.argmax(left <= size[corner]))
            count = max(usual, min(seen or horizon, count))
        longest = max(longest, count)
    return longest, settles


def _step_saturated(
    loops: Sequence[SampledLoop], setpoint: Setpoint, limit: float, band: float
) -> list[tuple[Array, bool]]:
    """Outputs with saturation, stepped until the free motion stays within the limit in each loop.

    And whether the tool can leave the band no more when they end.
    """
    if not loops:
        return []
    gains, T = loops[0].controller, loops[0].lifted.dt
    delay, cycles = gains.reference_delay, gains.cycles
    X, moved = np.zeros((len(loops), len(loops[0].lifted.A))), np.empty((len(loops), 0, 0))
    k, stop = 0, ceil((setpoint.duration + delay) / T) + 1
    last = stop + min(ceil(HORIZON / T), STEPPED // cycles)
    found: dict[int, tuple[Array, bool]] = {}
    while k < last and len(found) < len(loops):
        references = sample_setpoint(setpoint, np.arange(k, stop, dtype=np.float64) * T)
        X, Y = step_through(loops, X, references, force_limit=limit)
        moved = np.concatenate([moved, Y], axis=1) if k else Y
        later = np.arange(stop, stop + ceil(FOLLOWED / T), dtype=np.float64) * T
        references = sample_setpoint(setpoint, later)
        for i in set(range(len(loops))) - set(found):
            free = step_linear(loops[i], X[i], references)
            if np.max(np.abs(free[:, FORCE])) <= limit:
                end = np.array([stop * T + (len(free) - 1) * T / cycles])
                late = sample_setpoint(setpoint, end - delay)[0, 0]
                rests = abs(float(free[-1, TOOL] - late)) <= band
                found[i] = np.vstack([moved[i], free]), rests
        k, stop = stop, min(2 * stop, last)
    return [found.get(i, (moved[i], False)) for i in range(len(loops))]


def _judge(
    loop: SampledLoop,
    setpoint: Setpoint,
    n: Cycles,
    late: Array,
    outputs: Array,
    *,
    settles: bool,
    drive: Drive,
    band: float,
) -> LoopResponse:
    gains, t_e = loop.controller, setpoint.duration
    until, T_v = t_e + gains.reference_delay, gains.velocity_cycle
    t = ((n[:, None] * gains.cycles + np.arange(gains.cycles)) * T_v).ravel()
    tool, force, states = outputs[:, TOOL], outputs[:, FORCE], outputs[:, OUTPUTS:]
    deviation, begin = tool - late.ravel(), int(np.argmax(t >= until - 1e-12))
    # The judgement begins between two samples: there the tool is interpolated against the
    # setpoint that by then rests or coasts.
    end, speed = sample_setpoint(setpoint, np.array([t_e]))[0, :2]
    before = tool[begin - 1] - end - speed * (t[begin - 1] - until)
    share = (until - t[begin - 1]) / (t[begin] - t[begin - 1])
    at_end = before + share * (deviation[begin] - before)
    judged = np.abs(np.append(at_end, deviation[begin:]))
    settling = until
    if settles and np.max(judged) > band:
        at = np.append(until, t[begin:])
        settling = float(last_crossing(at, judged[None], band, begin=at[:1])[1][0])
    window, motor = t_e + setpoint.move.dwell, outputs[:, -1]
    shares = window_shares(n, window, step=T_v, cycles=gains.cycles).ravel()
    integrals = np.asarray(shares @ motor), np.asarray(shares @ motor**2)
    signals = np.hstack([np.abs(states).max(axis=0), np.abs(states @ loop.plant.C.T).max(axis=0)])
    return LoopResponse(
        setpoint=setpoint,
        t=np.asarray(t, dtype=np.float64),
        deviation=deviation,
        force=force.copy(),  # a view would keep all outputs
        states=states,
        t_end=until,
        settling_time=settling if settles else inf,
        residual_deviation=float(np.max(judged)) if settles else inf,
        peak_deviation=float(np.max(np.abs(deviation))),
        mode_amplitudes=_mode_amplitudes(loop, states[begin]),
        peaks=signals,
        max_force=float(np.max(np.abs(force))),
        rms_force=float(rms_force(*integrals, window=window, static_load=drive.static_load)),
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
