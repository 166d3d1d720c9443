"""Rows of secs. 3 and 7: the feedback loop, which is ours, and the conclusions."""

from __future__ import annotations

from dataclasses import replace
from math import log
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.commission.recommend import Recommendation, recommend
from mtcommission.limits.judge import simulate_moves
from mtcommission.limits.optima import condense
from mtcommission.loop.simulate import LoopResponse
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.validate.cases import Cases
from mtcommission.validate.paper import VELOCITY_STEP, Claim, Row

MUCH_LARGER = 2.0
"""Ratio of times from which one is "much larger" [-]."""


def _respond(found: Recommendation, limits: MotionLimits) -> LoopResponse:
    """Return the response of the nominal machine to its move within some limits."""
    return simulate_moves(found.machine, found.tuned, limits)[0].responses[0]


def _respond_to_rectangle(found: Recommendation) -> LoopResponse:
    """Return the response to the acceleration F_max / m without jerk limit."""
    largest = found.machine.drive.motion_force / found.plant.moving_mass
    return _respond(found, without_jerk_limit(found.machine, largest))


def _overshoot(plant: Plant, response: LoopResponse) -> float:
    """Return by how much the tool's velocity exceeds its target, relative to it."""
    reached = float(np.max(response.states @ (plant.row("tcp") @ plant.A)))
    return max(reached / VELOCITY_STEP - 1.0, 0.0)


def _condensed(cases: Cases) -> list[MotionLimits]:
    """Return the limits closest to the time-optimal, bounded and damping-optimal control."""
    return [
        condense(best.move, cases.sample(best, count=500), velocity=cases.plant.velocity)
        for best in (cases.time, cases.bounded, cases.damping)
    ]


def feedback_rows(cases: Cases, ours: Recommendation) -> list[Row]:
    """Return the claims of sec. 3 on feedback control, beside our loop."""
    plant, least, limits = cases.plant, cases.time.t_f, ours.choice.limits
    smooth, rough = _respond(ours, limits), _respond_to_rectangle(ours)
    typical = [_overshoot(plant, _respond(ours, one)) for one in _condensed(cases)]
    overshoot, times = _overshoot(plant, rough), [smooth.settling_time, rough.settling_time]
    rates = [float(one.peaks[plant.signals.index("v_phi")]) for one in (smooth, rough)]
    is_much = min(times) > MUCH_LARGER * least
    return [
        _active_damping(cases, ours, rough.settling_time),
        Claim(
            "overshoot", "3, (i)", "the terminal position is not attained precisely: overshooting"
        ).judged(
            holds=min(overshoot, *typical) > 0.01,
            rough=overshoot,
            smooth=_overshoot(plant, smooth),
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
            limits=_describe(limits),
            smooth=rates[0],
            rough=rates[1],
        ),
        _jerk_follows(cases, ours),
    ]


def _describe(limits: MotionLimits) -> Message:
    return Message("paper-limits", acceleration=limits.acceleration, jerk=limits.jerk)


def _active_damping(cases: Cases, ours: Recommendation, settling: float) -> Row:
    """Give the loop a second encoder near the tool."""
    control = replace(ours.machine.control, has_tcp_sensor=True)
    sensed = recommend(replace(ours.machine, control=control))
    times = settling, _respond_to_rectangle(sensed).settling_time
    own = np.array([mode.damping_ratio for mode in cases.plant.modes])
    by_sensor, by_encoder = sensed.tuned.nominal.mode_damping, ours.tuned.nominal.mode_damping
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


def _jerk_follows(cases: Cases, ours: Recommendation) -> Row:
    """Change one eigenfrequency at a time: the jerk must follow that of one mode."""
    told, jerks = dict[str, Any](), list[list[float]]()
    for i, name in enumerate(("base", "tower")):
        soft, stiff = (recommend(_with_frequency(cases, name, factor)) for factor in (0.8, 1.25))
        axes = {f"{name}_soft": soft, name: ours, f"{name}_stiff": stiff}
        told |= {at: one.plant.modes[i].frequency_hz for at, one in axes.items()}
        told |= {f"j_{at}": one.choice.limits.jerk for at, one in axes.items()}
        jerks.append([one.choice.limits.jerk for one in axes.values()])
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


def conclusion_rows(cases: Cases, ours: Recommendation) -> list[Row]:
    """Return the conclusions of sec. 7, beside ours."""
    free, bounded = (cases.peak(best, "v_phi") for best in (cases.time, cases.bounded))
    hints, limits = _condensed(cases), ours.choice.limits
    jerks, settling = [hint.jerk for hint in hints], _respond(ours, limits).settling_time
    soonest = min(_respond(ours, hint).settling_time for hint in hints)
    return [
        Claim("bounds-damp", "7", "significantly improved by suitable state constraints").judged(
            holds=bounded < 0.5 * free,
            less=1.0 - bounded / free,
            longer=cases.bounded.t_f / cases.time.t_f - 1.0,
        ),
        Claim("hints", "7", "concrete hints for suitable jerk limitations").judged(
            holds=settling >= soonest,
            refuted=settling < soonest and limits.jerk < min(jerks),
            free=jerks[0],
            bounded=jerks[1],
            damped=jerks[2],
            soonest=soonest,
            limits=_describe(limits),
            settling=settling,
        ),
    ]
