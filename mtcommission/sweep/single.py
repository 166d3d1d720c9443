"""One time-optimal control; apart from the rest: the bounded ones' modules load slowly."""

from __future__ import annotations

from mtcommission.limits.optima import find_time_optimum
from mtcommission.machine.machine import Machine
from mtcommission.machine.rigid_body import require_force
from mtcommission.optimal.solution import Bound
from mtcommission.plant.plant import build_plant
from mtcommission.sweep.cases import PEAKS_KEY, Plan, Settings
from mtcommission.sweep.rows import peak_signals, proof_cells, switch_cells
from mtcommission.sweep.store import Cell


def solve_single(machine: Machine, base: Plan, settings: Settings) -> tuple[Cell, ...]:
    """Return the result columns of ``optimal``.

    Parameters
    ----------
    machine
        Of the case.
    base
        Its move and bounds count.
    settings
        What varies; bounds on peaks among it are kept, too.

    Returns
    -------
    tuple
        As ``result_columns``.

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    require_force(machine)
    if not 1 <= base.move <= len(machine.moves):
        raise IndexError(f"move {base.move} of {len(machine.moves)}")
    plant = build_plant(machine)
    optimum = find_time_optimum(
        plant,
        machine.moves[base.move - 1],
        force_limit=machine.drive.motion_force,
        bounds=(*base.bounds, *_varied_bounds(machine, settings)),
    )
    peaks = dict(zip(plant.signals, optimum.peaks.tolist(), strict=True))
    return (
        *proof_cells(optimum.t_f, optimum.certificate.t_f_lower_bound),
        *switch_cells(optimum.switching_times),
        *(peaks[name] for name in peak_signals(plant)),
    )


def _varied_bounds(machine: Machine, settings: Settings) -> tuple[Bound, ...]:
    """The bounds on peaks that vary: an optimal control keeps those, too."""
    varied = {key.removeprefix(PEAKS_KEY) for key, _ in settings if key.startswith(PEAKS_KEY)}
    peaks = machine.requirements.peaks
    return tuple(Bound(name=peak.name, value=peak.bound) for peak in peaks if peak.name in varied)
