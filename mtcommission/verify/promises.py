"""Every promise of the record against one recorded move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import hypot, inf, isfinite, pi, sqrt

import numpy as np

from mtcommission.messages.message import Message
from mtcommission.record.record import Record
from mtcommission.requirements.settling_time import SETTLING_TIME
from mtcommission.requirements.together import bounded_states
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verify.beside import Beside, Recorded, allowed_shift
from mtcommission.verify.checks import KEPT, Check, Verdict, judge
from mtcommission.verify.columns import Role
from mtcommission.verify.planner import check_planner
from mtcommission.verify.prediction import ENCODER, TOOL, Rebuilt
from mtcommission.verify.trace import Array

MODEL_ERROR = 0.1
"""By how much a peak may exceed what the linear model says before the model is wrong (empirical:
what sampling and the smoothing of the setpoint leave open)."""

VISIBLE = 0.1
"""Relative difference of a mode at tool and encoder up to which one shows the other."""

HIDDEN = 0.05
"""Share of the band that a mode which the encoder does not show may have at the tool."""

FREQUENCY_ERROR = 0.005
"""Of a free vibration under a loop that is only nearly linear (empirical)."""

DECAY_TIMES = 4.0
"""Time constants 1/(ζ ω) of the slowest mode that must be seen of a dwell."""


def check_recorded(
    rebuilt: Rebuilt, record: Record, entered: MotionLimits, recorded: Recorded
) -> tuple[Check, ...]:
    """Return every check of one recorded move, the setpoint's first."""
    units, cut = rebuilt.machine.axis_units, Message("verify-cut")
    is_cut = recorded.motion.is_cut
    # Of a move that goes on nobody knows the plan: it reaches less than the whole one.
    plan = None if is_cut else recorded.setpoint
    planner = check_planner(recorded.motion, plan, entered, units)
    if is_cut:
        planner = [one if _fails(one) else _unknown(one, cut) for one in planner]
    promises = [
        *_position_checks(rebuilt, record, recorded),
        *_force_checks(rebuilt, recorded),
        *_state_checks(rebuilt, recorded),
    ]
    if is_cut:
        promises = [check.doubted(cut) for check in promises]
    if any(map(_fails, planner)):
        promises = [check.doubted(Message("verify-other-setpoint")) for check in promises]
    return (
        *planner,
        *promises,
        *_delay_check(rebuilt, recorded),
        *_mode_checks(rebuilt, recorded),
    )


def _fails(check: Check) -> bool:
    return check.verdict is Verdict.FAILS


def _unknown(check: Check, reason: Message) -> Check:
    return replace(check, verdict=Verdict.UNKNOWN, reason=reason)


def _row(
    move: int,
    key: str,
    unit: str,
    predicted: Sequence[float],
    verdict: Verdict,
    *,
    measured: float,
    uncertainty: float,
    limit: float,
    decides: bool = True,
) -> Check:
    return Check(
        key=key,
        move=move,
        unit=unit,
        predicted=_finite(predicted[0]),
        low=_finite(min(predicted)),
        high=_finite(max(predicted)),
        limit=_finite(limit),
        measured=_finite(measured),
        uncertainty=_finite(uncertainty),
        verdict=verdict,
        reason=KEPT[verdict],
        decides=decides,
    )


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


# Positions


def _position_checks(rebuilt: Rebuilt, record: Record, recorded: Recorded) -> list[Check]:
    """Settling time, residual and peak of the tool."""
    needs, number = rebuilt.machine.requirements, recorded.number
    motion, unit, band = recorded.motion, rebuilt.machine.axis_units.length.si, needs.tcp_deviation
    one = recorded.find(Role.TOOL) or recorded.find(Role.ENCODER)
    promised = _promised_settling(rebuilt, record, recorded)
    if one is None:
        missing = partial(Check, move=number, reason=Message("verify-no-tool"), decides=True)
        return [
            missing(key="settling time", unit="s", limit=_finite(promised)),
            missing(key="residual deviation", unit=unit, limit=band),
        ]
    rest = motion.end + rebuilt.controller.reference_delay + recorded.applied_shift
    # What the shift leaves open is a way, if the setpoint still moves.
    apart = abs(motion.final_velocity) * recorded.shift_error if motion.coasts else 0.0
    apart = apart if isfinite(apart) else 0.0
    noise, slack = one.noise + apart, one.slack + apart
    row = partial(_row, number)

    settled = partial(_settling, one, motion.begin, rest)
    settling, earliest, latest = (
        settled(one.deviation, limit) for limit in (band, band + noise, band - slack)
    )
    checks = [
        row(
            "settling time",
            "s",
            [settled(values, band) for values in one.predicted],
            judge(earliest, latest, -inf, promised),
            measured=settling,
            uncertainty=max(settling - earliest, latest - settling, one.step),
            limit=promised,
        )
    ]
    for key, flags, limit in (
        ("residual deviation", one.after(rest), band),
        ("peak deviation", one.t >= motion.begin, needs.contour_deviation),
    ):
        predicted = [_largest(values[flags]) for values in one.predicted]
        value = _largest(one.deviation[flags])
        bound = limit if isfinite(limit) else max(predicted) * (1.0 + MODEL_ERROR)
        verdict = judge(value - noise, value + slack, -inf, bound)
        checks.append(
            row(key, unit, predicted, verdict, measured=value, uncertainty=noise, limit=limit,
                decides=isfinite(limit))
        )  # fmt: skip
    hidden = one.role is not Role.TOOL and _hidden_mode(rebuilt)
    if doubt := _doubt(rebuilt, recorded, one, rest=rest, band=band, noise=noise):
        checks[:2] = [_doubted(check, doubt, one, band) for check in checks[:2]]
    if hidden:
        checks[2] = checks[2].doubted(Message("verify-encoder-only", mode=hidden))
    if not number:
        checks[0] = checks[0].doubted(Message("verify-other-move"))
    return checks


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if values.size else inf


def _settling(one: Beside, begin: float, rest: float, values: Array, limit: float) -> float:
    """Time from the start of the setpoint until a deviation stays within a limit; inf: never."""
    after = one.after(rest)
    outside = np.flatnonzero(np.abs(values[after]) > limit)
    if limit <= 0.0 or (outside.size and outside[-1] == after.sum() - 1):
        return inf
    return float(one.t[after][outside[-1] + 1] if outside.size else rest) - begin


def _promised_settling(rebuilt: Rebuilt, record: Record, recorded: Recorded) -> float:
    """What the requirement allows, or else the slowest corner of the record [s]."""
    required = SETTLING_TIME.bound(rebuilt.machine)
    if isfinite(required) or not recorded.number:
        return required
    move = record.moves[recorded.number - 1]
    times = [entry.settling_time for entry in (move.response, *move.corners)]
    slowest = max((time for time in times if time is not None), default=inf)
    return slowest + 2.0 * recorded.motion.blur


def _doubt(
    rebuilt: Rebuilt, recorded: Recorded, one: Beside, *, rest: float, band: float, noise: float
) -> Message | None:
    """What forbids to say that the band is kept; None: nothing."""
    length = recorded.motion.until - rest
    rates = [mode.damping_ratio * mode.natural_frequency for mode in rebuilt.plant.modes]
    needed = DECAY_TIMES / min(rates) if rates else 0.0
    if length < needed:
        return Message("verify-too-short", got=max(length, 0.0), needed=needed)
    if noise > band:
        return Message("verify-noise-above-band", noise=noise, band=band)
    if one.role is not Role.TOOL and (hidden := _hidden_mode(rebuilt)):
        prediction = recorded.prediction
        apart = prediction.outputs[:, :, TOOL] - prediction.outputs[:, :, ENCODER]
        if float(np.abs(apart[:, prediction.t >= rest]).max(initial=0.0)) > HIDDEN * band:
            return Message("verify-encoder-only", mode=hidden)
    return None


def _hidden_mode(rebuilt: Rebuilt) -> str:
    """The first mode that tool and encoder show differently."""
    return next(
        (
            mode.name
            for mode in rebuilt.plant.modes
            if abs(mode.tcp_gain - mode.measured_gain) > VISIBLE * abs(mode.measured_gain)
        ),
        "",
    )


def _doubted(check: Check, doubt: Message, one: Beside, band: float) -> Check:
    """A verdict that cannot be given, unless it fails whatever is in doubt."""
    fails = _fails(check)
    if doubt.kind == "verify-encoder-only":
        # A deviation that the encoder itself shows as a steady one is there at the tool, too.
        tail = one.deviation[-max(one.deviation.size // 4, 1) :]
        fails = fails and abs(float(tail.mean())) > band + one.noise
    elif doubt.kind == "verify-too-short":
        fails = fails and check.key != "settling time"
    return check if fails else _unknown(check, doubt)


# Forces and states


def _force_checks(rebuilt: Rebuilt, recorded: Recorded) -> list[Check]:
    """Largest and RMS force."""
    drive, unit = rebuilt.machine.drive, rebuilt.machine.axis_units.force.si
    limit, is_limited = drive.continuous_force, isfinite(drive.continuous_force)
    one, motion, number = recorded.find(Role.FORCE), recorded.motion, recorded.number
    stop = motion.end + (rebuilt.machine.moves[number - 1].dwell if number else 0.0)
    if one is None or not (one.after(motion.begin) & (one.t <= stop)).any():
        shows = not drive.follows  # a motor that follows has no force anybody could record
        missing = partial(Check, move=number, unit=unit, reason=Message("verify-no-force"))
        return [
            missing(key="max force", limit=drive.max_force, decides=shows),
            missing(key="RMS force", limit=_finite(limit), decides=shows and is_limited),
        ]
    row = partial(_row, number)
    load, moving = abs(drive.static_load), one.after(motion.begin)
    largest = np.abs(one.predicted[:, moving]).max(axis=1) + load
    value = float(np.abs(one.raw[moving]).max())
    verdict = judge(value - one.noise, value + one.noise, -inf, drive.max_force)
    first = row("max force", unit, largest.tolist(), verdict, measured=value,
                uncertainty=one.noise, limit=drive.max_force)  # fmt: skip
    window = moving & (one.t <= stop)
    rms = [hypot(float(np.sqrt(np.mean(values[window] ** 2))), load) for values in one.predicted]
    measured = float(np.sqrt(np.mean(one.raw[window] ** 2)))
    error = one.noise / sqrt(max(int(window.sum()), 1))
    bound = limit if is_limited else max(rms) * (1.0 + MODEL_ERROR)
    verdict = judge(measured - error, measured + error, -inf, bound)
    second = row("RMS force", unit, rms, verdict, measured=measured, uncertainty=error,
                 limit=limit, decides=is_limited)  # fmt: skip
    if not number:
        second = _unknown(second, Message("verify-other-move"))
    elif stop > motion.until + one.step:
        got, needed = motion.until - motion.begin, stop - motion.begin
        # Even without any force in what was not recorded, the mean over all of it is this large.
        if (measured - error) * sqrt(got / needed) > bound:
            second = replace(second, verdict=Verdict.FAILS, reason=KEPT[Verdict.FAILS])
        else:
            second = _unknown(second, Message("verify-dwell-not-recorded", got=got, needed=needed))
    return [first, second]


def _state_checks(rebuilt: Rebuilt, recorded: Recorded) -> Iterator[Check]:
    """What is required of the plant's states, which no control records."""
    machine, plant = rebuilt.machine, rebuilt.plant
    for one, _ in bounded_states(machine, plant):
        yield Check(
            key=one.key,
            move=recorded.number,
            unit=one.unit(machine, plant),
            limit=one.bound(machine),
            reason=Message("verify-no-state"),
            decides=True,
        )


# Delay and modes


def _delay_check(rebuilt: Rebuilt, recorded: Recorded) -> Iterator[Check]:
    """When the position follows, against τ."""
    if not isfinite(recorded.shift_error):
        return
    tau, slack = rebuilt.controller.reference_delay, allowed_shift(rebuilt, recorded.trace)
    spread = [tau, tau - slack, tau + slack]
    measured, error = tau + recorded.shift, recorded.shift_error
    verdict = judge(measured - error, measured + error, tau - slack, tau + slack)
    check = _row(0, "reference delay", "s", spread, verdict, measured=measured,
                 uncertainty=error, limit=inf, decides=False)  # fmt: skip
    if recorded.trace.is_delayed:
        reason = Message("verify-delay-not-recorded")
        check = replace(_unknown(check, reason), measured=None, uncertainty=None)
    yield check


def _mode_checks(rebuilt: Rebuilt, recorded: Recorded) -> Iterator[Check]:
    """Frequency and damping of each mode in the closed loop."""
    for mode, poles, seen in zip(rebuilt.plant.modes, rebuilt.poles.T, recorded.modes, strict=True):
        hertz = (np.abs(poles) / (2 * pi)).tolist()
        zetas = (-poles.real / np.abs(poles)).tolist()
        for key, values, unit in (("frequency", hertz, "Hz"), ("damping ratio", zetas, "")):
            low, high = min(values), max(values)
            measured = error = inf
            verdict = Verdict.UNKNOWN
            if seen is not None and key == "frequency":
                measured = seen.frequency_hz
                slack = FREQUENCY_ERROR * measured
                error = 2.0 * seen.frequency_sigma_hz + slack
                verdict = judge(measured - error, measured + error, low, high)
                if low - slack <= measured <= high + slack:
                    verdict = Verdict.HOLDS  # what was calculated is not known better than that
            elif seen is not None:
                measured, error = seen.damping_ratio, 2.0 * seen.damping_sigma
                # More damping than promised does no harm.
                verdict = judge(measured, measured + 2.0 * error, low, inf)
            check = _row(0, key, unit, values, verdict, measured=measured, uncertainty=error,
                         limit=inf, decides=False)  # fmt: skip
            reason = check.reason if seen is not None else Message("verify-mode-not-seen")
            yield replace(check, mode=mode.name, reason=reason)
