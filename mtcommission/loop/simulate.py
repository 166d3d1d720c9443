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

from mtcommission.loop.model.assembly import (
    SampledLoop,
    discretise_disturbance,
    hand_down_setpoints,
)
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.poles import Cycles, LoopPoles, find_poles
from mtcommission.loop.respond import (
    FORCE,
    OUTPUTS,
    TOOL,
    FreeMotion,
    Motions,
    free_motion,
    keep_from,
    last_crossing,
    lay_grid,
    outputs_at,
    set_in_motion,
)
from mtcommission.machine.drive import Drive
from mtcommission.machine.plant.plant import Plant
from mtcommission.setpoint.setpoint import INSTANT, Setpoint, sample_setpoint

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Friction:
    """Friction of a plant, or of several, each with its own rows, over one velocity cycle."""

    coulomb: float  # F_c [N]
    viscous: float  # d [N s/m]
    velocity: Array  # that rubs, as a row over the plant's states, (n,) or (n_plants, n)
    push: Array  # what 1 N over the cycle adds to the state, likewise

    def force(self, free: Array) -> Array:
        """Return the force of the cycle, of plant states at its end without friction, (m, n)."""
        v, gain = (free * self.velocity).sum(axis=1), (self.velocity * self.push).sum(axis=-1)
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


def friction_of(loops: Sequence[SampledLoop], drive: Drive) -> Friction:
    """Return the friction of a drive in several loops, each a machine of its own."""
    step = loops[0].controller.velocity_cycle
    return Friction(
        coulomb=drive.coulomb_friction,
        viscous=drive.viscous_friction,
        velocity=np.array([loop.plant.row("encoder") @ loop.plant.A for loop in loops]),
        push=np.array([discretise_disturbance(loop.plant, step) for loop in loops]),
    )


BLOCK = 64
"""Position cycles that are taken at once while nothing saturates."""


def step_through(
    loops: Sequence[SampledLoop],
    X: Array,
    given: Array,
    *,
    force_limit: float,
    friction: Friction | None = None,
) -> tuple[Array, Array]:
    """Return the same controller on several machines some position cycles later, and its outputs.

    The set force saturates at ``force_limit`` [N], and the integrator stands still meanwhile.
    ``X``: states, shape (n_loops, n); ``given``: what the setpoints hand down at each position
    cycle, shape (n_cycles, n_held), or of each loop, (n_cycles, n_loops, n_held). The outputs at
    every velocity cycle have the shape (n_loops, n_samples, n_outputs).
    """
    first = loops[0]
    z, held, seen = first.integrator, first.held, len(first.outputs)
    rows = np.array([loop.rows for loop in loops])
    # What is handed down by the encoder differs from machine to machine.
    by_state = np.array([loop.by_state for loop in loops])
    outputs = np.empty((len(loops), len(given), first.controller.cycles, seen))
    k, is_linear = 0, friction is None
    while k < len(given):
        if is_linear:
            states, Y = _step_linear(loops, X, given[k : k + BLOCK])
            pending = np.abs(states[1:, :, z + 1]).max(axis=1)
            asked = np.abs(Y[:, :, 1:, FORCE]).max(axis=(1, 2), initial=0.0)
            is_over = np.maximum(pending, asked) > force_limit
            kept = int(np.argmax(np.append(is_over, True)))
            outputs[:, k : k + kept], X = Y[:kept].swapaxes(0, 1), states[kept].copy()
            k, is_linear = k + kept, kept == len(Y)
            continue
        handed_down = (by_state @ X[:, :, None])[:, :, 0] + given[k]
        is_linear = friction is None
        for i in range(first.controller.cycles):
            Y = (rows @ X[:, :, None])[:, :, 0]
            outputs[:, k, i] = Y[:, :seen]
            demand, increment, X = Y[:, seen], Y[:, seen + 1], Y[:, seen + 2 :]
            force = np.minimum(np.maximum(demand, -force_limit), force_limit)
            is_free = force == demand
            is_linear = is_linear and bool(is_free.all())
            X[:, z] += np.where(is_free, increment, 0.0)
            X[:, z + 1] = force
            if friction:
                rubbed = X[:, : first.plant.order]
                rubbed += friction.force(rubbed)[:, None] * friction.push
        X[:, held:] = handed_down
        k += 1
    return X, outputs.reshape(len(loops), -1, seen)


def _step_linear(loops: Sequence[SampledLoop], X: Array, given: Array) -> tuple[Array, Array]:
    """States before each position cycle and at the end, (n + 1, n_loops, n_states), and outputs."""
    A, C = (np.array([getattr(one.lifted, name) for one in loops]) for name in "AC")
    states = np.empty((len(given) + 1, *X.shape))
    states[0] = X
    for k, push in enumerate(given):
        states[k + 1] = (A @ states[k, :, :, None])[:, :, 0]
        states[k + 1, :, loops[0].held :] += push
    found = states[:-1].swapaxes(0, 1) @ C.swapaxes(1, 2)
    found = found.reshape(*found.shape[:2], loops[0].controller.cycles, -1)
    return states, found.swapaxes(0, 1)


def drive_loops(
    loops: Sequence[SampledLoop],
    references: Array,
    *,
    force_limit: float = inf,
    friction: Friction | None = None,
) -> Array:
    """Return the outputs at every velocity cycle, at rest before, (n_loops, n_samples, n_out).

    ``references``: x_ref, v_ref, a_ref, j_ref at each position cycle, shape (n_cycles, 4), or of
    each loop, (n_cycles, n_loops, 4); ``force_limit``: of the set force [N]; ``friction``: of the
    loops' plants.
    """
    rest = np.zeros((len(loops), len(loops[0].states)))
    given = hand_down_setpoints(loops[0], references)
    return step_through(loops, rest, given, force_limit=force_limit, friction=friction)[1]


def drive_loop(
    loop: SampledLoop,
    references: Array,
    *,
    force_limit: float = inf,
    friction: Friction | None = None,
) -> Array:
    """Return the same of one loop, (n_samples, n_out)."""
    return np.asarray(
        drive_loops((loop,), references, force_limit=force_limit, friction=friction)[0]
    )


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

STRETCH = 0.1
"""Of free motion after a saturated move, before it is asked whether the tool rests [s]."""

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Seen:
    """A response as far as it is looked at."""

    n: Cycles  # position cycles
    late: Array  # position of the delayed setpoint at each velocity cycle of these [m]
    outputs: Array  # likewise, (n_samples, n_out)
    settles: bool  # whether the tool can leave the band no more when they end


def simulate_corners(
    loops: Sequence[SampledLoop], setpoint: Setpoint, *, drive: Drive, band: float
) -> list[LoopResponse]:
    """Return the response of the same controller on several machines; see ``simulate``.

    ``drive``: force limit and static load; ``band``: tcp_deviation of the requirements [m].
    """
    poles, limit = find_poles(tuple(loops)), drive.motion_force
    seen = _respond(poles, setpoint, band)
    asked = [float(np.max(np.abs(one.outputs[:, FORCE]))) for one in seen]
    saturated = [force > limit * (1.0 + ROUNDING) for force in asked]
    # An open-loop axis does not saturate: it loses steps, and no motion could be shown.
    if not loops[0].controller.follows:
        over = [i for i, is_over in enumerate(saturated) if is_over]
        for i in over:
            seen[i] = replace(seen[i], settles=False)
        if over and _end(setpoint, poles) * poles.cycles <= STEPPED:
            limited = _step_saturated(poles, [loops[i] for i in over], setpoint, limit, band)
            for i, one in zip(over, limited, strict=True):
                seen[i] = one
    return [
        replace(
            _judge(loop, setpoint, one, drive=drive, band=band), max_force=most, saturated=is_over
        )
        for loop, one, most, is_over in zip(loops, seen, asked, saturated, strict=True)
    ]


def simulate_rubbing(
    loops: Sequence[SampledLoop], setpoint: Setpoint, *, drive: Drive, band: float, followed: float
) -> list[LoopResponse]:
    """Return the responses with the drive's friction, stepped for a while after their end [s].

    What is off by then is "not settled".
    """
    gains = loops[0].controller
    cycle, friction = gains.position_cycle, friction_of(loops, drive)
    n = np.arange(ceil((setpoint.duration + gains.reference_delay + followed) / cycle))
    references = sample_setpoint(setpoint, np.asarray(n * cycle))
    late, limit = _delayed(setpoint, gains, n), drive.usable_force
    outputs = drive_loops(loops, references, force_limit=limit, friction=friction)
    found = []
    for loop, own in zip(loops, outputs, strict=True):
        settles = bool(abs(own[-1, TOOL] - late[-1]) <= band)
        seen = _Seen(n=n, late=late, outputs=own, settles=settles)
        found.append(_judge(loop, setpoint, seen, drive=drive, band=band))
    return found


def _end(setpoint: Setpoint, poles: LoopPoles) -> int:
    """The first position cycle after the delayed setpoint."""
    return ceil((setpoint.duration + poles.delay) / poles.dt) + 1


def _respond(poles: LoopPoles, setpoint: Setpoint, band: float) -> list[_Seen]:
    """The linear response in every corner."""
    motions, first = set_in_motion(poles, setpoint.steps), _end(setpoint, poles)
    free = free_motion(motions, lay_grid(poles, SAMPLES))
    count, decayed = _follow(free, first, band=band)
    n = _looked_at(motions, first, first + count, free.settling(band)[0])
    outputs = np.empty((len(poles.loops), len(n) * poles.cycles, poles.outputs))
    for start in range(0, len(n), TOGETHER):
        some = n[start : start + TOGETHER]
        found = outputs_at(motions, some[None], np.eye(poles.outputs))[0]
        part = slice(start * poles.cycles, (start + len(some)) * poles.cycles)
        outputs[:, part] = found.reshape(len(outputs), -1, poles.outputs)
    late = _delayed(setpoint, poles.loops[0].controller, n)
    pairs = zip(outputs, decayed.tolist(), strict=True)
    return [_Seen(n=n, late=late, outputs=own, settles=settles) for own, settles in pairs]


def _delayed(setpoint: Setpoint, gains: Controller, n: Cycles) -> Array:
    """Position of the delayed setpoint at each velocity cycle of some position cycles [m]."""
    t = (n[:, None] * gains.cycles + np.arange(gains.cycles)) * gains.velocity_cycle
    return sample_setpoint(setpoint, np.asarray(t.ravel() - gains.reference_delay))[:, 0]


TOGETHER = 200
"""Position cycles that are computed at once: keeps them in the cache."""


STEPPED = 80_000
"""Velocity cycles of a move that are stepped at most, and as many after it: ten seconds at 125 us.
A longer one that saturates is shown without that, and does not settle (empirical)."""

LOOKED_AT = 2000
"""Velocity cycles after each step of the setpoint that are all looked at, and of the rest until the
next one, evenly spread: a quarter of a second each at 125 us, so that no move makes many
(empirical)."""


def _looked_at(motions: Motions, first: int, last: int, late: Array) -> Cycles:
    """Position cycles that are looked at, from one on for longer after the setpoint's end.

    And those about the times at which the tool settles in each corner [s].
    """
    poles = motions.poles
    steps = np.minimum(motions.first[0], first)
    ends = np.unique(np.concatenate([[0], steps, [first, last]])).tolist()
    parts = []
    for start, stop in pairwise(ends):
        every = FOLLOWED / poles.dt if start == first else LOOKED_AT / poles.cycles
        dense = min(start + ceil(every), stop)
        rest = min(stop - dense, ceil(LOOKED_AT / poles.cycles))
        parts += [np.arange(start, dense), np.linspace(dense, stop, rest, endpoint=False)]
    about = (late[np.isfinite(late)] / poles.dt).astype(np.int64)[:, None] + np.arange(-1, 3)
    parts.append(about[(about >= first) & (about < last)])
    return np.unique(np.concatenate(parts).astype(np.int64))


def _follow(free: FreeMotion, first: int, *, band: float) -> tuple[int, NDArray[np.bool_]]:
    """How many cycles from one on are followed, and where the tool can leave the band no more."""
    motions, poles = free.motions, free.motions.poles
    usual, horizon = ceil(FOLLOWED / poles.dt), ceil(HORIZON / poles.dt)
    if not poles.factors.size:
        return min(poles.recent, horizon), np.ones(len(poles.loops), dtype=bool)
    begun = first - motions.first[:, -1] - poles.recent
    modal = motions.modal[-1, 0] * poles.power(np.maximum(begun, 0))[0]
    sizes = np.abs(poles.shapes[:, :, TOOL]).max(axis=1) * np.abs(modal)  # (n_corners, n_poles)
    radii = np.maximum(np.abs(poles.factors), 1e-9)
    size = np.minimum(np.maximum(free.residual[0], LEAST_SIZE * band), band)
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
    poles: LoopPoles, loops: Sequence[SampledLoop], setpoint: Setpoint, limit: float, band: float
) -> list[_Seen]:
    """Responses with saturation, stepped until the tool rests, or has been followed for long.

    What asks for more force than there is until the horizon does not settle.
    """
    T, gains, outputs = poles.dt, loops[0].controller, list[Array]()
    X = np.zeros((len(loops), len(loops[0].states)))
    k, stop = 0, _end(setpoint, poles)
    end, last = stop, stop + min(ceil(HORIZON / T), STEPPED // poles.cycles)
    references = sample_setpoint(setpoint, np.asarray(np.arange(last) * T))
    given = hand_down_setpoints(loops[0], references)
    while k < last:
        n = np.arange(k, stop)
        X, Y = step_through(loops, X, given[k:stop], force_limit=limit)
        outputs.append(Y)
        off = np.abs(Y[:, :, TOOL] - _delayed(setpoint, gains, n)).max(axis=1)
        is_free = np.abs(Y[:, :, FORCE]).max(axis=1) < limit
        settles = is_free & (off <= band)
        is_long = is_free.all() and (k - end) * T >= FOLLOWED
        if k > end and (is_long or (settles.all() and off.max() <= DECAYED * band)):
            break
        k, stop = stop, min(stop + ceil(STRETCH / T), last)
    every = np.arange(sum(Y.shape[1] for Y in outputs) // poles.cycles)
    late = _delayed(setpoint, gains, every)
    both = np.concatenate(outputs, axis=1), settles.tolist()
    return [
        _Seen(n=every, late=late, outputs=own, settles=rests)
        for own, rests in zip(*both, strict=True)
    ]


def _judge(
    loop: SampledLoop, setpoint: Setpoint, seen: _Seen, *, drive: Drive, band: float
) -> LoopResponse:
    n, outputs, settles = seen.n, seen.outputs, seen.settles
    gains, t_e = loop.controller, setpoint.duration
    until, T_v = t_e + gains.reference_delay, gains.velocity_cycle
    t = np.asarray((n[:, None] * gains.cycles + np.arange(gains.cycles)) * T_v).ravel()
    tool, force, states = outputs[:, TOOL], outputs[:, FORCE], outputs[:, OUTPUTS:]
    deviation, begin = tool - seen.late, int(np.argmax(t >= until - INSTANT))
    # By then the setpoint rests or coasts, also where it is asked for between two samples.
    end, speed = sample_setpoint(setpoint, np.array([t_e]))[0, :2]
    free, own = (tool - end - speed * (t - until))[None, None], np.array([until])
    keep_from(t, free, own)
    settling, residual = until, float(np.max(free))
    if settles and residual > band:
        settling = float(last_crossing(t, free[0], band, begin=own)[1][0])
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
        residual_deviation=residual if settles else inf,
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
    """
    left = window / step - (n[:, None] * cycles + np.arange(cycles))
    return np.asarray(step * np.clip(left + 0.5, 0.0, 1.0) * np.gradient(n.astype(float))[:, None])


def rms_force(first: Array, square: Array, *, window: Array | float, static_load: float) -> Array:
    """Return the RMS force over a window [s], the static load in its worse direction [N].

    Of the integrals of force and square over it; the motion may go either way against the load.
    """
    load = abs(static_load)
    return np.asarray(np.sqrt(square / window + load**2 + 2.0 * load * np.abs(first / window)))
