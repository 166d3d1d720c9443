"""Rows of secs. 2, 5 and 5.1: the plant, its time-optimal control, its switches over the force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count, groupby
from math import exp, inf, pi, sqrt
from typing import Literal

import numpy as np
from scipy.linalg import expm

from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.plant import Plant, kalman_rank
from mtcommission.optimal.control import (
    Bang,
    TimeOptimum,
    constant_arc,
    control_text,
    powers_of,
    propagate,
    terminal_target,
)
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.validate.cases import Array, Cases, symbol
from mtcommission.validate.paper import (
    ADJOINT,
    FORCE_LIMIT,
    LARGEST_FORCE,
    SURE_GAP,
    SWITCHING_TIMES,
    T_F,
    TIME_ACCURACY,
    Claim,
    Number,
    Row,
)

THREE_DIGITS = 1e-3
"""Accuracy of λ(0) as printed [-]."""
DIFFERENCE_STEP = 1e-8
"""Step of a switching time for a difference quotient [s]; the quotient is right to 4 digits."""
GRID = 4000
"""Instants at which a sign of λ_F is looked at; a short arc of 0.3 ms is 30 of them."""

SWITCHES = 5
"""Number of switches "for all values of F_max > 0", eq. (11)."""
EVERYWHERE = f"{SWITCHES} for all values of F_max > 0"
LOWEST, HIGHEST, COUNT = 20.0, 2e4, 241
"""Forces looked at [N], evenly spaced by ratio (2.9 %): 1 % to ten times that of sec. 5.1."""
FARTHEST, FAR_COUNT = 1.2e7, 33
"""Force from which the number of switches is known by theory [N], and forces on the way there."""
WEAK = 60.0
"""Force below which the start of the move is forgotten before its end [N]."""


def plant_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the plant, beside ours."""
    plant, row = cases.plant, cases.plant.row("v_phi")
    powers = [np.linalg.matrix_power(plant.A, i) for i in range(plant.order)]
    unscaled = int(np.linalg.matrix_rank(np.array([power @ plant.B for power in powers])))
    error = _printed_adjoint_matrix(cases.mechanics, force_lag=plant.force_lag) + plant.A.T
    off = np.abs(error).max() / np.abs(plant.A).max()
    order = next(k for k in count(1) if row @ powers[k - 1] @ plant.B)
    return [
        Number("kalman-rank", "5, (10)", 7).beside(kalman_rank(plant), 0.0, unscaled=unscaled),
        Number("adjoint-equations", "5, (8)", 0.0).beside(off, 1e-14),
        Claim("order", "5.2", "order 2: F_set first appears in the second derivative").judged(
            holds=order == 2, order=order
        ),
    ]


def _printed_adjoint_matrix(m: Manipulator, *, force_lag: float) -> Array:
    """Return the matrix M of the printed adjoint equations dλ/dt = M λ, coefficient by coefficient.

    Source: Christiansen, Maurer & Zirn, eq. (8), λ as a column.
    """
    M, J = np.zeros((7, 7)), m.rotary_inertia
    M[0, 3] = m.base_stiffness / m.base_mass
    M[2, 5] = m.rotary_stiffness / J
    M[3, [0, 3]] = -1.0, m.base_damping / m.base_mass
    M[4, 1] = -1.0
    M[5, [2, 5]] = -1.0, m.rotary_damping / J
    M[6, 3:] = 1.0 / m.base_mass, -1.0 / m.slider_mass, -m.lever_arm / J, 1.0 / force_lag
    return M


def time_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the time-optimal control, beside ours."""
    best, proof = cases.time, cases.time.certificate
    hamiltonian = 1.0 + ADJOINT[-1] / cases.plant.force_lag * FORCE_LIMIT
    times = zip(SWITCHING_TIMES, best.switching_times, range(1, SWITCHES + 1), strict=True)
    return [
        *(
            Number("switching-time", "5.1, (12)", printed, "s").beside(
                ours, TIME_ACCURACY, number=i
            )
            for printed, ours, i in times
        ),
        Number("final-time", "5.1, (12)", T_F, "s").beside(
            best.t_f, TIME_ACCURACY, least=proof.t_f_lower_bound
        ),
        *_terminal_errors(cases),
        *_adjoint(cases),
        Number("hamiltonian", "5, (7)", 0.0).beside(hamiltonian, THREE_DIGITS),
        Number("jacobian-rank", "5.1", 6).beside(
            proof.terminal_jacobian_rank, 0.0, gap=proof.relative_gap
        ),
        *_switching_law(cases),
    ]


def _terminal_errors(cases: Cases) -> list[Row]:
    """Put the control (12) into the plant, exactly."""
    plant, share = cases.plant, 5e-3  # three decimals of (12) are 0.2 to 1 % of a peak
    starts, ends, sides = (0.0, *SWITCHING_TIMES), (*SWITCHING_TIMES, T_F), (1, -1) * 3
    arcs = tuple(
        constant_arc(start, end, control=Bang(side), force=side * FORCE_LIMIT)
        for start, end, side in zip(starts, ends, sides, strict=True)
    )
    reached, (target, fixed) = propagate(plant, arcs), terminal_target(plant, cases.time.move)
    return [
        Number("terminal-error", "5.1, (12)", target[i], unit=plant.signal_units[i]).beside(
            reached[i], share * cases.peak(cases.time, name), state=symbol(name), share=share
        )
        for i, name in enumerate(plant.states)
        if fixed[i]
    ]


def _adjoint(cases: Cases) -> list[Row]:
    """Compare λ(0), and say how far (12) fixes it."""
    plant, printed, switches = cases.plant, np.array(ADJOINT), np.array(SWITCHING_TIMES)
    ours = cases.time.certificate.adjoint_initial + 0.0  # no -0
    implied = _adjoint_from_switches(plant, switches)
    steps = DIFFERENCE_STEP * np.eye(switches.size)
    moved = np.array([_adjoint_from_switches(plant, switches + step) for step in steps])
    slopes = np.abs(moved - implied).sum(axis=0) / DIFFERENCE_STEP  # of λ(0) over the times [1/s]

    allowed = TIME_ACCURACY * slopes + THREE_DIGITS * np.abs(printed)

    def relative(difference: Array) -> float:
        known = printed != 0.0
        return float(np.abs(difference[known] / printed[known]).max())

    deviation = relative(implied - printed)
    return [
        *(
            Number("adjoint", "5.1", printed[i]).beside(ours[i], allowed[i], state=symbol(name))
            for i, name in enumerate(plant.states)
        ),
        Number("adjoint-implied", "5.1", 0.0).beside(
            deviation,
            0.02,
            deviation=deviation,
            rounding=relative(0.5e-6 * slopes),  # half the last decimal
            off=relative(ours - printed),
            arc=float(switches[1] - switches[0]),
        ),
    ]


def _adjoint_from_switches(plant: Plant, switching_times: Array) -> Array:
    """Return the λ(0) for which λ_F vanishes at five switching times and H = 0.

    Source: λ(t) = λ(0) e^{-At}, and H = 1 + λ(0) B F_max = 0 at rest.
    """
    unknown = np.arange(plant.order) != plant.position
    columns = [expm(-plant.A * t) @ plant.B for t in switching_times.tolist()]
    rows = np.array([*columns, plant.B])[:, unknown]
    scale = np.abs(rows).max(axis=0)
    right = np.append(np.zeros(switching_times.size), -1.0 / FORCE_LIMIT)
    found = np.zeros(plant.order)
    found[unknown] = np.linalg.solve(rows / scale, right) / scale
    return found


def follow_adjoint(
    plant: Plant, initial: Array, *, t_f: float, way: Literal["on", "back"]
) -> tuple[Array, Array]:
    """Return times and λ_F by matrix exponentials, apart from the solvers.

    ``way``: followed on from λ(0), or back from t_f with H = 0 there.
    """
    row, step, t = initial, t_f / GRID, np.linspace(0.0, t_f, GRID + 1)
    if way == "on":
        return t, powers_of(expm(-plant.A * step).T, row, GRID)[:, plant.force]
    # At the target A x is λ_xs v_s = 0, so H = 1 + λ_F F_set / T with F_set = -F_max.
    row = initial @ expm(-plant.A * t_f)
    row[plant.force] = plant.force_lag / FORCE_LIMIT
    return t, powers_of(expm(plant.A * step).T, row, GRID)[::-1, plant.force]


def _zeros(t: Array, values: Array) -> Array:
    at = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0)
    return np.asarray(t[at] + values[at] / (values[at] - values[at + 1]) * (t[at + 1] - t[at]))


def _distance(found: Array, times: tuple[float, ...]) -> float:
    """Return the largest distance of a zero from its switch [s]; inf if the numbers differ."""
    return float(np.abs(found - times).max()) if found.size == len(times) else inf


def _switching_law(cases: Cases) -> list[Row]:
    plant, best, printed = cases.plant, cases.time, np.array(ADJOINT)
    proof = best.certificate
    own = _zeros(*follow_adjoint(plant, proof.adjoint_initial, t_f=best.t_f, way="back"))
    on = _zeros(*follow_adjoint(plant, printed, t_f=T_F, way="on"))
    back = _zeros(*follow_adjoint(plant, printed, t_f=T_F, way="back"))
    # A zero interpolated linearly on 10 µs is right to less than 1 µs.
    fits = _distance(own, best.switching_times) < 1e-6
    return [
        Claim("switching-law", "5, (9)", "F_set = -sign(λ_F) F_max").judged(
            holds=proof.switching_law_holds and fits, zeros=own.size
        ),
        Claim("law-as-printed", "5.1", "(9) holds with high accuracy").judged(
            holds=_distance(on, SWITCHING_TIMES) < TIME_ACCURACY,
            refuted=on.size != SWITCHES,
            forward=on.size,
            last=float(on[-1]),
            backward=back.size,
            off=_distance(back, SWITCHING_TIMES),
            growth=exp(T_F / plant.force_lag),
        ),
    ]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scan:
    """Certified optima over the force: those that do not switch five times, and where."""

    exceptions: tuple[TimeOptimum, ...]
    ranges: tuple[tuple[int, float, float], ...]  # number of switches, and ends of the forces [N]
    gap: float  # the worst relative gap of all optima [-]


def scan_forces(plant: Plant, move: Move, forces: Sequence[float]) -> Scan:
    """Return what differs among the optima of ascending forces [N]."""

    def solve(force: float) -> TimeOptimum:
        return solve_time_optimal(plant, move, force_limit=force)

    def edge(low: float, high: float) -> float:
        """Return where the number of switches changes, to 1e-4."""
        usual = len(solve(low).arcs)
        while high / low - 1.0 > 1e-4:
            middle = sqrt(low * high)
            low, high = (middle, high) if len(solve(middle).arcs) == usual else (low, middle)
        return sqrt(low * high)

    optima = [solve(force) for force in forces]
    ranges = []
    for switches, group in groupby(range(len(forces)), lambda i: len(optima[i].switching_times)):
        run = list(group)
        before, after = forces[max(run[0] - 1, 0)], forces[min(run[-1] + 1, len(forces) - 1)]
        if switches != SWITCHES:
            ranges.append((switches, edge(before, forces[run[0]]), edge(forces[run[-1]], after)))
    return Scan(
        exceptions=tuple(one for one in optima if len(one.switching_times) != SWITCHES),
        ranges=tuple(ranges),
        gap=max(one.certificate.relative_gap for one in optima),
    )


def structure_rows(cases: Cases) -> list[Row]:
    """Return the claim of five switches, beside certified optima over the range of forces."""
    best, switches = cases.time, len(cases.time.switching_times)
    first = best.arcs[0].control
    return [
        Claim("switches", "5.1, (11)", f"{SWITCHES}, +F_max first").judged(
            holds=switches == SWITCHES and first == Bang(1),
            refuted=best.certificate.relative_gap < SURE_GAP,
            switches=switches,
            control=control_text(first),
        ),
        _switches_everywhere(cases),
        _switches_beyond(cases),
    ]


def _switches_everywhere(cases: Cases) -> Row:
    forces = np.geomspace(LOWEST, HIGHEST, COUNT).tolist()
    scan = scan_forces(cases.plant, cases.machine.moves[0], forces)
    shortest = (min(arc.length for arc in one.arcs) for one in scan.exceptions)
    return Claim("switches-everywhere", "5, (11)", EVERYWHERE).judged(
        holds=scan.gap < SURE_GAP and not scan.ranges,
        refuted=scan.gap < SURE_GAP and bool(scan.ranges),
        usual=SWITCHES,
        found=len(scan.ranges),
        exceptions=tuple(
            Message("paper-switches-between", switches=switches, lowest=low, highest=high)
            for switches, low, high in scan.ranges
        ),
        arc=max(shortest, default=0.0),
        count=COUNT,
        lowest=LOWEST,
        highest=HIGHEST,
        gap=scan.gap,
        range=LARGEST_FORCE,
    )


def _switches_beyond(cases: Cases) -> Row:
    """Close both ends: by disconjugacy above, by a limit of the switches below."""
    plant, move = cases.plant, cases.machine.moves[0]
    scan = scan_forces(plant, move, np.geomspace(HIGHEST, FARTHEST, FAR_COUNT).tolist())
    farthest, weak, weakest = (
        solve_time_optimal(plant, move, force_limit=F) for F in (FARTHEST, WEAK, LOWEST)
    )
    half, moved = pi / float(np.abs(np.linalg.eigvals(plant.A).imag).max()), inf
    if len(weak.arcs) == len(weakest.arcs) == SWITCHES + 1:
        remaining = [one.t_f - np.array(one.switching_times) for one in (weak, weakest)]
        moved = float(np.abs(remaining[0] - remaining[1]).max())
    is_five = scan.gap < SURE_GAP and not scan.ranges
    return Claim("switches-beyond", "5, (11)", EVERYWHERE).judged(
        holds=is_five and farthest.t_f < half and moved < 1e-6,
        usual=SWITCHES,
        highest=HIGHEST,
        farthest=FARTHEST,
        t_f=farthest.t_f,
        count=FAR_COUNT,
        weak=WEAK,
        moved=moved,
        half=half,
    )
