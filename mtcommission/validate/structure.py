"""Sec. 5: "for all values of F_max > 0 the control has ... 5 switching times", put to the test."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Move
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import Bang, TimeOptimum, control_text
from mtcommission.plant.plant import Plant
from mtcommission.validate.cases import Cases
from mtcommission.validate.paper import LARGEST_FORCE, SWITCHES
from mtcommission.validate.row import Row, claim_row, judge_claim

Array = NDArray[np.float64]

LOWEST, HIGHEST, COUNT = 20.0, 2e4, 241
"""Forces looked at [N], evenly spaced by ratio (2.9 %): 1 % to ten times that of sec. 5.1."""
FARTHEST, FAR_COUNT = 1.2e7, 33
"""Force from which the number of switches is known by theory [N], and forces on the way there."""
WEAK = 60.0
"""Force below which the start of the move is forgotten before its end [N]."""
SAME_SWITCHES = 1e-6
"""Distance up to which two switching times, counted from t_f, count as one [s]."""
EDGE_TOLERANCE = 1e-4
"""Relative width to which the ends of a range of forces are found [-]."""
SURE_GAP = 1e-9
"""Relative gap below which an optimum counts as proved [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Counterexample:
    """A range of forces at which the certified optimum has another number of switches."""

    # lowest, highest: Its ends, to 1e-4 [N].
    lowest: float
    highest: float
    switches: int  # Number of switches inside
    shortest_arc: float  # Largest length of the shortest arc at the forces looked at [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scan:
    """Number of switches over F_max."""

    solved: int  # Forces looked at
    worst_gap: float  # Largest relative gap between t_f and its proved lower bound [-]
    # Ranges with another number of switches than the paper's, ascending.
    counterexamples: tuple[Counterexample, ...]


def scan_forces(plant: Plant, move: Move, *, lowest: float, highest: float, count: int) -> Scan:
    """Return where the time-optimal control has another number of switches than 5.

    Examples
    --------
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.validate.paper import paper_machine
    >>> machine = paper_machine()
    >>> plant, move = build_plant(machine), machine.moves[0]
    >>> scan_forces(plant, move, lowest=1.9e3, highest=2.1e3, count=3).counterexamples
    ()
    """
    forces = np.geomspace(lowest, highest, count).tolist()
    optima = [solve_time_optimal(plant, move, force_limit=force) for force in forces]
    found = []
    for switches, run in groupby(range(count), key=lambda i: count_switches(optima[i])):
        inside = list(run)
        if switches == SWITCHES:
            continue
        first, last = inside[0], inside[-1]
        before, after = max(first - 1, 0), min(last + 1, count - 1)
        found.append(
            Counterexample(
                lowest=_edge(plant, move, forces[before], forces[first]),
                highest=_edge(plant, move, forces[last], forces[after]),
                switches=switches,
                shortest_arc=max(_shortest_arc(optima[i]) for i in inside),
            )
        )
    return Scan(
        solved=count,
        worst_gap=max(item.certificate.relative_gap for item in optima),
        counterexamples=tuple(found),
    )


def count_switches(optimum: TimeOptimum) -> int:
    """Return the number of switches of a bang-bang control."""
    return len(optimum.arcs) - 1


def _shortest_arc(optimum: TimeOptimum) -> float:
    return min(arc.t_end - arc.t_start for arc in optimum.arcs)


def _edge(plant: Plant, move: Move, low: float, high: float) -> float:
    """Return the force between two at which the number of switches changes [N]."""
    at_low = count_switches(solve_time_optimal(plant, move, force_limit=low))
    while high > low * (1.0 + EDGE_TOLERANCE):
        middle = sqrt(low * high)
        if count_switches(solve_time_optimal(plant, move, force_limit=middle)) == at_low:
            low = middle
        else:
            high = middle
    return sqrt(low * high)


def structure_rows(cases: Cases) -> tuple[Row, ...]:
    """Return the claim of five switches, beside certified optima over the range of forces."""
    at_paper = count_switches(cases.time)
    scan = scan_forces(
        cases.plant, cases.machine.moves[0], lowest=LOWEST, highest=HIGHEST, count=COUNT
    )
    proved = scan.worst_gap < SURE_GAP
    exceptions = "; ".join(
        f"{item.switches} from {item.lowest:.1f} to {item.highest:.1f} N"
        for item in scan.counterexamples
    )
    return (
        claim_row(
            "sec. 5.1, (11)",
            "number of switches at F_max = 2 kN",
            printed=f"{SWITCHES}, +F_max first",
            ours=f"{at_paper}, {control_text(cases.time.arcs[0].control)} first",
            basis="certified optimum",
            verdict=judge_claim(
                holds=at_paper == SWITCHES and cases.time.arcs[0].control == Bang(1),
                refuted=cases.time.certificate.relative_gap < SURE_GAP,
            ),
        ),
        claim_row(
            "sec. 5, (11)",
            "number of switches for all F_max > 0",
            printed=f"{SWITCHES} for all values of F_max > 0",
            ours=f"{SWITCHES}, but {exceptions}" if exceptions else f"{SWITCHES} throughout",
            basis=(
                f"{scan.solved} certified optima from {LOWEST:g} to {HIGHEST:g} N, largest "
                f"relative gap {scan.worst_gap:.1g}"
            ),
            verdict=judge_claim(
                holds=proved and not scan.counterexamples,
                refuted=proved and bool(scan.counterexamples),
            ),
            reason=_reason(scan),
        ),
        _outside(cases),
    )


def _outside(cases: Cases) -> Row:
    """Close the range of forces at both ends."""
    plant, move = cases.plant, cases.machine.moves[0]
    far = scan_forces(plant, move, lowest=HIGHEST, highest=FARTHEST, count=FAR_COUNT)
    farthest = solve_time_optimal(plant, move, force_limit=FARTHEST)
    half = pi / max(abs(pole.imag) for pole in np.linalg.eigvals(plant.A))
    weak, weakest = (solve_time_optimal(plant, move, force_limit=F) for F in (WEAK, LOWEST))
    moved = np.inf
    if count_switches(weak) == count_switches(weakest) == SWITCHES:
        moved = float(np.abs(_remaining(weak) - _remaining(weakest)).max())
    holds = not far.counterexamples and far.worst_gap < SURE_GAP and farthest.t_f < half
    return claim_row(
        "sec. 5, (11)",
        "number of switches beyond these forces",
        printed=f"{SWITCHES} for all values of F_max > 0",
        ours=(
            f"{SWITCHES} from {HIGHEST:g} to {FARTHEST:g} N, where t_f = "
            f"{1e3 * farthest.t_f:.3f} ms; below {WEAK:g} N the switches, counted from t_f, move "
            f"by less than {1e9 * moved:.2g} ns"
        ),
        basis=f"{FAR_COUNT} certified optima, and theory for the rest",
        verdict=judge_claim(holds=holds and moved < SAME_SWITCHES),
        reason=(
            f"In less than {1e3 * half:.3f} ms, half a damped period of the tower, no combination "
            "of 1, e^(-t/T) and the modes' functions has more than five zeros, and five conditions "
            "of rest need at least five switches. Small forces move for so long that what the "
            "start excites has decayed at the end: there the switches are those of one limit."
        ),
    )


def _remaining(optimum: TimeOptimum) -> Array:
    """Return the switching times counted back from t_f [s]."""
    return optimum.t_f - np.array(optimum.switching_times)


def _reason(scan: Scan) -> str:
    if not scan.counterexamples:
        return ""
    longest = max(item.shortest_arc for item in scan.counterexamples)
    return (
        f"Within the machine's own range (F_max <= {LARGEST_FORCE / 1e3:g} kN) a double zero of "
        "the switching function opens into two more switches. The optimum is unique and proved, "
        f"so five switches are slower there. The shortest arc is at most {1e6 * longest:.0f} µs "
        "long: easily lost on a grid. Between the forces looked at nothing is proved."
    )
