"""Survey of time-optimal control under random bounds: outcome, proof, CPU time, bounds kept.

Random machines, both kinds of move, one bound or two at 30 to 90 % of the peak that the motion
has without it. Every result is looked at by an integration that shares nothing with the solver.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, inf
from time import process_time

import numpy as np
from scipy.linalg import expm, matrix_balance

from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.control import Arc, TimeOptimum
from mtcommission.optimal.free import solve_time_optimal

RADIANS_PER_SAMPLE = 0.02
"""Samples among which the peaks are looked for; each is then followed to its top."""
NEAR = 1e-3
"""Peaks that stay further below a bound than this are not followed."""
SHARES = (0.3, 0.9)
"""Bounds, as shares of the peaks of the motion without them."""
TWO_BOUNDS = 0.3
"""Share of the cases with a second bound."""
EXCESS = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One random problem; the optimum without bounds takes ``t_free`` [s]."""

    seed: int
    plant: Plant
    move: Move
    force_limit: float
    bounds: tuple[SignalValue, ...]
    t_free: float

    @property
    def name(self) -> str:
        kind = "step" if isinstance(self.move, VelocityStep) else "move"
        bounds = ", ".join(f"|{bound.name}| <= {bound.value:.3g}" for bound in self.bounds)
        return f"{self.seed:3d} {kind} {len(self.plant.modes)} modes {bounds}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What became of a case: outcome, relative gap, excess over a bound, CPU seconds."""

    outcome: str
    gap: float
    excess: float
    t_f: float
    seconds: float


def cases(count: int, *, first: int = 0) -> Iterator[Case]:
    """Return random problems by seed, the same ones every time."""
    for seed in range(first, first + count):
        generator = np.random.default_rng([55, seed])
        machine = random_machine(seed)
        plant, force = build_plant(machine), machine.drive.max_force
        move = _move(machine)
        free = solve_time_optimal(plant, move, force_limit=force)
        names = [name for name in _boundable(plant, move) if name in plant.signals]
        chosen = generator.permutation(names)[: 1 + int(generator.random() < TWO_BOUNDS)]
        yield Case(
            seed=seed,
            plant=plant,
            move=move,
            force_limit=force,
            bounds=tuple(
                SignalValue(
                    name=str(name),
                    value=float(generator.uniform(*SHARES))
                    * float(free.peaks[plant.signals.index(str(name))]),
                )
                for name in chosen
            ),
            t_free=free.t_f,
        )


def _move(machine: Machine) -> Move:
    """Return the move without its max_velocity: a cruise is another problem."""
    move = machine.moves[0]
    return Positioning(distance=move.distance) if isinstance(move, Positioning) else move


def _boundable(plant: Plant, move: Move) -> list[str]:
    """Return the signals whose bound does not forbid the target itself."""
    rigid = {plant.states[plant.position], "tcp", "encoder"}
    if isinstance(move, VelocityStep):
        rigid.add(plant.states[plant.velocity])
    return [name for name in plant.signals if name not in rigid]


def judge(case: Case) -> Judged:
    """Return what became of a case."""
    start = process_time()
    try:
        found = solve_bounded_time_optimal(
            case.plant, case.move, force_limit=case.force_limit, bounds=case.bounds
        )
    except ComputationError as error:
        seconds = process_time() - start
        return Judged(outcome=error.outcome.name, gap=inf, excess=0.0, t_f=inf, seconds=seconds)
    seconds = process_time() - start
    return Judged(
        outcome="certified",
        gap=found.certificate.relative_gap,
        excess=largest_excess(case.plant, found),
        t_f=found.t_f,
        seconds=seconds,
    )


def largest_excess(plant: Plant, found: TimeOptimum) -> float:
    """Return by how much the motion exceeds a bound, relative to it, between all samples too."""
    rate = max(1.0 / plant.force_lag, *(mode.natural_frequency for mode in plant.modes))
    rows = np.array([plant.row(bound.name) / bound.value for bound in found.bounds])
    state, worst = np.zeros(plant.order), -inf
    for arc in found.arcs:
        together, joint, step = _followed(plant, arc, state, rate)
        state = together[-1, : plant.order]
        for row in np.pad(rows, ((0, 0), (0, arc.initial.size))):
            worst = max(worst, _peak(together, joint, row, step) - 1.0)
    return worst


def _followed(
    plant: Plant, arc: Arc, state: np.ndarray, rate: float
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the states of plant and arc along the arc, their generator, and the step [s]."""
    n, k = plant.order, arc.initial.size
    joint = np.zeros((n + k, n + k))
    joint[:n, :n], joint[:n, n:] = plant.A, np.outer(plant.B, arc.output)
    joint[n:, n:] = arc.generator
    length = arc.t_end - arc.t_start
    count = max(ceil(length * rate / RADIANS_PER_SAMPLE), 2)
    flow = _balanced_expm(joint * (length / count))
    together = [np.concatenate([state, arc.initial])]
    for _ in range(count):
        together.append(flow @ together[-1])
    return np.array(together), joint, length / count


def _balanced_expm(matrix: np.ndarray) -> np.ndarray:
    """Return the matrix exponential; unbalanced it loses six digits on arcs of many decades."""
    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    return np.asarray(expm(balanced) * scale[:, np.newaxis] / scale)


def _peak(together: np.ndarray, joint: np.ndarray, row: np.ndarray, step: float) -> float:
    """Return the largest |row x|; peaks between two samples by Newton's method on its slope."""
    levels = np.abs(together @ row)
    worst = float(levels.max())
    inner = levels[1:-1]
    tops = (inner > 1.0 - NEAR) & (inner > levels[:-2]) & (inner > levels[2:])
    for at in np.nonzero(tops)[0] + 1:
        here = together[at]
        for _ in range(2):
            slope, bend = row @ joint @ here, row @ joint @ joint @ here
            if not abs(slope) < step * abs(bend):
                break
            here = _balanced_expm(joint * (-slope / bend)) @ here
        worst = max(worst, abs(float(row @ here)))
    return worst


def survey(count: int, *, first: int = 0) -> list[tuple[Case, Judged]]:
    """Print and return what becomes of random problems."""
    results = []
    print(f"{'case':62} {'outcome':18} {'gap':>8} {'excess':>8} {'t_f/free':>8} {'s':>6}")
    for case in cases(count, first=first):
        judged = judge(case)
        results.append((case, judged))
        print(
            f"{case.name[:62]:62} {judged.outcome:18} {judged.gap:8.1e} {judged.excess:8.1e}"
            f" {judged.t_f / case.t_free:8.3f} {judged.seconds:6.2f}",
            flush=True,
        )
    print(summary(results))
    return results


def summary(results: list[tuple[Case, Judged]]) -> str:
    """Return the survey in three lines."""
    outcomes = Counter(judged.outcome for _, judged in results)
    solved = [judged for _, judged in results if judged.outcome == "certified"]
    gaps = np.array([judged.gap for judged in solved])
    seconds = np.array([judged.seconds for _, judged in results])
    broken = sum(judged.excess > EXCESS for judged in solved)
    return "\n".join(
        [
            f"outcomes: {dict(outcomes)}; bound broken by more than {EXCESS:g}: {broken}",
            f"gap: median {np.median(gaps):.1e}, largest {gaps.max():.1e},"
            f" above 1e-6: {int((gaps > 1e-6).sum())}",
            f"CPU: median {np.median(seconds):.2f} s, largest {seconds.max():.1f} s",
        ]
    )
