"""Figs. 3 to 6 of the paper again, from our solutions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.optimal.solution import (
    DampingOptimum,
    Interior,
    TimeOptimum,
    Trajectory,
    sample_trajectory,
)
from mtcommission.plant.plant import Plant
from mtcommission.sheet.document import Border, Line, LinePlot, Panel
from mtcommission.validate.adjoint import follow_law
from mtcommission.validate.cases import Cases, LoopCase
from mtcommission.validate.paper import FORCE_LIMIT, RATE_BOUND

Array = NDArray[np.float64]

SAMPLES = 800
"""Points of a curve; more are not seen."""
DASHED, SOLID = 1, 4
"""Line styles of the sheet."""
SHOWN_AFTER = 1.15
"""Share of the settling time that Fig. 3 shows."""


def paper_figures(cases: Cases) -> tuple[LinePlot, ...]:
    """Return the four figures of results."""
    return (
        _feedback(cases),
        _optimum(
            cases,
            cases.time,
            key="figure-4",
            caption="Fig. 4: time-optimal solution, F_max = 2 kN",
            sigma=_free_switching(cases),
        ),
        _optimum(
            cases,
            cases.bounded,
            key="figure-5",
            caption="Fig. 5: time-optimal solution, F_max = 2 kN, |v_φ| ≤ 0.005 rad/s",
        ),
        _damping(cases),
    )


def _plot(key: str, caption: str, alt: str, panels: tuple[Panel, ...]) -> LinePlot:
    return LinePlot(
        key=key,
        caption=caption,
        alt=alt,
        x_label="t in ms",
        x_is_log=False,
        link=key,
        panels=panels,
    )


def _line(label: str, t: Array, y: Array, style: int = SOLID, *, is_stepped: bool = False) -> Line:
    return Line(label=label, x=1e3 * t, y=y, style=style, is_stepped=is_stepped)


def _force_panel(lines: tuple[Line, ...]) -> Panel:
    borders = tuple(Border(label="F_max", y=sign * FORCE_LIMIT / 1e3) for sign in (1.0, -1.0))
    return Panel(y_label="F_set in kN", lines=lines, borders=borders)


def _feedback(cases: Cases) -> LinePlot:
    names = (
        ("rectangular acceleration", cases.rectangular, DASHED),
        ("trapezoidal acceleration", cases.trapezoidal, SOLID),
    )
    plant = cases.plant
    until = SHOWN_AFTER * max(case.response.settling_time for _, case, _ in names)
    shown = [(name, case, style, _shown(case, until)) for name, case, style in names]
    tool = plant.row("tcp") @ plant.A
    force = tuple(
        _line(name, case.response.t[i], case.response.force[i] / 1e3, style, is_stepped=True)
        for name, case, style, i in shown
    )
    velocity = tuple(
        _line(name, case.response.t[i], 1e3 * (case.response.states[i] @ tool), style)
        for name, case, style, i in shown
    )
    rate = tuple(
        _line(name, case.response.t[i], 1e3 * (case.response.states[i] @ plant.row("v_phi")), style)
        for name, case, style, i in shown
    )
    return _plot(
        "figure-3",
        "Fig. 3: feedback control with rectangular (a) and trapezoidal (b) setpoints, our loop",
        "Set force, velocity of the tool and rotation rate of the tower over time. The rectangular "
        "setpoint overshoots and leaves a vibration, the trapezoidal one hardly.",
        (
            _force_panel(force),
            Panel(y_label="tool velocity in mm/s", lines=velocity, borders=(_target(),)),
            Panel(y_label="v_φ in mrad/s", lines=rate),
        ),
    )


def _shown(case: LoopCase, until: float) -> NDArray[np.intp]:
    last = int(np.searchsorted(case.response.t, until))
    return np.arange(0, last, max(1, last // SAMPLES))


def _target() -> Border:
    return Border(label="target", y=100.0)


def _optimum(
    cases: Cases, solution: TimeOptimum, *, key: str, caption: str, sigma: Panel | None = None
) -> LinePlot:
    motion = _sample(cases.plant, solution)
    panels = [_force_panel((_drawn_force(motion),)), *_state_panels(cases.plant, motion)]
    if sigma is not None:
        panels.append(sigma)
    return _plot(
        key,
        caption,
        f"Set force and states over time up to t_f = {1e3 * solution.t_f:.3f} ms; "
        f"{len(solution.arcs)} arcs.",
        tuple(panels),
    )


def _sample(plant: Plant, solution: TimeOptimum | DampingOptimum) -> Trajectory:
    return sample_trajectory(plant, solution.arcs, step=solution.t_f / SAMPLES)


def _drawn_force(motion: Trajectory) -> Line:
    return _line("optimal", motion.t, motion.force / 1e3, is_stepped=True)


def _state_panels(plant: Plant, motion: Trajectory) -> tuple[Panel, ...]:
    def panel(name: str, label: str, factor: float, borders: tuple[Border, ...] = ()) -> Panel:
        values = factor * motion.states[:, plant.states.index(name)]
        return Panel(y_label=label, lines=(_line("optimal", motion.t, values),), borders=borders)

    bounds = tuple(Border(label="c", y=sign * 1e3 * RATE_BOUND) for sign in (1.0, -1.0))
    return (
        panel("x_b", "x_b in µm", 1e6),
        panel("v_s", "v_s in mm/s", 1e3, (_target(),)),
        panel("phi", "φ in µrad", 1e6),
        panel("v_phi", "v_φ in mrad/s", 1e3, bounds),
        panel("F", "F in kN", 1e-3),
    )


def _free_switching(cases: Cases) -> Panel:
    """Return λ_F over its magnitude at t = 0, the switching function of Fig. 4 (d)."""
    plant, solution = cases.plant, cases.time
    t, values = _propagate_adjoint(plant, solution)
    share = values[:, plant.force] / abs(float(solution.certificate.adjoint_initial[plant.force]))
    return Panel(
        y_label="λ_F / |λ_F(0)|",
        lines=(_line("optimal", t, share),),
        borders=(Border(label="0", y=0.0),),
    )


def _propagate_adjoint(plant: Plant, solution: TimeOptimum) -> tuple[Array, Array]:
    """Return λ backwards from t_f, where errors decay, with H = 0 there."""
    h = solution.t_f / SAMPLES
    end = solution.certificate.adjoint_initial @ expm(-plant.A * solution.t_f)
    end[plant.force] = -plant.force_lag / float(solution.arcs[-1].output[0])
    transition, rows = expm(plant.A * h), [end]
    for _ in range(SAMPLES):
        rows.append(rows[-1] @ transition)
    return np.linspace(0.0, solution.t_f, SAMPLES + 1), np.array(rows[::-1])


def _damping(cases: Cases) -> LinePlot:
    plant, solution = cases.plant, cases.damping
    motion = _sample(plant, solution)
    law = follow_law(plant, solution, samples=SAMPLES)
    force = (
        _line("optimal", motion.t, motion.force / 1e3),
        _line("−λ_F / 2T", law.t, np.clip(law.wanted / 1e3, -4.0, 4.0), DASHED),
    )
    saturated = sum(arc.control != Interior() for arc in solution.arcs)
    return _plot(
        "figure-6",
        "Fig. 6: damping-optimal solution, F_max = 2 kN, t_f = 0.0522 s, weights (17)",
        "Set force with the law (16), and states over time; the force is continuous and saturated "
        f"on {saturated} arcs. The law is cut at 4 kN.",
        (_force_panel(force), *_state_panels(plant, motion)),
    )
