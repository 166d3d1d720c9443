"""The optimum beside the loop: with a band, on the same plant, and fed forward.

The optimum with the band is the honest lower limit of a recommendation that is judged by it; the
robust force is what of it remains if frequencies and damping are known to their spread only. Sec. 3
of the paper claims that a feedback-controlled setpoint overshoots at the end and takes much longer
than the least time; here setpoints and optimal controls do the same move on the same plant,
measured alike. Users ask why they cannot simply use the optimum: so its force goes to the drive at
every velocity cycle (its mean over the cycle, so that no impulse is lost), the controllers compare
with the optimal motion, and the machine is the nominal one or off by the spread.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import ceil, inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.errors import ComputationError
from mtcommission.limits.judge import MoveResult
from mtcommission.limits.optima import Optima
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.simulate import simulate_corners
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.machine.variations import NOMINAL, Corner, corners, vary
from mtcommission.messages.message import Message
from mtcommission.optimal.band import (
    BandForce,
    BandOptimum,
    RobustForce,
    find_band_optimum,
    find_robust_force,
)
from mtcommission.optimal.solution import (
    AnyOptimum,
    sample_evenly,
    sample_trajectory,
)
from mtcommission.plant.plant import Plant, build_plant, driven_at_once, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_within
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.settings import STUDY, BandSettings

Array = NDArray[np.float64]

ROBUST = Message("control-robust")
"""Name of the force that keeps the band on all machines of the spread."""

Fed = AnyOptimum | BandForce
"""An optimal control that can be fed forward."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WithinBand:
    """The fastest controls of one move to a state from which the tool keeps the band by itself."""

    optimum: BandOptimum | None = None  # on the nominal machine; None where it was not found
    robust: RobustForce | None = None  # on all of the spread, without payload; None: no spread
    remarks: tuple[Message, ...] = ()  # what was left out, and why


def find_within_band(machine: Machine, optima: Optima, settings: BandSettings) -> WithinBand:
    """Return the fastest controls of one move that leave the tool within the permitted deviation.

    ``tcp_deviation`` as stated is the band, without reserve.
    """
    plant, needs, move = build_plant(machine), machine.requirements, optima.move
    size, force, band = size_of(move), machine.drive.motion_force, needs.tcp_deviation
    if isinstance(move, Positioning) and size <= band:
        return WithinBand(remarks=(Message("band-wider-than-move", distance=size, band=band),))
    rigid = least_motion_time(move, force / moving_mass(machine))
    left = 1.0 - rigid / optima.time.t_f
    is_long = optima.time.t_f > settings.many_periods * longest_period(plant)
    if is_long and left < settings.worthwhile:
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
            places = _over_spread(machine, settings)
            robust = find_robust_force(
                [driven_at_once(build_plant(vary(machine, place))) for place in places],
                move,
                force_limit=force,
                band=band,
                guess=optimum.force.t_f,
            )
    except ComputationError as error:
        remark = Message(failed, error=error.message)
        return WithinBand(optimum=optimum, remarks=(remark,))
    return WithinBand(optimum=optimum, robust=robust)


def _over_spread(machine: Machine, settings: BandSettings) -> list[Corner]:
    """Machines over the frequency spread, at both ends and the middle of damping, each once."""
    needs = machine.requirements
    frequency = np.linspace(-1.0, 1.0, settings.checked_frequencies) * needs.frequency_spread
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
class FedForward:
    """One optimal control fed forward, or a setpoint, on one machine."""

    corner: Corner  # the machine
    settling_time: float  # with the tool outside the band about the delayed motion wanted [s]
    residual_deviation: float  # of the tool from that, after its end [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveComparison:
    """A move done in the loop and by optimal controls."""

    controls: tuple[ComparedControl, ...]  # the paper's comparison
    fed_forward: tuple[tuple[Message, tuple[FedForward, ...]], ...]  # and the recommended limits
    claims: tuple[Message, ...]  # overshoot and transfer time against the least time
    why_not_the_optimum: tuple[Message, ...]  # what it does fed forward, and beside its machine


def compare_move(
    machine: Machine,
    tuned: TunedLoop,
    optima: Optima,
    result: MoveResult,
    *,
    robust: RobustForce | None,
) -> MoveComparison:
    """Return what the optimal controls of a move do, on the plant and fed forward in the loop.

    ``robust``: the force that keeps the band on all machines of the spread, where there is one.
    """
    solutions = {
        "control-time-optimal": optima.time,
        "control-constrained": optima.constrained,
        "control-damping-optimal": optima.damping,
    }
    found = {Message(kind): item for kind, item in solutions.items() if item is not None}
    limits, known = result.setpoint.limits, tuple(found.values())
    controls = compare_controls(machine, tuned, optima.move, limits=limits, optima=known)
    fed = {**found, **({ROBUST: robust.force} if robust else {})}
    fed_forward = (
        *zip(fed, feed_forward(machine, tuned, list(fed.values())), strict=True),
        (Message("recommended-limits"), follow_setpoint(machine, tuned, result)),
    )
    return MoveComparison(
        controls=controls,
        fed_forward=fed_forward,
        claims=state_claims(controls),
        why_not_the_optimum=explain_why_not(machine, fed_forward),
    )


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
        (found,) = simulate_corners((loop,), setpoint, drive=drive, band=band)
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


def state_claims(controls: Sequence[ComparedControl]) -> tuple[Message, ...]:
    """Return overshoot and transfer time of the setpoints in the loop, as sentences.

    ``controls``: rectangular and trapezoidal acceleration in the loop, then the time-optimal one.
    """
    least = controls[2].transfer_time
    claims = []
    for kind, control in zip(("claim-rectangular", "claim-trapezoidal"), controls[:2], strict=True):
        overshoot = Message("claim-no-overshoot")
        transfer = Message("claim-not-settled", least=least)
        if control.overshoot >= STUDY.overshoot_seen:
            overshoot = Message("claim-overshoot", overshoot=control.overshoot)
        if isfinite(time := control.transfer_time):
            transfer = Message("claim-transfer", time=time, times=time / least, least=least)
        claims.append(Message(kind, overshoot=overshoot, transfer=transfer))
    return tuple(claims)


def explain_why_not(
    machine: Machine, fed_forward: Sequence[tuple[Message, Sequence[FedForward]]]
) -> tuple[Message, ...]:
    """Return what the fed-forward optimum does on the nominal machine and beside it, as sentences.

    ``fed_forward``: the nominal machine first; last the setpoint with the recommended limits.
    """

    def say(kind: str, rows: Sequence[FedForward], **name: Message) -> Message:
        nominal = next(row for row in rows if row.corner == NOMINAL)
        outcome = Message(
            "settles-on-both",
            nominal=_settles(nominal.settling_time),
            worst=_settles(max(row.settling_time for row in rows)),
        )
        left = max(row.residual_deviation for row in rows)
        return Message(kind, **name, outcome=outcome, left=left)

    *optima, (_, ours) = fed_forward
    return (
        *(say("fed-forward-outcome", rows, name=name) for name, rows in optima),
        say("recommended-outcome", ours),
        Message(
            "why-controls-take-limits",
            band=machine.requirements.tcp_deviation,
            spread=max(abs(row.corner.frequency_factor - 1.0) for row in ours),
        ),
    )


def _settles(time: float) -> Message:
    return Message("time-value", time=time) if isfinite(time) else Message("no-time-looked-at")


def feed_forward(
    machine: Machine,
    tuned: TunedLoop,
    solutions: Sequence[AnyOptimum | BandForce],
) -> list[tuple[FedForward, ...]]:
    """Return what each fed-forward optimum does on the nominal machine and in its corners.

    While it moves, the tool is compared with the optimal motion, and after its end with where
    that comes to rest; what leaves modes ringing within the band lets the reference lie beside.
    The nominal machine first; corners with a usual spread where the profile states none.
    """
    plant, cycle, places = tuned.loops[0].plant, tuned.controller.velocity_cycle, _places(machine)
    plants = [build_plant(vary(machine, corner)) for corner in places]
    counts = [ceil((each.t_f + STUDY.tail) / cycle) for each in solutions]
    until = (max(counts) + 1) * cycle

    def sample(each: Fed, one: Plant) -> Array:
        return sample_evenly(one, each.arcs, step=cycle, until=until)

    wanted = np.array([sample(each, plant) for each in solutions])
    if tuned.controller.follows:
        # The motor does what the optimum asks for, one cycle late like every force fed forward.
        moved = [[sample(each, one) @ one.row("tcp") for one in plants] for each in solutions]
        tool = np.pad(np.moveaxis(np.array(moved), -1, 0)[:-2], ((1, 0), (0, 0), (0, 0)))
    else:
        whole = replace(tuned.controller, velocity_feedforward=1.0)
        loops = [build_loop(one, whole, model=plant) for one in plants]
        tool = _advance(loops, wanted, limit=machine.drive.motion_force)
    found = []
    for k, (solution, count) in enumerate(zip(solutions, counts, strict=True)):
        states = wanted[k, : count + 2]
        aimed = states @ plant.row("tcp")
        if isinstance(solution, BandForce):
            after = ceil(solution.t_f / cycle)
            to_last = cycle * np.arange(after - 1 - count, 1)
            steady = states[-1, plant.position] + states[-1, plant.velocity] * to_last
            aimed[after:] = steady + solution.offset
        late = np.concatenate(([0.0], aimed[:-2]))[:, None]
        deviation, t = np.abs(tool[: count + 1, k] - late), np.arange(count + 1) * cycle
        is_out = deviation > machine.requirements.tcp_deviation
        last, end = np.max(t[:, None] * is_out, axis=0), solution.t_f + cycle
        found.append(
            tuple(
                FedForward(
                    corner=corner,
                    settling_time=inf if last[i] == t[-1] else max(end, float(last[i])),
                    residual_deviation=float(np.max(deviation[t >= end, i])),
                )
                for i, corner in enumerate(places)
            )
        )
    return found


def follow_setpoint(
    machine: Machine, tuned: TunedLoop, result: MoveResult
) -> tuple[FedForward, ...]:
    """Return what a setpoint does on the same machines, beside the fed-forward optima."""
    places, responses, setpoint = _places(machine), result.responses, result.setpoint
    if places != tuned.corners:
        model, plants = tuned.loops[0].plant, [build_plant(vary(machine, each)) for each in places]
        loops = [build_loop(one, tuned.controller, model=model) for one in plants]
        band = machine.requirements.tcp_deviation
        responses = tuple(simulate_corners(loops, setpoint, drive=machine.drive, band=band))
    return tuple(
        FedForward(
            corner=corner,
            settling_time=response.settling_time,
            residual_deviation=response.residual_deviation,
        )
        for corner, response in zip(places, responses, strict=True)
    )


def _places(machine: Machine) -> tuple[Corner, ...]:
    """The corners of a machine, with a usual spread where its profile states none."""
    places = corners(machine)
    if places != (NOMINAL,):
        return places
    needs = replace(machine.requirements, frequency_spread=STUDY.usual_spread)
    return corners(replace(machine, requirements=needs))


def _advance(loops: Sequence[SampledLoop], wanted: Array, *, limit: float) -> Array:
    """Position of the tool at every velocity cycle, shape (n_samples, n_motions, n_loops) [m].

    ``wanted``: states of some motions, shape (n_motions, n_samples + 1, n). The force acts one
    velocity cycle late, so the controllers compare with the motion wanted one cycle ago, its
    velocity by differences as the encoder's.
    """
    controller, plant, size = loops[0].controller, loops[0].plant, len(loops[0].states) + 2
    # ∫ F_set over a cycle, from T F' = F_set - F and m v' = F.
    momentum = np.zeros(plant.order)
    momentum[plant.force], momentum[plant.velocity] = plant.force_lag, plant.moving_mass
    mean_force = np.diff(wanted @ momentum) / controller.velocity_cycle
    late = np.pad(wanted[:, :-1], ((0, 0), (1, 0), (0, 0)))[:, :-1]
    position = late @ plant.row("encoder")
    rate = np.diff(position, prepend=0.0) / controller.velocity_cycle
    fed = np.stack([position, rate, mean_force + late @ controller.state_gains], axis=-1)
    # Cycles in which no force saturates are one product, found by stepping unit states and inputs.
    together = controller.cycles * ceil(STUDY.cycles_together / controller.cycles)
    unit = np.eye(size + 3 * together)
    units = np.repeat(unit[:, None, :size], len(loops), axis=1)
    whole = _step_on(loops, units, unit[:, size:].reshape(-1, together, 3), limit=inf)
    whole, states = whole.swapaxes(0, 1), np.zeros((len(fed), len(loops), size))
    parts = []
    for start in range(0, fed.shape[1], together):
        given = fed[:, start : start + together]
        given = np.pad(given, ((0, 0), (0, together - given.shape[1]), (0, 0)))
        flat = np.repeat(given.reshape(len(given), 1, -1), len(loops), axis=1)
        found = (np.concatenate([states, flat], axis=-1).swapaxes(0, 1) @ whole).swapaxes(0, 1)
        if np.abs(found[..., -together:]).max() > limit:
            found = _step_on(loops, states, given, limit=limit)
        states = found[..., :size]
        parts.append(found[..., size:-together])
    return np.moveaxis(np.concatenate(parts, axis=-1), -1, 0)[: fed.shape[1]]


def _step_on(loops: Sequence[SampledLoop], states: Array, fed: Array, *, limit: float) -> Array:
    """Some velocity cycles later, the first one of which begins a position cycle.

    All loops have the same states, and all of them and all motions advance together. ``states``:
    with what is handed down and what waits for that, shape (n_motions, n_loops, n + 2); ``fed``:
    position, velocity and force, shape (n_motions, n_cycles, 3). Returned are the states, the tool
    and the force asked for in each cycle, side by side in the last axis.
    """
    first, controller, n = loops[0], loops[0].controller, loops[0].plant.order
    held, own, integrator = first.held, first.own_size, first.integrator
    places = [held, held + 1, first.states.index("held_force")]
    rows = np.array([np.vstack([one.demand, one.integration, one.step]) for one in loops])
    encoder = np.array([loop.plant.row("encoder") for loop in loops])
    tool_row = np.array([loop.plant.row("tcp") for loop in loops])
    X, handed, asked = states[..., :-2], states[..., -2], states[..., -1]
    tool, demands = [], []
    for i, (position, rate, ahead) in enumerate(np.moveaxis(fed, (1, 2), (0, 1))[..., None]):
        if controller.position_loop is PositionLoop.DRIVE:
            handed = np.broadcast_to(position, handed.shape)
        elif i % controller.cycles == 0:
            error = position - np.sum(encoder * X[..., :n], axis=-1)
            handed, asked = asked, controller.position_gain * error
        tool.append(np.sum(tool_row * X[..., :n], axis=-1))
        X = X.copy()
        X[..., held:own] = 0.0
        for place, values in zip(places, (handed, rate, ahead), strict=True):
            X[..., place] = values
        Y = (rows @ X[..., None])[..., 0]
        demand, increment, X = Y[..., 0], Y[..., 1], Y[..., 2:]
        acting = np.clip(demand, -limit, limit)
        demands.append(demand)
        X[..., integrator] += np.where(acting == demand, increment, 0.0)
        X[..., integrator + 1] = acting
    seen = np.stack([*tool, *demands], axis=-1)
    return np.concatenate([X, handed[..., None], asked[..., None], seen], axis=-1)
