"""Hundreds of random machines: a stable tuned loop with the stated margins, or a named outcome.

Run as ``python -m benchmarks.loop_survey [--count 300] [--corners 60]``. Two groups:

- ``count`` machines of ``benchmarks.population``, the cascade alone;
- ``corners`` machines with one to four modes, payload from 0 to 20 % of the moving mass and
  frequencies off by 5 % either way, with state feedback where it is of use, in turn without and
  with a second encoder near the tool.

A loop counts as tuned if in every corner the poles of the sampled loop lie inside the unit circle
(``numpy``) and the margins, read from the open loop's frequency response here once more, are those
stated. Anything but that or a named outcome ends the survey.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError
from mtcommission.loop.tuning.tuned import TUNING, TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, moving_mass
from tests.machines import random_modal_machine

ROUNDING = 1e-3
"""A margin read between the samples of the frequency response may differ by so much (relative)."""


@dataclass(slots=True, kw_only=True)
class Tally:
    name: str
    ends: Counter[str] = field(default_factory=Counter)
    with_feedback: int = 0
    gain_margin_db: list[float] = field(default_factory=list)
    phase_margin_deg: list[float] = field(default_factory=list)
    sensitivity_peak: list[float] = field(default_factory=list)
    bandwidth_hz: list[float] = field(default_factory=list)
    radius: float = 0.0
    processor: float = 0.0


def from_population(seed: int) -> Machine:
    return random_machine(seed)


def in_corners(seed: int) -> Machine:
    machine = random_modal_machine(seed, n_modes=1 + seed % 4)
    has_sensor = seed // 4 % 2 == 1
    return replace(
        machine,
        requirements=replace(
            machine.requirements, frequency_spread=0.05, payload=(0.0, 0.2 * moving_mass(machine))
        ),
        control=replace(machine.control, has_tcp_sensor=has_sensor),
    )


def survey(name: str, build: Callable[[int], Machine], count: int) -> Tally:
    tally = Tally(name=name)
    start = time.process_time()
    for seed in range(count):
        try:
            tuned = tune_loop(build(seed))
        except ComputationError as error:
            tally.ends[error.outcome.name] += 1
            continue
        examine(tuned, tally, where=f"{name}, seed {seed}")
        tally.ends["tuned"] += 1
        tally.with_feedback += bool(tuned.controller.state_gains.any())
    tally.processor = time.process_time() - start
    return tally


def examine(tuned: TunedLoop, tally: Tally, *, where: str) -> None:
    """Add the worst corner of a loop to the tally; stop if it is not what was promised."""
    radius = max(float(np.max(np.abs(np.linalg.eigvals(loop.lifted.A)))) for loop in tuned.loops)
    peak = max(float(np.max(1.0 / np.abs(1.0 + item.open_loop))) for item in tuned.responses)
    phase = min(least_phase(item.open_loop) for item in tuned.responses)
    gain = min(analysis.gain_margin_db for analysis in tuned.analyses)
    is_kept = (
        radius < 1.0
        and peak <= TUNING.sensitivity_peak * (1.0 + ROUNDING)
        and phase >= TUNING.phase_margin_deg * (1.0 - ROUNDING)
        and gain >= TUNING.gain_margin_db
    )
    if not is_kept:
        raise SystemExit(f"{where}: radius {radius}, peak {peak}, phase {phase}, gain {gain} dB")
    tally.radius = max(tally.radius, radius)
    tally.sensitivity_peak.append(peak)
    tally.phase_margin_deg.append(phase)
    tally.gain_margin_db.append(gain)
    tally.bandwidth_hz.append(tuned.least_bandwidth_hz)


def least_phase(open_loop: np.ndarray) -> float:
    """The least angle between L and -1 where |L| passes 1, from the chords of the curve."""
    here, there = open_loop[:-1], open_loop[1:]
    cuts = (np.abs(here) > 1.0) != (np.abs(there) > 1.0)
    here, chord = here[cuts], (there - here)[cuts]
    b, c = (here.conj() * chord).real, np.abs(here) ** 2 - 1.0
    a, root = np.abs(chord) ** 2, np.sqrt(b**2 - np.abs(chord) ** 2 * c)
    share = np.where(c > 0.0, (-b - root) / a, (-b + root) / a)
    return float(np.degrees(np.min(np.abs(np.angle(-(here + share * chord))), initial=np.pi)))


def describe(tally: Tally) -> str:
    ends = ", ".join(f"{number} {name}" for name, number in tally.ends.most_common())
    lines = [
        f"{tally.name}: {sum(tally.ends.values())} machines: {ends}; {tally.with_feedback} with "
        f"state feedback; {tally.processor:.0f} s processor time"
    ]
    if tally.bandwidth_hz:
        low, high = min(tally.bandwidth_hz), max(tally.bandwidth_hz)
        lines += [
            f"  least gain margin {min(tally.gain_margin_db):.2f} dB (stated >= 6), "
            f"phase margin {min(tally.phase_margin_deg):.2f} degrees (>= 30), "
            f"largest sensitivity peak {max(tally.sensitivity_peak):.4f} (<= 2), "
            f"spectral radius {tally.radius:.6f} (< 1)",
            f"  bandwidth {low:.2g} ... {high:.3g} Hz, median {np.median(tally.bandwidth_hz):.3g}",
        ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300, help="machines of the population")
    parser.add_argument("--corners", type=int, default=60, help="machines with state feedback")
    options = parser.parse_args()
    print(describe(survey("population", from_population, options.count)), flush=True)
    print(describe(survey("corners", in_corners, options.corners)), flush=True)


if __name__ == "__main__":
    main()
