"""The motion under a force that is constant on every arc: its end, peaks, and squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import Arc, Trajectory, sample_trajectory
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

SAMPLING_ANGLE = 0.02
"""Sampling step times the fastest natural frequency [-]: the quadrature then errs by 1e-8."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PiecewiseMotion:
    """Samples of the motion, with each switch among them."""

    plant: Plant
    samples: Trajectory

    @property
    def final(self) -> Array:
        """State at the end, shape (n,)."""
        return np.asarray(self.samples.states[-1])

    def _slopes(self) -> tuple[Array, Array]:
        """Rates of the states at both ends of each cell: they may jump where the force does."""
        free = self.samples.states @ self.plant.A.T
        pushed = np.outer(self.samples.force[:-1], self.plant.B)
        return free[:-1] + pushed, free[1:] + pushed

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals``, by cubics between the samples."""
        rows, (start, end) = signal_rows(self.plant).T, self._slopes()
        values = self.samples.states @ rows
        return hermite_peaks(
            np.diff(self.samples.t),
            values[:-1],
            values[1:],
            start_rate=start @ rows,
            end_rate=end @ rows,
        )

    @property
    def effort(self) -> float:
        """Integral of F_set² [N² s]."""
        return float(np.diff(self.samples.t) @ self.samples.force[:-1] ** 2)

    @property
    def squares(self) -> Array:
        """Integrals of the squared states, by the trapezoidal rule with corrected ends."""
        h, x, (start, end) = np.diff(self.samples.t), self.samples.states, self._slopes()
        corrected = (x[:-1] ** 2 + x[1:] ** 2) / 2.0
        corrected += h[:, None] / 6.0 * (x[:-1] * start - x[1:] * end)
        return np.asarray(h @ corrected)


def follow_piecewise(plant: Plant, arcs: tuple[Arc, ...], *, longest: float) -> PiecewiseMotion:
    """Return the motion from rest, sampled at least every ``longest`` seconds.

    Examples
    --------
    A constant force moves the rigid mass of 750 kg, but for the lag of 2.5 ms.

    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.optimal.solution import Bang, constant_arc
    >>> from mtcommission.plant.plant import build_plant
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> arc = constant_arc(0.0, 1.0, control=Bang(1), force=750.0)
    >>> motion = follow_piecewise(plant, (arc,), longest=1.0)
    >>> round(float(motion.final[plant.velocity]), 6)
    0.9975
    """
    fastest = max(mode.natural_frequency for mode in plant.modes)
    step = min(SAMPLING_ANGLE / fastest, longest)
    return PiecewiseMotion(plant=plant, samples=sample_trajectory(plant, arcs, step=step))
