"""Recommended limits in every corner, by a program that shares nothing with the package.

``python -m benchmarks.second_program`` does so for every shipped profile and random machines.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import ceil
from pathlib import Path

import numpy as np
import pytest

from benchmarks.population import random_machine
from mtcommission.controls.kind import PositionLoop
from mtcommission.limits.choose import choose_limits
from mtcommission.machine.machine import Machine, vary
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import read_profile
from mtcommission.setpoint.smaller_moves import resize, size_of
from mtcommission.study.loops import settle_on_loop
from tests.independent_loop import behind, judge, profile_of, quiet_copy, rms_force, run

PROFILES = sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))

TAIL = 0.4
"""Free motion simulated after the end [s]."""

EXACTLY = 1e-6
"""Room for rounding in the comparison with a requirement that is just kept."""


def broken_requirements(machine: Machine, shares: Sequence[float] = (1.0,)) -> list[str] | None:
    """What the second program finds broken; None where the product promises nothing.

    ``shares``: sizes of the moves, by the listed one [-].
    """
    plant, settled = build_plant(machine), settle_on_loop(machine)
    tuned = settled.tuned
    best = settled.choice or choose_limits(machine, tuned)
    if not best.meets_requirements:
        return None
    limits = best.limits
    needs, drive, gains = machine.requirements, machine.drive, tuned.controller
    broken = []
    for (number, listed), share in product(enumerate(machine.moves, start=1), shares):
        move = resize(listed, share * size_of(listed))
        profile = behind(
            profile_of(move, limits.acceleration, limits.jerk),
            limits.setpoint_filter or machine.control.setpoint_filter,
        )
        samples = ceil((profile.end + gains.reference_delay + TAIL) / gains.velocity_cycle)
        for corner in tuned.corners:
            motion = run(
                vary(machine, corner),
                gains,
                profile,
                nominal=machine,
                samples=samples,
                resolution=drive.encoder_resolution,
            )
            found = judge(
                motion,
                profile,
                tau=gains.reference_delay,
                band=needs.tcp_deviation,
            )
            rms = rms_force(motion, profile, dwell=move.dwell, load=drive.static_load)
            peaks = [
                (peak.name, float(np.max(np.abs(motion.states @ plant.row(peak.name)))), peak.value)
                for peak in needs.peaks
            ]
            for name, value, limit in (
                ("residual", found.residual, needs.tcp_deviation),
                ("settling", found.settling_time if share == 1.0 else 0.0, needs.max_settling_time),
                ("force", float(np.max(np.abs(motion.force))), drive.motion_force),
                ("RMS force", rms, drive.continuous_force),
                *peaks,
            ):
                if value > limit * (1.0 + EXACTLY):
                    place = f"move {number} x {share:.3g}, {corner}"
                    broken.append(f"{place}: {name} {value:.6g} > {limit:.6g}")
    return broken


@pytest.mark.parametrize("name", ["honing-z", "milling-manipulator"])
def test_shipped_profile(name):
    """If it failed, a sheet would promise what an outsider's simulation refutes."""
    machine = read_profile(next(path for path in PROFILES if path.stem == name))
    assert broken_requirements(machine) == []


@pytest.mark.parametrize(("seed", "position_loop"), list(zip([2, 5, 8], PositionLoop, strict=True)))
def test_random_machine(seed, position_loop):
    """If it failed, the promise would hold on the shipped examples, or for one loop, alone."""
    machine = quiet_copy(random_machine(seed), position_loop=position_loop)
    assert broken_requirements(machine) == []
