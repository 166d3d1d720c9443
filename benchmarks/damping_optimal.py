"""CPU time per damping-optimal solve, warm, on one core; other tools: ``benchmarks.race``.

Then a survey of random problems, each integrated again by another method with an adjoint of its
own (tests/independent_damping.py): the worst errors, and every problem that is not solved.

OMP_NUM_THREADS=1 python -m benchmarks.damping_optimal [--count N]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from math import pi
from statistics import median
from time import process_time

import numpy as np

from mtcommission.base.errors import ComputationError
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.control import DampingOptimum
from mtcommission.optimal.damping import balanced_weights, solve_damping_optimal
from mtcommission.optimal.free import solve_time_optimal
from tests.independent_damping import follow
from tests.machines import paper_machine, random_modal_machine
from tests.references_optimal import PAPER_WEIGHTS

STEP = VelocityStep(velocity_step=0.1)


PAPER_TIMES = (0.043525, 0.044, 0.0522, 0.07, 0.435)
"""Final times from just above t_f,min, over that of the paper, to ten times t_f,min [s]."""


def time_of(call: Callable[[], DampingOptimum], *, repeats: int) -> float:
    times = []
    for _ in range(repeats + 1):
        start = process_time()
        call()
        times.append(process_time() - start)
    return median(times[1:])


def paper_cases(plant: Plant) -> None:
    print("paper's machine, 2 kN: t_f [s], median [ms]")
    for t_f in PAPER_TIMES:
        call = partial(solve_damping_optimal, plant, STEP, force_limit=2e3, t_f=t_f)
        ours = time_of(partial(call, weights=PAPER_WEIGHTS), repeats=15)
        print(f"{t_f:9.6f} {1e3 * ours:7.1f}", flush=True)


def random_cases() -> None:
    print("random machines, force at 93 % of what the free optimum wants: modes, median [ms]")
    for n_modes in (1, 2, 4, 6, 8):
        times = []
        for seed in range(8):
            machine = random_modal_machine(seed, n_modes=n_modes)
            plant, move = build_plant(machine), machine.moves[0]
            t_f = 4.0 * pi / min(mode.natural_frequency for mode in plant.modes)
            weights = tuple(
                SignalValue(name=plant.states[mode.deflection], value=mode.natural_frequency**4)
                for mode in plant.modes
            )
            free = solve_damping_optimal(plant, move, force_limit=1e12, t_f=t_f, weights=weights)
            wanted = max(abs(float(arc.output @ arc.initial)) for arc in free.arcs)
            taken = time_of(
                partial(
                    solve_damping_optimal,
                    plant,
                    move,
                    force_limit=0.93 * wanted,
                    t_f=t_f,
                    weights=weights,
                ),
                repeats=3,
            )
            times.append(taken)
        print(f"{n_modes:3d} {1e3 * float(np.median(times)):7.1f}")


def survey(count: int) -> None:
    print(f"{count} random problems, 1 ... 8 modes, t_f 1.02 ... 3 t_f,min, both kinds of move")
    generator = np.random.default_rng(7)
    checks, costs, times = [], [], []
    for seed in range(count):
        share = float(np.exp(generator.uniform(np.log(1.02), np.log(3.0))))
        step, force, stress = generator.uniform([0.0, -1.0, -2.0], [1.0, 1.0, 2.0])
        machine = random_modal_machine(seed, n_modes=1 + seed % 8)
        plant, F = build_plant(machine), machine.drive.max_force * 10.0 ** float(force)
        move: Move = machine.moves[0] if step < 0.5 else Positioning(distance=0.02)
        fastest = solve_time_optimal(plant, move, force_limit=F)
        weights = tuple(
            SignalValue(name=weight.name, value=weight.value * 10.0 ** float(stress))
            for weight in balanced_weights(plant, fastest)
        )
        start = process_time()
        try:
            found = solve_damping_optimal(
                plant, move, force_limit=F, t_f=share * fastest.t_f, weights=weights
            )
        except ComputationError as error:
            print(f"seed {seed}, t_f = {share:.3f} t_f,min: {error}")
            continue
        times.append(process_time() - start)
        again = follow(plant, found)
        checks.append(again)
        costs.append(abs(found.cost / again.cost - 1.0))
    laws, gaps = ([getattr(each, name) for each in checks] for name in ("law", "cost_gap"))
    errors = [float(np.abs(each.terminal_error).max()) for each in checks]
    print(f"solved {len(checks)} of {count}; CPU median {1e3 * median(times):.0f} ms, at most")
    print(f"{1e3 * max(times):.0f} ms. Integrated again, worst and median of all:")
    for name, values in (
        ("cost, relative difference", costs),
        ("cost above the least possible, relative, at most", gaps),
        ("control law (16) with an adjoint of its own, of F_max", laws),
        ("terminal error, of a peak", errors),
    ):
        print(f"  {name}: {max(values):.1e}, {median(values):.1e}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="random problems of the survey")
    options = parser.parse_args()
    paper_cases(build_plant(paper_machine()))
    random_cases()
    if options.count:
        survey(options.count)


if __name__ == "__main__":
    main()
