"""The loop from ``record.json`` alone, by the letter of docs/feedback-loop.md, on numpy.

Shares no code with the package, nor with the other second program: the plant is advanced by a
matrix exponential, the controller step by step in the page's order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, factorial, floor, inf
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Array = NDArray[np.float64]
Json = dict[str, Any]

ROUNDING = 1e-9


def setpoint_of(move: Json) -> Callable[[float], Array]:
    """x, v, a, j at any time, of the segments of a move in the record."""
    entry, coasts = move["setpoint"], "velocity_step" in move["move"]
    lengths = [segment["duration"] for segment in entry["segments"]]
    jerks = [segment["jerk"] for segment in entry["segments"]]
    item = entry["setpoint_filter"] or {"delays": [0], "shares": [1], "time": 0, "second_time": 0}
    knots = np.add.outer(item["delays"], np.concatenate([[0.0], np.cumsum(lengths)])).ravel()
    steps = np.outer(item["shares"], np.diff(jerks, prepend=0.0, append=0.0)).ravel()
    means = [item[key] for key in ("time", "second_time") if item[key]]
    end = float(knots[-1]) + sum(means)

    def powers(t: float) -> Array:
        s = t - knots
        on = steps * (s >= -ROUNDING)
        s = np.maximum(s, 0.0)
        return np.array([on @ s**k / factorial(k) for k in (5, 4, 3, 2, 1, 0)])

    def averaged(t: float, behind: list[float]) -> Array:
        if not behind:
            return powers(t)
        T, *rest = behind
        return np.asarray(averaged(t, rest) - averaged(t - T, rest))[:-1] / T

    def inside(t: float) -> Array:
        return averaged(t, means)[2 - len(means) :][:4]

    def at(t: float) -> Array:
        if t < -ROUNDING:
            return np.zeros(4)
        if t < end - ROUNDING:
            return inside(t)
        x, v = inside(end)[:2]
        v = v if coasts else 0.0
        return np.array([x + v * (t - end), v, 0.0, 0.0])

    return at


def some_time_ago(r: Callable[[float], Array], t: float, T: float) -> Array:
    """The setpoint from its samples at the position cycle."""
    n = floor(t / T + ROUNDING)
    u = t / T - n
    if u < ROUNDING:
        return r(n * T)
    (x0, v0, a0, j0), (x1, v1, a1, j1) = r(n * T), r((n + 1) * T)
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


class Filter:
    """A force filter by the bilinear transform, as a difference equation."""

    def __init__(self, item: Json, T_v: float) -> None:
        w, zeta, c = item["natural_frequency"], item["damping"], 2 / T_v
        low_pass = item["kind"] == "low_pass"
        top = [0.0, 0.0, w * w] if low_pass else [1.0, 2 * zeta * w, w * w]
        bottom = [1.0, 2 * (zeta if low_pass else item.get("width", 1.0)) * w, w * w]
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
class Motion:
    """Tool, set force and plant state at every velocity cycle; what was asked for at most."""

    t: Array
    tool: Array
    states: Array
    asked: float


def simulate_record(record: Json, move: Json, *, until: float) -> Motion:
    """A move of the record through its nominal loop, up to its force limit."""
    loop, plant, r = record["loop"], record["plant"], setpoint_of(move)
    T_p, T_v, Kv = loop["position_cycle"], loop["velocity_cycle"], loop["Kv"]
    tau, T_r = loop["reference_delay"], loop["reference_model_time"]
    N, place, limit = round(T_p / T_v), loop["position_loop"], loop["motion_force"]
    ahead, states = loop["feedforward"], plant["states"]
    m, D = ahead["mass"], T_p + (T_p - T_v) / 2
    n = len(states)
    A_c = np.array(plant["A"])
    joint = expm(T_v * np.vstack([np.column_stack([A_c, plant["B"]]), np.zeros(n + 1)]))
    A, B = joint[:n, :n], joint[:n, n]
    row = {name: np.array(values) for name, values in plant["outputs"].items()}
    K = np.array([loop["state_feedback"].get(name, 0.0) for name in states])
    seen = [states.index(name) for name in loop["observer"]["states"]]
    A_o, B_o, C_o, L = (np.array(loop["observer"][k]) for k in "ABCL")
    wanted_of = _wanted(A_c, row["encoder"], m)

    def f_ff(t: float) -> float:
        _, _, a, j = r(t)
        return float(m * (ahead["acceleration"] * a + ahead["jerk"] * loop["force_lag"] * j))

    def late(t: float) -> Array:
        return some_time_ago(r, t, T_p)

    def hand_down(t: float, y: float) -> Callable[[float], tuple[float, float, float]]:
        c = Kv * (late(t - tau)[0] - y)
        if place == "control":
            v = late(t - max(tau + T_v / 2 - D, 0.0))[1]
            old = late(t - max(tau - D, 0.0))
            rate = K @ wanted_of(np.append(old[1:], 0.0))
            f = f_ff(t) + K @ wanted_of(old) - rate * (T_p - T_v) / 2
            return lambda s: (c, v, f + rate * s)
        age = max(tau - 2 * T_p, 0.0)
        r0, r1 = late(t - age - T_p), late(t - age)
        f0, f1 = f_ff(t - T_p) + K @ wanted_of(r0), f_ff(t) + K @ wanted_of(r1)
        b = 3 * (r1[0] - r0[0]) - T_p * (2 * r0[1] + r1[1])
        d = 2 * (r0[0] - r1[0]) + T_p * (r0[1] + r1[1])

        def x_d(s: float) -> float:
            u = s / T_p
            return float(r0[0] + T_p * r0[1] * u + b * u**2 + d * u**3)

        def read(s: float) -> tuple[float, float, float]:
            v = (x_d(s) - x_d(s - T_v)) / T_v
            return (x_d(s) if place == "drive" else c), v, f0 + (f1 - f0) * s / T_p

        return read

    filters = [Filter(item, T_v) for item in loop["force_filters"]]
    X, estimate = np.zeros(n), np.zeros(len(seen))
    z = lagged = y_before = F_set = asked = 0.0
    computed = in_force = lambda s: (0.0, 0.0, 0.0)
    noted = []
    for k in range(round(until / T_v)):
        y = float(row["encoder"] @ X)
        if loop["encoder_resolution"]:
            y = loop["encoder_resolution"] * round(y / loop["encoder_resolution"])
        noted.append((row["tcp"] @ X, F_set, *X))
        if k % N == 0:
            in_force, computed = computed, hand_down(k * T_v, y)
        c, v_set, f_set = in_force(k % N * T_v)
        if place == "drive":
            c = Kv * (c - y)
        error = c + ahead["velocity"] * v_set - (y - y_before) / T_v
        u = loop["Kp"] * (error + z) + f_set - float(K[seen] @ estimate)
        for item in filters:
            u = item(u)
        F_next = min(max(u, -limit), limit)
        asked = max(asked, abs(u))
        if F_next == u:
            z += T_v / loop["Tn"] * (error + (lagged - c if T_r else 0.0))
        if T_r:
            lagged += (1 - exp(-T_v / T_r)) * (c - lagged)
        if seen:
            sensed = np.array([y if s == "encoder" else row[s] @ X for s in loop["sensors"]])
            estimate = A_o @ estimate + B_o * F_set + L @ (sensed - C_o @ estimate)
        X, F_set, y_before = A @ X + B * F_set, F_next, y
    table = np.array(noted)
    return Motion(np.arange(len(table)) * T_v, table[:, 0], table[:, 2:], asked)


def _wanted(A: Array, encoder: Array, m: float) -> Callable[[Array], Array]:
    """Rigid motion along the setpoint, every mode at its static deflection under m a.

    The plant's own equations tell which states are which: a position is a state whose rate is
    another state; it is the rigid one if nothing draws it back.
    """
    n, F = len(A), len(A) - 1
    by = np.zeros((n, 4))
    by[F, 2] = m
    for place in range(n):
        rate = np.flatnonzero(A[place] == 1.0)
        if rate.size != 1 or np.count_nonzero(A[place]) != 1 or rate[0] == F:
            continue
        if A[rate[0], place] == 0.0:
            by[place, 0] = by[rate[0], 1] = 1.0
        else:
            by[place, 2] = by[rate[0], 3] = -m * A[rate[0], F] / A[rate[0], place]
    assert encoder @ by[:, 0] == 1.0
    return lambda r: by @ r


@dataclass(frozen=True, slots=True)
class Verdict:
    """The page's judgement of a motion."""

    settling_time: float
    residual: float
    peak: float


def judge_record(motion: Motion, move: Json, *, tau: float, band: float) -> Verdict:
    """Settling time, residual and peak deviation."""
    r, t_e = setpoint_of(move), move["setpoint"]["duration"]
    begin = t_e + tau
    e = motion.tool - np.array([r(t - tau)[0] for t in motion.t])
    first = int(np.argmax(motion.t >= begin - 1e-12))
    x_end, v_end = r(t_e)[:2]
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
    return Verdict(float(settled), float(np.max(size)), float(np.max(np.abs(e))))
