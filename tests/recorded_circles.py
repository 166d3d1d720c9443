"""Circles as a machine would record them: by a formula of our own, or by stepping its loops."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spoilt:
    """A circle test; lengths in m, times in s."""

    radius: float = 50e-3
    feed: float = 0.1
    turns: float = 2.3
    clockwise: bool = False
    step: float = 1e-3
    delays: tuple[float, float] = (9.3786e-3, 9.3947e-3)
    gains: tuple[float, float] = (1.0, 1.0)
    squareness: float = 0.0
    peaks: tuple[float, float] = (7.2e-6, 12.5e-6)
    decay: float = 20e-3  # time from a reversal to its peak
    centre: tuple[float, float] = (0.0, 0.0)
    noise: float = 0.05e-6
    seed: int = 0


def draw(how: Spoilt) -> dict[str, Array]:
    """Columns in SI: time, setpoint, actual positions.

    A reversal adds p (t/T) exp(1 - t/T) outwards, whose largest value is p at t = T.
    """
    omega = how.feed / how.radius * (-1.0 if how.clockwise else 1.0)
    t = np.arange(0.0, 2.0 * np.pi * how.turns / abs(omega), how.step)
    phase = 0.3 + omega * t
    rng = np.random.default_rng(how.seed)
    actual = []
    for k in (0, 1):
        own = 0.3 + omega * (t - how.delays[k]) - 0.5 * np.pi * k
        late = np.mod(np.sign(omega) * own, np.pi) / abs(omega) / how.decay
        bump = how.peaks[k] * late * np.exp(1.0 - late) * np.sign(np.cos(own))
        actual.append(how.gains[k] * how.radius * np.cos(own) + bump)
    actual[0] = actual[0] + how.squareness * actual[1]
    x, y = (
        one + c + rng.normal(0.0, how.noise, t.size)
        for one, c in zip(actual, how.centre, strict=True)
    )
    return {
        "t": t,
        "x_ref": how.radius * np.cos(phase) + how.centre[0],
        "y_ref": how.radius * np.sin(phase) + how.centre[1],
        "x": x,
        "y": y,
    }


def write_csv(path: Path, columns: dict[str, Array]) -> Path:
    """Write positions as mm."""
    units = {"t": "s"}
    heads = ",".join(f"{name} [{units.get(name, 'mm')}]" for name in columns)
    table = np.column_stack(
        [values if name == "t" else 1e3 * values for name, values in columns.items()]
    )
    np.savetxt(path, table, delimiter=",", header=heads, comments="", fmt="%.12g")
    return path


def write_ballbar(path: Path, columns: dict[str, Array], *, language: str = "en") -> Path:
    """Write a ballbar's angle and radius, in German with decimal commas and semicolons."""
    x, y = columns["x"], columns["y"]
    angle = np.degrees(np.unwrap(np.arctan2(y, x)))
    table = np.column_stack([columns["t"], angle, 1e3 * np.hypot(x, y)])
    if language == "en":
        np.savetxt(path, table, delimiter=",", fmt="%.12g", comments="",
                   header="t [s],angle [deg],radius [mm]")  # fmt: skip
        return path
    lines = [";".join(f"{value:.9f}".replace(".", ",") for value in row) for row in table]
    path.write_text("\n".join(["Zeit [s];Winkel [°];Radius [mm]", *lines]) + "\n", "utf-8")
    return path
