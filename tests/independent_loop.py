"""The feedback loop once more, written from its description alone.

Shares no code with the package: the machine's and the controller's numbers are read, all else
is done here in another way. The plant is solved in closed form between velocity cycles, in
one complex number per mode; the controller is scalar code, cycle by cycle; the setpoint is a
sum of cubics.
"""

from __future__ import annotations

from bisect import bisect_left
from cmath import exp
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import comb, cos, pi, sqrt, tanh
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly, CubicHermiteSpline
from scipy.optimize import brentq, minimize_scalar

from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.model.controller import Controller
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.setpoint_filter import HUMPS, SetpointFilter, shape

Array = NDArray[np.float64]


SLICES, CREEP = 10, 2e-5
"""Of a velocity cycle in which friction is constant, and the velocity at which it has turned
[m/s]."""


@dataclass(slots=True)
class Vibration:
    """One mode: w = q' - conj(p) q, so that w' = p w + F, q = Im w / Im p."""

    pole: complex
    tool: float
    encoder: float
    scale: float
    w: complex = 0.0

    @property
    def q(self) -> float:
        return self.w.imag / self.pole.imag

    @property
    def rate(self) -> float:
        return self.w.real + self.pole.real * self.q

    def place(self, q: float, rate: float) -> None:
        self.w = complex(rate - self.pole.real * q, self.pole.imag * q)


@dataclass(slots=True)
class Axis:
    """Rigid mass, force lag and modes, advanced exactly under a constant set force."""

    names: tuple[str, ...]
    mass: float
    lag: float
    modes: list[Vibration]
    slots: list[tuple[int, int]]
    rigid: tuple[int, int]
    x: float = 0.0
    v: float = 0.0
    F: float = 0.0

    def advance(self, u: float, h: float, push: float = 0.0) -> None:
        """Set force u and a constant push beside the motor, for the time h."""
        T, excess = self.lag, self.F - u
        fade = exp(-h / T).real
        self.F = u + excess * fade
        u += push
        self.x += self.v * h + (u * h * h / 2 + excess * T * (h - T * (1 - fade))) / self.mass
        self.v += (u * h + excess * T * (1 - fade)) / self.mass
        for mode in self.modes:
            p, turn = mode.pole, exp(mode.pole * h)
            mode.w = turn * mode.w + u * (turn - 1) / p + excess * (turn - fade) / (p + 1 / T)

    def state(self) -> Array:
        state = np.zeros(len(self.names))
        state[list(self.rigid)] = self.x, self.v
        for mode, (place, rate) in zip(self.modes, self.slots, strict=True):
            state[place], state[rate] = mode.scale * mode.q, mode.scale * mode.rate
        state[-1] = self.F
        return state

    def put(self, state: Array) -> None:
        self.x, self.v = (float(state[i]) for i in self.rigid)
        for mode, (place, rate) in zip(self.modes, self.slots, strict=True):
            mode.place(float(state[place]) / mode.scale, float(state[rate]) / mode.scale)
        self.F = float(state[-1])

    @property
    def encoder(self) -> float:
        return self.x + sum(mode.encoder * mode.q for mode in self.modes)

    @property
    def encoder_rate(self) -> float:
        return self.v + sum(mode.encoder * mode.rate for mode in self.modes)

    @property
    def tool(self) -> float:
        return self.x + sum(mode.tool * mode.q for mode in self.modes)


def axis_of(machine: Machine) -> Axis:
    """The machine at rest."""
    parts, lag = machine.mechanics, machine.drive.force_lag
    if isinstance(parts, Manipulator):
        base = _pole(parts.base_mass, parts.base_damping, parts.base_stiffness)
        tower = _pole(parts.rotary_inertia, parts.rotary_damping, parts.rotary_stiffness)
        lever = parts.lever_arm / parts.rotary_inertia
        return Axis(
            names=("x_b", "x_s", "phi", "v_b", "v_s", "v_phi", "F"),
            mass=parts.slider_mass,
            lag=lag,
            modes=[
                Vibration(base, 1 / parts.base_mass, 1 / parts.base_mass, -1 / parts.base_mass),
                Vibration(tower, parts.tcp_height * lever, 0.0, lever),
            ],
            slots=[(0, 3), (2, 5)],
            rigid=(1, 4),
        )
    names = ["x", "v"]
    modes = []
    for mode in parts.modes:
        names += [f"q_{mode.name}", f"v_{mode.name}"]
        omega, zeta = mode.natural_frequency, mode.damping_ratio
        pole = _pole(1.0, 2 * zeta * omega, omega**2)
        modes.append(Vibration(pole, mode.tcp_gain, mode.measured_gain, 1.0))
    return Axis(
        names=(*names, "F"),
        mass=parts.moving_mass,
        lag=lag,
        modes=modes,
        slots=[(2 * i + 2, 2 * i + 3) for i in range(len(modes))],
        rigid=(0, 1),
    )


def _pole(mass: float, damping: float, stiffness: float) -> complex:
    return complex(-damping, sqrt(4 * mass * stiffness - damping**2)) / (2 * mass)


class Moving(Protocol):
    """A setpoint: x, v, a, j at any time."""

    def at(self, t: float) -> Array: ...


@dataclass(frozen=True, slots=True)
class Profile:
    """Cubics switched on one after another; perhaps behind sliding means."""

    knots: tuple[float, ...]
    jerks: tuple[float, ...]
    means: tuple[float, ...] = ()

    @property
    def end(self) -> float:
        return self.knots[-1] + sum(self.means)

    def at(self, t: float) -> Array:
        """x, v, a, j."""
        if t < -1e-9:
            return np.zeros(4)
        if t > self.end - 1e-9:
            last = self._values(self.end)
            return np.array([last[0] + last[1] * (t - self.end), last[1], 0.0, 0.0])
        return self._values(t)

    def _values(self, t: float) -> Array:
        count = len(self.means)
        return self._powers(t, self.means)[2 - count : 6 - count]

    def _powers(self, t: float, means: tuple[float, ...]) -> Array:
        """Integrals of x, then x, v, a, j (without the last ones), behind some of the means."""
        if means:
            T, rest = means[0], means[1:]
            return (self._powers(t, rest) - self._powers(t - T, rest))[:-1] / T
        total = np.zeros(6)
        for knot, jerk in zip(self.knots, self.jerks, strict=True):
            s = t - knot
            if s >= -1e-9:
                powers = [s**5 / 120, s**4 / 24, s**3 / 6, s**2 / 2, s, 1.0]
                total += jerk * np.array(powers)
        return total

    def copied(self, delays: Sequence[float], shares: Sequence[float]) -> Profile:
        """The sum of copies, so much later and so large."""
        both = [
            (knot + delay, jerk * share)
            for delay, share in zip(delays, shares, strict=True)
            for knot, jerk in zip(self.knots, self.jerks, strict=True)
        ]
        knots, jerks = zip(*sorted(both), strict=True)
        return replace(self, knots=knots, jerks=jerks)


def profile_of(move: Move, a: float, j: float, *, means: tuple[float, ...] = ()) -> Profile:
    """The seven-segment profile (four for a velocity step)."""
    if isinstance(move, VelocityStep):
        rise = _rise(move.velocity_step, a, j)
        return Profile(knots=rise, jerks=(j, -j, -j, j), means=means)

    def shortest(v: float) -> float:
        return v * _rise(v, a, j)[-1]  # up and down again

    top = move.max_velocity
    if top == float("inf") or shortest(top) > move.distance:
        high = 1.0
        while shortest(high) < move.distance:
            high *= 2.0
        top = float(brentq(lambda v: shortest(v) - move.distance, 1e-12, high, xtol=1e-15))
    rise = _rise(top, a, j)
    down = max(move.distance / top, rise[-1])
    return Profile(
        knots=(*rise, *(down + t for t in rise)), jerks=(j, -j, -j, j, -j, j, j, -j), means=means
    )


def behind(profile: Profile, item: SetpointFilter | None) -> Profile:
    """The setpoint that a control with this filter sends."""
    if item is None:
        return profile
    if item.frequency_hz:
        return profile.copied(*shaper(item.kind, item.frequency_hz, item.damping_ratio))
    if item.taps:
        return profile.copied([n * item.spacing for n in range(len(item.taps))], item.taps)
    return replace(profile, means=tuple(T for T in (item.time, item.second_time) if T))


def shaper(kind: str, f: float, zeta: float) -> tuple[list[float], list[float]]:
    """Delays and shares; classical EI from its condition: no hump above 5 %.

    Klipper's EI is a fit whose own test says how well it meets the damped condition.
    """
    if kind in ("ei", *HUMPS):
        fitted = shape(kind, frequency_hz=f, damping_ratio=zeta)
        return list(fitted.delays), list(fitted.shares)
    period = 1 / (f * sqrt(1 - zeta**2))
    apart, fading = 0.5 * period, 0.5 * period
    name = kind.removeprefix("marlin_")
    if name == "mzv":
        apart, plain = 0.375 * period, [1 - sqrt(0.5), sqrt(2) - 1, 1 - sqrt(0.5)]
    elif name.startswith("zv"):
        order = len(name) - 1
        plain = [float(comb(order, n)) for n in range(order + 1)]
    else:
        plain = _with_humps({"e": 1, "2": 2, "3": 3}[name[0]], 0.05)
    if name == kind:
        fading = apart
    else:  # Marlin samples every millisecond; LROUND rounds halves up
        apart = 1e-3 * int(1e3 * apart + 0.5)
    fade = [exp(-2 * pi * f * zeta * fading * n).real for n in range(len(plain))]
    total = sum(share * c for share, c in zip(plain, fade, strict=True))
    shares = [share * c / total for share, c in zip(plain, fade, strict=True)]
    return [n * apart for n in range(len(plain))], shares


def _with_humps(count: int, V: float) -> list[float]:
    if count == 1:
        return [(1 + V) / 4, (1 - V) / 2, (1 + V) / 4]

    def shares(a: float) -> list[float]:
        if count == 2:
            return [a, 0.5 - a, 0.5 - a, a]
        b = (1 - V) / 4
        return [a, b, 1 - 2 * (a + b), b, a]

    def excess(a: float) -> float:
        """The hump beside the design frequency, over what it may be."""
        own = shares(a)

        def left(r: float) -> float:
            middle = (len(own) - 1) / 2
            # From 0 with two humps, from V with three; the next extreme is the other way.
            sign = -1 if count == 2 else 1
            return sign * sum(s * cos(pi * r * (n - middle)) for n, s in enumerate(own))

        best = minimize_scalar(left, bounds=(1.0, 1.4), method="bounded", options={"xatol": 1e-11})
        return float(-best.fun - V)

    between = (0.13, 0.19) if count == 2 else (0.1, 0.13)
    return shares(float(brentq(excess, *between, xtol=1e-14)))


def _rise(v: float, a: float, j: float) -> tuple[float, float, float, float]:
    if v * j > a * a:
        return 0.0, a / j, v / a, v / a + a / j
    half = sqrt(v / j)
    return 0.0, half, half, 2 * half


class Biquad:
    """One set-force filter by the bilinear transform, direct form II."""

    def __init__(self, item: ForceFilter, cycle: float) -> None:
        w, d, c = item.natural_frequency, item.damping, 2 / cycle
        if item.kind == "low_pass":
            top, bottom = (0.0, 0.0, w * w), (1.0, 2 * d * w, w * w)
        else:
            top, bottom = (1.0, 2 * d * w, w * w), (1.0, 2 * item.width * w, w * w)
        lead = bottom[0] * c * c + bottom[1] * c + bottom[2]
        self.b, self.a = (
            [
                (s2 * c * c + s1 * c + s0) / lead,
                2 * (s0 - s2 * c * c) / lead,
                (s2 * c * c - s1 * c + s0) / lead,
            ]
            for s2, s1, s0 in (top, bottom)
        )
        self.one = self.two = 0.0

    def pass_on(self, u: float) -> float:
        now = u - self.a[1] * self.one - self.a[2] * self.two
        y = self.b[0] * now + self.b[1] * self.one + self.b[2] * self.two
        self.one, self.two = now, self.one
        return y


@dataclass(frozen=True, slots=True)
class Run:
    """Signals at every velocity cycle."""

    t: Array
    tool: Array
    encoder: Array
    force: Array
    states: Array
    reference: Array


def run(
    machine: Machine,
    gains: Controller,
    profile: Moving,
    *,
    nominal: Machine,
    samples: int,
    force_limit: float = float("inf"),
    push: float = 0.0,
    resolution: float = 0.0,
    phase: float = 0.0,
    coulomb: float = 0.0,
) -> Run:
    """The machine under the cascade; ``nominal`` is what the controller believes it to be.

    ``push`` is a force beside the motor from the beginning on, ``coulomb`` a friction. The encoder
    rounds to whole steps of ``resolution``; at the start it stands ``phase`` of a step beside one.
    """
    axis, h, T_p = axis_of(machine), gains.velocity_cycle, gains.position_cycle
    tau, K = gains.reference_delay, gains.state_gains
    estimate, advance = _observer(gains, nominal)
    biquads = [Biquad(item, h) for item in gains.force_filters]
    integral = acting = modelled = last = 0.0
    corrections = [0.0, 0.0]
    out = []
    for i in range(samples):
        cycle, step = divmod(i, gains.cycles)
        seen = axis.encoder
        if resolution:
            seen = resolution * (round(seen / resolution + phase) - phase)
        if step == 0:
            error = delayed(profile, i * h - tau, T_p)[0] - seen
            corrections = [corrections[1], gains.position_gain * error]
            handed = _handed_down(profile, gains, nominal, (cycle - 1) * T_p)
        x_wanted, v_wanted, f_wanted = handed(step * h)
        out.append((axis.tool, seen, acting, *axis.state()))
        correction = corrections[0]
        if gains.position_loop is PositionLoop.DRIVE:
            correction = gains.position_gain * (x_wanted - seen)
        miss = correction + gains.velocity_feedforward * v_wanted - (seen - last) / h
        last = seen
        wanted = gains.velocity_gain * (miss + integral) + f_wanted - float(K @ estimate)
        for biquad in biquads:
            wanted = biquad.pass_on(wanted)
        granted = min(max(wanted, -force_limit), force_limit)
        if granted == wanted:
            expected = modelled - correction if gains.reference_model_time else 0.0
            integral += h / gains.integral_time * (miss + expected)
        if gains.reference_model_time:
            fade = exp(-h / gains.reference_model_time).real
            modelled = fade * modelled + (1 - fade) * correction
        measured = np.array([axis.tool if s == "tcp" else seen for s in gains.sensors])
        estimate = advance(estimate, acting, measured)
        if coulomb:
            for _ in range(SLICES):
                rubs = -coulomb * tanh(axis.encoder_rate / CREEP)
                axis.advance(acting, h / SLICES, push + rubs)
        else:
            axis.advance(acting, h, push)
        acting = granted
    table = np.array(out)
    t = np.arange(samples) * h
    reference = np.array([profile.at(s - tau)[0] for s in t])
    return Run(t, table[:, 0], table[:, 1], table[:, 2], table[:, 3:], reference)


def _handed_down(
    profile: Moving, gains: Controller, nominal: Machine, now: float
) -> Callable[[float], tuple[float, float, float]]:
    """What was computed at ``now``: position, velocity and force, so long into the next cycle."""
    T_p, h, K, m = (
        gains.position_cycle,
        gains.velocity_cycle,
        gains.state_gains,
        gains.feedforward_mass,
    )

    def fed_forward(t: float) -> float:
        _, _, a, j = profile.at(t)
        return m * (
            gains.acceleration_feedforward * a + gains.jerk_feedforward * gains.force_lag * j
        )

    if gains.position_loop is PositionLoop.CONTROL:
        path = T_p + (T_p - h) / 2
        late = delayed(profile, now - max(gains.reference_delay - path, 0.0), T_p)
        held = delayed(profile, now - max(gains.reference_delay + h / 2 - path, 0.0), T_p)[1]
        middle = float(K @ _wanted(nominal, m, late))
        rate = float(K @ _wanted(nominal, m, np.array([*late[1:], 0.0])))
        return lambda s: (0.0, held, fed_forward(now) + middle + rate * (s - (T_p - h) / 2))

    age = max(gains.reference_delay - 2 * T_p, 0.0)
    ends = [delayed(profile, now - age - T_p, T_p), delayed(profile, now - age, T_p)]
    spline = CubicHermiteSpline([0.0, T_p], [e[0] for e in ends], [e[1] for e in ends])
    forces = [
        fed_forward(t) + float(K @ _wanted(nominal, m, e))
        for t, e in zip((now - T_p, now), ends, strict=True)
    ]
    return lambda s: (
        float(spline(s)),
        float(spline(s) - spline(s - h)) / h,
        float(np.interp(s, [0.0, T_p], forces)),
    )


def delayed(profile: Moving, t: float, cycle: float) -> Array:
    """The setpoint between samples of the position cycle, as the control interpolates it."""
    place = t / cycle
    nearest = round(place)
    if abs(place - nearest) < 1e-9:
        return profile.at(nearest * cycle)
    before = int(np.floor(place))
    left, right = profile.at(before * cycle), profile.at((before + 1) * cycle)
    quintic = BPoly.from_derivatives([0.0, cycle], [left[:3], right[:3]])
    s = t - before * cycle
    mixed = left + (right - left) * (s / cycle)
    return np.array([quintic(s), quintic(s, nu=1), mixed[2], mixed[3]])


def _wanted(nominal: Machine, mass: float, setpoint: Array) -> Array:
    """Rigid motion along the setpoint, every mode at its static deflection under m a."""
    axis = axis_of(nominal)
    state = np.zeros(len(axis.names))
    state[list(axis.rigid)] = setpoint[:2]
    for mode, (place, rate) in zip(axis.modes, axis.slots, strict=True):
        static = mode.scale * mass / abs(mode.pole) ** 2
        state[place], state[rate] = static * setpoint[2], static * setpoint[3]
    state[-1] = mass * setpoint[2]
    return state


def _observer(gains: Controller, nominal: Machine):  # type: ignore[no-untyped-def]
    """Estimate at rest and its advance by one velocity cycle: predict, correct by L."""
    axis, seen, L = axis_of(nominal), list(gains.observer.states), gains.observer.L

    def advance(estimate: Array, force: float, measured: Array) -> Array:
        if not seen:
            return estimate
        axis.put(estimate)
        expected = np.array([axis.tool if s == "tcp" else axis.encoder for s in gains.sensors])
        axis.advance(force, gains.velocity_cycle)
        following = np.zeros(len(axis.names))
        following[seen] = axis.state()[seen] + L @ (measured - expected)
        return following

    return np.zeros(len(axis.names)), advance


@dataclass(frozen=True, slots=True)
class Judgement:
    """The definitions, applied to a run."""

    settling_time: float
    residual: float
    peak: float
    rms_force: float


def judge(run: Run, profile: Profile, *, tau: float, band: float, dwell: float) -> Judgement:
    """Settling time, residual and peak deviation, RMS of the motor force."""
    begin = profile.end + tau
    e = np.abs(run.tool - run.reference)
    after = bisect_left(run.t.tolist(), begin - 1e-12)
    # Between the samples about t_e + tau the tool is a line, the setpoint rests or coasts.
    t_0, t_1 = run.t[after - 1], run.t[after]
    coast = (run.reference[-1] - run.reference[-2]) / (run.t[-1] - run.t[-2])
    late = run.reference[after] - coast * (t_1 - t_0)
    d_0, d_1 = run.tool[after - 1] - late, run.tool[after] - run.reference[after]
    at_end = abs(d_0 + (begin - t_0) / (t_1 - t_0) * (d_1 - d_0))
    judged_t = np.concatenate([[begin], run.t[after:]])
    judged = np.concatenate([[at_end], e[after:]])
    settling = begin
    for i in range(len(judged) - 1, 0, -1):
        if judged[i - 1] > band >= judged[i]:
            h = judged_t[i] - judged_t[i - 1]
            settling = float(
                judged_t[i - 1] + h * (judged[i - 1] - band) / (judged[i - 1] - judged[i])
            )
            break
    window = profile.end + dwell
    F = np.interp(np.linspace(0, window, 20001), run.t, run.states[:, -1], right=0.0)
    rms = sqrt(np.trapezoid(F**2, dx=window / 20000) / window)
    return Judgement(settling, float(np.max(judged)), float(np.max(e)), rms)


def quiet_copy(machine: Machine, **changes: object) -> Machine:
    """A machine with some fields of its control block changed."""
    return replace(machine, control=replace(machine.control, **changes))  # type: ignore[arg-type]
