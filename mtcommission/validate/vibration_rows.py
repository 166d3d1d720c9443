"""Secs. 4 to 6: what the paper says of the vibration that its controls cause."""

from __future__ import annotations

import numpy as np

from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import sample_trajectory
from mtcommission.validate.cases import Cases
from mtcommission.validate.paper import FORCE_LIMIT, LARGEST_FORCE, RATE_BOUND
from mtcommission.validate.row import Row, claim_row, judge_claim

SAMPLES = 2000
"""Samples of a motion on which changes of sign are counted."""
HIGHLY = 4
"""Changes of sign from which a motion is "highly oscillatory" [-]: two whole swings."""
WEAKEST, FORCES = 500.0, 13
"""Least force [N], and number of forces up to the largest, whose peaks are compared."""
SIGNIFICANT = 0.9
"""Ratio below which a deflection is "significantly" smaller [-]."""
NOTABLY, HALF = 1.25, 0.5
"""Ratio from which a rate is "notably" higher, and below which "significantly" smaller [-]."""


def vibration_rows(cases: Cases) -> tuple[Row, ...]:
    """Return the claims on vibration, beside certified optima."""
    return (_oscillation(cases), _force(cases), _rotation(cases), _between(cases))


def _oscillation(cases: Cases) -> Row:
    plant, step = cases.plant, cases.time.t_f / SAMPLES
    motion = sample_trajectory(plant, cases.time.arcs, step=step)
    rate = motion.states[:, plant.states.index("v_phi")]
    inner = rate[np.abs(rate) > 1e-6 * np.abs(rate).max()]
    changes = int(np.count_nonzero(np.diff(np.sign(inner))))
    return claim_row(
        "sec. 4",
        "time-optimal trajectories oscillate",
        printed="some of the time-optimal state trajectories are highly oscillatory",
        ours=(
            f"v_phi changes its sign {changes} times in {1e3 * cases.time.t_f:.1f} ms and swings "
            f"up to {1e3 * np.abs(rate).max():.1f} mrad/s"
        ),
        basis="the certified control of sec. 5.1",
        verdict=judge_claim(holds=changes >= HIGHLY),
    )


def _force(cases: Cases) -> Row:
    """Follow the peaks of the time-optimal controls over the force."""
    plant, move = cases.plant, cases.machine.moves[0]
    forces = np.geomspace(WEAKEST, LARGEST_FORCE, FORCES)
    optima = [solve_time_optimal(plant, move, force_limit=force) for force in forces.tolist()]
    rates, angles = (
        np.array([optimum.peaks[plant.signals.index(name)] for optimum in optima])
        for name in ("v_phi", "phi")
    )
    falls = int(np.count_nonzero(np.diff(rates) < 0.0))
    return claim_row(
        "sec. 5.2",
        "higher F_max leads to higher vibrations",
        printed="higher values of F_max lead to higher vibrations",
        ours=(
            f"from {WEAKEST:g} to {LARGEST_FORCE:g} N the peak of |v_phi| grows from "
            f"{1e3 * rates[0]:.1f} to {1e3 * rates[-1]:.1f} mrad/s, that of |phi| from "
            f"{1e6 * angles[0]:.0f} to {1e6 * angles[-1]:.0f} µrad"
        ),
        basis=f"{FORCES} certified optima, evenly spaced by ratio",
        verdict=judge_claim(holds=bool(rates[-1] > 2.0 * rates[0] and angles[-1] > angles[0])),
        reason=(
            f"A trend, not a law: on {falls} of the {FORCES - 1} steps between these forces the "
            "peak of |v_phi| falls."
            if falls
            else ""
        ),
    )


def _rotation(cases: Cases) -> Row:
    index = cases.plant.signals.index("phi")
    free, bounded = float(cases.time.peaks[index]), float(cases.bounded.peaks[index])
    return claim_row(
        "sec. 5.2",
        "the bound on v_phi reduces the largest |phi|, too",
        printed="significant reduction",
        ours=(
            f"from {1e6 * free:.1f} to {1e6 * bounded:.1f} µrad, by "
            f"{100.0 * (1.0 - bounded / free):.0f} %"
        ),
        basis="peaks of the two certified controls",
        verdict=judge_claim(holds=bounded < SIGNIFICANT * free),
    )


def _between(cases: Cases) -> Row:
    index = cases.plant.signals.index("v_phi")
    damped, free = float(cases.damping.peaks[index]), float(cases.time.peaks[index])
    return claim_row(
        "sec. 6",
        "peak rate of the damping-optimal control between the other two",
        printed="notably higher than the bound, significantly smaller than time-optimal",
        ours=(
            f"{1e3 * damped:.2f} mrad/s: {damped / RATE_BOUND:.2f} times the bound, "
            f"{100.0 * damped / free:.0f} % of the free time-optimal control"
        ),
        basis=f"damping-optimal and certified time-optimal control, F_max = {FORCE_LIMIT:g} N",
        verdict=judge_claim(holds=NOTABLY * RATE_BOUND < damped < HALF * free),
    )
