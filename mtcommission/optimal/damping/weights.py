"""Time optimum -> balanced weights for the damping functional."""

from __future__ import annotations

import numpy as np

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Weight
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import TimeOptimum, sample_trajectory
from mtcommission.plant.plant import Plant

SAMPLING_ANGLE = 0.02
"""Sampling step times the fastest natural frequency [-]: the quadrature then errs by 1e-8."""

MOST_RADIANS = 1e4
"""Of the fastest mode over the motion: a hundred thousand samples (empirical)."""


def balanced_weights(plant: Plant, reference: TimeOptimum) -> tuple[Weight, ...]:
    """Return the weights with which all terms are equal along the time-optimal motion.

    c_i = ∫ F_set² dt / ∫ x_i² dt over the reference, for the deflection and the rate of each
    flexible mode. Along the damping-optimal motion itself the terms then differ: it is what
    the optimisation is free to change.

    Source: Christiansen, Maurer & Zirn, sec. 6: "all terms ... have the same magnitude". That
    the time-optimal solution of their sec. 5.1 is meant is inferred: it gives (17) to 1 ... 3 %,
    see docs/optimal-control.md, section 9.
    """
    fastest = max(mode.natural_frequency for mode in plant.modes)
    radians = fastest * reference.t_f
    if radians > MOST_RADIANS:
        detail = Message("optimum-too-long", t_f=reference.t_f, radians=radians, most=MOST_RADIANS)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    motion = sample_trajectory(plant, reference.arcs, step=SAMPLING_ANGLE / fastest)
    h = np.diff(motion.t)[:, None]
    x = motion.states
    square, free, pushed = x**2, x @ plant.A.T, np.outer(motion.force[:-1], plant.B)
    # Where F_set acts at once, rates jump at a switch: each cell has slopes of its own.
    start, end = 2.0 * x[:-1] * (free[:-1] + pushed), 2.0 * x[1:] * (free[1:] + pushed)
    corrected = h / 2 * (square[:-1] + square[1:]) + h**2 / 12 * (start - end)
    integrals = corrected.sum(axis=0)
    effort = float((h[:, 0] * motion.force[:-1] ** 2).sum())
    places = [mode.deflection for mode in plant.modes] + [mode.rate for mode in plant.modes]
    return tuple(Weight(state=plant.states[i], value=effort / float(integrals[i])) for i in places)
