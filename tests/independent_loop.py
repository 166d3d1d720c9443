"""The feedback loop once more, by the letter of docs/feedback-loop.md: from a record, or a machine.

Shares no code with the package, whose numbers are read: the plant is written down anew and advanced
by a matrix exponential, the controller step by step in the page's order, the setpoint is a sum of
cubics.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, factorial, floor, inf, sqrt, tanh
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.model.controller import NO_OBSERVER, Controller, Observer
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.setpoint_filter import SetpointFilter

Array = NDArray[np.float64]
Json = dict[str, Any]

ROUNDING = 1e-9

SLICES, CREEP = 5, 2e-5
"""Of a velocity cycle in which friction is constant, and the velocity at which it has turned
[m/s]."""


@dataclass(frozen=True, slots=True)
class Axis:
    """x' = A x + B F_set, and the rows of tool and encoder; the last state is the force."""

    A: Array
    B: Array
    tool: Array
    encoder: Array

    def over(self, T: float) -> tuple[Array, Array, Array]:
        """State, set force and a force beside the motor, held for a time, to the state after."""
        n = len(self.B)
        beside = np.append(self.A[:-1, -1], 0.0)
        joint = np.zeros((n + 2, n + 2))
        joint[:n] = np.column_stack([self.A, self.B, beside])
        flow = expm(T * joint)
        return flow[:n, :n], flow[:n, n], flow[:n, n + 1]

    def wanted(self, m: float) -> Callable[[Array], Array]:
        """Rigid motion along the setpoint, every mode at its static deflection under m a.

        The equations tell which states are which: a position is a state whose rate is another
        state; it is the rigid one if nothing draws it back.
        """
        A, F = self.A, len(self.B) - 1
        by = np.zeros((F + 1, 4))
        by[F, 2] = m
        for place in range(F):
            rate = np.flatnonzero(A[place] == 1.0)
            if rate.size != 1 or np.count_nonzero(A[place]) != 1 or rate[0] == F:
                continue
            if A[rate[0], place] == 0.0:
                by[place, 0] = by[rate[0], 1] = 1.0
            else:
                by[place, 2] = by[rate[0], 3] = -m * A[rate[0], F] / A[rate[0], place]
        assert self.encoder @ by[:, 0] == 1.0
        return lambda r: by @ r


def axis_of(machine: Machine) -> Axis:
    """Equation (1) of the paper, or q'' + 2 zeta omega q' + omega² q = F for every mode."""
    parts, T = machine.mechanics, machine.drive.force_lag
    if isinstance(parts, Manipulator):
        p = parts
        A = np.zeros((7, 7))
        A[[0, 1, 2], [3, 4, 5]] = 1.0
        A[3, [0, 3, 6]] = -np.array([p.base_stiffness, p.base_damping, 1.0]) / p.base_mass
        A[4, 6] = 1.0 / p.slider_mass
        A[5, [2, 5, 6]] = -p.rotary_stiffness, -p.rotary_damping, p.lever_arm
        A[5] /= p.rotary_inertia
        tool = np.array([-1.0, 1.0, p.tcp_height, 0.0, 0.0, 0.0, 0.0])
        encoder = np.array([-1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    else:
        n = 3 + 2 * len(parts.modes)
        A, tool, encoder = np.zeros((n, n)), np.zeros(n), np.zeros(n)
        A[0, 1], A[1, -1] = 1.0, 1.0 / parts.moving_mass
        tool[0] = encoder[0] = 1.0
        for q, mode in zip(range(2, n, 2), parts.modes, strict=False):
            omega = mode.natural_frequency
            A[q, q + 1] = 1.0
            A[q + 1, [q, q + 1, -1]] = -(omega**2), -2 * mode.damping_ratio * omega, 1.0
            tool[q], encoder[q] = mode.tcp_gain, mode.measured_gain
    A[-1, -1] = -1.0 / T
    return Axis(A, np.append(np.zeros(len(A) - 1), 1.0 / T), tool, encoder)


class Moving(Protocol):
    """A setpoint: x, v, a, j at any time."""

    def at(self, t: float) -> Array: ...


@dataclass(frozen=True)
class Profile:
    """Cubics switched on one after another; perhaps behind sliding means."""

    knots: Sequence[float]
    jerks: Sequence[float]  # steps of the jerk at the knots
    means: tuple[float, ...] = ()

    @property
    def end(self) -> float:
        return self.knots[-1] + sum(self.means)

    def at(self, t: float) -> Array:
        """x, v, a, j."""
        if t < -ROUNDING:
            return np.zeros(4)
        if t > self.end - ROUNDING:
            x, v = self._last
            return np.array([x + v * (t - self.end), v, 0.0, 0.0])
        return self._inside(t)

    @cached_property
    def _last(self) -> Array:
        return self._inside(self.end)[:2]

    def _inside(self, t: float) -> Array:
        count = len(self.means)
        return self._powers(t, self.means)[2 - count : 6 - count]

    def _powers(self, t: float, means: tuple[float, ...]) -> Array:
        """Integrals of x, then x, v, a, j (without the last ones), behind some of the means."""
        if means:
            T, rest = means[0], means[1:]
            return (self._powers(t, rest) - self._powers(t - T, rest))[:-1] / T
        s = t - np.asarray(self.knots)
        on = np.asarray(self.jerks) * (s >= -ROUNDING)
        return np.array([on @ s**k / factorial(k) for k in (5, 4, 3, 2, 1, 0)])

    def copied(self, delays: Sequence[float], shares: Sequence[float]) -> Profile:
        """The sum of copies, so much later and so large."""
        knots = np.add.outer(delays, self.knots).ravel()
        jerks = np.outer(shares, self.jerks).ravel()
        order = np.argsort(knots)
        return replace(self, knots=knots[order].tolist(), jerks=jerks[order].tolist())


def profile_of(move: Move, a: float, j: float, *, means: tuple[float, ...] = ()) -> Profile:
    """The seven-segment profile (four for a velocity step)."""
    if isinstance(move, VelocityStep):
        return Profile(_rise(move.velocity_step, a, j), (j, -j, -j, j), means)

    def shortest(v: float) -> float:
        return v * _rise(v, a, j)[-1]  # up and down again

    top = move.max_velocity
    if top == inf or shortest(top) > move.distance:
        high = 1.0
        while shortest(high) < move.distance:
            high *= 2.0
        top = float(brentq(lambda v: shortest(v) - move.distance, 1e-12, high, xtol=1e-15))
    rise = _rise(top, a, j)
    down = max(move.distance / top, rise[-1])
    knots = (*rise, *(down + t for t in rise))
    return Profile(knots, (j, -j, -j, j, -j, j, j, -j), means)


def _rise(v: float, a: float, j: float) -> tuple[float, float, float, float]:
    if v * j > a * a:
        return 0.0, a / j, v / a, v / a + a / j
    half = sqrt(v / j)
    return 0.0, half, half, 2 * half


def behind(profile: Profile, item: SetpointFilter | None) -> Profile:
    """The setpoint that a control with this filter sends."""
    if item is None:
        return profile
    means = tuple(T for T in (item.time, item.second_time) if T)
    return replace(profile, means=means).copied(*item.impulses)


def profile_of_record(move: Json) -> Profile:
    """Of the segments of a move in a record."""
    entry = move["setpoint"]
    lengths = [segment["duration"] for segment in entry["segments"]]
    jerks = [segment["jerk"] for segment in entry["segments"]]
    knots = np.concatenate([[0.0], np.cumsum(lengths)])
    plain = Profile(knots.tolist(), np.diff(jerks, prepend=0.0, append=0.0).tolist())
    item = entry["setpoint_filter"]
    if item is None:
        return plain
    means = tuple(item[key] for key in ("time", "second_time") if item[key])
    return replace(plain, means=means).copied(item["delays"], item["shares"])


class Delayed:
    """The setpoint between samples of the position cycle, as the control interpolates it."""

    def __init__(self, profile: Moving, T: float) -> None:
        self.profile, self.T, self.known = profile, T, dict[int, Array]()

    def sample(self, n: int) -> Array:
        if n not in self.known:
            self.known[n] = self.profile.at(n * self.T)
        return self.known[n]

    def __call__(self, t: float) -> Array:
        T, n = self.T, floor(t / self.T + ROUNDING)
        u = t / T - n
        if u < ROUNDING:
            return self.sample(n)
        (x0, v0, a0, j0), (x1, v1, a1, j1) = self.sample(n), self.sample(n + 1)
        c = np.array([x0, T * v0, T * T * a0, x1, T * v1, T * T * a1])
        h = [
            1 - 10 * u**3 + 15 * u**4 - 6 * u**5,
            u - 6 * u**3 + 8 * u**4 - 3 * u**5,
            (u**2 - 3 * u**3 + 3 * u**4 - u**5) / 2,
            10 * u**3 - 15 * u**4 + 6 * u**5,
            -4 * u**3 + 7 * u**4 - 3 * u**5,
            (u**3 - 2 * u**4 + u**5) / 2,
        ]
        slope = [
            -30 * u**2 + 60 * u**3 - 30 * u**4,
            1 - 18 * u**2 + 32 * u**3 - 15 * u**4,
            (2 * u - 9 * u**2 + 12 * u**3 - 5 * u**4) / 2,
            30 * u**2 - 60 * u**3 + 30 * u**4,
            -12 * u**2 + 28 * u**3 - 15 * u**4,
            (3 * u**2 - 8 * u**3 + 5 * u**4) / 2,
        ]
        return np.array([h @ c, slope @ c / T, (1 - u) * a0 + u * a1, (1 - u) * j0 + u * j1])


class Biquad:
    """One set-force filter by the bilinear transform, as a difference equation."""

    def __init__(self, item: ForceFilter, T_v: float) -> None:
        w, d, c = item.natural_frequency, item.damping, 2 / T_v
        low_pass = item.kind == "low_pass"
        top = [0.0, 0.0, w * w] if low_pass else [1.0, 2 * d * w, w * w]
        bottom = [1.0, 2 * (d if low_pass else item.width) * w, w * w]
        self.b, self.a = (
            [p * c * c + q * c + r, 2 * (r - p * c * c), p * c * c - q * c + r]
            for p, q, r in (top, bottom)
        )
        self.u, self.y = [0.0, 0.0], [0.0, 0.0]

    def __call__(self, u: float) -> float:
        y = self.b[0] * u + self.b[1] * self.u[0] + self.b[2] * self.u[1]
        y = (y - self.a[1] * self.y[0] - self.a[2] * self.y[1]) / self.a[0]
        self.u, self.y = [u, self.u[0]], [y, self.y[0]]
        return y


@dataclass(frozen=True, slots=True)
class Run:
    """Signals at every velocity cycle, and the largest set force before its limit."""

    t: Array
    tool: Array
    encoder: Array
    force: Array
    states: Array
    asked: float


def run(
    machine: Machine, gains: Controller, profile: Moving, *, nominal: Machine, **how: Any
) -> Run:
    """The machine under the cascade; ``nominal`` is what the controller believes it to be."""
    return drive(axis_of(machine), gains, profile, nominal=axis_of(nominal), **how)


def drive(
    axis: Axis,
    gains: Controller,
    profile: Moving,
    *,
    nominal: Axis,
    samples: int,
    force_limit: float = inf,
    push: float = 0.0,
    resolution: float = 0.0,
    phase: float = 0.0,
    coulomb: float = 0.0,
) -> Run:
    """Every velocity cycle.

    ``push`` is a force beside the motor from the beginning on, ``coulomb`` a friction. The encoder
    rounds to whole steps of ``resolution``; at the start it stands ``phase`` of a step beside one.
    """
    T_v, T_r, N = gains.velocity_cycle, gains.reference_model_time, gains.cycles
    K, observer, place = gains.state_gains, gains.observer, gains.position_loop
    seen = list(observer.states)
    A_o, B_o, _ = nominal.over(T_v)
    assert np.allclose(observer.A, A_o[np.ix_(seen, seen)], rtol=1e-9, atol=1e-12)
    assert np.allclose(observer.B, B_o[seen], rtol=1e-9)
    A, B, beside = axis.over(T_v / SLICES if coulomb else T_v)
    rate = axis.encoder @ axis.A
    hand_down = _position_cycle(profile, gains, nominal)
    filters = [Biquad(item, T_v) for item in gains.force_filters]
    X, estimate = np.zeros(len(axis.B)), np.zeros(len(seen))
    z = modelled = before = F_set = asked = 0.0
    computed = in_force = lambda _: (0.0, 0.0, 0.0)
    noted = []
    for k in range(samples):
        y = float(axis.encoder @ X)
        if resolution:
            y = resolution * (round(y / resolution + phase) - phase)
        noted.append((axis.tool @ X, y, F_set, *X))
        if k % N == 0:
            in_force, computed = computed, hand_down(k // N, y)
        c, v_set, f_set = in_force(k % N * T_v)
        if place is PositionLoop.DRIVE:
            c = gains.position_gain * (c - y)
        error = c + gains.velocity_feedforward * v_set - (y - before) / T_v
        u = gains.velocity_gain * (error + z) + f_set - float(K[seen] @ estimate)
        for item in filters:
            u = item(u)
        F_next = min(max(u, -force_limit), force_limit)
        asked = max(asked, abs(u))
        if F_next == u:
            z += T_v / gains.integral_time * (error + (modelled - c if T_r else 0.0))
        if T_r:
            modelled += (1 - exp(-T_v / T_r)) * (c - modelled)
        if seen:
            sensed = np.array([y if s == "encoder" else axis.tool @ X for s in gains.sensors])
            estimate = (
                observer.A @ estimate + observer.B * F_set
                + observer.L @ (sensed - observer.C @ estimate)
            )  # fmt: skip
        given = B * F_set + beside * push
        for _ in range(SLICES if coulomb else 1):
            rubs = coulomb * tanh(rate @ X / CREEP) if coulomb else 0.0
            X = A @ X + given - beside * rubs
        F_set, before = F_next, y
    table = np.array(noted)
    columns = (table[:, 0], table[:, 1], table[:, 2], table[:, 3:])
    return Run(np.arange(samples) * T_v, *columns, asked)


def _position_cycle(
    profile: Moving, gains: Controller, nominal: Axis
) -> Callable[[int, float], Callable[[float], tuple[float, float, float]]]:
    """What cycle n computes: c (the position where the loop is in the drive), v_set, f_set."""
    T_p, T_v, tau = gains.position_cycle, gains.velocity_cycle, gains.reference_delay
    m, K, D = gains.feedforward_mass, gains.state_gains, T_p + (T_p - T_v) / 2
    late, wanted_of = Delayed(profile, T_p), nominal.wanted(m)

    def f_ff(n: int) -> float:
        _, _, a, j = late.sample(n)
        jerk = gains.jerk_feedforward * gains.force_lag * j
        return float(m * (gains.acceleration_feedforward * a + jerk))

    def hand_down(n: int, y: float) -> Callable[[float], tuple[float, float, float]]:
        t = n * T_p
        c = gains.position_gain * float(late(t - tau)[0] - y)
        if gains.position_loop is PositionLoop.CONTROL:
            v = float(late(t - max(tau + T_v / 2 - D, 0.0))[1])
            old = late(t - max(tau - D, 0.0))
            rate = float(K @ wanted_of(np.append(old[1:], 0.0)))
            f = f_ff(n) + float(K @ wanted_of(old)) - rate * (T_p - T_v) / 2
            return lambda s: (c, v, f + rate * s)
        age = max(tau - 2 * T_p, 0.0)
        r0, r1 = late(t - age - T_p), late(t - age)
        f0 = f_ff(n - 1) + float(K @ wanted_of(r0))
        f1 = f_ff(n) + float(K @ wanted_of(r1))
        b = 3 * (r1[0] - r0[0]) - T_p * (2 * r0[1] + r1[1])
        d = 2 * (r0[0] - r1[0]) + T_p * (r0[1] + r1[1])

        def x_d(s: float) -> float:
            u = s / T_p
            return float(r0[0] + T_p * r0[1] * u + b * u**2 + d * u**3)

        def read(s: float) -> tuple[float, float, float]:
            v, f = (x_d(s) - x_d(s - T_v)) / T_v, f0 + (f1 - f0) * s / T_p
            return (x_d(s) if gains.position_loop is PositionLoop.DRIVE else c), v, f

        return read

    return hand_down


def simulate_record(record: Json, move: Json, *, until: float) -> Run:
    """A move of a record through its nominal loop, up to its force limit."""
    loop, plant, ahead = record["loop"], record["plant"], record["loop"]["feedforward"]
    rows = {name: np.array(values) for name, values in plant["outputs"].items()}
    axis = Axis(np.array(plant["A"]), np.array(plant["B"]), rows["tcp"], rows["encoder"])
    own, observer = loop["observer"], NO_OBSERVER
    if own["states"]:
        states = tuple(plant["states"].index(name) for name in own["states"])
        observer = Observer(states=states, **{key: np.array(own[key]) for key in "ABCL"})
    gains = Controller(
        position_loop=PositionLoop(loop["position_loop"]),
        position_gain=loop["Kv"],
        velocity_gain=loop["Kp"],
        integral_time=loop["Tn"],
        reference_model_time=loop["reference_model_time"],
        velocity_feedforward=ahead["velocity"],
        acceleration_feedforward=ahead["acceleration"],
        jerk_feedforward=ahead["jerk"],
        feedforward_mass=ahead["mass"],
        force_lag=loop["force_lag"],
        reference_delay=loop["reference_delay"],
        velocity_cycle=loop["velocity_cycle"],
        cycles=round(loop["position_cycle"] / loop["velocity_cycle"]),
        force_filters=tuple(ForceFilter(**item) for item in loop["force_filters"]),
        sensors=tuple(loop["sensors"]),
        state_gains=np.array([loop["state_feedback"].get(name, 0.0) for name in plant["states"]]),
        observer=observer,
    )
    return drive(
        axis,
        gains,
        profile_of_record(move),
        nominal=axis,
        samples=round(until / gains.velocity_cycle),
        force_limit=loop["motion_force"],
        resolution=loop["encoder_resolution"],
    )


@dataclass(frozen=True, slots=True)
class Judgement:
    """The page's judgement of a motion."""

    settling_time: float
    residual: float
    peak: float


def reference(profile: Moving, t: Array, *, tau: float) -> Array:
    """The setpoint with which the tool is compared."""
    return np.array([profile.at(time - tau)[0] for time in t])


def judge(motion: Run, profile: Profile, *, tau: float, band: float) -> Judgement:
    """Settling time, residual and peak deviation."""
    begin = profile.end + tau
    e = motion.tool - reference(profile, motion.t, tau=tau)
    first = int(np.argmax(motion.t >= begin - 1e-12))
    x_end, v_end = profile.at(profile.end)[:2]
    # Between the samples about t_e + tau the tool is a line, the setpoint rests or coasts.
    t_0, t_1 = motion.t[first - 1 : first + 1]
    before = motion.tool[first - 1] - x_end - v_end * (t_0 - begin)
    at_end = before + (begin - t_0) / (t_1 - t_0) * (e[first] - before)
    t, size = np.append(begin, motion.t[first:]), np.abs(np.append(at_end, e[first:]))
    outside = np.flatnonzero(size > band)
    settled = begin
    if outside.size:
        i = int(outside[-1])
        settled = inf
        if i + 1 < len(t):
            settled = t[i] + (t[i + 1] - t[i]) * (size[i] - band) / (size[i] - size[i + 1])
    return Judgement(float(settled), float(np.max(size)), float(np.max(np.abs(e))))


def rms_force(motion: Run, profile: Profile, *, dwell: float, load: float = 0.0) -> float:
    """Of the motor until the next move begins, with a static load in its worse direction."""
    t = np.linspace(0.0, profile.end + dwell, 20001)
    F = np.interp(t, motion.t, motion.states[:, -1], right=0.0)
    worst = max(np.trapezoid((F + sign * load) ** 2, t) for sign in (1.0, -1.0))
    return sqrt(worst / t[-1])


def quiet_copy(machine: Machine, **changes: object) -> Machine:
    """A machine with some fields of its control block changed."""
    return replace(machine, control=replace(machine.control, **changes))  # type: ignore[arg-type]
