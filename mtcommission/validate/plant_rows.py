"""Sec. 2, eq. (1), (8), (10) and the order of the constraint: the model."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from mtcommission.plant.plant import Plant, kalman_rank
from mtcommission.validate.adjoint import printed_adjoint_matrix
from mtcommission.validate.cases import Cases
from mtcommission.validate.paper import FORCE_LAG, KALMAN_RANK, MECHANICS
from mtcommission.validate.row import Row, claim_row, judge_claim, number_row

CLOSED_FORM = "closed form from Table 1 against the eigenvalues of our plant"
ROUNDING = 1e-9
"""Relative tolerance where only rounding separates two ways [-]."""


def plant_rows(cases: Cases) -> tuple[Row, ...]:
    """Return what the paper says of the plant, beside ours."""
    plant = cases.plant
    return (
        *_modes(plant),
        number_row(
            "sec. 5, (10)",
            "rank of the Kalman matrix",
            printed=KALMAN_RANK,
            ours=kalman_rank(plant),
            tolerance=0.0,
            basis="a whole number",
            reason=_scaling(plant),
        ),
        _adjoint_equations(plant),
        _constraint_order(plant),
    )


def _scaling(plant: Plant) -> str:
    columns = [plant.B]
    for _ in range(plant.order - 1):
        columns.append(plant.A @ columns[-1])
    kalman = np.array(columns).T
    entries = np.abs(kalman[kalman != 0.0])
    return (
        f"Decided after scaling the states. In SI units the entries of C span "
        f"{np.log10(entries.max() / entries.min()):.0f} decades, and rounding makes its rank look "
        f"like {np.linalg.matrix_rank(kalman)}."
    )


def _modes(plant: Plant) -> tuple[Row, ...]:
    """Return frequencies, damping ratios and the lag, printed nowhere but implied by Table 1."""
    poles = np.linalg.eigvals(plant.A)
    rows = []
    for name, stiffness, damping, inertia in (
        ("base", MECHANICS.base_stiffness, MECHANICS.base_damping, MECHANICS.base_mass),
        (
            "tower",
            MECHANICS.rotary_stiffness,
            MECHANICS.rotary_damping,
            MECHANICS.rotary_inertia,
        ),
    ):
        omega = sqrt(stiffness / inertia)
        found = poles[np.argmin(np.abs(np.abs(poles) - omega) + (poles.imag < 0.0))]
        frequency = omega / (2.0 * pi)
        ratio = damping / (2.0 * sqrt(stiffness * inertia))
        rows += [
            number_row(
                "Table 1, implied",
                f"eigenfrequency of the {name} (closed form from Table 1)",
                unit="Hz",
                printed=frequency,
                ours=float(abs(found)) / (2.0 * pi),
                tolerance=ROUNDING * frequency,
                basis=CLOSED_FORM,
            ),
            number_row(
                "Table 1, implied",
                f"damping ratio of the {name} (closed form from Table 1)",
                printed=ratio,
                ours=float(-found.real / abs(found)),
                tolerance=ROUNDING,
                basis=CLOSED_FORM,
            ),
        ]
    lag = number_row(
        "Table 1, implied",
        "pole of the force lag (-1/T, Table 1)",
        unit="1/s",
        printed=-1.0 / FORCE_LAG,
        ours=float(poles.real.min()),
        tolerance=ROUNDING / FORCE_LAG,
        basis=CLOSED_FORM,
    )
    return (*rows, lag)


def _adjoint_equations(plant: Plant) -> Row:
    error = printed_adjoint_matrix() + plant.A.T
    scale = np.abs(plant.A).max()
    return number_row(
        "sec. 5, (8)",
        "adjoint equations: largest error of a coefficient, relative to the largest",
        printed=0.0,
        ours=float(np.abs(error).max() / scale),
        tolerance=1e-14,
        basis="rounding; printed coefficients against -A of our plant",
    )


def _constraint_order(plant: Plant) -> Row:
    row = plant.row("v_phi")
    order, derivative = 1, row
    while float(derivative @ plant.B) == 0.0:
        order, derivative = order + 1, derivative @ plant.A
    return claim_row(
        "sec. 5.2",
        "order of the constraint on v_phi",
        printed="order 2: F_set first appears in the second derivative",
        ours=f"order {order}",
        basis="c A^(k-1) B of our plant",
        verdict=judge_claim(holds=order == 2),
    )
