"""How long the free motion of a loop lasts, mode by mode."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import LiftedLoop

Array = NDArray[np.float64]

ZERO_POLE = 1e-6
"""Lifted poles this small are dead times and gone after a few cycles."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Decay:
    """Free motion as a sum of closed-loop modes at the tool.

    Parameters
    ----------
    radii
        What is left of each mode after a position cycle, shape (n_modes,) [-].
    sizes
        Its amplitude at the beginning, shape (n_modes,) [m].
    dt
        Position cycle [s].
    """

    radii: Array
    sizes: Array
    dt: float

    def cycles(self, amplitude: float, *, longest: float) -> int:
        """Return after how many position cycles every mode is below an amplitude.

        Parameters
        ----------
        amplitude
            [m].
        longest
            Where the answer is capped: one cycle more than this time [s].
        """
        needed = 0.0
        for radius, size in zip(self.radii, self.sizes, strict=True):
            if size > amplitude:
                own = inf if radius >= 1.0 else np.log(amplitude / size) / np.log(radius)
                needed = max(needed, own)
        return int(min(needed + 1, ceil(longest / self.dt) + 1))

    def left(self, cycles: int) -> float:
        """Return what the tool still moves at most from a position cycle on [m]."""
        return float(np.sum(self.sizes * self.radii**cycles))


def find_decay(lifted: LiftedLoop, transient: Array) -> Decay:
    """Return the modes of a loop's free motion.

    Parameters
    ----------
    lifted
        The loop.
    transient
        Loop state less its steady state, shape (n,).
    """
    z, V = np.linalg.eig(lifted.A)
    alive = np.abs(z) > ZERO_POLE
    shares = np.linalg.lstsq(V, transient.astype(np.complex128), rcond=None)[0]
    tool_rows = [i for i, name in enumerate(lifted.outputs) if name.startswith("tcp[")]
    size = np.max(np.abs(lifted.C[tool_rows] @ (V * shares)), axis=0)
    return Decay(radii=np.abs(z[alive]), sizes=size[alive], dt=lifted.dt)
