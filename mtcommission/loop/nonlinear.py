"""What is not linear, stepped through the velocity cycles: a saturated set force, friction.

Friction on the line of the drive is a law between force and velocity over one cycle:

    F = -F_c sign(v) - d v,   |F| <= F_c at rest

v is the velocity between motor and guide, i.e. that of the encoder. The law is solved at the end
of the cycle together with the motion (time stepping after Moreau): the force of the cycle is the
one with which the velocity obeys the law, or stops. So the axis sticks exactly, at any cycle, and
without the slope at zero velocity of a tanh model, which lets a loaded axis creep.

Source: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, CISM 302,
1988; D. Karnopp, ASME J. Dyn. Sys. 107 (1985) 100-103 for stick as a state of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop, discretise_disturbance
from mtcommission.loop.motions import FORCE
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Friction:
    """Friction of a plant over one velocity cycle."""

    coulomb: float  # F_c [N]
    viscous: float  # d [N s/m]
    velocity: Array  # that rubs, as a row over the plant's states, shape (n,)
    push: Array  # what 1 N over the cycle adds to the state, shape (n,)

    def force(self, free: Array) -> Array:
        """Return the force of the cycle, of plant states at its end without friction, (n, m)."""
        v, gain = self.velocity @ free, float(self.velocity @ self.push)
        sliding = (v - np.sign(v) * gain * self.coulomb) / (1.0 + gain * self.viscous)
        after = np.where(np.abs(v) <= gain * self.coulomb, 0.0, sliding)
        return np.asarray((after - v) / gain)


def find_friction(plant: Plant, *, coulomb: float, viscous: float, step: float) -> Friction | None:
    """Return the friction of a plant over a velocity cycle [s]; None where there is none."""
    if coulomb == 0.0 and viscous == 0.0:
        return None
    return Friction(
        coulomb=coulomb,
        viscous=viscous,
        velocity=plant.row("encoder") @ plant.A,
        push=discretise_disturbance(plant, step),
    )


def step_through(
    loops: Sequence[SampledLoop],
    X: Array,
    references: Array,
    *,
    force_limit: float,
    friction: Friction | None = None,
) -> tuple[Array, Array]:
    """Return the same controller on several machines some position cycles later, and its outputs.

    The set force saturates at ``force_limit`` [N], and the integrator stands still meanwhile.
    ``X``: states, shape (n_loops, n); ``references``: x_ref, v_ref, a_ref, j_ref at each position
    cycle, shape (n_cycles, 4); ``friction``: of the one plant. The outputs at every velocity cycle
    have the shape (n_loops, n_samples, n_outputs).
    """
    first = loops[0]
    z, held, own, seen = first.integrator, first.held, first.own_size, len(first.outputs)
    rows = np.array([loop.rows for loop in loops])
    # What is handed down by the encoder differs from machine to machine.
    handing = np.array([loop.handed_down for loop in loops])
    outputs = np.empty((len(loops), len(references), first.controller.cycles, seen))
    whole, size = np.array([_rows_of_a_cycle(loop) for loop in loops]), X.shape[1]
    # Pending forces of a position cycle, in what ``whole`` makes of it.
    pending = size + seen * np.arange(1, first.controller.cycles) + FORCE
    forces = np.append(z + 1, pending)
    entering = np.empty((len(loops), size + references.shape[1], 1))
    for k, r in enumerate(np.tile(references[:, None], (1, len(loops), 1))):
        entering[:, :size, 0], entering[:, size:, 0] = X, r
        # A position cycle in which nothing saturates or rubs is one product.
        Y = (whole @ entering)[:, :, 0]
        if friction is None and np.abs(Y[:, forces]).max() <= force_limit:
            outputs[:, k], X = Y[:, size:].reshape(outputs[:, k].shape), Y[:, :size]
            continue
        handed_down = (handing @ entering)[:, :, 0]
        for i in range(first.controller.cycles):
            Y = (rows @ X[:, :, None])[:, :, 0]
            outputs[:, k, i] = Y[:, :seen]
            demand, increment, X = Y[:, seen], Y[:, seen + 1], Y[:, seen + 2 :]
            force = np.minimum(np.maximum(demand, -force_limit), force_limit)
            X[:, z] += np.where(force == demand, increment, 0.0)
            X[:, z + 1] = force
            if friction:
                rubbed = X[:, : first.plant.order]
                rubbed += np.outer(friction.force(rubbed.T), friction.push)
        X = np.hstack([X[:, :held], handed_down, r, X[:, own:]])[:, : X.shape[1]]
    return X, outputs.reshape(len(loops), -1, seen)


def _rows_of_a_cycle(loop: SampledLoop) -> Array:
    """State after a position cycle, and outputs during it, over state and references."""
    lifted = loop.lifted
    return np.block([[lifted.A, lifted.B], [lifted.C, lifted.D]])


def step_linear(loop: SampledLoop, X: Array, references: Array) -> Array:
    """Return the outputs at every velocity cycle without saturation, from a state on, (n, n_out).

    ``references``: at each position cycle, shape (n_cycles, 4).
    """
    lifted = loop.lifted
    states = march(lifted.A, X, references @ lifted.B.T)
    outputs = states @ lifted.C.T + references @ lifted.D.T
    return np.asarray(outputs.reshape(-1, len(loop.outputs)))


def march(A: Array, X: Array, pushes: Array) -> Array:
    """Return the states X⁺ = A X + push, the first one included, shape of ``pushes``."""
    # In blocks side by side, each from rest; what each begins with is added afterwards.
    length = ceil(sqrt(len(pushes)))
    blocks = ceil(len(pushes) / length)
    padded = np.zeros((blocks * length, len(A)))
    padded[: len(pushes)] = pushes
    pushed = padded.reshape(blocks, length, len(A))
    from_rest, powers = np.zeros((length + 1, blocks, len(A))), np.empty((length + 1, *A.shape))
    powers[0] = np.eye(len(A))
    for k in range(length):
        from_rest[k + 1] = from_rest[k] @ A.T + pushed[:, k]
        powers[k + 1] = A @ powers[k]
    begins = np.empty((blocks, len(A)))
    for k in range(blocks):
        begins[k] = X
        X = powers[-1] @ X + from_rest[-1, k]
    states = from_rest[:-1] + begins @ powers[:-1].transpose(0, 2, 1)
    return np.asarray(states.swapaxes(0, 1).reshape(-1, len(A))[: len(pushes)])


def drive_loop(
    loop: SampledLoop,
    references: Array,
    *,
    force_limit: float = inf,
    friction: Friction | None = None,
) -> Array:
    """Return the outputs at every velocity cycle of any setpoint, at rest before it, (n, n_out).

    ``references``: at each position cycle, shape (n_cycles, 4); ``force_limit``: of the set force
    [N]; ``friction``: of the loop's plant.
    """
    rest = np.zeros(len(loop.states))
    if friction is None:
        outputs = step_linear(loop, rest, references)
        if float(np.max(np.abs(outputs[:, 2]))) <= force_limit:
            return outputs
    _, stepped = step_through(
        (loop,), rest[None], references, force_limit=force_limit, friction=friction
    )
    return np.asarray(stepped[0])
