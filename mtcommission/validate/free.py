"""Rows of secs. 2, 5 and 5.1: the plant, its time-optimal control, its switches over the force."""

from __future__ import annotations

from itertools import groupby, pairwise
from math import exp, inf, pi, sqrt

import numpy as np

from mtcommission.machine.moves import Move
from mtcommission.messages.message import Message
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import (
    Bang,
    TimeOptimum,
    constant_arc,
    control_text,
    propagate,
    sample_trajectory,
)
from mtcommission.plant.plant import Plant, kalman_rank
from mtcommission.validate import paper
from mtcommission.validate.adjoint import (
    adjoint_from_switches,
    adjoint_uncertainty,
    printed_adjoint_matrix,
    zeros,
)
from mtcommission.validate.paper import FORCE_LIMIT, SWITCHES, SWITCHING_TIMES, Array, Cases
from mtcommission.validate.row import Row, claim, number

THREE_DIGITS = 1e-3
"""Accuracy of λ(0) as printed [-]."""
SURE_GAP = 1e-9
"""Relative gap below which an optimum counts as proved [-]."""
LOWEST, HIGHEST, COUNT = 20.0, 2e4, 241
"""Forces looked at [N], evenly spaced by ratio (2.9 %): 1 % to ten times that of sec. 5.1."""
FARTHEST, FAR_COUNT = 1.2e7, 33
"""Force from which the number of switches is known by theory [N], and forces on the way there."""
WEAK = 60.0
"""Force below which the start of the move is forgotten before its end [N]."""


def plant_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the plant, beside ours."""
    plant = cases.plant
    kalman = np.array([np.linalg.matrix_power(plant.A, i) @ plant.B for i in range(plant.order)])
    entries = np.abs(kalman[kalman != 0.0])
    order, derivative = 1, plant.row("v_phi")
    while float(derivative @ plant.B) == 0.0:
        order, derivative = order + 1, derivative @ plant.A
    return [
        number(
            "5, (10)",
            "kalman-rank",
            paper.KALMAN_RANK,
            kalman_rank(plant),
            tolerance=0.0,
            decades=float(np.log10(entries.max() / entries.min())),
            unscaled=int(np.linalg.matrix_rank(kalman)),
        ),
        number(
            "5, (8)",
            "adjoint-equations",
            0.0,
            float(np.abs(printed_adjoint_matrix() + plant.A.T).max() / np.abs(plant.A).max()),
            tolerance=1e-14,
        ),
        claim(
            "5.2",
            "order",
            "order 2: F_set first appears in the second derivative",
            holds=order == 2,
            order=order,
        ),
    ]


def printed_control_error(plant: Plant) -> Array:
    """Return the state at t_f under the control (12), less the target; exact integration."""
    force, arcs = FORCE_LIMIT, []
    for start, end in pairwise((0.0, *SWITCHING_TIMES, paper.T_F)):
        arcs.append(constant_arc(start, end, control=Bang(1 if force > 0.0 else -1), force=force))
        force = -force
    error = propagate(plant, tuple(arcs))
    error[plant.velocity] -= paper.VELOCITY_STEP
    error[plant.position] = 0.0
    return error


def time_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the time-optimal control, beside ours."""
    proof = cases.time.certificate
    return [
        *_times(cases.time),
        *_terminal_errors(cases),
        *_adjoint(cases),
        number(
            "5, (7)",
            "hamiltonian",
            0.0,
            1.0 + paper.ADJOINT[-1] / paper.FORCE_LAG * FORCE_LIMIT,
            tolerance=THREE_DIGITS,
        ),
        *_switching_law(cases),
        number(
            "5.1",
            "jacobian-rank",
            paper.JACOBIAN_RANK,
            proof.terminal_jacobian_rank,
            tolerance=0.0,
            gap=proof.relative_gap,
        ),
    ]


def _times(best: TimeOptimum) -> list[Row]:
    final = number(
        "5.1, (12)",
        "final-time",
        paper.T_F,
        best.t_f,
        unit="s",
        tolerance=paper.TIME_ACCURACY,
        least=best.certificate.t_f_lower_bound,
    )
    switches = [
        number(
            "5.1, (12)",
            "switching-time",
            printed,
            ours,
            unit="s",
            tolerance=paper.TIME_ACCURACY,
            number=i,
        )
        for i, (printed, ours) in enumerate(
            zip(SWITCHING_TIMES, best.switching_times, strict=True), start=1
        )
    ]
    return [*switches, final]


def _terminal_errors(cases: Cases) -> list[Row]:
    """Compare in shares of a state's peak: three decimals of (12) are 0.2 to 1 % of it."""
    plant, share = cases.plant, 5e-3
    error, target = printed_control_error(plant), np.zeros(plant.order)
    target[plant.velocity] = paper.VELOCITY_STEP
    return [
        number(
            "5.1, (12)",
            "terminal-error",
            float(target[i]),
            float(error[i] + target[i]),
            unit=unit,
            tolerance=share * float(cases.time.peaks[i]),
            state=name,
            share=share,
        )
        for i, (name, unit) in enumerate(zip(plant.states, plant.signal_units, strict=False))
        if i != plant.position
    ]


def _adjoint(cases: Cases) -> list[Row]:
    plant, switches = cases.plant, np.array(SWITCHING_TIMES)
    printed, ours = np.array(paper.ADJOINT), cases.time.certificate.adjoint_initial
    allowed = adjoint_uncertainty(plant, switches, accuracy=paper.TIME_ACCURACY)
    given = printed != 0.0
    off = np.zeros(printed.size)
    off[given] = np.abs(ours[given] / printed[given] - 1.0)
    rows = [
        number(
            "5.1",
            "adjoint",
            float(printed[i]),
            float(ours[i]) + 0.0,
            tolerance=float(allowed[i] + THREE_DIGITS * abs(printed[i])),
            state=name,
            off=float(off[i]),
            is_off="yes" if off[i] >= THREE_DIGITS else "no",
        )
        for i, name in enumerate(plant.states)
    ]
    implied = adjoint_from_switches(plant, switches)
    deviation = float(np.abs(implied[given] / printed[given] - 1.0).max())
    rounding = adjoint_uncertainty(plant, switches, accuracy=0.5e-6)  # half the last decimal
    explained = float((rounding[given] / np.abs(printed[given])).max())
    consistent = number(
        "5.1",
        "adjoint-implied",
        0.0,
        deviation,
        tolerance=0.02,
        deviation=deviation,
        rounding=explained,
        arc=float(switches[1] - switches[0]),
    )
    return [*rows, consistent]


def _switching_law(cases: Cases) -> list[Row]:
    plant, time, printed = cases.plant, cases.time, np.array(paper.ADJOINT)
    own = zeros(plant, time.certificate.adjoint_initial, t_f=time.t_f, way="back")
    forward = zeros(plant, printed, t_f=paper.T_F, way="on")
    backward = zeros(plant, printed, t_f=paper.T_F, way="back")
    # A zero interpolated linearly on 10 µs is right to less than 1 µs.
    fits = _distance(own, time.switching_times) < 1e-6
    return [
        claim(
            "5, (9)",
            "switching-law",
            "F_set = -sign(lambda_F) F_max",
            holds=time.certificate.switching_law_holds and fits,
            zeros=own.size,
        ),
        claim(
            "5.1",
            "law-as-printed",
            "(9) holds with high accuracy",
            holds=_distance(forward, SWITCHING_TIMES) < paper.TIME_ACCURACY,
            refuted=forward.size != len(SWITCHING_TIMES),
            forward=forward.size,
            last=float(forward[-1]),
            backward=backward.size,
            off=_distance(backward, SWITCHING_TIMES),
            growth=exp(paper.T_F / plant.force_lag),
        ),
    ]


def _distance(found: Array, times: tuple[float, ...]) -> float:
    """Return the largest distance of a zero from its switch [s]; inf if the numbers differ."""
    return float(np.abs(found - times).max()) if found.size == len(times) else inf


def scan_forces(
    plant: Plant, move: Move, *, lowest: float, highest: float, count: int
) -> tuple[list[tuple[float, float, list[TimeOptimum]]], float]:
    """Return ranges of forces [N] whose optima do not have 5 switches, and the worst gap [-]."""
    forces: list[float] = np.geomspace(lowest, highest, count).tolist()
    optima = [solve_time_optimal(plant, move, force_limit=force) for force in forces]

    def edge(inside: int, outside: int) -> float:
        """Return where the number of switches changes, to 1e-4; an end of the scan as it is."""
        if not 0 <= outside < count:
            return forces[inside]
        known, other = forces[inside], forces[outside]
        while abs(other / known - 1.0) > 1e-4:
            middle = sqrt(known * other)
            best = solve_time_optimal(plant, move, force_limit=middle)
            is_inside = len(best.arcs) == len(optima[inside].arcs)
            known, other = (middle, other) if is_inside else (known, middle)
        return sqrt(known * other)

    found = []
    for arcs, run in groupby(range(count), key=lambda i: len(optima[i].arcs)):
        inside = list(run)
        if arcs != SWITCHES + 1:
            ends = edge(inside[0], inside[0] - 1), edge(inside[-1], inside[-1] + 1)
            found.append((*ends, [optima[i] for i in inside]))
    return found, max(item.certificate.relative_gap for item in optima)


def structure_rows(cases: Cases) -> list[Row]:
    """Return the claim of five switches, beside certified optima over the range of forces."""
    plant, move, best = cases.plant, cases.machine.moves[0], cases.time
    first = best.arcs[0].control
    found, gap = scan_forces(plant, move, lowest=LOWEST, highest=HIGHEST, count=COUNT)
    exceptions = tuple(
        Message(
            "paper-switches-between",
            switches=len(inside[0].arcs) - 1,
            lowest=low,
            highest=high,
        )
        for low, high, inside in found
    )
    shortest = [
        min(arc.t_end - arc.t_start for arc in each.arcs)
        for _, _, inside in found
        for each in inside
    ]
    printed = f"{SWITCHES} for all values of F_max > 0"
    far, far_gap = scan_forces(plant, move, lowest=HIGHEST, highest=FARTHEST, count=FAR_COUNT)
    farthest = solve_time_optimal(plant, move, force_limit=FARTHEST).t_f
    half = pi / max(abs(pole.imag) for pole in np.linalg.eigvals(plant.A))
    weak, weakest = (solve_time_optimal(plant, move, force_limit=F) for F in (WEAK, LOWEST))
    moved = inf
    if len(weak.arcs) == len(weakest.arcs) == SWITCHES + 1:
        remaining = [each.t_f - np.array(each.switching_times) for each in (weak, weakest)]
        moved = float(np.abs(remaining[0] - remaining[1]).max())
    return [
        claim(
            "5.1, (11)",
            "switches",
            f"{SWITCHES}, +F_max first",
            holds=len(best.arcs) == SWITCHES + 1 and first == Bang(1),
            refuted=best.certificate.relative_gap < SURE_GAP,
            switches=len(best.arcs) - 1,
            control=control_text(first),
        ),
        claim(
            "5, (11)",
            "switches-everywhere",
            printed,
            holds=gap < SURE_GAP and not found,
            refuted=gap < SURE_GAP and bool(found),
            usual=SWITCHES,
            found=len(found),
            exceptions=exceptions,
            count=COUNT,
            lowest=LOWEST,
            highest=HIGHEST,
            gap=gap,
            range=paper.LARGEST_FORCE,
            arc=max(shortest, default=0.0),
        ),
        claim(
            "5, (11)",
            "switches-beyond",
            printed,
            holds=not far and far_gap < SURE_GAP and farthest < half and moved < 1e-6,
            usual=SWITCHES,
            highest=HIGHEST,
            farthest=FARTHEST,
            t_f=farthest,
            weak=WEAK,
            moved=moved,
            count=FAR_COUNT,
            half=half,
        ),
    ]


def vibration_rows(cases: Cases) -> list[Row]:
    """Return how the time-optimal controls vibrate, and how that grows with the force."""
    plant, best = cases.plant, cases.time
    motion = sample_trajectory(plant, best.arcs, step=best.t_f / 2000)
    rate = motion.states[:, plant.states.index("v_phi")]
    inner = rate[np.abs(rate) > 1e-6 * np.abs(rate).max()]
    changes = int(np.count_nonzero(np.diff(np.sign(inner))))
    forces = np.geomspace(500.0, paper.LARGEST_FORCE, 13)
    optima = [
        solve_time_optimal(plant, cases.machine.moves[0], force_limit=force)
        for force in forces.tolist()
    ]
    rates, angles = ([cases.peak(each, name) for each in optima] for name in ("v_phi", "phi"))
    falls = int(np.count_nonzero(np.diff(rates) < 0.0))
    return [
        claim(
            "4",
            "oscillation",
            "some of the time-optimal state trajectories are highly oscillatory",
            holds=changes >= 4,  # two whole swings
            changes=changes,
            t_f=best.t_f,
            rate=float(np.abs(rate).max()),
        ),
        claim(
            "5.2",
            "more-force",
            "higher values of F_max lead to higher vibrations",
            holds=rates[-1] > 2.0 * rates[0] and angles[-1] > angles[0],
            least=float(forces[0]),
            most=float(forces[-1]),
            rate=rates[0],
            highest_rate=rates[-1],
            angle=angles[0],
            largest_angle=angles[-1],
            count=forces.size,
            falls=falls,
            steps=forces.size - 1,
        ),
    ]
