"""MotionLimits + move -> Setpoint: what the control's generator sends to the loop.

The only door to Ruckig. Only state-to-state moves are planned: the Community build sends
waypoint problems over the network, so waypoints are never set.

A setpoint is a polynomial between knots, at which one derivative steps: the jerk, and behind a
moving average the one above. It is therefore exact at any time, not only at the position cycle.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]

NUDGES = (0.0, 1e-9, 1e-7, 1e-5)
"""Shares by which the acceleration is lowered in turn where Ruckig finds no profile: it fails on
the exact border at which a phase vanishes, and next to it it does not."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JerkSteps:
    """Setpoints of one move for many limits at once."""

    times: Array  # instants of the steps, shape (n_limits, n_steps) [s]
    steps: Array  # change of the highest derivative there, shape (n_limits, n_steps) [m/s³, ...]
    order: int = 3  # which derivative steps: 3 the jerk, and one more for each moving average

    @property
    def duration(self) -> Array:
        """End t_e of each setpoint, shape (n_limits,) [s]."""
        return np.asarray(self.times[:, -1])

    def only(self, place: slice | list[int] | NDArray[np.bool_]) -> JerkSteps:
        """Return some of them."""
        return replace(self, times=self.times[place], steps=self.steps[place])


INSTANT = 1e-9
"""Times closer than this are one instant [s]: whether a sample that falls on a knot sees the
jerk before or after it must not hang on the last bit of a sum."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pieces:
    """Some setpoints, piece by piece.

    Sampled from the last knot before it and not from all steps so far: summed from its beginning, a
    position behind two averages loses six digits within ten seconds.
    """

    knots: Array  # in rising order, shape (n_knots, n_setpoints) [s]
    values: Array
    """Position and its derivatives just after each knot, before the first at first: at rest; shape
    (order + 1, n_knots + 1, n_setpoints)."""

    def sample(
        self, t: Array, *, derivatives: int, setpoint: NDArray[np.int64] | None = None
    ) -> Array:
        """Return position and its first derivatives, shape (derivatives, *t.shape).

        ``t``: each setpoint's own times, shape (..., n_setpoints) [s], or those of the setpoints
        that are named; at a knot the values are those after it. Derivatives above the order are
        zero.
        """
        own = np.arange(t.shape[-1]) if setpoint is None else setpoint
        # All knots on one axis, those of each setpoint further than those of the one before.
        count, apart = len(self.knots), float(np.ptp(self.knots)) + 1.0
        every = (self.knots - INSTANT + apart * np.arange(self.knots.shape[1])).T.ravel()
        piece = np.searchsorted(every, t + apart * own, side="right") - count * own
        piece = np.clip(piece, 0, count)
        age = t - self.knots[np.maximum(piece - 1, 0), own]
        every_piece = self.values.reshape(len(self.values), -1)
        values = list(every_piece.take(piece * self.values.shape[2] + own, axis=1))
        result = np.zeros((derivatives, *t.shape))
        for k in range(min(derivatives, len(values))):
            result[k] = _taylor(values[k:], age)
        return result


def cut(times: Array, steps: Array, *, order: int) -> Pieces:
    """Return the pieces of setpoints whose highest derivative steps.

    As in ``JerkSteps``, the times in any order. After the last step the setpoints are at rest or
    coast, whatever rounding leaves.
    """
    rising = np.argsort(times, axis=1, kind="stable")
    knots = np.take_along_axis(times, rising, axis=1).T
    sizes = np.take_along_axis(steps, rising, axis=1).T
    values = np.zeros((len(knots) + 1, knots.shape[1], order + 1))
    gaps = np.diff(knots, axis=0, prepend=knots[:1])
    # Each derivative at the next knot, from those at the last one, by Taylor.
    shift, grown = np.zeros((*gaps.shape, order + 1, order + 1)), np.ones_like(gaps)
    for k in range(order + 1):
        for low in range(order + 1 - k):
            shift[..., low, low + k] = grown
        grown = grown * gaps / (k + 1)
    for i, size in enumerate(sizes):
        values[i + 1] = (shift[i] @ values[i, :, :, None])[..., 0]
        values[i + 1, :, order] += size
    values[-1, :, 2:] = 0.0
    return Pieces(knots=knots, values=np.ascontiguousarray(values.transpose(2, 0, 1)))


def _taylor(derivatives: list[Array], age: Array) -> Array:
    """A quantity ``age`` [s] later from it and its derivatives, each of that shape."""
    total = np.zeros_like(age)
    for k in range(len(derivatives) - 1, 0, -1):
        total += derivatives[k]
        total *= age
        total /= k
    total += derivatives[0]
    return total


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Setpoint:
    """One jerk-limited motion from rest."""

    move: Move
    limits: MotionLimits
    segment_durations: Array  # of Ruckig's profile before filtering, shape (n_segments,) [s]
    segment_jerks: Array  # likewise, shape (n_segments,) [m/s³]
    steps: JerkSteps  # of this one setpoint, behind the limits' filter

    @property
    def duration(self) -> float:
        """t_e, the end of the setpoint, filter included [s]."""
        return float(self.steps.duration[0])


def plan_setpoint(move: Move, limits: MotionLimits) -> Setpoint:
    """Return the fastest jerk-limited motion, computed by Ruckig, behind the limits' filter.

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
    complaints = []
    for nudge in NUDGES:
        request.max_acceleration = [limits.acceleration * (1.0 - nudge)]
        try:
            result = ruckig.Ruckig(1).calculate(request, trajectory)
        except ruckig.RuckigError as error:
            complaints.append(str(error).strip().partition("\n")[0])
            continue
        if result in (ruckig.Result.Working, ruckig.Result.Finished):
            break
        complaints.append(str(result))
    else:
        a, j, why = limits.acceleration, limits.jerk, complaints[0]
        detail = Message("setpoint-of-limits", acceleration=a, jerk=j, complaint=why)
        raise ComputationError(Outcome.SETPOINT_FAILED, detail)
    profile = trajectory.profiles[0][0]
    durations, jerks = np.array(profile.t), np.array(profile.j)
    used = durations > 0.0
    durations, jerks = durations[used], jerks[used]
    plain = JerkSteps(
        times=np.concatenate([[0.0], np.cumsum(durations)])[None],
        steps=np.diff(jerks, prepend=0.0, append=0.0)[None],
    )
    return Setpoint(
        move=move,
        limits=limits,
        segment_durations=durations,
        segment_jerks=jerks,
        steps=filter_steps(plain, limits.setpoint_filter),
    )


Plan = Callable[[Move], Setpoint]
"""What the control sends for a move."""


def plan_within(machine: Machine, limits: MotionLimits) -> Plan:
    """Return how a machine's control plans moves within limits, behind its setpoint filter."""
    given = machine.control.setpoint_filter
    if limits.setpoint_filter is None and given is not None:
        limits = replace(limits, setpoint_filter=given)
    return partial(plan_setpoint, limits=limits)


def sample_setpoint(setpoint: Setpoint, times: Array) -> Array:
    """Return the setpoint at any times; at rest before 0, coasting after t_e.

    ``times``: in any order. Columns x_ref, v_ref, a_ref, j_ref, shape (n_samples, 4); at a knot the
    jerk after it.

    Examples
    --------
    >>> step = VelocityStep(velocity_step=0.1)
    >>> setpoint = plan_setpoint(step, MotionLimits(acceleration=2.0, jerk=200.0))
    >>> sample_setpoint(setpoint, np.array([-1.0, 0.06, 0.16])).round(6)[:, :2].tolist()
    [[0.0, 0.0], [0.003, 0.1], [0.013, 0.1]]
    """
    return _pieces(setpoint).sample(times[:, None], derivatives=4)[:, :, 0].T


@lru_cache(maxsize=64)
def _pieces(setpoint: Setpoint) -> Pieces:
    """The pieces of a setpoint, once for all that is sampled of it, with its exact end."""
    steps = setpoint.steps
    pieces = cut(steps.times, steps.steps, order=steps.order)
    if isinstance(setpoint.move, Positioning):
        pieces.values[:2, -1, 0] = setpoint.move.distance, 0.0
    else:
        pieces.values[1, -1, 0] = setpoint.move.velocity_step
    return pieces


def jerk_steps(
    move: Move, *, acceleration: Array, jerk: Array, size: Array | None = None
) -> JerkSteps:
    """Return the setpoints of one move for many limits, or in many sizes, in closed form.

    The same motions as ``plan_setpoint``, some thousand times faster; for the search only.
    ``size``: velocity steps or distances in place of the move's own [m/s or m], shape (n_limits,)
    like the limits. There are 4 steps for a velocity step, 8 for positioning; zero-length segments
    stay in.

    Source: the seven-segment profile, e.g. Biagiotti & Melchiorri, Trajectory Planning for
    Automatic Machines and Robots, 2008, sec. 3.4.
    """
    if isinstance(move, VelocityStep):
        velocity = np.full_like(jerk, move.velocity_step) if size is None else size
        times = _ramp_times(velocity, acceleration, jerk)
        return JerkSteps(times=times, steps=jerk[:, None] * np.array([1.0, -1.0, -1.0, 1.0]))
    distance = np.full_like(jerk, move.distance) if size is None else size
    velocity = _peak_velocity(distance, move.max_velocity, acceleration, jerk)
    rise = _ramp_times(velocity, acceleration, jerk)
    cruise = np.maximum(distance / velocity - rise[:, -1], 0.0)
    fall = rise + (rise[:, -1] + cruise)[:, None]
    signs = np.array([1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0])
    times = np.concatenate([rise, fall], axis=1)
    return JerkSteps(times=times, steps=jerk[:, None] * signs)


def filter_steps(steps: JerkSteps, item: SetpointFilter | None) -> JerkSteps:
    """Return the steps of the same setpoints behind a filter; None: none.

    A shaper multiplies the steps, an average raises the derivative that steps; the last instant is
    the end of the filtered setpoint.
    """
    if item is None:
        return steps
    impulses = item.impulses
    times = np.concatenate([steps.times + delay for delay in impulses.delays], axis=1)
    sizes = np.concatenate([steps.steps * share for share in impulses.shares], axis=1)
    for time in item.averages:
        times = np.concatenate([times, times + time], axis=1)
        sizes = np.concatenate([sizes, -sizes], axis=1) / time
    return JerkSteps(times=times, steps=sizes, order=steps.order + len(item.averages))


def _ramp_times(velocity: Array, acceleration: Array, jerk: Array) -> Array:
    """Jerk steps of a change of velocity from rest, shape (n_limits, 4) [s]."""
    ramp = np.minimum(acceleration / jerk, np.sqrt(velocity / jerk))
    hold = np.maximum(velocity / (jerk * ramp) - ramp, 0.0)
    return np.array([0.0 * ramp, ramp, ramp + hold, 2.0 * ramp + hold]).T


def _peak_velocity(distance: Array, max_velocity: float, acceleration: Array, jerk: Array) -> Array:
    """Largest velocity of a move from rest to rest [m/s].

    Up to v and down again takes the distance v (v/a + a/j) where a is reached, else
    2 v sqrt(v/j); solved for v and cut at max_velocity.
    """
    L, a, j = distance, acceleration, jerk
    reached = 0.5 * a * (np.sqrt((a / j) ** 2 + 4.0 * L / a) - a / j)
    triangular = (0.5 * L * np.sqrt(j)) ** (2.0 / 3.0)
    velocity = np.where(reached >= a**2 / j, reached, triangular)
    return np.minimum(velocity, max_velocity) if isfinite(max_velocity) else velocity
