"""Circles of two axes: how far the tool is off, from the loops' complex responses.

An axis answers x = cos(ω t), ω = v/R, with |G| cos(ω t + arg G) at the tool, G of filter, delay and
loop. Two axes draw (R/2) ((G_x + G_y) e^{iωt} + conj(G_x - G_y) e^{-iωt}), an ellipse about the
delayed circle, whose radius lies between R (|G_x + G_y| ± |G_x - G_y|)/2. Exact for the linear
loop while the circle lasts; a tangential entry steps the acceleration by v²/R.

Source: derived here; its limits for small ω are -v²/(2 R Kv²) of a lag and -v² T²/(24 R) of a
moving average (facts of the project), held to by tests.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.disturbance import simulate_disturbance
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.poles import LoopPoles
from mtcommission.loop.respond import TOOL
from mtcommission.loop.simulate import drive_loop, find_friction
from mtcommission.machine.drive import Drive
from mtcommission.machine.setpoint_filter import SetpointFilter

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def filter_response(item: SetpointFilter | None, omega: Array) -> Complex:
    """Return the complex response of a setpoint filter, shape of ``omega`` [rad/s]; None: 1."""
    found = np.ones(omega.shape, dtype=complex)
    if item is None:
        return found
    impulses = item.impulses
    shares, delays = np.array(impulses.shares), np.array(impulses.delays)
    found = np.exp(-1j * omega[..., None] * delays) @ shares
    for time in item.averages:
        half = 0.5 * omega * time
        found = found * np.exp(-1j * half) * np.sinc(half / pi)
    return np.asarray(found)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToolResponse:
    """From the setpoint behind the filter to the tool, in every corner of an axis."""

    omega: Array  # rising, shape (n_omega,) [rad/s]
    leading: Complex
    """The response without what the delay turns it by, which then hardly bends between two
    frequencies, (n_corners, n_omega)."""
    delay: float  # of slow motion in the nominal machine [s]
    wait: float = 0.0  # before the axis begins [s]

    def at(self, omega: Array, item: SetpointFilter | None) -> Complex:
        """Return the responses behind a filter, (n_corners, *omega.shape)."""
        turn = filter_response(item, omega) * np.exp(-1j * omega * (self.delay + self.wait))
        x, known = np.log(omega), np.log(self.omega)
        parts = [
            np.interp(x, known, one.real) + 1j * np.interp(x, known, one.imag)
            for one in self.leading
        ]
        return np.asarray(turn * np.array(parts))


SLOWEST, FASTEST, FREQUENCIES = 0.05, 0.3, 160
"""Least angular frequency of a circle [rad/s], the largest times the position cycle [-], and
frequencies between (empirical: to 1e-4 of the deviation)."""


def find_response(poles: LoopPoles) -> ToolResponse:
    """Return how an axis answers circles of every angular velocity, in every corner."""
    omega = np.geomspace(SLOWEST, FASTEST / poles.dt, FREQUENCIES)
    # The steady answer to a ramp is its velocity times the delay behind it.
    delay = -float(poles.steady[0, 0, TOOL, 1])
    found = np.array([tool_response(loop, omega) for loop in poles.loops])
    return ToolResponse(omega=omega, leading=found * np.exp(1j * omega * delay), delay=delay)


def tool_response(loop: SampledLoop, omega: Array) -> Complex:
    """Return the complex response from setpoint to tool, shape of ``omega`` [rad/s].

    Position and its derivatives enter as the control gets them, at the position cycle; the tool is
    seen at every velocity cycle, and the mean over these is its fundamental.
    """
    lifted, parts = loop.lifted, loop.controller.cycles
    own, tool = len(loop.outputs), np.eye(len(lifted.A))
    C, D = lifted.C[TOOL::own], lifted.D[TOOL::own]  # one row for each velocity cycle
    ahead = np.exp(1j * omega * lifted.dt)
    setpoint = (1j * omega)[:, None] ** np.arange(4)
    states = np.linalg.solve(
        ahead[:, None, None] * tool - lifted.A, (setpoint @ lifted.B.T)[..., None]
    )
    seen = states[..., 0] @ C.T + setpoint @ D.T
    late = np.exp(-1j * np.outer(omega, np.arange(parts)) * loop.controller.velocity_cycle)
    return np.asarray(np.mean(seen * late, axis=1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """How a circle comes out, as shares of its radius [-], each of the shape of what is asked."""

    radius: Array  # of the mean radius; negative: too small
    form: Array  # largest less smallest radius

    @property
    def largest(self) -> Array:
        """How far the tool is from the circle at most."""
        return np.asarray(np.abs(self.radius) + 0.5 * self.form)


def deviate(first: Complex, second: Complex) -> Deviation:
    """Return the deviations of circles from the complex responses of two axes."""
    return Deviation(
        radius=0.5 * np.abs(first + second) - 1.0, form=np.asarray(np.abs(first - second))
    )


RUN_IN, AFTER = 0.4, 0.2
"""How long an axis moves before it reverses, and afterwards, where its friction is stepped [s]: the
integrator has taken up the friction by then (empirical)."""


def reversal_course(
    loop: SampledLoop, drive: Drive, *, item: SetpointFilter | None, radius: float, feed: float
) -> Array:
    """Return how friction throws the tool off from a reversal on, at every velocity cycle [m].

    Positive: outwards. On a circle of some radius [m] at a feed [m/s], by the stepping engine: the
    motion with friction less that without it.
    """
    friction = find_friction(
        loop.plant,
        coulomb=drive.coulomb_friction,
        viscous=drive.viscous_friction,
        step=loop.controller.velocity_cycle,
    )
    omega = feed / radius
    before = min(RUN_IN, 0.5 * pi / omega)
    t = np.arange(0.0, before + AFTER, loop.controller.position_cycle)
    size = radius * np.abs(filter_response(item, np.array([omega])))[0]
    phase = omega * (t - before)
    setpoint = [np.cos(phase), -np.sin(phase), -np.cos(phase), np.sin(phase)]
    references = size * np.array(setpoint).T * omega ** np.arange(4)
    references[:, 0] -= references[0, 0]
    with_friction = drive_loop(loop, references, friction=friction)[:, TOOL]
    off = with_friction - drive_loop(loop, references)[:, TOOL]
    reverses = round(before / loop.controller.velocity_cycle)
    return np.asarray(off[reverses:])


def peak_bound(loops: tuple[SampledLoop, ...], drive: Drive) -> float:
    """Return what no reversal exceeds: 2 F_c times the largest answer to a step of force [m]."""
    worst = max(simulate_disturbance(loop, duration=AFTER).peak for loop in loops)
    return 2.0 * drive.coulomb_friction * worst
