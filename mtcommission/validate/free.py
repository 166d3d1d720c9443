"""Rows of secs. 2, 4, 5 and 5.1: the plant, its time-optimal control, its switches over force."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, pairwise
from math import exp, inf, pi, sqrt

import numpy as np

from mtcommission.base.messages.message import Message, Value
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant, kalman_rank
from mtcommission.optimal.control import (
    Bang,
    TimeOptimum,
    constant_arc,
    control_text,
    propagate,
    sample_trajectory,
)
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.validate.adjoint import (
    adjoint_from_switches,
    adjoint_uncertainty,
    largest_distance,
    printed_adjoint_matrix,
    zeros,
)
from mtcommission.validate.cases import Array, Cases
from mtcommission.validate.paper import (
    ADJOINT,
    FORCE_LIMIT,
    JACOBIAN_RANK,
    KALMAN_RANK,
    LARGEST_FORCE,
    SWITCHES,
    SWITCHING_TIMES,
    T_F,
    TIME_ACCURACY,
    VELOCITY_STEP,
    Row,
    claim,
    number,
)

THREE_DIGITS = 1e-3
"""Accuracy of λ(0) as printed [-]."""
THREE_DECIMALS = 5e-3
"""What three decimals of (12) are of a state's peak: 0.2 to 1 %."""
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
    plant, row = cases.plant, cases.plant.row("v_phi")
    kalman = np.array([np.linalg.matrix_power(plant.A, i) @ plant.B for i in range(plant.order)])
    rank, entries = kalman_rank(plant), np.abs(kalman[kalman != 0.0])
    decades = float(np.log10(entries.max() / entries.min()))
    looks = {"decades": decades, "unscaled": int(np.linalg.matrix_rank(kalman))}
    error = printed_adjoint_matrix(cases.mechanics, force_lag=plant.force_lag) + plant.A.T
    off = float(np.abs(error).max() / np.abs(plant.A).max())
    order = next(k for k in count(1) if row @ np.linalg.matrix_power(plant.A, k - 1) @ plant.B)
    return [
        number("kalman-rank", KALMAN_RANK, rank, 0.0, looks),
        number("adjoint-equations", 0.0, off, 1e-14),
        claim("order", {"order": order}, holds=order == 2),
    ]


def printed_control_error(plant: Plant) -> Array:
    """Return the state at t_f under the control (12), less the target; exact integration."""
    ends = pairwise((0.0, *SWITCHING_TIMES, T_F))
    arcs = [
        constant_arc(start, end, control=Bang(side), force=side * FORCE_LIMIT)
        for side, (start, end) in zip((1, -1) * 3, ends, strict=True)
    ]
    error = propagate(plant, tuple(arcs))
    error[plant.velocity] -= VELOCITY_STEP
    error[plant.position] = 0.0
    return error


def time_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the time-optimal control, beside ours."""
    plant, best, off = cases.plant, cases.time, TIME_ACCURACY
    proof, error, share = best.certificate, printed_control_error(plant), THREE_DECIMALS
    rows = [
        number("switching-time", printed, ours, off, {"number": i}, unit="s")
        for i, printed, ours in zip(range(1, 6), SWITCHING_TIMES, best.switching_times, strict=True)
    ]
    least = {"least": proof.t_f_lower_bound}
    rows.append(number("final-time", T_F, best.t_f, off, least, unit="s"))
    for i, name in enumerate(plant.states):
        if i != plant.position:
            aim = VELOCITY_STEP if i == plant.velocity else 0.0
            reached, room = aim + float(error[i]), share * float(best.peaks[i])
            said: dict[str, Value] = {"state": name, "share": share}
            unit = plant.signal_units[i]
            rows.append(number("terminal-error", aim, reached, room, said, unit=unit))
    hamiltonian = 1.0 + ADJOINT[-1] / plant.force_lag * FORCE_LIMIT
    rank, gap = proof.terminal_jacobian_rank, {"gap": proof.relative_gap}
    return [
        *rows,
        *_adjoint(cases),
        number("hamiltonian", 0.0, hamiltonian, THREE_DIGITS),
        *_switching_law(cases),
        number("jacobian-rank", JACOBIAN_RANK, rank, 0.0, gap),
    ]


def _adjoint(cases: Cases) -> list[Row]:
    plant, switches = cases.plant, np.array(SWITCHING_TIMES)
    allowed = adjoint_uncertainty(plant, switches, accuracy=TIME_ACCURACY)
    rounding = adjoint_uncertainty(plant, switches, accuracy=0.5e-6)  # half the last decimal
    implied = adjoint_from_switches(plant, switches)
    rows, deviation, explained = list[Row](), 0.0, 0.0
    for i, (name, printed) in enumerate(zip(plant.states, ADJOINT, strict=True)):
        ours, off = float(cases.time.certificate.adjoint_initial[i]) + 0.0, 0.0
        if printed:
            off = abs(ours / printed - 1.0)
            deviation = max(deviation, abs(float(implied[i]) / printed - 1.0))
            explained = max(explained, float(rounding[i]) / abs(printed))
        said: dict[str, Value] = {
            "state": name,
            "off": off,
            "is_off": "yes" if off >= THREE_DIGITS else "no",
        }
        room = float(allowed[i]) + THREE_DIGITS * abs(printed)
        rows.append(number("adjoint", printed, ours, room, said))
    arc = float(switches[1] - switches[0])
    fit = {"deviation": deviation, "rounding": explained, "arc": arc}
    return [*rows, number("adjoint-implied", 0.0, deviation, 0.02, fit)]


def _switching_law(cases: Cases) -> list[Row]:
    plant, best, printed = cases.plant, cases.time, np.array(ADJOINT)
    own = zeros(plant, best.certificate.adjoint_initial, t_f=best.t_f, way="back")
    on, back = (zeros(plant, printed, t_f=T_F, way=way) for way in ("on", "back"))
    off, growth = largest_distance(back, SWITCHING_TIMES), exp(T_F / plant.force_lag)
    said = {"forward": on.size, "last": float(on[-1]), "backward": back.size}
    # A zero interpolated linearly on 10 µs is right to less than 1 µs.
    fits = largest_distance(own, best.switching_times) < 1e-6
    return [
        claim(
            "switching-law",
            {"zeros": own.size},
            holds=best.certificate.switching_law_holds and fits,
        ),
        claim(
            "law-as-printed",
            {**said, "off": off, "growth": growth},
            holds=largest_distance(on, SWITCHING_TIMES) < TIME_ACCURACY,
            refuted=on.size != SWITCHES,
        ),
    ]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scan:
    """Certified optima over the force."""

    # Ranges of forces [N] whose optima do not have 5 switches.
    ranges: list[tuple[float, float, list[TimeOptimum]]]
    gap: float  # The worst of all [-]


def scan_forces(plant: Plant, move: Move, *, lowest: float, highest: float, count: int) -> Scan:
    """Return the optima of forces evenly spaced by ratio, and where their switches change."""

    def solve(force: float) -> TimeOptimum:
        return solve_time_optimal(plant, move, force_limit=force)

    def edge(low: float, high: float, switches: int) -> float:
        """Return where the number of switches changes, to 1e-4."""
        while high / low - 1.0 > 1e-4:
            middle = sqrt(low * high)
            is_low = len(solve(middle).switching_times) == switches
            low, high = (middle, high) if is_low else (low, middle)
        return sqrt(low * high)

    forces: list[float] = np.geomspace(lowest, highest, count).tolist()
    optima = [solve(force) for force in forces]
    switches = [len(optimum.switching_times) for optimum in optima]
    starts = [i for i in range(1, count) if switches[i] != switches[i - 1]]
    between = [edge(forces[i - 1], forces[i], switches[i - 1]) for i in starts]
    ends, parts = pairwise([forces[0], *between, forces[-1]]), pairwise([0, *starts, count])
    ranges = [
        (low, high, optima[start:stop])
        for (low, high), (start, stop) in zip(ends, parts, strict=True)
        if switches[start] != SWITCHES
    ]
    return Scan(ranges=ranges, gap=max(each.certificate.relative_gap for each in optima))


def structure_rows(cases: Cases) -> list[Row]:
    """Return the claim of five switches, beside certified optima over the range of forces."""
    plant, move, best = cases.plant, cases.machine.moves[0], cases.time
    first, switches, usual = best.arcs[0].control, len(best.switching_times), {"usual": SWITCHES}
    near = scan_forces(plant, move, lowest=LOWEST, highest=HIGHEST, count=COUNT)
    between = [(low, high, len(each[0].switching_times)) for low, high, each in near.ranges]
    exceptions = tuple(
        Message("paper-switches-between", switches=number, lowest=low, highest=high)
        for low, high, number in between
    )
    inside = [each for *_, optima in near.ranges for each in optima]
    arc = max((min(arc.length for arc in each.arcs) for each in inside), default=0.0)
    looked = {"count": COUNT, "lowest": LOWEST, "highest": HIGHEST, "gap": near.gap}
    seen: dict[str, Value] = {"found": len(near.ranges), "exceptions": exceptions, "arc": arc}
    beyond = scan_forces(plant, move, lowest=HIGHEST, highest=FARTHEST, count=FAR_COUNT)
    farthest, weak, weakest = (
        solve_time_optimal(plant, move, force_limit=F) for F in (FARTHEST, WEAK, LOWEST)
    )
    half, moved = pi / max(abs(pole.imag) for pole in np.linalg.eigvals(plant.A)), inf
    if len(weak.arcs) == len(weakest.arcs) == SWITCHES + 1:
        remaining = [each.t_f - np.array(each.switching_times) for each in (weak, weakest)]
        moved = float(np.abs(remaining[0] - remaining[1]).max())
    far = {"highest": HIGHEST, "farthest": FARTHEST, "t_f": farthest.t_f, "count": FAR_COUNT}
    is_sure, is_surely_far = near.gap < SURE_GAP, beyond.gap < SURE_GAP and not beyond.ranges
    return [
        claim(
            "switches",
            {"switches": switches, "control": control_text(first)},
            holds=switches == SWITCHES and first == Bang(1),
            refuted=best.certificate.relative_gap < SURE_GAP,
        ),
        claim(
            "switches-everywhere",
            {**usual, **looked, **seen, "range": LARGEST_FORCE},
            holds=is_sure and not near.ranges,
            refuted=is_sure and bool(near.ranges),
        ),
        claim(
            "switches-beyond",
            {**usual, **far, "weak": WEAK, "moved": moved, "half": half},
            holds=is_surely_far and farthest.t_f < half and moved < 1e-6,
        ),
    ]


def vibration_rows(cases: Cases) -> list[Row]:
    """Return how the time-optimal controls vibrate, and how that grows with the force."""
    plant, best, move = cases.plant, cases.time, cases.machine.moves[0]
    motion = sample_trajectory(plant, best.arcs, step=best.t_f / 2000)
    rate = motion.states[:, plant.states.index("v_phi")]
    inner, swing = rate[np.abs(rate) > 1e-6 * np.abs(rate).max()], float(np.abs(rate).max())
    changes = int(np.count_nonzero(np.diff(np.sign(inner))))
    forces: list[float] = np.geomspace(500.0, LARGEST_FORCE, 13).tolist()
    optima = [solve_time_optimal(plant, move, force_limit=force) for force in forces]
    rates, angles = ([cases.peak(each.peaks, name) for each in optima] for name in ("v_phi", "phi"))
    falls = int(np.count_nonzero(np.diff(rates) < 0.0))
    force = {"least": forces[0], "most": forces[-1], "count": len(forces)}
    grown = {"rate": rates[0], "highest_rate": rates[-1], "falls": falls, "steps": len(rates) - 1}
    return [
        claim(
            "oscillation", {"changes": changes, "t_f": best.t_f, "rate": swing}, holds=changes >= 4
        ),
        claim(
            "more-force",
            {**force, **grown, "angle": angles[0], "largest_angle": angles[-1]},
            holds=rates[-1] > 2.0 * rates[0] and angles[-1] > angles[0],
        ),
    ]
