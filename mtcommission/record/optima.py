"""An optimal control -> its entry in the record, and sampled motions for the plots."""

from __future__ import annotations

from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.solution import (
    Certificate,
    DampingOptimum,
    TimeOptimum,
    control_text,
    sample_trajectory,
    side_text,
)
from mtcommission.plant.plant import Plant
from mtcommission.record.data import describe_move
from mtcommission.record.schema import ArcEntry, CertificateEntry, OptimumEntry, Series

Array = NDArray[np.float64]

PLOT_SAMPLES = 800
"""Samples of an optimal control for its plot."""


def optimum_entry(plant: Plant, solution: TimeOptimum | DampingOptimum) -> OptimumEntry:
    """Return an optimal control as ``optimal --json`` prints it.

    Parameters
    ----------
    plant
        The plant it was computed for.
    solution
        Time-optimal or damping-optimal.

    Returns
    -------
    OptimumEntry
    """
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / PLOT_SAMPLES)
    entry = OptimumEntry(
        kind="time",
        method=solution.method,
        f_max=solution.force_limit,
        move=describe_move(solution.move),
        limits={bound.name: bound.value for bound in solution.bounds},
        t_f=solution.t_f,
        arcs=[
            ArcEntry(t_start=arc.t_start, t_end=arc.t_end, control=control_text(arc.control))
            for arc in solution.arcs
        ],
        switching_times=[arc.t_end for arc in solution.arcs[:-1]],
        touch_points=[],
        peaks=dict(zip(plant.signals, solution.peaks.tolist(), strict=True)),
        terminal_error=dict(zip(plant.states, solution.terminal_error.tolist(), strict=True)),
        cost=None,
        cost_terms={},
        weights={},
        certificate={},
        series=series_entry(plant, motion.t, motion.states, {"F_set": motion.force}),
    )
    if isinstance(solution, TimeOptimum):
        entry["touch_points"] = [
            {"t": p.t, "limit": side_text(p.signal, p.side)} for p in solution.touch_points
        ]
        entry["certificate"] = _certificate(plant, solution.certificate)
        return entry
    names = ("F_set", *(item.state for item in solution.weights))
    entry["kind"] = "damping"
    entry["cost"] = solution.cost
    entry["cost_terms"] = dict(zip(names, solution.cost_terms.tolist(), strict=True))
    entry["weights"] = {item.state: item.value for item in solution.weights}
    entry["certificate"] = _law(plant, solution)
    return entry


def _certificate(plant: Plant, proof: Certificate) -> CertificateEntry:
    return {
        "t_f_lower_bound": proof.t_f_lower_bound,
        "relative_gap": proof.relative_gap,
        "adjoint_initial": {
            state: value
            for state, value in zip(plant.states, proof.adjoint_initial.tolist(), strict=True)
            if isfinite(value)
        },
        "switching_slopes": proof.switching_slopes.tolist(),
        "switching_law_holds": proof.switching_law_holds,
        "terminal_jacobian_rank": (
            proof.terminal_jacobian_rank if proof.terminal_jacobian_rank >= 0 else None
        ),
        "terminal_jacobian_condition": finite_or_none(proof.terminal_jacobian_condition),
    }


def _law(plant: Plant, solution: DampingOptimum) -> CertificateEntry:
    adjoint = dict(zip(plant.states, solution.adjoint_initial.tolist(), strict=True))
    return {"adjoint_initial": adjoint, "law_residual": solution.law_residual}


def series_entry(plant: Plant, t: Array, states: Array, extra: dict[str, Array]) -> Series:
    """Return signals rounded to seven digits: for plots only, and a third of the bytes.

    Parameters
    ----------
    plant
        Nominal.
    t, states
        Shapes (n_samples,) [s] and (n_samples, n_states) [SI].
    extra
        Further signals by name, each of shape (n_samples,) [SI].

    Returns
    -------
    Series
        The extra signals, the states and the outputs.
    """
    columns = dict(zip(plant.states, states.T, strict=True))
    columns |= dict(zip(plant.outputs, (states @ plant.C.T).T, strict=True))
    return Series(
        t=[float(f"{value:.7g}") for value in t],
        signals={
            name: [float(f"{value:.7g}") for value in column]
            for name, column in {**extra, **columns}.items()
        },
    )


def finite_or_none(value: float) -> float | None:
    """Return the number, or None for an infinite one or a nan."""
    return float(value) if isfinite(value) else None
