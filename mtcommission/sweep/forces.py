"""Cases that differ in F_max alone -> their rows, solved as one curve."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from mtcommission.errors import MtcommissionError
from mtcommission.machine.machine import Machine, Positioning
from mtcommission.optimal.free.curve import solve_curve
from mtcommission.optimal.free.moments import moment_problem
from mtcommission.plant.plant import build_plant, driven_at_once
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.cases import (
    FORCE_KEY,
    si_number,
    vary_profile,
)
from mtcommission.sweep.peaks import curve_peaks
from mtcommission.sweep.rows import Answer, Work, done, proof_cells, switch_cells


def solve_forces(work: Work, members: Sequence[int]) -> dict[int, Answer]:
    """Return the rows that the curve proves; what is missing is solved case by case.

    Parameters
    ----------
    work
        A piece for ``optimal``.
    members
        Places of its cases that differ in F_max alone.

    Returns
    -------
    dict
        Answers by place.
    """
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
        plant = driven_at_once(build_plant(machine))
        problem = moment_problem(plant, move)
    except MtcommissionError:
        return {}  # the reader's or the plant's message belongs to each case
    left = forces - (machine.drive.max_force - machine.drive.motion_force)
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
