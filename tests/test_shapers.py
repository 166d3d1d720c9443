"""Setpoint filters: their zeros, their setpoints, and shapers in the comparison."""

from __future__ import annotations

from cmath import exp
from math import comb, pi

import numpy as np
import pytest

from mtcommission.controls.kind import SHAPERS
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint, sample_setpoint
from tests.independent_loop import behind, profile_of

F = 40.0


def design(kind: str, damping: float = 0.0) -> SetpointFilter:
    return SetpointFilter(kind=kind, frequency_hz=F, damping_ratio=damping)


FILTERS = [
    SetpointFilter(kind="moving_average", time=0.021),
    SetpointFilter(kind="two_moving_averages", time=0.017, second_time=0.009),
    SetpointFilter(kind="fir", taps=(0.2, -0.1, 0.6, 0.3), spacing=3e-3),
    *(design(kind, 0.03) for kind in ("zvd", "2hump_ei", "marlin_ei")),
]


def vibration(item: SetpointFilter, ratio: float, damping: float = 0.0) -> float:
    """Residual vibration of a mode over that of a single impulse at the end of the sequence."""
    pole = 2 * pi * F * ratio * complex(-damping, (1 - damping**2) ** 0.5)
    delays, shares = item.impulses
    pairs = zip(delays, shares, strict=True)
    return abs(sum(share * exp(pole * (delays[-1] - t)) for t, share in pairs))


@pytest.mark.parametrize("damping", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("kind", ["zv", "zvd", "mzv"])
def test_singer_seering_1990_zeros(kind, damping):
    """If it failed, these would not cancel the mode they are designed for."""
    assert vibration(design(kind, damping), 1.0, damping) < 1e-12
    if kind == "zvd":  # and its slope
        assert vibration(design(kind, damping), 1.001, damping) < 1e-5


@pytest.mark.parametrize(
    ("kind", "width"),
    [("marlin_ei", 0.399), ("marlin_2hump_ei", 0.726), ("marlin_3hump_ei", 0.965)],
)
def test_singhose_humps_tolerate_five_per_cent_over_the_published_width(kind, width):
    """If it failed, the robust shapers would be robust in name only."""
    item = SetpointFilter(kind=kind, frequency_hz=50.0)  # 10 ms apart: on Marlin's grid as it is
    ratios = np.linspace(1.0, 1.6, 6001)
    curve = np.array([vibration(item, 50.0 / F * r) for r in ratios])
    out = int(np.argmax(curve > 0.05 * (1 + 1e-6)))
    assert curve[:out].max() == pytest.approx(0.05, rel=1e-4)
    assert 2 * (ratios[out] - 1) == pytest.approx(width, abs=0.005)


@pytest.mark.parametrize("damping", [0.02, 0.05, 0.1, 0.15])
@pytest.mark.parametrize(
    ("kind", "zeros", "low", "high"),
    [
        ("ei", (0.848, 1.152), 0.79, 1.20),
        ("2hump_ei", (0.674, 1.0, 1.34), 0.63, 1.37),
        ("3hump_ei", (0.543, 0.818, 1.179, 1.49), 0.51, 1.48),
    ],
)
def test_klipper_2025_ei_family_meets_its_damped_conditions(kind, zeros, low, high, damping):
    """If it failed, a figure of the fit would be wrong: five per cent at the top of each hump, as
    good as nothing between them, over the band of the published insensitivity."""
    item = design(kind, damping)
    ratios = np.linspace(0.4, 1.7, 2601)
    curve = np.array([vibration(item, r, damping) for r in ratios])
    feet = [i for i in range(1, 2600) if curve[i - 1] > curve[i] < curve[i + 1]]
    tops = [i for i in range(1, 2600) if curve[i - 1] < curve[i] > curve[i + 1]]
    humps = [i for i in tops if feet[0] < i < feet[-1]]
    assert len(feet) == len(zeros)
    assert len(humps) == len(zeros) - 1
    assert curve[humps] == pytest.approx(0.05, abs=0.0065)
    assert curve[feet] == pytest.approx(0.0, abs=0.0135)
    assert ratios[feet] == pytest.approx(zeros, abs=0.02 + damping)
    assert curve[(ratios >= low) & (ratios <= high)].max() < 0.057


@pytest.mark.parametrize("kind", [kind for kind in SHAPERS if kind.startswith("marlin_")])
def test_marlin_s_copies_lie_on_its_samples_and_fade_by_half_periods(kind):
    """If it failed, the firmware would shape otherwise than was simulated (shaping.cpp)."""
    zeta = 0.05
    item, plain = design(kind, zeta), np.array(design(kind).impulses.shares)
    n, damped = np.arange(plain.size), 1.0 / (F * (1.0 - zeta**2) ** 0.5)
    apart = (0.375 if "mzv" in kind else 0.5) * damped
    assert item.impulses.delays == pytest.approx(1e-3 * int(1e3 * apart + 0.5) * n, abs=1e-15)
    faded = plain * np.exp(-pi * F * zeta * damped * n)
    assert item.impulses.shares == pytest.approx(faded / faded.sum(), abs=1e-12)
    if kind.startswith("marlin_zv"):
        assert plain == pytest.approx([comb(n.size - 1, k) / 2.0 ** (n.size - 1) for k in n])
    if kind == "marlin_mzv":
        assert plain == pytest.approx(design("mzv").impulses.shares)


@pytest.mark.parametrize("item", FILTERS, ids=lambda item: item.kind)
@pytest.mark.parametrize("move", [VelocityStep(velocity_step=0.1), Positioning(distance=0.03)])
def test_filtered_setpoint_is_that_of_the_second_program(move, item):
    """If it failed, limits would be judged on a motion that no control produces."""
    limits = MotionLimits(acceleration=2.0, jerk=150.0, setpoint_filter=item)
    ours = plan_setpoint(move, limits)
    other = behind(profile_of(move, 2.0, 150.0), item)
    assert ours.duration == pytest.approx(other.end, rel=1e-9)
    t = np.linspace(-0.01, ours.duration + 0.01, 353)
    expected = np.array([other.at(time) for time in t])
    found = sample_setpoint(ours, t)
    scale = np.abs(expected).max(axis=0)
    assert found[:, :3] == pytest.approx(expected[:, :3], abs=1e-9 * scale.max())
