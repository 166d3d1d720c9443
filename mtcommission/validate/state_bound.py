"""Rows of sec. 5.2: the time-optimal control under a bound on the tower's rate."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.linalg import expm

from mtcommission.base.messages.message import Message
from mtcommission.optimal.control import Boundary, control_text, powers_of
from mtcommission.validate.cases import Array, Cases
from mtcommission.validate.paper import (
    BOUNDED_T_F,
    FORCE_LIMIT,
    SURE_GAP,
    T_F,
    TIME_ACCURACY,
    Claim,
    Number,
    Row,
)

FORMULA_TOLERANCE = 1e-7
"""Relative error of a formula that holds [-]: rounding of motions and adjoints."""
FORMULA_SAMPLES = 400
"""Samples of a motion on which a formula is measured."""
SIDES = {1: "v_φ = +c", -1: "v_φ = -c"}
"""Sides of the bound."""


def bounded_rows(cases: Cases) -> list[Row]:
    """Return what the paper says of the bounded control, beside ours."""
    bounded, own = cases.bounded, BOUNDED_T_F / T_F - 1.0
    return [
        Number("bounded-time", "5.2", BOUNDED_T_F, unit="s").beside(
            bounded.t_f, TIME_ACCURACY, least=bounded.certificate.t_f_lower_bound
        ),
        Number("increase", "5.2", 0.23, correct=own).beside(
            bounded.t_f / cases.time.t_f - 1.0, 2.0 * TIME_ACCURACY / T_F, own=own
        ),
        *_structure(cases),
        *_formulas(cases),
        *_multiplier(cases),
    ]


def _structure(cases: Cases) -> list[Row]:
    arcs, proof = cases.bounded.arcs, cases.bounded.certificate
    proved, gap = proof.relative_gap < SURE_GAP and proof.switching_law_holds, proof.relative_gap
    at = [i for i, arc in enumerate(arcs) if isinstance(arc.control, Boundary)]
    sides = [arc.control.side for arc in arcs if isinstance(arc.control, Boundary)]
    groups = tuple(after - before - 1 for before, after in pairwise([-1, *at, len(arcs)]))
    shortest = min((arc for i, arc in enumerate(arcs) if i not in at), key=lambda arc: arc.length)
    touches = tuple(
        Message("paper-touch", side=SIDES[one.side], t=one.t) for one in cases.bounded.touch_points
    )
    return [
        Claim("boundary-arcs", "5.2", "one with v_φ = +c, then one with v_φ = -c").judged(
            holds=sides == [1, -1],
            refuted=proved,
            held=", ".join(SIDES[side] for side in sides),
            gap=gap,
        ),
        Claim("bang-arcs", "5.2", "2 + 5 + 2 = 9").judged(
            holds=groups == (2, 5, 2),
            refuted=proved,
            arcs=f"{' + '.join(map(str, groups))} = {sum(groups)}",
            count=len(touches),
            touches=touches,
            gap=gap,
            control=control_text(shortest.control),
            start=shortest.t_start,
            length=shortest.length,
            steps=1e4 * shortest.length / cases.bounded.t_f,
        ),
    ]


def _formulas(cases: Cases) -> list[Row]:
    """Measure both formulas: on the free time optimum v_φ moves most, the other at the bound."""
    plant, m, T = cases.plant, cases.mechanics, cases.plant.force_lag
    k, d, J, r = m.rotary_stiffness, m.rotary_damping, m.rotary_inertia, m.lever_arm
    tower = [plant.states.index(name) for name in ("v_phi", "phi", "F")]

    motion = cases.sample(cases.time, count=FORMULA_SAMPLES)
    slope, (v_phi, phi, F) = plant.row("v_phi") @ plant.A, motion.states.T[tower]
    truth = motion.states @ (slope @ plant.A) + motion.force * (slope @ plant.B)
    rest = r / (J * T) * motion.force - (r / (J * T) + r * d / J**2) * F
    printed = (d**2 - k) / J * v_phi + d * k / J * phi + rest
    correct = (d**2 / J - k) / J * v_phi + d * k / J**2 * phi + rest
    off, off_correct = (
        float(np.abs(one - truth).max() / np.abs(truth).max()) for one in (printed, correct)
    )

    motion = cases.sample(cases.bounded, count=FORMULA_SAMPLES)
    held = [arc for arc in cases.bounded.arcs if isinstance(arc.control, Boundary)]
    inside = np.any([(motion.t >= a.t_start) & (motion.t < a.t_end) for a in held], axis=0)
    force, (v_phi, phi, F) = motion.force[inside], motion.states[inside].T[tower]
    printed = T * (k - d**2) / r * v_phi - T * d * k / r * phi + (1.0 + T * d / J) * F
    correct = T * (k - d**2 / J) / r * v_phi - T * d * k / (r * J) * phi + (1.0 + T * d / J) * F
    gap, gap_correct = (
        float(np.abs(one - force).max() / FORCE_LIMIT) for one in (printed, correct)
    )
    largest = float(np.abs(force).max())
    return [
        Claim(
            "second-derivative",
            "5.2",
            "(d² - k)/J v_φ + d k/J φ - ...",
            correct="(d²/J - k)/J v_φ + d k/J² φ - ...",
        ).judged(holds=off_correct <= FORMULA_TOLERANCE < off, off=off, off_corrected=off_correct),
        Claim(
            "boundary-control",
            "5.2",
            "T (k - d²)/r v_φ - T d k/r φ + (1 + T d/J) F",
            correct="T (k - d²/J)/r v_φ - T d k/(r J) φ + (1 + T d/J) F",
        ).judged(holds=gap_correct <= FORMULA_TOLERANCE < gap, off=gap, off_corrected=gap_correct),
        Claim("inside", "5.2", "assumed").judged(
            holds=largest < FORCE_LIMIT, largest=largest, limit=FORCE_LIMIT
        ),
    ]


def _multiplier(cases: Cases) -> list[Row]:
    """Follow the adjoint along the first boundary arc under both forms of (15)."""
    plant, m = cases.plant, cases.mechanics
    arc = next(arc for arc in cases.bounded.arcs if isinstance(arc.control, Boundary))
    before = cases.bounded.certificate.adjoint_initial @ expm(-plant.A * arc.t_start)
    entry, lever = before.copy(), m.rotary_inertia / m.lever_arm
    rate = plant.states.index("v_phi")
    entry[rate] = lever * (before[3] / m.base_mass - before[4] / m.slider_mass)
    base = plant.row("x_b") - m.base_damping / m.base_mass * plant.row("v_b")
    printed = lever / m.base_mass * base - plant.row("phi")
    correct = printed + m.rotary_damping / m.rotary_inertia * plant.row("v_phi")

    def follow(mu: Array) -> Array:
        """Return λ along the arc, λ' = -λ A - μ(λ) e_vφ."""
        generator = -(plant.A.T + np.outer(plant.row("v_phi"), mu))
        return powers_of(expm(generator * arc.length / FORMULA_SAMPLES), entry, FORMULA_SAMPLES)

    scale = plant.force_lag / FORCE_LIMIT  # |λ_F(0)|
    paths = follow(printed), follow(correct)
    drift, held = (float(np.abs(path[:, plant.force]).max()) / scale for path in paths)
    least, at_entry = float((paths[1] @ correct).min()), abs(float(entry[plant.force])) / scale
    return [
        Claim(
            "switching-function",
            "5.2, (14)",
            "λ_I(t) / T = H_U(t) = 0",
            correct="λ_F(t) / T = H_{F_set}(t) = 0",
        ).judged(holds=at_entry < FORMULA_TOLERANCE, at_entry=at_entry),
        Claim(
            "multiplier",
            "5.2, (15)",
            "J/(r m_b) λ_xb - λ_φ - J d_b/(r m_b²) λ_vb",
            correct=Message("paper-multiplier.correct"),
        ).judged(
            holds=held <= FORMULA_TOLERANCE < drift and least > 0.0,
            drift=drift,
            held=held,
            least=least,
        ),
        Claim("jumps", "5.2", "λ_vφ may have jumps at entry and exit").judged(
            holds=bool(entry[rate] < before[rate]),
            before=float(before[rate]),
            after=float(entry[rate]),
        ),
    ]
