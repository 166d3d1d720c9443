"""Entries of a record -> the machine and limits that they were made from; ``verify``'s verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from mtcommission.base.messages.message import Message
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.gains import build_cascade, given_state_feedback
from mtcommission.loop.tuning.tuned import (
    TunedLoop,
    close_loop,
    corner_plants,
    follow,
)
from mtcommission.loop.tuning.tuning import warn_of_modes
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.readers import SignalValue
from mtcommission.record.limits import JudgedLimits, RecommendedEntry
from mtcommission.record.loop import LoopPart
from mtcommission.record.machine import Datum, MachineEntry, PlantEntry, Profile
from mtcommission.record.moves import AssessmentPart
from mtcommission.record.record import FORCE_LIMITS, Record
from mtcommission.record.shape import WrongFormError, fault, load_json, to_entry
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.attainable import ModeLimits

VERDICTS = ("holds", "does not hold", "cannot tell")


class AxisLimits(Protocol):
    """Limits for a control, and those of its machining modes."""

    @property
    def recommended(self) -> RecommendedEntry: ...  # noqa: D102
    @property
    def modes(self) -> list[ModeLimits]: ...  # noqa: D102


class AxisRecord(Protocol):
    """What there is of an axis in a record of its own, and in that of a group."""

    @property
    def machine(self) -> MachineEntry: ...  # noqa: D102
    @property
    def profile(self) -> Profile: ...  # noqa: D102
    @property
    def data(self) -> list[Datum]: ...  # noqa: D102
    @property
    def plant(self) -> PlantEntry: ...  # noqa: D102
    @property
    def limits(self) -> AxisLimits: ...  # noqa: D102
    @property
    def loop(self) -> LoopPart: ...  # noqa: D102
    @property
    def assessment(self) -> AssessmentPart: ...  # noqa: D102


def read_machine(record: AxisRecord) -> Machine:
    """Return the machine of a record's profile, with the force limit of the run."""
    machine = parse_profile(record.profile.text, where=record.profile.name)
    data = {row.key: row.value for row in record.data}
    force = data[FORCE_LIMITS[machine.drive.follows]]
    return replace(machine, drive=replace(machine.drive, max_force=float(force)))


def read_held(record: AxisRecord) -> Machine:
    """Return the machine of a record with the gains that were found in place of tuning."""
    machine, loop = read_machine(record), record.loop
    gains = loop.state_feedback
    control = replace(
        machine.control,
        position_gain=loop.Kv,
        velocity_gain=loop.Kp,
        integral_time=loop.Tn,
        reference_delay=loop.reference_delay,
        feedforward_mass=loop.feedforward.mass,
        force_filters=tuple(loop.force_filters),
        seeks_force_filters=False,
        state_feedback=StateFeedback.GIVEN if gains else StateFeedback.OFF,
        state_gains=tuple(SignalValue(name=state, value=gain) for state, gain in gains.items()),
    )
    return replace(machine, control=control)


def held_controller(machine: Machine, plant: Plant) -> Controller:
    """Return a controller whose gains are all given: nothing is tuned.

    Raises
    ------
    ComputationError
        NOT_OBSERVABLE or FEEDBACK_DESIGN_FAILED, for state gains.
    """
    controller = build_cascade(machine, plant, fraction=1.0)
    if machine.control.state_feedback is not StateFeedback.GIVEN:
        return controller
    return given_state_feedback(machine, plant, controller)


def close_as_held(machine: Machine) -> TunedLoop:
    """Return the loop of a control whose gains are all given, in every corner.

    Raises
    ------
    ComputationError
        As ``held_controller``.
    """
    bench = corner_plants(machine)
    if machine.drive.follows:
        return follow(machine, bench)
    tuned = close_loop(bench, held_controller(machine, bench.model))
    return replace(tuned, warnings=tuple(warn_of_modes(bench, tuned)))


def read_limits(entry: JudgedLimits) -> MotionLimits:
    """Return recommended limits with their setpoint filter."""
    return MotionLimits(
        acceleration=entry.acceleration, jerk=entry.jerk, setpoint_filter=entry.setpoint_filter
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """A measured value beside the calculated one; ``verdict`` "" where none is given [SI]."""

    name: str  # in the JSON of ``verify``
    measured: float | None
    uncertainty: float | None
    verdict: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Verified:
    """The verdict over all, and each measured value by its name."""

    verdict: str
    headline: Message  # the verdict in words, with what cannot be told
    values: Mapping[str, Measured]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Refined:
    new: float
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Verdict:
    """What is read of ``verdict.json``."""

    verdict: str
    record: str
    checks: list[Measured]
    refined: dict[str, _Refined]
    headline: Message | None = None  # None: written before there was one


def load_verdict(path: Path, record: Record) -> Verified:
    """Return a verdict from the ``verdict.json`` of ``verify``.

    Raises
    ------
    InputError
        It is no such file, or it is about another record.
    """
    try:
        found = to_entry(load_json(path), _Verdict)
    except WrongFormError as error:
        raise fault(path, Message("verdict-of-other-form")) from error
    if not {found.verdict, *(check.verdict for check in found.checks)} <= set(VERDICTS):
        raise fault(path, Message("verdict-of-other-form"))
    if found.record != record.checksum:
        raise fault(path, Message("verdict-of-other-record"))
    values = {check.name: check for check in found.checks}
    for name, one in found.refined.items():
        # base.damping_ratio is judged by the check "base: damping ratio".
        mode, _, key = name.rpartition(".")
        check = values.get(f"{mode}: {key.replace('_', ' ')}")
        values[name] = Measured(
            name=name,
            measured=one.new,
            uncertainty=2.0 * one.sigma,
            verdict=check.verdict if check else "",
        )
    plain = Message(f"verify-verdict-{found.verdict.replace(' ', '-')}")
    return Verified(verdict=found.verdict, headline=found.headline or plain, values=values)
