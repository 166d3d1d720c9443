"""The matrices of the loop: one assembly for every engine, held to ``diagram`` by a test.

Which path carries which dead time:

- What the position cycle computes (``handed_down``) reaches the velocity controller one position
  cycle later: held, or as polynomials. Wanted velocity and reference state are taken from the
  setpoint τ less the age they have by then, so that they arrive at their comparison τ late, like
  the position that is compared (the velocity T_v/2 later still, see below).
- The velocity controller samples at the velocity cycle; its force acts one velocity cycle
  later and is held. It knows the velocity from the difference of two positions of the encoder,
  which is half a velocity cycle late.

It takes half a millisecond, the diagram some thirty: tuning assembles hundreds of loops, a batch
thousands.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import exp

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.controller import Controller
from mtcommission.loop.model.discrete import Stage, discretise, discretise_filter
from mtcommission.loop.model.handed_down import HandedDown, hand_down
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

INPUTS = ("x_ref", "v_ref", "a_ref", "j_ref")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LiftedLoop:
    """The linear loop at the position cycle, X⁺ = A X + B r, Y = C X + D r."""

    A: Array  # (n, n)
    B: Array  # (n, 4)
    C: Array  # (cycles n_outputs, n), the outputs of the first velocity cycle first
    D: Array
    dt: float  # position cycle [s]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]  # ``tcp[0]``, ..., with the velocity cycle in brackets


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledLoop:
    """A plant under a controller, one velocity cycle as matrices over its n states."""

    plant: Plant  # perhaps in a corner: another than the controller was tuned for
    controller: Controller
    step: Array  # state one cycle later, before the new force and the integrator, (n, n)
    demand: Array  # force asked for, (n,)
    integration: Array  # what the integrator adds, (n,)
    observation: Array  # outputs, (n_outputs, n)
    handed_down: Array  # what the position cycle computes, over (state, references), (n_held, n+4)
    sensed: Array
    """What an error of the encoder adds to the state one velocity cycle later, and what, where a
    position cycle begins, to the state one position cycle later, shape (2, n) [1/m]."""
    held: int  # first state that holds what is handed down; the kept setpoint samples follow
    states: tuple[str, ...]
    outputs: tuple[str, ...]  # tcp, encoder, force, then the plant's states
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
    def rows(self) -> Array:
        """Outputs, demand, integration and step, one product a velocity cycle, over the state."""
        return np.vstack([self.observation, self.demand, self.integration, self.step])

    @property
    def integrator(self) -> int:
        """Index of the integrator; the pending force follows it."""
        return self.plant.order

    @property
    def own_size(self) -> int:
        """Number of states without the kept setpoint samples, which end it."""
        return self.held + len(self.handed_down)


def build_loop(plant: Plant, controller: Controller, *, model: Plant) -> SampledLoop:
    """Return the loop of a plant, perhaps in a corner, under a controller with all its gains.

    ``model``: the machine as the controller believes it to be, for its reference state.
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
    step[:n, :size] = _drive_by_motion(*followed, plant, held=own.start, size=size)
    step[own] = handed_down.advance @ step[own]
    demand = handed_down.force @ step[own]
    # The setpoint's own acceleration is shown; what excites the modes has its mean and its slope
    # over a position cycle, which a step of the acceleration inside it makes overshoot.
    step[plant.force] = demand
    step[n : n + 3] = 0.0
    return step, demand, np.zeros(size + 1)


def _drive_by_motion(A: Array, B: Array, plant: Plant, *, held: int, size: int) -> Array:
    """Rows of the plant's states; position to jerk are handed down to it from ``held`` on."""
    n, slaves = plant.order, [plant.position, plant.velocity, plant.force]
    rows = np.zeros((n, size))
    rows[:, :n] = A
    rows[:, slaves] = 0.0
    rows[:, held : held + 3] = A[:, slaves]
    rows[:, held + 3] = B
    return rows


def _position_cycle(plant: Plant, handed_down: HandedDown, *, size: int) -> Array:
    """What is handed down, as rows over (state, references)."""
    kept = handed_down.by_setpoint.shape[1] - len(INPUTS)
    rows = np.zeros((len(handed_down.names), size + len(INPUTS)))
    rows[:, size:] = handed_down.by_setpoint[:, : len(INPUTS)]
    rows[:, size - kept : size] = handed_down.by_setpoint[:, len(INPUTS) :]
    rows[:, : plant.order] = np.outer(handed_down.by_encoder, plant.row("encoder"))
    return rows


def _lift(loop: SampledLoop) -> LiftedLoop:
    """The linear loop at the position cycle, by advancing unit states and unit references."""
    n, z, own = len(loop.states), loop.integrator, loop.own_size
    unit = np.eye(n + len(INPUTS))
    handed_down = loop.handed_down @ unit
    X, rows, seen, outputs = unit[:n], loop.rows, len(loop.outputs), []
    for _ in range(loop.controller.cycles):
        Y = rows @ X
        outputs.append(Y[:seen])
        X = Y[seen + 2 :]
        X[z] += Y[seen + 1]
        X[z + 1] = Y[seen]
    following = np.vstack([X[: loop.held], handed_down, unit[n:], X[own:]])[:n]
    Y = np.vstack(outputs)
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
