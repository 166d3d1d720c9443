"""Rows of secs. 5.2 and 6: the bound on the tower's rate, and the damping-optimal control."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg import expm

from mtcommission.messages.message import Message
from mtcommission.optimal.damping import balanced_weights
from mtcommission.optimal.solution import Boundary, TimeOptimum, control_text, sample_trajectory
from mtcommission.validate import paper
from mtcommission.validate.adjoint import law_residual
from mtcommission.validate.free import SURE_GAP
from mtcommission.validate.paper import (
    BANG_ARCS,
    FORCE_LIMIT,
    RATE_BOUND,
    T_F,
    TIME_ACCURACY,
    Array,
    Cases,
)
from mtcommission.validate.row import Row, claim, number

FORMULA_TOLERANCE = 1e-7
"""Relative error of a formula that holds [-]: rounding of motions and adjoints."""
FORMULA_SAMPLES = 400
"""Samples of a motion on which a formula is measured."""
LAW_TOLERANCE = 1e-6
"""Largest deviation from (16) over F_max [-]."""


def bounded_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the bounded control, beside ours."""
    return [*_times(cases), *_structure(cases.bounded), *_formulas(cases), *_multiplier(cases)]


def _times(cases: Cases) -> list[Row]:
    bounded, free = cases.bounded, cases.time
    return [
        number(
            "5.2",
            "bounded-time",
            paper.BOUNDED_T_F,
            bounded.t_f,
            unit="s",
            tolerance=TIME_ACCURACY,
            least=bounded.certificate.t_f_lower_bound,
        ),
        number(
            "5.2",
            "increase",
            paper.INCREASE,
            bounded.t_f / free.t_f - 1.0,
            corrected=paper.BOUNDED_T_F / T_F - 1.0,
            tolerance=2.0 * TIME_ACCURACY / T_F,
        ),
        number(
            "5.2, (13)",
            "largest-rate",
            RATE_BOUND,
            cases.peak(bounded, "v_phi"),
            unit="rad/s",
            tolerance=1e-9 * RATE_BOUND,
        ),
    ]


def _sum(counts: tuple[int, ...]) -> str:
    return f"{' + '.join(map(str, counts))} = {sum(counts)}"


def _structure(optimum: TimeOptimum) -> list[Row]:
    arcs, certificate = optimum.arcs, optimum.certificate
    proved = certificate.relative_gap < SURE_GAP and certificate.switching_law_holds
    at = [i for i, arc in enumerate(arcs) if isinstance(arc.control, Boundary)]
    groups = tuple(after - before - 1 for before, after in pairwise([-1, *at, len(arcs)]))
    bangs = [arc for arc in arcs if not isinstance(arc.control, Boundary)]
    shortest = min(bangs, key=lambda arc: arc.t_end - arc.t_start)
    length = shortest.t_end - shortest.t_start
    sides = {1: "v_phi = +c", -1: "v_phi = -c"}
    touches = tuple(
        Message("paper-touch", side=sides[each.side], t=each.t) for each in optimum.touch_points
    )
    held = [arc.control.side for arc in arcs if isinstance(arc.control, Boundary)]
    return [
        claim(
            "5.2",
            "boundary-arcs",
            "one with v_phi = +c, then one with v_phi = -c",
            holds=held == [1, -1],
            refuted=proved,
            held=", ".join(sides[side] for side in held),
            gap=certificate.relative_gap,
        ),
        claim(
            "5.2",
            "bang-arcs",
            _sum(BANG_ARCS),
            holds=groups == BANG_ARCS,
            refuted=proved,
            arcs=_sum(groups),
            count=len(touches),
            touches=touches,
            gap=certificate.relative_gap,
            control=control_text(shortest.control),
            length=length,
            start=shortest.t_start,
            steps=1e4 * length / optimum.t_f,
        ),
    ]


def _formulas(cases: Cases) -> list[Row]:
    """Measure both formulas: on the free time optimum v_phi moves most, the other at the bound."""
    plant, m, T = cases.plant, paper.MECHANICS, paper.FORCE_LAG
    k, d, J, r = m.rotary_stiffness, m.rotary_damping, m.rotary_inertia, m.lever_arm
    at = [plant.states.index(name) for name in ("phi", "v_phi", "F")]
    free, bounded = (
        sample_trajectory(plant, best.arcs, step=best.t_f / FORMULA_SAMPLES)
        for best in (cases.time, cases.bounded)
    )
    row = plant.row("v_phi") @ plant.A
    truth = free.states @ (row @ plant.A) + free.force * float(row @ plant.B)
    phi, v_phi, F = free.states[:, at].T
    drive = -(r / (J * T) + r * d / J**2) * F + r / (J * T) * free.force
    printed = (d**2 - k) / J * v_phi + d * k / J * phi + drive
    corrected = (d**2 / J - k) / J * v_phi + d * k / J**2 * phi + drive
    off, off_corrected = (
        float(np.abs(x - truth).max() / np.abs(truth).max()) for x in (printed, corrected)
    )
    inside = np.zeros(bounded.t.size, dtype=bool)
    for arc in cases.bounded.arcs:
        if isinstance(arc.control, Boundary):
            inside |= (bounded.t >= arc.t_start) & (bounded.t < arc.t_end)
    force = bounded.force[inside]
    phi, v_phi, F = bounded.states[inside][:, at].T
    own = (1.0 + T * d / J) * F
    printed = T * (k - d**2) / r * v_phi - T * d * k / r * phi + own
    corrected = T * (k - d**2 / J) / r * v_phi - T * d * k / (r * J) * phi + own
    gap, gap_corrected = (
        float(np.abs(x - force).max() / FORCE_LIMIT) for x in (printed, corrected)
    )
    largest = float(np.abs(force).max())
    return [
        claim(
            "5.2",
            "second-derivative",
            "(d^2 - k)/J v_phi + d k/J phi - ...",
            corrected="(d^2/J - k)/J v_phi + d k/J^2 phi - ...",
            holds=off_corrected <= FORMULA_TOLERANCE < off,
            off=off,
            off_corrected=off_corrected,
        ),
        claim(
            "5.2",
            "boundary-control",
            "T (k - d^2)/r v_phi - T d k/r phi + (1 + T d/J) F",
            corrected="T (k - d^2/J)/r v_phi - T d k/(r J) phi + (1 + T d/J) F",
            holds=gap_corrected <= FORMULA_TOLERANCE < gap,
            off=gap,
            off_corrected=gap_corrected,
        ),
        claim(
            "5.2",
            "inside",
            "assumed",
            holds=largest < FORCE_LIMIT,
            largest=largest,
            limit=FORCE_LIMIT,
        ),
    ]


def _multiplier(cases: Cases) -> list[Row]:
    """Follow the adjoint along the first boundary arc under both forms of (15)."""
    plant, m = cases.plant, paper.MECHANICS
    J, r, m_b = m.rotary_inertia, m.lever_arm, m.base_mass
    arc = next(arc for arc in cases.bounded.arcs if isinstance(arc.control, Boundary))
    before = cases.bounded.certificate.adjoint_initial @ expm(-plant.A * arc.t_start)
    entry = before.copy()
    entry[5] = J / r * (before[3] / m_b - before[4] / m.slider_mass)
    printed = np.array(
        [J / (r * m_b), 0.0, -1.0, -J * m.base_damping / (r * m_b**2), 0.0, 0.0, 0.0]
    )
    corrected = printed.copy()
    corrected[5] = m.rotary_damping / J
    scale = plant.force_lag / FORCE_LIMIT
    paths = [_follow(plant.A, entry, mu, arc.t_end - arc.t_start) for mu in (printed, corrected)]
    drift, held = (float(np.abs(path[:, plant.force]).max()) / scale for path in paths)
    least = float((paths[1] @ corrected).min())
    at_entry = abs(float(entry[plant.force])) / scale
    return [
        claim(
            "5.2, (14)",
            "switching-function",
            "lambda_I(t) / T = H_U(t) = 0",
            corrected="lambda_F(t) / T = H_{F_set}(t) = 0",
            holds=at_entry < FORMULA_TOLERANCE,
            at_entry=at_entry,
        ),
        claim(
            "5.2, (15)",
            "multiplier",
            "J/(r m_b) lambda_xb - lambda_phi - J d_b/(r m_b^2) lambda_vb",
            corrected=Message("paper-multiplier.correct"),
            holds=held <= FORMULA_TOLERANCE < drift and least > 0.0,
            drift=drift,
            held=held,
            least=least,
        ),
        claim(
            "5.2",
            "jumps",
            "lambda_vphi may have jumps at entry and exit",
            holds=bool(entry[5] < before[5]),
            before=float(before[5]),
            after=float(entry[5]),
        ),
    ]


def _follow(A: Array, entry: Array, multiplier: Array, length: float) -> Array:
    """Return λ along a boundary arc, shape (n_samples, n): λ' = -λA - μ(λ) e_vφ."""
    system = -A
    system[:, 5] -= multiplier
    transition = expm(system * (length / FORMULA_SAMPLES))
    path = [entry]
    for _ in range(FORMULA_SAMPLES):
        path.append(path[-1] @ transition)
    return np.array(path)


def damping_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the damping-optimal control, beside ours."""
    return [*_peaks(cases), *_weights(cases), *_cost(cases), *_law(cases), _least_time(cases)]


def _peaks(cases: Cases) -> list[Row]:
    rows = []
    for name, printed, solution in (
        ("damping", paper.PEAKS[0], cases.damping),
        ("bounded", paper.PEAKS[1], cases.bounded),
        ("free", paper.PEAKS[2], cases.time),
    ):
        angle = cases.peak(solution, "phi")
        rows.append(
            number(
                "6",
                "peak-rate",
                printed,
                cases.peak(solution, "v_phi"),
                literal=angle,
                unit="rad/s",
                tolerance=2e-3 * printed,
                correction=Message("paper-peak-rate.correct"),
                control=name,
                angle=angle,
            )
        )
    return rows


def _weights(cases: Cases) -> list[Row]:
    pairs = list(zip(paper.WEIGHTS, balanced_weights(cases.plant, cases.time), strict=True))
    off = max(abs(ours.value / printed.value - 1.0) for printed, ours in pairs)
    return [
        number(
            "6, (17)",
            "weight",
            printed.value,
            ours.value,
            tolerance=0.02 * printed.value,
            state=printed.state,
            off=off,
            is_first="yes" if printed is paper.WEIGHTS[0] else "no",
        )
        for printed, ours in pairs
    ]


def coasting_cost(cases: Cases) -> float:
    """Return J of the time-optimal control followed by rest until the t_f of sec. 6 [N² s].

    With balanced weights each term would be the first, ∫ F_set² dt.
    """
    balanced = balanced_weights(cases.plant, cases.time)
    shares = [mine.value / one.value for mine, one in zip(paper.WEIGHTS, balanced, strict=True)]
    return FORCE_LIMIT**2 * cases.time.t_f * (1.0 + sum(shares))


def _cost(cases: Cases) -> list[Row]:
    terms, cost = cases.damping.cost_terms, cases.damping.cost
    shares = (terms[1:] / terms[0]).tolist()
    share = cost / coasting_cost(cases)
    return [
        claim(
            "6",
            "terms",
            "all of the same magnitude",
            holds=float(terms.max() / terms.min()) < 10.0,
            cost=cost,
            **dict(zip((weight.state for weight in paper.WEIGHTS), shares, strict=True)),
        ),
        claim(
            "6, (5)",
            "cost",
            "no value printed",
            holds=share < 1.0,
            cost=cost,
            share=share,
        ),
    ]


def _law(cases: Cases) -> list[Row]:
    damping, plant = cases.damping, cases.plant
    motion = sample_trajectory(plant, damping.arcs, step=damping.t_f / 4000)
    followed = law_residual(plant, damping, samples=40_000)
    jump = 0.0
    for before, after in pairwise(damping.arcs):
        length = before.t_end - before.t_start
        last = before.output @ expm(before.generator * length) @ before.initial
        jump = max(jump, abs(float(last - after.output @ after.initial)))
    labels = {control_text(arc.control) for arc in damping.arcs}
    return [
        number(
            "6, (16)",
            "control-law",
            0.0,
            followed,
            tolerance=LAW_TOLERANCE,
        ),
        claim(
            "6",
            "continuous",
            "any optimal control is continuous",
            holds=jump < LAW_TOLERANCE * FORCE_LIMIT,
            jump=jump / FORCE_LIMIT,
            arcs=len(damping.arcs),
        ),
        claim(
            "7",
            "saturated",
            "linear-quadratic with control constraints (saturated control)",
            holds={"+F_max", "interior"} <= labels,
            arcs=", ".join(sorted(labels)),
            largest=float(np.abs(motion.force).max()),
        ),
        claim(
            "6",
            "functional",
            "lambda = -2 D x - lambda A, D = diag(c1, 0, c2, c3, 0, c4)",
            corrected="d lambda/dt = -2 D x - lambda A, D = diag(c1, 0, c2, c3, 0, c4, 0)",
            holds=plant.order == 7 and followed < LAW_TOLERANCE,
            states=plant.order,
        ),
    ]


def _least_time(cases: Cases) -> Row:
    is_refused = cases.time.certificate.t_f_lower_bound > T_F
    return claim(
        "4",
        "least-time",
        "t_f > t_f,min",
        holds=is_refused,
        longer=paper.BOUNDED_T_F,
        least=T_F,
        refused="yes" if is_refused else "no",
    )


def peak_rows(cases: Cases) -> list[Row]:
    """Return what bound and damping do to the vibration."""
    free, bounded = (cases.peak(best, "phi") for best in (cases.time, cases.bounded))
    damped, fast = (cases.peak(best, "v_phi") for best in (cases.damping, cases.time))
    return [
        claim(
            "5.2",
            "bound-helps",
            "significant reduction",
            holds=bounded < 0.9 * free,
            free=free,
            bounded=bounded,
            less=1.0 - bounded / free,
        ),
        claim(
            "6",
            "rate-between",
            "notably higher than the bound, significantly smaller than time-optimal",
            holds=1.25 * RATE_BOUND < damped < 0.5 * fast,
            rate=damped,
            over=damped / RATE_BOUND,
            share=damped / fast,
            limit=FORCE_LIMIT,
        ),
    ]
