"""What the multipliers of the band prove: a time before which nothing reaches the target.

For any multipliers λ of the free motion's deviations e(s_i), with any κ for positioning,

    target = ∫ ψ F_set dτ = ∫ σ F_set dτ + Σ λ_i e(s_i) + (deg m + Σ λ_i) y
           <= F ∫|σ| dτ + band (Σ|λ_i| + |deg m + Σ λ_i|),

    σ = ψ - κ - Σ λ_i Re Σ_k C_k e^{p_k (s_i + τ)},

since |y| <= band, too: e swings about -y for ever. max_velocity adds atoms of its own.
"""

from __future__ import annotations

import numpy as np

from mtcommission.optimal.band.program import CellForce, Question, combs, solve_cells
from mtcommission.optimal.free.moments import moment_problem, moment_rows
from mtcommission.optimal.problem import all_bounds, bounded_problem
from mtcommission.optimal.proof import Atom, Measure, excluded_time


def prove_time(question: Question, cells: CellForce) -> float:
    """Return a time before which no admissible force reaches a state that keeps the band.

    Source: docs/optimal-control.md, section 6.
    """
    plant, move, (tail,) = question.plant, question.move, question.tails
    bounds = all_bounds(plant, move, ())
    if bounds:
        edges = cells.edges
        cells = solve_cells(question, edges, cells.contacts, watched=combs(edges))
    weights = cells.multipliers @ tail.responses(cells.contacts.s)
    problem = moment_problem(plant, move)
    c = np.zeros(problem.size)
    pairs = np.empty(2 * weights.size)
    pairs[0::2], pairs[1::2] = weights.real, -weights.imag
    c[: problem.one] = pairs[: problem.one]
    if question.degree:
        c[-1] = cells.momentum_multiplier
    rows = moment_rows(plant, problem)
    unbalanced = question.degree * plant.moving_mass + float(cells.multipliers.sum())
    spent = question.band * (float(np.abs(cells.multipliers).sum()) + abs(unbalanced))
    measure = Measure(
        t_f=cells.t_f,
        terminal=rows[-1] - c @ rows[:-1],
        atoms=tuple(
            Atom(remaining=tau, limit=0, weight=weight * bound.value / len(comb))
            for bound in bounds
            for comb, weight in zip(
                cells.watched.tolist(), cells.velocity_multipliers.tolist(), strict=True
            )
            if weight
            for tau in comb
        ),
        interiors=(),
    )
    bounded = bounded_problem(
        plant, move, force_limit=question.force_limit, bounds=bounds, horizon=cells.t_f
    )
    return excluded_time(bounded, measure, claim=question.target - spent)
