"""Limits and whole runs of one case; apart from the rest: the loop's libraries load slowly."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256

from mtcommission.choose import choose_limits
from mtcommission.commission import commission
from mtcommission.loop_choice import Settings, settle_on_loop
from mtcommission.machine import Machine
from mtcommission.optima import condense_optima, find_optima
from mtcommission.plant import build_plant
from mtcommission.plausibility import check_plausibility
from mtcommission.record.build import build_record
from mtcommission.record.files import dump_json
from mtcommission.record.schema import Profile
from mtcommission.sweep.store import Cell
from mtcommission.trials import Trial, judge


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
    trial = judge(machine, plant, tuned, "recommended", "this search", choice.limits)
    return _cells(max(item.time.t_f for item in optima), trial, choice.bound_by)


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
    t_f = max(item.time.t_f for item in found.optima)
    cells = _cells(t_f, found.recommended, found.choice.bound_by)
    return CaseRun(cells=cells, record=dump_json(record))


def _cells(t_f: float, trial: Trial, bound_by: str) -> tuple[Cell, ...]:
    limits = trial.limits
    return (
        t_f,
        limits.acceleration,
        limits.jerk,
        limits.jerk_time,
        trial.settling_time,
        trial.residual_deviation,
        trial.peak_deviation,
        trial.assessment.is_met,
        bound_by,
        trial.assessment.obstacle,
    )
