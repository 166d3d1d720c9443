"""The adjoint that multipliers of the bounded problem give, stretch by stretch.

A dual point is a row Λ for the terminal state and a signed measure for each bound: atoms at touch
points and ends of boundary arcs, a density along the arcs ("interiors"), where it keeps σ = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.places import ArcInterior
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.sigma import largest_outputs
from mtcommission.optimal.closed_form import transition

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Atom:
    """A point mass of the measure of one bound."""

    remaining: float  # Where, as remaining time [s]
    limit: int  # Index of the bound
    weight: float  # Signed mass; positive where c x = +1 is held


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measure:
    """A dual point."""

    t_f: float  # Horizon [s]
    terminal: Array  # Λ, shape (n,)
    atoms: tuple[Atom, ...]  # Point masses
    # Intervals where the measure has the density that keeps σ = 0.
    interiors: tuple[ArcInterior, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stretch:
    """A piece of the adjoint without jumps."""

    # start, end: Remaining times, start > end [s].
    start: float
    end: float
    adjoint: Array  # Λ at its end, shape (n,)
    limit: int  # Index of the bound held on it; -1 off the interiors
    slack: float = 0.0  # What putting Λ on σ = 0 at its end may cost

    @property
    def length(self) -> float:
        """Duration [s]."""
        return self.start - self.end


def stretches(problem: BoundedProblem, measure: Measure) -> tuple[Stretch, ...]:
    """Return the adjoint, stretch by stretch in order of time.

    Source: docs/optimal-control-bounds.md, section 3.
    """
    done: list[Stretch] = []
    end, adjoint = 0.0, measure.terminal
    for stop, interior, jump in _events(problem, measure):
        if stop > end:
            part = Stretch(start=stop, end=end, adjoint=adjoint, limit=-1)
            if interior is not None:
                part = _settled(problem, replace(part, limit=interior.limit), t_f=measure.t_f)
            done.append(part)
            adjoint = adjoint_before(problem, part)
            end = stop
        adjoint = adjoint - jump
    return tuple(reversed(done))


def _settled(problem: BoundedProblem, interior: Stretch, *, t_f: float) -> Stretch:
    """Return an interior with σ = σ' = ... = 0 at its end, which the multipliers miss by rounding.

    A miss grows over the interior like (rate · length)^(r-1), and with it over all before. The
    step of Λ by w_j c (A/rate)^j that removes it is worth w_j c (A/rate)^j x of the motion; for
    j = 0 it is an atom, for the others its largest value over all motions is the slack.
    """
    limit = problem.limits[interior.limit]
    weights = interior.adjoint @ limit.impulses
    worth = np.append(1.0, largest_outputs(problem, limit.output_chain[1:], t_f=t_f))
    return replace(
        interior,
        adjoint=interior.adjoint - weights @ limit.output_chain,
        slack=float(np.abs(weights) @ worth),
    )


def _events(
    problem: BoundedProblem, measure: Measure
) -> list[tuple[float, ArcInterior | None, Array]]:
    """Return (end of a stretch, interior that covers it, jump there), by remaining time."""
    still = np.zeros(problem.plant.order)
    events: list[tuple[float, int, ArcInterior | None, Array]] = [(measure.t_f, 2, None, still)]
    for interior in measure.interiors:
        events += [(interior.end, 1, None, still), (interior.start, -1, interior, still)]
    for atom in measure.atoms:
        # At the late end of an interior the atom acts before it, at the early end after it.
        jump = atom.weight * problem.limits[atom.limit].row
        inside = next(
            (interior for interior in measure.interiors if interior.holds(atom.remaining)), None
        )
        events.append((atom.remaining, 0, inside, jump))
    ordered = sorted(events, key=lambda event: (event[0], event[1]))
    return [(stop, interior, jump) for stop, _, interior, jump in ordered]


def adjoint_before(problem: BoundedProblem, stretch: Stretch) -> Array:
    """Return Λ at the start of a stretch, shape (n,)."""
    if stretch.limit < 0:
        flow: Array = transition(problem.plant, np.array(stretch.length))
    else:
        flow = problem.limits[stretch.limit].adjoint_flow.over(stretch.length).T
    return np.asarray(stretch.adjoint @ flow)


def sigma_sign(problem: BoundedProblem, parts: tuple[Stretch, ...], remaining: float) -> int:
    """Return the sign of σ at a remaining time off the interiors."""
    part = next(part for part in parts if part.end <= remaining <= part.start)
    flow = transition(problem.plant, np.array(remaining - part.end))
    return 1 if float(part.adjoint @ flow @ problem.plant.B) > 0.0 else -1
