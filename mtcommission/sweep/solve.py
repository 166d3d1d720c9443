"""A piece of work -> its answers, whatever happens to its cases.

A case that fails is an answer with its named outcome; nothing here stops a sweep.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from mtcommission.errors import ComputationError, InputError, MtcommissionError
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Positioning
from mtcommission.machine.rigid_body import require_force
from mtcommission.optimal.free.time_optimal import solve_forces
from mtcommission.optimal.solution import Bound
from mtcommission.plant.plant import Plant, build_plant, driven_at_once
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.plan import (
    FEWEST,
    FORCE_KEY,
    PEAKS_KEY,
    Quantity,
    Settings,
    si_number,
    unit_of,
    vary_profile,
)
from mtcommission.sweep.rows import Answer, Row, Work, peak_signals, proof_cells, switch_cells

Array = NDArray[np.float64]

WRONG_INPUT = "wrong_input"
INTERNAL = "internal_error"


def solve_piece(work: Work) -> tuple[Answer, ...]:
    """Return the answers of a piece, in the order of its cases.

    In one thread, whatever the process allows: matrices have some ten rows, so that threads cost
    more than they give, and the order of summation would change with their number.
    """
    with threadpool_limits(limits=1, user_api="blas"):
        found: dict[int, Answer] = {}
        keys = [key for settings in work.settings[:1] for key, _ in settings]
        bounded = bool(work.base.bounds) or any(key.startswith(PEAKS_KEY) for key in keys)
        if work.base.quantity is Quantity.OPTIMAL and not bounded:
            groups: dict[Settings, list[int]] = {}
            for number, settings in enumerate(work.settings):
                groups.setdefault(_without_force(settings), []).append(number)
            for members in groups.values():
                if len(members) >= FEWEST:
                    found |= _solve_forces(work, members)
        numbers = range(len(work.settings))
        return tuple(found.get(number) or solve_case(work, number) for number in numbers)


def _without_force(settings: Settings) -> Settings:
    # The unit stays: a force in kilograms must meet the reader.
    return tuple((key, unit_of(text) if key == FORCE_KEY else text) for key, text in settings)


def solve_case(work: Work, number: int) -> Answer:
    """Return the answer of one case of a piece, whatever happens to it."""
    try:
        return _compute(work, number)
    except InputError as error:
        return Answer(outcome=WRONG_INPUT, message=str(error))
    except ComputationError as error:
        return Answer(outcome=error.outcome.name.lower(), message=str(error))
    except Exception as error:  # one case must not take the others with it
        return Answer(outcome=INTERNAL, message=f"please report it with the profile: {error!r}")


def _compute(work: Work, number: int) -> Answer:
    # What each of them needs takes up to seconds to load.
    base, settings = work.base, work.settings[number]
    text = vary_profile(base.profile_text, settings, where=base.where)
    machine = parse_profile(text, where=base.where)
    require_force(machine)
    if base.quantity is Quantity.OPTIMAL:
        return Answer(cells=_solve_optimal(work, machine, settings))
    if base.quantity is Quantity.LIMITS:
        from mtcommission.sweep.chain import choose_case

        return Answer(cells=choose_case(machine))
    from mtcommission.sweep.chain import run_case

    cells, record = run_case(machine, text=text, name=base.where, created=base.created)
    place = f"records/case-{work.first + number:06d}.json"
    return Answer(cells=(*cells, place), record=record)


def _solve_optimal(work: Work, machine: Machine, settings: Settings) -> Row:
    """One time-optimal control; bounds on peaks that vary are kept, too."""
    from mtcommission.limits.optima import find_time_optimum

    if work.base.move > len(machine.moves):
        raise IndexError(f"move {work.base.move} of {len(machine.moves)}")
    varied = {key.removeprefix(PEAKS_KEY) for key, _ in settings if key.startswith(PEAKS_KEY)}
    peaks = [peak for peak in machine.requirements.peaks if peak.name in varied]
    plant = build_plant(machine)
    optimum = find_time_optimum(
        plant,
        machine.moves[work.base.move - 1],
        force_limit=machine.drive.motion_force,
        bounds=(*work.base.bounds, *(Bound(name=item.name, value=item.bound) for item in peaks)),
    )
    return _optimal_cells(
        plant,
        optimum.peaks,
        proof_cells(optimum.t_f, optimum.certificate.t_f_lower_bound),
        optimum.switching_times,
    )


def _optimal_cells(plant: Plant, peaks: Array, proof: Row, switching_times: Sequence[float]) -> Row:
    found = dict(zip(plant.signals, peaks.tolist(), strict=True))
    return (*proof, *switch_cells(switching_times), *(found[name] for name in peak_signals(plant)))


def _solve_forces(work: Work, members: Sequence[int]) -> dict[int, Answer]:
    """The answers of cases that differ in F_max alone, by place, each found from the one before."""
    texts = [dict(work.settings[number]).get(FORCE_KEY, "") for number in members]
    forces = np.array([si_number(text) for text in texts])
    if not np.all(np.isfinite(forces)):
        return {}
    try:
        # What a profile allows of F_max is an interval, so its ends speak for all between.
        machine = _machine(work, members[int(np.argmin(forces))])
        _machine(work, members[int(np.argmax(forces))])
        if work.base.move > len(machine.moves):
            return {}
        move = machine.moves[work.base.move - 1]
        if isinstance(move, Positioning) and isfinite(move.max_velocity):
            return {}
        plant = build_plant(machine)
    except MtcommissionError:
        return {}  # the reader's or the plant's message belongs to each case
    moved = driven_at_once(plant)
    left = forces - (machine.drive.max_force - machine.drive.motion_force)
    found: dict[int, Answer] = {}
    order = np.argsort(left)
    for place, solved in zip(order.tolist(), solve_forces(moved, move, left[order]), strict=True):
        if solved is None:
            continue
        motion, lower_bound = solved
        peaks = motion.peaks
        if plant.follows:
            peaks = np.insert(peaks, plant.force, left[place])
        proof = proof_cells(motion.t_f, lower_bound)
        cells = _optimal_cells(plant, peaks, proof, motion.switching_times.tolist())
        found[members[place]] = Answer(cells=cells)
    return found


def _machine(work: Work, number: int) -> Machine:
    text = vary_profile(work.base.profile_text, work.settings[number], where=work.base.where)
    return parse_profile(text, where=work.base.where)
