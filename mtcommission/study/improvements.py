"""Potential improvements: what to switch on, measure or order, by the settling time that it saves.

Each change is a row: the machine with one thing changed, the loop that is used tuned again on it
with the same ratios of Kv and Tn to Kp, and limits chosen near the recommended ones. What the
search sees save next to nothing is not judged. Nothing is estimated: what cannot be computed is
said.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, inf, isfinite, log10

from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.message import Message, parts_of
from mtcommission.controls.kind import PositionLoop
from mtcommission.limits.choose import Choice
from mtcommission.limits.explore import REFINED
from mtcommission.limits.judge import Candidate, MoveResult
from mtcommission.limits.requirements import RMS_FORCE
from mtcommission.loop.tuning.family import (
    LoopFamily,
    cascade_family,
    feedback_family,
    find_filters,
    tune_shape,
)
from mtcommission.loop.tuning.tuned import TUNING, TunedLoop, close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.identified import ToolSensor
from mtcommission.machine.machine import Machine
from mtcommission.study.loops import WITH, LoopChoice, with_filters
from mtcommission.study.settings import STUDY
from mtcommission.study.variations import Row, choose, judge, look

ROUNDING = 1e-9

SAVES_LITTLE = Message("change-saves-little", share=STUDY.worth)


@dataclass(frozen=True, slots=True, kw_only=True)
class Improvement:
    """One change, and what it would bring; None where there is no number."""

    change: Message
    settling_time: float | None = None  # slowest move, worst corner, limits chosen for it [s]
    saved: float | None = None  # less than with the recommendation [s]; negative: it takes longer
    share: float | None = None  # the same relative to that of the recommendation [-]
    meets_requirements: bool = False
    outcome: Message | None = None  # why there is no number, or that it hardly helps

    @property
    def name(self) -> str:
        """What is changed, without its numbers."""
        return self.change.kind.removeprefix("change-")


def find_improvements(
    machine: Machine,
    loop: LoopChoice,
    choice: Choice,
) -> tuple[Improvement, ...]:
    """Return what each single change would bring, the most first; what has no number comes last."""
    used, shape = loop.used, loop.tuned.shape
    # The classic rule begins with the symmetrical optimum, all other loops with more.
    largest = 1.0 if used is None or used.is_classic else TUNING.largest_fraction

    def family(changed: Machine) -> LoopFamily:
        cascades = cascade_family(changed)
        return (feedback_family(cascades) if shape.mode_weight else None) or cascades

    def tune(changed: Machine) -> TunedLoop | None:
        if changed.drive.follows:
            return tune_loop(changed)
        return tune_shape(family(changed), shape, largest=largest)

    def filter_force(changed: Machine) -> TunedLoop | None:
        found = find_filters(family(changed), shape)
        return found[1] if found else None

    rows = [
        _improve(change, changed, tune, choice, is_near=is_near)
        for change, changed, is_near in _changes(with_filters(machine, loop.tuned))
    ]
    rows += _rested(machine, loop.tuned, choice)
    has_filters = machine.control.kind.force_filters and not machine.drive.follows
    if has_filters and not machine.control.seeks_force_filters:
        rows.append(_improve(Message("change-force-filters"), machine, filter_force, choice))
    rows += [
        _compared(Message("change-state-feedback"), variant.candidate, choice)
        for variant in loop.variants
        if variant.name == WITH and not variant.is_used
    ]
    return tuple(sorted(rows, key=lambda item: item.settling_time or inf))


_Change = tuple[Message, Machine, bool]
"""A change, the machine with it, and whether its limits lie near the recommended ones."""


def _changes(machine: Machine) -> Iterator[_Change]:
    """Yield what control, drive and structure leave room for."""
    control, drive, kind = machine.control, machine.drive, machine.control.kind

    def of_control(name: str, *, is_near: bool = True, **changed: object) -> _Change:
        other = replace(control, **changed)  # type: ignore[arg-type]
        return Message(name), replace(machine, control=other), is_near

    if control.position_loop is not PositionLoop.DRIVE:
        if PositionLoop.DRIVE in kind.position_loops:
            yield of_control("change-dsc", position_loop=PositionLoop.DRIVE)
        finer = PositionLoop.INTERPOLATED
        if control.position_loop is not finer and finer in kind.position_loops:
            yield of_control("change-interpolation", position_loop=finer)
    if kind.acceleration_feedforward and control.acceleration_feedforward == 0.0:
        yield of_control("change-feedforward", acceleration_feedforward=1.0, is_near=False)
    if kind.setpoint_filters and not control.seeks_setpoint_filter:
        sought = {"setpoint_filter": None, "seeks_setpoint_filter": True}
        yield of_control("change-setpoint-filter", is_near=False, **sought)
    needs, spread = machine.requirements, STUDY.known_spread
    if needs.frequency_spread > spread:
        known = replace(machine, requirements=replace(needs, frequency_spread=spread))
        yield Message("change-spread", spread=spread), known, True
    if not drive.follows:
        faster = replace(drive, force_lag=0.5 * drive.force_lag)
        yield Message("change-lag"), replace(machine, drive=faster), True


def _improve(
    change: Message,
    machine: Machine,
    tune: Callable[[Machine], TunedLoop | None],
    choice: Choice,
    *,
    is_near: bool = True,
) -> Improvement:
    """What a change brings in the loop that is tuned for it; named where there is no number."""
    try:
        tuned = tune(machine)
        if tuned is None:
            is_filter = change.kind == "change-force-filters"
            why = Message("change-no-filters" if is_filter else "change-without-margins")
            return Improvement(change=change, outcome=why)
        row = Row(machine=machine, tuned=tuned, near=choice.limits if is_near else None)
        if not choice.meets_requirements or choice.reserve_used:
            return _compared(change, judge(row), choice)
        known, delay = choice.candidate.settling_time, tuned.controller.reference_delay
        latest = (1.0 - STUDY.worth) * known - delay
        seen = look(replace(row, refined=1 if is_near else REFINED, latest=latest))
        if not seen or seen[0].duration > latest:
            return Improvement(change=change, outcome=SAVES_LITTLE)
        return _compared(change, judge(replace(row, found=seen)), choice)
    except ComputationError as error:
        return Improvement(change=change, outcome=error.message)


def _compared(change: Message, found: Candidate, choice: Choice) -> Improvement:
    known, time = choice.candidate.settling_time, found.settling_time
    is_little = choice.meets_requirements and time > (1.0 - STUDY.worth) * known
    is_known = isfinite(known) and isfinite(time)
    return Improvement(
        change=change,
        settling_time=time if isfinite(time) else None,
        saved=known - time if is_known else None,
        share=1.0 - time / known if is_known else None,
        meets_requirements=found.assessment.is_met,
        outcome=SAVES_LITTLE if is_little else None,
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
        return Row(machine=replace(machine, moves=moves), tuned=tuned, near=choice.limits)

    try:
        rested = choose(with_rest(STUDY.long_rest))
        dwell = _least_rest(machine, rested.moves, assumed)
        for _ in range(STUDY.rest_tries):
            if not 0.0 < dwell < STUDY.long_rest:
                break
            # Up to two digits, since an engineer compares it with his cycle; judged as it stands.
            step = 10.0 ** (floor(log10(dwell)) - 1)
            dwell = float(f"{ceil(dwell / step - ROUNDING) * step:.2g}")
            a = rested.limits.acceleration
            change = Message("change-dwell", dwell=dwell, acceleration=a)
            found = judge(replace(with_rest(dwell), limits=rested.limits))
            is_sooner = found.settling_time < choice.candidate.settling_time
            if found.assessment.keeps_reserve and is_sooner:
                return [_compared(change, found, choice)]
            dwell *= STUDY.rest_factor  # some smaller move, or another corner, heats more
    except ComputationError as error:
        return [Improvement(change=Message("change-rest"), outcome=error.message)]
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


def value_tool_sensor(machine: Machine, tuned: TunedLoop, choice: Choice) -> ToolSensor | None:
    """Return what a sensor at the tool could free at most; None where nothing was assumed.

    The measurement may show anything between the assumed share, a worst case, and a tool at rest.
    """
    mechanics = machine.mechanics
    assumed = tuple(
        mode.name
        for place, mode in enumerate(mechanics.modes)
        if machine.is_assumed(f"{mechanics.mode_key(place)}.tcp_gain")
    )
    resting = mechanics.still_tool(assumed)
    if machine.identified is None or not assumed or resting is None:
        return None
    still = replace(machine, mechanics=resting)
    loop = close_loop(corner_plants(still), tuned.controller)
    # A tool that swings less may want another filter: everywhere, not about the recommendation.
    found = choose(Row(machine=still, tuned=loop))
    return ToolSensor(
        modes=assumed,
        settling_time=choice.candidate.settling_time if choice.meets_requirements else None,
        least=found.candidate.settling_time if found.meets_requirements else None,
    )
