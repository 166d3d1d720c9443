"""Rows of sec. 6, the damping-optimal control, and of secs. 4 to 6 on what vibrates."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg import expm

from mtcommission.base.messages.message import Message
from mtcommission.optimal.control import AnyOptimum, control_text
from mtcommission.optimal.damping import balanced_weights
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.validate.cases import Cases, symbol
from mtcommission.validate.paper import (
    BOUNDED_T_F,
    FORCE_LIMIT,
    LARGEST_FORCE,
    RATE_BOUND,
    Claim,
    Number,
    Row,
)

LAW_TOLERANCE = 1e-6
"""Largest deviation from (16) over F_max [-]."""


def damping_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the damping-optimal control, beside ours."""
    best, least = cases.damping, cases.time.certificate.t_f_lower_bound
    pairs = list(zip(best.weights, balanced_weights(cases.plant, cases.time), strict=True))
    shares = best.cost_terms[1:] / best.cost_terms[0]
    return [
        _peak_rate(cases, best, "damping", 0.008916),
        _peak_rate(cases, cases.bounded, "bounded", 0.005),
        _peak_rate(cases, cases.time, "free", 0.022444),
        *(
            Number("weight", "6, (17)", printed.value).beside(
                ours.value, 0.02 * printed.value, state=symbol(printed.name)
            )
            for printed, ours in pairs
        ),
        Number("control-law", "6, (16)", 0.0).beside(best.certificate.law_residual, LAW_TOLERANCE),
        Claim("terms", "6", "all of the same magnitude").judged(
            holds=bool(best.cost_terms.max() < 10.0 * best.cost_terms.min()),
            cost=best.cost,
            off=max(abs(ours.value / printed.value - 1.0) for printed, ours in pairs),
            **{printed.name: share for (printed, _), share in zip(pairs, shares, strict=True)},
        ),
        *_arcs(cases),
        Claim("least-time", "4", "t_f > t_f,min").judged(
            holds=least < BOUNDED_T_F, longer=BOUNDED_T_F, least=least
        ),
    ]


def _peak_rate(cases: Cases, best: AnyOptimum, control: str, printed: float) -> Row:
    angle, correct = cases.peak(best, "phi"), Message("paper-peak-rate.correct")
    return Number("peak-rate", "6", printed, unit="rad/s", correct=correct).beside(
        cases.peak(best, "v_phi"), 2e-3 * printed, control=control, angle=angle
    )


def _arcs(cases: Cases) -> list[Row]:
    damping, order = cases.damping, cases.plant.order
    jump = 0.0
    for before, after in pairwise(damping.arcs):
        last = before.output @ expm(before.generator * before.length) @ before.initial
        jump = max(jump, abs(float(last - after.output @ after.initial)) / FORCE_LIMIT)
    labels = {control_text(arc.control) for arc in damping.arcs}
    return [
        Claim("continuous", "6", "any optimal control is continuous").judged(
            holds=jump < LAW_TOLERANCE, jump=jump, arcs=len(damping.arcs)
        ),
        Claim(
            "saturated", "7", "linear-quadratic with control constraints (saturated control)"
        ).judged(
            holds={"+F_max", "interior"} <= labels,
            arcs=", ".join(sorted(labels)),
            largest=damping.motion.force_peak,
        ),
        Claim(
            "functional",
            "6",
            "λ = -2 D x - λ A, D = diag(c1, 0, c2, c3, 0, c4)",
            correct="dλ/dt = -2 D x - λ A, D = diag(c1, 0, c2, c3, 0, c4, 0)",
        ).judged(
            holds=order == 7 and damping.certificate.law_residual < LAW_TOLERANCE, states=order
        ),
    ]


def vibration_rows(cases: Cases) -> list[Row]:
    """Return how the optimal controls vibrate, and what force, bound and damping do to it."""
    rate = cases.sample(cases.time, count=2000).states[:, cases.plant.states.index("v_phi")]
    swing, damped = (cases.peak(best, "v_phi") for best in (cases.time, cases.damping))
    changes = int(np.count_nonzero(np.diff(np.sign(rate[np.abs(rate) > 1e-6 * swing]))))
    free, bounded = (cases.peak(best, "phi") for best in (cases.time, cases.bounded))
    return [
        Claim(
            "oscillation", "4", "some of the time-optimal state trajectories are highly oscillatory"
        ).judged(holds=changes >= 4, changes=changes, t_f=cases.time.t_f, rate=swing),
        _more_force(cases),
        Claim("bound-helps", "5.2", "significant reduction").judged(
            holds=bounded < 0.9 * free, free=free, bounded=bounded, less=1.0 - bounded / free
        ),
        Claim(
            "rate-between",
            "6",
            "notably higher than the bound, significantly smaller than time-optimal",
        ).judged(
            holds=1.25 * RATE_BOUND < damped < 0.5 * swing,
            rate=damped,
            limit=FORCE_LIMIT,
            over=damped / RATE_BOUND,
            share=damped / swing,
        ),
    ]


def _more_force(cases: Cases) -> Row:
    forces = np.geomspace(500.0, LARGEST_FORCE, 13).tolist()
    move = cases.machine.moves[0]
    optima = [solve_time_optimal(cases.plant, move, force_limit=force) for force in forces]
    rates, angles = ([cases.peak(one, name) for one in optima] for name in ("v_phi", "phi"))
    return Claim("more-force", "5.2", "higher values of F_max lead to higher vibrations").judged(
        holds=rates[-1] > 2.0 * rates[0] and angles[-1] > angles[0],
        least=forces[0],
        most=forces[-1],
        count=len(forces),
        rate=rates[0],
        highest_rate=rates[-1],
        angle=angles[0],
        largest_angle=angles[-1],
        falls=sum(after < before for before, after in pairwise(rates)),
        steps=len(rates) - 1,
    )
