"""Every promise of the record against one recorded move."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import hypot, inf, isfinite, pi, sqrt

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements import SETTLING_TIME, bounded_states
from mtcommission.measured.measurement import Array
from mtcommission.record.record import Record
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verify.beside import Beside, Recorded, allowed_shift
from mtcommission.verify.checks import KEPT, Check, Verdict, judge, judged
from mtcommission.verify.prediction import ENCODER, TOOL, Rebuilt
from mtcommission.verify.setpoint import check_planner
from mtcommission.verify.trace import Role

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
    promise = _Promises(rebuilt, record, recorded)
    units, cut = rebuilt.machine.axis_units, Message("verify-cut")
    is_cut = recorded.motion.is_cut
    # Of a move that goes on nobody knows the plan: it reaches less than the whole one.
    plan = None if is_cut else recorded.motion.plan
    is_known = recorded.number > 0
    planner = check_planner(recorded.motion, plan, entered, units, is_known=is_known)
    if is_cut:
        planner = [one if one.fails else one.unknown(cut) for one in planner]
    kept = [*promise.positions(), *promise.forces(), *promise.states()]
    if is_cut:
        kept = [check.doubted(cut) for check in kept]
    if any(one.fails for one in planner):
        kept = [check.doubted(Message("verify-other-setpoint")) for check in kept]
    return (*planner, *kept, *promise.delay(), *promise.modes())


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if values.size else inf


@dataclass(frozen=True, slots=True)
class _Promises:
    """A recorded move, and the record that promises something of it."""

    rebuilt: Rebuilt
    record: Record
    recorded: Recorded

    @property
    def number(self) -> int:
        return self.recorded.number

    @property
    def promised_settling(self) -> float:
        """What the requirement allows, or else the slowest corner of the record [s]."""
        required = SETTLING_TIME.bound(self.rebuilt.machine)
        if isfinite(required) or not self.number:
            return required
        move = self.record.moves[self.number - 1]
        times = [entry.settling_time for entry in (move.response, *move.corners)]
        slowest = max((time for time in times if time is not None), default=inf)
        # Nobody knows whether the axis is late, or its column.
        late = max(self.recorded.applied_shift, 0.0)
        return slowest + late + 2.0 * self.recorded.motion.blur

    @property
    def hidden_mode(self) -> str:
        """The first mode that tool and encoder show differently; "" for none."""
        return next(
            (
                mode.name
                for mode in self.rebuilt.plant.modes
                if abs(mode.tcp_gain - mode.measured_gain) > VISIBLE * abs(mode.measured_gain)
            ),
            "",
        )

    def positions(self) -> list[Check]:
        """Settling time, residual and peak of the tool."""
        machine, recorded, motion = self.rebuilt.machine, self.recorded, self.recorded.motion
        unit, band = machine.axis_units.length.si, machine.requirements.tcp_deviation
        one = recorded.find(Role.TOOL) or recorded.find(Role.ENCODER)
        promised = self.promised_settling
        if one is None:
            missing = partial(Check, move=self.number, reason=Message("verify-no-tool"))
            limit = promised if isfinite(promised) else None
            return [
                missing(key="settling time", unit="s", limit=limit, decides=True),
                missing(key="residual deviation", unit=unit, limit=band, decides=True),
            ]
        # What the shift leaves open is a way, if the setpoint still moves.
        apart = abs(motion.final_velocity) * recorded.shift_error if motion.coasts else 0.0
        apart = apart if isfinite(apart) else 0.0
        noise, slack = one.noise + apart, one.slack + apart
        row = partial(judged, move=self.number)
        settled = partial(self._settling, one, one.deviation)
        settling, earliest, latest = map(settled, (band, band + noise, band - slack))
        off = max(settling - earliest, latest - settling, one.step) + motion.blur
        earliest, latest = earliest - motion.blur, latest + motion.blur
        checks = [
            row(
                "settling time",
                "s",
                judge(earliest, latest, -inf, promised),
                predicted=[self._settling(one, values, band) for values in one.predicted],
                seen=(settling, off),
                limit=promised,
            )
        ]
        for key, flags, limit in (
            ("residual deviation", one.after(self.recorded.rest), band),
            ("peak deviation", one.t >= motion.begin, machine.requirements.contour_deviation),
        ):
            predicted = [_largest(values[flags]) for values in one.predicted]
            value, is_limited = _largest(one.deviation[flags]), isfinite(limit)
            bound = limit if is_limited else max(predicted) * (1.0 + MODEL_ERROR)
            verdict = judge(value - noise, value + slack, -inf, bound)
            checks.append(
                row(
                    key,
                    unit,
                    verdict,
                    predicted=predicted,
                    seen=(value, noise),
                    limit=limit,
                    decides=is_limited,
                )
            )
        hidden = one.role is not Role.TOOL and self.hidden_mode
        if doubt := self._doubt(one, band, noise):
            checks[:2] = [_in_doubt(check, doubt, one, band) for check in checks[:2]]
        if hidden:
            checks[2] = checks[2].doubted(Message("verify-encoder-only", mode=hidden))
        if not self.number:
            checks[0] = checks[0].doubted(Message("verify-other-move"))
        return checks

    def _settling(self, one: Beside, values: Array, limit: float) -> float:
        """Time from the start until a deviation stays within a limit; inf: never."""
        after = one.after(self.recorded.rest)
        outside = np.flatnonzero(np.abs(values[after]) > limit)
        if limit <= 0.0 or (outside.size and outside[-1] == after.sum() - 1):
            return inf
        settled = float(one.t[after][outside[-1] + 1]) if outside.size else self.recorded.rest
        return settled - self.recorded.motion.begin

    def _doubt(self, one: Beside, band: float, noise: float) -> Message | None:
        """What forbids to say that the band is kept; None: nothing."""
        length = self.recorded.motion.until - self.recorded.rest
        rates = [mode.damping_ratio * mode.natural_frequency for mode in self.rebuilt.plant.modes]
        needed = DECAY_TIMES / min(rates) if rates else 0.0
        if length < needed:
            return Message("verify-too-short", got=max(length, 0.0), needed=needed)
        if noise > band:
            return Message("verify-noise-above-band", noise=noise, band=band)
        if one.role is not Role.TOOL and (hidden := self.hidden_mode):
            foreseen = self.recorded.prediction
            apart = foreseen.outputs[:, :, TOOL] - foreseen.outputs[:, :, ENCODER]
            if (
                float(np.abs(apart[:, foreseen.t >= self.recorded.rest]).max(initial=0.0))
                > HIDDEN * band
            ):
                return Message("verify-encoder-only", mode=hidden)
        return None

    def forces(self) -> list[Check]:
        """Largest and RMS force."""
        drive, unit = self.rebuilt.machine.drive, self.rebuilt.machine.axis_units.force.si
        limit, is_limited = drive.continuous_force, isfinite(drive.continuous_force)
        one, motion, number = self.recorded.find(Role.FORCE), self.recorded.motion, self.number
        stop = motion.end + (self.rebuilt.machine.moves[number - 1].dwell if number else 0.0)
        if one is None or not (one.after(motion.begin) & (one.t <= stop)).any():
            shows = not drive.follows  # a motor that follows has no force anybody could record
            missing = partial(Check, move=number, unit=unit, reason=Message("verify-no-force"))
            rms = limit if is_limited else None
            return [
                missing(key="max force", limit=drive.max_force, decides=shows),
                missing(key="RMS force", limit=rms, decides=shows and is_limited),
            ]
        row = partial(judged, unit=unit, move=number)
        load, moving = abs(drive.static_load), one.after(motion.begin)
        value, noise = float(np.abs(one.raw[moving]).max()), one.noise
        first = row(
            "max force",
            verdict=judge(value - noise, value + noise, -inf, drive.max_force),
            predicted=np.abs(one.predicted[:, moving]).max(axis=1) + load,
            seen=(value, noise),
            limit=drive.max_force,
        )
        window = moving & (one.t <= stop)
        squares = [*np.mean(one.predicted[:, window] ** 2, axis=1), np.mean(one.raw[window] ** 2)]
        *foreseen, measured = (sqrt(one) for one in squares)
        predicted = [hypot(value, load) for value in foreseen]
        error = noise / sqrt(max(int(window.sum()), 1))
        bound = limit if is_limited else max(predicted) * (1.0 + MODEL_ERROR)
        second = row(
            "RMS force",
            verdict=judge(measured - error, measured + error, -inf, bound),
            predicted=predicted,
            seen=(measured, error),
            limit=limit,
            decides=is_limited,
        )
        if not number:
            second = second.unknown(Message("verify-other-move"))
        elif stop > motion.until + one.step:
            got, needed = motion.until - motion.begin, stop - motion.begin
            second = second.unknown(Message("verify-dwell-not-recorded", got=got, needed=needed))
            # Even without any force in what was not recorded, the mean over all is this large.
            if (measured - error) * sqrt(got / needed) > bound:
                fails = Verdict.FAILS
                second = replace(second, verdict=fails, reason=KEPT[fails])
        return [first, second]

    def states(self) -> Iterator[Check]:
        """What is required of the plant's states, which no control records."""
        machine, plant = self.rebuilt.machine, self.rebuilt.plant
        for one, _ in bounded_states(machine, plant):
            yield Check(
                key=one.key,
                move=self.number,
                unit=one.unit(machine, plant),
                limit=one.bound(machine),
                reason=Message("verify-no-state"),
                decides=True,
            )

    def delay(self) -> Iterator[Check]:
        """When the position follows, against τ."""
        recorded, error = self.recorded, self.recorded.shift_error
        if not isfinite(error):
            return
        tau = self.rebuilt.controller.reference_delay
        slack, measured = allowed_shift(self.rebuilt, recorded.trace), tau + recorded.shift
        check = judged(
            "reference delay",
            "s",
            judge(measured - error, measured + error, tau - slack, tau + slack),
            predicted=[tau, tau - slack, tau + slack],
            seen=(measured, error),
            decides=False,
        )
        if recorded.trace.is_delayed:
            check = check.unknown(Message("verify-delay-not-recorded"))
            check = replace(check, measured=None, uncertainty=None)
        yield check

    def modes(self) -> Iterator[Check]:
        """Frequency and damping of each mode in the closed loop."""
        plant, all_poles = self.rebuilt.plant, self.rebuilt.poles.T
        for mode, poles, seen in zip(plant.modes, all_poles, self.recorded.modes, strict=True):
            hertz, zetas = np.abs(poles) / (2 * pi), -poles.real / np.abs(poles)
            row = partial(judged, mode=mode.name, decides=False)
            if seen is None:
                none, reason = Verdict.UNKNOWN, Message("verify-mode-not-seen")
                nothing = inf, inf
                yield row("frequency", "Hz", none, predicted=hertz, seen=nothing).unknown(reason)
                yield row("damping ratio", "", none, predicted=zetas, seen=nothing).unknown(reason)
                continue
            f, zeta = seen.frequency_hz, seen.damping_ratio
            low, high, slack = hertz.min(), hertz.max(), FREQUENCY_ERROR * f.value
            error = 2.0 * f.sigma + slack
            verdict = judge(f.value - error, f.value + error, low, high)
            if low - slack <= f.value <= high + slack:
                verdict = Verdict.HOLDS  # what was calculated is not known better than that
            yield row("frequency", "Hz", verdict, predicted=hertz, seen=(f.value, error))
            # More damping than promised does no harm.
            error = 2.0 * zeta.sigma
            verdict = judge(zeta.value, zeta.value + 2.0 * error, zetas.min(), inf)
            yield row("damping ratio", "", verdict, predicted=zetas, seen=(zeta.value, error))


def _in_doubt(check: Check, doubt: Message, one: Beside, band: float) -> Check:
    """A verdict that cannot be given, unless it fails whatever is in doubt."""
    fails = check.fails
    if doubt.kind == "verify-encoder-only":
        # A deviation that the encoder itself shows as a steady one is there at the tool, too.
        tail = one.deviation[-max(one.deviation.size // 4, 1) :]
        fails = fails and abs(float(tail.mean())) > band + one.noise
    elif doubt.kind == "verify-too-short":
        fails = fails and check.key != "settling time"
    return check if fails else check.unknown(doubt)
