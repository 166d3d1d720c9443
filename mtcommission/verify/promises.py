"""One recorded move against the promises of the record."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, inf, isfinite, pi, sqrt

import numpy as np

from mtcommission.messages.message import Message
from mtcommission.record.record import Record
from mtcommission.requirements.settling_time import SETTLING_TIME
from mtcommission.requirements.together import bounded_states
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verify.beside import Beside
from mtcommission.verify.checks import Check, Verdict, at_most, within
from mtcommission.verify.dwell import needed_dwell, settle
from mtcommission.verify.motions import Recorded, allowed_shift
from mtcommission.verify.planner import check_planner
from mtcommission.verify.prediction import ENCODER, TOOL, Rebuilt
from mtcommission.verify.trace import Array, Role

MODEL_ERROR = 0.1
"""By how much a peak may exceed what the linear model says before the model is wrong (empirical:
what sampling and the smoothing of the setpoint leave open)."""

VISIBLE = 0.1
"""Relative difference of a mode at tool and encoder up to which one shows the other."""

HIDDEN = 0.05
"""Share of the band that a mode which the encoder does not show may have at the tool."""

FREQUENCY_ERROR = 0.005
"""Of a free vibration under a loop that is only nearly linear (empirical)."""


def check_recorded(
    rebuilt: Rebuilt, record: Record, entered: MotionLimits, recorded: Recorded
) -> tuple[Check, ...]:
    """Return every check of one recorded move, the setpoint's first."""
    units = rebuilt.machine.axis_units
    is_cut = recorded.motion.is_cut
    # Of a move that goes on nobody knows the plan: it reaches less than the whole one.
    plan = None if is_cut else recorded.setpoint
    planner = check_planner(recorded.motion, plan, entered, units)
    if is_cut:
        reason = Message("verify-cut")
        planner = tuple(
            one if _fails(one) else replace(one, verdict=Verdict.UNKNOWN, reason=reason)
            for one in planner
        )
    disobeys = any(map(_fails, planner))
    motion = [
        *_position_checks(rebuilt, record, recorded),
        *_force_checks(rebuilt, recorded),
        *_state_checks(rebuilt, recorded),
    ]
    if is_cut:
        motion = [_unknown(check, Message("verify-cut")) for check in motion]
    if disobeys:
        motion = [_unknown(check, Message("verify-other-setpoint")) for check in motion]
    return (*planner, *motion, *_delay_check(rebuilt, recorded), *_mode_checks(rebuilt, recorded))


def _fails(check: Check) -> bool:
    return check.verdict is Verdict.FAILS


def _unknown(check: Check, reason: Message) -> Check:
    if check.verdict is Verdict.UNKNOWN:
        return check
    return replace(check, verdict=Verdict.UNKNOWN, reason=reason)


def _position_checks(rebuilt: Rebuilt, record: Record, recorded: Recorded) -> list[Check]:
    """Settling time, residual and peak of the tool."""
    needs, tau = rebuilt.machine.requirements, rebuilt.controller.reference_delay
    motion, unit = recorded.motion, rebuilt.machine.axis_units.length.si
    band = needs.tcp_deviation
    tool = recorded.find(Role.TOOL)
    one = tool or recorded.find(Role.ENCODER)
    promised = _promised_settling(rebuilt, record, recorded)
    if one is None:
        nothing = Message("verify-no-tool")
        return [
            _row("settling time", recorded, None, None, promised, "s", None, nothing, decides=True),
            _row("residual deviation", recorded, None, None, band, unit, None, nothing,
                 decides=True),
        ]  # fmt: skip
    rest, begin = motion.end + tau + recorded.applied_shift, motion.begin

    def judged(values: Array, noise: float, slack: float) -> tuple[float, ...]:
        found = settle(one.t, values, begin=begin, rest=rest, band=band, noise=noise, slack=slack)
        return found.settling, found.residual, found.peak, found.earliest, found.latest

    # What the shift leaves open is a way, if the setpoint still moves.
    apart = abs(motion.final_velocity) * recorded.shift_error if motion.coasts else 0.0
    apart = apart if isfinite(apart) else 0.0
    noise, slack = one.noise + apart, one.slack + apart
    rows = [judged(row, 0.0, 0.0) for row in one.predicted_deviation]
    settling, residual, peak, earliest, latest = judged(one.deviation, noise, slack)
    doubt = _doubt(rebuilt, recorded, one, rest=rest, band=band, noise=noise)
    spread = [tuple(column) for column in zip(*rows, strict=True)]
    checks = []
    verdict = Verdict.FAILS if earliest > promised else Verdict.UNKNOWN
    if latest <= promised:
        verdict = Verdict.HOLDS
    error = max(settling - earliest, latest - settling, one.step) if isfinite(latest) else None
    checks.append(
        _row("settling time", recorded, spread[0], settling if isfinite(settling) else None,
             promised, "s", error, _reason(verdict), verdict=verdict, decides=True)
    )  # fmt: skip
    residual_verdict = at_most(residual, noise, band, slack=slack)
    checks.append(
        _row("residual deviation", recorded, spread[1], residual, band, unit, noise,
             _reason(residual_verdict), verdict=residual_verdict, decides=True)
    )  # fmt: skip
    if doubt is not None:
        checks = [_doubted(check, doubt, one, band) for check in checks]
    limit = needs.contour_deviation if isfinite(needs.contour_deviation) else None
    bound = limit or max(spread[2]) * (1.0 + MODEL_ERROR)
    peak_verdict = at_most(peak, noise, bound, slack=slack)
    checks.append(
        _row("peak deviation", recorded, spread[2], peak, limit, unit, noise,
             _reason(peak_verdict), verdict=peak_verdict, decides=limit is not None)
    )  # fmt: skip
    if tool is None:
        checks[-1] = _unknown(
            checks[-1], Message("verify-encoder-only", mode=_hidden_name(rebuilt))
        )
    if not recorded.number:
        reason = Message("verify-other-move")
        checks = [_unknown(checks[0], reason), *checks[1:]]
    return checks


def _promised_settling(rebuilt: Rebuilt, record: Record, recorded: Recorded) -> float:
    """What the requirement allows, or else the slowest corner of the record [s]."""
    required = SETTLING_TIME.bound(rebuilt.machine)
    if isfinite(required):
        return required
    if not recorded.number:
        return inf
    move = record.moves[recorded.number - 1]
    times = [entry.settling_time for entry in (move.response, *move.corners)]
    worst = max((time for time in times if time is not None), default=inf)
    return worst + 2.0 * recorded.motion.blur


def _row(
    key: str,
    recorded: Recorded,
    predicted: tuple[float, ...] | None,
    measured: float | None,
    limit: float | None,
    unit: str,
    uncertainty: float | None,
    reason: Message,
    *,
    verdict: Verdict = Verdict.UNKNOWN,
    decides: bool = False,
) -> Check:
    return Check(
        key=key,
        move=recorded.number,
        unit=unit,
        predicted=predicted[0] if predicted else None,
        low=min(predicted) if predicted else None,
        high=max(predicted) if predicted else None,
        limit=limit,
        measured=measured,
        uncertainty=uncertainty,
        verdict=verdict,
        reason=reason,
        decides=decides,
    )


def _reason(verdict: Verdict) -> Message:
    kind = {
        Verdict.HOLDS: "verify-kept",
        Verdict.FAILS: "verify-missed",
        Verdict.UNKNOWN: "verify-within-noise",
    }[verdict]
    return Message(kind)


def _doubt(
    rebuilt: Rebuilt,
    recorded: Recorded,
    one: Beside,
    *,
    rest: float,
    band: float,
    noise: float,
) -> Message | None:
    """What forbids to say that the band is kept; None: nothing."""
    length = recorded.motion.until - rest
    needed = needed_dwell(rebuilt)
    if length < needed:
        return Message("verify-too-short", got=max(length, 0.0), needed=needed)
    if noise > band:
        return Message("verify-noise-above-band", noise=noise, band=band)
    if one.role is not Role.TOOL and (hidden := _hidden_modes(rebuilt)):
        prediction = recorded.prediction
        apart = prediction.outputs[:, :, TOOL] - prediction.outputs[:, :, ENCODER]
        if float(np.abs(apart[:, prediction.t >= rest]).max(initial=0.0)) > HIDDEN * band:
            return Message("verify-encoder-only", mode=hidden[0])
    return None


def _hidden_modes(rebuilt: Rebuilt) -> list[str]:
    """Modes that the tool and the encoder show differently."""
    return [
        mode.name
        for mode in rebuilt.plant.modes
        if abs(mode.tcp_gain - mode.measured_gain) > VISIBLE * abs(mode.measured_gain)
    ]


def _hidden_name(rebuilt: Rebuilt) -> str:
    return (_hidden_modes(rebuilt) or [""])[0]


def _doubted(check: Check, doubt: Message, one: Beside, band: float) -> Check:
    """A verdict that cannot be given: all of them by noise, "holds" by a short or other signal.

    A deviation that the encoder itself shows as a steady one is there at the tool, too.
    """
    if doubt.kind == "verify-encoder-only" and check.verdict is Verdict.FAILS:
        tail = one.deviation[-max(one.deviation.size // 4, 1) :]
        if abs(float(tail.mean())) > band + one.noise:
            return check
        return replace(check, verdict=Verdict.UNKNOWN, reason=doubt)
    if check.verdict is Verdict.FAILS and check.key != "settling time":
        return check
    if check.verdict is Verdict.FAILS and doubt.kind == "verify-noise-above-band":
        return check
    return replace(check, verdict=Verdict.UNKNOWN, reason=doubt)


def _force_checks(rebuilt: Rebuilt, recorded: Recorded) -> list[Check]:
    """Largest and RMS force."""
    drive, unit = rebuilt.machine.drive, rebuilt.machine.axis_units.force.si
    shows_force = not drive.follows  # a motor that follows has no force anybody could record
    one, motion = recorded.find(Role.FORCE), recorded.motion
    if one is None:
        reason, limit = Message("verify-no-force"), _finite(drive.continuous_force)
        return [
            _row("max force", recorded, None, None, drive.max_force, unit, None, reason,
                 decides=shows_force),
            _row("RMS force", recorded, None, None, limit, unit, None, reason,
                 decides=shows_force and limit is not None),
        ]  # fmt: skip
    load = abs(drive.static_load)
    moving = one.after(motion.begin)
    largest = tuple(float(np.abs(row[moving]).max()) + load for row in one.predicted)
    value = float(np.abs(one.raw[moving]).max())
    verdict = at_most(value, one.noise, drive.max_force)
    checks = [
        _row("max force", recorded, largest, value, drive.max_force, unit, one.noise,
             _reason(verdict), verdict=verdict, decides=True)
    ]  # fmt: skip
    dwell = rebuilt.machine.moves[recorded.number - 1].dwell if recorded.number else 0.0
    stop = motion.end + dwell
    window = moving & (one.t <= stop)
    rms = tuple(hypot(float(np.sqrt(np.mean(row[window] ** 2))), load) for row in one.predicted)
    measured = float(np.sqrt(np.mean(one.raw[window] ** 2)))
    error = one.noise / sqrt(max(int(window.sum()), 1))
    limit = _finite(drive.continuous_force)
    bound = limit if limit is not None else max(rms) * (1.0 + MODEL_ERROR)
    verdict = at_most(measured, error, bound)
    reason = _reason(verdict)
    if not recorded.number:
        verdict, reason = Verdict.UNKNOWN, Message("verify-other-move")
    elif stop > motion.until + one.step:
        got, needed = motion.until - motion.begin, stop - motion.begin
        # Even without any force in what was not recorded, the mean over all of it is this large.
        if (measured - error) * sqrt(got / needed) > bound:
            verdict, reason = Verdict.FAILS, Message("verify-missed")
        else:
            verdict = Verdict.UNKNOWN
            reason = Message("verify-dwell-not-recorded", got=got, needed=needed)
    checks.append(
        _row("RMS force", recorded, rms, measured, limit, unit, error, reason, verdict=verdict,
             decides=limit is not None)
    )  # fmt: skip
    return checks


def _state_checks(rebuilt: Rebuilt, recorded: Recorded) -> list[Check]:
    """What is required of the plant's states, which no control records."""
    machine, plant, reason = rebuilt.machine, rebuilt.plant, Message("verify-no-state")
    return [
        _row(one.key, recorded, None, None, one.bound(machine), one.unit(machine, plant), None,
             reason, decides=True)
        for one, _ in bounded_states(machine, plant)
    ]  # fmt: skip


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _delay_check(rebuilt: Rebuilt, recorded: Recorded) -> list[Check]:
    """When the position follows, against τ."""
    if not isfinite(recorded.shift_error):
        return []
    tau, slack = rebuilt.controller.reference_delay, allowed_shift(rebuilt, recorded.trace)
    measured = error = None
    verdict, reason = Verdict.UNKNOWN, Message("verify-delay-not-recorded")
    if not recorded.trace.is_delayed:
        measured, error = tau + recorded.shift, recorded.shift_error
        verdict = within(measured, error, tau - slack, tau + slack)
        reason = _reason(verdict)
    return [
        Check(
            key="reference delay",
            unit="s",
            predicted=tau,
            low=tau - slack,
            high=tau + slack,
            measured=measured,
            uncertainty=error,
            verdict=verdict,
            reason=reason,
        )
    ]


def _mode_checks(rebuilt: Rebuilt, recorded: Recorded) -> list[Check]:
    """Frequency and damping of each mode in the closed loop."""
    checks = []
    for mode, poles, seen in zip(rebuilt.plant.modes, rebuilt.poles.T, recorded.modes, strict=True):
        hertz = tuple(float(f) for f in np.abs(poles) / (2 * pi))
        zetas = tuple(float(z) for z in -poles.real / np.abs(poles))
        for key, values, unit in (("frequency", hertz, "Hz"), ("damping ratio", zetas, "")):
            low, high = min(values), max(values)
            measured = error = None
            verdict, reason = Verdict.UNKNOWN, Message("verify-mode-not-seen")
            if seen is not None and key == "frequency":
                measured = seen.frequency_hz
                slack = FREQUENCY_ERROR * measured
                error = 2.0 * seen.frequency_sigma_hz + slack
                verdict = within(measured, error, low, high)
                if low - slack <= measured <= high + slack:
                    verdict = Verdict.HOLDS  # what was calculated is not known better than that
                reason = _reason(verdict)
            elif seen is not None:
                measured, error = seen.damping_ratio, 2.0 * seen.damping_sigma
                # More damping than promised does no harm.
                verdict = at_most(-measured, error, -low + error)
                reason = _reason(verdict)
            checks.append(
                Check(
                    key=key,
                    mode=mode.name,
                    unit=unit,
                    predicted=values[0],
                    low=low,
                    high=high,
                    measured=measured,
                    uncertainty=error,
                    verdict=verdict,
                    reason=reason,
                )
            )
    return checks
