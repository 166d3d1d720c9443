"""Mass and friction from force and motion: the equation of motion under smooth weights.

    F(t - δ) = m y'' + F_c sign(v) + d v + F_0

y is the position less what the modes add to it under the recorded force. Both sides pass the same
Gaussian, which the equation does not feel, before anything is differentiated, and only instants
count whose whole window moves one way: what friction takes at rest nobody can tell.

Source: weak (modulating-function) form after M. Shinbrot, Trans. ASME 79 (1957) 583-588.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from scipy.linalg import expm, solve_banded

from mtcommission.identify.damped import Equations, Regression, regress
from mtcommission.identify.measurement import Array
from mtcommission.machine.identified import Estimate
from mtcommission.machine.plant.plant import Plant
from mtcommission.verify.setpoint import runs
from mtcommission.verify.trace import Role, Trace

REACH = 4.0
"""Half width of the weights in their standard deviations."""

SLOWEST = 0.03
"""Share of the largest velocity below which an axis may stick."""

FEWEST, FEWEST_OF_STRETCH = 60, 8
"""Samples that say something, in all and in a row."""

FEWEST_STRETCHES = 4
"""Stretches that move one way from which on the second half of them is held back."""

UNTESTED = 2.0
"""Factor on the standard errors where no stretch can be held back."""

UNSURE = 0.2
"""Standard error of the mass, relative to it, from which on nothing is said."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBody:
    """What force and motion say."""

    mass: Estimate  # [kg]
    coulomb: Estimate  # [N]
    viscous: Estimate  # [N s/m]
    # Share of the force, by RMS, that is left: of the second half of the moves by a fit to the
    # first; of all where they are few.
    unexplained: float


def fit_rigid_body(traces: Sequence[Trace], plant: Plant) -> RigidBody | None:
    """Return mass and friction; None where force or motion do not suffice."""
    rows = [stretch for trace in traces for stretch in _rows(trace, plant)]
    if not rows or sum(own.values.size for own in rows) < FEWEST:
        return None
    found = _solve(rows)
    sigma = found.sigma if len(rows) >= FEWEST_STRETCHES else UNTESTED * found.sigma
    tested, missed = rows, found.rest
    if len(rows) >= FEWEST_STRETCHES:
        half = len(rows) // 2
        first, second, tested = _solve(rows[:half]), _solve(rows[half:]), rows[half:]
        # What differs between the halves is part of the doubt, whatever the residuals say.
        sigma = np.maximum(sigma, 0.5 * np.abs(second.values - first.values))
        whole = Equations.of(tested)
        missed = whole.values - whole.columns @ first.values
    mass, coulomb, viscous = (
        Estimate(value=float(found.values[k]), sigma=float(sigma[k])) for k in (0, 2, 3)
    )
    if mass.value <= 0.0 or mass.sigma > UNSURE * mass.value:
        return None
    unexplained = float(np.linalg.norm(missed) / np.linalg.norm(Equations.of(tested).values))
    return RigidBody(mass=mass, coulomb=coulomb, viscous=viscous, unexplained=unexplained)


def _solve(rows: Sequence[Equations]) -> Regression:
    """Mass, mass times delay, Coulomb and viscous friction, and an offset."""
    whole = Equations.of(rows)
    if abs(whole.columns[:, 2].sum()) == len(whole.columns):
        whole.columns[:, 4] = 0.0  # one direction alone: a weight and friction look the same
    return regress(whole.columns, whole.values)


def _rows(trace: Trace, plant: Plant) -> list[Equations]:
    """The equations of each stretch that moves one way."""
    force = trace.channels.get(Role.FORCE)
    place = trace.channels.get(Role.ENCODER) or trace.channels.get(Role.TOOL)
    if force is None or place is None or trace.gaps:
        return []
    h = max(force.step, place.step)
    t = np.arange(max(force.t[0], place.t[0]), min(force.t[-1], place.t[-1]), h)
    F, x = np.interp(t, force.t, force.values), np.interp(t, place.t, place.values)
    for number, mode in enumerate(plant.modes):
        gain = mode.measured_gain if Role.ENCODER in trace.channels else mode.tcp_gain
        x = x - gain * _mode_motion(plant, number, F - F[0], h)
    slowest = min((mode.frequency_hz for mode in plant.modes), default=100.0)
    weights = _weights(max(1.0 / (2.0 * pi * slowest), 3.0 * h), h)
    if x.size <= 2 * weights.size:
        return []
    smooth, y = (np.convolve(signal, weights, "valid") for signal in (F, x))
    rate = np.gradient(y, h)
    acceleration = np.gradient(rate, h)
    jerk = np.gradient(acceleration, h)
    reach = (weights.size - 1) // 2
    way = np.sign(rate) * (np.abs(rate) > SLOWEST * np.abs(rate).max())
    # The whole window must move one way.
    sums = np.convolve(way, np.ones(2 * reach + 1), "same")
    one_way = np.abs(sums) >= 2 * reach + 0.5
    columns = np.column_stack([acceleration, jerk, way, rate, np.ones_like(rate)])
    return [
        Equations(columns[first:last], smooth[first:last])
        for first, last in runs(one_way)
        if last - first >= FEWEST_OF_STRETCH
    ]


def _weights(width: float, h: float) -> Array:
    """A Gaussian of unit area over the step."""
    reach = ceil(REACH * width / h)
    bell = np.exp(-0.5 * (h * np.arange(-reach, reach + 1, dtype=np.float64) / width) ** 2)
    return np.asarray(bell / bell.sum())


def _mode_motion(plant: Plant, number: int, force: Array, h: float) -> Array:
    """Q of q'' + 2 ζ ω q' + ω² q = F at the samples, the force held between them."""
    mode = plant.modes[number]
    zeta, omega = mode.damping_ratio, mode.natural_frequency
    joint = np.zeros((3, 3))
    joint[0, 1], joint[1, 2] = 1.0, 1.0
    joint[1, :2] = -(omega**2), -2.0 * zeta * omega
    step = expm(h * joint)
    A, B = step[:2, :2], step[:2, 2]
    # q[n] - tr(A) q[n-1] + det(A) q[n-2] = B_0 F[n-1] + (A_01 B_1 - A_11 B_0) F[n-2]
    driven = B[0] * np.append(0.0, force[:-1])
    driven[2:] += (A[0, 1] * B[1] - A[1, 1] * B[0]) * force[:-2]
    bands = np.outer([1.0, -np.trace(A), np.linalg.det(A)], np.ones(force.size))
    return np.asarray(solve_banded((2, 0), bands, driven), dtype=np.float64)
