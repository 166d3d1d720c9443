"""MotionLimits + move -> Setpoint: what the control's generator sends to the loop.

The only door to Ruckig. Only state-to-state moves are planned: the Community build sends
waypoint problems over the network, so waypoints are never set.

A setpoint is a polynomial between knots; its jerk (and, behind a moving-average filter, its
snap) steps at the knots. It is therefore exact at any time, not only at the position cycle.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]

NUDGES = (0.0, 1e-9, 1e-7, 1e-5)
"""Shares by which the acceleration is lowered in turn where Ruckig finds no profile: it fails on
the exact border at which a phase vanishes, and next to it it does not."""

INSTANT = 1e-9
"""Times closer than this are one instant [s]: whether a sample that falls on a knot sees the
jerk before or after it must not hang on the last bit of a sum."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JerkSteps:
    """Setpoints of one move for many limits at once.

    Parameters
    ----------
    times
        Instants of the jerk steps, shape (n_limits, n_steps) [s].
    steps
        Change of the jerk there, shape (n_limits, n_steps) [m/s³].
    """

    times: Array
    steps: Array

    @property
    def duration(self) -> Array:
        """End t_e of each setpoint, shape (n_limits,) [s]."""
        return np.asarray(self.times[:, -1])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Setpoint:
    """One jerk-limited motion from rest.

    Parameters
    ----------
    move
        What was asked for.
    limits
        With which limits.
    segment_durations, segment_jerks
        Ruckig's profile before filtering, shape (n_segments,) [s, m/s³].
    knot_times
        Instants at which a derivative steps, shape (n_knots,) [s].
    jerk_steps, snap_steps
        Changes there, shape (n_knots,) [m/s³, m/s⁴].
    """

    move: Move
    limits: MotionLimits
    segment_durations: Array
    segment_jerks: Array
    knot_times: Array
    jerk_steps: Array
    snap_steps: Array

    @property
    def duration(self) -> float:
        """t_e, the end of the setpoint, filter included [s]."""
        return float(self.knot_times[-1])


def plan_setpoint(move: Move, limits: MotionLimits, *, moving_average: float = 0.0) -> Setpoint:
    """Return the fastest jerk-limited motion, computed by Ruckig.

    Parameters
    ----------
    move
        Velocity step (velocity interface) or positioning (position interface).
    limits
        Acceleration and jerk limits.
    moving_average
        Length of the control's moving-average setpoint filter [s]; 0 = none.

    Returns
    -------
    Setpoint

    Raises
    ------
    ComputationError
        SETPOINT_FAILED if Ruckig refuses the limits.

    Source: Berscheid & Kröger, Jerk-limited real-time trajectory generation, RSS 2021.

    Examples
    --------
    >>> step = VelocityStep(velocity_step=0.1)
    >>> plan_setpoint(step, MotionLimits(acceleration=2.0, jerk=250.0)).duration
    0.058
    """
    import ruckig

    request = ruckig.InputParameter(1)
    if isinstance(move, VelocityStep):
        request.control_interface = ruckig.ControlInterface.Velocity
        request.target_velocity = [move.velocity_step]
    else:
        request.target_position = [move.distance]
        request.max_velocity = [move.max_velocity]
    request.max_jerk = [limits.jerk]
    trajectory = ruckig.Trajectory(1)
    complaint = ""
    for nudge in NUDGES:
        request.max_acceleration = [limits.acceleration * (1.0 - nudge)]
        try:
            result = ruckig.Ruckig(1).calculate(request, trajectory)
        except ruckig.RuckigError as error:
            complaint = complaint or str(error).strip().partition("\n")[0]
            continue
        if result in (ruckig.Result.Working, ruckig.Result.Finished):
            break
        complaint = complaint or str(result)
    else:
        detail = Message(
            "setpoint-of-limits",
            acceleration=limits.acceleration,
            jerk=limits.jerk,
            complaint=complaint,
        )
        raise ComputationError(Outcome.SETPOINT_FAILED, detail)
    profile = trajectory.profiles[0][0]
    durations, jerks = np.array(profile.t), np.array(profile.j)
    used = durations > 0.0
    return _assemble(move, limits, durations[used], jerks[used], moving_average)


Plan = Callable[[Move], Setpoint]
"""What the control sends for a move."""


def plan_within(machine: Machine, limits: MotionLimits) -> Plan:
    """Return how a machine's control plans moves within limits, behind its setpoint filter."""
    return partial(plan_setpoint, limits=limits, moving_average=machine.control.moving_average_time)


def _assemble(
    move: Move, limits: MotionLimits, durations: Array, jerks: Array, moving_average: float
) -> Setpoint:
    times = np.concatenate([[0.0], np.cumsum(durations)])
    steps = np.diff(jerks, prepend=0.0, append=0.0)
    snaps = np.zeros_like(steps)
    if moving_average > 0.0:
        times = np.concatenate([times, times + moving_average])
        snaps = np.concatenate([steps, -steps]) / moving_average
        steps = np.zeros_like(snaps)
        order = np.argsort(times, kind="stable")
        times, steps, snaps = times[order], steps[order], snaps[order]
    for array in (durations, jerks, times, steps, snaps):
        array.setflags(write=False)
    return Setpoint(
        move=move,
        limits=limits,
        segment_durations=durations,
        segment_jerks=jerks,
        knot_times=times,
        jerk_steps=steps,
        snap_steps=snaps,
    )


def sample_setpoint(setpoint: Setpoint, times: Array) -> Array:
    """Return the setpoint at any times; at rest before 0, coasting after t_e.

    Parameters
    ----------
    setpoint
        A setpoint.
    times
        Shape (n_samples,) [s], in any order.

    Returns
    -------
    ndarray, shape (n_samples, 4)
        Columns x_ref, v_ref, a_ref, j_ref [m, m/s, m/s², m/s³]; at a knot the jerk after it.

    Examples
    --------
    >>> step = VelocityStep(velocity_step=0.1)
    >>> setpoint = plan_setpoint(step, MotionLimits(acceleration=2.0, jerk=200.0))
    >>> sample_setpoint(setpoint, np.array([-1.0, 0.06, 0.16])).round(6)[:, :2].tolist()
    [[0.0, 0.0], [0.003, 0.1], [0.013, 0.1]]
    """
    knots = setpoint.knot_times
    values = np.zeros((knots.size, 5))  # x, v, a, j, snap just after each knot
    current = np.zeros(5)
    for i in range(knots.size):
        if i:
            current = _advance(current[None, :], np.array([knots[i] - knots[i - 1]]))[0]
        current[3] += setpoint.jerk_steps[i]
        current[4] += setpoint.snap_steps[i]
        values[i] = current
    values[-1, 2:] = 0.0  # at rest or coasting: rounding must not drift away
    if isinstance(setpoint.move, Positioning):
        values[-1, :2] = setpoint.move.distance, 0.0
    else:
        values[-1, 1] = setpoint.move.velocity_step
    piece = np.searchsorted(knots, times + INSTANT, side="right") - 1
    sampled = _advance(values[np.maximum(piece, 0)], times - knots[np.maximum(piece, 0)])[:, :4]
    sampled[piece < 0] = 0.0
    return sampled


def _advance(values: Array, dt: Array) -> Array:
    x, v, a, j, s = values.T
    return np.column_stack(
        [
            x + dt * (v + dt * (a / 2 + dt * (j / 6 + dt * s / 24))),
            v + dt * (a + dt * (j / 2 + dt * s / 6)),
            a + dt * (j + dt * s / 2),
            j + dt * s,
            s,
        ]
    )


def jerk_steps(move: Move, *, acceleration: Array, jerk: Array) -> JerkSteps:
    """Return the setpoints of one move for many limits in closed form.

    The same motions as ``plan_setpoint`` (a test holds the two together), some thousand
    times faster; for the search only.

    Parameters
    ----------
    move
        Velocity step or positioning.
    acceleration, jerk
        Limits, shape (n_limits,) [m/s², m/s³].

    Returns
    -------
    JerkSteps
        4 steps for a velocity step, 8 for positioning; zero-length segments stay in.

    Source: the seven-segment profile, e.g. Biagiotti & Melchiorri, Trajectory Planning for
    Automatic Machines and Robots, 2008, sec. 3.4.
    """
    if isinstance(move, VelocityStep):
        velocity = np.full_like(jerk, move.velocity_step)
        times = _ramp_times(velocity, acceleration, jerk)
        return JerkSteps(times=times, steps=jerk[:, None] * np.array([1.0, -1.0, -1.0, 1.0]))
    velocity = _peak_velocity(move, acceleration, jerk)
    rise = _ramp_times(velocity, acceleration, jerk)
    cruise = np.maximum(move.distance / velocity - rise[:, -1], 0.0)
    fall = rise + (rise[:, -1] + cruise)[:, None]
    signs = np.array([1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0])
    return JerkSteps(times=np.hstack([rise, fall]), steps=jerk[:, None] * signs)


def moving_average_steps(steps: JerkSteps, *, time: float) -> JerkSteps:
    """Return the snap steps of the same setpoints behind a moving average.

    Parameters
    ----------
    steps
        Jerk steps.
    time
        Length of the average [s], > 0.

    Returns
    -------
    JerkSteps
        ``steps`` now in m/s⁴; the last instant is the end of the filtered setpoint.
    """
    return JerkSteps(
        times=np.hstack([steps.times, steps.times + time]),
        steps=np.hstack([steps.steps, -steps.steps]) / time,
    )


def _ramp_times(velocity: Array, acceleration: Array, jerk: Array) -> Array:
    """Jerk steps of a change of velocity from rest, shape (n_limits, 4) [s]."""
    ramp = np.minimum(acceleration / jerk, np.sqrt(velocity / jerk))
    hold = np.maximum(velocity / (jerk * ramp) - ramp, 0.0)
    return np.column_stack([np.zeros_like(ramp), ramp, ramp + hold, 2.0 * ramp + hold])


def _peak_velocity(move: Positioning, acceleration: Array, jerk: Array) -> Array:
    """Largest velocity of a move from rest to rest [m/s].

    Up to v and down again takes the distance v (v/a + a/j) where a is reached, else
    2 v sqrt(v/j); solved for v and cut at max_velocity.
    """
    L, a, j = move.distance, acceleration, jerk
    reached = 0.5 * a * (np.sqrt((a / j) ** 2 + 4.0 * L / a) - a / j)
    triangular = (0.5 * L * np.sqrt(j)) ** (2.0 / 3.0)
    velocity = np.where(reached >= a**2 / j, reached, triangular)
    return np.minimum(velocity, move.max_velocity) if isfinite(move.max_velocity) else velocity


def reached_acceleration(move: Move, *, acceleration: float, jerk: float) -> float:
    """Return the largest acceleration that a move really reaches [m/s²].

    A change of velocity v below a²/j ends before a is reached: the peak is sqrt(j v).

    Parameters
    ----------
    move
        Velocity step or positioning.
    acceleration, jerk
        Limits [m/s², m/s³].

    Returns
    -------
    float

    Examples
    --------
    >>> reached_acceleration(VelocityStep(velocity_step=0.01), acceleration=2.0, jerk=100.0)
    1.0
    """
    if isinstance(move, VelocityStep):
        velocity = move.velocity_step
    else:
        velocity = float(_peak_velocity(move, np.array([acceleration]), np.array([jerk]))[0])
    return min(acceleration, sqrt(jerk * velocity))
