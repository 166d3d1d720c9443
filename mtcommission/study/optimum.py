"""The optimum beside the loop: with a band, and on the same plant.

The optimum with the band is the honest lower limit of a recommendation that is judged by it; the
robust force is what of it remains if frequencies and damping are known to their spread only. Sec. 3
of the paper claims that a feedback-controlled setpoint overshoots at the end and takes much longer
than the least time; here setpoints and optimal controls do the same move on the same plant,
measured alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.message import Message
from mtcommission.limits.optima import Optima
from mtcommission.loop.simulate import simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant, driven_at_once, longest_period
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.machine.variations import Corner, vary
from mtcommission.optimal.band import BandForce, find_band_optimum, find_robust_force
from mtcommission.optimal.control import AnyOptimum, sample_trajectory
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_within
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.settings import BAND, STUDY

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class WithinBand:
    """The fastest controls of one move to a state from which the tool keeps the band by itself."""

    optimum: BandForce | None = None  # on the nominal machine; None where it was not found
    robust: BandForce | None = None  # on all of the spread, without payload; None: no spread
    remarks: tuple[Message, ...] = ()  # what was left out, and why


def find_within_band(machine: Machine, optima: Optima) -> WithinBand:
    """Return the fastest controls of one move that leave the tool within the permitted deviation.

    ``tcp_deviation`` as stated is the band, without reserve.
    """
    plant, needs, move = build_plant(machine), machine.requirements, optima.move
    size, force, band = size_of(move), machine.drive.motion_force, needs.tcp_deviation
    if isinstance(move, Positioning) and size <= band:
        return WithinBand(remarks=(Message("band-wider-than-move", distance=size, band=band),))
    rigid = least_motion_time(move, force / moving_mass(machine))
    left = 1.0 - rigid / optima.time.t_f
    is_long = optima.time.t_f > BAND.many_periods * longest_period(plant)
    if is_long and left < BAND.worthwhile:
        return WithinBand(remarks=(Message("band-saves-nothing", rigid=rigid, share=left),))
    optimum, robust, failed = None, None, "band-optimum-failed"
    try:
        optimum = find_band_optimum(
            driven_at_once(plant),
            move,
            force_limit=force,
            band=band,
            at_rest=optima.time.t_f,
        )
        failed = "robust-force-failed"
        if needs.frequency_spread or needs.damping_spread:
            places = _over_spread(machine)
            robust = find_robust_force(
                [driven_at_once(build_plant(vary(machine, place))) for place in places],
                move,
                force_limit=force,
                band=band,
                guess=optimum.t_f,
            )
    except ComputationError as error:
        remark = Message(failed, error=error.message)
        return WithinBand(optimum=optimum, remarks=(remark,))
    return WithinBand(optimum=optimum, robust=robust)


def _over_spread(machine: Machine) -> list[Corner]:
    """Machines over the frequency spread, at both ends and the middle of damping, each once."""
    needs = machine.requirements
    frequency = np.linspace(-1.0, 1.0, BAND.checked_frequencies) * needs.frequency_spread
    damping = np.array([-1.0, 0.0, 1.0]) * needs.damping_spread
    pairs = product(dict.fromkeys(damping.tolist()), dict.fromkeys(frequency.tolist()))
    return [Corner(frequency_factor=1.0 + f, damping_factor=1.0 + d) for d, f in pairs]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedControl:
    """One way of doing the move."""

    name: Message  # what drives the axis
    transfer_time: float  # t_f of an optimal control (exact rest); settling time in the loop [s]
    overshoot: float  # of the tool's velocity or position over its target, relative to it [-]
    peaks: Array  # largest magnitude of each of ``Plant.signals``
    max_force: float  # largest |F_set| [N]
    heat: float  # integral of the squared motor force, the measure of motor heating [N² s]
    work: float  # integral of |motor force x rigid velocity| [J]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveComparison:
    """A move done in the loop and by optimal controls."""

    controls: tuple[ComparedControl, ...]  # the paper's comparison


def compare_move(
    machine: Machine, tuned: TunedLoop, optima: Optima, limits: MotionLimits
) -> MoveComparison:
    """Return a move with some limits in the loop beside its optimal controls on the plant."""
    known = [one for one in (optima.time, optima.constrained, optima.damping) if one is not None]
    controls = compare_controls(machine, tuned, optima.move, limits=limits, optima=known)
    return MoveComparison(controls=controls)


def compare_controls(
    machine: Machine,
    tuned: TunedLoop,
    move: Move,
    *,
    limits: MotionLimits,
    optima: Sequence[AnyOptimum],
) -> tuple[ComparedControl, ...]:
    """Return rectangular (F_max/m, no jerk limit) and trapezoidal acceleration, then the optima."""
    loop, band = tuned.loops[0], machine.requirements.tcp_deviation
    plant, drive, rows = loop.plant, machine.drive, []
    rectangular = without_jerk_limit(machine, drive.motion_force / plant.moving_mass)
    for kind, each in (
        ("rectangular-in-the-loop", rectangular),
        ("trapezoidal-in-the-loop", limits),
    ):
        setpoint = plan_within(machine, each)(move)
        found = simulate(loop, setpoint, drive=drive, band=band)
        seen = (found.t, found.states, found.force)
        rows.append(_compare(kind, plant, move, seen, found.settling_time, found.peaks))
    for solution in optima:
        kind = "constrained-on-the-plant" if solution.bounds else "time-optimal-on-the-plant"
        if solution.kind == "damping":
            kind = "damping-optimal-on-the-plant"
        step = solution.t_f / STUDY.motion_samples
        motion = sample_trajectory(plant, solution.arcs, step=step)
        seen = (motion.t, motion.states, motion.force)
        rows.append(_compare(kind, plant, move, seen, solution.t_f, solution.peaks))
    return tuple(rows)


def _compare(
    kind: str,
    plant: Plant,
    move: Move,
    seen: tuple[Array, Array, Array],
    transfer_time: float,
    peaks: Array,
) -> ComparedControl:
    """``seen``: times, states and set force."""
    t, states, force = seen
    reached, motor = states @ plant.row("tcp"), states[:, plant.force]
    if isinstance(move, VelocityStep):
        reached = states @ (plant.row("tcp") @ plant.A)
    return ComparedControl(
        name=Message(kind),
        transfer_time=transfer_time,
        overshoot=max(float(np.max(reached)) / size_of(move) - 1.0, 0.0),
        peaks=peaks,
        max_force=float(np.max(np.abs(force))),
        heat=float(np.trapezoid(motor**2, t)),
        work=float(np.trapezoid(np.abs(motor * states[:, plant.velocity]), t)),
    )
