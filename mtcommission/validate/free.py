"""Rows of secs. 2, 5 and 5.1: the plant, its time-optimal control, its switches over the force."""

from __future__ import annotations

from itertools import groupby, pairwise
from math import inf, pi, sqrt

import numpy as np

from mtcommission.machine.moves import Move
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
            "sec. 5, (10)",
            "rank of the Kalman matrix",
            paper.KALMAN_RANK,
            kalman_rank(plant),
            tolerance=0.0,
            basis="a whole number",
            reason="Decided after scaling the states. In SI units the entries of C span "
            f"{np.log10(entries.max() / entries.min()):.0f} decades, and rounding makes its rank "
            f"look like {np.linalg.matrix_rank(kalman)}.",
        ),
        number(
            "sec. 5, (8)",
            "adjoint equations: largest error of a coefficient, relative to the largest",
            0.0,
            float(np.abs(printed_adjoint_matrix() + plant.A.T).max() / np.abs(plant.A).max()),
            tolerance=1e-14,
            basis="rounding; printed coefficients against -A of our plant",
        ),
        claim(
            "sec. 5.2",
            "order of the constraint on v_phi",
            "order 2: F_set first appears in the second derivative",
            f"order {order}",
            basis="c A^(k-1) B of our plant",
            holds=order == 2,
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
            "sec. 5, (7)",
            "H at t = 0 with the printed lambda(0)",
            0.0,
            1.0 + paper.ADJOINT[-1] / paper.FORCE_LAG * FORCE_LIMIT,
            tolerance=THREE_DIGITS,
            basis="three digits",
            reason="H = 0 demands lambda_F(0) = -T / F_max = -1.25e-6; printed is -1.2503e-6.",
        ),
        *_switching_law(cases),
        number(
            "sec. 5.1",
            "rank of the 6 x 6 Jacobian of the terminal conditions",
            paper.JACOBIAN_RANK,
            proof.terminal_jacobian_rank,
            tolerance=0.0,
            basis="a whole number",
            reason="Full rank proves a strict local optimum; that it is global, our lower bound "
            f"proves, with a relative gap of {proof.relative_gap:.1g}.",
        ),
    ]


def _times(best: TimeOptimum) -> list[Row]:
    reason = (
        f"No control reaches the target before {best.certificate.t_f_lower_bound:.9f} s (proved), "
        "so the printed t_f is too short. Explicit Euler steps err in this direction, in "
        "proportion to the step."
    )
    names = (*(f"t_{i}" for i in range(1, SWITCHES + 1)), "t_f")
    printed, found = (*SWITCHING_TIMES, paper.T_F), (*best.switching_times, best.t_f)
    return [
        number(
            "sec. 5.1, (12)",
            name,
            printed_time,
            ours,
            unit="s",
            tolerance=paper.TIME_ACCURACY,
            basis='the text: "correct up to 3-4 decimals"',
            reason=reason if name == "t_f" else "",
        )
        for name, printed_time, ours in zip(names, printed, found, strict=True)
    ]


def _terminal_errors(cases: Cases) -> list[Row]:
    """Compare in shares of a state's peak: three decimals of (12) are 0.2 to 1 % of it."""
    plant, share = cases.plant, 5e-3
    error, target = printed_control_error(plant), np.zeros(plant.order)
    target[plant.velocity] = paper.VELOCITY_STEP
    return [
        number(
            "sec. 5.1, (12)",
            f"{name}(t_f) of the printed control, integrated exactly",
            float(target[i]),
            float(error[i] + target[i]),
            unit=unit,
            tolerance=share * float(cases.time.peaks[i]),
            basis=f"{share:g} of the peak: three decimals of (12)",
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
            "sec. 5.1",
            f"lambda_{name}(0)",
            float(printed[i]),
            float(ours[i]) + 0.0,
            tolerance=float(allowed[i] + THREE_DIGITS * abs(printed[i])),
            basis="what 1e-4 s in the switching times does to it, and 0.1 %",
            reason=f"{100.0 * off[i]:.1f} % off: agrees only within what the short arcs of (12) "
            "leave open, see the row on the adjoint that these times imply."
            if off[i] >= THREE_DIGITS
            else "",
        )
        for i, name in enumerate(plant.states)
    ]
    implied = adjoint_from_switches(plant, switches)
    deviation = float(np.abs(implied[given] / printed[given] - 1.0).max())
    rounding = adjoint_uncertainty(plant, switches, accuracy=0.5e-6)  # half the last decimal
    explained = float((rounding[given] / np.abs(printed[given])).max())
    consistent = number(
        "sec. 5.1",
        "lambda(0) that the printed times (12) imply: largest relative deviation",
        0.0,
        deviation,
        tolerance=0.02,
        basis="two of the printed digits",
        reason=f"Times and adjoint of the paper fit each other to {100.0 * deviation:.1f} %; the "
        f"rounding of (12) to 1e-6 s explains {100.0 * explained:.1g} %. The rest of what "
        "separates our lambda(0) from the printed one are the times, above all those of the "
        f"second arc, only {1e3 * (switches[1] - switches[0]):.2f} ms long.",
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
            "sec. 5, (9)",
            "switching law",
            "F_set = -sign(lambda_F) F_max",
            f"holds on the whole interval; {own.size} zeros of lambda_F, at the switches",
            basis="certificate, and zeros of the adjoint integrated apart from it",
            holds=time.certificate.switching_law_holds and fits,
        ),
        claim(
            "sec. 5.1",
            "the reader may verify (9) with the printed lambda(0)",
            "(9) holds with high accuracy",
            f"integrated forward lambda_F has {forward.size} zeros instead of 5, the last at "
            f"{1e3 * forward[-1]:.1f} ms; backward from H = 0 it has {backward.size}, off by "
            f"up to {1e3 * _distance(backward, SWITCHING_TIMES):.2f} ms",
            basis="(8) by matrix exponentials",
            holds=_distance(forward, SWITCHING_TIMES) < paper.TIME_ACCURACY,
            refuted=forward.size != len(SWITCHING_TIMES),
            reason="The force lag makes errors of lambda(0) grow like e^(t/T), by "
            f"{np.exp(paper.T_F / plant.force_lag):.1g} over t_f: six or seven printed digits do "
            "not last. The law itself holds, see the row before.",
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
    exceptions = "; ".join(
        f"{len(inside[0].arcs) - 1} from {low:.1f} to {high:.1f} N" for low, high, inside in found
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
            "sec. 5.1, (11)",
            "number of switches at F_max = 2 kN",
            f"{SWITCHES}, +F_max first",
            f"{len(best.arcs) - 1}, {control_text(first)} first",
            basis="certified optimum",
            holds=len(best.arcs) == SWITCHES + 1 and first == Bang(1),
            refuted=best.certificate.relative_gap < SURE_GAP,
        ),
        claim(
            "sec. 5, (11)",
            "number of switches for all F_max > 0",
            printed,
            f"{SWITCHES}, but {exceptions}" if exceptions else f"{SWITCHES} throughout",
            basis=f"{COUNT} certified optima from {LOWEST:g} to {HIGHEST:g} N, largest "
            f"relative gap {gap:.1g}",
            holds=gap < SURE_GAP and not found,
            refuted=gap < SURE_GAP and bool(found),
            reason=f"Within the machine's own range (F_max <= {paper.LARGEST_FORCE / 1e3:g} kN) a "
            "double zero of the switching function opens into two more switches. The optimum is "
            "unique and proved, so five switches are slower there. The shortest arc is at most "
            f"{1e6 * max(shortest, default=0.0):.0f} µs long: easily lost on a grid. Between the "
            "forces looked at nothing is proved.",
        ),
        claim(
            "sec. 5, (11)",
            "number of switches beyond these forces",
            printed,
            f"{SWITCHES} from {HIGHEST:g} to {FARTHEST:g} N, where t_f = {1e3 * farthest:.3f} ms; "
            f"below {WEAK:g} N the switches, counted from t_f, move by less than "
            f"{1e9 * moved:.2g} ns",
            basis=f"{FAR_COUNT} certified optima, and theory for the rest",
            holds=not far and far_gap < SURE_GAP and farthest < half and moved < 1e-6,
            reason=f"In less than {1e3 * half:.3f} ms, half a damped period of the tower, no "
            "combination of 1, e^(-t/T) and the modes' functions has more than five zeros, and "
            "five conditions of rest need at least five switches. Small forces move for so long "
            "that what the start excites has decayed at the end: there the switches are those of "
            "one limit.",
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
            "sec. 4",
            "time-optimal trajectories oscillate",
            "some of the time-optimal state trajectories are highly oscillatory",
            f"v_phi changes its sign {changes} times in {1e3 * best.t_f:.1f} ms and swings "
            f"up to {1e3 * np.abs(rate).max():.1f} mrad/s",
            basis="the certified control of sec. 5.1",
            holds=changes >= 4,  # two whole swings
        ),
        claim(
            "sec. 5.2",
            "higher F_max leads to higher vibrations",
            "higher values of F_max lead to higher vibrations",
            f"from {forces[0]:g} to {forces[-1]:g} N the peak of |v_phi| grows from "
            f"{1e3 * rates[0]:.1f} to {1e3 * rates[-1]:.1f} mrad/s, that of |phi| from "
            f"{1e6 * angles[0]:.0f} to {1e6 * angles[-1]:.0f} µrad",
            basis=f"{forces.size} certified optima, evenly spaced by ratio",
            holds=rates[-1] > 2.0 * rates[0] and angles[-1] > angles[0],
            reason=f"A trend, not a law: on {falls} of the {forces.size - 1} steps between these "
            "forces the peak of |v_phi| falls."
            if falls
            else "",
        ),
    ]
