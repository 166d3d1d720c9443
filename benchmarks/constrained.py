"""Time-optimal control under bounds: CPU seconds, gaps and the same problem as one large program.

    python -m benchmarks.constrained
    python -m benchmarks.constrained survey [COUNT [FIRST SEED]]

The peer is direct transcription as a linear program on an even grid for the t_f that we found:
its reachable multiple of the target says by how much a grid misses the optimum.
"""

from __future__ import annotations

import sys
from time import process_time

from benchmarks.constrained_survey import survey
from mtcommission.errors import ComputationError
from mtcommission.machine import Move, Positioning, VelocityStep
from mtcommission.optimal import bounded_grid
from mtcommission.optimal.bounded_problem import bounded_problem
from mtcommission.optimal.constrained import solve_bounded_time_optimal
from mtcommission.optimal.solution import Bound
from mtcommission.optimal.time_optimal import solve_time_optimal
from mtcommission.plant import build_plant
from tests.machines import paper_machine

STEP = VelocityStep(velocity_step=0.1)
CASES: tuple[tuple[Move, tuple[Bound, ...]], ...] = (
    (STEP, (Bound(name="v_phi", value=0.02),)),
    (STEP, (Bound(name="v_phi", value=0.01),)),
    (STEP, (Bound(name="v_phi", value=0.005),)),
    (STEP, (Bound(name="v_phi", value=0.002),)),
    (STEP, (Bound(name="v_phi", value=0.001),)),
    (STEP, (Bound(name="v_b", value=0.004),)),
    (STEP, (Bound(name="F", value=1500.0),)),
    (STEP, (Bound(name="v_phi", value=0.005), Bound(name="v_b", value=0.004))),
    (STEP, (Bound(name="phi", value=5e-5),)),
    (STEP, (Bound(name="phi", value=3e-5),)),
    (STEP, (Bound(name="x_b", value=3e-5),)),
    (STEP, (Bound(name="tcp_vibration", value=1.5e-5),)),
    (STEP, (Bound(name="v_phi", value=0.005), Bound(name="phi", value=5e-5))),
    (Positioning(distance=0.02, max_velocity=0.2), ()),
)


def main() -> None:
    plant = build_plant(paper_machine())
    print(
        f"{'bounds':44} {'t_f [ms]':>12} {'gap':>8} {'arcs':>5} {'s':>7} {'grid t_f':>9} {'s':>6}"
    )
    for move, bounds in CASES:
        name = ", ".join(f"|{bound.name}| <= {bound.value:g}" for bound in bounds)
        name = name or f"{move}"
        start = process_time()
        try:
            optimum = solve_bounded_time_optimal(plant, move, force_limit=2e3, bounds=bounds)
        except ComputationError as error:
            print(f"{name[:44]:44} {error.outcome.name} after {process_time() - start:.2f} s")
            continue
        taken = process_time() - start
        free = solve_time_optimal(plant, move, force_limit=2e3)
        problem = bounded_problem(
            plant, move, force_limit=2e3, bounds=optimum.bounds, horizon=free.t_f
        )
        start = process_time()
        grid = bounded_grid.solve_grid_time(problem, t_free=free.t_f)
        print(
            f"{name[:44]:44} {optimum.t_f * 1e3:12.7f} {optimum.certificate.relative_gap:8.1e}"
            f" {len(optimum.arcs):5d} {taken:7.2f} {grid.t_f * 1e3:9.3f}"
            f" {process_time() - start:6.2f}"
        )


if __name__ == "__main__":
    if sys.argv[1:2] == ["survey"]:
        numbers = [int(text) for text in sys.argv[2:4]]
        survey(numbers[0] if numbers else 60, first=numbers[1] if len(numbers) > 1 else 0)
    else:
        main()
