"""One recorded move beside what the loop of the record makes of its setpoint; modes in the dwell.

Signals and predictions are on the same clock, and go through the same smoothing. The modes are
poles of the closed loop. Which ones matter, the prediction tells, and there a fit begins: a damped
vibration hides beside a servo tail from every fit that starts blind. All oscillating ones are free,
since another mode moves the servo's poles, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot, inf, log, pi, sqrt

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from mtcommission.machine.identified import Estimate
from mtcommission.measured.measurement import Array, Channel
from mtcommission.measured.regression import FreeMode, fit_damped, regress, weigh
from mtcommission.verify.prediction import ENCODER, FORCE, TOOL, Prediction, Rebuilt, predict
from mtcommission.verify.setpoint import Motion
from mtcommission.verify.trace import Role, Trace, resolution

REST = 0.1
"""Of the rest before a move, what offset and noise are taken from [s]."""

FEWEST = 8
"""Samples without which nothing is said."""

SMOOTHED = 0.2
"""Window of the smoothing by the period of the fastest mode: it takes 0.1 % of that mode."""

LEAST_SIGMAS = 2.0

CORRELATED = 10.0
"""Samples of what a shift leaves that are worth one (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Beside:
    """One signal of one move."""

    role: Role  # tool, encoder (also from a following error), acceleration of the tool, or force
    t: Array  # times of the samples, in the trace's time [s]
    measured: Array  # position relative to the rest before it, or force, shape (n,) [m, N]
    deviation: Array  # of a position, from the delayed setpoint, smoothed; else the signal itself
    predicted: Array  # the same in every corner, shape (n_corners, n)
    raw: Array  # ``deviation`` before smoothing
    width: int  # samples that were smoothed over
    noise: float  # what noise and resolution may add to a largest value of ``deviation``
    slack: float  # what they may hide of it
    grain: float  # resolution of what was recorded

    @property
    def is_position(self) -> bool:
        """Whether it is the position of tool or encoder."""
        return self.role in (Role.TOOL, Role.ENCODER)

    @property
    def step(self) -> float:
        """Of the clock [s]."""
        return float(self.t[1] - self.t[0])

    def after(self, instant: float) -> NDArray[np.bool_]:
        """Return which samples are at or after an instant."""
        return self.t >= instant - 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recorded:
    """One move of a trace, beside what the record says of it."""

    trace: Trace
    motion: Motion
    rest: float  # when the tool should rest, or coast [s]
    prediction: Prediction  # what the loop makes of the recorded setpoint
    shift: float  # by which the position comes later than predicted [s]
    shift_error: float  # two standard errors of it; inf: not known [s]
    applied_shift: float  # ``shift``, or 0 where columns may not be recorded as far apart [s]
    beside: tuple[Beside, ...]
    modes: tuple[FreeMode | None, ...]  # vibration in the dwell of each mode; None: not seen

    @property
    def number(self) -> int:
        """Which of the record's moves it is, from 1; 0 for none."""
        return self.motion.number

    def find(self, role: Role) -> Beside | None:
        """Return one signal; None if it was not recorded."""
        return next((one for one in self.beside if one.role is role), None)


def lay_out(rebuilt: Rebuilt, trace: Trace, motion: Motion) -> Recorded:
    """Return a recorded move beside its prediction."""
    prediction = predict(rebuilt, motion)
    beside = tuple(_lay_beside(rebuilt, trace, motion, prediction, shift=0.0))
    shift, error = 0.0, inf
    if first := next((one for one in beside if one.is_position), None):
        shift, error = _find_shift(rebuilt, motion, first)
    applied = shift if abs(shift) <= allowed_shift(rebuilt, trace) else 0.0
    if applied:
        beside = tuple(_lay_beside(rebuilt, trace, motion, prediction, shift=applied))
    rest = motion.end + rebuilt.controller.reference_delay + applied
    modes: tuple[FreeMode | None, ...] = tuple(None for _ in rebuilt.plant.modes)
    for one in beside:
        if one.role is Role.FORCE or motion.is_cut or any(modes):
            continue
        after = one.after(rest)
        modes = find_modes(
            rebuilt,
            one.t[after] - rest,
            one.deviation[after],
            one.predicted[0][after],
            noise=one.noise,
            grain=one.grain,
        )
        if one.role is Role.ACCELERATION:
            modes = tuple(mode and _as_position(mode) for mode in modes)
    return Recorded(
        trace=trace,
        motion=motion,
        rest=rest,
        prediction=prediction,
        shift=shift,
        shift_error=2.0 * error,
        applied_shift=applied,
        beside=beside,
        modes=modes,
    )


def _as_position(mode: FreeMode) -> FreeMode:
    return replace(mode, amplitude=mode.amplitude / (2.0 * pi * mode.frequency_hz.value) ** 2)


def unexplained(recorded: Iterable[Recorded], rebuilt: Rebuilt | None = None) -> float | None:
    """Return the share of the deviation, by RMS, that a machine leaves; None: no position.

    ``rebuilt``: the machine, if it is another than the one that the moves lie beside.
    """
    missed = total = 0.0
    for one in recorded:
        other = predict(rebuilt, one.motion) if rebuilt else None
        for signal in one.beside:
            if not signal.is_position:
                continue
            expected = signal.predicted[0]
            if rebuilt and other:
                t = signal.t - one.applied_shift
                late = one.motion.sample(t - rebuilt.controller.reference_delay)[:, 0]
                column = TOOL if signal.role is Role.TOOL else ENCODER
                expected = _smoothed(other.at(t, column)[0] - late, signal.width)
            moving = signal.after(one.motion.begin)
            missed += float(np.sum((signal.deviation - expected)[moving] ** 2))
            total += float(np.sum(signal.deviation[moving] ** 2))
    return sqrt(missed / total) if total > 0.0 else None


def allowed_shift(rebuilt: Rebuilt, trace: Trace) -> float:
    """Return by how much columns may be recorded apart from each other [s]."""
    return rebuilt.controller.position_cycle + trace.setpoint.step


def _lay_beside(
    rebuilt: Rebuilt, trace: Trace, motion: Motion, prediction: Prediction, *, shift: float
) -> Iterator[Beside]:
    for role in (Role.TOOL, Role.ENCODER, Role.FOLLOWING_ERROR, Role.ACCELERATION, Role.FORCE):
        channel = trace.channels.get(role)
        if channel is None or (role is Role.FOLLOWING_ERROR and Role.ENCODER in trace.channels):
            continue
        t, values = channel.between(motion.begin - REST, motion.until)
        if t.size >= 4 * FEWEST:
            yield _lay(rebuilt, role, channel, motion, prediction, t, values, shift)


def _lay(
    rebuilt: Rebuilt,
    role: Role,
    channel: Channel,
    motion: Motion,
    prediction: Prediction,
    t: Array,
    values: Array,
    shift: float,
) -> Beside:
    step = channel.step
    is_force, is_position = role is Role.FORCE, role not in (Role.FORCE, Role.ACCELERATION)
    late = motion.sample(t - rebuilt.controller.reference_delay - shift)[:, 0]
    column = {Role.FORCE: FORCE, Role.TOOL: TOOL, Role.ACCELERATION: TOOL}.get(role, ENCODER)
    predicted, deviation = prediction.at(t - shift, column), values
    if is_position:
        predicted = predicted - late
        is_error = role is Role.FOLLOWING_ERROR
        deviation = -values if is_error else values - motion.start - late
    elif not is_force:
        predicted = np.gradient(np.gradient(predicted, step, axis=1), step, axis=1)
    before = t < motion.begin - step
    if not is_force and before.sum() >= FEWEST:
        deviation = deviation - float(np.mean(deviation[before]))
    width = 1 if is_force else _width(rebuilt, step)
    smooth = _smoothed(deviation, width)
    sigma, grain = _sigma(deviation, smooth, before, width), resolution(values)
    sigmas = max(sqrt(2.0 * log(max(t.size / width, 2.0))), LEAST_SIGMAS)
    return Beside(
        role=Role.ENCODER if role is Role.FOLLOWING_ERROR else role,
        t=t,
        measured=deviation + late if is_position else deviation,
        deviation=smooth,
        predicted=_smoothed(predicted, width),
        raw=deviation,
        width=width,
        noise=sigmas * sigma + 0.5 * grain,
        slack=LEAST_SIGMAS * sigma + 0.5 * grain,
        grain=grain,
    )


def _width(rebuilt: Rebuilt, step: float) -> int:
    """Samples that are smoothed over; 1 for none."""
    fastest = max(mode.frequency_hz for mode in rebuilt.plant.modes)
    width = int(SMOOTHED / fastest / step) | 1
    return width if width >= 5 else 1


def _parabola(width: int) -> Array:
    """What takes samples to the parabola through them by least squares, shape (width, width)."""
    powers = np.vander(np.linspace(-1.0, 1.0, width), 3)
    return np.asarray(powers @ np.linalg.pinv(powers))


def _smoothed(values: Array, width: int) -> Array:
    """Each sample on the parabola through the window around it, or at an end the outermost one.

    Source: A. Savitzky, M. J. E. Golay, Anal. Chem. 36 (1964) 1627-1639.
    """
    if width == 1 or values.shape[-1] <= width:
        return values
    onto, half = _parabola(width), width // 2
    smooth = np.empty_like(values)
    smooth[..., half:-half] = sliding_window_view(values, width, axis=-1) @ onto[half]
    smooth[..., :half] = values[..., :width] @ onto[:half].T
    smooth[..., -half:] = values[..., -width:] @ onto[-half:].T
    return smooth


def _sigma(values: Array, smooth: Array, before: NDArray[np.bool_], width: int) -> float:
    """Standard deviation of what is left of the noise."""
    second = np.abs(np.diff(values, n=2))
    scatter = 1.4826 * float(np.median(second)) / sqrt(6.0)
    if width > 1:
        scatter *= sqrt(float(np.sum(_parabola(width)[width // 2] ** 2)))
    at_rest = smooth[before]
    rest = float(np.std(at_rest)) if at_rest.size >= FEWEST else 0.0
    return max(rest, scatter if rest == 0.0 else min(scatter, 2.0 * rest))


def _find_shift(rebuilt: Rebuilt, motion: Motion, beside: Beside) -> tuple[float, float]:
    """By how much a position comes later than predicted, and the standard error [s].

    Least squares of measured less predicted position over the setpoint's velocity; a second
    column takes what follows the acceleration (mass, stiffness).
    """
    tau = rebuilt.controller.reference_delay
    moving = (beside.t >= motion.begin + tau) & (beside.t <= motion.end + tau)
    rows = motion.sample(beside.t[moving] - tau)[:, 1:3]
    if rows.shape[0] < FEWEST or not np.any(rows[:, 0]):
        return 0.0, inf
    found = regress(rows, (beside.raw - beside.predicted[0])[moving], correlated=CORRELATED)
    return -float(found.values[0]), float(found.sigma[0])


FEWEST_TO_FIT, MOST_TO_FIT = 64, 2000
"""Samples of a dwell."""

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
"""Share of half the sampling frequency up to which a mode is looked for."""

RINGS = 0.2
"""Damping ratio in the closed loop up to which a mode rings; one beyond it is part of the tail."""


def find_modes(
    rebuilt: Rebuilt, t: Array, deviation: Array, predicted: Array, *, noise: float, grain: float
) -> tuple[FreeMode | None, ...]:
    """Return the vibration that belongs to each mode of the plant; None: not seen.

    ``t``: from the end of the setpoint on.
    """
    none: tuple[FreeMode | None, ...] = tuple(None for _ in rebuilt.plant.modes)
    size = float(np.abs(deviation).max(initial=0.0))
    if t.size < FEWEST_TO_FIT or size == 0.0:
        return none
    stride = max(t.size // MOST_TO_FIT, 1)
    t, measured, expected = (row[::stride] for row in (t, deviation / size, predicted / size))
    fixed, modes = _poles_that_matter(rebuilt, t, expected, noise / size)
    if not modes:
        return none
    own = {number: complex(rebuilt.poles[0, number]) for number in modes}
    found = _fit(t, measured, fixed, own, noise=noise / size)
    # What the same fit makes of the prediction, whose poles are known, is its error on such a
    # dwell: poles that were left out, a tail that ends too early, digits that are lost.
    written = np.rint(expected * size / grain) * grain / size if grain else expected
    known = _fit(t, written, fixed, own, noise=inf)
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
