"""Time of one certified time-optimal control, beside direct transcription with IPOPT.

Run as ``python -m benchmarks.time_optimal [--repeat N] [--peer-cells N]``; 0 leaves the peer out.
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import dataclass

import casadi
import numpy as np
from scipy.linalg import expm

from mtcommission.machine import Machine, VelocityStep
from mtcommission.optimal.time_optimal import solve_time_optimal
from mtcommission.plant import Plant, build_plant
from tests.machines import paper_machine, random_modal_machine


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    case: str
    median: float
    processor: float
    gap: float
    switches: int


def measure(case: str, machine: Machine, *, repeat: int) -> Row:
    """Different forces each time, so that nothing can be remembered."""
    plant = build_plant(machine)
    wall, processor, gaps, switches = [], [], [], 0
    for factor in np.linspace(0.8, 1.25, repeat + 1):
        start, used = time.perf_counter(), time.process_time()
        optimum = solve_time_optimal(
            plant, machine.moves[0], force_limit=float(factor) * machine.drive.max_force
        )
        wall.append(time.perf_counter() - start)
        processor.append(time.process_time() - used)
        gaps.append(optimum.certificate.relative_gap)
        switches = len(optimum.switching_times)
    return Row(
        case=case,
        median=statistics.median(wall[1:]),
        processor=statistics.median(processor[1:]),
        gap=max(gaps),
        switches=switches,
    )


def transcribed(plant: Plant, move: VelocityStep, *, force_limit: float, cells: int) -> float:
    """t_f from IPOPT: free final time, trapezoidal rule, states scaled."""
    scale = np.abs(expm(plant.A * 0.01) @ plant.B * force_limit * plant.force_lag) + 1e-9
    opti = casadi.Opti()
    x, u = opti.variable(plant.order, cells + 1), opti.variable(1, cells + 1)
    t_f = opti.variable()
    A = plant.A * scale / scale[:, np.newaxis]
    B = plant.B * force_limit / scale
    rate = casadi.mtimes(A, x) + casadi.mtimes(casadi.DM(B), u)
    opti.subject_to(x[:, 1:] - x[:, :-1] == t_f / (2 * cells) * (rate[:, 1:] + rate[:, :-1]))
    opti.subject_to(opti.bounded(-1, u, 1))
    opti.subject_to(x[:, 0] == 0)
    for i in range(plant.order):
        if i != plant.position:
            goal = move.velocity_step / scale[i] if i == plant.velocity else 0.0
            opti.subject_to(x[i, -1] == goal)
    least = plant.moving_mass * move.velocity_step / force_limit
    opti.subject_to(opti.bounded(least, t_f, 10 * least))
    opti.set_initial(t_f, 1.2 * least)
    opti.minimize(t_f)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    return float(opti.solve().value(t_f))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=50)
    parser.add_argument("--peer-cells", type=int, default=200)
    arguments = parser.parse_args()
    cases = {"2 modes (paper)": paper_machine()} | {
        f"{n} modes": random_modal_machine(3, n_modes=n) for n in (2, 6, 8)
    }
    print(f"{'case':18s} {'median ms':>10s} {'CPU ms':>8s} {'worst gap':>10s} {'switches':>9s}")
    rows = [measure(case, machine, repeat=arguments.repeat) for case, machine in cases.items()]
    for row in rows:
        print(
            f"{row.case:18s} {1e3 * row.median:10.2f} {1e3 * row.processor:8.2f} "
            f"{row.gap:10.1e} {row.switches:9d}"
        )
    if arguments.peer_cells:
        plant, move = build_plant(paper_machine()), VelocityStep(velocity_step=0.1)
        start = time.perf_counter()
        t_f = transcribed(plant, move, force_limit=2e3, cells=arguments.peer_cells)
        peer = time.perf_counter() - start
        exact = solve_time_optimal(plant, move, force_limit=2e3).t_f
        print(
            f"IPOPT, N = {arguments.peer_cells}: {1e3 * peer:.0f} ms, t_f off by "
            f"{abs(t_f - exact):.1e} s; {peer / rows[0].median:.0f} x the time"
        )


if __name__ == "__main__":
    main()
