"""Entries of a record -> the machine, limits and filters that they were made from."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from mtcommission.controls.kind import FIR
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.gains import build_cascade, given_state_feedback
from mtcommission.loop.tuning.tuned import (
    TunedLoop,
    TuningSettings,
    close_loop,
    corner_plants,
    follow,
)
from mtcommission.loop.tuning.tuning import warn_of_modes
from mtcommission.machine.control import StateFeedback, StateGain
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.limits import JudgedLimits, ModeLimitsEntry, RecommendedEntry
from mtcommission.record.loop import LoopPart
from mtcommission.record.machine import Datum, MachineEntry, PlantEntry, Profile
from mtcommission.record.moves import AssessmentPart
from mtcommission.record.record import FORCE_LIMITS
from mtcommission.record.values import SetpointFilterEntry
from mtcommission.setpoint.motion_limits import MotionLimits


class AxisLimits(Protocol):
    """Limits for a control, and those of its machining modes."""

    @property
    def recommended(self) -> RecommendedEntry: ...  # noqa: D102
    @property
    def modes(self) -> list[ModeLimitsEntry]: ...  # noqa: D102


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
        state_gains=tuple(StateGain(state=state, value=gain) for state, gain in gains.items()),
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
    return given_state_feedback(machine, plant, controller, settings=TuningSettings())


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
    item = entry.setpoint_filter
    return MotionLimits(
        acceleration=entry.acceleration,
        jerk=entry.jerk,
        setpoint_filter=read_filter(item) if item else None,
    )


def read_filter(entry: SetpointFilterEntry) -> SetpointFilter:
    """Return the setpoint filter of a record's entry."""
    is_fir = entry.kind == FIR
    return SetpointFilter(
        kind=entry.kind,
        time=entry.time,
        second_time=entry.second_time,
        frequency_hz=entry.frequency_hz,
        damping_ratio=entry.damping_ratio,
        taps=tuple(entry.shares) if is_fir else (),
        spacing=entry.delays[1] if is_fir else 0.0,
    )
