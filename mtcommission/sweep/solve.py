"""A piece of work -> its answers, whatever happens to its cases.

A case that fails is an answer with its named outcome; nothing here stops a sweep. What a quantity
needs is loaded where it is computed, since it takes up to seconds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from mtcommission.base.errors import ComputationError, InputError, MtcommissionError
from mtcommission.base.messages.catalogue import NAME, Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine, Motion, require_force
from mtcommission.machine.plant.plant import Plant, build_plant, driven_at_once
from mtcommission.machine.profile.describe import unit_of_key
from mtcommission.machine.profile.read import parse_profile, read_key
from mtcommission.optimal.free import GAP_TOLERANCE, solve_forces
from mtcommission.sweep.plan import (
    FORCE_KEY,
    PEAKS_KEY,
    Plan,
    Quantity,
    Settings,
    piece_size,
    si_number,
    unit_of,
    vary_profile,
)

if TYPE_CHECKING:
    from mtcommission.limits.choose import Choice
    from mtcommission.limits.judge import Candidate
    from mtcommission.limits.optima import Optima

DONE = "done"
FEWEST = 3
"""Cases that differ in F_max alone and are worth a curve."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """Cases that are computed together, with all that this needs; goes to another process."""

    piece: int
    first: int  # number of the first case
    settings: tuple[Settings, ...]  # of each case
    base: Plan  # without its axes


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What was computed for a case: the result columns, or why there are none."""

    cells: tuple[Cell, ...] = ()
    outcome: str = DONE
    message: str = ""
    record: str = ""  # ``record.json`` of a run, as text


def cut_work(plan: Plan, numbers: Iterable[int]) -> Iterator[Work]:
    """Yield pieces of a plan, by number from 0, with all that they need."""
    base, size = replace(plan, axes=()), piece_size(plan)
    for piece in numbers:
        cases = range(piece * size, min((piece + 1) * size, plan.count))
        settings = tuple(plan.settings(index) for index in cases)
        yield Work(piece=piece, first=cases.start, settings=settings, base=base)


def place_of_record(case: int) -> str:
    """Return where the record of a whole run stands in the folder of a sweep."""
    return f"records/case-{case:06d}.json"


def solve_piece(work: Work) -> tuple[Answer, ...]:
    """Return the answers of a piece, in the order of its cases.

    In one thread, whatever the process allows: matrices have some ten rows, so that threads cost
    more than they give, and the order of summation would change with their number.
    """
    with threadpool_limits(limits=1, user_api="blas"):
        found: dict[int, Answer] = {}
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
    base, record = work.base, ""
    try:
        text = vary_profile(base.profile_text, work.settings[number], where=base.where)
        machine = parse_profile(text, where=base.where)
        require_force(machine)
        plant = build_plant(machine)
        found: Optimum
        if base.quantity is Quantity.OPTIMAL:
            found = _solve_optimal(work, machine, plant, work.settings[number])
        elif base.quantity is Quantity.LIMITS:
            found = _choose(machine, plant)
        else:
            found, record = _run(machine, text, base, place_of_record(work.first + number))
        return Answer(cells=_cells(base, machine, plant, found), record=record)
    except InputError as error:
        return Answer(outcome="wrong_input", message=str(error))
    except ComputationError as error:
        return Answer(outcome=error.outcome.name.lower(), message=str(error))
    except Exception as error:  # one case must not take the others with it
        return Answer(
            outcome="internal_error", message=f"please report it with the profile: {error!r}"
        )


def _cells(base: Plan, machine: Machine, plant: Plant, found: Optimum) -> tuple[Cell, ...]:
    return tuple(one.of(found) for one in result_columns(base.quantity, machine, plant) if one.of)


def _solve_optimal(work: Work, machine: Machine, plant: Plant, settings: Settings) -> Optimum:
    """One time-optimal control; bounds on peaks that vary are kept, too."""
    from mtcommission.limits.optima import find_time_optimum

    varied = {key.removeprefix(PEAKS_KEY) for key, _ in settings if key.startswith(PEAKS_KEY)}
    peaks = [peak for peak in machine.requirements.peaks if peak.name in varied]
    optimum = find_time_optimum(
        plant,
        machine.moves[work.base.move - 1],
        force_limit=machine.drive.motion_force,
        bounds=(*work.base.bounds, *peaks),
    )
    return Optimum(
        t_f=optimum.t_f,
        lower_bound=optimum.certificate.t_f_lower_bound,
        peaks=optimum.peaks,
        switching_times=optimum.switching_times,
    )


def _choose(machine: Machine, plant: Plant) -> Chosen:
    from mtcommission.commission.recommend import recommend
    from mtcommission.limits.optima import find_optima

    optima = [find_optima(machine, plant, move) for move in machine.moves]
    return _chosen(optima, recommend(machine).choice)


def _run(machine: Machine, text: str, base: Plan, place: str) -> tuple[Chosen, str]:
    """A whole commissioning, and its ``record.json`` as text."""
    from mtcommission.commission.commission import commission
    from mtcommission.machine.checks import check_plausibility
    from mtcommission.record.identified import read_evidence
    from mtcommission.record.machine import Profile
    from mtcommission.record.record import build_record
    from mtcommission.record.shape import dump_json

    found = commission(machine)
    record = build_record(
        found,
        profile=Profile(name=base.where, sha256=sha256(text.encode()).hexdigest(), text=text),
        created=base.created,
        warnings=check_plausibility(machine),
        identified=read_evidence(machine, None),
    )
    return replace(_chosen(found.optima, found.choice), record=place), dump_json(record)


def _chosen(optima: Sequence[Optima], choice: Choice) -> Chosen:
    slowest = max((item.time for item in optima), key=lambda time: time.t_f)
    responses = [response for move in choice.moves for response in move.responses]
    return Chosen(
        t_f=slowest.t_f,
        lower_bound=slowest.certificate.t_f_lower_bound,
        peaks=np.max([response.peaks for response in responses], axis=0),
        judged=choice.candidate,
        bound_by=choice.bound_by,
        max_force=max(response.max_force for response in responses),
    )


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
        plant = build_plant(machine)
    except MtcommissionError:
        return {}  # the reader's or the plant's message belongs to each case
    move = machine.moves[work.base.move - 1]
    left = forces - (machine.drive.max_force - machine.drive.motion_force)
    found: dict[int, Answer] = {}
    order = np.argsort(left)
    moved = driven_at_once(plant)
    for place, solved in zip(order.tolist(), solve_forces(moved, move, left[order]), strict=True):
        if solved is None:
            continue
        motion, lower_bound = solved
        peaks = motion.peaks
        if plant.follows:
            peaks = np.insert(peaks, plant.force, left[place])
        optimum = Optimum(
            t_f=motion.t_f,
            lower_bound=lower_bound,
            peaks=peaks,
            switching_times=motion.switching_times.tolist(),
        )
        found[members[place]] = Answer(cells=_cells(work.base, machine, plant, optimum))
    return found


def _machine(work: Work, number: int) -> Machine:
    text = vary_profile(work.base.profile_text, work.settings[number], where=work.base.where)
    return parse_profile(text, where=work.base.where)


# The columns of a table: each declared once, with its unit and where its cells come from


PEAK = "peak_"
"""What columns of the peaks of signals begin with."""

Cell = float | int | str | bool | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Optimum:
    """What was computed for a case of ``optimal``."""

    t_f: float  # [s]
    lower_bound: float  # which no control beats [s]
    peaks: NDArray[np.float64]  # of each of the plant's signals
    switching_times: Sequence[float] = ()  # [s]

    @property
    def gap(self) -> float:
        """By how much the time may be above the least [-]."""
        return (self.t_f - self.lower_bound) / self.t_f


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chosen(Optimum):
    """What was computed for a case of ``limits`` or ``run``; the optimum is of the slowest move."""

    judged: Candidate  # the recommended limits
    bound_by: Message
    max_force: float  # set force [N]
    record: str = ""  # where the record of a whole run is


@dataclass(frozen=True, slots=True)
class Column:
    """One column of the table: named as in the record, or by the dotted key of what varies."""

    name: str
    unit: str = ""  # SI
    kind: str = "float"  # or "int", "bool", "str"
    of: Callable[[Any], Cell] | None = None  # its cell, from a ``Found``; None: it is no result
    varies: bool = False

    @property
    def meaning(self) -> Message:
        """What it holds."""
        if self.varies:
            return Message("sweep-column-key")
        if self.name.startswith(PEAK) and self.name != "peak_deviation":
            signal = Message(NAME, key=self.name.removeprefix(PEAK))
            return Message("sweep-column-peak", name=signal)
        return Message(f"sweep-column-{self.name.replace('_', '-')}")


def columns(plan: Plan) -> tuple[Column, ...]:
    """Return the columns of a plan's table; raise InputError if its profile cannot be read."""
    machine = parse_profile(plan.profile_text, where=plan.where)
    plant, varied = build_plant(machine), []
    for axis in plan.axes:
        for key, texts in zip(axis.keys, zip(*axis.rows, strict=True), strict=True):
            has_words = any(isnan(si_number(text)) for text in texts)
            unit, kind = _unit_of_key(key, machine, plant), "str" if has_words else "float"
            varied.append(Column(key, "" if has_words else unit, kind, varies=True))
    return (
        Column("case", kind="int"),
        *varied,
        *result_columns(plan.quantity, machine, plant),
        Column("outcome", kind="str"),
        Column("message", kind="str"),
    )


def result_columns(quantity: Quantity, machine: Machine, plant: Plant) -> tuple[Column, ...]:
    """Return the columns that a quantity fills."""
    length = machine.axis_units.length.si
    force = "N m" if machine.motion is Motion.ROTARY else "N"
    rates = (plant.states[mode.rate] for mode in plant.modes)
    peaks = [_peak(plant, name) for name in (*rates, "tcp_vibration", plant.states[plant.force])]
    proof = (
        Column("t_f", "s", of=lambda found: found.t_f),
        Column("t_f_lower_bound", "s", of=lambda found: found.lower_bound),
        Column("relative_gap", of=lambda found: found.gap),
        Column("certified", kind="bool", of=lambda found: found.gap <= GAP_TOLERANCE),
    )
    if quantity is Quantity.OPTIMAL:
        return (
            *proof,
            Column("switches", kind="int", of=lambda found: len(found.switching_times)),
            Column("switching_times", "s", "str", of=lambda found: _join(found.switching_times)),
            *peaks,
        )
    chosen = (
        *proof,
        Column("acceleration", f"{length}/s^2", of=lambda found: found.judged.limits.acceleration),
        Column("jerk", f"{length}/s^3", of=lambda found: found.judged.limits.jerk),
        Column("jerk_time", "s", of=lambda found: found.judged.limits.jerk_time),
        Column("settling_time", "s", of=lambda found: found.judged.settling_time),
        Column("residual_deviation", length, of=lambda found: found.judged.residual_deviation),
        Column("peak_deviation", length, of=lambda found: found.judged.peak_deviation),
        *peaks,
        Column("peak_F_set", force, of=lambda found: found.max_force),
        Column("requirements_met", kind="bool", of=lambda found: found.judged.assessment.is_met),
        Column("bound_by", kind="str", of=lambda found: Catalogue().say(found.bound_by)),
        Column("obstacle", kind="str", of=_obstacle),
    )
    record = Column("record", kind="str", of=lambda found: found.record)
    return (*chosen, record) if quantity is Quantity.RUN else chosen


def _peak(plant: Plant, signal: str) -> Column:
    place = plant.signals.index(signal)
    return Column(PEAK + signal, plant.unit(signal), of=lambda found: float(found.peaks[place]))


def _obstacle(found: Chosen) -> str:
    """The requirement that stands in the way; "": none."""
    limiting = found.judged.assessment.limiting_requirement
    return limiting.key if limiting else ""


def _join(times: Sequence[float]) -> str:
    return " ".join(f"{time:.12g}" for time in times)


def _unit_of_key(key: str, machine: Machine, plant: Plant) -> str:
    """SI unit of a key of the profile; "SI" where nothing tells."""
    name = key.removeprefix(PEAKS_KEY)
    if name != key and name in plant.signals:
        return plant.unit(name)
    rotary = machine.motion is Motion.ROTARY
    unit = unit_of_key(read_key(key).split("."), rotary=rotary)
    return "SI" if unit is None else unit
