"""The search for the time-optimal control: starts, Newton, and the exchange of structures.

An attempt counts only when the bound that its multipliers prove equals the time that it takes.
"""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.free.dual import Ascent, DualPoint, ascend, evaluate_dual
from mtcommission.optimal.free.dual_start import (
    PARTS,
    CellForce,
    improve,
    refine_cells,
    start_force,
)
from mtcommission.optimal.free.mesh import ROUNDOFF, Mesh
from mtcommission.optimal.free.moments import MomentProblem, independence
from mtcommission.optimal.free.newton_refinement import (
    FEASIBLE,
    BangBang,
    RefinedControl,
    refine_control,
)
from mtcommission.optimal.free.switching import bracket_zeros, has_one_zero

AGREEMENT = 1e-12
"""Relative distance of time and bound at which the search ends at once."""
SUFFICIENT = 1e-10
"""Distance that no finer start is tried for: rounding, not the start, is what is left."""
ROUNDING = 1e-9
"""Doubt about t_f that rounding alone may leave for a refinement to be tried."""
EXCHANGES = 4
"""Changes of structure in a row; one is usual next to the birth of an arc."""
TOLERANCES = (5e-3, 1e-4, 1e-6)
"""Gaps of the starts on the first cells: with two modes five of six attempts succeed from the
first, the next one gives the structure where pairs of zeros are close (empirical)."""
ASCENT_STEPS = 6
"""From each later start."""
REFINEMENTS = 8
"""Divisions; the last has cells of 1e-5 of the fastest period where σ is near zero."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attempt:
    """A feasible control with the time that its multipliers prove."""

    control: BangBang  # The control
    point: DualPoint  # Its multipliers with all zeros of their σ and the time that they prove

    @property
    def gap(self) -> float:
        """Relative distance of both times."""
        return abs(self.control.horizon - self.point.bound) / self.control.horizon


def find_bang_bang(problem: MomentProblem, *, span: float) -> Attempt:
    """Return the time-optimal control as signs over the remaining time.

    Starts of rising accuracy are refined; the last ones take turns with Newton steps on the dual
    bound. An attempt is accepted when the bound that its multipliers prove equals the time that
    it takes.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if no attempt is feasible to ``FEASIBLE``; how far the bound stays behind
        is left to the certificate.
    """
    cells = start_force(problem, span=span, tolerance=TOLERANCES[0])
    best = _exchange(cells.mesh, _seen_control(cells), span)
    for tolerance in TOLERANCES[1:]:
        if best and best.gap <= AGREEMENT:
            return best
        cells = improve(cells, span=span, tolerance=tolerance)
        best = _better(best, _exchange(cells.mesh, _seen_control(cells), span))
    if best and best.gap <= AGREEMENT:
        return best
    # Finer starts help the structure, not the digits that nearly dependent functions cost.
    is_worth = ROUNDING * independence(problem, cells.horizon) > ROUNDOFF
    for refinement in range(REFINEMENTS if is_worth else 0):
        best = _better(best, _climb(cells, span))
        if best and best.gap <= SUFFICIENT:
            return best
        tolerance = TOLERANCES[-1] * PARTS ** -(refinement + 1)
        cells = improve(refine_cells(cells), span=span, tolerance=tolerance)
    if best is None:
        detail = Message("no-control-reaches-rest", span=span, t_f=cells.horizon)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return best


def _better(one: Attempt | None, other: Attempt | None) -> Attempt | None:
    if one is None or other is None:
        return one or other
    return one if one.gap <= other.gap else other


def _climb(cells: CellForce, span: float) -> Attempt | None:
    """Refine from the cells' multipliers and from better ones that Newton steps lead to."""
    point = evaluate_dual(cells.mesh, cells.multipliers, span=span, near=cells.horizon)
    ascent, best = Ascent(point=point), None
    for _ in range(ASCENT_STEPS):
        best = _better(best, _exchange(point.mesh, _proved_control(ascent.point), span))
        if ascent.stalled or (best and best.gap <= AGREEMENT):
            break
        ascent = ascend(ascent, span=span)
    return best


def _exchange(mesh: Mesh, start: BangBang, span: float) -> Attempt | None:
    """Refine; where the multipliers then show other zeros than the control has, do so with those.

    Next to the birth of an arc this is what adds or drops the two zeros.
    """
    best = None
    for _ in range(EXCHANGES):
        refined = refine_control(mesh, start, span=span)
        if refined.residual > FEASIBLE:
            break
        point = confirm(mesh, refined, span=span)
        attempt = Attempt(control=refined.control, point=point)
        best = _better(best, attempt)
        if attempt.gap <= AGREEMENT or point.zeros.size == refined.control.zeros.size:
            break
        start = _proved_control(point)
    return best


def _proved_control(point: DualPoint) -> BangBang:
    return BangBang(
        zeros=point.zeros,
        horizon=point.bound,
        first_sign=point.first_sign,
        multipliers=point.multipliers,
    )


def _seen_control(cells: CellForce) -> BangBang:
    """Return the sign changes of σ between nodes; pairs inside a cell are left out."""
    mesh, c = cells.mesh, cells.multipliers
    last = int(mesh.nodes.searchsorted(cells.horizon))
    values = mesh.values[:, : last + 1]
    sigma = values[-1] - c.dot(values[:-1])
    positive = sigma > 0.0
    at = (positive[1:] != positive[:-1]).nonzero()[0]
    left = sigma[at]
    zeros = mesh.nodes[at] + mesh.lengths[at] * (left / (left - sigma[at + 1]))
    inside = zeros < cells.horizon
    return BangBang(
        zeros=zeros[inside],
        horizon=cells.horizon,
        first_sign=1.0 if sigma[0] > 0.0 else -1.0,
        multipliers=c,
    )


def confirm(mesh: Mesh, refined: RefinedControl, *, span: float) -> DualPoint:
    """Return the multipliers of a control with all zeros of their σ and the time they prove.

    Usually the zeros are just the switches, known to full precision, and ∫|σ| up to the final time
    differs from the span by what is left of the moments; else T' is found anew.
    """
    control, end_value = refined.control, refined.end_value
    c, horizon = control.multipliers, control.horizon
    brackets = bracket_zeros(mesh, c, horizon=horizon, settled=has_one_zero)
    sign = control.first_sign * (-1.0) ** control.zeros.size
    if sign * end_value <= 0.0 or not brackets.isolate(control.zeros, horizon, end_value):
        return evaluate_dual(mesh, c, span=span, near=horizon)
    return DualPoint(
        mesh=mesh,
        multipliers=c,
        bound=horizon - refined.excess / abs(end_value),
        zeros=control.zeros,
        first_sign=control.first_sign,
        end_value=abs(end_value),
        doubt=brackets.doubt,
    )
