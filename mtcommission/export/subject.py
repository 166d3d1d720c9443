"""Record -> Subject: what an export needs to know, and the loop to evaluate it in.

The record holds the profile's text and every gain that was chosen, so the loop is built again
as it was, in every corner, without tuning or optimising anything.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np

from mtcommission.errors import Fault, InputError
from mtcommission.export.wording import DEGREE, MILLI, name_mode
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.machine import Machine, Motion, StateFeedback, StateGain
from mtcommission.machine.rigid_body import peak_velocity
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, PlantMode, build_plant, dominant_mode
from mtcommission.profile.read import parse_profile, profile_text_hash
from mtcommission.record.schema import ModeLimitsEntry, Record
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Plan
from mtcommission.verdict.assess import Assessment
from mtcommission.verdict.evaluate import evaluate_moves, simulate_planned

REBUILT, ROUNDING = 1e-6, 1e-12
"""Largest relative difference of an entry of the record's loop from the one built again, and what
counts as zero beside its largest entry: versions of the linear algebra may differ by so much."""

BYTE_ORDER_MARK = "\ufeff"
"""Some editors begin a file with it; the hash counts it, the text in the record lacks it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """Gains of the cascade.

    Parameters
    ----------
    position
        Kv [1/s].
    velocity
        Kp [N s/m].
    integral_time
        Tn [s].
    """

    position: float
    velocity: float
    integral_time: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Subject:
    """An axis with its recommended limits, ready to be written for a control.

    Parameters
    ----------
    record
        Where everything comes from.
    machine, plant, tuned
        Built again from the record.
    limits
        The recommendation.
    settling_time
        What it reached in the run, worst case [s]; inf if not settled.
    is_met
        Whether it met all requirements.
    """

    record: Record
    machine: Machine
    plant: Plant
    tuned: TunedLoop
    limits: MotionLimits
    settling_time: float
    is_met: bool

    @property
    def is_rotary(self) -> bool:
        """Whether the axis turns."""
        return self.machine.motion is Motion.ROTARY

    @property
    def length(self) -> str:
        """SI unit of a position."""
        return self.machine.axis_units.length.si

    @property
    def small_unit(self) -> tuple[str, float]:
        """Unit of a position that most controls have: its name, and its size in SI."""
        return ("deg", DEGREE) if self.is_rotary else ("mm", MILLI)

    @property
    def gains(self) -> Gains:
        """Gains of the loop that limits are judged in."""
        controller = self.tuned.controller
        return Gains(
            position=controller.position_gain,
            velocity=controller.velocity_gain,
            integral_time=controller.integral_time,
        )

    @property
    def axis(self) -> str:
        """Name of the axis as the profile gives it."""
        return self.machine.axis.strip()

    @property
    def mode(self) -> PlantMode:
        """The mode that a setpoint excites most."""
        return dominant_mode(self.plant)

    @property
    def fastest(self) -> float:
        """Largest velocity of the profile's moves [m/s]."""
        return max(peak_velocity(move, self.limits.acceleration) for move in self.machine.moves)


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What limits do in every corner.

    Parameters
    ----------
    settling_time, residual_deviation
        Worst over moves and corners [s, m]; inf where not settled.
    assessment
        Every requirement.
    """

    settling_time: float
    residual_deviation: float
    assessment: Assessment


def build_subject(record: Record) -> Subject:
    """Return the axis of a record with its loop built again.

    Parameters
    ----------
    record
        Of a run.

    Returns
    -------
    Subject

    Raises
    ------
    InputError
        If the record does not belong to its own profile text.
    """
    _require_own_profile(record)
    machine = _as_recorded(record)
    recommended = record.limits.recommended
    subject = Subject(
        record=record,
        machine=machine,
        plant=build_plant(machine),
        tuned=tune_loop(machine),
        limits=MotionLimits(acceleration=recommended.acceleration, jerk=recommended.jerk),
        settling_time=_or_infinite(recommended.settling_time),
        is_met=record.assessment.met,
    )
    _require_same_loop(subject)
    return subject


def with_gains(subject: Subject, gains: Gains) -> Subject:
    """Return the subject with other gains in its loop, which is built anew in every corner.

    Parameters
    ----------
    subject
        The axis.
    gains
        In SI.

    Returns
    -------
    Subject
    """
    control = replace(
        subject.machine.control,
        position_gain=gains.position,
        velocity_gain=gains.velocity,
        integral_time=gains.integral_time,
    )
    machine = replace(subject.machine, control=control)
    return replace(subject, machine=machine, tuned=tune_loop(machine))


def for_mode(subject: Subject, mode: ModeLimitsEntry) -> Subject:
    """Return the subject with the limits and the band of one machining mode.

    Parameters
    ----------
    subject
        The axis.
    mode
        Of its record.

    Returns
    -------
    Subject

    Raises
    ------
    InputError
        If the mode has no limits.
    """
    acceleration, jerk = mode.acceleration, mode.jerk
    if acceleration is None or jerk is None:
        message = Message("export-mode-without-limits", mode=name_mode(mode.name))
        raise InputError([Fault(where="record", key="limits.modes", message=message)])
    needs = replace(subject.machine.requirements, tcp_deviation=mode.band)
    return replace(
        subject,
        machine=replace(subject.machine, requirements=needs),
        limits=MotionLimits(acceleration=acceleration, jerk=jerk),
        settling_time=_or_infinite(mode.settling_time),
        is_met=mode.meets_requirements,
    )


def judge_plan(subject: Subject, plan: Plan) -> Verdict:
    """Return what planned setpoints do in every corner.

    Parameters
    ----------
    subject
        The axis.
    plan
        Setpoint of a move, filters included.

    Returns
    -------
    Verdict
    """
    machine, tuned = subject.machine, subject.tuned
    moves = simulate_planned(machine, tuned, plan)
    found = evaluate_moves(machine, subject.plant, tuned, moves)
    return Verdict(
        settling_time=found.settling_time,
        residual_deviation=found.residual_deviation,
        assessment=found.assessment,
    )


def _or_infinite(value: float | None) -> float:
    return inf if value is None else value


def _require_own_profile(record: Record) -> None:
    """The header prints the hash: it must be that of the text which the loop is built from."""
    profile = record.profile
    texts = (profile.text, f"{BYTE_ORDER_MARK}{profile.text}")
    if profile.sha256 not in (profile_text_hash(text.encode()) for text in texts):
        message = Message("export-profile-edited")
        raise InputError([Fault(where="record", key="profile.text", message=message)])


def _as_recorded(record: Record) -> Machine:
    """The profile's machine with the record's force limit and gains in place of tuning."""
    machine = parse_profile(record.profile.text, where=record.profile.name)
    force = next(row.value for row in record.data if row.key == "drive.max_force")
    loop, gains = record.loop, record.loop.state_feedback
    control = replace(
        machine.control,
        position_gain=loop.Kv,
        velocity_gain=loop.Kp,
        integral_time=loop.Tn,
        reference_delay=loop.reference_delay,
        feedforward_mass=loop.feedforward.mass,
        state_feedback=StateFeedback.GIVEN if gains else StateFeedback.OFF,
        state_gains=tuple(StateGain(state=state, value=gain) for state, gain in gains.items()),
    )
    drive = replace(machine.drive, max_force=float(force))
    return replace(machine, drive=drive, control=control)


def _require_same_loop(subject: Subject) -> None:
    recorded = np.array(subject.record.loop.closed_loop.A)
    rebuilt = subject.tuned.loops[0].lifted.A
    same = recorded.shape == rebuilt.shape and np.allclose(
        recorded, rebuilt, rtol=REBUILT, atol=ROUNDING * float(np.max(np.abs(rebuilt)))
    )
    recommended = subject.record.limits.recommended
    if not (same and isfinite(recommended.acceleration) and recommended.jerk > 0.0):
        raise InputError([Fault(where="record", key="loop", message=Message("export-other-loop"))])
