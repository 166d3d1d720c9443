"""CasADi and IPOPT as well as we know how: this package's own cross-check.

Fourth-order Gauss scheme, sparse derivatives, zero Hessian for the free time (the true one is
indefinite and makes IPOPT crawl), started from coarser grids.
"""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.answer import Answer
from benchmarks.problems import Problem
from mtcommission.optimal.transcription import transcribe_damping_optimal, transcribe_time_optimal
from mtcommission.optimal.transcription_settings import TranscriptionSettings


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver; it builds its program anew for each grid, inside the solve."""
    settings = TranscriptionSettings(intervals=cells)
    plant, move, F = problem.plant, problem.move, problem.force_limit

    def solve() -> Answer:
        if problem.weights:
            best = transcribe_damping_optimal(
                plant,
                move,
                force_limit=F,
                t_f=problem.t_f,
                weights=problem.weights,
                bounds=problem.bounds,
                settings=settings,
            )
            return Answer(t_f=best.t_f, arcs=best.arcs, cost=best.cost)
        fastest = transcribe_time_optimal(
            plant, move, force_limit=F, bounds=problem.bounds, settings=settings
        )
        return Answer(t_f=fastest.t_f, arcs=fastest.arcs)

    return solve
