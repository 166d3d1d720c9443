"""Limits and whole runs of one case; apart from the rest: the loop's modules load slowly."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256

import numpy as np

from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import Candidate, MoveResult
from mtcommission.limits.optima import Optima, find_optima
from mtcommission.machine.machine import Machine
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.study.loops import settle_on_loop
from mtcommission.sweep.rows import Row, peak_signals, proof_cells


def choose_case(machine: Machine) -> Row:
    """Return the result columns of ``limits``: the steps of ``commission`` up to the choice."""
    plant = build_plant(machine)
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    loop = settle_on_loop(machine)
    choice = loop.choice or choose_limits(machine, plant, loop.tuned)
    return _cells(plant, optima, choice.moves, choice.candidate, choice.bound_by)


def run_case(machine: Machine, *, text: str, name: str, created: str) -> tuple[Row, str]:
    """Return the result columns of a whole commissioning, and its ``record.json`` as text."""
    # The record needs python-control, which limits do without.
    from mtcommission.commission import commission
    from mtcommission.machine.plausibility import check_plausibility
    from mtcommission.record.files import dump_json
    from mtcommission.record.identified import read_evidence
    from mtcommission.record.machine import Profile
    from mtcommission.record.record import build_record

    found = commission(machine)
    record = build_record(
        found,
        profile=Profile(name=name, sha256=sha256(text.encode()).hexdigest(), text=text),
        created=created,
        warnings=check_plausibility(machine),
        identified=read_evidence(machine, None),
    )
    cells = _cells(found.plant, found.optima, found.moves, found.recommended, found.choice.bound_by)
    return cells, dump_json(record)


def _cells(
    plant: Plant,
    optima: Sequence[Optima],
    moves: Sequence[MoveResult],
    candidate: Candidate,
    bound_by: Message,
) -> Row:
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
