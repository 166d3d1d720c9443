"""What a control holds, as settings: from the record, and back to the loop that is judged."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from math import inf, pi
from typing import Any

from mtcommission.base.errors import ComputationError, InputError
from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import (
    FIR,
    LOW_PASS,
    MOVING_AVERAGE,
    NOTCH,
    SHAPERS,
    TWO_AVERAGES,
    PositionLoop,
)
from mtcommission.controls.row import Key, Setting, Values, unreadable
from mtcommission.export.subject import Subject
from mtcommission.limits.judge import Candidate, evaluate
from mtcommission.loop.tuning.tuned import TunedLoop, TuningSettings, describe_margins, has_margins
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import Control, ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.machine.readers import SignalValue
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.record.read_back import close_as_held
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.attainable import ModeLimits

ALWAYS = {
    Setting.POSITION_CYCLE: "position_cycle",
    Setting.VELOCITY_CYCLE: "velocity_cycle",
    Setting.POSITION_GAIN: "position_gain",
    Setting.VELOCITY_GAIN: "velocity_gain",
    Setting.INTEGRAL_TIME: "integral_time",
}
"""Numbers without which there is no loop, and what they are called there."""

LIMITS = {Setting.ACCELERATION, Setting.RISE_TIME, Setting.JERK, Setting.JERK_TIME}
"""Settings that are chosen anew for each machining mode."""

ROUNDED_MARGINS = TuningSettings(gain_margin_db=5.7, phase_margin_deg=29.0, sensitivity_peak=2.1)
"""What rounding to the digits of a control may leave of the margins."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Held:
    """The loop that a text makes, ready to simulate."""

    machine: Machine  # mechanics, moves and requirements of the profile, the text's control
    tuned: TunedLoop  # its loop in every corner; nothing of it was tuned
    values: Values  # everything that the text says
    judged: dict[tuple[MotionLimits, float], Candidate] = field(default_factory=dict)
    """What was judged already, by limits and band [m]."""

    def limits(self, mode: str = "") -> MotionLimits:
        """Return the limits of a machining mode; "" for the recommendation."""
        return read_limits(self.values, mode)

    def judge(self, limits: MotionLimits, mode: ModeLimits | None = None) -> Candidate:
        """Return what limits do in every corner, with the band of a machining mode."""
        needs = self.machine.requirements
        band = mode.band if mode else needs.tcp_deviation
        if (limits, band) not in self.judged:
            machine = replace(self.machine, requirements=replace(needs, tcp_deviation=band))
            self.judged[limits, band] = evaluate(machine, self.tuned, limits)
        return self.judged[limits, band]


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What a text holds and does."""

    held: Held  # the loop that it makes
    verdict: Candidate  # of the recommendation
    left_out: tuple[ModeLimits, ...]  # machining modes whose band no limits meet
    lost_margins: Message | None  # where they are poor and those of the record were not
    is_met: bool  # whether all requirements are kept in every corner, and the record's margins


# From the record


def loop_of(subject: Subject) -> dict[Key, float | str]:
    """Return the settings of the record's loop, as far as the control has them."""
    kind, loop = subject.kind, subject.controller
    values: dict[Key, float | str] = {(Setting.POSITION_LOOP, ""): subject.position_loop.value}
    values |= {(setting, ""): getattr(loop, name) for setting, name in ALWAYS.items()}
    if loop.reference_model_time:
        values[Setting.REFERENCE_MODEL, ""] = loop.reference_model_time
    mass, filters = loop.feedforward_mass, min(len(loop.force_filters), kind.force_filters)
    force = loop.acceleration_feedforward * mass
    jerk = loop.jerk_feedforward * mass * loop.force_lag
    delay = max(loop.reference_delay, subject.own_delay)
    for setting, value, has in (
        (Setting.VELOCITY_FEEDFORWARD, loop.velocity_feedforward, kind.velocity_feedforward),
        (Setting.FORCE_FEEDFORWARD, force, kind.acceleration_feedforward),
        (Setting.JERK_FEEDFORWARD, jerk, kind.jerk_feedforward),
        (Setting.REFERENCE_DELAY, delay, kind.reference_delay),
        (Setting.FILTERS, filters, kind.force_filters),
    ):
        if has:
            values[setting, ""] = float(value)
    values[Setting.FEEDFORWARD, ""] = _feedforward(values)
    if kind.state_feedback:
        gains = subject.record.loop.state_feedback
        values |= {(Setting.STATE_GAIN, state): gain for state, gain in gains.items()}
    values |= filter_of(subject)
    for number, item in enumerate(loop.force_filters[: kind.force_filters], start=1):
        values |= {
            (Setting.FILTER_KIND, str(number)): item.kind,
            (Setting.FILTER_FREQUENCY, str(number)): item.natural_frequency / (2.0 * pi),
            (Setting.FILTER_DAMPING, str(number)): item.damping,
        }
        if item.kind == NOTCH:
            values[Setting.FILTER_WIDTH, str(number)] = item.width
    return values


def filter_of(subject: Subject) -> dict[Key, float | str]:
    """Return the settings of the setpoint filter: all that is left where the motor follows."""
    none = {(Setting.AVERAGE, ""): 0.0} if subject.kind.find_filter(MOVING_AVERAGE) else {}
    return {**none, **write_filter(subject.setpoint_filter)}


def _feedforward(values: Values) -> str:
    """Which feed-forward acts, for controls that switch it."""
    if values.get((Setting.FORCE_FEEDFORWARD, "")):
        return "force"
    return "velocity" if values.get((Setting.VELOCITY_FEEDFORWARD, "")) else "none"


def today_of(subject: Subject) -> dict[Key, float | str]:
    """Return what the control holds now, as far as the profile says so."""
    today = subject.machine.today
    if today is None:
        return {}
    a, j = today.acceleration, today.jerk
    known = {
        Setting.ACCELERATION: a,
        Setting.RISE_TIME: subject.fastest / a,
        Setting.JERK: j,
        Setting.JERK_TIME: a / j if j else None,
        Setting.POSITION_GAIN: today.position_gain,
        Setting.VELOCITY_GAIN: today.velocity_gain,
        Setting.INTEGRAL_TIME: today.integral_time,
    }
    given = {(setting, ""): value for setting, value in known.items() if value is not None}
    return given | write_filter(today.setpoint_filter)


def write_limits(limits: MotionLimits, rapid: float, mode: str = "") -> dict[Key, float | str]:
    """Return limits in all the ways in which a control may hold them."""
    a, j = limits.acceleration, limits.jerk
    return {
        (Setting.ACCELERATION, mode): a,
        (Setting.RISE_TIME, mode): rapid / a,
        (Setting.JERK, mode): j,
        (Setting.JERK_TIME, mode): a / j,
    }


def write_filter(item: SetpointFilter | None) -> dict[Key, float | str]:
    """Return the settings of a setpoint filter; none for none."""
    if item is None:
        return {}
    if item.kind in SHAPERS:
        return {
            (Setting.SHAPER, ""): item.kind,
            (Setting.SHAPER_FREQUENCY, ""): item.frequency_hz,
            (Setting.SHAPER_DAMPING, ""): item.damping_ratio,
        }
    if item.taps:
        taps = {(Setting.TAP, str(i)): tap for i, tap in enumerate(item.taps, start=1)}
        return {**taps, (Setting.TAP_SPACING, ""): item.spacing}
    times = zip((Setting.AVERAGE, Setting.SECOND_AVERAGE), item.averages, strict=False)
    return {(setting, ""): time for setting, time in times}


# Back to the loop


def _number(
    values: Values, setting: Setting, index: str = "", *, missing: float | None = None
) -> float:
    """A number that a text must hold, unless there is one for where it does not."""
    value = values.get((setting, index), missing)
    if not isinstance(value, float):
        raise unreadable(setting.value[0])
    return value


def read_limits(values: Values, mode: str = "") -> MotionLimits:
    """Return the limits that a control makes of its settings.

    Raises InputError if one is missing.
    """
    if (Setting.RISE_TIME, mode) in values:
        a = _number(values, Setting.RAPID) / _number(values, Setting.RISE_TIME, mode)
    else:
        a = _number(values, Setting.ACCELERATION, mode)
    if (Setting.JERK, mode) in values:
        jerk = _number(values, Setting.JERK, mode)
    elif (Setting.JERK_TIME, mode) in values:
        jerk = a / _number(values, Setting.JERK_TIME, mode)
    else:
        jerk = a / _number(values, Setting.POSITION_CYCLE)
    return MotionLimits(acceleration=a, jerk=jerk, setpoint_filter=_read_filter(values))


def _read_filter(values: Values) -> SetpointFilter | None:
    """The setpoint filter that a control makes of its settings."""
    if (Setting.SHAPER, "") in values:
        return SetpointFilter(
            kind=str(values[Setting.SHAPER, ""]),
            frequency_hz=_number(values, Setting.SHAPER_FREQUENCY),
            damping_ratio=_number(values, Setting.SHAPER_DAMPING),
        )
    if (Setting.TAP_SPACING, "") in values:
        taps = [_number(values, setting, i) for setting, i in values if setting is Setting.TAP]
        spacing = _number(values, Setting.TAP_SPACING)
        return SetpointFilter(kind=FIR, taps=tuple(taps), spacing=spacing)
    time = _number(values, Setting.AVERAGE, missing=0.0)
    second = _number(values, Setting.SECOND_AVERAGE, missing=0.0)
    if time and second:
        return SetpointFilter(kind=TWO_AVERAGES, time=time, second_time=second)
    return moving_average(time)


def hold(subject: Subject, values: Values, *, known: Held | None = None) -> Held:
    """Return the loop that settings make: of the profile only machine, moves and requirements.

    ``known``: of other settings; its loop is taken where these make the same.

    Raises InputError if a setting is missing, contradicts another, or the loop is unstable.
    """
    machine = subject.machine
    if machine.drive.follows:
        # Nothing of a loop stands in the text: its setpoint is simulated as the record's.
        cycle = subject.controller.position_cycle
        values = {(Setting.POSITION_CYCLE, ""): cycle, **values}
        control = replace(
            machine.control, kind=subject.kind, setpoint_filter=None, seeks_setpoint_filter=False
        )
        machine = replace(machine, control=control)
    else:
        machine = replace(machine, control=_control(values, subject))
    if known is not None and machine == known.machine:
        return replace(known, values=values)
    try:
        tuned = close_as_held(machine)
        if not all(analysis.is_stable for analysis in tuned.analyses):
            tune_loop(machine)  # names the corner, and the gains to lower
    except ComputationError as error:
        message = Message(
            "export-unstable",
            lacking="yes" if subject.left_out else "no",
            left_out=tuple(Message("export-feature", what=what) for what in subject.left_out),
            why=error.message,
            kind=subject.kind.key,
        )
        raise InputError.at("--control", message) from error
    return Held(machine=machine, tuned=tuned, values=values)


def _control(values: Values, subject: Subject) -> Control:
    filters = [index for setting, index in values if setting is Setting.FILTER_KIND]
    if _number(values, Setting.FILTERS, missing=0.0) != len(filters):
        raise unreadable(Setting.FILTERS.value[0])
    if (Setting.POSITION_LOOP, "") not in values:
        raise unreadable(Setting.POSITION_LOOP.value[0])
    if values.get((Setting.FEEDFORWARD, ""), _feedforward(values)) != _feedforward(values):
        raise unreadable(Setting.FEEDFORWARD.value[0])

    def given(setting: Setting) -> float:
        return _number(values, setting, missing=0.0)

    lag = subject.machine.drive.force_lag
    fed_back = tuple(
        SignalValue(name=index, value=_number(values, setting, index))
        for setting, index in values
        if setting is Setting.STATE_GAIN
    )
    force, jerk = given(Setting.FORCE_FEEDFORWARD), given(Setting.JERK_FEEDFORWARD)
    mass = force or (jerk / lag if lag else 0.0)
    cycles_and_gains: dict[str, Any] = {name: _number(values, one) for one, name in ALWAYS.items()}
    return Control(
        kind=subject.kind,
        position_loop=PositionLoop(values[Setting.POSITION_LOOP, ""]),
        reference_model_time=given(Setting.REFERENCE_MODEL),
        velocity_feedforward=given(Setting.VELOCITY_FEEDFORWARD),
        acceleration_feedforward=1.0 if force else 0.0,
        jerk_feedforward=jerk / (mass * lag) if jerk else 0.0,
        feedforward_mass=mass,
        reference_delay=given(Setting.REFERENCE_DELAY),
        **cycles_and_gains,
        state_feedback=StateFeedback.GIVEN if fed_back else StateFeedback.OFF,
        state_gains=fed_back,
        force_filters=tuple(
            ForceFilter(
                kind=NOTCH if values[Setting.FILTER_KIND, i] == NOTCH else LOW_PASS,
                natural_frequency=2.0 * pi * _number(values, Setting.FILTER_FREQUENCY, i),
                damping=_number(values, Setting.FILTER_DAMPING, i),
                width=_number(values, Setting.FILTER_WIDTH, i, missing=1.0),
            )
            for i in filters
        ),
    )


def judge_text(
    subject: Subject, values: Values, indices: Collection[str] = (), *, known: Held | None = None
) -> Judged:
    """Return what the settings that a text holds do to its axis.

    ``indices``: of the control's machining modes; ``known``: what it was filled in by.

    Raises InputError if a setting is missing, contradicts another, or the loop is unstable.
    """
    held, modes = hold(subject, values, known=known), subject.record.limits.modes
    written = {index for setting, index in held.values if setting in LIMITS}
    verdict = held.judge(held.limits())
    by_mode = [held.judge(held.limits(one.name), one) for one in modes if one.name in written]
    lost = _find_lost_margins(subject, held)
    met = all(found.assessment.is_met for found in (verdict, *by_mode))
    return Judged(
        held=held,
        verdict=verdict,
        left_out=tuple(mode for mode in modes if mode.name in indices and mode.name not in written),
        lost_margins=lost,
        is_met=met and not lost,
    )


def _find_lost_margins(subject: Subject, held: Held) -> Message | None:
    """The margins of the text's loop where they are poor and the record's were not."""
    worst = subject.record.loop.worst_corner
    had = (
        worst is not None
        and (worst.gain_margin_db or inf) >= ROUNDED_MARGINS.gain_margin_db
        and (worst.phase_margin_deg or inf) >= ROUNDED_MARGINS.phase_margin_deg
        and worst.sensitivity_peak <= ROUNDED_MARGINS.sensitivity_peak
    )
    analyses = held.tuned.analyses
    if not had or all(has_margins(one, settings=ROUNDED_MARGINS) for one in analyses):
        return None
    return Message("export-margins-lost", margins=describe_margins(analyses))
