"""Random axes with noise: which modes identify finds, how exactly, and whether its intervals hold.

Run as ``python -m benchmarks.identify_survey [--count 100] [--grid log|linear|both]``. Each axis
has a rigid mass with friction, a delay and one to six modes, 12 to 450 Hz, damping 0.3 to 10 %, at
least the sum of their half-power widths apart, a mode above the band that nobody tells, 1 to 10 %
noise, and up to four stretches in which the coherence is bad. The coherence is estimated from 16
averages, so it scatters itself. A mode counts as found within twice its damping ratio.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit import Fitted, fit_state
from mtcommission.measured.measurement import (
    FrequencyResponse,
    Sensor,
    Signal,
    Source,
)

Array = NDArray[np.float64]

AVERAGES = 16
LINES = 600
HIGHEST_HZ = 1000.0
GRIDS: dict[str, Array] = {
    "log": np.geomspace(2.0, HIGHEST_HZ, LINES),
    "linear": np.linspace(HIGHEST_HZ / LINES, HIGHEST_HZ, LINES),
}


@dataclass(frozen=True, kw_only=True)
class Axis:
    """What is true."""

    mass: float
    drag: float
    delay: float
    frequency_hz: Array
    damping_ratio: Array
    gain: Array
    hidden_hz: float
    hidden_gain: float


def random_axis(rng: np.random.Generator, *, modes: int | None = None) -> Axis:
    count = modes or int(rng.integers(1, 7))
    while True:
        f = np.sort(np.exp(rng.uniform(np.log(12.0), np.log(450.0), count)))
        zeta = np.exp(rng.uniform(np.log(0.003), np.log(0.1), count))
        width = 2 * zeta * f
        if np.all(np.diff(f) >= width[1:] + width[:-1]):
            break
    mass = float(np.exp(rng.uniform(np.log(0.05), np.log(2000.0))))
    return Axis(
        mass=mass,
        drag=rng.uniform(0.0, 20.0),
        delay=rng.uniform(0.0, 1.5e-3),
        frequency_hz=f,
        damping_ratio=zeta,
        gain=np.exp(rng.uniform(np.log(0.1), np.log(2.0), count)) / mass,
        hidden_hz=HIGHEST_HZ * rng.uniform(1.3, 2.5),
        hidden_gain=rng.uniform(0.1, 1.0) / mass,
    )


def measure(
    rng: np.random.Generator, axis: Axis, frequency_hz: Array, *, noise: float
) -> FrequencyResponse:
    s = 2j * np.pi * frequency_hz
    omega = 2 * np.pi * np.append(axis.frequency_hz, axis.hidden_hz)
    zeta, gain = np.append(axis.damping_ratio, 0.02), np.append(axis.gain, axis.hidden_gain)
    H = 1.0 / (axis.mass * (s**2 + axis.drag * s))
    for w, z, g in zip(omega, zeta, gain, strict=True):
        H = H + g / (s**2 + 2 * z * w * s + w**2)
    H = H * s * np.exp(-s * axis.delay)
    relative = np.full(frequency_hz.size, noise)
    for _ in range(int(rng.integers(0, 5))):
        centre = np.exp(rng.uniform(np.log(frequency_hz[0]), np.log(frequency_hz[-1])))
        off = np.log(frequency_hz / centre) / rng.uniform(0.005, 0.08)
        relative *= 1.0 + rng.uniform(2.0, 15.0) * np.exp(-0.5 * off**2)
    gamma2 = 1.0 / (1.0 + AVERAGES * relative**2)
    seen = gamma2 + (1 - gamma2) * np.sqrt(2 * gamma2 / AVERAGES) * rng.normal(size=gamma2.size)
    scatter = rng.normal(size=(2, frequency_hz.size)) / np.sqrt(2.0)
    return FrequencyResponse(
        source=Source(file="survey", sha256=""),
        frequency_hz=frequency_hz,
        values=H * (1.0 + relative * (scatter[0] + 1j * scatter[1])),
        coherence=np.clip(seen, 1e-3, 0.99999),
        averages=AVERAGES,
        resolution_hz=0.0,
        input=Signal.FORCE,
        output=Signal.VELOCITY,
        sensor=Sensor.ENCODER,
        rotary=False,
    )


@dataclass(kw_only=True)
class Tally:
    right: int = 0
    of: int = 0
    found: int = 0
    modes: int = 0
    false: int = 0
    errors: dict[str, list[float]] = field(default_factory=dict)
    held: dict[str, list[bool]] = field(default_factory=dict)

    def note(self, name: str, value: float, sigma: float, true: float) -> None:
        self.errors.setdefault(name, []).append(abs(value / true - 1.0))
        self.held.setdefault(name, []).append(abs(value - true) <= 2.0 * sigma)

    def take(self, axis: Axis, fit: Fitted) -> bool:
        left = list(fit.modes)
        missed = 0
        for f, zeta, gain in zip(axis.frequency_hz, axis.damping_ratio, axis.gain, strict=True):
            near = min(left, key=lambda mode: abs(mode.frequency_hz.value / f - 1.0), default=None)
            off = abs(near.frequency_hz.value / f - 1.0) if near else np.inf
            if near is None or off > max(2.0 * zeta, 0.02):
                missed += 1
                continue
            left.remove(near)
            one = near.frequency_hz, near.damping_ratio, near.measured_gain
            for name, estimate, true in zip(
                ("f", "zeta", "gain"), one, (f, zeta, gain), strict=True
            ):
                if estimate:
                    self.note(name, estimate.value, estimate.sigma, true)
        mass = fit.responses[0].inverse_mass
        self.note("mass", mass.value, mass.sigma, 1.0 / axis.mass)
        self.of += 1
        self.modes += axis.frequency_hz.size
        self.found += axis.frequency_hz.size - missed
        self.false += len(left)
        is_right = not missed and not left
        self.right += is_right
        return is_right


def survey(grid: str, count: int, *, first: int = 0, tells: bool = True) -> Tally:
    """Return what came out on some random axes."""
    tally = Tally()
    for seed in range(first, first + count):
        rng = np.random.default_rng(seed)
        axis = random_axis(rng)
        noise = float(np.exp(rng.uniform(np.log(0.01), np.log(0.1))))
        fit = fit_state([measure(rng, axis, GRIDS[grid], noise=noise)])
        if not tally.take(axis, fit) and tells:
            true = " ".join(f"{f:.1f}" for f in axis.frequency_hz)
            seen = " ".join(f"{mode.frequency_hz.value:.1f}" for mode in fit.modes)
            print(f"{grid} {seed}: noise {noise:.3f}, true {true}, found {seen}")
    return tally


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--grid", choices=(*GRIDS, "both"), default="both")
    asked = parser.parse_args()
    for grid in GRIDS if asked.grid == "both" else (asked.grid,):
        begun = time.perf_counter()
        tally = survey(grid, asked.count, first=asked.first)
        spent = (time.perf_counter() - begun) / asked.count
        print(
            f"{grid}: {tally.right} of {tally.of} axes right, {tally.found} of {tally.modes} modes "
            f"found, {tally.false} false, {spent:.2f} s each"
        )
        for name, errors in tally.errors.items():
            median, most = np.median(errors), np.quantile(errors, 0.95)
            held = np.mean(tally.held[name])
            print(f"  {name}: error {median:.2%}, 95 % {most:.2%}, two sigma hold {held:.1%}")


if __name__ == "__main__":
    main()
