"""Friction on the line of the drive, as a law between force and velocity over one cycle.

    F = -F_c sign(v) - d v,   |F| <= F_c at rest

v is the velocity between motor and guide, i.e. that of the encoder. The law is solved at the end
of the cycle together with the motion (time stepping after Moreau): the force of the cycle is the
one with which the velocity obeys the law, or stops. So the axis sticks exactly, at any cycle, and
without the slope at zero velocity of a tanh model, which lets a loaded axis creep.

Source: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, CISM 302,
1988; D. Karnopp, ASME J. Dyn. Sys. 107 (1985) 100-103 for stick as a state of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.discrete import discretise_disturbance
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Friction:
    """Friction of a plant over one velocity cycle.

    Parameters
    ----------
    coulomb, viscous
        F_c [N], d [N s/m].
    velocity
        Velocity that rubs, as a row over the plant's states, shape (n,).
    push
        What 1 N over the cycle adds to the state, shape (n,).
    """

    coulomb: float
    viscous: float
    velocity: Array
    push: Array

    def force(self, free: Array) -> Array:
        """Return the force of the cycle.

        Parameters
        ----------
        free
            Plant states at the end of the cycle without friction, shape (n, m).
        """
        v, gain = self.velocity @ free, float(self.velocity @ self.push)
        sliding = (v - np.sign(v) * gain * self.coulomb) / (1.0 + gain * self.viscous)
        after = np.where(np.abs(v) <= gain * self.coulomb, 0.0, sliding)
        return np.asarray((after - v) / gain)


def find_friction(plant: Plant, *, coulomb: float, viscous: float, step: float) -> Friction | None:
    """Return the friction of a plant; None where there is none.

    Parameters
    ----------
    plant
        The machine.
    coulomb, viscous
        F_c [N], d [N s/m].
    step
        Velocity cycle [s].
    """
    if coulomb == 0.0 and viscous == 0.0:
        return None
    return Friction(
        coulomb=coulomb,
        viscous=viscous,
        velocity=plant.row("encoder") @ plant.A,
        push=discretise_disturbance(plant, step),
    )
