"""What would bring more: the settling time with one thing of the machine or its control changed.

Each change gets the loop that is used, tuned again with the same ratios of Kv and Tn to Kp, and
limits chosen for it, both freely and near the recommended ones. Nothing is estimated: what cannot
be computed is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import ceil, floor, inf, log10, sqrt

from mtcommission.allowance import allow_part
from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.errors import ComputationError
from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.loop.tuning.cascade import CLASSIC, Shape
from mtcommission.loop.tuning.family import LoopFamily, cascade_family, feedback_family, tune_shape
from mtcommission.loop.tuning.force_filters import find_filters
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import Control
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message, parts_of
from mtcommission.plant.plant import build_plant
from mtcommission.requirements.rms_force import RMS_FORCE
from mtcommission.study.comparison import ROBUST, MoveComparison
from mtcommission.study.loop_choice import WITH, with_filters
from mtcommission.study.loop_trials import LoopChoice
from mtcommission.study.settings import Settings
from mtcommission.verdict.evaluate import MoveResult, evaluate

KNOWN_SPREAD = 0.02
"""Frequency spread of a machine whose modes were measured [-] (empirical)."""
PART = 0.1
"""Share by which the machine is made stiffer or lighter: what a redesign may reach."""

LONG_REST = 3600.0
"""Rest with which no move heats the motor [s]: an hour."""

REST_TRIES, REST_FACTOR = 4, 1.5
"""How often a rest that does not suffice yet is made longer, and by how much."""

ROUNDING = 1e-9

COMPUTED, BEYOND = 16.0, 9.0
"""What they may take, about that many seconds of processor time; and what of it where nothing is
left of what the recommendation was allowed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Improvement:
    """One change, and what it would bring.

    Parameters
    ----------
    change
        What is changed.
    settling_time
        Of the slowest move in the worst corner, with limits chosen for it [s]; inf: not settled.
    saved
        Less than with the recommendation [s]; negative: it takes longer.
    meets_requirements
        Whether all requirements are met then.
    outcome
        Why there is no number, or what was not judged; None where all was.
    """

    change: Message
    settling_time: float
    saved: float
    meets_requirements: bool
    outcome: Message | None = None


def find_improvements(
    machine: Machine,
    loop: LoopChoice,
    choice: Choice,
    comparisons: Sequence[MoveComparison],
    settings: Settings,
    spare: float = inf,
) -> tuple[Improvement, ...]:
    """Return what each single change would bring, the most first.

    Parameters
    ----------
    machine
        Nominal.
    loop, choice
        The loop that is used, and the recommendation.
    comparisons
        One for each move; they know the robust force fed forward.
    settings
        Numerical settings; limits are chosen by the coarser search.
    spare
        What the recommendation left of its allowance [s].

    Returns
    -------
    tuple of Improvement
        What has no number comes last.
    """
    before = choice.candidate.settling_time
    trial = next((item for item in loop.trials if item.is_used and not item.is_classic), None)
    shape = trial.shape if trial else CLASSIC
    # The classic rule begins with the symmetrical optimum, all other loops with more.
    largest = settings.tuning.largest_fraction if trial else 1.0
    has_filters = machine.control.kind.force_filters and not machine.drive.follows
    with allow_part(min(COMPUTED, BEYOND + spare)):  # what comes after that is named as too much
        changes = _changes(with_filters(machine, loop.tuned))
        found = _rested(machine, loop.tuned, choice)
        found += [_computed(item, shape, largest, choice, settings) for item in changes]
        if has_filters and not machine.control.seeks_force_filters:
            found.append(_with_force_filters(machine, shape, loop.tuned, choice, settings))
    for variant in loop.variants:
        if variant.name == WITH and not variant.is_used:
            candidate = variant.candidate
            found.append(
                Improvement(
                    change=Message("change-state-feedback"),
                    settling_time=candidate.settling_time,
                    saved=before - candidate.settling_time,
                    meets_requirements=candidate.assessment.is_met,
                )
            )
    fed = _robust_times(comparisons)
    if fed:
        found.append(
            Improvement(
                change=Message("change-robust-force"),
                settling_time=max(fed),
                saved=before - max(fed),
                meets_requirements=False,
                outcome=Message("change-judged-by-band"),
            )
        )
    return tuple(sorted(found, key=lambda item: item.settling_time))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Change:
    """A change, the machine with it, and whether another control makes it another job."""

    change: Message
    machine: Machine
    is_of_control: bool = False


def _changes(machine: Machine) -> Iterator[_Change]:
    """Yield what the control and the machine leave room for."""
    control, drive = machine.control, machine.drive
    kind = control.kind

    def controlled(name: str, changed: Control) -> _Change:
        changed_machine = replace(machine, control=changed)
        return _Change(change=Message(name), machine=changed_machine, is_of_control=True)

    if control.position_loop is not PositionLoop.DRIVE:
        if PositionLoop.DRIVE in kind.position_loops:
            yield controlled("change-dsc", replace(control, position_loop=PositionLoop.DRIVE))
        finer = PositionLoop.INTERPOLATED
        if control.position_loop is not finer and finer in kind.position_loops:
            yield controlled("change-interpolation", replace(control, position_loop=finer))
    if kind.acceleration_feedforward and control.acceleration_feedforward == 0.0:
        yield controlled("change-feedforward", replace(control, acceleration_feedforward=1.0))
    if kind.setpoint_filters and not control.seeks_setpoint_filter:
        filtered = replace(control, setpoint_filter=None, seeks_setpoint_filter=True)
        yield controlled("change-setpoint-filter", filtered)
    if drive.follows:
        yield from _of_structure(machine)
        return
    faster = replace(drive, force_lag=0.5 * drive.force_lag)
    yield _Change(change=Message("change-lag"), machine=replace(machine, drive=faster))
    yield from _of_structure(machine)
    less = PART * machine.mechanics.moving_mass
    lighter = machine.mechanics.vary(payload=-less, payload_radius=0.0, frequency=1.0, damping=1.0)
    fed = control.feedforward_mass
    adapted = replace(control, feedforward_mass=None if fed is None else fed - less)
    yield _Change(
        change=Message("change-lighter", share=PART),
        machine=replace(machine, mechanics=lighter, control=adapted),
    )


def _of_structure(machine: Machine) -> Iterator[_Change]:
    """Yield what can be known better, or built stiffer."""
    needs = machine.requirements
    if needs.frequency_spread > KNOWN_SPREAD:
        known = replace(needs, frequency_spread=KNOWN_SPREAD)
        yield _Change(
            change=Message("change-spread", spread=KNOWN_SPREAD),
            machine=replace(machine, requirements=known),
        )
    mechanics = machine.mechanics
    stiffer = mechanics.vary(
        payload=0.0, payload_radius=0.0, frequency=sqrt(1.0 + PART), damping=1.0
    )
    yield _Change(
        change=Message("change-stiffer", share=PART), machine=replace(machine, mechanics=stiffer)
    )


def _computed(
    change: _Change, shape: Shape, largest: float, choice: Choice, settings: Settings
) -> Improvement:
    """What a change brings; named where it cannot be computed."""
    try:
        if change.machine.drive.follows:
            return _judged(change, tune_loop(change.machine), choice, settings)
        family = _family(change.machine, shape, settings)
        tuned = tune_shape(family, shape, largest=largest)
        if tuned is None:
            return _without_number(change.change, Message("change-without-margins"))
        return _judged(change, tuned, choice, settings)
    except ComputationError as error:
        return _without_number(change.change, error.message)


def _family(machine: Machine, shape: Shape, settings: Settings) -> LoopFamily:
    """The family that a shape is of: with state feedback where it has a weight for the modes."""
    cascades = cascade_family(machine, settings.tuning)
    return (feedback_family(cascades) if shape.mode_weight else None) or cascades


def _judged(change: _Change, tuned: TunedLoop, choice: Choice, settings: Settings) -> Improvement:
    changed, plant = change.machine, build_plant(change.machine)
    search = partial(choose_limits, changed, plant, tuned)
    # A machine that is a little better has its best limits nearby; another loop may not.
    found = [search(near=choice.limits).candidate]
    is_likely = found[0].assessment.is_met and not change.is_of_control
    if changed.requirements.every_size and not is_likely:
        found.append(search().candidate)
    met = [candidate for candidate in found if candidate.assessment.is_met] or found
    candidate = min(met, key=lambda candidate: candidate.settling_time)
    return Improvement(
        change=change.change,
        settling_time=candidate.settling_time,
        saved=choice.candidate.settling_time - candidate.settling_time,
        meets_requirements=candidate.assessment.is_met,
    )


def _rested(machine: Machine, tuned: TunedLoop, choice: Choice) -> list[Improvement]:
    """What a rest after the moves brings where nobody stated it and the RMS force binds.

    At its least: that from which the force heats too little to bind. Empty where another one
    would change nothing.
    """
    assumed = [machine.is_assumed(f"moves[{n}].dwell") for n in range(1, 1 + len(machine.moves))]
    if not any(assumed) or RMS_FORCE.message not in parts_of(choice.bound_by):
        return []
    plant = build_plant(machine)

    def with_rest(dwell: float) -> Machine:
        pairs = zip(machine.moves, assumed, strict=True)
        return replace(
            machine,
            moves=tuple(replace(move, dwell=dwell) if free else move for move, free in pairs),
        )

    try:
        rested = choose_limits(with_rest(LONG_REST), plant, tuned, near=choice.limits)
        dwell = _least_rest(machine, rested.moves, assumed)
        for _ in range(REST_TRIES):
            if not 0.0 < dwell < LONG_REST:
                break
            # Up to two digits, since an engineer compares it with his cycle; judged as it stands.
            dwell = _rounded_up(dwell)
            candidate = evaluate(with_rest(dwell), plant, tuned, rested.limits)
            saved = choice.candidate.settling_time - candidate.settling_time
            if candidate.assessment.keeps(machine.requirements.reserve) and saved > 0.0:
                change = Message(
                    "change-dwell",
                    dwell=dwell,
                    acceleration=rested.limits.acceleration,
                )
                return [
                    Improvement(
                        change=change,
                        settling_time=candidate.settling_time,
                        saved=saved,
                        meets_requirements=True,
                    )
                ]
            dwell *= REST_FACTOR  # some smaller move, or another corner, heats more
    except ComputationError as error:
        return [_without_number(Message("change-rest"), error.message)]
    return []


def _least_rest(machine: Machine, moves: Sequence[MoveResult], assumed: Sequence[bool]) -> float:
    """Rest from which the RMS force of all moves is what recommendations may use [s].

    The square of the force over the move is E = F_RMS^2 (t_e + d); at rest the static load s heats
    on, so (E + s^2 d') / (t_e + d') = F^2, solved for d'; inf: the load alone heats as much.
    """
    allowed = (machine.requirements.reserve.force * machine.drive.continuous_force) ** 2
    load, rests = machine.drive.static_load**2, [0.0]
    if load >= allowed:
        return inf
    for move, free in zip(moves, assumed, strict=True):
        t_e, d = move.setpoint.duration, move.setpoint.move.dwell
        rms = max(response.rms_force for response in move.responses)
        energy = rms**2 * (t_e + d) - load * d
        if free:
            rests.append((energy - allowed * t_e) / (allowed - load))
    return max(rests)


def _rounded_up(value: float) -> float:
    step = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{ceil(value / step - ROUNDING) * step:.2g}")


def _with_force_filters(
    machine: Machine, shape: Shape, tuned: TunedLoop, choice: Choice, settings: Settings
) -> Improvement:
    """What filters of the set force that let Kp rise bring."""
    change = _Change(change=Message("change-force-filters"), machine=machine)
    try:
        found = find_filters(_family(machine, shape, settings), shape, tuned)
        if found is None:
            return _without_number(change.change, Message("change-no-filters"))
        return _judged(change, found.tuned, choice, settings)
    except ComputationError as error:
        return _without_number(change.change, error.message)


def _without_number(change: Message, outcome: Message) -> Improvement:
    return Improvement(
        change=change, settling_time=inf, saved=-inf, meets_requirements=False, outcome=outcome
    )


def _robust_times(comparisons: Sequence[MoveComparison]) -> list[float]:
    """Settling times of the robust force in every corner of every move; empty if one has none."""
    rows = [
        [row.settling_time for row in found]
        for comparison in comparisons
        for name, found in comparison.fed_forward
        if name == ROBUST
    ]
    return [time for row in rows for time in row] if len(rows) == len(comparisons) else []
