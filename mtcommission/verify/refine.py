"""Parameters as the traces show them, tested on moves held back; the profile and limits with them.

Mass and friction from force and motion, by the equation of motion under smooth weights:

    F(t - δ) = m y'' + F_c sign(v) + d v + F_0

y is the position less what the modes add to it under the recorded force. Both sides pass the same
Gaussian, which the equation does not feel, before anything is differentiated, and only instants
count whose whole window moves one way: what friction takes at rest nobody can tell.

Source: weak (modulating-function) form after M. Shinbrot, Trans. ASME 79 (1957) 583-588.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import ceil, hypot, pi, sqrt
from typing import Any

import numpy as np
import tomlkit
from scipy.linalg import expm, solve_banded

from mtcommission.base.errors import ComputationError, MtcommissionError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.identified import Estimate
from mtcommission.machine.keys import list_quantities
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.measured.measurement import Array
from mtcommission.measured.regression import Equations, Regression, regress
from mtcommission.record.limits import JudgedLimits
from mtcommission.record.record import Record
from mtcommission.record.shape import entry_of
from mtcommission.verify.beside import Recorded, unexplained
from mtcommission.verify.prediction import Rebuilt, on_machine
from mtcommission.verify.setpoint import runs
from mtcommission.verify.trace import Role, Trace
from mtcommission.verify.verify import Verification

REACH = 4.0
"""Half width of the weights in their standard deviations."""

SLOWEST = 0.03
"""Share of the largest velocity below which an axis may stick."""

FEWEST, FEWEST_OF_STRETCH = 60, 8
"""Samples that say something, in all and in a row."""

FEWEST_STRETCHES = 4
"""Stretches that move one way from which on the second half of them is held back."""

UNTESTED = 2.0
"""Factor on the standard errors where no stretch can be held back."""

UNSURE = 0.2
"""Standard error of the mass, relative to it, from which on nothing is said."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBody:
    """What force and motion say."""

    mass: Estimate  # [kg]
    coulomb: Estimate  # [N]
    viscous: Estimate  # [N s/m]
    # Share of the force, by RMS, that is left: of the second half of the moves by a fit to the
    # first; of all where they are few.
    unexplained: float


def fit_rigid_body(traces: Sequence[Trace], plant: Plant) -> RigidBody | None:
    """Return mass and friction; None where force or motion do not suffice."""
    rows = [stretch for trace in traces for stretch in _rows(trace, plant)]
    if not rows or sum(own.values.size for own in rows) < FEWEST:
        return None
    found = _solve(rows)
    sigma = found.sigma if len(rows) >= FEWEST_STRETCHES else UNTESTED * found.sigma
    tested, missed = rows, found.rest
    if len(rows) >= FEWEST_STRETCHES:
        half = len(rows) // 2
        first, second, tested = _solve(rows[:half]), _solve(rows[half:]), rows[half:]
        # What differs between the halves is part of the doubt, whatever the residuals say.
        sigma = np.maximum(sigma, 0.5 * np.abs(second.values - first.values))
        whole = Equations.of(tested)
        missed = whole.values - whole.columns @ first.values
    mass, coulomb, viscous = (
        Estimate(value=float(found.values[k]), sigma=float(sigma[k])) for k in (0, 2, 3)
    )
    if mass.value <= 0.0 or mass.sigma > UNSURE * mass.value:
        return None
    unexplained = float(np.linalg.norm(missed) / np.linalg.norm(Equations.of(tested).values))
    return RigidBody(mass=mass, coulomb=coulomb, viscous=viscous, unexplained=unexplained)


def _solve(rows: Sequence[Equations]) -> Regression:
    """Mass, mass times delay, Coulomb and viscous friction, and an offset."""
    whole = Equations.of(rows)
    if abs(whole.columns[:, 2].sum()) == len(whole.columns):
        whole.columns[:, 4] = 0.0  # one direction alone: a weight and friction look the same
    return regress(whole.columns, whole.values)


def _rows(trace: Trace, plant: Plant) -> list[Equations]:
    """The equations of each stretch that moves one way."""
    force = trace.channels.get(Role.FORCE)
    place = trace.channels.get(Role.ENCODER) or trace.channels.get(Role.TOOL)
    if force is None or place is None or trace.gaps:
        return []
    h = max(force.step, place.step)
    t = np.arange(max(force.t[0], place.t[0]), min(force.t[-1], place.t[-1]), h)
    F, x = np.interp(t, force.t, force.values), np.interp(t, place.t, place.values)
    for number, mode in enumerate(plant.modes):
        gain = mode.measured_gain if Role.ENCODER in trace.channels else mode.tcp_gain
        x = x - gain * _mode_motion(plant, number, F - F[0], h)
    slowest = min((mode.frequency_hz for mode in plant.modes), default=100.0)
    weights = _weights(max(1.0 / (2.0 * pi * slowest), 3.0 * h), h)
    if x.size <= 2 * weights.size:
        return []
    smooth, y = (np.convolve(signal, weights, "valid") for signal in (F, x))
    rate = np.gradient(y, h)
    acceleration = np.gradient(rate, h)
    jerk = np.gradient(acceleration, h)
    reach = (weights.size - 1) // 2
    way = np.sign(rate) * (np.abs(rate) > SLOWEST * np.abs(rate).max())
    # The whole window must move one way.
    sums = np.convolve(way, np.ones(2 * reach + 1), "same")
    one_way = np.abs(sums) >= 2 * reach + 0.5
    columns = np.column_stack([acceleration, jerk, way, rate, np.ones_like(rate)])
    return [
        Equations(columns[first:last], smooth[first:last])
        for first, last in runs(one_way)
        if last - first >= FEWEST_OF_STRETCH
    ]


def _weights(width: float, h: float) -> Array:
    """A Gaussian of unit area over the step."""
    reach = ceil(REACH * width / h)
    bell = np.exp(-0.5 * (h * np.arange(-reach, reach + 1, dtype=np.float64) / width) ** 2)
    return np.asarray(bell / bell.sum())


def _mode_motion(plant: Plant, number: int, force: Array, h: float) -> Array:
    """Q of q'' + 2 ζ ω q' + ω² q = F at the samples, the force held between them."""
    mode = plant.modes[number]
    zeta, omega = mode.damping_ratio, mode.natural_frequency
    joint = np.zeros((3, 3))
    joint[0, 1], joint[1, 2] = 1.0, 1.0
    joint[1, :2] = -(omega**2), -2.0 * zeta * omega
    step = expm(h * joint)
    A, B = step[:2, :2], step[:2, 2]
    # q[n] - tr(A) q[n-1] + det(A) q[n-2] = B_0 F[n-1] + (A_01 B_1 - A_11 B_0) F[n-2]
    driven = B[0] * np.append(0.0, force[:-1])
    driven[2:] += (A[0, 1] * B[1] - A[1, 1] * B[0]) * force[:-2]
    bands = np.outer([1.0, -np.trace(A), np.linalg.det(A)], np.ones(force.size))
    return np.asarray(solve_banded((2, 0), bands, driven), dtype=np.float64)


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


def renew_profile(text: str, refined: Refined, *, words: Catalogue, date: str) -> str:
    """Return the text of the record's profile with the parameters that the traces show.

    A kind of plant whose keys state no frequencies gets those values that give the new ones.
    ``words``: language of the comments; ``date``: day, ISO 8601. Raises InputError where the new
    values make no profile.
    """
    document = tomlkit.parse(text)
    changed = [one for one in refined.parameters if one.has_changed]
    for one in changed:
        if one.key in ("coulomb_friction", "viscous_friction"):
            _set(document["drive"], one.key, one.new.value, one.unit, _say(one, words))
    before, after = parse_profile(text, where="record"), refined.machine
    old, new = (list_quantities(one.mechanics, "plant", one.axis_units) for one in (before, after))
    for (key, value, unit), (_, was, _) in zip(new, old, strict=True):
        if _written(value, unit) == _written(was, unit):
            continue
        *above, own = key.split(".")
        table: Any = document
        for name in above:
            table = _element(table, name)
        stated = [one for one in changed if _states(key, value, one, after.mechanics.moving_mass)]
        comment = _say(stated[0], words) if stated else words.text("verify-renewed-derived")
        _set(table, own, value, unit, comment)
    head = tomlkit.document()
    head.add(tomlkit.comment(words.text("verify-renewed-head", date=date)))
    renewed = tomlkit.dumps(head) + tomlkit.dumps(document)
    parse_profile(renewed, where="--refine")
    return renewed


def _states(key: str, value: float, one: Parameter, mass: float) -> bool:
    """Whether a key of the profile states a parameter itself."""
    if one.mode:
        return key.endswith(f".{one.mode}.{one.key}")
    return one.key == "mass" and value == mass


def _element(table: Any, name: str) -> Any:
    """What stands below a key, or the element of an array with this name."""
    if isinstance(table, dict):
        return table[name]
    return next(one for one in table if str(one["name"]) == name)


def _set(table: Any, key: str, value: float, unit: str, comment: str) -> None:
    table[key] = tomlkit.item(_written(value, unit)).comment(comment)


def _written(value: float, unit: str) -> str | float:
    return float(f"{value:.4g}") if unit in ("", "-") else f"{value:.6g} {unit}"


def _say(one: Parameter, words: Catalogue) -> str:
    error = f"{2.0 * one.new.sigma:.2g} {one.unit}".rstrip()
    return words.text("verify-renewed", error=error)


@dataclass(frozen=True, slots=True, kw_only=True)
class NewLimits:
    """Old beside new; ``new`` None where ``failure`` says why there are none."""

    old: JudgedLimits
    new: JudgedLimits | None
    failure: Message | None = None


def find_new_limits(record: Record, profile: str) -> NewLimits:
    """Return what ``run`` recommends for a refined profile, beside what the record recommends."""
    from mtcommission.commission.recommend import recommend  # for --refine alone

    old = record.limits.recommended
    try:
        found = recommend(parse_profile(profile, where="--refine")).choice.candidate
    except ComputationError as error:
        return NewLimits(old=old, new=None, failure=Message("verify-no-limits", why=str(error)))
    return NewLimits(old=old, new=entry_of(JudgedLimits, found))
