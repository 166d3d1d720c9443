"""The step of velocity at a corner that an axis which follows its setpoint may take.

A control that rounds no corner steps the velocity of an axis by up to dv there. That shakes each
mode like a blow: after the shaper's last impulse T_n there remains at most

    Σ |c_i| dv / ω_di  |Σ_k A_k e^(p_i (T_n - T_k))|

in the worst corner of frequency and damping. The path while the shaper runs, and whether the motor
can jump so far, are not in it.

Source: the answer of q'' + 2 ζ ω q' + ω² q = -dv δ(t), by superposition.
"""

from __future__ import annotations

from cmath import exp
from math import inf

from mtcommission.machine.machine import Machine, corners, vary
from mtcommission.machine.setpoint_filter import SetpointFilter


def find_corner_velocity(machine: Machine, item: SetpointFilter | None) -> float:
    """Return the largest step of velocity whose vibration by itself stays within the band [m/s].

    inf where nothing vibrates. The machine's motor follows its setpoint; the share of the band that
    is reserved is kept. ``item``: the setpoint filter; None: none.
    """
    worst = max(_vibration(vary(machine, corner), item) for corner in corners(machine))
    needs = machine.requirements
    return needs.reserve.band * needs.tcp_deviation / worst if worst else inf


def _vibration(machine: Machine, item: SetpointFilter | None) -> float:
    """What a step of 1 m/s leaves behind the filter [m per m/s]."""
    total = 0.0
    for mode in machine.mechanics.modes:
        omega, zeta = mode.natural_frequency, mode.damping_ratio
        damped = omega * (1.0 - zeta**2) ** 0.5
        pole = complex(-zeta * omega, damped)
        total += abs(mode.tcp_gain) / damped * abs(_behind(item, pole))
    return total


def _behind(item: SetpointFilter | None, pole: complex) -> complex:
    """A vibration at the end of the filter, by that of a blow there [-]."""
    if item is None:
        return 1.0
    delays, shares = item.impulses
    left = sum(
        share * exp(pole * (delays[-1] - delay))
        for delay, share in zip(delays, shares, strict=True)
    )
    for time in item.averages:
        left *= (exp(pole * time) - 1.0) / (pole * time)
    return left
