"""Traces as a machine would record them: our own simulator, a little spoilt."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.simulate import drive_loop, find_friction
from mtcommission.machine.machine import Corner, vary
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_setpoint, sample_setpoint
from mtcommission.verify.prediction import Rebuilt

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spoilt:
    """How machine and recorder differ from the record.

    ``lag``: what was measured is recorded so much late; ``behind``: the setpoint is [s].
    """

    frequency: float = 1.0
    damping: float = 1.0
    payload: float = 0.0
    coulomb: float = 0.0
    viscous: float = 0.0
    noise: float = 0.0
    setpoint_grain: float = 1e-9
    grain: float = 1e-9
    step: float = 125e-6
    lag: float = 0.0
    behind: float = 0.0
    ignores_jerk: bool = False
    slower: float = 1.0
    offset: float = 0.0
    before: float = 0.2
    dwell: float = 0.8
    repeats: int = 1
    seed: int = 0


def record_moves(
    rebuilt: Rebuilt, limits: MotionLimits, how: Spoilt, move: Move | None = None
) -> dict[str, Array]:
    """Columns of a trace in SI: repeated moves from rest, each with its dwell."""
    machine = rebuilt.machine
    corner = Corner(payload=how.payload, frequency_factor=how.frequency, damping_factor=how.damping)
    plant = build_plant(vary(machine, corner))
    loop = build_loop(plant, rebuilt.controller, model=rebuilt.plant)
    limits = replace(limits, acceleration=how.slower * limits.acceleration)
    if how.ignores_jerk:
        limits = replace(limits, jerk=without_jerk_limit(machine, limits.acceleration).jerk)
    setpoint = plan_setpoint(move or machine.moves[0], limits)
    T_p, T_v = rebuilt.controller.position_cycle, rebuilt.controller.velocity_cycle
    length = how.before + setpoint.duration + how.dwell
    count = int(length / T_p)
    t_p = T_p * np.arange(count)
    begin = T_p * round(how.before / T_p)
    friction = find_friction(plant, coulomb=how.coulomb, viscous=how.viscous, step=T_v)
    drive = machine.drive
    out = drive_loop(
        loop,
        sample_setpoint(setpoint, t_p - begin),
        force_limit=drive.max_force - abs(drive.static_load),
        friction=friction,
    )
    t_v = T_v * np.arange(len(out))
    rng = np.random.default_rng(how.seed)
    pieces, x = [], 0.0
    for _ in range(how.repeats):
        t = np.arange(0.0, t_v[-1] - how.lag, how.step)
        ref = sample_setpoint(setpoint, t - begin - how.behind)[:, 0]
        tool, encoder, force = (
            np.interp(t - how.lag, t_v, out[:, k]) for k in (0, 1, 3 + plant.force)
        )
        pieces.append(np.column_stack([ref + x, encoder + x, tool + x, force]))
        x += ref[-1]
    rows = np.vstack(pieces)

    def written(values: Array, grain: float, noise: float) -> Array:
        noisy = values + rng.normal(0.0, noise, values.size) if noise else values
        return grain * np.rint(noisy / grain)

    return {
        "t": how.step * np.arange(len(rows)),
        "x_ref": written(rows[:, 0], how.setpoint_grain, 0.0),
        "encoder": written(rows[:, 1], how.grain, 0.2 * how.noise),
        "tcp": written(rows[:, 2] + how.offset, how.grain, how.noise),
        "force": np.round(rows[:, 3] + rng.normal(0.0, 1e-3 * drive.max_force, len(rows)), 3),
    }


UNITS = {"t": "s", "x_ref": "m", "encoder": "m", "tcp": "m", "force": "N"}
ROTARY = {"t": "s", "x_ref": "rad", "encoder": "rad", "tcp": "rad", "force": "N m"}


def write_csv(path: Path, columns: dict[str, Array], *, units: dict[str, str] = UNITS) -> Path:
    """Write columns as a table."""
    heads = ",".join(f"{name} [{units[name]}]" for name in columns)
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, delimiter=",", header=heads, comments="", fmt="%.12g")
    return path
