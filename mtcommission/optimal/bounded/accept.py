"""Accepting a control: the motion keeps everything, and the multipliers prove its time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.breaches import breaches, overloads
from mtcommission.optimal.bounded.dual import lower_bound
from mtcommission.optimal.bounded.edit import touch_contacts
from mtcommission.optimal.bounded.exchange import LEAST_SLOPE, later
from mtcommission.optimal.bounded.measure import Measure
from mtcommission.optimal.bounded.mesh import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded.motion import Motion, follow, mesh_arcs, sequence_arcs
from mtcommission.optimal.bounded.newton import RESIDUAL, Extremal
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.rows import FORCE, Contact, Layout

Array = NDArray[np.float64]

GAP = 1e-6
"""Largest relative distance of t_f from its proved lower bound."""
LOOSE_GAP = 1e-3
"""The same for a control on a mesh, which is returned with the gap that it has."""
EXCESS = 1e-9
"""Largest relative excess over a bound or the force limit."""
TERMINAL = 1e-9
"""Largest terminal error of a state against its peak."""
FINE = 1e-8
"""Relative excess over a bound between the points that calls for another point at the end."""
SMALL_EXCESS = 2e-7
"""Relative excess that is left to the margin: it costs less than a tenth of the allowed gap."""
POINT_STEPS, FINISHING_STEPS = 16, 24
"""Programs that put in points, and programs at most, until a control on a mesh is finished."""
LATENESS = 1e-8
"""Largest reach beyond 1 of a finished control."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """An accepted control with its proof.

    Parameters
    ----------
    motion
        The control and what it does.
    measure
        The dual point that proves it.
    t_f, t_lower
        Achieved and excluded time [s].
    touches
        Touch points.
    exact
        Whether the arcs are exact; otherwise they are cells of a mesh.
    """

    motion: Motion
    measure: Measure
    t_f: float
    t_lower: float
    touches: tuple[Contact, ...]
    exact: bool

    @property
    def gap(self) -> float:
        """(t_f - t_lower) / t_f."""
        return (self.t_f - self.t_lower) / self.t_f


def accepted(problem: BoundedProblem, extremal: Extremal) -> Found | None:
    """Return the control of a solved sequence with its proof, or None.

    Parameters
    ----------
    problem
        The bounded problem.
    extremal
        As Newton's method left it.

    Returns
    -------
    Found or None
        None if it is not solved, breaks a bound, or its multipliers prove too little.
    """
    sequence = extremal.sequence
    if extremal.residual > RESIDUAL or min(p.duration for p in sequence.pieces) <= 0.0:
        return None
    motion = follow(problem.plant, sequence_arcs(problem, sequence), rate=problem.rate)
    return _proved(problem, motion, extremal.measure, touch_contacts(sequence), exact=True)


def on_mesh(problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum) -> Found | None:
    """Return the mesh control itself, slowed down until it keeps the bounds everywhere.

    Parameters
    ----------
    problem
        The bounded problem.
    kept
        The restriction, whose control it is.
    relaxed
        The relaxation, whose multipliers prove it.

    Returns
    -------
    Found or None
    """
    layout, found, slope = kept.layout, kept, kept.slope
    sizes = kept.sizes[problem.fixed]
    for attempt in range(FINISHING_STEPS):
        over = [
            *breaches(problem, found, tolerance=EXCESS),
            *overloads(problem, found, tolerance=EXCESS),
        ]
        excess = max((breach.excess for breach in over), default=0.0)
        late = 1.0 - found.reach
        if not over and -LATENESS < late <= 0.0:
            arcs = mesh_arcs(problem, found)
            motion = follow(problem.plant, arcs, rate=problem.rate)
            excess = max(_levels(problem, motion)) - 1.0
            if excess < EXCESS:
                acting = (at for at in found.contacts if at.weight > 0.0)
                touches = tuple(at for at in acting if at.limit != FORCE)
                return _proved(problem, motion, relaxed.measure, touches, exact=False)
        found = replace(found, slope=slope)
        # Another point costs less time than a margin kept everywhere; the last bit is the margin's.
        by_points = attempt < POINT_STEPS and excess > SMALL_EXCESS
        fine = [breach.contact for breach in over if breach.excess > FINE and by_points]
        worse = [at for at in fine if not _is_held(layout, at)]
        more = 1.1 * excess if excess > 0.0 and not worse else 0.0
        margin = layout.margin + more
        expected = replace(found, reach=found.reach - more * found.held)
        t_f = later(layout, expected) + 2e-10 / max(slope, LEAST_SLOPE / layout.t_f)
        contacts = tuple(dict.fromkeys([*layout.contacts, *worse]))
        layout = replace(layout, contacts=contacts, margin=margin).stretched(t_f)
        # A control like this one exists, or nearly: a verdict against it is rounding.
        following = solve_mesh(
            problem, layout, relaxed=False, start=found.basis, solvable=True, sizes=sizes
        )
        if following is None:
            return None
        slope = _slope(found, following) if attempt else following.slope
        found = following
    return None


def _is_held(layout: Layout, contact: Contact) -> bool:
    """Return whether a core holds the very bound of a contact there, so that no point can help."""
    return any(
        core.limit == contact.limit and core.holds(contact.remaining) for core in layout.cores
    )


def _slope(before: MeshOptimum, after: MeshOptimum) -> float:
    """Return dα/dt_f: of the way gone if that tells, else the marginal, which knows one cell only.

    Points put in on the way lower the reach; a step that went too far tells nevertheless.
    """
    gone = after.layout.t_f - before.layout.t_f
    secant = (after.reach - before.reach) / gone if gone else 0.0
    same = len(after.layout.contacts) == len(before.layout.contacts)
    too_far = (after.reach - 1.0) * (before.reach - 1.0) < 0.0
    return secant if secant > 0.0 and (same or too_far) else max(after.slope, before.slope)


def _levels(problem: BoundedProblem, motion: Motion) -> list[float]:
    """Return the peaks of the bounded signals and of the force, relative to their bounds."""
    signals = problem.plant.signals
    peaks = [
        float(motion.peaks[signals.index(limit.bound.name)]) / limit.bound.value
        for limit in problem.limits
    ]
    return [*peaks, motion.force_peak / problem.force_limit]


def _proved(
    problem: BoundedProblem,
    motion: Motion,
    measure: Measure,
    touches: tuple[Contact, ...],
    *,
    exact: bool,
) -> Found | None:
    """Return the control with its proof if the motion keeps everything, else None."""
    error = np.abs(motion.final - problem.target)[problem.fixed]
    share = error / motion.peaks[: problem.plant.order][problem.fixed]
    if max(_levels(problem, motion)) > 1.0 + EXCESS or float(share.max()) > TERMINAL:
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
    return found if found.gap <= (GAP if exact else LOOSE_GAP) else None
