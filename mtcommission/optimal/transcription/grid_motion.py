"""The exact motion under a force that is constant between grid points: states, peaks, cost."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.machine.machine import Weight
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import Arc, ArcControl, Bang, Interior, constant_arc
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

QUADRATURE_NODES = 6
"""Of Gauss' rule in each interval, over which a grid lets no mode turn far."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridMotion:
    """The motion under a force that is constant between grid points."""

    plant: Plant  # Plant with n states
    control: Array  # F_set on each interval, shape (N,) [N]
    states: Array  # At the grid points, shape (N + 1, n)
    t_f: float  # End [s]

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals``, by cubics between grid points."""
        plant, control, states = self.plant, self.control, self.states
        rows = signal_rows(plant)
        drift, push = states @ plant.A.T @ rows.T, np.outer(control, rows @ plant.B)
        values = states @ rows.T
        return hermite_peaks(
            np.full(control.size, self.t_f / control.size),
            values[:-1],
            values[1:],
            start_rate=drift[:-1] + push,
            end_rate=drift[1:] + push,
        )

    def cost_terms(self, weights: tuple[Weight, ...]) -> Array:
        """Return the integrals of F_set² and of each weighted square of a state [N² s]."""
        plant, step = self.plant, self.t_f / self.control.size
        z = np.column_stack([self.states[:-1], self.control])
        squares = np.zeros(plant.order + 1)
        for node, share in zip(*np.polynomial.legendre.leggauss(QUADRATURE_NODES), strict=True):
            inside = z @ _held_input(plant, step * (1.0 + node) / 2.0).T
            squares += share * step / 2.0 * (inside**2).sum(axis=0)
        terms = [weight.value * squares[plant.states.index(weight.state)] for weight in weights]
        return np.array([squares[-1], *terms])


def follow_grid(plant: Plant, control: Array, *, t_f: float) -> GridMotion:
    """Return the motion from rest.

    Examples
    --------
    A constant force moves the rigid mass of 750 kg, but for the lag of 2.5 ms.

    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> motion = follow_grid(plant, np.full(10, 750.0), t_f=1.0)
    >>> round(float(motion.states[-1, plant.velocity]), 6)
    0.9975
    """
    n = plant.order
    transition = _held_input(plant, t_f / control.size)
    Phi, Gamma = transition[:n, :n], np.outer(control, transition[:n, n])
    states = np.zeros((control.size + 1, n))
    for k in range(control.size):
        states[k + 1] = Phi @ states[k] + Gamma[k]
    return GridMotion(plant=plant, control=control, states=states, t_f=t_f)


def grid_arcs(control: Array, *, t_f: float, force_limit: float) -> tuple[Arc, ...]:
    """Return one arc for each run of equal saturated intervals, and for each other interval."""
    N = control.size
    saturated = np.abs(control) == force_limit
    joined = saturated[1:] & (control[1:] == control[:-1])
    starts = [0, *(np.flatnonzero(~joined) + 1).tolist(), N]
    arcs = []
    for start, end in pairwise(starts):
        kind: ArcControl = Interior()
        if saturated[start]:
            kind = Bang(1 if control[start] > 0.0 else -1)
        t_start, t_end = start * t_f / N, t_f if end == N else end * t_f / N
        arcs.append(constant_arc(t_start, t_end, control=kind, force=float(control[start])))
    return tuple(arcs)


def _held_input(plant: Plant, step: float) -> Array:
    """Return the transition of (x, u) over a time in which u is constant."""
    n = plant.order
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = plant.A, plant.B
    return np.asarray(expm(joint * step))
