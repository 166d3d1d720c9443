"""Figs. 4 and 5 of the paper again, from our solutions."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from mtcommission.optimal.solution import TimeOptimum, sample_trajectory
from mtcommission.plant.plant import Plant
from mtcommission.sheet.document import Border, Line, LinePlot, Panel
from mtcommission.validate.cases import Cases
from mtcommission.validate.paper import FORCE_LIMIT, RATE_BOUND, VELOCITY_STEP

SAMPLES = 800
"""Points of a curve; more are not seen."""
SOLID = 4
"""Line style of the sheet."""
STATES = (
    ("x_b", "x_b in µm", 1e6),
    ("v_s", "v_s in mm/s", 1e3),
    ("phi", "φ in µrad", 1e6),
    ("v_phi", "v_φ in mrad/s", 1e3),
    ("F", "F in kN", 1e-3),
)
"""Panels: state, label, factor from SI."""


def paper_figures(cases: Cases) -> tuple[LinePlot, ...]:
    """Return the two time-optimal controls, free and under the bound on the tower's rate."""
    caption = "time-optimal solution, F_max = 2 kN"
    free = _plot(cases.plant, cases.time, 4, f"Fig. 4: {caption}", (_switching(cases),))
    bounded = f"Fig. 5: {caption}, |v_φ| ≤ 0.005 rad/s"
    return free, _plot(cases.plant, cases.bounded, 5, bounded, ())


def _plot(
    plant: Plant, solution: TimeOptimum, number: int, caption: str, more: tuple[Panel, ...]
) -> LinePlot:
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / SAMPLES)
    borders = {
        "v_s": (Border(label="target", y=1e3 * VELOCITY_STEP),),
        "v_phi": tuple(Border(label="c", y=side * 1e3 * RATE_BOUND) for side in (1.0, -1.0)),
    }
    force = Panel(
        y_label="F_set in kN",
        lines=(_line(motion.t, motion.force / 1e3, is_stepped=True),),
        borders=tuple(Border(label="F_max", y=side * FORCE_LIMIT / 1e3) for side in (1.0, -1.0)),
    )
    states = (
        Panel(
            y_label=label,
            lines=(_line(motion.t, factor * motion.states[:, plant.states.index(name)]),),
            borders=borders.get(name, ()),
        )
        for name, label, factor in STATES
    )
    return LinePlot(
        key=f"figure-{number}",
        caption=caption,
        alt=f"Set force and states over time up to t_f = {1e3 * solution.t_f:.3f} ms; "
        f"{len(solution.arcs)} arcs.",
        x_label="t in ms",
        x_is_log=False,
        link=f"figure-{number}",
        panels=(force, *states, *more),
    )


def _line(t: np.ndarray, y: np.ndarray, *, is_stepped: bool = False) -> Line:
    return Line(label="optimal", x=1e3 * t, y=y, style=SOLID, is_stepped=is_stepped)


def _switching(cases: Cases) -> Panel:
    """Return λ_F over its magnitude at t = 0, the switching function of Fig. 4 (d).

    Followed backwards from t_f, where errors decay, with H = 0 there.
    """
    plant, solution = cases.plant, cases.time
    initial = solution.certificate.adjoint_initial
    row = initial @ expm(-plant.A * solution.t_f)
    row[plant.force] = -plant.force_lag / float(solution.arcs[-1].output[0])
    transition, values = expm(plant.A * (solution.t_f / SAMPLES)), []
    for _ in range(SAMPLES + 1):
        values.append(row[plant.force] / abs(float(initial[plant.force])))
        row = row @ transition
    t = np.linspace(0.0, solution.t_f, SAMPLES + 1)
    return Panel(
        y_label="λ_F / |λ_F(0)|",
        lines=(_line(t, np.array(values[::-1])),),
        borders=(Border(label="0", y=0.0),),
    )
