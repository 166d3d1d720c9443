"""The matrices of the loop: one assembly for every engine, held to ``diagram`` by a test.

Which path carries which dead time:

- What the position cycle computes (``HandedDown``) reaches the velocity controller one position
  cycle later: held, or as polynomials. Wanted velocity and reference state are taken from the
  setpoint τ less the age they have by then, so that they arrive at their comparison τ late, like
  the position that is compared (the velocity T_v/2 later still, see below).
- The velocity controller samples at the velocity cycle; its force acts one velocity cycle
  later and is held. It knows the velocity from the difference of two positions of the encoder,
  which is half a velocity cycle late.

It takes half a millisecond, the diagram some thirty: tuning assembles hundreds of loops.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from math import ceil, exp

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.model.controller import Controller, filter_polynomials, reference_state
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]

INPUTS = ("x_ref", "v_ref", "a_ref", "j_ref")


@lru_cache(maxsize=64)
def discretise(plant: Plant, step: float) -> tuple[Array, Array]:
    """Return the zero-order-hold discretisation (A, B) of a plant over one step [s].

    Held is the set force, or the jerk of an open-loop axis.
    """
    return _held_over(plant.A, plant.B, step)


@lru_cache(maxsize=64)
def discretise_disturbance(plant: Plant, step: float) -> Array:
    """Return what a constant force of 1 N beside the motor adds to the plant state over a step [s].

    A disturbance on the line of the drive force enters like the force state, without its lag.
    Shape (n_plant,).
    """
    push = plant.A[:, plant.force].copy()
    push[plant.force] = 0.0
    return _held_over(plant.A, push, step)[1]


def _held_over(A: Array, B: Array, step: float) -> tuple[Array, Array]:
    n = len(A)
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = A, B
    transition = np.asarray(expm(joint * step))
    return transition[:n, :n], transition[:n, n]


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossCheck:
    """What python-control says of the nominal loop, put together from the same blocks."""

    pole_difference: float  # largest distance of a pole of ours from theirs in the z plane [-]
    gain_margin_db: float | None  # None: by any amount
    phase_margin_deg: float | None


def _sampled(item: ForceFilter, velocity_cycle: float) -> tuple[Array, Array, Array, float]:
    """A, B, C, D of a set-force filter at the velocity cycle [s], by the bilinear transform.

    Of b(s)/a(s) in controllable form, with trapezoidal integration over the cycle:
    x⁺ = (I - A T/2)⁻¹ ((I + A T/2) x + B T u), read halfway between x and x⁺.
    """
    numerator, denominator = filter_polynomials(item)
    half = 0.5 * velocity_cycle
    A = np.array([-denominator[1:], [1.0, 0.0]])
    C = numerator[1:] - numerator[0] * denominator[1:]
    implicit = np.asarray(np.linalg.inv(np.eye(2) - half * A), dtype=np.float64)
    B = 2.0 * half * implicit[:, 0]
    step, D = implicit @ (np.eye(2) + half * A), float(numerator[0] + 0.5 * C @ B)
    return step, B, C @ implicit, D


def kept_samples(controller: Controller) -> int:
    """Return how many samples of the setpoint before the current one the control keeps."""
    oldest = controller.reference_delay
    if controller.position_loop is not PositionLoop.CONTROL:
        piece = controller.reference_age + controller.position_cycle
        in_drive = controller.position_loop is PositionLoop.DRIVE
        oldest = piece if in_drive else max(oldest, piece)
    return ceil(oldest / controller.position_cycle - 1e-9)


def delay_weights(delay: float, *, cycle: float, delays: int) -> Array:
    """Return the weights of setpoint samples that give the setpoint a delay [s] ago.

    Position by quintic Hermite interpolation (exact while the jerk is constant; a jerk step
    of Δj inside the cycle costs at most some Δj T³/400), the velocity by its derivative,
    acceleration and jerk linearly. Rows x, v, a, j; columns (x, v, a, j) of the current sample,
    then of those kept before it (``delays`` of them, at least delay/cycle), shape
    (4, 4 (delays + 1)).
    """
    back = ceil(delay / cycle - 1e-9)
    s = min(max(back - delay / cycle, 0.0), 1.0)
    weights = np.zeros((4, delays + 1, 4))
    if s == 0.0:
        weights[:, back, :] = np.eye(4)
        return weights.reshape(4, -1)
    powers = s ** np.arange(6.0)
    slopes = np.append(0.0, np.arange(1.0, 6.0) * powers[:-1]) / cycle
    scale = np.array([1.0, cycle, cycle**2])
    for row, basis in ((0, powers), (1, slopes)):
        ends = basis @ _HERMITE
        weights[row, back, :3] = ends[:3] * scale
        weights[row, back - 1, :3] = ends[3:] * scale
    for row in (2, 3):
        weights[row, back, row] = 1.0 - s
        weights[row, back - 1, row] = s
    return weights.reshape(4, -1)


_POWERS = np.arange(6.0)
_HERMITE = np.linalg.inv(
    np.vstack(
        [np.diag([1.0, 1.0, 2.0]) @ np.eye(3, 6), _POWERS**0, _POWERS, _POWERS * (_POWERS - 1)]
    )
)
"""Coefficients of 1, s, ..., s^5 (rows) over x0, v0, a0, x1, v1, a1 (columns) on s in [0, 1]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HandedDown:
    """What the position cycle hands down to the velocity cycle, one position cycle later.

    Held: the position controller's output, the velocity and the force fed forward. Interpolated:
    the wanted motion and the force as polynomials, which the velocity cycle advances. This is the
    only difference between the three position loops.
    """

    names: tuple[str, ...]  # n states that hold it
    by_setpoint: Array  # the setpoint now, then the kept samples, newest first, (n, 4 (kept + 1))
    by_encoder: Array  # the encoder's position now, (n,)
    advance: Array  # what is held one velocity cycle later, (n, n)
    correction: Array
    """Output of the position controller, as a row over what is held, (n,); the encoder's share is
    already in what is held, or ``drive_gain`` times its position now."""
    velocity: Array  # fed forward, (n,)
    force: Array  # fed forward, (n,)
    drive_gain: float  # Kv where the position loop closes at the velocity cycle, else 0 [1/s]

    @property
    def kept(self) -> int:
        """Samples of the setpoint before the current one."""
        return int(self.by_setpoint.shape[1]) // len(INPUTS) - 1


def hand_down(controller: Controller, model: Plant) -> HandedDown:
    """Return what the position cycle hands down; ``model``: as in ``build_loop``."""
    kept, T_p, m = kept_samples(controller), controller.position_cycle, controller.feedforward_mass

    def ago(delay: float) -> Array:
        return delay_weights(delay, cycle=T_p, delays=kept)

    wanted = controller.state_gains @ reference_state(model, controller)
    # Force by acceleration and jerk of the setpoint now.
    ahead = np.zeros(len(INPUTS) * (kept + 1))
    ahead[2] = controller.acceleration_feedforward * m
    ahead[3] = controller.jerk_feedforward * m * controller.force_lag
    Kv, age, tau = controller.position_gain, controller.reference_age, controller.reference_delay
    if controller.position_loop is PositionLoop.CONTROL:
        correction, velocity, late = Kv * ago(tau)[0], ago(controller.velocity_age)[1], ago(age)
        force, rate = ahead + wanted @ late, wanted[:3] @ late[1:]
        return _held(controller, correction, velocity, force, rate)
    start, end = ago(age + T_p), ago(age)
    before = np.roll(ahead, len(INPUTS)) + wanted @ start
    rise = (ahead + wanted @ end - before) / T_p
    # The cubic that has position and velocity at both ends: exact while the jerk is constant.
    x, v = end[0] - start[0] - T_p * start[1], end[1] - start[1]
    motion = [start[1], 6.0 * x / T_p**2 - 2.0 * v / T_p, 6.0 * v / T_p**2 - 12.0 * x / T_p**3]
    in_drive = controller.position_loop is PositionLoop.DRIVE
    first = start[0] if in_drive else Kv * ago(tau)[0]
    return _interpolated(controller, np.array([first, *motion, before, rise]))


def _held(
    controller: Controller, correction: Array, velocity: Array, force: Array, rate: Array
) -> HandedDown:
    """The force by the wanted state goes on at its rate even where the rest is held.

    A held wanted position would make the state feedback ripple even while coasting.
    """
    T_p, T_v, Kv = controller.position_cycle, controller.velocity_cycle, controller.position_gain
    # Setpoint and state belong to the middle of the cycle; the first sample comes earlier.
    rows = [correction, velocity, force - 0.5 * (T_p - T_v) * rate, rate]
    used = 4 if controller.state_gains.any() else 3
    unit, advance = np.eye(used), np.eye(used)
    advance[2, 3:] = T_v
    return HandedDown(
        names=("held_correction", "held_velocity", "held_force", "held_force_rate")[:used],
        by_setpoint=np.array(rows[:used]),
        by_encoder=-Kv * unit[0],
        advance=advance,
        correction=unit[0],
        velocity=controller.velocity_feedforward * unit[1],
        force=unit[2],
        drive_gain=0.0,
    )


def _interpolated(controller: Controller, by_setpoint: Array) -> HandedDown:
    T_v, Kv = controller.velocity_cycle, controller.position_gain
    in_drive = controller.position_loop is PositionLoop.DRIVE
    unit, advance = np.eye(6), np.eye(6)
    begin = 0 if in_drive else 1
    powers = np.array([1.0, T_v, T_v**2 / 2, T_v**3 / 6])
    for i in range(begin, 4):
        advance[i, i:4] = powers[: 4 - i]
    advance[4, 5] = T_v
    # The mean over the past velocity cycle, as the encoder's difference is.
    mean = np.array([0.0, 1.0, -T_v / 2, T_v**2 / 6, 0.0, 0.0])
    names = ("velocity", "acceleration", "jerk", "force", "force_rate")
    first = "position" if in_drive else "correction"
    return HandedDown(
        names=tuple(f"held_{name}" for name in (first, *names)),
        by_setpoint=by_setpoint,
        by_encoder=np.zeros(6) if in_drive else -Kv * unit[0],
        advance=advance,
        correction=Kv * unit[0] if in_drive else unit[0],
        velocity=controller.velocity_feedforward * mean,
        force=unit[4],
        drive_gain=Kv if in_drive else 0.0,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LiftedLoop:
    """The linear loop at the position cycle, X⁺ = A X + B r, Y = C X.

    X and Y as in ``SampledLoop``, r = (x, v, a, j) of the setpoint now, then one position cycle
    earlier, and so on: what the control keeps of it is known, and no state.
    """

    A: Array  # (n, n)
    B: Array  # (n, 4 (kept + 1))
    C: Array  # (cycles n_outputs, n), the outputs of the first velocity cycle first
    dt: float  # position cycle [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledLoop:
    """A plant under a controller, one velocity cycle as matrices over its n states."""

    plant: Plant  # perhaps in a corner: another than the controller was tuned for
    controller: Controller
    step: Array  # state one cycle later, before the new force and the integrator, (n, n)
    demand: Array  # force asked for, (n,)
    integration: Array  # what the integrator adds, (n,)
    observation: Array  # outputs, (n_outputs, n)
    by_state: Array  # what the position cycle hands down, over the state, (n_held, n) ...
    by_setpoint: Array  # ... and over r as in ``LiftedLoop``, (n_held, 4 (kept + 1))
    sensed: Array
    """What an error of the encoder adds to the state one velocity cycle later, and where a position
    cycle begins, one position cycle later, shape (2, n) [1/m]."""
    held: int  # first state that holds what is handed down
    states: tuple[str, ...]
    outputs: tuple[str, ...]  # tcp, encoder, force, then the plant's states
    lifted: LiftedLoop = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lifted", _lift(self))

    @property
    def kept(self) -> int:
        """Setpoints before the current one that the control keeps."""
        return int(self.by_setpoint.shape[1]) // len(INPUTS) - 1

    @property
    def cycle(self) -> Array:
        """Linear state one velocity cycle later, force and integrator included, shape (n, n)."""
        cycle = self.step.copy()
        cycle[self.integrator] += self.integration
        cycle[self.integrator + 1] = self.demand
        return cycle

    @property
    def rows(self) -> Array:
        """Outputs, demand, integration and step, one product a velocity cycle, over the state."""
        return np.vstack([self.observation, self.demand, self.integration, self.step])

    @property
    def integrator(self) -> int:
        """Index of the integrator; the pending force follows it."""
        return self.plant.order


def build_loop(plant: Plant, controller: Controller, *, model: Plant) -> SampledLoop:
    """Return the loop of a plant, perhaps in a corner, under a controller with all its gains.

    ``model``: the machine as the controller believes it to be, for its reference state.
    """
    handed_down = hand_down(controller, model)
    names = [f"plant.{name}" for name in plant.states]
    names += ["integrator", "pending_force", "last_encoder"]
    names += ["reference_model"] if controller.reference_model_time else []
    names += [f"filter[{i}].{k}" for i in range(len(controller.force_filters)) for k in range(2)]
    names += [f"observer.{model.states[i]}" for i in controller.observer.states]
    held = len(names)
    names += handed_down.names
    size = len(names)
    cycle = _open_loop_cycle if controller.follows else _velocity_cycle
    step, demand, integration = cycle(plant, controller, handed_down, size=size)
    by_state = np.zeros((size - held, size))
    by_state[:, : plant.order] = np.outer(handed_down.by_encoder, plant.row("encoder"))
    unit = np.eye(size)
    P, force = unit[: plant.order], unit[plant.order + 1]
    sensed = np.zeros((2, size))
    sensed[0] = step[:, -1]
    sensed[0, plant.order : plant.order + 2] += integration[-1], demand[-1]
    sensed[1, held:] = handed_down.by_encoder
    return SampledLoop(
        plant=plant,
        controller=controller,
        step=step[:, :-1],
        demand=demand[:-1],
        integration=integration[:-1],
        observation=np.vstack([plant.row("tcp") @ P, plant.row("encoder") @ P, force, P]),
        by_state=by_state,
        by_setpoint=handed_down.by_setpoint,
        sensed=sensed,
        held=held,
        states=tuple(names),
        outputs=("tcp", "encoder", "force", *plant.states),
    )


def _velocity_cycle(
    plant: Plant, controller: Controller, handed_down: HandedDown, *, size: int
) -> tuple[Array, Array, Array]:
    """Step matrix, demanded force and integrator increment, as rows over state and encoder error.

    The order of the state is that of ``SampledLoop.states``.
    """
    observer, n, T_v = controller.observer, plant.order, controller.velocity_cycle
    unit = np.eye(size, size + 1)
    P, z, pending, last, modelled = unit[:n], unit[n], unit[n + 1], n + 2, n + 3
    rest = modelled + bool(controller.reference_model_time)
    step = unit.copy()
    A, B = discretise(plant, T_v)
    step[:n] = A @ P + np.outer(B, pending)
    measured = np.array([plant.row(sensor) for sensor in controller.sensors]) @ P
    measured[0, -1] = 1.0
    encoder = measured[0]
    step[last] = encoder

    first = rest + 2 * len(controller.force_filters)
    seen = slice(first, first + len(observer.states))
    own = slice(seen.stop, seen.stop + len(handed_down.names))
    estimate, held = unit[seen], unit[own]
    if observer.states:
        error = measured - observer.C @ estimate
        step[seen] = observer.A @ estimate + np.outer(observer.B, pending) + observer.L @ error
    step[own] = handed_down.advance @ held

    correction = handed_down.correction @ held - handed_down.drive_gain * encoder
    error = correction + handed_down.velocity @ held - (encoder - unit[last]) / T_v
    integrated = error
    if controller.reference_model_time:
        # Only the correction passes the model: the fed-forward velocity already arrives in time.
        share = 1.0 - exp(-T_v / controller.reference_model_time)
        step[modelled] += share * (correction - unit[modelled])
        integrated = error + unit[modelled] - correction
    gains = controller.state_gains[list(observer.states)]
    force = handed_down.force @ held - gains @ estimate
    demand = controller.velocity_gain * (error + z) + force
    for i, item in enumerate(controller.force_filters):
        (A, B, C, D), part = _sampled(item, T_v), slice(rest + 2 * i, rest + 2 * i + 2)
        step[part] = A @ unit[part] + np.outer(B, demand)
        demand = C @ unit[part] + D * demand
    return step, demand, T_v / controller.integral_time * integrated


def _open_loop_cycle(
    plant: Plant, controller: Controller, handed_down: HandedDown, *, size: int
) -> tuple[Array, Array, Array]:
    """The same of an open-loop axis: what is handed down moves it; its acceleration is the "force".

    The states of encoder and integrator are there, and stay zero.
    """
    n, moved = plant.order, [plant.position, plant.velocity, plant.force]
    step, own = np.eye(size, size + 1), slice(n + 3, n + 3 + len(handed_down.names))
    A, B = discretise(plant, controller.velocity_cycle)
    step[:n] = 0.0
    step[:n, :n] = A
    step[:n, moved] = 0.0
    step[:n, own.start : own.start + 3] = A[:, moved]
    step[:n, own.start + 3] = B
    step[own] = handed_down.advance @ step[own]
    demand = handed_down.force @ step[own]
    # The setpoint's own acceleration is shown; what excites the modes has its mean and its slope
    # over a position cycle, which a step of the acceleration inside it makes overshoot.
    step[plant.force] = demand
    step[n : n + 3] = 0.0
    return step, demand, np.zeros(size + 1)


def _lift(loop: SampledLoop) -> LiftedLoop:
    """The linear loop at the position cycle, by advancing unit states."""
    n, z, held = len(loop.states), loop.integrator, loop.held
    X, rows, seen, outputs = np.eye(n), loop.rows, len(loop.outputs), []
    for _ in range(loop.controller.cycles):
        Y = rows @ X
        outputs.append(Y[:seen])
        X = Y[seen + 2 :]
        X[z] += Y[seen + 1]
        X[z + 1] = Y[seen]
    X[held:] = loop.by_state
    B = np.zeros((n, loop.by_setpoint.shape[1]))
    B[held:] = loop.by_setpoint
    return LiftedLoop(A=X, B=B, C=np.vstack(outputs), dt=loop.controller.position_cycle)


def hand_down_setpoints(loop: SampledLoop, references: Array) -> Array:
    """Return what setpoints, one each position cycle, hand down, shape (n_cycles, ..., n_held).

    ``references``: x_ref, v_ref, a_ref, j_ref, shape (n_cycles, ..., 4), at rest at 0 before.
    """
    count, weights = len(references), loop.by_setpoint.reshape(-1, loop.kept + 1, len(INPUTS))
    found = np.zeros((*references.shape[:-1], len(weights)))
    for back in np.flatnonzero(weights.any(axis=(0, 2))):
        found[back:] += references[: max(count - back, 0)] @ weights[:, back].T
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StateSpace:
    """The lifted loop with the kept setpoints as states: X⁺ = A X + B r, Y = C X + D r.

    r = (x, v, a, j) of the setpoint now.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float  # position cycle [s]
    states: tuple[str, ...]  # those of the loop, then the kept setpoints, newest first


def as_state_space(loop: SampledLoop) -> StateSpace:
    """Return a loop for whoever simulates it with the setpoint of each position cycle alone."""
    lifted, now, n = loop.lifted, len(INPUTS), len(loop.states)
    memory = now * loop.kept
    unit, nothing = np.eye(memory, k=-now), np.zeros((memory, n))
    return StateSpace(
        A=np.block([[lifted.A, lifted.B[:, now:]], [nothing, unit]]),
        B=np.vstack([lifted.B[:, :now], np.eye(memory, now)]),
        C=np.hstack([lifted.C, np.zeros((len(lifted.C), memory))]),
        D=np.zeros((len(lifted.C), now)),
        dt=lifted.dt,
        states=loop.states + tuple(f"{x}[-{k}]" for k in range(1, loop.kept + 1) for x in INPUTS),
    )
