"""What a tool answers, and a judgement of it that no tool has a part in.

Every control is a row of pieces, each the output of a small linear system, so that it can be
integrated exactly: plant and control together by one matrix exponential, in scaled states.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, hypot, nan, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from benchmarks.problems import Problem
from mtcommission.optimal.control import Arc, Interior

Array = NDArray[np.float64]

SAMPLES = 4000
"""Least number of samples of a whole motion, for its largest values between grid points."""
LEAST_SAMPLES = 8
"""Samples of one piece."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Answer:
    """A control, in SI units.

    Parameters
    ----------
    t_f
        Final time that the tool claims [s].
    arcs
        Its control from 0 to t_f.
    cost
        Value of the functional that the tool claims [N² s]; nan for time-optimal problems.
    lower_bound
        Proved lower bound of t_f [s]; nan if the tool proves none.
    """

    t_f: float
    arcs: tuple[Arc, ...]
    cost: float = nan
    lower_bound: float = nan


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What an answer is worth, by exact integration.

    Parameters
    ----------
    terminal_error
        Largest |x - target| at t_f in units of what F_max could cause [-].
    residual
        Vibration of the tool that remains after t_f, amplitude, all modes added [m].
    violation
        Largest excess over a limit on force or state anywhere, over that limit [-]; negative
        where none is reached.
    """

    terminal_error: float
    residual: float
    violation: float


def grid_answer(problem: Problem, coefficients: Array, *, time: float, cost: float = nan) -> Answer:
    """Return the answer of a tool that divides the time evenly.

    Parameters
    ----------
    problem
        The problem.
    coefficients
        Shape (N, d + 1): u = Σ c_i s^i on each interval, s from 0 to 1.
    time
        Final time in units of the scaled problem.
    cost
        Of the scaled functional.
    """
    t_f = float(time) * problem.time_unit
    count, degrees = coefficients.shape
    length = t_f / count
    factorials = np.cumprod(np.concatenate([[1.0], np.arange(1.0, degrees)]))
    shift = np.diag(np.ones(degrees - 1), 1) / length
    output = np.zeros(degrees)
    output[0] = problem.force_limit
    arcs = tuple(
        Arc(
            t_start=i * length,
            t_end=(i + 1) * length,
            control=Interior(),
            generator=shift,
            initial=row * factorials,
            output=output,
        )
        for i, row in enumerate(coefficients)
    )
    return Answer(t_f=t_f, arcs=arcs, cost=float(cost) * problem.force_limit**2 * t_f)


def judge(problem: Problem, answer: Answer) -> Judgement:
    """Return what the control does to the plant, integrated exactly."""
    plant, scale = problem.plant, problem.state_scale
    rows = np.array([plant.row(b.name) / b.value for b in problem.bounds]).reshape(-1, plant.order)
    rows = rows * scale
    x, largest = np.zeros(plant.order), 0.0
    cache: dict[object, Array] = {}
    for arc in answer.arcs:
        length = arc.t_end - arc.t_start
        # Ends of equal intervals differ in the last bits, which is no reason for a new matrix.
        key = (id(arc.generator), id(arc.output), f"{length:.11e}")
        if key not in cache:
            cache[key] = _samples_of(problem, arc, length, whole=answer.t_f)
        motion = cache[key] @ np.concatenate([x, arc.initial])
        x = motion[-1, : plant.order]
        force = motion[:, plant.order :] @ arc.output / problem.force_limit
        largest = max(largest, float(np.abs(force).max()))
        if rows.size:
            largest = max(largest, float(np.abs(motion[:, : plant.order] @ rows.T).max()))
    scaled = problem.scaled()
    error = np.abs(x - scaled.target)[scaled.fixed]
    return Judgement(
        terminal_error=float(error.max()),
        residual=_residual(problem, x * scale),
        violation=largest - 1.0,
    )


def _samples_of(problem: Problem, arc: Arc, length: float, *, whole: float) -> Array:
    """Transitions from the start of a piece to its samples, shape (count + 1, n + k, n + k)."""
    plant, scale = problem.plant, problem.state_scale
    n, k = plant.order, arc.initial.size
    joint = np.zeros((n + k, n + k))
    joint[:n, :n] = plant.A * scale / scale[:, None]
    joint[:n, n:] = np.outer(plant.B / scale, arc.output)
    joint[n:, n:] = arc.generator
    count = max(LEAST_SAMPLES, ceil(SAMPLES * length / whole))
    return np.asarray(expm(joint * np.linspace(0.0, length, count + 1)[:, None, None]))


def _residual(problem: Problem, x: Array) -> float:
    total = 0.0
    for mode in problem.plant.modes:
        omega, zeta = mode.natural_frequency, mode.damping_ratio
        q, rate = x[mode.deflection] / mode.scale, x[mode.rate] / mode.scale
        swing = (rate + zeta * omega * q) / (omega * sqrt(1.0 - zeta**2))
        total += abs(mode.tcp_gain) * hypot(q, swing)
    return total
