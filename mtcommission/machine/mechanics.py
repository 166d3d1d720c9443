"""The flexible modes of any machine in one form, whichever way its mechanics are described."""

from __future__ import annotations

from math import pi, sqrt

from mtcommission.machine.machine import FlexibleMode, Machine, Manipulator

EQUAL_POLE_TOLERANCE = 1e-6
"""Relative distance of two poles below which they count as one (empirical: beyond it the
moment equations of the two modes are dependent to half of double precision)."""


def flexible_modes(machine: Machine) -> tuple[FlexibleMode, ...]:
    """Return the flexible modes, all in the form q'' + 2 ζ ω q' + ω² q = F.

    For the manipulator x_b = -q/m_b and φ = r q/J, so the base moves tool and encoder alike
    (+1/m_b) and the tower moves the tool alone (h r/J).

    Parameters
    ----------
    machine
        Any machine.

    Returns
    -------
    tuple of FlexibleMode
        In the order of the plant's states.

    Source: Christiansen, Maurer & Zirn, eq. (1), divided by m_b and J.

    Examples
    --------
    >>> tower = Manipulator(base_mass=450, slider_mass=750, rotary_inertia=40, lever_arm=0.25,
    ...     tcp_height=0.21, base_stiffness=44.41e6, base_damping=8500, rotary_stiffness=8.2e6,
    ...     rotary_damping=1800)
    >>> [round(frequency_hz(mode), 2) for mode in _manipulator_modes(tower)]
    [50.0, 72.06]
    """
    mechanics = machine.mechanics
    return _manipulator_modes(mechanics) if isinstance(mechanics, Manipulator) else mechanics.modes


def _manipulator_modes(mechanics: Manipulator) -> tuple[FlexibleMode, FlexibleMode]:
    m_b, J = mechanics.base_mass, mechanics.rotary_inertia
    k_b, d_b = mechanics.base_stiffness, mechanics.base_damping
    k, d = mechanics.rotary_stiffness, mechanics.rotary_damping
    base = FlexibleMode(
        name="base",
        natural_frequency=sqrt(k_b / m_b),
        damping_ratio=d_b / (2 * sqrt(k_b * m_b)),
        tcp_gain=1 / m_b,
        measured_gain=1 / m_b,
    )
    tower = FlexibleMode(
        name="rotation",
        natural_frequency=sqrt(k / J),
        damping_ratio=d / (2 * sqrt(k * J)),
        tcp_gain=mechanics.tcp_height * mechanics.lever_arm / J,
        measured_gain=0.0,
    )
    return base, tower


def frequency_hz(mode: FlexibleMode) -> float:
    """Return the natural frequency of a mode [Hz]."""
    return mode.natural_frequency / (2 * pi)
