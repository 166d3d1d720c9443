"""Time-optimal control under bounds: CPU seconds, gaps and the same problem as one program.

    python -m benchmarks.constrained
    python -m benchmarks.constrained survey [COUNT [FIRST SEED]]

Beside each case, direct transcription as a linear program on an even grid says by how much a grid
misses the optimum. Other tools on the case of the paper: ``benchmarks.race``.
"""

from __future__ import annotations

import argparse
from time import process_time

from benchmarks.constrained_survey import survey
from mtcommission.base.errors import ComputationError
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.cells import first_cells
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.optimal.problem import bounded_problem
from tests.machines import paper_machine

STEP = VelocityStep(velocity_step=0.1)
CASES: tuple[tuple[Move, tuple[SignalValue, ...]], ...] = (
    (STEP, (SignalValue(name="v_phi", value=0.02),)),
    (STEP, (SignalValue(name="v_phi", value=0.01),)),
    (STEP, (SignalValue(name="v_phi", value=0.005),)),
    (STEP, (SignalValue(name="v_phi", value=0.002),)),
    (STEP, (SignalValue(name="v_phi", value=0.001),)),
    (STEP, (SignalValue(name="v_b", value=0.004),)),
    (STEP, (SignalValue(name="F", value=1500.0),)),
    (STEP, (SignalValue(name="v_phi", value=0.005), SignalValue(name="v_b", value=0.004))),
    (STEP, (SignalValue(name="phi", value=5e-5),)),
    (STEP, (SignalValue(name="phi", value=3e-5),)),
    (STEP, (SignalValue(name="x_b", value=3e-5),)),
    (STEP, (SignalValue(name="tcp_vibration", value=1.5e-5),)),
    (STEP, (SignalValue(name="v_phi", value=0.005), SignalValue(name="phi", value=5e-5))),
    (Positioning(distance=0.02, max_velocity=0.2), ()),
)


def print_cases(plant: Plant) -> None:
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
        grid = first_cells(problem, t_free=free.t_f)
        print(
            f"{name[:44]:44} {optimum.t_f * 1e3:12.7f} {optimum.certificate.relative_gap:8.1e}"
            f" {len(optimum.arcs):5d} {taken:7.2f} {grid.t_f * 1e3:9.3f}"
            f" {process_time() - start:6.2f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("survey", nargs="?", choices=["survey"])
    parser.add_argument("count", nargs="?", type=int, default=60)
    parser.add_argument("first", nargs="?", type=int, default=0)
    options = parser.parse_args()
    if options.survey:
        survey(options.count, first=options.first)
        return
    print_cases(build_plant(paper_machine()))


if __name__ == "__main__":
    main()
