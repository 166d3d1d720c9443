"""Continuous blocks at the velocity cycle: the plant behind its hold, set-force filters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.machine.control import ForceFilter
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stage:
    """A discrete single-input single-output block x⁺ = A x + B u, y = C x + D u."""

    A: Array
    B: Array
    C: Array
    D: float


def discretise(plant: Plant, step: float) -> tuple[Array, Array]:
    """Return the zero-order-hold discretisation (A, B) of the plant over one step [s].

    Held is the set force, or the jerk of a motor that follows.
    """
    n = plant.order
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n] = plant.A
    joint[:n, n] = plant.B
    transition = expm(joint * step)
    return transition[:n, :n], transition[:n, n]


def discretise_filter(item: ForceFilter, controller: Controller) -> Stage:
    """Return a set-force filter at the velocity cycle (bilinear transform).

    Of b(s)/a(s) in controllable form, with trapezoidal integration over the cycle:
    x⁺ = (I - A T/2)⁻¹ ((I + A T/2) x + B T u), read halfway between x and x⁺.
    """
    numerator, denominator = filter_polynomials(item)
    half = 0.5 * controller.velocity_cycle
    A = np.array([-denominator[1:], [1.0, 0.0]])
    C = numerator[1:] - numerator[0] * denominator[1:]
    implicit = np.asarray(np.linalg.inv(np.eye(2) - half * A), dtype=np.float64)
    B = 2.0 * half * implicit[:, 0]
    return Stage(
        A=implicit @ (np.eye(2) + half * A),
        B=B,
        C=C @ implicit,
        D=float(numerator[0] + 0.5 * C @ B),
    )


def discretise_disturbance(plant: Plant, step: float) -> Array:
    """Return what a constant force of 1 N beside the motor adds to the plant state over a step [s].

    A disturbance on the line of the drive force enters like the force state, without its lag.
    Shape (n_plant,).
    """
    n = plant.order
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n] = plant.A
    joint[:n, n] = plant.A[:, plant.force]
    joint[plant.force, n] = 0.0
    return np.asarray(expm(joint * step)[:n, n])
