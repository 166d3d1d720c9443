"""Limits of one case; apart from the rest: the loop's modules load slowly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import Candidate, MoveResult
from mtcommission.limits.optima import Optima, find_optima
from mtcommission.machine.machine import Machine
from mtcommission.machine.rigid_body import require_force
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.study.loops import settle_on_loop
from mtcommission.sweep.rows import peak_signals, proof_cells
from mtcommission.sweep.store import Cell


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
    require_force(machine)
    plant = build_plant(machine)
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    loop = settle_on_loop(machine)
    choice = loop.choice or choose_limits(machine, plant, loop.tuned)
    return chain_cells(plant, optima, choice.moves, choice.candidate, choice.bound_by)


def chain_cells(
    plant: Plant,
    optima: Sequence[Optima],
    moves: Sequence[MoveResult],
    candidate: Candidate,
    bound_by: Message,
) -> tuple[Cell, ...]:
    """Return the result columns of ``limits`` and ``run``.

    Parameters
    ----------
    plant, optima
        Of the case.
    moves, candidate
        What the limits do, and the verdict.
    bound_by
        What the limits end at.
    """
    limits, limiting = candidate.limits, candidate.assessment.limiting_requirement
    slowest = max((item.time for item in optima), key=lambda time: time.t_f)
    responses = [response for move in moves for response in move.responses]
    largest = np.max([response.peaks for response in responses], axis=0)
    peaks: dict[str, float] = dict(zip(plant.signals, largest.tolist(), strict=True))
    return (
        *proof_cells(slowest.t_f, slowest.certificate.t_f_lower_bound),
        limits.acceleration,
        limits.jerk,
        limits.jerk_time,
        candidate.settling_time,
        candidate.residual_deviation,
        candidate.peak_deviation,
        *(peaks[name] for name in peak_signals(plant)),
        max(response.max_force for response in responses),
        candidate.assessment.is_met,
        Catalogue().say(bound_by),
        limiting.key if limiting else "",
    )
