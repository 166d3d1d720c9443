"""Circles, corners and lines of two axes once more, by the second program, cycle by cycle.

Shares nothing with ``mtcommission.group``: setpoints are sampled along the path, sent through the
scalar loop of ``independent_loop``, and the tool's distance from the path is measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.controller import Controller
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from tests.independent_loop import profile_of, run

Array = NDArray[np.float64]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True, slots=True)
class Filtered:
    """A setpoint behind a filter, by quadrature; each piece of ``breaks`` is smooth."""

    plain: Callable[[float], Array]  # x, v, a, j
    breaks: tuple[float, ...]
    item: SetpointFilter | None
    wait: float = 0.0

    def at(self, t: float) -> Array:
        t -= self.wait
        item = self.item
        if item is None:
            return self.plain(t)
        if item.frequency_hz:
            pairs = zip(*item.impulses, strict=True)
            return np.sum([share * self.plain(t - delay) for delay, share in pairs], axis=0)
        return self._mean(t, tuple(T for T in (item.time, item.second_time) if T))

    def _mean(self, t: float, means: tuple[float, ...]) -> Array:
        if not means:
            return self.plain(t)
        T, rest = means[0], means[1:]
        late = [sum(rest[:i]) for i in range(len(rest) + 1)]
        inner = {b + d for b in self.breaks for d in late if t - T < b + d < t}
        ends = sorted({t - T, t, *inner})
        total = np.zeros(4)
        for low, high in pairwise(ends):
            half, middle = 0.5 * (high - low), 0.5 * (high + low)
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                total += half * weight * self._mean(middle + half * node, rest)
        # Derivatives by differences: what steps inside the window counts, too.
        ends_at = self._mean(t, rest), self._mean(t - T, rest)
        return np.append(total[0], ends_at[0][:3] - ends_at[1][:3]) / T


RAMP, SETTLED = 0.4, 0.4
"""In which the feed is reached along the path, and after which nothing of that is left [s]."""


@dataclass(frozen=True, slots=True)
class Road:
    """A path of lines and arcs from the origin along x: lengths and curvatures."""

    pieces: tuple[tuple[float, float], ...]

    def __call__(self, s: float) -> tuple[Array, float, float]:
        """Place, heading and curvature after a length."""
        place, heading, curvature = np.zeros(2), 0.0, 0.0
        for number, (length, curvature) in enumerate(self.pieces, start=1):
            here = s if number == len(self.pieces) else min(s, length)
            turned = curvature * here
            chord = here * np.sinc(turned / (2.0 * pi))
            middle = heading + 0.5 * turned
            place = place + chord * np.array([cos(middle), sin(middle)])
            heading += turned
            s -= here
            if s <= 0.0:
                break
        return place, heading, curvature

    def setpoint(self, feed: float, turned: float, axis: int) -> Callable[[float], Array]:
        """One axis of the road, the whole turned by an angle, at a feed that rises from rest."""

        def at(t: float) -> Array:
            u = min(max(t / RAMP, 0.0), 1.0)
            v = feed * (10 * u**3 - 15 * u**4 + 6 * u**5)
            a = feed / RAMP * (30 * u**2 - 60 * u**3 + 30 * u**4)
            j = feed / RAMP**2 * (60 * u - 180 * u**2 + 120 * u**3)
            s = feed * RAMP * (2.5 * u**4 - 3 * u**5 + u**6) + feed * max(t - RAMP, 0.0)
            place, heading, k = self(s)
            x, y = place
            angle = heading + turned - 0.5 * pi * axis
            base = turned - 0.5 * pi * axis
            along, across = cos(angle), sin(angle)
            return np.array(
                [
                    cos(base) * x - sin(base) * y,
                    v * along,
                    a * along - k * v**2 * across,
                    j * along - 3 * k * v * a * across - k**2 * v**3 * along,
                ]
            )

        return at

    def breaks(self, feed: float) -> tuple[float, ...]:
        """Instants at which a piece ends, and the feed's ramp."""
        ends = np.cumsum([length for length, _ in self.pieces[:-1]])
        return (0.0, RAMP, *((end / feed + 0.5 * RAMP) for end in ends.tolist()))


Driven = tuple[Machine, Machine, Controller, float]
"""Machine, nominal machine, gains, and wait of an axis."""


def drive(
    axes: list[Driven],
    item: SetpointFilter | None,
    road: Road,
    *,
    feed: float,
    duration: float,
    turned: float = 0.0,
    coulomb: tuple[float, float] = (0.0, 0.0),
) -> tuple[Array, Array]:
    """Return times, and the tool's path in the road's own directions, (2, n)."""
    path = []
    for number, ((machine, nominal, gains, wait), friction) in enumerate(
        zip(axes, coulomb, strict=True)
    ):
        plain = road.setpoint(feed, turned, number)
        moved = run(
            machine,
            gains,
            Filtered(plain, road.breaks(feed), item, wait),
            nominal=nominal,
            samples=int(duration / gains.velocity_cycle),
            force_limit=machine.drive.motion_force,
            coulomb=friction,
        )
        path.append(moved.tool)
    c, s = cos(turned), sin(turned)
    return moved.t, np.array([[c, s], [-s, c]]) @ np.array(path)


def circle_off(
    axes: list[Driven],
    item: SetpointFilter | None,
    *,
    radius: float,
    feed: float,
    coulomb: tuple[float, float] = (0.0, 0.0),
) -> tuple[Array, Array]:
    """Radius of the tool about the middle of its path, less R, and its angle, in a whole turn."""
    turn = 2.0 * pi * radius / feed
    settled = RAMP + SETTLED + (item.duration if item else 0.0)
    road = Road(((1.0, 1.0 / radius),))
    t, path = drive(axes, item, road, feed=feed, duration=settled + turn, coulomb=coulomb)
    x, y = path[:, t >= settled]
    # A circle through the middle of all, by least squares.
    a, b, _ = np.linalg.lstsq(np.array([2 * x, 2 * y, x**0]).T, x**2 + y**2, rcond=None)[0]
    return np.hypot(x - a, y - b) - radius, np.arctan2(y - b, x - a)


def entry_off(
    axes: list[Driven], item: SetpointFilter | None, *, radius: float, feed: float, turned: float
) -> float:
    """Largest distance of the tool from a line and the circle that is entered from it."""
    line = feed * (0.5 * RAMP + SETTLED)
    road = Road(((line, 0.0), (1.0, 1.0 / radius)))
    begin = RAMP + SETTLED
    duration = begin + min(2.0 * pi * radius / feed, 0.3) + (item.duration if item else 0.0)
    t, (x, y) = drive(axes, item, road, feed=feed, duration=duration, turned=turned)
    from_line = np.where(x < line, np.abs(y), np.inf)
    from_circle = np.abs(np.hypot(x - line, y - radius) - radius)
    return float(np.minimum(from_line, from_circle)[t > RAMP + 0.5 * SETTLED].max())


def corner_off(
    axes: list[Driven],
    item: SetpointFilter | None,
    *,
    angle: float,
    arc: float,
    feed: float,
    turned: float,
) -> float:
    """Larger of the distances tool to corner lines, and corner to tool."""
    tangent = arc * np.tan(0.5 * angle)
    line = feed * (0.5 * RAMP + SETTLED)
    bend = ((arc * angle, 1.0 / arc),) if arc else ((1e-12, angle / 1e-12),)
    road = Road(((line, 0.0), *bend, (1.0, 0.0)))
    duration = RAMP + SETTLED + 0.3 + arc * angle / feed + (item.duration if item else 0.0)
    t, (x, y) = drive(axes, item, road, feed=feed, duration=duration, turned=turned)
    x, y = x[t > RAMP + 0.5 * SETTLED] - line - tangent, y[t > RAMP + 0.5 * SETTLED]
    c, s = cos(angle), sin(angle)
    corner = np.hypot(x, y)
    first = np.where(x < 0.0, np.abs(y), corner)
    second = np.where(c * x + s * y > 0.0, np.abs(s * x - c * y), corner)
    return float(max(np.minimum(first, second).max(), corner.min()))


def line_off(
    axes: list[Driven],
    item: SetpointFilter | None,
    *,
    feed: float,
    acceleration: float,
    jerk: float,
    direction: float,
) -> float:
    """Largest distance of the tool from a line on which it is accelerated."""
    motion = profile_of(VelocityStep(velocity_step=feed), acceleration, jerk)
    path = []
    for (machine, nominal, gains, wait), share in zip(
        axes, (cos(direction), sin(direction)), strict=True
    ):

        def plain(t: float, share: float = share) -> Array:
            return share * motion.at(t)

        duration = motion.end + SETTLED + (item.duration if item else 0.0)
        moved = run(
            machine,
            gains,
            Filtered(plain, motion.knots, item, wait),
            nominal=nominal,
            samples=int(duration / gains.velocity_cycle),
            force_limit=machine.drive.motion_force,
        )
        path.append(moved.tool)
    x, y = path
    return float(np.abs(sin(direction) * x - cos(direction) * y).max())
