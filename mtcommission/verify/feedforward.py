"""The feed-forward as it should be: what a trace's following error says of it.

What is left between the encoder and the delayed setpoint is laid over the setpoint's velocity, and
over what the loop of the record makes of a force in proportion to its acceleration, its jerk and
the sign of its velocity, by least squares: delay, inertia, the drive's lag and Coulomb friction.
All of it is linear, so the same columns tell what the values would bring.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, sqrt

import numpy as np

from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.simulate import drive_loop
from mtcommission.machine.identified import Estimate
from mtcommission.measured.measurement import Array
from mtcommission.measured.regression import Equations, regress
from mtcommission.verify.beside import Recorded
from mtcommission.verify.prediction import Rebuilt, cycles_of
from mtcommission.verify.refine import Parameter
from mtcommission.verify.trace import Role
from mtcommission.verify.verify import Verification

COUNTS = 3.0
"""Standard errors by which a value must differ from today's, to be changed."""
WORTH = 0.02
"""Share of the RMS deviation that a value must take away, to be changed (design choice)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedForward:
    """Values for the control beside today's, and what they would bring."""

    values: tuple[Parameter, ...]
    # before, after: RMS deviation of the encoder from the delayed setpoint, as recorded and with
    # the values: on the second half of the moves by the first half, where there are several [m].
    before: float
    after: float
    tested: int  # Moves held back; 0: the values come from the same move


def suggest_feedforward(found: Verification) -> FeedForward | None:
    """Return the values that leave the least following error; None where a trace shows none."""
    rebuilt = found.rebuilt
    controller, units = rebuilt.controller, rebuilt.machine.axis_units
    rows = [_rows(rebuilt, one) for one in found.recorded if _tells(one)]
    if controller.follows or not rows:
        return None
    more, sigma = _solve(rows)
    half = len(rows) // 2
    learnt, tested = (_solve(rows[:half])[0], rows[half:]) if half else (more, rows)
    whole = Equations.of(tested)
    missed = whole.values
    mass, jerk = controller.feedforward_mass, controller.jerk_feedforward * controller.force_lag
    today = (
        ("reference_delay", "s", controller.reference_delay),
        ("feedforward_mass", units.mass.si, controller.acceleration_feedforward * mass),
        ("jerk_feedforward", f"{units.mass.si} s", jerk * mass),
        ("friction_feedforward", units.force.si, 0.0),
    )
    return FeedForward(
        values=tuple(
            Parameter(key=key, unit=unit, old=old, new=Estimate(value=old + d, sigma=s))
            for (key, unit, old), d, s in zip(today, more.tolist(), sigma.tolist(), strict=True)
            if s < inf
        ),
        before=sqrt(float(np.mean(missed**2))),
        after=sqrt(float(np.mean((missed + whole.columns @ learnt) ** 2))),
        tested=len(tested) if half else 0,
    )


def _tells(one: Recorded) -> bool:
    return one.find(Role.ENCODER) is not None and not one.motion.is_cut


def _rows(rebuilt: Rebuilt, one: Recorded) -> Equations:
    """Deviation of a move, and what each unit more of a value adds to it, shape (n, 4)."""
    signal, motion = one.find(Role.ENCODER), one.motion
    assert signal is not None
    # An axis that sticks once it has arrived answers no force, whatever a linear loop does there.
    tau = rebuilt.controller.reference_delay
    stop = motion.until if motion.coasts else motion.end + tau
    moving = signal.after(motion.begin) & (signal.t <= stop)
    t = signal.t[moving]
    late = motion.sample(t - tau)
    # A unit of force per unit of what stands in place of the setpoint's acceleration; the same
    # without any takes off what else the setpoint's acceleration does.
    plain = replace(rebuilt.controller, acceleration_feedforward=1.0, jerk_feedforward=0.0)
    fed, unfed = (
        build_loop(rebuilt.plant, replace(plain, feedforward_mass=m), model=rebuilt.plant)
        for m in (1.0, 0.0)
    )
    cycles, references = cycles_of(rebuilt, motion)
    columns = [late[:, 1]]
    for force in (references[:, 2], references[:, 3], np.sign(references[:, 1])):
        instead = np.zeros_like(references)
        instead[:, 2] = force
        answer = drive_loop(fed, instead)[:, 1] - drive_loop(unfed, instead)[:, 1]
        columns.append(np.interp(t, cycles, answer))
    return Equations(np.column_stack(columns), signal.measured[moving] - late[:, 0])


def _solve(rows: Sequence[Equations]) -> tuple[Array, Array]:
    """What is to be added to each value, and its standard error; inf: no move tells.

    Values that do not stand out, or bring next to nothing, stay as they are, the least first.
    """
    whole = Equations.of(rows)
    columns, deviation = whole.columns, whole.values
    power = float(deviation @ deviation)
    more, sigma = np.zeros(columns.shape[1]), np.full(columns.shape[1], inf)
    kept = np.flatnonzero(np.any(columns, axis=0))
    while kept.size:
        found = regress(columns[:, kept], -deviation)
        sigma[kept] = found.sigma
        # What the misfit grows by without a value, of the noise of one sample.
        t_squared = (found.values / np.maximum(found.sigma, 1e-300)) ** 2
        lost = t_squared * found.variance
        stays = (t_squared > COUNTS**2) & (lost > WORTH**2 * power)
        if stays.all():
            more[kept] = found.values
            break
        kept = np.delete(kept, int(np.argmin(np.where(stays, inf, lost))))
    return more, sigma
