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
from scipy.linalg import expm, matrix_balance

from mtcommission.machine.moves import Move, Positioning
from mtcommission.machine.plant.plant import Plant, driven_at_once
from mtcommission.machine.readers import SignalValue

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
    # On states and outputs; under cost only a transcription takes them.
    bounds: tuple[SignalValue, ...]
    method: str  # ``"exact"`` or ``"transcription"``
    t_f: float  # Final time [s]
    arcs: tuple[Arc, ...]  # In order, without gaps, from 0 to t_f
    touch_points: tuple[TouchPoint, ...] = ()  # Where a bound is touched without a boundary arc
    terminal_error: Array  # State at t_f minus target, shape (n,); 0 for a free state
    motion: MotionPeaks  # Tells the peaks of all signals but that of ``set_state``
    set_state: int = -1  # Index of F among the signals, if it is what is set (a motor that follows)
    certificate: Proof  # The proof
    jerk_limit: float = inf  # Of a motor that follows [m/s³]; inf: the acceleration may jump
    weights: tuple[SignalValue, ...] = ()  # c_i of the cost by state
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
        peaks = self.motion.peaks
        if self.set_state < 0:
            return peaks
        return np.insert(peaks, self.set_state, self.motion.force_peak)

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


def balanced_expm(matrix: Array) -> Array:
    """Return the matrix exponential, computed in states of one size.

    States of 1e-6 rad beside forces of 1e3 N make entries of a feedback A + B K twenty decades
    apart. The method scales by the norm and squares again: on a boundary arc of 50 ms twenty-seven
    times instead of five, with a relative error of 1e-9 instead of 1e-14.

    Source: Al-Mohy & Higham (2009), SIAM J. Matrix Anal. Appl. 31, 970 (overscaling); balancing
    by powers of two after Parlett & Reinsch (1969), which rounds nothing.
    """
    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    return np.asarray(expm(balanced) * scale[:, np.newaxis] / scale)


def powers_of(flow: Array, start: Array, count: int) -> Array:
    """Return start, flow start, ... of states in the last axis, shape (count + 1, ..., n)."""
    samples, filled, power = np.empty((count + 1, *start.shape)), 1, flow.T
    samples[0] = start
    while filled <= count:
        more = min(filled, count + 1 - filled)
        np.matmul(samples[:more], power, out=samples[filled : filled + more])
        filled, power = filled + more, power @ power
    return samples


RADIANS_PER_SAMPLE = 0.015
"""Cells for the peaks: the cubic between samples is right to (ω h)^4 / 384 = 1.3e-10."""
BLOCK = 4096
"""Samples at a time: a long arc has millions, and their states would take gigabytes."""
TERMS = 8
"""Of the series of a cell's squares: the next one is below (2 ω h)^8 / 9! = 2e-18."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowedMotion:
    """What a control does."""

    arcs: tuple[Arc, ...]
    final: Array  # State at the end, shape (n,)
    peaks: Array  # Largest magnitude of each of ``Plant.signals``
    force_peak: float  # Largest |F_set| [N]
    effort: float  # Integral of F_set² [N² s]
    squares: Array  # Integrals of the squared states, shape (n,)


def follow_control(plant: Plant, arcs: tuple[Arc, ...], *, rate: float = 0.0) -> FollowedMotion:
    """Return what a plant of ``driven_at_once`` does under the arcs, from rest.

    Cells are short against the plant's fastest rate, and against one of the control [1/s].

    Source: d/dt z z' = J z z' + z z' J' for the joint generator J, so the integral of z z' over
    cells of one length is the power series of that map on the sum of z z' at their starts.
    """
    n, rows, fastest = plant.order, signal_rows(plant).T, max(rate, plant.fastest_rate)
    peaks, force_peak, effort, squares = np.zeros(rows.shape[1]), 0.0, 0.0, np.zeros(n)
    for run in follow_runs(plant, arcs):
        length, output, joint = run.arcs[0].length, run.arcs[0].output, run.joint.T
        count = int(np.ceil(length * fastest / RADIANS_PER_SAMPLE)) + 1
        step, together, starts = length / count, max(1, BLOCK // count), np.zeros_like(joint)
        flow = balanced_expm(run.joint * step)
        for first in range(0, len(run.arcs), together):
            z = run.begins[first : first + together]
            for done in range(0, count, BLOCK):
                along = powers_of(flow, z, min(BLOCK, count - done))
                values, rates = along[..., :n] @ rows, (along @ joint)[..., :n] @ rows
                peaks = np.maximum(peaks, _largest(step, values, rates))
                force_peak = max(force_peak, float(np.abs(along[..., n:] @ output).max()))
                every = along[:-1].reshape(-1, len(joint))
                starts += every.T @ every
                z = along[-1]
        products = term = starts * step
        for k in range(2, TERMS + 1):
            term = (term @ joint + joint.T @ term) * (step / k)
            products = products + term
        effort += float(output @ products[n:, n:] @ output)
        squares += np.diag(products)[:n]
    return FollowedMotion(
        arcs=arcs,
        final=run.final[:n],
        peaks=peaks,
        force_peak=force_peak,
        effort=effort,
        squares=squares,
    )


def _largest(step: float, values: Array, rates: Array) -> Array:
    """Return the peaks along some arcs, values and rates of shape (n_samples, n_arcs, k)."""
    start, end, start_rate, end_rate = (
        part.reshape(-1, values.shape[-1])
        for part in (values[:-1], values[1:], rates[:-1], rates[1:])
    )
    steps = np.full(len(start), step)
    return hermite_peaks(steps, start, end, start_rate=start_rate, end_rate=end_rate)


def signal_rows(plant: Plant) -> Array:
    """Return the rows c with signal = c x for all ``Plant.signals``."""
    return np.vstack([np.eye(plant.order), plant.C])


def unit_cubics(
    step: Array, start: Array, end: Array, *, start_rate: Array, end_rate: Array
) -> Array:
    """Return the cubic in each cell that takes the values and derivatives at its ends."""
    rise, first, last = end - start, step * start_rate, step * end_rate
    return np.stack([first + last - 2.0 * rise, 3.0 * rise - 2.0 * first - last, first, start])


def hermite_peaks(
    step: Array, start: Array, end: Array, *, start_rate: Array, end_rate: Array
) -> Array:
    """Return the largest magnitude of each signal, interpolated cubically in each cell.

    Examples
    --------
    >>> t = np.linspace(0.0, 3.0, 31)[:, None]
    >>> y, dy = np.sin(t), np.cos(t)
    >>> peak = hermite_peaks(np.diff(t[:, 0]), y[:-1], y[1:], start_rate=dy[:-1], end_rate=dy[1:])
    >>> bool(abs(peak[0] - 1.0) < 1e-6)
    True
    """
    largest = np.maximum(np.abs(start).max(axis=0), np.abs(end).max(axis=0))
    reach = step[:, None] / 3.0
    inner = np.maximum(np.abs(start + reach * start_rate), np.abs(end - reach * end_rate))
    # A cubic stays within its control points: few cells can exceed what their ends reach.
    may_exceed = np.flatnonzero((inner > largest).any(axis=1))
    cube, square, first, start = unit_cubics(
        step[may_exceed, None],
        start[may_exceed],
        end[may_exceed],
        start_rate=start_rate[may_exceed],
        end_rate=end_rate[may_exceed],
    )
    root = np.sqrt(np.maximum(square**2 - 3.0 * first * cube, 0.0))
    # both roots of first + 2 square s + 3 cube s², in the form that does not cancel
    q = -(square + np.copysign(root, square))
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.clip(np.nan_to_num(np.stack([q / (3.0 * cube), first / q])), 0.0, 1.0)
    inside = start + places * (first + places * (square + places * cube))
    return np.asarray(np.maximum(largest, np.abs(inside).max(axis=(0, 1), initial=0.0)))
