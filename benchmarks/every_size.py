"""The choice of limits against a plain grid that is refined where it is best, on every control.

    python -m benchmarks.every_size --machines 300 [--first 0] [--points 14] [--write DIRECTORY]
    python -m benchmarks.every_size PROFILE.toml ...

Random machines over all kinds of control and drive, with the loop of ``tune_loop`` and the reserve
kept. The grid: filters of the control, jerk times from 1 ms to 3 s, accelerations, judged from the
fastest on, then refined about the best. The judge is this file's own: plain
sizes of each move, dense ones before anything counts; with the search it shares the loop's response
alone (``mtcommission.loop.respond``), which tests/test_respond.py holds to the stepped loop.

The former benchmark found nothing where others found a seventh of all machines 2 % behind: its
machines had the control ``generic`` alone, at cycles of 1 ms mostly; its grid ended at a jerk time
of 0.3 s, where the search ended, too, and was not refined; and the search's own sampled answers
judged both.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from math import inf, isfinite, pi
from pathlib import Path

import numpy as np

from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError
from mtcommission.controls.kind import MOVING_AVERAGE, SHAPERS, TWO_AVERAGES, ControlKind
from mtcommission.controls.kinds import KINDS
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.requirements import keep_reserve
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.respond import extremes, free_motion, lay_grid, outputs_at, set_in_motion
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import without_jerk_limit
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps
from mtcommission.setpoint.smaller_moves import size_of

SHORTEST, LONGEST, LEAST_SHARE = 1e-3, 3.0, 1e-4
"""Jerk times [s], and the least acceleration as a share of the largest, of the grid."""
TIERS = (10, 60, 300, 800)
"""Sizes of a move that are looked at in turn, until one is not allowed."""
REFINED, NEAR, TRIED, REACHES = 3, 1.1, 8, (0.15, 0.07, 0.03, 0.015, 0.007, 0.003)
"""Best places about which the grid is refined, how much later than the soonest others may be,
accelerations tried for each, and how far about a place is looked [-]."""

Place = tuple[SetpointFilter | None, float, float]
"""Filter, jerk time [s], acceleration [m/s²]."""


def draw_profile(seed: int) -> str:
    """Return a random profile: machines of the population under every kind of control in turn."""
    machine, generator = random_machine(seed), np.random.default_rng([2026, seed])
    kind = list(KINDS.values())[seed % len(KINDS)]
    mechanics, drive, (move,) = machine.mechanics, machine.drive, machine.moves
    assert isinstance(mechanics, Modal)
    lines = ["schema = 1", "[machine]", f'name = "Random machine {seed}"', 'axis = "X"']
    lines += ['source = "drawn at random"', "[plant]", 'kind = "modal"']
    lines += [] if kind.follows_steps else [f"moving_mass = {mechanics.moving_mass}"]
    for mode in mechanics.modes:
        lines += ["[[plant.modes]]", f'name = "{mode.name}"']
        lines += [f"frequency = {mode.natural_frequency / (2.0 * pi)}"]
        lines += [f"damping_ratio = {mode.damping_ratio}"]
        if kind.follows_steps:
            lines += [f"tcp_gain = {abs(mode.tcp_gain) * mechanics.moving_mass}"]
        else:
            lines += [f"tcp_gain = {mode.tcp_gain}", f"measured_gain = {mode.measured_gain}"]
    largest = drive.max_force / mechanics.moving_mass
    if kind.follows_steps:
        lines += ["[drive]", 'kind = "position_source"', f"max_acceleration = {largest}"]
    else:
        lines += ["[drive]", f"force_lag = {drive.force_lag}", f"max_force = {drive.max_force}"]
        if generator.integers(2):
            lines += [f"continuous_force = {drive.max_force * generator.uniform(0.3, 0.8)}"]
    lines += ["[[moves]]", f"dwell = {generator.uniform(0.02, 0.5)}"]
    if isinstance(move, VelocityStep):
        lines += [f"velocity_step = {move.velocity_step}"]
    else:
        lines += [f"distance = {move.distance}", f"max_velocity = {move.max_velocity}"]
    needs = machine.requirements
    lines += [
        "[requirements]",
        f"tcp_deviation = {np.exp(generator.uniform(*np.log([1e-6, 5e-5])))}",
    ]
    lines += [f"frequency_spread = {needs.frequency_spread}"]
    lines += [] if kind.follows_steps else [f"payload = [0.0, {needs.payload[1]}]"]
    lines += ["[control]", f'kind = "{kind.key}"']
    if not kind.follows_steps:
        cycle = float(generator.choice([1e-3, 2e-3, 4e-3]))
        loop = kind.position_loops[int(generator.integers(len(kind.position_loops)))]
        lines += [f'position_loop = "{loop.value}"', f"position_cycle = {cycle}"]
        lines += [f"velocity_cycle = {cycle / float(generator.choice([4, 8]))}"]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judge:
    """What is allowed on a machine with its loop, every size of its moves counted."""

    machine: Machine  # whose requirements count as they stand
    poles: LoopPoles
    known: dict[Place, bool] = field(default_factory=dict)

    def durations(self, item: SetpointFilter | None, jerk_time: float, a: np.ndarray) -> np.ndarray:
        """t_e + τ of the slowest listed move, shape of ``a`` [s]."""
        jerk, moves = a / jerk_time, self.machine.moves
        ends = [jerk_steps(move, acceleration=a, jerk=jerk).duration for move in moves]
        late = self.poles.delay + (item.duration if item else 0.0)
        return np.asarray(np.max(ends, axis=0) + late)

    def duration(self, place: Place) -> float:
        """The same of one place [s]."""
        item, jerk_time, a = place
        return float(self.durations(item, jerk_time, np.array([a]))[0])

    def allows(self, place: Place) -> bool:
        """Whether band, force and RMS force are kept in every size and corner."""
        if place not in self.known:
            moves = self.machine.moves
            self.known[place] = all(
                self._keeps(place, move, count) for count in TIERS for move in moves
            )
        return self.known[place]

    def _keeps(self, place: Place, move: Move, count: int) -> bool:
        needs, drive, poles = self.machine.requirements, self.machine.drive, self.poles
        even = np.linspace(0.0, 1.0, count // 2 + 1)[1:] ** 2
        sizes = np.append(np.geomspace(1e-5, 1.0, count // 2), even)
        motions = set_in_motion(poles, self._plan(place, move, sizes))
        free = free_motion(motions, lay_grid(poles, 24))
        if free.residual.max() > needs.tcp_deviation:
            return False
        if count != TIERS[1]:
            return True
        grid, parts, force = (
            lay_grid(poles, 24),
            np.arange(poles.cycles),
            np.eye(1, poles.outputs, 2),
        )
        peaks = extremes(motions, grid, force, parts=parts)
        if peaks.max() > drive.motion_force:
            return False
        if not isfinite(drive.continuous_force):
            return True
        return all(self._rms(place, move, share) <= drive.continuous_force for share in even[::-2])

    def _rms(self, place: Place, move: Move, share: float) -> float:
        """RMS motor force of a size, worst corner, over the move and its dwell [N]."""
        steps = self._plan(place, move, np.array([share]))
        window = float(steps.duration[0]) + move.dwell
        n = np.linspace(0, window / self.poles.dt, 1500).astype(np.int64)
        motor = np.eye(1, self.poles.outputs, self.poles.outputs - 1)
        force = outputs_at(set_in_motion(self.poles, steps), n[None], motor)[0, ..., 0]
        return float(np.sqrt((force**2).mean(axis=(1, 2)).max()))

    def _plan(self, place: Place, move: Move, shares: np.ndarray) -> JerkSteps:
        item, jerk_time, acceleration = place
        a = np.full_like(shares, acceleration)
        steps = jerk_steps(move, acceleration=a, jerk=a / jerk_time, size=shares * size_of(move))
        return filter_steps(steps, item)

    def seem_allowed(
        self, item: SetpointFilter | None, jerk_time: float, a: np.ndarray
    ) -> np.ndarray:
        """Whether a few sizes of each keep the band, shape of ``a``."""
        kept, shares = np.ones(len(a), dtype=bool), np.geomspace(0.01, 1.0, TIERS[0])
        for move in self.machine.moves:
            each, sizes = np.repeat(a, TIERS[0]), np.tile(shares * size_of(move), len(a))
            steps = jerk_steps(move, acceleration=each, jerk=each / jerk_time, size=sizes)
            motions = set_in_motion(self.poles, filter_steps(steps, item))
            left = free_motion(motions, lay_grid(self.poles, 12)).residual.max(axis=1)
            kept &= left.reshape(len(a), -1).max(axis=1) <= self.machine.requirements.tcp_deviation
        return kept


def soonest_of_grid(judge: Judge, points: int) -> tuple[float, Place | None]:
    """Return the soonest allowed place of the refined grid, and its settling time [s]."""
    machine, best = judge.machine, list[tuple[float, Place]]()
    kind = machine.control.kind
    largest = machine.drive.motion_force / moving_mass(machine)
    times = [without_jerk_limit(machine, 1.0).jerk_time]
    if kind.has_jerk_limit:
        times = np.geomspace(SHORTEST, LONGEST, points).tolist()
    ladder = largest * np.geomspace(LEAST_SHARE, 1.0, 2 * points)
    soonest = inf
    for item, t in product(filters_of(machine, points), times):
        ends = judge.durations(item, t, ladder)
        # What is allowed has gaps, so from the fastest that a few sizes allow downwards.
        a = ladder[ends <= NEAR * soonest]
        few = a[judge.seem_allowed(item, t, a)][::-1] if len(a) else a
        found = next((x for x in few[:TRIED].tolist() if judge.allows((item, t, x))), None)
        if found is None:
            continue
        duration = judge.duration((item, t, found))
        best.append((duration, (item, t, found)))
        soonest = min(soonest, duration)
    begin = sorted(best, key=lambda x: x[0])[:REFINED]
    refined = [refine(judge, duration, place, largest) for duration, place in begin]
    return min(refined, key=lambda x: x[0], default=(inf, None))


def filters_of(machine: Machine, points: int) -> list[SetpointFilter | None]:
    """None and the filters of a control, logarithmic, as long or high as it takes them."""
    control, found = machine.control, list[SetpointFilter | None]()
    cycle = control.position_cycle
    if not control.seeks_setpoint_filter:
        return [control.setpoint_filter]
    for choice in control.kind.setpoint_filters:
        least, most = choice.times(cycle)
        lengths = np.geomspace(max(least, 2.0 * cycle), max(most, 2.0 * cycle), points // 2)
        modes = build_plant(machine).modes
        if choice.kind == MOVING_AVERAGE and most > least:
            found += [SetpointFilter(kind=choice.kind, time=t) for t in lengths]
        elif choice.kind == TWO_AVERAGES and most > least:
            found += [
                SetpointFilter(kind=choice.kind, time=t, second_time=s)
                for t, s in product(lengths, lengths[::2])
                if s <= t
            ]
        elif choice.kind in SHAPERS:
            for mode, factor in product(modes, np.geomspace(0.7, 1.4, points // 3)):
                zeta = min(max(mode.damping_ratio, choice.least_damping), choice.most_damping)
                found += [
                    SetpointFilter(
                        kind=choice.kind,
                        frequency_hz=factor * mode.frequency_hz,
                        damping_ratio=zeta,
                    )
                ]
    whole = [settable(control.kind, item, cycle) for item in found if item]
    return [None, *dict.fromkeys(item for item in whole if item is not None)]


def settable(kind: ControlKind, item: SetpointFilter, cycle: float) -> SetpointFilter | None:
    """The nearest filter that the control takes; None: out of its range."""
    choice = kind.find_filter(item.kind)
    assert choice is not None
    if item.frequency_hz:
        inside = choice.least_frequency_hz <= item.frequency_hz <= choice.most_frequency_hz
        return item if inside else None
    least, most = choice.times(cycle)
    step = choice.unit(cycle)
    times = [round(t / step) * step for t in (item.time, item.second_time)]
    if any(t and not least <= t * (1.0 + 1e-9) <= most * (1.0 + 2e-9) for t in times):
        return None
    return replace(item, time=times[0], second_time=times[1]) if times[0] else None


def refine(judge: Judge, duration: float, place: Place, largest: float) -> tuple[float, Place]:
    """Return the soonest allowed place that ever finer grids about one lead to."""
    control = judge.machine.control
    for reach in REACHES:
        for _ in range(12):
            item, t, a = place
            times = np.array([t])
            if control.kind.has_jerk_limit:
                times = np.maximum(t * np.array([1.0 - reach, 1.0, 1.0 + reach]), SHORTEST)
            steps = np.minimum(a * (1.0 + reach * np.arange(-2.0, 5.0)), largest)
            around = product(beside(judge.machine, item, reach), times, np.unique(steps))
            ranked = sorted(((judge.duration(p), p) for p in around), key=lambda x: x[0])
            better = (p for p in ranked if p[0] < duration * (1.0 - 1e-4) and judge.allows(p[1]))
            found = next(better, None)
            if found is None:
                break
            duration, place = found
    return duration, place


def beside(
    machine: Machine, item: SetpointFilter | None, reach: float
) -> list[SetpointFilter | None]:
    """A filter and those of its kind that are shorter and longer."""
    control = machine.control
    if item is None or not control.seeks_setpoint_filter:
        return [item]
    step, found = control.position_cycle, [item]
    for sign in (-1.0, 1.0):
        if item.frequency_hz:
            found.append(replace(item, frequency_hz=item.frequency_hz * (1.0 + sign * reach)))
            continue
        for name in ("time", "second_time") if item.second_time else ("time",):
            own = getattr(item, name)
            found.append(replace(item, **{name: own + sign * max(reach * own, step)}))
    settled = [settable(control.kind, each, step) for each in found if each.duration > 0.0]
    return list(dict.fromkeys(each for each in settled if each is not None))


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One machine: settling times of the choice and of the grid [s], and what found them."""

    name: str
    kind: str
    is_met: bool
    ours: float
    grid: float
    chosen: str
    best: str
    seconds: tuple[float, float]

    @property
    def behind(self) -> float:
        """By how much the grid is sooner, as a share of its settling time [-]."""
        if not isfinite(self.grid):
            return 0.0
        return self.ours / self.grid - 1.0 if self.is_met else inf

    def __str__(self) -> str:
        return (
            f"{self.name:20} {self.kind:12} {'met' if self.is_met else 'not met':8}"
            f"{1e3 * self.ours:10.2f} {1e3 * self.grid:10.2f} ms {100 * self.behind:+7.2f} % "
            f"{self.seconds[0]:6.1f} {self.seconds[1]:6.1f} s  {self.chosen} | {self.best}"
        )


def measure(machine: Machine, points: int) -> Row:
    """Return the choice of limits and the refined grid's on one machine."""
    tuned = tune_loop(machine)
    begun = time.process_time()
    choice = choose_limits(machine, tuned)
    spent = time.process_time() - begun
    # Where nothing is met, whatever the grid finds counts, reserve or not.
    whole = choice.reserve_used or not choice.meets_requirements
    judge = Judge(
        machine=machine if whole else keep_reserve(machine), poles=find_poles(tuned.loops)
    )
    grid, place = soonest_of_grid(judge, points)
    own = choice.limits
    return Row(
        name=machine.name,
        kind=machine.control.kind.key,
        is_met=choice.meets_requirements,
        ours=choice.candidate.settling_time,
        grid=grid,
        chosen=describe((own.setpoint_filter, own.jerk_time, own.acceleration)),
        best=describe(place) if place else "none",
        seconds=(spent, time.process_time() - begun - spent),
    )


def describe(place: Place) -> str:
    item, jerk_time, a = place
    own = f"{item.kind} {1e3 * item.duration:.1f} ms" if item else "no filter"
    return f"{a:.4g} m/s2, {1e3 * jerk_time:.4g} ms, {own}"


def machines(profiles: list[Path], first: int, count: int) -> Iterator[tuple[str, Machine]]:
    texts = [(path.name, path.read_text(encoding="utf-8")) for path in profiles]
    texts += [(f"r{seed}.toml", draw_profile(seed)) for seed in range(first, first + count)]
    for name, text in texts:
        yield text, parse_profile(text, where=name)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("profiles", nargs="*", type=Path)
    parser.add_argument("--machines", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="seed of the first of them")
    parser.add_argument("--points", type=int, default=14, help="of the grid in each direction")
    parser.add_argument("--write", type=Path, default=None, help="profiles more than 1 %% behind")
    options = parser.parse_args()
    rows = []
    for text, machine in machines(options.profiles, options.first, options.machines):
        try:
            row = measure(machine, options.points)
        except ComputationError as error:
            print(
                f"{machine.name:20} {machine.control.kind.key:12} {error.outcome.name}", flush=True
            )
            continue
        rows.append(row)
        print(row, flush=True)
        if options.write and row.behind > 0.01:
            name = machine.name.replace(" ", "-").lower()
            (options.write / f"{name}.toml").write_text(text, encoding="utf-8")
    late = [sum(row.behind > share for row in rows) for share in (0.01, 0.02)]
    print(f"{len(rows)} machines: {late[0]} more than 1 % behind, {late[1]} more than 2 %; worst:")
    for row in sorted(rows, key=lambda row: -row.behind)[:5]:
        print(row)


if __name__ == "__main__":
    main()
