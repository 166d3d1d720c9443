"""A piece of work -> its rows, whatever happens to its cases.

A case that fails is a row with its named outcome; nothing here stops a sweep.
"""

from __future__ import annotations

from threadpoolctl import threadpool_limits

from mtcommission.errors import ComputationError, InputError
from mtcommission.machine.machine import Machine
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.cases import (
    FORCE_KEY,
    PEAKS_KEY,
    Quantity,
    Settings,
    unit_of,
    vary_profile,
)
from mtcommission.sweep.forces import solve_forces
from mtcommission.sweep.pieces import FEWEST
from mtcommission.sweep.rows import Answer, Work, done, failed

WRONG_INPUT = "wrong_input"
INTERNAL = "internal_error"


def solve_piece(work: Work) -> tuple[Answer, ...]:
    """Return the rows of a piece, in the order of its cases.

    In one thread, whatever the process allows: matrices have some ten rows, so that threads cost
    more than they give, and the order of summation would change with their number.

    Parameters
    ----------
    work
        Cases that are computed together.
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
                answers |= solve_forces(work, members)
    return tuple(
        answers.get(number) or solve_case(work, number) for number in range(len(work.settings))
    )


def _without_force(settings: Settings) -> Settings:
    # The unit stays: a force in kilograms must meet the reader, not the curve.
    return tuple((key, unit_of(text) if key == FORCE_KEY else text) for key, text in settings)


def solve_case(work: Work, number: int) -> Answer:
    """Return the row of one case, whatever happens to it.

    Parameters
    ----------
    work
        The piece that the case belongs to.
    number
        Its place there.
    """
    settings = work.settings[number]
    try:
        text = vary_profile(work.base.profile_text, settings, where=work.base.where)
        machine = parse_profile(text, where=work.base.where)
        return _compute(work, number, text, machine)
    except InputError as error:
        return failed(work, number, WRONG_INPUT, str(error))
    except ComputationError as error:
        return failed(work, number, error.outcome.name.lower(), str(error))
    except Exception as error:  # one case must not take the others with it
        return failed(work, number, INTERNAL, f"please report it with the profile: {error!r}")


def _compute(work: Work, number: int, text: str, machine: Machine) -> Answer:
    # What each of them needs takes up to seconds to load.
    base = work.base
    if base.quantity is Quantity.OPTIMAL:
        from mtcommission.sweep.single import solve_single

        return done(work, number, solve_single(machine, base, work.settings[number]))
    if base.quantity is Quantity.LIMITS:
        from mtcommission.sweep.chain import choose_case

        return done(work, number, choose_case(machine))
    from mtcommission.sweep.whole_run import run_case

    name = f"case-{work.first + number:06d}.json"
    found = run_case(machine, text=text, name=base.where, created=base.created)
    return done(work, number, (*found.cells, f"records/{name}"), record=found.record)
