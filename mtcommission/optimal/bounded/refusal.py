"""Why bounds cannot be kept within a given final time, in numbers."""

from __future__ import annotations

from math import isfinite

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Move
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded.problem import all_bounds, bounded_problem, describe_bounds
from mtcommission.optimal.bounded.program.grid import solve_grid_time
from mtcommission.optimal.bounded.program.smallest_bound import smallest_factor_by
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import Bound
from mtcommission.plant.plant import Plant


def explain_short_time(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, bounds: tuple[Bound, ...]
) -> ComputationError | None:
    """Return the refusal of bounds that cannot be kept by t_f; None if that is not the reason."""
    every = all_bounds(plant, move, bounds)
    t_free = solve_time_optimal(plant, move, force_limit=force_limit).t_f
    problem = bounded_problem(plant, move, force_limit=force_limit, bounds=every, horizon=t_f)
    least = smallest_factor_by(problem, t_f)
    if not isfinite(least) or least < 1.0 + problem.settings.program.undecided:
        return None
    try:
        need = Message("bounds-take-some", t_f=solve_grid_time(problem, t_free=t_free).t_f)
    except ComputationError as error:
        if error.outcome is Outcome.BOUND_CANNOT_HOLD:
            return error
        need = Message("bounds-take-longer")
    detail = Message(
        "bounds-need-longer",
        t_f=t_f,
        bounds=describe_bounds(plant, every),
        need=need,
        possible=describe_bounds(plant, every, kind="signal-bound-about", factor=least),
        together=Message("bounds-widened-alike") if len(every) > 1 else None,
    )
    return ComputationError(Outcome.FINAL_TIME_TOO_SHORT, detail)
