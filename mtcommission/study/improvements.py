"""Potential improvements: what to order or rebuild, by the settling time that each change saves.

Each change is a row: the machine with one thing changed, the loop that is used tuned again on it
with the same ratios of Kv and Tn to Kp, and limits chosen near the recommended ones. Nothing is
estimated: what cannot be computed is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, inf, log10, sqrt

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.errors import ComputationError
from mtcommission.limits.choose import Choice
from mtcommission.limits.judge import Candidate, MoveResult
from mtcommission.loop.tuning.cascade import CLASSIC, Shape
from mtcommission.loop.tuning.family import (
    LoopFamily,
    cascade_family,
    feedback_family,
    find_filters,
    tune_shape,
)
from mtcommission.loop.tuning.tuned import TunedLoop, TuningSettings
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message, parts_of
from mtcommission.requirements.rms_force import RMS_FORCE
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.comparison import ROBUST, MoveComparison
from mtcommission.study.loop_choice import WITH, with_filters
from mtcommission.study.loop_trials import LoopChoice
from mtcommission.study.variations import Row, choose, judge

KNOWN_SPREAD = 0.02
"""Frequency spread of a machine whose modes were measured [-] (empirical)."""

PART = 0.1
"""Share by which the machine is made stiffer or lighter: what a redesign may reach."""

LONG_REST = 3600.0
"""Rest with which no move heats the motor [s]: an hour."""

REST_TRIES, REST_FACTOR = 4, 1.5
"""How often a rest that does not suffice yet is made longer, and by how much."""

ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Improvement:
    """One change, and what it would bring."""

    change: Message
    settling_time: float  # slowest move, worst corner, limits chosen for it [s]; inf: not settled
    saved: float  # less than with the recommendation [s]; negative: it takes longer
    meets_requirements: bool
    outcome: Message | None = None  # why there is no number, or what was not judged


def find_improvements(
    machine: Machine,
    loop: LoopChoice,
    choice: Choice,
    comparisons: Sequence[MoveComparison],
    settings: TuningSettings,
) -> tuple[Improvement, ...]:
    """Return what each single change would bring, the most first; what has no number comes last."""
    before = choice.candidate.settling_time
    trial = next((item for item in loop.trials if item.is_used and not item.is_classic), None)
    again = _Retuned(
        shape=trial.shape if trial else CLASSIC,
        # The classic rule begins with the symmetrical optimum, all other loops with more.
        largest=settings.largest_fraction if trial else 1.0,
        settings=settings,
    )
    changed = _changes(with_filters(machine, loop.tuned))
    found = [_improve(item, again, choice) for item in changed]
    found += _rested(machine, loop.tuned, choice)
    has_filters = machine.control.kind.force_filters and not machine.drive.follows
    if has_filters and not machine.control.seeks_force_filters:
        found.append(_with_force_filters(machine, again, choice))
    found += [
        _compared(Message("change-state-feedback"), variant.candidate, before)
        for variant in loop.variants
        if variant.name == WITH and not variant.is_used
    ]
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
    """A change, the machine with it, and about which limits its own are looked for."""

    change: Message
    machine: Machine
    is_near: bool = True


def _changes(machine: Machine) -> Iterator[_Change]:
    """Yield what the control and the machine leave room for."""
    control, drive = machine.control, machine.drive
    kind = control.kind

    def of_control(name: str, *, is_near: bool = True, **changed: object) -> _Change:
        other = replace(control, **changed)  # type: ignore[arg-type]
        return _Change(
            change=Message(name), machine=replace(machine, control=other), is_near=is_near
        )

    if control.position_loop is not PositionLoop.DRIVE:
        if PositionLoop.DRIVE in kind.position_loops:
            yield of_control("change-dsc", position_loop=PositionLoop.DRIVE)
        finer = PositionLoop.INTERPOLATED
        if control.position_loop is not finer and finer in kind.position_loops:
            yield of_control("change-interpolation", position_loop=finer)
    if kind.acceleration_feedforward and control.acceleration_feedforward == 0.0:
        yield of_control("change-feedforward", acceleration_feedforward=1.0, is_near=False)
    if kind.setpoint_filters and not control.seeks_setpoint_filter:
        yield of_control(
            "change-setpoint-filter",
            setpoint_filter=None,
            seeks_setpoint_filter=True,
            is_near=False,
        )
    yield from _of_structure(machine)
    if drive.follows:
        return
    faster = replace(drive, force_lag=0.5 * drive.force_lag)
    yield _Change(change=Message("change-lag"), machine=replace(machine, drive=faster))
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
    stiffer = machine.mechanics.vary(
        payload=0.0, payload_radius=0.0, frequency=sqrt(1.0 + PART), damping=1.0
    )
    yield _Change(
        change=Message("change-stiffer", share=PART), machine=replace(machine, mechanics=stiffer)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Retuned:
    """How the loop that is used is tuned on another machine."""

    shape: Shape
    largest: float  # where Kp begins, over the symmetrical optimum [-]
    settings: TuningSettings

    def family(self, machine: Machine) -> LoopFamily:
        """The family that the shape is of: state feedback where it has a weight for the modes."""
        cascades = cascade_family(machine, self.settings)
        return (feedback_family(cascades) if self.shape.mode_weight else None) or cascades

    def loop(self, machine: Machine) -> TunedLoop | None:
        """The loop; None where no Kp keeps the margins."""
        if machine.drive.follows:
            return tune_loop(machine)
        return tune_shape(self.family(machine), self.shape, largest=self.largest)


def _improve(item: _Change, again: _Retuned, choice: Choice) -> Improvement:
    """What a change brings; named where it cannot be computed."""
    try:
        tuned = again.loop(item.machine)
        if tuned is None:
            return _without_number(item.change, Message("change-without-margins"))
        near = choice.limits if item.is_near else None
        return _judged(item.change, item.machine, tuned, near, choice)
    except ComputationError as error:
        return _without_number(item.change, error.message)


def _with_force_filters(machine: Machine, again: _Retuned, choice: Choice) -> Improvement:
    """What filters of the set force that let Kp rise bring."""
    change = Message("change-force-filters")
    try:
        found = find_filters(again.family(machine), again.shape)
        if found is None:
            return _without_number(change, Message("change-no-filters"))
        return _judged(change, machine, found.tuned, choice.limits, choice)
    except ComputationError as error:
        return _without_number(change, error.message)


def _judged(
    change: Message, machine: Machine, tuned: TunedLoop, near: MotionLimits | None, choice: Choice
) -> Improvement:
    found = judge(Row(label=change, machine=machine, tuned=tuned, near=near))
    return _compared(change, found, choice.candidate.settling_time)


def _compared(change: Message, found: Candidate, before: float) -> Improvement:
    return Improvement(
        change=change,
        settling_time=found.settling_time,
        saved=before - found.settling_time,
        meets_requirements=found.assessment.is_met,
    )


def _without_number(change: Message, outcome: Message) -> Improvement:
    return Improvement(
        change=change, settling_time=inf, saved=-inf, meets_requirements=False, outcome=outcome
    )


def _rested(machine: Machine, tuned: TunedLoop, choice: Choice) -> list[Improvement]:
    """What a rest after the moves brings where nobody stated it and the RMS force binds.

    At its least: that from which the force heats too little to bind. Empty where another one
    would change nothing.
    """
    assumed = [machine.is_assumed(f"moves[{n}].dwell") for n in range(1, 1 + len(machine.moves))]
    if not any(assumed) or RMS_FORCE.message not in parts_of(choice.bound_by):
        return []

    def with_rest(dwell: float) -> Row:
        pairs = zip(machine.moves, assumed, strict=True)
        moves = tuple(replace(move, dwell=dwell) if free else move for move, free in pairs)
        return Row(
            label=Message("change-rest"),
            machine=replace(machine, moves=moves),
            tuned=tuned,
            near=choice.limits,
        )

    try:
        rested = choose(with_rest(LONG_REST))
        dwell = _least_rest(machine, rested.moves, assumed)
        for _ in range(REST_TRIES):
            if not 0.0 < dwell < LONG_REST:
                break
            # Up to two digits, since an engineer compares it with his cycle; judged as it stands.
            dwell = _rounded_up(dwell)
            candidate = judge(replace(with_rest(dwell), limits=rested.limits))
            before = choice.candidate.settling_time
            is_sooner = candidate.settling_time < before
            if candidate.assessment.keeps(machine.requirements.reserve) and is_sooner:
                change = Message(
                    "change-dwell", dwell=dwell, acceleration=rested.limits.acceleration
                )
                return [_compared(change, candidate, before)]
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


def _robust_times(comparisons: Sequence[MoveComparison]) -> list[float]:
    """Settling times of the robust force in every corner of every move; empty if one has none."""
    rows = [
        [row.settling_time for row in found]
        for comparison in comparisons
        for name, found in comparison.fed_forward
        if name == ROBUST
    ]
    return [time for row in rows for time in row] if len(rows) == len(comparisons) else []
