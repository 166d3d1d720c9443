"""The matrices of the loop, quickly: one assembly for every engine, held to ``diagram`` by a test.

Which path carries which dead time:

- What the position cycle computes (``handed_down``) reaches the velocity controller one position
  cycle later: held, or as polynomials. Wanted velocity and reference state are taken from the
  setpoint τ less the age they have by then, so that they arrive at their comparison τ late, like
  the position that is compared (the velocity T_v/2 later still, see below).
- The velocity controller samples at the velocity cycle; its force acts one velocity cycle
  later and is held. It knows the velocity from the difference of two positions of the encoder,
  which is half a velocity cycle late.

The same step advances numbers (a simulation, with saturation) and unit vectors (the matrices
of the linear loop), so the two cannot differ. It takes half a millisecond, the diagram some
thirty: tuning assembles hundreds of loops, a batch thousands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from math import exp, inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.controller import Controller
from mtcommission.loop.model.discrete import (
    Stage,
    discretise,
    discretise_filter,
)
from mtcommission.loop.model.friction import Friction
from mtcommission.loop.model.handed_down import HandedDown, hand_down
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

INPUTS = ("x_ref", "v_ref", "a_ref", "j_ref")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LiftedLoop:
    """The linear loop at the position cycle, X⁺ = A X + B r, Y = C X + D r.

    Parameters
    ----------
    A, B, C, D
        Shapes (n, n), (n, 4), (cycles n_outputs, n), (cycles n_outputs, 4); the outputs of the
        first velocity cycle come first.
    dt
        Position cycle [s].
    states, inputs, outputs
        Names; an output is ``tcp[0]``, ..., with the velocity cycle in brackets.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledLoop:
    """A plant under a controller, ready to be advanced by position cycles.

    Parameters
    ----------
    plant, controller
        What it was built from; the plant may differ from the one the controller was tuned for.
    step
        State one velocity cycle later, before the new force and the integrator, shape (n, n).
    demand
        Force asked for, as a row over the state, shape (n,).
    integration
        What the integrator adds in a velocity cycle, shape (n,).
    observation
        Outputs at a velocity cycle, shape (n_outputs, n).
    handed_down
        What the position cycle computes, over (state, references), shape (n_held, n + 4).
    sensed
        What an error of the encoder adds to the state one velocity cycle later, and what, where a
        position cycle begins, to the state one position cycle later, shape (2, n) [1/m].
    held
        Index of the first state that holds it; the kept setpoint samples follow them.
    states
        Names of the loop's states.
    outputs
        Names per velocity cycle: tcp, encoder, force, then the plant's states.
    lifted
        The same loop, linear, at the position cycle.
    """

    plant: Plant
    controller: Controller
    step: Array
    demand: Array
    integration: Array
    observation: Array
    handed_down: Array
    sensed: Array
    held: int
    states: tuple[str, ...]
    outputs: tuple[str, ...]
    lifted: LiftedLoop = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lifted", _lift(self))

    @property
    def cycle(self) -> Array:
        """Linear state one velocity cycle later, force and integrator included, shape (n, n)."""
        cycle = self.step.copy()
        cycle[self.integrator] += self.integration
        cycle[self.integrator + 1] = self.demand
        return cycle

    @property
    def integrator(self) -> int:
        """Index of the integrator; the pending force follows it."""
        return self.plant.order

    @property
    def own_size(self) -> int:
        """Number of states without the kept setpoint samples, which end it."""
        return self.held + len(self.handed_down)


def build_loop(plant: Plant, controller: Controller, *, model: Plant) -> SampledLoop:
    """Return the loop of a plant under a controller.

    Parameters
    ----------
    plant
        The machine as it is (perhaps in a corner).
    controller
        All gains.
    model
        The machine as the controller believes it to be, for its reference state.

    Returns
    -------
    SampledLoop
    """
    handed_down = hand_down(controller, model)
    delays = handed_down.by_setpoint.shape[1] // len(INPUTS) - 1
    filters = tuple(discretise_filter(item, controller) for item in controller.force_filters)
    names = [f"plant.{name}" for name in plant.states]
    names += ["integrator", "pending_force", "last_encoder"]
    names += ["reference_model"] if controller.reference_model_time else []
    names += [f"filter[{i}].{k}" for i, stage in enumerate(filters) for k in range(len(stage.B))]
    names += [f"observer.{model.states[i]}" for i in controller.observer.states]
    held = len(names)
    names += handed_down.names
    names += [f"{name}[-{k}]" for k in range(1, delays + 1) for name in INPUTS]
    if controller.follows:
        step, demand, integration = _followed_cycle(plant, controller, handed_down, size=len(names))
    else:
        step, demand, integration = _velocity_cycle(
            plant, controller, filters, handed_down, size=len(names)
        )
    unit = np.eye(len(names))
    P = unit[: plant.order]
    sensed = np.zeros((2, len(names)))
    sensed[0] = step[:, -1]
    sensed[0, plant.order : plant.order + 2] += integration[-1], demand[-1]
    sensed[1, held : held + len(handed_down.names)] = handed_down.by_encoder
    return SampledLoop(
        plant=plant,
        controller=controller,
        step=step[:, :-1],
        demand=demand[:-1],
        integration=integration[:-1],
        observation=np.vstack(
            [plant.row("tcp") @ P, plant.row("encoder") @ P, unit[plant.order + 1], P]
        ),
        handed_down=_position_cycle(plant, handed_down, size=len(names)),
        sensed=sensed,
        held=held,
        states=tuple(names),
        outputs=("tcp", "encoder", "force", *plant.states),
    )


def _velocity_cycle(
    plant: Plant,
    controller: Controller,
    filters: tuple[Stage, ...],
    handed_down: HandedDown,
    *,
    size: int,
) -> tuple[Array, Array, Array]:
    """Step matrix, demanded force and integrator increment, as rows over state and encoder error.

    The order of the state is that of ``SampledLoop.states``; only the kept setpoint samples
    at its end do not take part.
    """
    observer, n, T_v = controller.observer, plant.order, controller.velocity_cycle
    unit = np.eye(size, size + 1)
    P, z, pending, last, rest = unit[:n], unit[n], unit[n + 1], n + 2, n + 3
    if controller.reference_model_time:
        modelled, rest = rest, rest + 1
    step = unit.copy()
    A, B = discretise(plant, T_v)
    step[:n] = A @ P + np.outer(B, pending)
    measured = np.array([plant.row(sensor) for sensor in controller.sensors]) @ P
    measured[0, -1] = 1.0
    encoder = measured[0]
    step[last] = encoder

    first_observer = rest + sum(len(stage.B) for stage in filters)
    seen = slice(first_observer, first_observer + len(observer.states))
    own = slice(seen.stop, seen.stop + len(handed_down.names))
    estimate, held = unit[seen], unit[own]
    step[seen] = (
        observer.A @ estimate
        + np.outer(observer.B, pending)
        + observer.L @ (measured - observer.C @ estimate)
    )
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
    for stage in filters:
        part = slice(rest, rest + len(stage.B))
        step[part] = stage.A @ unit[part] + np.outer(stage.B, demand)
        demand = stage.C @ unit[part] + stage.D * demand
        rest = part.stop
    return step, demand, T_v / controller.integral_time * integrated


def _followed_cycle(
    plant: Plant, controller: Controller, handed_down: HandedDown, *, size: int
) -> tuple[Array, Array, Array]:
    """The same where the motor follows what is handed down; its acceleration is the "force".

    The states of encoder and integrator are there, and stay zero.
    """
    n = plant.order
    step, own = np.eye(size, size + 1), slice(n + 3, n + 3 + len(handed_down.names))
    followed = discretise(plant, controller.velocity_cycle)
    step[:n] = 0.0
    step[:n, :size] = drive_by_motion(*followed, plant, held=own.start, size=size)
    step[own] = handed_down.advance @ step[own]
    demand = handed_down.force @ step[own]
    # The setpoint's own acceleration is shown; what excites the modes has its mean and its slope
    # over a position cycle, which a step of the acceleration inside it makes overshoot.
    step[plant.force] = demand
    step[n : n + 3] = 0.0
    return step, demand, np.zeros(size + 1)


def drive_by_motion(A: Array, B: Array, plant: Plant, *, held: int, size: int) -> Array:
    """Return the rows of a plant's states where the motion is handed down to it.

    Parameters
    ----------
    A, B
        Of one plant or many, from ``discretise``, shapes (..., n, n), (..., n).
    plant
        The nominal one.
    held
        Index of the position that is handed down; velocity, acceleration and jerk follow it.
    size
        Number of the loop's states.

    Returns
    -------
    ndarray, shape (..., n, size)
    """
    n, slaves = plant.order, [plant.position, plant.velocity, plant.force]
    rows = np.zeros((*A.shape[:-1], size))
    rows[..., :n] = A
    rows[..., slaves] = 0.0
    rows[..., held : held + 3] = A[..., slaves]
    rows[..., held + 3] = B
    return rows


def _position_cycle(plant: Plant, handed_down: HandedDown, *, size: int) -> Array:
    """What is handed down, as rows over (state, references)."""
    kept = handed_down.by_setpoint.shape[1] - len(INPUTS)
    rows = np.zeros((len(handed_down.names), size + len(INPUTS)))
    rows[:, size:] = handed_down.by_setpoint[:, : len(INPUTS)]
    rows[:, size - kept : size] = handed_down.by_setpoint[:, len(INPUTS) :]
    rows[:, : plant.order] = np.outer(handed_down.by_encoder, plant.row("encoder"))
    return rows


def advance_cycle(
    loop: SampledLoop,
    X: Array,
    references: Array,
    *,
    force_limit: float = inf,
    friction: Friction | None = None,
) -> tuple[Array, Array]:
    """Return the loop one position cycle later, and its outputs at each velocity cycle.

    Parameters
    ----------
    loop
        The loop.
    X
        States, shape (n, m): m independent columns.
    references
        x_ref, v_ref, a_ref, j_ref now, shape (4, m).
    force_limit
        Saturation of the set force [N]; the integrator stands still while it acts.
    friction
        Of the loop's plant, if any.

    Returns
    -------
    X_next
        Shape (n, m).
    outputs
        Shape (cycles, n_outputs, m).
    """
    z, held, own = loop.integrator, loop.held, loop.own_size
    handed_down = loop.handed_down @ np.vstack([X, references])
    outputs = np.empty((loop.controller.cycles, len(loop.outputs), X.shape[1]))
    # One product a velocity cycle: a saturated simulation spends its time here.
    rows = np.vstack([loop.observation, loop.demand, loop.integration, loop.step])
    seen, cycles = len(loop.observation), loop.controller.cycles
    for i in range(cycles):
        Y = rows @ X
        outputs[i] = Y[:seen]
        demand, increment, X = Y[seen], Y[seen + 1], Y[seen + 2 :]
        force = np.minimum(np.maximum(demand, -force_limit), force_limit)
        X[z] += np.where(force == demand, increment, 0.0)
        X[z + 1] = force
        if friction:
            rubbed = X[: loop.plant.order]
            rubbed += np.outer(friction.push, friction.force(rubbed))
    kept = np.vstack([references, X[own:]])[: len(X) - own]
    return np.vstack([X[:held], handed_down, kept]), outputs


def advance_together(
    loops: Sequence[SampledLoop], X: Array, references: Array, *, force_limit: float
) -> tuple[Array, Array]:
    """Return the same controller on several machines one position cycle later, and its outputs.

    ``X``: states, shape (n_loops, n); ``references``: x_ref, v_ref, a_ref, j_ref now, shape (4,).
    Results: (n_loops, n), (n_loops, cycles, n_outputs). As ``advance_cycle``, without friction.
    """
    first = loops[0]
    z, held, own = first.integrator, first.held, first.own_size
    # What is handed down by the encoder differs from machine to machine.
    known = np.hstack([X, np.tile(references, (len(loops), 1))])
    handed_down = np.array([one.handed_down @ row for one, row in zip(loops, known, strict=True)])
    rows, seen = _stacked(tuple(loops)), len(first.observation)
    outputs = np.empty((len(loops), first.controller.cycles, seen))
    following = X
    for i in range(first.controller.cycles):
        Y = (rows @ following[:, :, None])[:, :, 0]
        outputs[:, i] = Y[:, :seen]
        demand, increment, following = Y[:, seen], Y[:, seen + 1], Y[:, seen + 2 :]
        force = np.minimum(np.maximum(demand, -force_limit), force_limit)
        following[:, z] += np.where(force == demand, increment, 0.0)
        following[:, z + 1] = force
    kept = np.hstack([np.tile(references, (len(loops), 1)), following[:, own:]])
    kept = kept[:, : X.shape[1] - own]
    return np.hstack([following[:, :held], handed_down, kept]), outputs


@lru_cache(maxsize=8)
def _stacked(loops: tuple[SampledLoop, ...]) -> Array:
    """Outputs, demand, integration and step of several loops, one product a velocity cycle."""
    return np.array(
        [np.vstack([one.observation, one.demand, one.integration, one.step]) for one in loops]
    )


def _lift(loop: SampledLoop) -> LiftedLoop:
    """The linear loop at the position cycle, by advancing unit states and unit references."""
    n = len(loop.states)
    unit = np.eye(n + 4)
    following, outputs = advance_cycle(loop, unit[:n], unit[n:])
    Y = outputs.reshape(-1, n + 4)
    names = [f"{name}[{i}]" for i in range(loop.controller.cycles) for name in loop.outputs]
    return LiftedLoop(
        A=following[:, :n],
        B=following[:, n:],
        C=Y[:, :n],
        D=Y[:, n:],
        dt=loop.controller.position_cycle,
        states=loop.states,
        inputs=INPUTS,
        outputs=tuple(names),
    )


def lift_on_plants(loop: SampledLoop, A: Array, B: Array, *, signals: Array) -> Array:
    """Return the loop on many plants at the position cycle, without the kept setpoint samples.

    Parameters
    ----------
    loop
        The same controller on one of them.
    A, B
        The plants over a velocity cycle, shapes (n_plants, n, n), (n_plants, n); followed ones
        where the motor follows.
    signals
        Rows over the loop's state (``own_size`` columns), shape (n_signals, n).

    Returns
    -------
    ndarray
        Shape (n_plants, n + (n_signals + 1) cycles, n). The first n rows are A in X⁺ = A X plus
        what the setpoint hands down; then each signal at each velocity cycle, as rows over X;
        then the tool position. One product is faster than three.
    """
    n, size = loop.plant.order, loop.own_size
    cycle = np.repeat(loop.cycle[None, :size, :size], len(A), axis=0)
    if loop.controller.follows:
        modal = [i for mode in loop.plant.modes for i in (mode.deflection, mode.rate)]
        rows = drive_by_motion(A, B, loop.plant, held=loop.held, size=size)
        cycle[:, modal] = rows[:, modal]
    else:
        cycle[:, :n, :n], cycle[:, :n, loop.integrator + 1] = A, B
    rows = np.repeat(np.vstack([signals, loop.observation[:1, :size]])[None], len(A), axis=0)
    pieces = []
    for _ in range(loop.controller.cycles):
        pieces.append(rows)
        rows = rows @ cycle
    lifted = np.linalg.matrix_power(cycle, loop.controller.cycles)
    lifted[:, loop.held :] = loop.handed_down[:, :size]
    return np.concatenate([lifted, np.stack(pieces, axis=2).reshape(len(A), -1, size)], axis=1)
