"""An optimal control as the other modules see it: arcs, and the motion that they cause.

Every arc is exact: on it the set force is the output of a small autonomous linear system,

    F_set(t) = output expm(generator (t - t_start)) initial,

which covers bang arcs (generator 0), boundary arcs (closed loop on the constraint) and the
interior arcs of the linear-quadratic problem (Hamiltonian system) alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from math import inf, nan
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Weight
from mtcommission.machine.moves import Move, Positioning
from mtcommission.machine.plant.plant import Plant, driven_at_once
from mtcommission.optimal.exponential import balanced_expm, powers_of

Array = NDArray[np.float64]

SAME = 1e-10
"""Relative distance of two lengths that one matrix exponential serves."""

STILL, ONE = np.zeros((1, 1)), np.ones(1)
"""Generator and output of every constant force: one object, so that arcs are seen to be alike."""


@dataclass(frozen=True, slots=True)
class Bang:
    """Full force, of the sign ``side``."""

    side: int


@dataclass(frozen=True, slots=True)
class Boundary:
    """Holding a bound of ``signal`` on its upper (+1) or lower (-1) side."""

    signal: str
    side: int


@dataclass(frozen=True, slots=True)
class Interior:
    """A force between its limits, with no bound held."""


@dataclass(frozen=True, slots=True)
class Ramp:
    """Full jerk, of the sign ``side``."""

    side: int


ArcControl = Bang | Boundary | Interior | Ramp
"""What an arc does."""


def control_text(control: ArcControl) -> str:
    """Return what an arc does as records and the terminal name it.

    Examples
    --------
    >>> [control_text(control) for control in (Bang(-1), Boundary("v_phi", 1), Interior())]
    ['-F_max', 'boundary:v_phi:+', 'interior']
    """
    match control:
        case Bang(side):
            return "+F_max" if side > 0 else "-F_max"
        case Boundary(signal, side):
            return f"boundary:{side_text(signal, side)}"
        case Interior():
            return "interior"
        case Ramp(side):
            return "+j_max" if side > 0 else "-j_max"


def side_text(signal: str, side: int) -> str:
    """Return one side of a bound, such as ``"v_phi:+"``."""
    return f"{signal}:{'+' if side > 0 else '-'}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arc:
    """One piece of the control, with F_set(t) = output expm(generator (t - t_start)) initial."""

    # t_start, t_end: Ends of the arc [s].
    t_start: float
    t_end: float
    control: ArcControl  # What it does
    # generator, initial, output: Shapes (k, k), (k,), (k,) [1/s, -, N].
    generator: Array
    initial: Array
    output: Array

    @property
    def length(self) -> float:
        """Duration [s]."""
        return self.t_end - self.t_start


def join_arcs(arcs: Sequence[Arc]) -> tuple[Arc, ...]:
    """Return the arcs that a reader counts, to be shown: pieces in a row that do the same are one.

    Examples
    --------
    >>> from itertools import pairwise
    >>> times = (0.0, 0.1, 0.3, 0.4)
    >>> arcs = [constant_arc(a, b, control=Interior(), force=a) for a, b in pairwise(times)]
    >>> [(arc.t_start, arc.t_end) for arc in join_arcs(arcs)]
    [(0.0, 0.4)]
    """
    runs = [tuple(run) for _, run in groupby(arcs, key=lambda arc: arc.control)]
    return tuple(replace(run[0], t_end=run[-1].t_end) for run in runs)


@dataclass(frozen=True, slots=True, kw_only=True)
class TouchPoint:
    """An instant at which a bound is touched and left at once."""

    t: float  # [s]
    signal: str  # The bounded signal
    side: int  # +1 or -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """A symmetric bound on a state or output."""

    name: str  # State or output of the plant
    value: float  # Largest magnitude, in the signal's SI unit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """Sampled motion."""

    t: Array  # Shape (n_samples,) [s]
    force: Array  # F_set, shape (n_samples,) [N]; at a switch the value after it
    states: Array  # Shape (n_samples, n), columns as ``Plant.states``


def terminal_target(plant: Plant, move: Move) -> tuple[Array, NDArray[np.bool_]]:
    """Return the state at the end of a move, and which of its entries are prescribed.

    Source: Christiansen, Maurer & Zirn, eq. (3).
    """
    target, fixed = np.zeros(plant.order), np.ones(plant.order, dtype=np.bool_)
    if isinstance(move, Positioning):
        target[plant.position] = move.distance
    else:
        target[plant.velocity] = move.velocity_step
        fixed[plant.position] = False
    return target, fixed


def constant_arc(t_start: float, t_end: float, *, control: ArcControl, force: float) -> Arc:
    """Return an arc of constant force."""
    return Arc(
        t_start=t_start,
        t_end=t_end,
        control=control,
        generator=STILL,
        initial=np.array([force]),
        output=ONE,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """Arcs in a row of one flow and length, that are followed together."""

    arcs: tuple[Arc, ...]
    joint: Array  # generator of plant and arc, see ``joint_system``
    begins: Array  # states of plant and arc where each begins, shape (n_arcs, n + k)
    final: Array  # and where the last one ends, shape (n + k,)


def follow_runs(plant: Plant, arcs: Sequence[Arc]) -> Iterator[Run]:
    """Follow arcs from rest, those in a row that are alike together.

    The plant is one of ``driven_at_once``.

    Source: variation of constants; the input is appended to the state (Van Loan 1978).
    """
    x, start = np.zeros(plant.order), 0
    while start < len(arcs):
        first, stop = arcs[start], start + 1
        while stop < len(arcs) and _is_alike(first, arcs[stop]):
            stop += 1
        run, joint = tuple(arcs[start:stop]), joint_system(plant, first)
        flow = balanced_expm(joint * first.length)
        begins = np.empty((len(run), len(joint)))
        for i, arc in enumerate(run):
            begins[i] = np.concatenate([x, arc.initial])
            z = flow @ begins[i]
            # The pieces of a long arc differ by rounding; the next term would be of order SAME².
            final = z + (arc.length - first.length) * (joint @ z)
            x = final[: plant.order]
        yield Run(arcs=run, joint=joint, begins=begins, final=final)
        start = stop


def _is_alike(one: Arc, other: Arc) -> bool:
    is_one = one.generator is other.generator and one.output is other.output
    return is_one and abs(one.length - other.length) <= SAME * one.length


def propagate(plant: Plant, arcs: tuple[Arc, ...]) -> Array:
    """Return the state after all arcs, starting at rest; exact up to rounding."""
    moved = driven_at_once(plant)
    *_, last = follow_runs(moved, arcs)
    return np.append(last.final[: moved.order], np.zeros(plant.order - moved.order))


def sample_trajectory(plant: Plant, arcs: tuple[Arc, ...], *, step: float) -> Trajectory:
    """Return the motion under the arcs, sampled evenly inside each arc and at each switch.

    Of short arcs in a row of one law and length, only as many as the step asks for.
    """
    moved = driven_at_once(plant)
    n, times, forces, states = moved.order, [], [], []
    for run in follow_runs(moved, arcs):
        length, output = run.arcs[0].length, run.arcs[0].output
        count, every = max(1, int(np.ceil(length / step))), max(1, int(step / length))
        flow = balanced_expm(run.joint * (length / count))
        motion = powers_of(flow, run.begins[::every], count).swapaxes(0, 1)
        begins = np.array([arc.t_start for arc in run.arcs[::every]])
        times.append((begins[:, None] + np.arange(count) * length / count).ravel())
        forces.append((motion[:, :-1, n:] @ output).ravel())
        states.append(motion[:, :-1, :n].reshape(-1, n))
    force = np.append(np.concatenate(forces), run.final[n:] @ output)
    return Trajectory(
        t=np.concatenate([*times, [arcs[-1].t_end]]),
        force=force,
        states=_with_force(plant, np.concatenate([*states, run.final[None, :n]]), force),
    )


def _with_force(plant: Plant, states: Array, force: Array) -> Array:
    """Return sampled states of a plant, given those of ``driven_at_once``: F is what is set."""
    return states if states.shape[1] == plant.order else np.column_stack([states, force])


def joint_system(plant: Plant, arc: Arc) -> Array:
    """Return the generator of plant and arc together, shape (n + k, n + k) [1/s].

    The plant is one of ``driven_at_once``.
    """
    n, k = plant.order, arc.initial.size
    joint = np.zeros((n + k, n + k))
    joint[:n, :n] = plant.A
    joint[:n, n:] = np.outer(plant.B, arc.output)
    joint[n:, n:] = arc.generator
    return joint


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Certificate:
    """What proves a time-optimal control; see docs/optimal-control.md for what each part means."""

    # No admissible control reaches the target sooner [s]; from a dual feasible point.
    t_f_lower_bound: float
    relative_gap: float  # (t_f - t_f_lower_bound) / t_f
    # λ(0), shape (n,), normalised by H = 1 + λ(Ax + B F_set) = 0 as in the paper's eq. (7).
    adjoint_initial: Array
    # dσ/dt at each switching time, σ = λB (λ_F / T behind a lag), shape (n_switches,).
    switching_slopes: Array
    # Whether F_set = -sign(λB) F_max on the whole interval (off boundary arcs).
    switching_law_holds: bool
    # Rank of the Jacobian of the terminal conditions over switching times and t_f; -1 where
    # it is not square or does not apply.
    terminal_jacobian_rank: int
    # Its condition number after scaling; nan where it does not apply.
    terminal_jacobian_condition: float


TIGHT_GAP = 1e-6
"""Relative distance of t_f from its proved bound above which a reader is told of it."""


EXCEEDED = 1e-6
"""Relative excess over max_velocity that is worth a remark."""


class MotionPeaks(Protocol):
    """What a control does to a plant."""

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals`` on [0, t_f]."""

    @property
    def force_peak(self) -> float:
        """Largest magnitude of what is set [N]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Law:
    """What proves a damping-optimal control: the problem is convex, so the law is enough."""

    adjoint_initial: Array  # λ(0), shape (n,)
    law_residual: float  # Largest |F_set - Proj(-λB / 2)| / F_max over [0, t_f], eq. (16).


Proof = TypeVar("Proof", Certificate, Law)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Optimum(Generic[Proof]):
    """An optimal control: of least time, free or under bounds, or of least cost, eq. (5)."""

    move: Move  # Velocity step or positioning move
    force_limit: float  # Force left for motion [N]
    bounds: tuple[Bound, ...]  # On states and outputs; under cost only a transcription takes them
    method: str  # ``"exact"`` or ``"transcription"``
    t_f: float  # Final time [s]
    arcs: tuple[Arc, ...]  # In order, without gaps, from 0 to t_f
    touch_points: tuple[TouchPoint, ...] = ()  # Where a bound is touched without a boundary arc
    terminal_error: Array  # State at t_f minus target, shape (n,); 0 for a free state
    motion: MotionPeaks  # Tells the peaks of all signals
    certificate: Proof  # The proof
    jerk_limit: float = inf  # Of a motor that follows [m/s³]; inf: the acceleration may jump
    weights: tuple[Weight, ...] = ()  # c_i of the cost by state
    # Parts of the cost: first of F_set², then one for each weight [N² s]; none of a least time.
    cost_terms: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def kind(self) -> str:
        """What is least: ``"time"`` or ``"damping"``."""
        return "time" if isinstance(self.certificate, Certificate) else "damping"

    @property
    def cost(self) -> float:
        """Value of the functional [N² s]; nan of a least time."""
        return float(self.cost_terms.sum()) if self.cost_terms.size else nan

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals`` on [0, t_f].

        Searched for whenever it is read, where ``motion`` does not hold it.
        """
        return self.motion.peaks

    @property
    def switching_times(self) -> tuple[float, ...]:
        """Ends of all arcs but the last [s]."""
        return tuple(arc.t_end for arc in self.arcs[:-1])


TimeOptimum = Optimum[Certificate]
DampingOptimum = Optimum[Law]
AnyOptimum = TimeOptimum | DampingOptimum


def excess_velocity(plant: Plant, damping: AnyOptimum) -> float:
    """Return the share by which a control exceeds its move's max_velocity, 0 where it does not."""
    move = damping.move
    if not isinstance(move, Positioning):
        return 0.0
    excess = float(damping.peaks[plant.velocity]) / move.max_velocity - 1.0
    return excess if excess > EXCEEDED else 0.0
