"""Optimal controls of a motor that follows, told in the states of its plant.

They are found on ``plant.driven_at_once``, which has no state for the acceleration: what is set
acts at once. In the plant's own states the acceleration F is what is set.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.solution import Bound, MotionPeaks, Optimum, Proof

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PeaksWithForce:
    """Peaks of a motion with that of what is set."""

    motion: MotionPeaks  # Of ``driven_at_once``
    force: int  # Index of F among the plant's signals

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals`` on [0, t_f]."""
        return np.insert(self.motion.peaks, self.force, self.motion.force_peak)

    @property
    def force_peak(self) -> float:
        """Largest magnitude of what is set [N]."""
        return self.motion.force_peak


def optimum_on(plant: Plant, found: Optimum[Proof]) -> Optimum[Proof]:
    """Return an optimal control in the states of the plant."""
    if not plant.follows:
        return found
    proof = found.certificate
    return replace(
        found,
        terminal_error=np.append(found.terminal_error, 0.0),
        motion=PeaksWithForce(motion=found.motion, force=plant.force),
        certificate=replace(proof, adjoint_initial=np.append(proof.adjoint_initial, np.nan)),
    )


def least_limit(plant: Plant, force_limit: float, bounds: Iterable[Bound]) -> float:
    """Return the force limit, or a lower bound on the acceleration of a motor that follows."""
    return min((force_limit, *(one.value for one in bounds if not _on_state(plant, one))))


def on_states(plant: Plant, bounds: Iterable[Bound]) -> tuple[Bound, ...]:
    """Return the bounds but for those that ``least_limit`` covers."""
    return tuple(one for one in bounds if _on_state(plant, one))


def _on_state(plant: Plant, bound: Bound) -> bool:
    return not plant.follows or bound.name != plant.states[plant.force]
