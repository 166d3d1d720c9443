"""Published and closed-form numbers for optimal controls, each with its source."""

from __future__ import annotations

from math import exp, log, sqrt

from mtcommission.machine.readers import SignalValue

PAPER_SWITCHING_TIMES = (0.009337, 0.009668, 0.036552, 0.037653, 0.041942)
PAPER_T_F = 0.043505
"""Christiansen, Maurer & Zirn, eq. (12) [s], F_max = 2 kN."""

PAPER_TIME_TOLERANCE = 6.3e-5
"""The printed times, put into eq. (1) exactly, end with v_s = 0.100028 m/s, F = 3.5 N: right to
3-4 decimals, as the paper itself says of its discretisation [s]."""

PAPER_WEIGHTS = tuple(
    SignalValue(name=state, value=value)
    for state, value in [
        ("x_b", 1.8858e15),
        ("phi", 1.0961e15),
        ("v_b", 8.6070e10),
        ("v_phi", 2.8505e10),
    ]
)
"""Christiansen, Maurer & Zirn, eq. (17)."""


def lag_only_step(span: float, force_lag: float) -> tuple[float, float]:
    """Return t_f and the remaining time of the switch of a rigid axis with a force lag.

    From ∫ sign = span and ∫ sign e^{-τ/T} = 0 with one switch at τ: t_f = span + 2 τ and
    2 x = 1 + E x² with x = e^{-τ/T}, E = e^{-span/T}; the root below 1 is 1 / (1 + sqrt(1 - E)).
    """
    E = exp(-span / force_lag)
    switch = force_lag * log(1.0 + sqrt(1.0 - E))
    return span + 2.0 * switch, switch
