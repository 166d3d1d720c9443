"""Input shapers: a few scaled and delayed copies of a setpoint whose vibrations cancel.

Klipper: klippy/extras/shaper_defs.py at commit 84104bbb (7 August 2026). Its EI, 2HUMP_EI and
3HUMP_EI are those of 16 September 2025 (commit 5da026a3), fitted to the damped conditions as
polynomials of the damping ratio; 3HUMP_EI left a comma out until 31 March 2026 (0d1445a7), so
older ones leave more vibration than is computed here.

Marlin: Marlin/src/module/ft_motion/shaping.cpp at commit 195278e4 (2025). Its EI family is the
classical one, as Klipper's was before: shares without damping, each reduced by what the vibration
has lost until then.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import exp, pi, sqrt
from typing import NamedTuple

TOLERANCE = 0.05
"""Vibration that the EI shapers leave at the design frequency [-] (the usual 5 %)."""


class Impulses(NamedTuple):
    """A sum of delayed copies.

    Parameters
    ----------
    delays
        The first is 0 [s].
    shares
        Their sum is 1 [-].
    """

    delays: tuple[float, ...] = (0.0,)
    shares: tuple[float, ...] = (1.0,)


@lru_cache(maxsize=4096)
def shape(kind: str, *, frequency_hz: float, damping_ratio: float) -> Impulses:
    """Return the impulses of a shaper.

    Parameters
    ----------
    kind
        One of ``SHAPERS``.
    frequency_hz, damping_ratio
        Natural frequency [Hz] and damping ratio [-] of the mode that shall stay at rest.

    Source: Singer & Seering 1990 (ZV, ZVD and more derivatives); Singhose, Seering & Singer 1994
    (EI) and 1997 (two and three humps); MZV, the correction for damping and the EI family with
    damping as in the sources above.

    Examples
    --------
    >>> shape("zvd", frequency_hz=50.0, damping_ratio=0.0)
    Impulses(delays=(0.0, 0.01, 0.02), shares=(0.25, 0.5, 0.25))
    """
    if kind == "ei":
        periods, weights = _ei(damping_ratio, TOLERANCE)
    elif kind in HUMPS:
        times, sizes = HUMPS[kind]
        periods, weights = _each(times, damping_ratio), _each(sizes, damping_ratio)
    else:
        periods, weights = _even(*EVEN[kind], damping_ratio)
    total = sum(weights)
    return Impulses(
        delays=tuple(period / frequency_hz for period in periods),
        shares=tuple(weight / total for weight in weights),
    )


def _even(
    spacing: float, shares: tuple[float, ...], damping_ratio: float
) -> tuple[list[float], list[float]]:
    """Evenly spaced copies; each is reduced by what the vibration of the one before has lost."""
    root = sqrt(1.0 - damping_ratio**2)
    decay = exp(-2.0 * pi * damping_ratio / root * spacing)
    weights = [share * decay**i for i, share in enumerate(shares)]
    return [i * spacing / root for i in range(len(shares))], weights


def _ei(zeta: float, V: float) -> tuple[list[float], list[float]]:
    """Three copies over one damped period, fitted to V at the frequency and 0 on both sides."""
    first = _series((0.24968 + 0.24961 * V, 0.80008 + 1.23328 * V, 0.49599 + 3.17316 * V), zeta)
    last = _series((0.25149 + 0.21474 * V, -0.83249 + 1.41498 * V, 0.85181 - 4.90094 * V), zeta)
    middle = (
        0.4999,
        0.46159 * V + 8.57843 * V**2,
        4.26169 * V - 108.644 * V**2,
        1.75601 * V + 336.989 * V**2,
    )
    period = 1.0 / sqrt(1.0 - zeta**2)
    return [0.0, _series(middle, zeta) * period, period], [first, 1.0 - first - last, last]


def _series(coefficients: tuple[float, ...], zeta: float) -> float:
    return sum(one * zeta**i for i, one in enumerate(coefficients))


def _each(rows: tuple[tuple[float, ...], ...], zeta: float) -> list[float]:
    return [_series(row, zeta) for row in rows]


def _two_humps() -> tuple[float, ...]:
    V = TOLERANCE
    X = (V**2 * (sqrt(1.0 - V**2) + 1.0)) ** (1.0 / 3.0)
    outer = (3.0 * X**2 + 2.0 * X + 3.0 * V**2) / (16.0 * X)
    return outer, 0.5 - outer, 0.5 - outer, outer


def _three_humps() -> tuple[float, ...]:
    V = TOLERANCE
    outer = (1.0 + 3.0 * V + 2.0 * sqrt(2.0 * V * (1.0 + V))) / 16.0
    inner = 0.25 * (1.0 - V)
    return outer, inner, 1.0 - 2.0 * (outer + inner), inner, outer


_EDGE = 1.0 - 1.0 / sqrt(2.0)
_V = TOLERANCE

EVEN: Mapping[str, tuple[float, tuple[float, ...]]] = {
    "zv": (0.5, (0.5, 0.5)),
    "mzv": (0.375, (_EDGE, 1.0 - 2.0 * _EDGE, _EDGE)),
    "zvd": (0.5, (0.25, 0.5, 0.25)),
    "zvdd": (0.5, (0.125, 0.375, 0.375, 0.125)),
    "zvddd": (0.5, (0.0625, 0.25, 0.375, 0.25, 0.0625)),
    "ei_classic": (0.5, (0.25 * (1.0 + _V), 0.5 * (1.0 - _V), 0.25 * (1.0 + _V))),
    "2hump_ei_classic": (0.5, _two_humps()),
    "3hump_ei_classic": (0.5, _three_humps()),
}
"""Spacing of the impulses in periods of the damped vibration, and their shares without damping."""

HUMPS: Mapping[str, tuple[tuple[tuple[float, ...], ...], tuple[tuple[float, ...], ...]]] = {
    "2hump_ei": (
        (
            (0.0,),
            (0.49890, 0.16270, -0.54262, 6.16180),
            (0.99748, 0.18382, -1.58270, 8.17120),
            (1.49920, -0.09297, -0.28338, 1.85710),
        ),
        (
            (0.16054, 0.76699, 2.26560, -1.22750),
            (0.33911, 0.45081, -2.58080, 1.73650),
            (0.34089, -0.61533, -0.68765, 0.42261),
            (0.15997, -0.60246, 1.00280, -0.93145),
        ),
    ),
    "3hump_ei": (
        (
            (0.0,),
            (0.49974, 0.23834, 0.44559, 12.4720),
            (0.99849, 0.29808, -2.36460, 23.3990),
            (1.49870, 0.10306, -2.01390, 17.0320),
            (1.99960, -0.28231, 0.61536, 5.40450),
        ),
        (
            (0.11275, 0.76632, 3.29160, -1.44380),
            (0.23698, 0.61164, -2.57850, 4.85220),
            (0.30008, -0.19062, -2.14560, 0.13744),
            (0.23775, -0.73297, 0.46885, -2.08650),
            (0.11244, -0.45439, 0.96382, -1.46000),
        ),
    ),
}
"""Times in periods of the undamped vibration and shares, by rising power of the damping ratio."""
