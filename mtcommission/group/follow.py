"""How an axis follows contours: circles by its complex response, all else by the loop's poles.

A corner steps the velocity of an axis, the entry of a circle its acceleration; a line moves all
axes in proportion. Behind its filter and its wait, in every corner of the machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.disturbance import simulate_disturbance
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.poles import Cycles, LoopPoles, find_poles
from mtcommission.loop.respond import (
    FORCE,
    TOOL,
    Motions,
    lay_grid,
    outputs_at,
    set_in_motion,
    swing_times,
)
from mtcommission.loop.simulate import drive_loops, friction_of
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SLOWEST, FASTEST, FREQUENCIES = 0.05, 0.3, 320
"""Least angular frequency of a circle [rad/s], the largest times the position cycle [-], and
frequencies between (empirical: to a few nanometres of a circle)."""

PERIODS, LONGEST = 2.0, 2.0
"""Of each pole that an answer is followed, and the longest [s]: by then what an integrator of one
second does is over but for its tail (empirical)."""

PHASES = (0.0, 1e-4, 0.5)
"""At which a step comes within a position cycle: with its sample, which sees all derivatives step
before anything has moved; just behind it, so that the next sample sees all; and between."""

LATE = 100.0
"""End of a step of acceleration, later than anything that is looked at [s]."""

FINER = 4
"""Instants of a position cycle that are looked at."""

ALL_LOOKED_AT, SAMPLES = 4000, 48
"""Position cycles that are all looked at; instants to a period of longer answers (empirical)."""

PAUSE = 1.5
"""How long an axis moves before it reverses, and between two reversals where a circle is made up
for its acceleration, in times of the loop (empirical: a nanometre is left) [-]."""


Circles = tuple[tuple[float, float], ...]
"""Radius [m] and feed [m/s] of each."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Follower:
    """An axis behind a filter, with a wait."""

    machine: Machine
    tuned: TunedLoop  # in every corner, the nominal machine first
    poles: LoopPoles
    omega: Array  # rising, shape (n_omega,) [rad/s]
    on_circles: Complex
    """From the setpoint behind filter and wait to the tool without what the delay turns it by,
    which then hardly bends between two frequencies, (n_corners, n_omega)."""
    setpoint_filter: SetpointFilter | None = None
    wait: float = 0.0  # before the axis begins [s]

    @property
    def delay(self) -> float:
        """From setpoint to tool in slow motion, the filter apart [s]."""
        # The steady answer to a ramp is its velocity times the delay behind it.
        return self.wait - float(self.poles.steady[0, 0, TOOL, 1])

    @property
    def lag(self) -> Array:
        """By how much slow motion comes later than its setpoint, (n_corners,) [s]."""
        return np.asarray(self.reverses - self.poles.steady[:, 0, TOOL, 1], dtype=np.float64)

    @property
    def reverses(self) -> float:
        """By how much an axis reverses later than it is told, by wait and filter [s]."""
        return self.wait + filter_lag(self.setpoint_filter)

    @property
    def fades(self) -> float:
        """How long friction is followed before and after a reversal: the loop's own time [s]."""
        poles = [pole for pole in self.poles.rates[0] if np.isfinite(pole)]
        gone = max((swing_times(pole, PERIODS)[1] for pole in poles), default=LONGEST)
        return min(gone, LONGEST)

    @property
    def step(self) -> float:
        """Time between two instants that are looked at: a quarter of a position cycle or so [s]."""
        return self.poles.dt / len(self._parts)

    @property
    def _parts(self) -> list[int]:
        cycles = self.poles.cycles
        return list(range(0, cycles, max(cycles // FINER, 1)))

    def response(self, omega: Array) -> Complex:
        """Return the complex responses from setpoint to tool, (n_corners, *omega.shape)."""
        turn = filter_response(self.setpoint_filter, omega) * np.exp(-1j * omega * self.delay)
        x, known = np.log(omega), np.log(self.omega)
        parts = [
            np.interp(x, known, one.real) + 1j * np.interp(x, known, one.imag)
            for one in self.on_circles
        ]
        return np.asarray(turn * np.array(parts))

    def cycles(self, duration: float) -> int:
        """Return after how many position cycles the answer to so long a setpoint [s] is over."""
        rings = [swing_times(pole, PERIODS)[0] for pole in self.poles.rates[0] if np.isfinite(pole)]
        rest = float(self.lag.max()) + min(max(rings, default=0.0), LONGEST)
        own = self.setpoint_filter.duration if self.setpoint_filter else 0.0
        return ceil((duration + own + rest) / self.poles.dt) + 2

    def behind_steps(self, steps: JerkSteps) -> Cycles:
        """Return cycles behind each step of setpoints, ever fewer of them, (n_setpoints, n_times).

        As the swings of its poles show in them, however long the setpoints last.
        """
        behind = self.poles.recent + lay_grid(self.poles, SAMPLES).cycle
        behind = np.append(np.arange(self.poles.recent), behind[behind < self.cycles(0.0)])
        first = self._motions(steps).first
        return (first[:, :, None] + behind).reshape(len(first), -1)

    def tool(self, steps: JerkSteps, each: Cycles) -> Array:
        """Return the tool's position in some cycles, (n_setpoints, n_corners, n_times)."""
        found = self._outputs(steps, each, TOOL)[:, :, :, self._parts]
        return np.asarray(found.reshape(*found.shape[:2], -1), dtype=np.float64)

    def to_step(self, derivative: int, starts: Array, cycles: int) -> Array:
        """Return the answers to a step of 1 of a derivative, (n_starts, n_corners, n_times).

        ``derivative``: 1 the velocity, 2 the acceleration; ``starts``: when it comes [s].
        """
        return self.tool(_step_of(derivative, starts), _from_begin(starts, cycles))

    def largest_step(self, starts: Array) -> float:
        """Return the step of velocity [m/s] that takes all of the force, in any corner.

        inf where the motor follows its setpoint: what it can do is then no matter of a force.
        """
        if self.tuned.controller.follows:
            return inf
        each = _from_begin(starts, self.cycles(0.0))
        force = np.abs(self._outputs(_step_of(1, starts), each, FORCE)).max()
        return self.machine.drive.motion_force / float(force)

    def _motions(self, steps: JerkSteps) -> Motions:
        late = replace(steps, times=steps.times + self.wait)
        return set_in_motion(self.poles, filter_steps(late, self.setpoint_filter))

    def _outputs(self, steps: JerkSteps, each: Cycles, output: int) -> Array:
        """An output, (n_setpoints, n_corners, n_cycles, velocity cycles)."""
        found = outputs_at(self._motions(steps), each, np.eye(self.poles.outputs)[output])
        return np.asarray(found[..., 0], dtype=np.float64)

    @lru_cache(maxsize=32)  # noqa: B019 (the group asks, its sheet and its page ask again)
    def reversals(self, circles: Circles, corners: tuple[int, ...] = (0,)) -> Array:
        """Return how friction throws the tool off from a reversal on, at every velocity cycle [m].

        Positive: outwards. Of every circle in every corner, (n_circles, n_corners, n_times), by the
        stepping engine: the motion with friction less that without it; 0 where none is stated.
        """
        drive = self.machine.drive
        if not drive.has_friction:
            return np.zeros((len(circles), len(corners), 1))
        radius, feed = np.repeat(circles, len(corners), axis=0).T
        loops = [self.tuned.loops[corner] for corner in corners] * len(circles)
        gains, omega, fades = loops[0].controller, feed / radius, self.fades
        # It moves off midway between two reversals, and reverses until what that did has faded.
        quarter, run_in = 0.5 * pi / omega, PAUSE * fades
        more = np.ceil(np.maximum(run_in - quarter, 0.0) / (2.0 * quarter))
        before = np.minimum(run_in, quarter) + 2.0 * quarter * more
        t = np.arange(0.0, float(before.max()) + fades, gains.position_cycle)
        size = radius * np.abs(filter_response(self.setpoint_filter, omega))
        phase = omega * (t[:, None] - before)
        setpoint = np.array([np.cos(phase), -np.sin(phase), -np.cos(phase), np.sin(phase)])
        references = np.moveaxis(size * setpoint * omega ** np.arange(4)[:, None, None], 0, 2)
        references[:, :, 0] -= references[0, :, 0]
        rubbing = drive_loops(loops, references, friction=friction_of(loops, drive))
        off = (rubbing - drive_loops(loops, references))[:, :, TOOL]
        begin = np.round(before / gains.velocity_cycle).astype(int)
        count = round(fades / gains.velocity_cycle)
        found = [one[k : k + count] for one, k in zip(off, begin.tolist(), strict=True)]
        return np.array(found).reshape(len(circles), len(corners), count)

    def thrown(self, circles: Circles, most: float) -> dict[float, Array]:
        """Return ``reversals`` of the nominal machine by the acceleration v²/R, on which they hang.

        Those of some circles, and two more up to the largest [m/s²]; empty where no friction is
        stated.
        """
        if not self.machine.drive.has_friction:
            return {}
        last = max(feed**2 / radius for radius, feed in circles)
        feeds = {a: a * PAUSE * self.fades / pi for a in (sqrt(last * most), most) if a > last}
        more = tuple((feed**2 / a, feed) for a, feed in feeds.items())
        found = [self.reversals(some)[:, 0] for some in (circles, more) if some]
        accelerations = [feed**2 / radius for radius, feed in (*circles, *more)]
        return dict(sorted(zip(accelerations, np.concatenate(found), strict=True)))

    def peak_bound(self) -> float:
        """Return what no reversal exceeds: 2 F_c times the peak after a step of force [m]."""
        loops = self.tuned.loops
        worst = max(simulate_disturbance(loop, duration=self.fades).peak for loop in loops)
        return 2.0 * self.machine.drive.coulomb_friction * worst


def follow(
    machine: Machine, tuned: TunedLoop, item: SetpointFilter | None = None, wait: float = 0.0
) -> Follower:
    """Return how a machine in its loop follows contours."""
    poles = find_poles(tuned.loops)
    omega = np.geomspace(SLOWEST, FASTEST / poles.dt, FREQUENCIES)
    delay = -float(poles.steady[0, 0, TOOL, 1])
    found = np.array([tool_response(loop, omega) for loop in poles.loops])
    return Follower(
        machine=machine,
        tuned=tuned,
        poles=poles,
        omega=omega,
        on_circles=found * np.exp(1j * omega * delay),
        setpoint_filter=item,
        wait=wait,
    )


def starts_of(axes: Sequence[Follower]) -> Array:
    """Return when a step comes within a position cycle, so that each axis sees every phase [s]."""
    dt = axes[0].poles.dt
    found = [(phase * dt - axis.wait) % dt for axis in axes for phase in PHASES]
    return np.unique(np.round(found, 12) % dt)


def instants_of(axes: Sequence[Follower], steps: JerkSteps) -> Cycles:
    """Return cycles in which answers to setpoints are worth a look, (n_setpoints, n_times)."""
    count = max(axis.cycles(float(steps.duration.max())) for axis in axes)
    if count <= ALL_LOOKED_AT:
        return _from_begin(steps.times, count)
    return np.concatenate([axis.behind_steps(steps) for axis in axes], axis=1)


def _from_begin(starts: Array, cycles: int) -> Cycles:
    return np.tile(np.arange(cycles), (len(starts), 1))


def _step_of(derivative: int, starts: Array) -> JerkSteps:
    """A step of 1 at some times, which ends late: behind its last step a setpoint coasts."""
    times, steps = np.array([starts, starts + LATE]).T, np.tile([1.0, -1.0], (len(starts), 1))
    lasts = max(derivative, 1)
    return JerkSteps(times=times[:, :lasts], steps=steps[:, :lasts], order=derivative)


def filter_lag(item: SetpointFilter | None) -> float:
    """Return by how much a filter delays slow motion [s]."""
    if item is None:
        return 0.0
    shares = zip(item.impulses.delays, item.impulses.shares, strict=True)
    return sum(d * share for d, share in shares) + 0.5 * sum(item.averages)


def filter_response(item: SetpointFilter | None, omega: Array) -> Complex:
    """Return the complex response of a setpoint filter, shape of ``omega`` [rad/s]; None: 1."""
    found = np.ones(omega.shape, dtype=complex)
    if item is None:
        return found
    shares, delays = np.array(item.impulses.shares), np.array(item.impulses.delays)
    found = np.exp(-1j * omega[..., None] * delays) @ shares
    for time in item.averages:
        half = 0.5 * omega * time
        found = found * np.exp(-1j * half) * np.sinc(half / pi)
    return np.asarray(found)


def tool_response(loop: SampledLoop, omega: Array) -> Complex:
    """Return the complex response from setpoint to tool, shape of ``omega`` [rad/s].

    Position and its derivatives enter as the control gets them, at the position cycle; the tool is
    seen at every velocity cycle, and the mean over these is its fundamental.
    """
    lifted, parts = loop.lifted, loop.controller.cycles
    C = lifted.C[TOOL :: len(loop.outputs)]  # one row for each velocity cycle
    ahead = np.exp(1j * omega * lifted.dt)[:, None, None]
    # The setpoint now, and as it was kept.
    kept = ahead[..., 0] ** -np.arange(loop.kept + 1)
    setpoint = kept[..., None] * ((1j * omega)[:, None] ** np.arange(4))[:, None]
    push = setpoint.reshape(len(omega), -1) @ lifted.B.T
    states = np.linalg.solve(ahead * np.eye(len(lifted.A)) - lifted.A, push[..., None])
    seen = states[..., 0] @ C.T
    late = np.exp(-1j * np.outer(omega, np.arange(parts)) * loop.controller.velocity_cycle)
    return np.asarray(np.mean(seen * late, axis=1))
