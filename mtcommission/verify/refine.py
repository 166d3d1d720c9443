"""Parameters as the traces show them, tested on moves that were held back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import hypot, pi, sqrt

import numpy as np

from mtcommission.base.errors import MtcommissionError
from mtcommission.machine.identified import Estimate
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import build_plant
from mtcommission.verify.beside import Recorded, unexplained
from mtcommission.verify.prediction import Rebuilt, on_machine
from mtcommission.verify.rigid import fit_rigid_body
from mtcommission.verify.trace import Trace
from mtcommission.verify.verify import Verification

SYSTEMATIC = 0.005
"""Of the mass: what recorders and units leave open beside the noise (facts: 0.3 % on a bench)."""

ALIASED = 0.01
"""The same where the trace has one sample a position cycle: what the force does between is not in
it (up to 1.8 % of the mass in simulations)."""

COARSE = 0.03
"""The same where the trace is coarser than the position cycle: the force between is not seen."""

WHOLE = 1.01
"""Largest ratio of two steps that are the same."""

FREQUENCY_FLOOR, DAMPING_FLOOR = 0.003, 0.02
"""Standard errors, relative, that a loop which is only nearly linear leaves (empirical)."""

ROUNDS = 3
"""Times the loop is closed again on the refined machine (empirical: 0.1 % of a frequency)."""

SIGNIFICANT = 2.0
"""Standard errors by which friction must differ from none, and a change from the old value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One parameter, old and new [SI]."""

    key: str  # as JSON and messages spell it, e.g. "mass", "coulomb_friction", "damping_ratio"
    mode: str = ""
    unit: str
    old: float
    new: Estimate

    @property
    def name(self) -> str:
        """Name in JSON."""
        return f"{self.mode}.{self.key}" if self.mode else self.key

    @property
    def has_changed(self) -> bool:
        """Whether the old value lies outside twice the standard error."""
        return bool(abs(self.new.value - self.old) > SIGNIFICANT * self.new.sigma)


@dataclass(frozen=True, slots=True, kw_only=True)
class Refined:
    """What the traces say of the machine."""

    machine: Machine  # with the new parameters
    parameters: tuple[Parameter, ...]  # those that the traces show
    unexplained_before: float | None  # share of the deviation that the old machine leaves, by RMS
    unexplained_after: float | None  # and the new one: both of ``tested`` moves
    tested: int  # moves that were held back; 0: one move alone, and both shares are of it
    force_unexplained: float | None  # share that mass and friction leave; None: no force


def refine(found: Verification) -> Refined:
    """Return the parameters that the traces show.

    Mass and friction from force and motion, frequency and damping from the dwells; the second half
    of the moves tests what the first half says.
    """
    machine, parameters, force = _estimate(found.rebuilt, found.recorded)
    half = len(found.recorded) // 2
    learnt, tested = machine, found.recorded
    if half:
        learnt, tested = _estimate(found.rebuilt, tested[:half])[0], tested[half:]
    try:
        after = unexplained(tested, on_machine(found.rebuilt, learnt))
    except MtcommissionError:
        after = None
    return Refined(
        machine=machine,
        parameters=parameters,
        unexplained_before=unexplained(tested),
        unexplained_after=after,
        tested=len(tested) if half else 0,
        force_unexplained=force,
    )


def _estimate(
    rebuilt: Rebuilt, recorded: Sequence[Recorded]
) -> tuple[Machine, tuple[Parameter, ...], float | None]:
    machine = rebuilt.machine
    modes = _modes(rebuilt, recorded, rebuilt)
    bodies, force_left = _bodies(rebuilt, recorded, _with(machine, modes))
    for _ in range(ROUNDS):
        try:
            closer = on_machine(rebuilt, _with(machine, (*bodies, *modes)))
        except MtcommissionError:
            break
        modes = _modes(rebuilt, recorded, closer)
    parameters = (*bodies, *modes)
    return _with(machine, parameters), parameters, force_left


def _bodies(
    rebuilt: Rebuilt, recorded: Sequence[Recorded], machine: Machine
) -> tuple[tuple[Parameter, ...], float | None]:
    """Mass and friction, and the share of the force that they leave."""
    ends: dict[Trace, float] = {}
    for one in recorded:
        ends[one.trace] = max(ends.get(one.trace, 0.0), one.motion.until)
    plant, units, drive = build_plant(machine), machine.axis_units, machine.drive
    rigid = fit_rigid_body([trace.before(end) for trace, end in ends.items()], plant)
    if rigid is None:
        return (), None
    cycles = max(trace.setpoint.step for trace in ends) / rebuilt.controller.position_cycle
    share = COARSE if cycles > WHOLE else ALIASED if cycles * WHOLE > 1.0 else SYSTEMATIC
    doubt = share * rigid.mass.value
    mass = Estimate(value=rigid.mass.value, sigma=hypot(rigid.mass.sigma, doubt))
    rows = (
        ("mass", units.mass.si, plant.moving_mass, mass),
        ("coulomb_friction", units.force.si, drive.coulomb_friction, _friction(rigid.coulomb)),
        ("viscous_friction", units.damping.si, drive.viscous_friction, _friction(rigid.viscous)),
    )
    bodies = tuple(Parameter(key=key, unit=unit, old=old, new=new) for key, unit, old, new in rows)
    return bodies, rigid.unexplained


def _friction(one: Estimate) -> Estimate:
    """It is not negative, and none where it does not stand out."""
    stands_out = one.value > SIGNIFICANT * one.sigma
    return one if stands_out else Estimate(value=0.0, sigma=max(one.sigma, abs(one.value)))


def _modes(rebuilt: Rebuilt, recorded: Sequence[Recorded], near: Rebuilt) -> tuple[Parameter, ...]:
    """Frequency and damping of the plant; a loop near it tells how far the pole is moved."""
    parameters = []
    for number, (known, mode) in enumerate(zip(rebuilt.plant.modes, near.plant.modes, strict=True)):
        seen = [own for one in recorded if (own := one.modes[number]) is not None]
        if not seen:
            continue
        pole = near.poles[0, number]
        stiffer = mode.natural_frequency / abs(pole)
        damped = mode.damping_ratio / (-pole.real / abs(pole))
        hertz = _mean([one.frequency_hz for one in seen], stiffer, FREQUENCY_FLOOR)
        zeta = _mean([one.damping_ratio for one in seen], damped, DAMPING_FLOOR)
        row = partial(Parameter, mode=mode.name)
        parameters += [
            row(key="frequency", unit="Hz", old=known.frequency_hz, new=hertz),
            row(key="damping_ratio", unit="", old=known.damping_ratio, new=zeta),
        ]
    return tuple(parameters)


def _mean(seen: Sequence[Estimate], factor: float, floor: float) -> Estimate:
    """Weighted mean times a factor; its error covers the scatter of the repetitions."""
    values = np.array([one.value for one in seen])
    weights = 1.0 / np.maximum([one.sigma for one in seen], 1e-12) ** 2
    scatter = float(np.std(values)) / sqrt(len(seen))
    value = factor * float(np.average(values, weights=weights))
    sigma = factor * max(float(weights.sum()) ** -0.5, scatter)
    return Estimate(value=value, sigma=hypot(sigma, floor * value))


def _with(machine: Machine, parameters: tuple[Parameter, ...]) -> Machine:
    """The machine with the new values of what has changed."""
    new = {one.name: one.new.value for one in parameters if one.has_changed}
    drive, mechanics = machine.drive, machine.mechanics

    def of(mode: str, key: str, old: float) -> float:
        return new.get(f"{mode}.{key}", old)

    modes = [
        replace(
            mode,
            natural_frequency=2.0 * pi * of(mode.name, "frequency", mode.frequency_hz),
            damping_ratio=of(mode.name, "damping_ratio", mode.damping_ratio),
        )
        for mode in mechanics.modes
    ]
    return replace(
        machine,
        drive=replace(
            drive,
            coulomb_friction=new.get("coulomb_friction", drive.coulomb_friction),
            viscous_friction=new.get("viscous_friction", drive.viscous_friction),
        ),
        mechanics=mechanics.renew(mass=new.get("mass", mechanics.moving_mass), modes=modes),
    )
