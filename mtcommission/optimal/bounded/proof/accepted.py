"""Accepting a control: the motion keeps everything, and the multipliers prove its time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mtcommission.optimal.bounded.places import ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.dual_point import Measure
from mtcommission.optimal.bounded.proof.dual_value import lower_bound
from mtcommission.optimal.bounded.proof.motion import FollowedMotion


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """An accepted control with its proof."""

    motion: FollowedMotion  # The control and what it does
    measure: Measure  # The dual point that proves it
    # t_f, t_lower: Achieved and excluded time [s].
    t_f: float
    t_lower: float
    touches: tuple[ConstraintPoint, ...]  # Touch points
    exact: bool  # Whether the arcs are exact; otherwise they are cells of a mesh

    @property
    def gap(self) -> float:
        """(t_f - t_lower) / t_f."""
        return (self.t_f - self.t_lower) / self.t_f


def proved(
    problem: BoundedProblem,
    motion: FollowedMotion,
    measure: Measure,
    touches: tuple[ConstraintPoint, ...],
    *,
    exact: bool,
) -> Found | None:
    """Return the control with its proof if the motion keeps everything, else None."""
    settings = problem.settings.proof
    error = np.abs(motion.final - problem.target)[problem.fixed]
    share = error / motion.peaks[: problem.plant.order][problem.fixed]
    if (
        max(peak_levels(problem, motion)) > 1.0 + settings.excess
        or float(share.max()) > settings.terminal
    ):
        return None
    t_f = motion.arcs[-1].t_end
    # In remaining time a dual point knows no horizon: it may prove more than the time it is from.
    measure = replace(measure, t_f=t_f)
    found = Found(
        motion=motion,
        measure=measure,
        t_f=t_f,
        t_lower=min(lower_bound(problem, measure), t_f),
        touches=touches,
        exact=exact,
    )
    return found if found.gap <= (settings.gap if exact else settings.loose_gap) else None


def peak_levels(problem: BoundedProblem, motion: FollowedMotion) -> list[float]:
    """Return the peaks of the bounded signals and of the force, relative to their bounds."""
    signals = problem.plant.signals
    peaks = [
        float(motion.peaks[signals.index(limit.bound.name)]) / limit.bound.value
        for limit in problem.limits
    ]
    return [*peaks, motion.force_peak / problem.force_limit]
