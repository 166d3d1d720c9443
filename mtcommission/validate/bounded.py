"""Rows of secs. 5.2 and 6: the bound on the tower's rate, and the damping-optimal control."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg import expm

from mtcommission.base.messages.message import Message, Value
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import (
    AnyOptimum,
    Boundary,
    TimeOptimum,
    control_text,
    powers_of,
    sample_trajectory,
)
from mtcommission.optimal.damping import balanced_weights
from mtcommission.validate.adjoint import law_residual
from mtcommission.validate.cases import Array, Cases
from mtcommission.validate.free import SURE_GAP
from mtcommission.validate.paper import (
    BANG_ARCS,
    BOUNDED_T_F,
    FORCE_LIMIT,
    INCREASE,
    PEAKS,
    RATE_BOUND,
    T_F,
    TIME_ACCURACY,
    Row,
    claim,
    number,
)

FORMULA_TOLERANCE = 1e-7
"""Relative error of a formula that holds [-]: rounding of motions and adjoints."""
FORMULA_SAMPLES = 400
"""Samples of a motion on which a formula is measured."""
LAW_TOLERANCE = 1e-6
"""Largest deviation from (16) over F_max [-]."""


def bounded_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the bounded control, beside ours."""
    bounded, printed = cases.bounded, BOUNDED_T_F
    least, rate = {"least": bounded.certificate.t_f_lower_bound}, cases.peak(bounded.peaks, "v_phi")
    longer, own = bounded.t_f / cases.time.t_f - 1.0, printed / T_F - 1.0
    room = 1e-9 * RATE_BOUND
    return [
        number("bounded-time", printed, bounded.t_f, TIME_ACCURACY, least, unit="s"),
        number(
            "increase", INCREASE, longer, 2.0 * TIME_ACCURACY / T_F, {"own": own}, corrected=own
        ),
        number("largest-rate", RATE_BOUND, rate, room, unit="rad/s"),
        *_structure(bounded),
        *_formulas(cases),
        *_multiplier(cases),
    ]


def _sum(counts: tuple[int, ...]) -> str:
    return f"{' + '.join(map(str, counts))} = {sum(counts)}"


def _structure(optimum: TimeOptimum) -> list[Row]:
    arcs, certificate = optimum.arcs, optimum.certificate
    proved = certificate.relative_gap < SURE_GAP and certificate.switching_law_holds
    at = [i for i, arc in enumerate(arcs) if isinstance(arc.control, Boundary)]
    held = [arc.control.side for arc in arcs if isinstance(arc.control, Boundary)]
    groups = tuple(after - before - 1 for before, after in pairwise([-1, *at, len(arcs)]))
    bangs = [arc for arc in arcs if not isinstance(arc.control, Boundary)]
    shortest = min(bangs, key=lambda arc: arc.length)
    sides, gap = {1: "v_phi = +c", -1: "v_phi = -c"}, {"gap": certificate.relative_gap}
    touches = tuple(
        Message("paper-touch", side=sides[each.side], t=each.t) for each in optimum.touch_points
    )
    short: dict[str, Value] = {"control": control_text(shortest.control), "start": shortest.t_start}
    length = {"length": shortest.length, "steps": 1e4 * shortest.length / optimum.t_f}
    seen: dict[str, Value] = {"arcs": _sum(groups), "count": len(touches), "touches": touches}
    return [
        claim(
            "boundary-arcs",
            {"held": ", ".join(sides[side] for side in held), **gap},
            holds=held == [1, -1],
            refuted=proved,
        ),
        claim(
            "bang-arcs",
            {**seen, **gap, **short, **length},
            holds=groups == BANG_ARCS,
            refuted=proved,
        ),
    ]


def _row(plant: Plant, **terms: float) -> Array:
    """Return what a formula has before the states that it names, shape (n,)."""
    row = np.zeros(plant.order)
    for name, factor in terms.items():
        row[plant.states.index(name)] = factor
    return row


def _formulas(cases: Cases) -> list[Row]:
    """Measure both formulas: on the free time optimum v_phi moves most, the other at the bound."""
    plant, m, T = cases.plant, cases.mechanics, cases.plant.force_lag
    k, d, J, r = m.rotary_stiffness, m.rotary_damping, m.rotary_inertia, m.lever_arm
    free, bounded = (
        sample_trajectory(plant, best.arcs, step=best.t_f / FORMULA_SAMPLES)
        for best in (cases.time, cases.bounded)
    )
    slope = plant.row("v_phi") @ plant.A
    truth = free.states @ (slope @ plant.A) + free.force * float(slope @ plant.B)
    own = -(r / (J * T) + r * d / J**2)
    push = r / (J * T) * free.force
    printed = _row(plant, v_phi=(d**2 - k) / J, phi=d * k / J, F=own)
    corrected = _row(plant, v_phi=(d**2 / J - k) / J, phi=d * k / J**2, F=own)
    off, off_corrected = (
        float(np.abs(free.states @ row + push - truth).max() / np.abs(truth).max())
        for row in (printed, corrected)
    )
    held = [arc for arc in cases.bounded.arcs if isinstance(arc.control, Boundary)]
    inside = np.any([(bounded.t >= a.t_start) & (bounded.t < a.t_end) for a in held], axis=0)
    states, force = bounded.states[inside], bounded.force[inside]
    own = 1.0 + T * d / J
    printed = _row(plant, v_phi=T * (k - d**2) / r, phi=-T * d * k / r, F=own)
    corrected = _row(plant, v_phi=T * (k - d**2 / J) / r, phi=-T * d * k / (r * J), F=own)
    gap, gap_corrected = (
        float(np.abs(states @ row - force).max() / FORCE_LIMIT) for row in (printed, corrected)
    )
    largest = float(np.abs(force).max())
    return [
        claim(
            "second-derivative",
            {"off": off, "off_corrected": off_corrected},
            holds=off_corrected <= FORMULA_TOLERANCE < off,
        ),
        claim(
            "boundary-control",
            {"off": gap, "off_corrected": gap_corrected},
            holds=gap_corrected <= FORMULA_TOLERANCE < gap,
        ),
        claim("inside", {"largest": largest, "limit": FORCE_LIMIT}, holds=largest < FORCE_LIMIT),
    ]


def _multiplier(cases: Cases) -> list[Row]:
    """Follow the adjoint along the first boundary arc under both forms of (15)."""
    plant, m = cases.plant, cases.mechanics
    J, m_b, at = m.rotary_inertia, m.base_mass, plant.states.index("v_phi")
    arc = next(arc for arc in cases.bounded.arcs if isinstance(arc.control, Boundary))
    before = cases.bounded.certificate.adjoint_initial @ expm(-plant.A * arc.t_start)
    entry, lever = before.copy(), J / m.lever_arm
    entry[at] = lever * (before[3] / m_b - before[4] / m.slider_mass)
    printed = _row(plant, x_b=lever / m_b, phi=-1.0, v_b=-lever * m.base_damping / m_b**2)
    corrected = printed + _row(plant, v_phi=m.rotary_damping / J)
    step = arc.length / FORMULA_SAMPLES
    # λ' = -λ A - μ(λ) e_vφ along the arc.
    paths = [
        powers_of(
            expm(-(plant.A.T + np.outer(plant.row("v_phi"), mu)) * step), entry, FORMULA_SAMPLES
        )
        for mu in (printed, corrected)
    ]
    scale = plant.force_lag / FORCE_LIMIT
    drift, held = (float(np.abs(path[:, plant.force]).max()) / scale for path in paths)
    least, at_entry = float((paths[1] @ corrected).min()), abs(float(entry[plant.force])) / scale
    jump = {"before": float(before[at]), "after": float(entry[at])}
    return [
        claim("switching-function", {"at_entry": at_entry}, holds=at_entry < FORMULA_TOLERANCE),
        claim(
            "multiplier",
            {"drift": drift, "held": held, "least": least},
            holds=held <= FORMULA_TOLERANCE < drift and least > 0.0,
        ),
        claim("jumps", jump, holds=jump["after"] < jump["before"]),
    ]


def damping_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the damping-optimal control, beside ours."""
    best, is_refused = cases.damping, cases.time.certificate.t_f_lower_bound > T_F
    terms, weights = best.cost_terms, best.weights
    shares = dict(zip((w.name for w in weights), (terms[1:] / terms[0]).tolist(), strict=True))
    share = best.cost / coasting_cost(cases)
    said = {"longer": BOUNDED_T_F, "least": T_F, "refused": "yes" if is_refused else "no"}
    return [
        *_peaks(cases),
        *_weights(cases),
        claim(
            "terms", {"cost": best.cost, **shares}, holds=float(terms.max() / terms.min()) < 10.0
        ),
        claim("cost", {"cost": best.cost, "share": share}, holds=share < 1.0),
        *_law(cases),
        claim("least-time", said, holds=is_refused),
    ]


def _peaks(cases: Cases) -> list[Row]:
    rows = list[Row]()
    solutions: tuple[AnyOptimum, ...] = (cases.damping, cases.bounded, cases.time)
    for name, printed, best in zip(("damping", "bounded", "free"), PEAKS, solutions, strict=True):
        angle, rate = (cases.peak(best.peaks, state) for state in ("phi", "v_phi"))
        said: dict[str, Value] = {"control": name, "angle": angle}
        rows.append(
            number("peak-rate", printed, rate, 2e-3 * printed, said, unit="rad/s", literal=angle)
        )
    return rows


def _weights(cases: Cases) -> list[Row]:
    rows, balanced = list[Row](), balanced_weights(cases.plant, cases.time)
    pairs = list(zip(cases.damping.weights, balanced, strict=True))
    off = max(abs(ours.value / printed.value - 1.0) for printed, ours in pairs)
    for printed, ours in pairs:
        is_first = "no" if rows else "yes"
        said: dict[str, Value] = {"state": printed.name, "off": off, "is_first": is_first}
        room = 0.02 * printed.value
        rows.append(number("weight", printed.value, ours.value, room, said))
    return rows


def coasting_cost(cases: Cases) -> float:
    """Return J of the time-optimal control followed by rest until the t_f of sec. 6 [N² s].

    With balanced weights each term would be the first, ∫ F_set² dt.
    """
    balanced = balanced_weights(cases.plant, cases.time)
    pairs = zip(cases.damping.weights, balanced, strict=True)
    shares = [mine.value / one.value for mine, one in pairs]
    return FORCE_LIMIT**2 * cases.time.t_f * (1.0 + sum(shares))


def _law(cases: Cases) -> list[Row]:
    damping, plant = cases.damping, cases.plant
    motion = sample_trajectory(plant, damping.arcs, step=damping.t_f / 4000)
    followed, jump = law_residual(plant, damping, samples=40_000), 0.0
    for before, after in pairwise(damping.arcs):
        last = before.output @ expm(before.generator * before.length) @ before.initial
        jump = max(jump, abs(float(last - after.output @ after.initial)))
    labels, largest = (
        {control_text(arc.control) for arc in damping.arcs},
        np.abs(motion.force).max(),
    )
    return [
        number("control-law", 0.0, followed, LAW_TOLERANCE),
        claim(
            "continuous",
            {"jump": jump / FORCE_LIMIT, "arcs": len(damping.arcs)},
            holds=jump < LAW_TOLERANCE * FORCE_LIMIT,
        ),
        claim(
            "saturated",
            {"arcs": ", ".join(sorted(labels)), "largest": float(largest)},
            holds={"+F_max", "interior"} <= labels,
        ),
        claim(
            "functional",
            {"states": plant.order},
            holds=plant.order == 7 and followed < LAW_TOLERANCE,
        ),
    ]


def peak_rows(cases: Cases) -> list[Row]:
    """Return what bound and damping do to the vibration."""
    free, bounded = (cases.peak(best.peaks, "phi") for best in (cases.time, cases.bounded))
    damped, fast = (cases.peak(best.peaks, "v_phi") for best in (cases.damping, cases.time))
    shares = {"over": damped / RATE_BOUND, "share": damped / fast}
    return [
        claim(
            "bound-helps",
            {"free": free, "bounded": bounded, "less": 1.0 - bounded / free},
            holds=bounded < 0.9 * free,
        ),
        claim(
            "rate-between",
            {"rate": damped, "limit": FORCE_LIMIT, **shares},
            holds=1.25 * RATE_BOUND < damped < 0.5 * fast,
        ),
    ]
