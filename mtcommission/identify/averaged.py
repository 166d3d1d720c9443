"""A response as a mean over windows, over periods, or over blows: one estimate for all of them.

With the transforms U, Y of n parts of a record, and R of what excites them, H = S_ry / S_ru; its
variance is S_vv S_rr / (n |S_ru|²) with v = Y - H U.

- By windows (Welch) R = U without a recorded excitation. In a closed loop the disturbances come
  back through the controller and stand in u, but not in a recorded excitation: only that one is
  unbiased.
- By periods R = 1: averages before dividing. Noise of the input then biases nothing, and neither
  does a closed loop, since noise does not repeat; whole periods do not leak.
- By blows R = U, from before each blow to the next one: it is short and what follows dies away, so
  no window is needed.

Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73; R. Pintelon, J. Schoukens,
System Identification, 2nd ed., 2.5, 2.6.4; overlap: F. J. Harris, Proc. IEEE 66 (1978), eq. (19).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.measured.measurement import Array, ComplexArray, FrequencyResponse, Signal
from mtcommission.measured.regression import neighbours

HIGHEST_SHARE = 0.3
"""Share of the sampling frequency up to which lines are kept: above it anti-alias filters act, and
what the hold of the force folds back is more than some per cent."""
HALF_POWER_BINS = 1.44
"""Half-power width of Hann's window in bins. Source: Harris 1978, table I."""
OVERLAP_CORRELATION = 1.0 / 36.0
"""Square of Hann's correlation at half overlap, 1/6. Source: Harris 1978, eq. (17)."""
FEWEST_SEGMENTS = 7
FIRST_SEGMENTS = 24
MOST_LINES = 3000
SPACING_OF_WIDTH = 0.4
"""Largest line spacing per half-power width 2 ζ f: beyond it damping is read too large by the
window. Source: tried on records of 2, 4 and 8 s, see docs/identification.md."""
LEAST_PEAK_DB = 6.0
CLEAR = 0.6
"""Coherence from which a peak is believed when the window is chosen."""
CARRIES = 0.2
"""Coherence of excitation and input from which the excitation is used."""
BIASED_BELOW = 0.9
"""Coherence below which a closed loop could bias a line by more than a tenth."""
EXCITED = 20.0
"""Power of a line of the input over the variance of its mean from which it counts as excited."""
FEW_PERIODS = 8
"""Fewer leave the variance of a line uncertain: that of its neighbours counts, too."""
UNSETTLED = 4.0
"""How much more the first period may differ from the others than they do among themselves."""
BEFORE = 0.005
"""Time before a blow at which its part of the record begins [s]."""
USEFUL = 1e-2
"""Power of the blow over that at low frequency, down to which lines are kept: 20 dB."""
HOLD = 0.078
"""Share of the sampling frequency at which a hold takes 1 %: sin(π x)/(π x) = 0.99."""
LEFT_OVER = 0.1
"""Share of a response at the end of its part that is told."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Signals:
    """Input and output of one response, made ready.

    A position drifts and its spectrum falls by four decades, which leaks into every line; so its
    differences are transformed and the lines divided by those of a difference, which is exact.
    """

    step: float  # Of the clock [s]
    # input, output: Shape (n,); the output is the difference where it is a position.
    input: Array
    output: Array
    reference: Array | None  # Recorded excitation, shape (n,); None where there is none
    response: FrequencyResponse  # What it will be, without lines yet

    def frequencies(self, length: int) -> Array:
        """Lines of a transform of so many samples [Hz]."""
        return np.fft.rfftfreq(length, self.step).astype(np.float64)

    def kept(self, length: int) -> NDArray[np.bool_]:
        f = self.frequencies(length)
        return np.asarray((f > 0.0) & (f <= HIGHEST_SHARE / self.step))


def average(
    step: float, input_: Array, output: Array, reference: Array | None, response: FrequencyResponse
) -> FrequencyResponse:
    """Return a response in the lines that signals show, by the way that fits their excitation.

    ``response``: what it will be, without lines yet; ``step``: of the clock [s].
    """
    if response.output is Signal.POSITION:
        output, input_ = np.diff(output), input_[:-1]
    if reference is not None:
        reference = reference[: input_.size] - reference[: input_.size].mean()
    signals = _Signals(
        step=step,
        input=input_ - input_.mean(),
        output=output - output.mean(),
        reference=reference,
        response=response,
    )
    if blows := _find_blows(signals.input, step):
        return _by_blows(signals, blows)
    period = _find_period(signals.input)
    if not period and reference is not None:
        period = _find_period(reference)
    found = _by_periods(signals, period) if period else _by_windows(signals)
    return found.say(Message("identify-hold", limit=HOLD / step))


def _by_windows(signals: _Signals) -> FrequencyResponse:
    """A response from a record that repeats nothing.

    The window is lengthened from a twelfth of the record until the sharpest peak is resolved, but
    not beyond the length that leaves seven overlapping segments.
    """
    size = signals.input.size
    longest = 2 * size // (FEWEST_SEGMENTS + 1)
    length = min(2 * size // (FIRST_SEGMENTS + 1), int(MOST_LINES / HIGHEST_SHARE))
    while True:
        found, segments, is_joint = _in_windows(signals, length)
        narrowest = _narrowest_width(found)
        window = length * signals.step
        is_resolved = narrowest == 0.0 or 1.0 / window <= SPACING_OF_WIDTH * narrowest
        if is_resolved or length >= longest:
            break
        length = min(longest, int(1.5 * length))
    how = {"window": window, "averages": found.averages, "spacing": 1.0 / window}
    said = [Message("identify-by-welch", segments=segments, **how)]
    if not is_resolved:
        said.append(Message("identify-welch-too-coarse", spacing=1.0 / window, width=narrowest))
    if is_joint:
        return found.say(*said, Message("identify-joint-estimate"))
    coherence = found.coherence
    doubtful = 1.0
    if coherence is not None and coherence.size:
        doubtful = float((coherence < BIASED_BELOW).mean())
    kind = "identify-no-reference" if signals.reference is None else "identify-reference-silent"
    return found.say(*said, Message(kind, share=doubtful))


def _by_periods(signals: _Signals, period: int) -> FrequencyResponse:
    count = signals.input.size // period
    first = signals.input.size - count * period
    U, Y = (
        np.fft.rfft(signal[first:].reshape(count, period), axis=1)
        for signal in (signals.input, signals.output)
    )
    said = []
    if count > 2 and _is_unsettled(U, Y):
        U, Y, said = U[1:], Y[1:], [Message("identify-period-left-out")]
    used = len(U)
    power = np.abs(U.mean(axis=0)) ** 2
    spread = _smooth(U.var(axis=0, ddof=1), used)
    excited = (power > EXCITED * spread / used) & _excited_band(power)
    excited &= signals.kept(period) & (np.abs(Y.mean(axis=0)) > 0.0)
    U, Y = U[:, excited], Y[:, excited]
    frequency = signals.frequencies(period)[excited]
    found = _average(signals, frequency, np.ones_like(U), U, Y, repeats=True)
    how = Message("identify-by-periods", count=used, period=period * signals.step)
    return found.say(how, *said)


def _by_blows(signals: _Signals, blows: Sequence[int]) -> FrequencyResponse:
    """A response, in the band that they excite, from blows that begin at some samples."""
    lead = int(BEFORE / signals.step)
    starts = [max(blow - lead, 0) for blow in blows]
    gaps = np.diff([*starts, signals.input.size])
    length = whole = int(gaps[:-1].min() if len(starts) > 1 else gaps[0])
    if gaps[-1] < 0.7 * whole:  # the last one was cut
        starts = starts[:-1]
    else:
        length = int(min(whole, gaps[-1]))
    u, y = (
        np.stack([signal[start : start + length] for start in starts])
        for signal in (signals.input, signals.output)
    )
    u = u - np.median(u, axis=1, keepdims=True)
    y = y - np.median(y[:, -max(length // 10, 1) :], axis=1, keepdims=True)
    tail = np.abs(y[:, -max(length // 20, 1) :]).max(axis=1) / np.abs(y).max(axis=1)
    U, Y = np.fft.rfft(u, axis=1), np.fft.rfft(y, axis=1)
    power = _mean(U, U).real
    kept = signals.kept(length) & (power > USEFUL * power[1:].max()) & (_mean(Y, Y).real > 0.0)
    frequency = signals.frequencies(length)[kept]
    found = _average(signals, frequency, U[:, kept], U[:, kept], Y[:, kept])
    count, left_over = len(starts), float(tail.max())
    said = [Message("identify-by-blows", count=count, duration=length * signals.step)]
    if left_over > LEFT_OVER:
        said.append(Message("identify-not-died-away", share=left_over))
    if count == 1:
        said.append(Message("identify-single-blow"))
    return found.say(*said)


def _segments(values: Array, length: int) -> ComplexArray:
    """Transforms of Hann-windowed segments, shape (n_segments, n_lines)."""
    parts = np.lib.stride_tricks.sliding_window_view(values, length)[:: max(length // 2, 1)]
    parts = parts - parts.mean(axis=1, keepdims=True)
    hann = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    return np.asarray(np.fft.rfft(parts * hann, axis=1))


def _average(
    signals: _Signals,
    frequency: Array,
    R: ComplexArray,
    U: ComplexArray,
    Y: ComplexArray,
    *,
    averages: float = 0.0,
    resolution_hz: float = 0.0,
    repeats: bool = False,
) -> FrequencyResponse:
    """The response in some lines; transforms of shape (n_parts, n_lines)."""
    S_rr, S_ru = _mean(R, R).real, _mean(R, U)
    with np.errstate(all="ignore"):
        H = _mean(R, Y) / S_ru
        S_vv = _mean(Y - H * U, Y - H * U).real
        if repeats:
            S_vv *= len(U) / (len(U) - 1)
        noise = S_vv * S_rr / (np.abs(S_ru) * np.abs(H)) ** 2
        gamma2 = 1.0 / (1.0 + (_smooth(noise, len(U)) if repeats else noise))
    good = np.isfinite(H) & np.isfinite(gamma2) & (np.abs(H) > 0.0)
    frequency, H = frequency[good], H[good]
    if signals.response.output is Signal.POSITION:
        H = H / (np.exp(2j * np.pi * frequency * signals.step) - 1.0)
    return replace(
        signals.response,
        frequency_hz=frequency,
        values=H,
        coherence=gamma2[good],
        averages=averages or float(len(U)),
        resolution_hz=resolution_hz,
    )


def _mean(one: ComplexArray, other: ComplexArray) -> ComplexArray:
    return np.asarray((one.conj() * other).mean(axis=0))


def _smooth(values: Array, periods: int) -> Array:
    """The mean over neighbouring lines, where few periods leave each line's own uncertain."""
    if periods >= FEW_PERIODS or values.size < NEIGHBOURS:
        return values
    padded = np.pad(values, NEIGHBOURS // 2, mode="edge")
    return np.convolve(padded, np.ones(NEIGHBOURS) / NEIGHBOURS, mode="valid")


def _is_unsettled(U: ComplexArray, Y: ComplexArray) -> bool:
    for Z in (U[:, 1:], Y[:, 1:]):
        off = np.linalg.norm(Z - Z[1:].mean(axis=0), axis=1)
        if off[0] > UNSETTLED * np.median(off[1:]):
            return True
    return False


def _in_windows(signals: _Signals, length: int) -> tuple[FrequencyResponse, int, bool]:
    """The response, the number of segments, and whether the recorded excitation was used."""
    frequency, kept = signals.frequencies(length), signals.kept(length)
    kept[:2] = False  # Hann's window spreads what is near 0 Hz into the first two lines
    U = _segments(signals.input, length)[:, kept]
    Y = _segments(signals.output, length)[:, kept]
    R, is_joint = U, False
    if signals.reference is not None:
        recorded = _segments(signals.reference, length)[:, kept]
        if _carries(recorded, U, Y):
            R, is_joint = recorded, True
    # Segments with half overlap are not worth as many independent ones.
    averages = len(U) / (1.0 + 2.0 * OVERLAP_CORRELATION * (len(U) - 1) / len(U))
    width = HALF_POWER_BINS / (length * signals.step)
    found = _average(signals, frequency[kept], R, U, Y, averages=averages, resolution_hz=width)
    return found, len(U), is_joint


def _carries(R: ComplexArray, U: ComplexArray, Y: ComplexArray) -> bool:
    """Whether the excitation moves the input in the lines in which the input moves the output."""
    with np.errstate(all="ignore"):
        by_input = np.abs(_mean(U, Y)) ** 2 / (_mean(U, U) * _mean(Y, Y)).real
        by_reference = np.abs(_mean(R, U)) ** 2 / (_mean(R, R) * _mean(U, U)).real
    moved = by_reference[np.isfinite(by_reference) & (by_input > 0.3)]
    return bool(moved.size) and float(np.median(moved)) > CARRIES


def _narrowest_width(found: FrequencyResponse) -> float:
    """Half-power width of the sharpest clear peak [Hz], freed of the window's own; 0: none."""
    f, coherence = found.frequency_hz, found.coherence
    if f.size < 5 or coherence is None:
        return 0.0
    from scipy.signal import find_peaks, peak_widths  # slow to load

    # Times f the velocity's peaks stand on a level ground, and a position's nearly so.
    power = 2 if found.output is Signal.POSITION else 1
    size = 20.0 * np.log10(np.abs(found.values) * f**power)
    peaks, _ = find_peaks(size, prominence=LEAST_PEAK_DB)
    peaks = peaks[coherence[peaks] > CLEAR]
    if not peaks.size:
        return 0.0
    widths = peak_widths(10.0 ** (size / 10.0), peaks, rel_height=0.5)[0]
    widths *= float(np.median(np.diff(f)))
    own = np.maximum(widths - (found.resolution_hz or 0.0), 0.2 * widths)
    return float(own.min())


QUIET = 0.05
"""Share of the largest force that counts as none."""
MOST_BUSY = 0.05
"""Share of the samples with force up to which a record is one of blows."""
LEAST_LIKENESS = 0.95
"""Correlation of a signal with itself one period later that makes it periodic."""
SAME = 0.02
"""A shorter period is taken if its correlation is lower by no more than this."""
SHORTEST = 32
"""Samples of a period."""
CLIFF = 30.0
"""Fall of the input's power from five lines to the next five that ends its band, for good. Beyond
it distortion remains, which repeats as well: 15 dB, and a multisine falls by more than 20."""
SPARSE = 50.0
"""Power of the lines around over that of one which was left out on purpose."""
FAINTEST = 1e-6
"""Power over the largest one below which a line is none."""
PARTS = 6.0
"""Of an octave, in which the largest power is looked for."""
MOSTLY = 0.7
"""Share of the lines that stand out from which a spectrum is dense."""
NEIGHBOURS = 5
"""Lines over which a level, or a variance, is averaged."""


def _find_blows(force: Array, step: float) -> list[int]:
    """The samples at which blows begin; [] if the record is none of blows."""
    rest = force - np.median(force)
    busy = np.abs(rest) > QUIET * np.abs(rest).max()
    if not busy.any() or busy.mean() > MOST_BUSY:
        return []
    places = np.flatnonzero(busy)
    gap = max(int(0.05 / step), 8)
    return [int(p) for p in places[np.concatenate(([True], np.diff(places) > gap))]]


def _find_period(values: Array) -> int:
    """The period of a signal in samples; 0 if it has none that is recorded twice."""
    size = values.size
    if size < 2 * SHORTEST:
        return 0
    transformed = np.fft.rfft(values, 2 * size)
    product = np.fft.irfft(np.abs(transformed) ** 2)[: size // 2 + 1]
    energy = np.concatenate(([0.0], np.cumsum(values**2)))
    lags = np.arange(size // 2 + 1)
    heads, tails = energy[size - lags], energy[size] - energy[lags]
    with np.errstate(all="ignore"):
        likeness = np.nan_to_num(product / np.sqrt(heads * tails))
    likeness[:SHORTEST] = -1.0
    best = int(np.argmax(likeness))
    if likeness[best] < LEAST_LIKENESS:
        return 0
    for parts in range(best // SHORTEST, 1, -1):
        lag = round(best / parts)
        if abs(lag * parts - best) <= parts // 2 and likeness[lag] >= likeness[best] - SAME:
            near = slice(max(lag - 1, SHORTEST), lag + 2)
            return near.start + int(np.argmax(likeness[near]))
    return best


def _excited_band(power: Array) -> NDArray[np.bool_]:
    """Which lines of an input are excited on purpose, shape (n_lines,).

    A loop makes the input's power fall slowly, a resonance digs a hole that ends; only where the
    power falls off a cliff and never recovers does the excitation end. Where most lines stand far
    below their neighbours, only some are excited (odd ones, or so many per octave).
    """
    band = np.zeros(power.size, dtype=np.bool_)
    stands_out = power * SPARSE > _envelope(power)
    loud = power > FAINTEST * power[1:].max()
    loud[0] = False
    dense = not loud.any() or stands_out[loud].mean() > MOSTLY
    lines = np.flatnonzero(loud if dense else loud & stands_out)
    band[lines[_between_cliffs(power[lines])]] = True
    return band


def _between_cliffs(power: Array) -> slice:
    """The lines from the last rise off a cliff to the first fall, around the loudest."""
    if power.size < 4 * NEIGHBOURS:
        return slice(0, power.size)
    level = np.median(neighbours(power, NEIGHBOURS), axis=1)
    loudest = int(np.argmax(level))
    below = _end_of_band(power[::-1], level[::-1], power.size - 1 - loudest)
    return slice(power.size - below, _end_of_band(power, level, loudest))


def _envelope(power: Array) -> Array:
    """The largest power within about a quarter of an octave, or a few lines, of each line."""
    lines = np.arange(1, power.size)
    widths = np.maximum(NEIGHBOURS, lines * np.log(2.0) / PARTS)
    parts = np.cumsum(1.0 / widths).astype(np.int64)
    starts = np.flatnonzero(np.diff(parts, prepend=-1))
    highest = neighbours(np.maximum.reduceat(power[1:], starts), 3).max(axis=1)
    places = np.cumsum(np.diff(parts, prepend=parts[0]) > 0)
    return np.concatenate(([power[0]], highest[places]))


def _end_of_band(power: Array, level: Array, start: int) -> int:
    """The first line beyond the band, upwards from a line inside it."""
    highest_after = np.maximum.accumulate(level[::-1])[::-1]
    for line in range(start + 1, level.size - NEIGHBOURS):
        before = float(np.median(power[max(line - NEIGHBOURS, 0) : line]))
        if before > CLIFF * highest_after[line + NEIGHBOURS // 2]:
            while power[line] * CLIFF > before:  # the median falls before the edge
                line += 1
            return line
    return level.size
