"""The modes in a dwell: frequencies and damping ratios that explain what was recorded.

They are poles of the closed loop. Which ones matter, the prediction tells; where those that modes
have become begin, a scan: a damped vibration hides beside a servo tail from every fit that starts
blind. All oscillating ones are free then, since another mode moves the servo's poles, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, inf, pi

import numpy as np

from mtcommission.identify.damped import fit_damped, weigh
from mtcommission.identify.measurement import Array, FreeMode
from mtcommission.machine.identified import Estimate
from mtcommission.verify.prediction import Rebuilt

FEWEST, MOST = 64, 2000
"""Samples of a dwell."""

SCANNED = np.linspace(0.7, 1.3, 61)
"""Factors on a mode's frequency at which a fit may begin."""

NOTABLE = 0.01
"""Share of the largest amplitude from which on a pole takes part."""

SIGNIFICANT = 4.0
"""Amplitude over its standard error."""

SURE = 0.05
"""Standard error of a frequency, relative, above which the mode counts as not seen."""

NO_VIBRATION = 0.03
"""Share of an amplitude that a fit leaves, beyond the noise, where no free vibration is behind it:
an axis that sticks (empirical)."""

ENDS = (0.8, 1.25)
"""Factors on a frequency between which it is fitted."""

BELOW_NYQUIST = 0.75
"""Share of half the sampling frequency up to which a mode is looked for, scan included."""

RINGS = 0.2
"""Damping ratio in the closed loop up to which a mode rings; one beyond it is part of the tail."""


def find_modes(
    rebuilt: Rebuilt, t: Array, deviation: Array, predicted: Array, noise: float
) -> tuple[FreeMode | None, ...]:
    """Return the vibration that belongs to each mode of the plant; None: not seen.

    ``t``: from the end of the setpoint on.
    """
    none: tuple[FreeMode | None, ...] = tuple(None for _ in rebuilt.plant.modes)
    size = float(np.abs(deviation).max(initial=0.0))
    if t.size < FEWEST or size == 0.0:
        return none
    stride = max(t.size // MOST, 1)
    t, measured, expected = (row[::stride] for row in (t, deviation / size, predicted / size))
    fixed, modes = _poles_that_matter(rebuilt, t, expected, noise / size)
    if not modes:
        return none
    own = {number: complex(rebuilt.poles[0, number]) for number in modes}
    start: dict[int, complex] = {}
    for number, pole in own.items():
        others = [*fixed, *start.values()]
        tried = [factor * pole for factor in SCANNED]
        power = [float(np.sum(weigh(t, measured, [*others, one])[1] ** 2)) for one in tried]
        start[number] = tried[int(np.argmin(power))]
    found = _fit(t, measured, fixed, start, noise=noise / size)
    # What the same fit makes of the prediction, whose poles are known, is its error on such a
    # dwell: poles that were left out, a tail that ends too early.
    known = _fit(t, expected, fixed, own, noise=inf)
    return tuple(
        _with_bias(found[number], known[number], own[number], size)
        if number in found and number in known
        else None
        for number in range(len(none))
    )


def _with_bias(one: FreeMode, known: FreeMode, pole: complex, size: float) -> FreeMode:
    """A mode with the error of the fit itself."""

    def doubted(own: Estimate, seen: Estimate, true: float) -> Estimate:
        return Estimate(value=own.value, sigma=hypot(own.sigma, seen.value - true))

    return FreeMode(
        frequency_hz=doubted(one.frequency_hz, known.frequency_hz, abs(pole) / (2 * pi)),
        damping_ratio=doubted(one.damping_ratio, known.damping_ratio, -pole.real / abs(pole)),
        amplitude=size * one.amplitude,
    )


def _poles_that_matter(
    rebuilt: Rebuilt, t: Array, expected: Array, noise: float
) -> tuple[list[complex], list[int]]:
    """Poles that stay, and numbers of the modes that are fitted, the largest amplitude first."""
    step = float(t[1] - t[0])
    fastest = BELOW_NYQUIST * pi / step
    all_modes = [complex(pole) for pole in rebuilt.poles[0]]
    numbers = [
        k
        for k, pole in enumerate(all_modes)
        if -pole.real < RINGS * abs(pole) and pole.imag < fastest
    ]
    if not numbers:
        return [], []
    damped = [pole for k, pole in enumerate(all_modes) if k not in numbers]
    others = [
        pole
        for pole in (*damped, *rebuilt.servo_poles)
        if pole.imag < fastest and -0.5 / step < pole.real < -1.0 / t[-1]
    ]
    weights, _ = weigh(t, expected, [*(all_modes[k] for k in numbers), *others])
    size = np.hypot(*weights[1:].reshape(-1, 2).T)
    notable = size > NOTABLE * float(size.max())
    fixed = [pole for pole, counts in zip(others, notable[len(numbers) :], strict=True) if counts]
    seen = [
        numbers[place]
        for place in np.argsort(-size[: len(numbers)])
        if notable[place] and 4.0 * size[place] > noise
    ]
    return fixed, seen


def _fit(
    t: Array,
    y: Array,
    fixed: Sequence[complex],
    start: Mapping[int, complex],
    *,
    noise: float,
) -> dict[int, FreeMode]:
    """The modes that stand out, by number; all oscillating poles are free."""
    free = [*start.values(), *(pole for pole in fixed if pole.imag > 0.0)]
    real = [pole for pole in fixed if pole.imag == 0.0]
    fitted = fit_damped(t, y, free, held=real, ends=ENDS)
    left = float(np.std(fitted.rest))
    return {
        number: one
        for number, one, error in zip(start, fitted.modes, fitted.errors, strict=False)
        if left <= max(0.5 * noise, NO_VIBRATION * one.amplitude)
        and one.amplitude >= SIGNIFICANT * error
        and one.frequency_hz.relative <= SURE
        and one.damping_ratio.value <= RINGS
    }
