"""Parameters as the traces show them, tested on moves that were held back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from mtcommission.errors import MtcommissionError
from mtcommission.machine.identified import Estimate
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import build_plant
from mtcommission.verify.motions import Recorded
from mtcommission.verify.prediction import Rebuilt, on_machine, predict
from mtcommission.verify.rigid import fit_rigid_body
from mtcommission.verify.trace import Role
from mtcommission.verify.verify import Verification

SYSTEMATIC = 0.005
"""Of the mass: what recorders and units leave open beside the noise (facts: 0.3 % on a bench)."""

COARSE = 0.03
"""The same where the trace is coarser than the position cycle: the force between is not seen."""

FREQUENCY_FLOOR, DAMPING_FLOOR = 0.003, 0.02
"""Standard errors, relative, that a loop which is only nearly linear leaves (empirical)."""

CLOCK = 0.1
"""Share of a sample by which columns of a recorder may be apart unknown to anybody (empirical)."""

ROUNDS = 3
"""Times the loop is closed again on the refined machine (empirical: 0.1 % of a frequency)."""

SIGNIFICANT = 2.0
"""Standard errors by which friction must differ from none, and a change from the old value."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One parameter, old and new."""

    # As JSON and messages spell it: mass, coulomb_friction, viscous_friction, delay, frequency,
    # damping_ratio.
    key: str
    mode: str = ""  # Its mode; "" for none
    unit: str  # SI
    # old, new: [SI]; ``new`` with its standard error.
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

    machine: Machine  # With the new parameters
    parameters: tuple[Parameter, ...]  # Those that the traces show
    # unexplained_before, unexplained_after: Share of the deviation, by RMS, that the old and the
    # new machine leave of ``tested`` moves.
    unexplained_before: float | None
    unexplained_after: float | None
    tested: int  # How many moves were held back; 0: one move alone, and both shares are of it
    # Share of the force that mass and friction leave, on the part held back if there is one; None:
    # no force.
    force_unexplained: float | None


def refine(found: Verification) -> Refined:
    """Return the parameters that the traces show.

    Mass and friction from force and motion, frequency and damping from the dwells; the second half
    of the moves tests what the first half says.
    """
    machine, parameters, force = _estimate(found, found.recorded)
    half = len(found.recorded) // 2
    before = after = None
    if half:
        learnt, _, _ = _estimate(found, found.recorded[:half])
        tested = found.recorded[half:]
    else:
        learnt, tested = machine, found.recorded
    before = _unexplained(found.rebuilt, tested)
    try:
        after = _unexplained(on_machine(found.rebuilt, learnt), tested)
    except MtcommissionError:
        after = None
    return Refined(
        machine=machine,
        parameters=parameters,
        unexplained_before=before,
        unexplained_after=after,
        tested=len(tested) if half else 0,
        force_unexplained=force,
    )


def _estimate(
    found: Verification, recorded: Sequence[Recorded]
) -> tuple[Machine, tuple[Parameter, ...], float | None]:
    rebuilt, machine = found.rebuilt, found.rebuilt.machine
    units, drive = machine.axis_units, machine.drive
    modes = _modes(rebuilt, recorded, rebuilt)
    plant = build_plant(_with(machine, modes))
    traces = [
        trace.before(max(one.motion.until for one in own))
        for trace in found.traces
        if (own := [one for one in recorded if one.trace is trace])
    ]
    rigid = fit_rigid_body(traces, plant) if traces else None
    force_left: float | None = None
    bodies: tuple[Parameter, ...] = ()
    if rigid is not None:
        force_left = rigid.unexplained_apart or rigid.unexplained
        step = max(trace.setpoint.step for trace in traces)
        coarse = step > rebuilt.controller.position_cycle
        doubt = (COARSE if coarse else SYSTEMATIC) * rigid.mass.value
        mass = Estimate(value=rigid.mass.value, sigma=float(np.hypot(rigid.mass.sigma, doubt)))
        bodies = (
            Parameter(key="mass", unit=units.mass.si, old=plant.moving_mass, new=mass),
            Parameter(key="coulomb_friction", unit=units.force.si, old=drive.coulomb_friction,
                      new=_at_least_none(rigid.coulomb)),
            Parameter(key="viscous_friction", unit=units.damping.si, old=drive.viscous_friction,
                      new=_at_least_none(rigid.viscous)),
        )  # fmt: skip
    for _ in range(ROUNDS):
        try:
            closer = on_machine(rebuilt, _with(machine, (*bodies, *modes)))
        except MtcommissionError:
            break
        modes = _modes(rebuilt, recorded, closer)
    parameters = (*bodies, *_delay(rebuilt, recorded), *modes)
    return _with(machine, parameters), parameters, force_left


def _delay(rebuilt: Rebuilt, recorded: Sequence[Recorded]) -> tuple[Parameter, ...]:
    known = [one for one in recorded if np.isfinite(one.shift_error) and not one.trace.is_delayed]
    if not known:
        return ()
    shifts = [one.shift for one in known]
    step = max(one.trace.setpoint.step for one in known)
    errors = [float(np.std(shifts)), 0.5 * float(np.median([one.shift_error for one in known]))]
    sigma = max(*errors, CLOCK * step)
    tau = rebuilt.controller.reference_delay
    new = Estimate(value=tau + float(np.median(shifts)), sigma=sigma)
    return (Parameter(key="delay", unit="s", old=tau, new=new),)


def _modes(rebuilt: Rebuilt, recorded: Sequence[Recorded], near: Rebuilt) -> tuple[Parameter, ...]:
    """Frequency and damping of the plant; a loop near it tells how far the pole is moved."""
    parameters = []
    for number, (known, mode) in enumerate(zip(rebuilt.plant.modes, near.plant.modes, strict=True)):
        pole = near.poles[0, number]
        seen = [own for one in recorded if (own := one.modes[number]) is not None]
        if not seen:
            continue
        hertz = _mean([(own.frequency_hz, own.frequency_sigma_hz) for own in seen])
        zeta = _mean([(own.damping_ratio, own.damping_sigma) for own in seen])
        stiffer = mode.natural_frequency / abs(pole)
        damped = mode.damping_ratio / (-pole.real / abs(pole))
        parameters += [
            Parameter(key="frequency", mode=mode.name, unit="Hz", old=known.frequency_hz,
                      new=_scaled(hertz, stiffer, floor=FREQUENCY_FLOOR)),
            Parameter(key="damping_ratio", mode=mode.name, unit="", old=known.damping_ratio,
                      new=_scaled(zeta, damped, floor=DAMPING_FLOOR)),
        ]  # fmt: skip
    return tuple(parameters)


def _scaled(one: Estimate, factor: float, *, floor: float) -> Estimate:
    value = float(factor * one.value)
    return Estimate(value=value, sigma=float(np.hypot(factor * one.sigma, floor * value)))


def _at_least_none(one: Estimate) -> Estimate:
    """Friction, which is not negative, and none where it does not stand out."""
    stands_out = one.value > SIGNIFICANT * one.sigma
    return one if stands_out else Estimate(value=0.0, sigma=max(one.sigma, abs(one.value)))


def _mean(rows: Sequence[tuple[float, float]]) -> Estimate:
    """Weighted mean; its error covers the scatter of the repetitions."""
    values, sigmas = (np.array(column) for column in zip(*rows, strict=True))
    weights = 1.0 / np.maximum(sigmas, 1e-12) ** 2
    mean = float(weights @ values / weights.sum())
    scatter = float(np.std(values)) / sqrt(len(rows)) if len(rows) > 1 else 0.0
    return Estimate(value=mean, sigma=max(float(weights.sum()) ** -0.5, scatter))


def _with(machine: Machine, parameters: tuple[Parameter, ...]) -> Machine:
    """The machine with the new values of what has changed."""
    new = {one.name: one.new.value for one in parameters if one.has_changed}
    drive, mechanics = machine.drive, machine.mechanics
    modes = [
        replace(
            mode,
            natural_frequency=2.0 * np.pi * new[f"{mode.name}.frequency"]
            if f"{mode.name}.frequency" in new
            else mode.natural_frequency,
            damping_ratio=new.get(f"{mode.name}.damping_ratio", mode.damping_ratio),
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


def _unexplained(rebuilt: Rebuilt, recorded: Sequence[Recorded]) -> float | None:
    """Share of the deviation that a machine leaves of some moves, by RMS."""
    missed = total = 0.0
    tau = rebuilt.controller.reference_delay
    for one in recorded:
        prediction = predict(rebuilt, one.motion)
        for signal in one.beside:
            if not signal.is_position:
                continue
            moving = signal.after(one.motion.begin)
            column = 0 if signal.role is Role.TOOL else 1
            late = one.motion.sample(signal.t - tau - one.applied_shift)[:, 0]
            own = prediction.at(signal.t - one.applied_shift, column)[0] - late
            missed += float(np.sum((signal.deviation - own)[moving] ** 2))
            total += float(np.sum(signal.deviation[moving] ** 2))
    return sqrt(missed / total) if total > 0.0 else None
