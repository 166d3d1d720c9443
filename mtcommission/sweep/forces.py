"""A piece of work -> its rows: cases that differ in F_max alone are solved as one curve."""

from __future__ import annotations

from math import isfinite

import numpy as np
from threadpoolctl import threadpool_limits

from mtcommission.errors import MtcommissionError
from mtcommission.machine.machine import Machine, Positioning
from mtcommission.optimal.free.curve import solve_curve
from mtcommission.optimal.free.moments import moment_problem
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.cases import (
    FORCE_KEY,
    PEAKS_KEY,
    Quantity,
    Settings,
    si_number,
    unit_of,
    vary_profile,
)
from mtcommission.sweep.peaks import curve_peaks
from mtcommission.sweep.pieces import FEWEST
from mtcommission.sweep.rows import Answer, Work, done, proof_cells, solve_case, switch_cells


def solve_piece(work: Work) -> tuple[Answer, ...]:
    """Return the rows of a piece, in the order of its cases.

    In one thread, whatever the process allows: matrices have some ten rows, so that threads cost
    more than they give, and the order of summation would change with their number.

    Parameters
    ----------
    work
        Cases that are computed together.

    Returns
    -------
    tuple of Answer
    """
    with threadpool_limits(limits=1, user_api="blas"):
        return _solve(work)


def _solve(work: Work) -> tuple[Answer, ...]:
    answers: dict[int, Answer] = {}
    keys = [key for settings in work.settings[:1] for key, _ in settings]
    bounded = bool(work.base.bounds) or any(key.startswith(PEAKS_KEY) for key in keys)
    if work.base.quantity is Quantity.OPTIMAL and not bounded:
        groups: dict[Settings, list[int]] = {}
        for number, settings in enumerate(work.settings):
            groups.setdefault(_without_force(settings), []).append(number)
        for members in groups.values():
            if len(members) >= FEWEST:
                answers |= _solve_group(work, members)
    return tuple(
        answers.get(number) or solve_case(work, number) for number in range(len(work.settings))
    )


def _without_force(settings: Settings) -> Settings:
    # The unit stays: a force in kilograms must meet the reader, not the curve.
    return tuple((key, unit_of(text) if key == FORCE_KEY else text) for key, text in settings)


def _solve_group(work: Work, members: list[int]) -> dict[int, Answer]:
    """Return the rows that the curve proves; what is missing is solved case by case."""
    texts = [dict(work.settings[number]).get(FORCE_KEY, "") for number in members]
    forces = np.array([si_number(text) for text in texts])
    if not np.all(np.isfinite(forces)):
        return {}
    try:
        # What a profile allows of F_max is an interval, so its ends speak for all between.
        machine = _machine(work, members[int(np.argmin(forces))])
        _machine(work, members[int(np.argmax(forces))])
        if not 1 <= work.base.move <= len(machine.moves):
            return {}
        move = machine.moves[work.base.move - 1]
        if isinstance(move, Positioning) and isfinite(move.max_velocity):
            return {}
        plant = build_plant(machine)
        problem = moment_problem(plant, move)
    except MtcommissionError:
        return {}  # the reader's or the plant's message belongs to each case
    left = forces - abs(machine.drive.static_load)
    points = solve_curve(problem, problem.target / left)
    proved = [place for place, point in enumerate(points) if point.is_proved]
    peaks = curve_peaks(plant, [points[place] for place in proved], left[proved])
    found = {}
    for place, row in zip(proved, peaks.tolist(), strict=True):
        point = points[place]
        cells = (
            *proof_cells(point.t_f, point.lower_bound),
            *switch_cells(point.switching_times.tolist()),
            *row,
        )
        found[members[place]] = done(work, members[place], cells)
    return found


def _machine(work: Work, number: int) -> Machine:
    text = vary_profile(work.base.profile_text, work.settings[number], where=work.base.where)
    return parse_profile(text, where=work.base.where)
