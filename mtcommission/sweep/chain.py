"""Limits and whole runs of one case; apart from the rest: the loop's libraries load slowly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256

import numpy as np

from mtcommission.choose import choose_limits
from mtcommission.commission import commission
from mtcommission.loop_choice import Settings, settle_on_loop
from mtcommission.machine import Machine
from mtcommission.optima import Optima, condense_optima, find_optima
from mtcommission.plant import Plant, build_plant
from mtcommission.plausibility import check_plausibility
from mtcommission.record.build import build_record
from mtcommission.record.files import dump_json
from mtcommission.record.schema import Profile
from mtcommission.sweep.rows import peak_signals, proof_cells
from mtcommission.sweep.store import Cell
from mtcommission.trials import MoveResult, Trial, judge, run_moves


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseRun:
    """A whole commissioning of one case.

    Parameters
    ----------
    cells
        Result columns.
    record
        ``record.json`` as text.
    """

    cells: tuple[Cell, ...]
    record: str


def choose_case(machine: Machine) -> tuple[Cell, ...]:
    """Return the result columns of ``limits``: the steps of ``commission`` up to the choice.

    Parameters
    ----------
    machine
        Of the case.

    Returns
    -------
    tuple
        As ``result_columns``.

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    settings = Settings()
    plant = build_plant(machine)
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    tuned = settle_on_loop(machine, plant, settings).tuned
    starts = [limits for _, limits in condense_optima(plant, optima)]
    choice = choose_limits(machine, plant, tuned, starts=starts, settings=settings.search)
    moves = run_moves(machine, tuned, choice.limits)
    trial = judge(machine, plant, tuned, "recommended", "this search", choice.limits)
    return _cells(plant, optima, moves, trial, choice.bound_by)


def run_case(machine: Machine, *, text: str, name: str, created: str) -> CaseRun:
    """Return the whole commissioning of a case.

    Parameters
    ----------
    machine
        Of the case.
    text, name
        Its profile.
    created
        Date for the record.

    Returns
    -------
    CaseRun

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    found = commission(machine)
    warnings = [f"{remark.key}: {remark.message}" for remark in check_plausibility(machine)]
    profile = Profile(name=name, sha256=sha256(text.encode()).hexdigest(), text=text)
    record = build_record(found, profile=profile, created=created, warnings=warnings)
    cells = _cells(found.plant, found.optima, found.moves, found.recommended, found.choice.bound_by)
    return CaseRun(cells=cells, record=dump_json(record))


def _cells(
    plant: Plant,
    optima: Sequence[Optima],
    moves: Sequence[MoveResult],
    trial: Trial,
    bound_by: str,
) -> tuple[Cell, ...]:
    limits = trial.limits
    slowest = max((item.time for item in optima), key=lambda time: time.t_f)
    responses = [response for move in moves for response in move.responses]
    largest = np.max([response.peaks for response in responses], axis=0)
    peaks = dict(zip(plant.signals, largest.tolist(), strict=True))
    return (
        *proof_cells(slowest.t_f, slowest.certificate.t_f_lower_bound),
        limits.acceleration,
        limits.jerk,
        limits.jerk_time,
        trial.settling_time,
        trial.residual_deviation,
        trial.peak_deviation,
        *(peaks[name] for name in peak_signals(plant)),
        max(response.max_force for response in responses),
        trial.assessment.is_met,
        bound_by,
        trial.assessment.obstacle,
    )
