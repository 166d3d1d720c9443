"""Random printer axes: our shaper and acceleration beside every textbook shaper with its best one.

    python -m benchmarks.printers --machines 300
    python -m benchmarks.printers --machines 60 --klipper    (beside calibrate_shaper)

Each axis follows its steps and has one mode, or two, with the motor held. The textbook shapers (ZV,
MZV, ZVD, classical EI) stand at the nominal frequency and damping of the main mode, each with the
largest acceleration whose every shorter move stays within the same band in the same corners; they
are judged, like our choice, by a program of their own: closed form per mode in complex numbers,
moves up to the listed one on a grid, no line of the package but the impulses' published formulas,
written down once more. Shown is by how much our listed move takes longer than the best of them.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from math import ceil, exp, pi, sqrt
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.calibrate_shaper import propose_shapers
from mtcommission.limits.choose import choose_limits
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.setpoint_filter import SetpointFilter, shape
from mtcommission.measured.measurement import AllDirections

Array = NDArray[np.float64]
Impulses = list[tuple[float, float]]

RESERVE = 0.8
"""Share of the band that both may use."""
LARGEST = 0.95
"""Share of the motor's acceleration that both may use."""
CEILING = 20.0
"""What nobody types into Klipper more than (docs/exports.md); both keep to it [m/s²]."""
TEXTBOOK = ("zv", "mzv", "zvd", "ei")
BEHIND = 0.02
"""By how much our choice may take longer [-]."""
SIZES = 400
"""Shorter moves that are looked at, as lengths of the ramp to the top."""


@dataclass(frozen=True)
class Axis:
    """One random axis; SI, frequencies in Hz."""

    modes: list[tuple[float, float, float]]
    largest: float
    distance: float
    velocity: float
    band: float
    spread: float
    damping_spread: float

    @property
    def profile(self) -> str:
        modes = "".join(
            f"[[plant.modes]]\nname = 'm{n}'\nfrequency = {f!r}\ndamping_ratio = {zeta!r}\n"
            f"tcp_gain = {share!r}\n"
            for n, (f, zeta, share) in enumerate(self.modes)
        )
        return (
            "schema = 1\n[machine]\nname = 'random printer'\naxis = 'X'\nsource = 'random'\n"
            f"[plant]\nkind = 'modal'\n{modes}"
            f"[drive]\nkind = 'position_source'\nmax_acceleration = {self.largest!r}\n"
            f"[[moves]]\ndistance = {self.distance!r}\nmax_velocity = {self.velocity!r}\n"
            f"[requirements]\ntcp_deviation = {self.band!r}\n"
            f"frequency_spread = {self.spread!r}\ndamping_spread = {self.damping_spread!r}\n"
            "[control]\nkind = 'klipper'\n"
        )

    @property
    def corners(self) -> list[list[tuple[complex, float]]]:
        """Pole and share of each mode, nominal and at the ends of both spreads."""
        factors = [(1.0, 1.0)] + [
            (1.0 + a * self.spread, 1.0 + b * self.damping_spread) for a in (-1, 1) for b in (-1, 1)
        ]
        return [
            [
                (2 * pi * f * u * complex(-zeta * v, sqrt(1 - (zeta * v) ** 2)), share)
                for f, zeta, share in self.modes
            ]
            for u, v in factors
        ]


def random_axis(seed: int) -> Axis:
    """An axis of a printer, from a slow bed to a light head."""
    rng = np.random.default_rng([20261123, seed])
    f, zeta = float(rng.uniform(22.0, 110.0)), float(rng.uniform(0.02, 0.12))
    modes = [(f, zeta, 1.0)]
    if rng.random() < 0.4:
        share = float(rng.uniform(0.05, 0.3))
        higher = f * float(rng.uniform(1.6, 3.0))
        modes = [(f, zeta, 1.0 - share), (higher, float(rng.uniform(0.02, 0.08)), share)]
    return Axis(
        modes=modes,
        largest=float(rng.uniform(5.0, 30.0)),
        distance=float(rng.choice([0.01, 0.02, 0.05])),
        velocity=float(rng.choice([0.1, 0.2, 0.3])),
        band=float(rng.choice([10e-6, 20e-6, 40e-6])),
        spread=float(rng.choice([0.03, 0.05, 0.07])),
        damping_spread=0.3,
    )


def textbook(kind: str, f: float, zeta: float) -> Impulses:
    """Delays and shares as the textbooks and Klipper's documentation state them."""
    spacing = 0.375 if kind == "mzv" else 0.5
    plain = {
        "zv": [1.0, 1.0],
        "mzv": [1 - sqrt(0.5), sqrt(2) - 1, 1 - sqrt(0.5)],
        "zvd": [1.0, 2.0, 1.0],
        "ei": [1.05, 1.9, 1.05],
    }[kind]
    root = sqrt(1 - zeta**2)
    fade = exp(-2 * pi * zeta / root * spacing)
    sized = [share * fade**n for n, share in enumerate(plain)]
    return [(n * spacing / (f * root), s / sum(sized)) for n, s in enumerate(sized)]


def steps_of(axis: Axis, a: float, rise: Array) -> tuple[Array, Array]:
    """Steps of the acceleration of a move, for ramps of ``rise`` [s]: times and sizes."""
    zero = np.zeros_like(rise)
    top = axis.velocity / a
    cruise = np.where(rise >= top * (1 - 1e-12), max(axis.distance / axis.velocity - top, 0.0), 0.0)
    times = np.column_stack([zero, rise, rise + cruise, 2 * rise + cruise])
    return times, a * np.array([1.0, -1.0, -1.0, 1.0])


def residual(axis: Axis, impulses: Impulses, times: Array, sizes: Array) -> float:
    """Largest deviation after the end, over all moves and corners [m].

    q'' + 2 zeta omega q' + omega² q = -a: a step of the acceleration leaves
    q = -(a/omega²) (1 - Re[(1 - i zeta/root) e^(p t)]) at the time t after it.
    """
    last = impulses[-1][0]
    worst = 0.0
    for corner in axis.corners:
        envelopes = []
        for pole, share in corner:
            omega, zeta = abs(pole), -pole.real / abs(pole)
            lead = complex(1.0, -zeta / sqrt(1 - zeta**2))
            end = times[:, -1:] + last
            total = np.zeros(len(times), dtype=complex)
            for delay, part in impulses:
                total += part * (sizes * np.exp(pole * (end - times - delay))).sum(axis=1)
            envelopes.append(share / omega**2 * lead * total)
        slowest = min(abs(pole) for pole, _ in corner)
        fastest = max(abs(pole) for pole, _ in corner)
        t = np.linspace(0.0, 2 * pi / slowest, ceil(48 * fastest / slowest))
        signal = sum(
            np.real(envelope[:, None] * np.exp(pole * t))
            for envelope, (pole, _) in zip(envelopes, corner, strict=True)
        )
        worst = max(worst, float(np.abs(signal).max()))
    return worst


def judge(axis: Axis, impulses: Impulses, a: float) -> tuple[float, float]:
    """Duration of the listed move and the largest residual of it and every shorter one [s, m]."""
    top = min(axis.velocity / a, sqrt(axis.distance / a))
    rise = np.concatenate([np.linspace(top / SIZES, top, SIZES), [top]])
    times, sizes = steps_of(axis, a, rise)
    worst = residual(axis, impulses, times, sizes)
    if axis.velocity / a <= top * (1 + 1e-12):  # cruises of every length at the top
        cruise = np.linspace(0.0, max(axis.distance / axis.velocity - top, 0.0), SIZES)
        full = np.full(SIZES, top)
        late = np.column_stack([0 * full, full, full + cruise, 2 * full + cruise])
        worst = max(worst, residual(axis, impulses, late, sizes))
    return float(times[-1, -1]) + impulses[-1][0], worst


def best_of(axis: Axis, impulses: Impulses) -> float:
    """Shortest listed move whose every shorter one stays within the reserve of the band [s]."""
    tried = np.geomspace(min(LARGEST * axis.largest, CEILING), 0.02 * axis.largest, 240)
    for a in tried.tolist():
        duration, worst = judge(axis, impulses, a)
        if worst <= RESERVE * axis.band:
            return duration
    return float("inf")


def compare(seed: int) -> dict[str, object]:
    """Our choice and the textbook shapers on one axis."""
    axis = random_axis(seed)
    machine = parse_profile(axis.profile, where=f"axis {seed}")
    begun = perf_counter()
    choice = choose_limits(machine, tune_loop(machine))
    took = perf_counter() - begun
    limits = choice.limits
    item = limits.setpoint_filter or SetpointFilter(kind="none")
    delays, shares = item.impulses
    duration, worst = judge(axis, list(zip(delays, shares, strict=True)), limits.acceleration)
    main = axis.modes[0]
    others = {kind: best_of(axis, textbook(kind, main[0], main[1])) for kind in TEXTBOOK}
    soonest = min(others.values())
    return {
        "seed": seed,
        "axis": asdict(axis),
        "ours": {
            "kind": item.kind,
            "frequency_hz": item.frequency_hz,
            "acceleration": limits.acceleration,
            "duration": duration,
            "residual_share": worst / axis.band,
        },
        "textbook": others,
        "behind": duration / soonest - 1.0,
        "seconds": took,
    }


OFF = 0.07
"""By how much the machine differs from the fitted one in ``beside_klipper`` [-]."""
SAME = 0.005
"""What counts as equally soon, and as the same residual by the band [-]."""


def beside_klipper(seed: int) -> dict[str, object]:
    """Our choice and calibrate_shaper's, on the axis that was measured and where it is 7 % off.

    One that is slower without leaving less, or leaves more without being sooner, is dominated.
    """
    axis = replace(random_axis(seed), spread=0.03)
    lines = np.arange(0.0, 200.1, 1.5625)
    s = 2j * pi * lines
    transfer = np.ones(lines.size, dtype=complex)
    for f, zeta, share in axis.modes:
        omega = 2 * pi * f
        transfer -= share * s**2 / (s**2 + 2 * zeta * omega * s + omega**2)
    power = lines**2 * np.abs(transfer) ** 2 * (lines < 134.0)
    measured = AllDirections(frequency_hz=lines, density=power, is_divided=False)
    (theirs,) = [one for one in propose_shapers([measured]) if one.is_recommended]
    machine = parse_profile(axis.profile, where=f"axis {seed}")
    limits = choose_limits(machine, tune_loop(machine)).limits
    ours = limits.setpoint_filter
    delays, shares = ours.impulses if ours else ((0.0,), (1.0,))
    copies = shape(theirs.shaper, frequency_hz=theirs.frequency_hz, damping_ratio=0.1)
    a = min(theirs.max_acceleration, axis.largest, CEILING)
    places = {}
    for off in (0.0, -OFF, OFF):
        modes = [(f * (1.0 + off), zeta, share) for f, zeta, share in axis.modes]
        there = replace(axis, modes=modes, spread=0.0, damping_spread=0.0)
        own = judge(there, list(zip(delays, shares, strict=True)), limits.acceleration)
        other = judge(there, list(zip(*copies, strict=True)), a)
        later, more = own[0] / other[0] - 1.0, (own[1] - other[1]) / axis.band
        places[f"{off:+.0%}"] = {
            "later": later,
            "more": more,
            "dominated": (later > SAME and more > -SAME) or (more > SAME and later > -SAME),
            "residual_shares": [own[1] / axis.band, other[1] / axis.band],
        }
    return {"seed": seed, "theirs": theirs.shaper, "places": places}


def compare_klipper(seeds: Sequence[int]) -> int:
    """Compare with calibrate_shaper; 1 if more than one case of twenty is dominated."""
    rows = [beside_klipper(seed) for seed in seeds]
    for off in (f"{off:+.0%}" for off in (0.0, -OFF, OFF)):
        cases = [row["places"][off] for row in rows]  # type: ignore[index]
        out = [sum(case["residual_shares"][n] > 1.0 for case in cases) for n in (0, 1)]
        sys.stdout.write(
            f"{off}: {sum(case['dominated'] for case in cases)} of {len(cases)} dominated by "
            f"calibrate_shaper; median {np.median([case['later'] for case in cases]):+.1%} of its "
            f"time; outside the band ours {out[0]}, calibrate_shaper's {out[1]}\n"
        )
    lost = sum(case["dominated"] for row in rows for case in row["places"].values())  # type: ignore[attr-defined]
    return int(lost > len(rows) * 3 / 20)


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare on some axes; 1 if one is more than 2 % behind or leaves the band."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--json", type=Path, help="A row for each axis, as it is found.")
    parser.add_argument("--klipper", action="store_true", help="Beside calibrate_shaper instead.")
    given = parser.parse_args(arguments)
    if given.klipper:
        return compare_klipper(range(given.first, given.first + given.machines))
    rows = []
    for seed in range(given.first, given.first + given.machines):
        row = compare(seed)
        rows.append(row)
        line = json.dumps(row)
        if given.json:
            with given.json.open("a", encoding="utf-8") as file:
                file.write(line + "\n")
        sys.stdout.write(f"{seed} {row['behind']:+.4f} {row['ours']}\n")
    behind = np.array([row["behind"] for row in rows], dtype=float)
    outside = sum(row["ours"]["residual_share"] > 1.0 for row in rows)  # type: ignore[index]
    sys.stdout.write(
        f"{len(rows)} axes: behind the best textbook shaper by more than {BEHIND:.0%} on "
        f"{int((behind > BEHIND).sum())}, at most {behind.max():+.2%}, median "
        f"{np.median(behind):+.2%}; outside the band on {outside}\n"
    )
    return int((behind > BEHIND).any() or outside > 0)


if __name__ == "__main__":
    sys.exit(main())
