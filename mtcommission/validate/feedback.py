"""Rows of secs. 3 and 7: the feedback loop, which is ours, and the conclusions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.optima import condense
from mtcommission.loop.simulate import LoopResponse, simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import VelocityStep
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_within
from mtcommission.study.loops import settle_on_loop
from mtcommission.validate.cases import Cases
from mtcommission.validate.paper import Claim, Row

MUCH_LARGER = 2.0
"""Ratio of times from which one is "much larger" [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Axis:
    """A machine with its loop tuned, and the limits recommended for it."""

    machine: Machine
    tuned: TunedLoop
    limits: MotionLimits

    def respond(self, limits: MotionLimits) -> LoopResponse:
        """Return the response of the nominal machine to a velocity step within some limits."""
        machine, move = self.machine, self.machine.moves[0]
        band = machine.requirements.tcp_deviation
        setpoint = plan_within(machine, limits)(move)
        return simulate(self.tuned.loops[0], setpoint, drive=machine.drive, band=band)

    def respond_to_rectangle(self) -> LoopResponse:
        """Return the response to the acceleration F_max / m without jerk limit."""
        mass = self.tuned.loops[0].plant.moving_mass
        largest = self.machine.drive.motion_force / mass
        return self.respond(without_jerk_limit(self.machine, largest))

    def overshoot(self, response: LoopResponse) -> float:
        """Return by how much the tool's velocity exceeds its target, relative to it."""
        plant, move = self.tuned.loops[0].plant, self.machine.moves[0]
        assert isinstance(move, VelocityStep)
        reached = float(np.max(response.states @ (plant.row("tcp") @ plant.A)))
        return max(reached / move.velocity_step - 1.0, 0.0)


def tune(machine: Machine) -> Axis:
    """Return a machine in the loop that is recommended for it, with its limits."""
    tuned = settle_on_loop(machine).tuned
    return Axis(machine=machine, tuned=tuned, limits=choose_limits(machine, tuned).limits)


def condensed(cases: Cases) -> list[MotionLimits]:
    """Return the limits closest to the time-optimal, bounded and damping-optimal control."""
    return [
        condense(best.move, cases.sample(best, count=500), velocity=cases.plant.velocity)
        for best in (cases.time, cases.bounded, cases.damping)
    ]


def feedback_rows(cases: Cases, axis: Axis) -> list[Row]:
    """Return the claims of sec. 3 on feedback control, beside our loop."""
    smooth, rough = axis.respond(axis.limits), axis.respond_to_rectangle()
    typical = [axis.overshoot(axis.respond(limits)) for limits in condensed(cases)]
    overshoot, least = axis.overshoot(rough), cases.time.t_f
    times = [smooth.settling_time, rough.settling_time]
    rates = [float(one.peaks[cases.plant.signals.index("v_phi")]) for one in (smooth, rough)]
    is_much = min(times) > MUCH_LARGER * least
    return [
        _active_damping(cases, axis, rough.settling_time),
        Claim(
            "overshoot", "3, (i)", "the terminal position is not attained precisely: overshooting"
        ).judged(
            holds=min(overshoot, *typical) > 0.01,
            rough=overshoot,
            smooth=axis.overshoot(smooth),
            least=min(typical),
            most=max(typical),
        ),
        Claim("transfer-time", "3, (ii)", "much larger than the minimal transfer time").judged(
            holds=is_much,
            refuted=not is_much,
            smooth=times[0],
            rough=times[1],
            smooth_share=times[0] / least,
            rough_share=times[1] / least,
            least=least,
            much=MUCH_LARGER,
        ),
        Claim(
            "jerk-control",
            "3",
            "optimum productivity with suitable damping for significant jerk control",
        ).judged(
            holds=times[0] < times[1] and rates[0] < rates[1],
            limits=_describe(axis.limits),
            smooth=rates[0],
            rough=rates[1],
        ),
        _jerk_follows(cases, axis),
    ]


def _describe(limits: MotionLimits) -> Message:
    return Message("paper-limits", acceleration=limits.acceleration, jerk=limits.jerk)


def _active_damping(cases: Cases, axis: Axis, settling: float) -> Row:
    """Give the loop a second encoder near the tool."""
    control = replace(axis.machine.control, has_tcp_sensor=True)
    sensed = tune(replace(axis.machine, control=control))
    times = settling, sensed.respond_to_rectangle().settling_time
    own = np.array([mode.damping_ratio for mode in cases.plant.modes])
    by_sensor, by_encoder = sensed.tuned.nominal.mode_damping, axis.tuned.nominal.mode_damping
    return Claim(
        "active-damping",
        "3",
        "possible with sensors quite near to the TCP, but the achievable damping is not sufficient",
    ).judged(
        holds=bool(np.all(by_sensor > own)) and min(times) > MUCH_LARGER * cases.time.t_f,
        base=own[0],
        tower=own[1],
        base_encoder=by_encoder[0],
        tower_encoder=by_encoder[1],
        base_sensed=by_sensor[0],
        tower_sensed=by_sensor[1],
        encoder=times[0],
        sensed=times[1],
    )


def _jerk_follows(cases: Cases, axis: Axis) -> Row:
    """Change one eigenfrequency at a time: the jerk must follow that of one mode."""
    told, jerks = dict[str, Any](), list[list[float]]()
    for i, name in enumerate(("base", "tower")):
        soft, stiff = (tune(_with_frequency(cases, name, factor)) for factor in (0.8, 1.25))
        axes = {f"{name}_soft": soft, name: axis, f"{name}_stiff": stiff}
        for at, one in axes.items():
            mode = one.tuned.loops[0].plant.modes[i]
            told[at], told[f"j_{at}"] = mode.natural_frequency / (2.0 * np.pi), one.limits.jerk
        jerks.append([one.limits.jerk for one in axes.values()])
    growth = [log(max(each) / min(each)) for each in jerks]
    leading = jerks[int(np.argmax(growth))]
    return Claim(
        "jerk-follows",
        "3",
        "the eigenfrequency of the dominating mode; no commissioning rules up to now",
    ).judged(holds=leading == sorted(leading) and max(growth) > 2.0 * min(growth), **told)


def _with_frequency(cases: Cases, mode: str, factor: float) -> Machine:
    """Return the machine with one eigenfrequency changed, its damping ratio kept."""
    m = cases.mechanics
    if mode == "base":
        k, d = factor**2 * m.base_stiffness, factor * m.base_damping
        return replace(cases.machine, mechanics=replace(m, base_stiffness=k, base_damping=d))
    k, d = factor**2 * m.rotary_stiffness, factor * m.rotary_damping
    return replace(cases.machine, mechanics=replace(m, rotary_stiffness=k, rotary_damping=d))


def conclusion_rows(cases: Cases, axis: Axis) -> list[Row]:
    """Return the conclusions of sec. 7, beside ours."""
    free, bounded = (cases.peak(best, "v_phi") for best in (cases.time, cases.bounded))
    hints = condensed(cases)
    jerks, settling = [limits.jerk for limits in hints], axis.respond(axis.limits).settling_time
    soonest = min(axis.respond(limits).settling_time for limits in hints)
    return [
        Claim("bounds-damp", "7", "significantly improved by suitable state constraints").judged(
            holds=bounded < 0.5 * free,
            less=1.0 - bounded / free,
            longer=cases.bounded.t_f / cases.time.t_f - 1.0,
        ),
        Claim("hints", "7", "concrete hints for suitable jerk limitations").judged(
            holds=settling >= soonest,
            refuted=settling < soonest and axis.limits.jerk < min(jerks),
            free=jerks[0],
            bounded=jerks[1],
            damped=jerks[2],
            soonest=soonest,
            limits=_describe(axis.limits),
            settling=settling,
        ),
    ]
