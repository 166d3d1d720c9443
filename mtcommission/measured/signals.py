"""What files hold -> records on an even clock, responses and spectra, in SI.

Never guessed in silence: what a name or a unit leaves open becomes one error that shows what was
found and how to say it, and what they decide alone becomes a remark. Numbers that cannot be what
they are said to be (clipped, swapped, off by a power of ten) are refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from mtcommission.base.errors import Fault, InputError, Refused
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import TIME, parse_quantity
from mtcommission.measured.columns import (
    Course,
    Meaning,
    place_in,
    read_columns,
    read_response_unit,
)
from mtcommission.measured.formats.sinumerik import SETPOINT
from mtcommission.measured.formats.table import CLOCK, SAMPLE_TIME, words_of
from mtcommission.measured.measurement import (
    FORCES,
    INPUTS,
    MOTIONS,
    NO_LINES,
    Array,
    Channel,
    Column,
    FrequencyResponse,
    Given,
    Lines,
    ResponseContents,
    Sensor,
    Signal,
    Source,
    Spectrum,
    SpectrumContents,
    TimeContents,
    TimeRecord,
    broken,
    within,
)

LEAST_SAMPLES = 64
ROUNDING = 0.02
"""Distance from an even clock, as share of the step, that times printed with few digits have."""
GAP = 4.0
"""Steps without a sample from which on something is missing."""
JITTER = 0.5
"""Spread of the steps up to which what nothing is missing from may be interpolated."""
SHORTEST_STEP, LONGEST_STEP = 2e-6, 0.05
"""Other steps are no sampling of an axis but a wrong unit [s]."""
LATEST = 1e12
"""Beyond it a time is a broken number [s]; a clock may count from the year 1601."""
SIGMAS = 3.0
"""Standard errors that the largest error of an interpolation is taken for."""
PLATEAU = 4
"""Equal samples at the end of the range that no smooth signal shows."""
FEWEST_PLATEAUS = 3
LARGEST_SHARE = 0.35
"""A signal that stands at its ends more often switches between two values on purpose."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Clock:
    """Times at which samples were taken, and the even ones at which they are wanted."""

    times: Array  # shape (n,) [s]
    step: float  # [s]
    lines: Lines  # of each sample in the file, shape (n,) or empty

    @property
    def even(self) -> Array:
        """Even times, shape (m,) [s]."""
        count = int((self.times[-1] - self.times[0]) / self.step + 1e-6) + 1
        return np.asarray(self.times[0] + self.step * np.arange(count))

    @property
    def is_even(self) -> bool:
        """Whether samples stand at even times but for rounding."""
        even = self.even
        off = np.abs(self.times - even).max() if even.size == self.times.size else np.inf
        return bool(off <= ROUNDING * self.step)

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Begin and end of stretches without samples [s]."""
        at = np.flatnonzero(np.diff(self.times) > GAP * self.step)
        return [(float(self.times[i]), float(self.times[i + 1])) for i in at]

    @property
    def remarks(self) -> list[Message]:
        """What is done to the signals, if anything."""
        if self.is_even or self.gaps:
            return []
        spread = float(np.abs(np.diff(self.times) / self.step - 1.0).max())
        return [Message("identify-resampled", spread=spread, step=self.step)]

    def _sample(self, values: Array) -> tuple[Array, float]:
        """A signal at the even times, and the standard error of its interpolation."""
        if self.is_even:
            return values, 0.0
        from scipy.interpolate import CubicSpline  # slow to load, and most clocks are even

        # Every other sample from its neighbours errs more than the sample between them.
        half = CubicSpline(self.times[::2], values[::2])(self.times[1:-1:2])
        error = float(np.abs(values[1:-1:2] - half).max()) / SIGMAS
        return np.asarray(CubicSpline(self.times, values)(self.even)), error

    def channel(
        self,
        column: Column,
        signal: Signal,
        *,
        scale: float,
        sensor: Sensor | None,
        rotary: bool | None,
    ) -> Channel:
        """Return a column at the even times; ``scale``: SI value of one unit of the file."""
        values, error = self._sample(column.values)
        return Channel(
            name=column.name,
            signal=signal,
            sensor=sensor,
            rotary=rotary,
            start=float(self.times[0]),
            step=self.step,
            values=scale * values,
            error=abs(scale) * error,
        )

    def require_even(self) -> None:
        """Raise InputError where samples are missing."""
        steps = np.diff(self.times)
        usual = float(np.median(steps))
        worst = int(np.argmax(np.abs(steps - usual)))
        got, at = float(steps[worst]), float(self.times[worst])
        if not self.is_even and abs(got - usual) > JITTER * usual:
            line = _line(self.lines, worst + 1)
            raise broken("identify-uneven", line=line, usual=usual, got=got, at=at)


def read_clock(contents: TimeContents, said: Mapping[str, str], *, where: str) -> Clock:
    """Return the clock of a record; ``said``: ``--columns``, which may state the sample time."""
    with within(where):
        return _clock(contents, said)


def _clock(contents: TimeContents, said: Mapping[str, str]) -> Clock:
    size = contents.columns[0].values.size if contents.columns else 0
    if size < LEAST_SAMPLES:
        raise broken("identify-too-few-samples", got=size, least=LEAST_SAMPLES)
    if contents.clock is None:
        step = contents.sample_time or _said_step(said)
        if step <= 0.0:
            raise broken("identify-no-sample-time")
        times: Array = step * np.arange(size, dtype=np.float64)
    else:
        times = _rising(contents.clock, contents.lines)
        steps = np.diff(times)
        step = float(np.mean(steps[steps <= GAP * np.median(steps)]))
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise broken("identify-step-out-of-range", step=step)
    return Clock(times=times, step=step, lines=contents.lines)


def _said_step(said: Mapping[str, str]) -> float:
    try:
        return parse_quantity(said[SAMPLE_TIME], TIME) if SAMPLE_TIME in said else 0.0
    except Refused as error:
        fault = Fault(where=f"--columns {SAMPLE_TIME}", message=error.message)
        raise InputError([fault]) from error


def _rising(clock: Array, lines: Lines) -> Array:
    """Times that rise; those printed with too few digits are spread evenly between."""
    if not (np.abs(clock) < LATEST).all():
        raise broken("identify-series-not-finite", name=CLOCK)
    steps = np.diff(clock)
    if (steps > 0.0).all():
        return clock
    even: Array = np.linspace(clock[0], clock[-1], clock.size)
    grain = float(steps.max())
    if steps.min() < 0.0 or grain == 0.0 or float(np.abs(clock - even).max()) > 1.5 * grain:
        at = int(np.argmax(steps <= 0.0))
        line, kind = _line(lines, at + 1), "identify-time-does-not-rise"
        raise broken(kind, line=line, before=clock[at], after=clock[at + 1])
    return even


def _line(lines: Lines, row: int) -> int:
    return int(lines[row]) if lines.size else 0


def read_record(
    contents: TimeContents, source: Source, given: Given, remarks: Sequence[Message]
) -> TimeRecord:
    """Return a record in SI."""
    columns = contents.columns
    clock = _clock(contents, given.columns)
    clock.require_even()
    # Words alone tell no unit; and who names columns names those that count.
    names_all = bool(set(given.columns) - {CLOCK, SAMPLE_TIME})
    meanings = [
        one if one and (one.is_ours or not (one.is_assumed or names_all)) else None
        for one in read_columns(columns, given.columns, where=source.file)
    ]
    _require_known(columns, meanings, given)
    known = [(c, m) for c, m in zip(columns, meanings, strict=True) if m]
    channels, said = _channels(known, clock, given)
    slips = (
        _find_unit_slip(one, other)
        for one in channels
        for other in channels
        if (one.signal, other.signal) in tuple(pairwise(MOTIONS))
        if one.sensor is other.sensor and one.rotary == other.rotary
    )
    clipped = (_find_clipping(c.values, c.name) for c, m in known if m.seen is not Signal.REFERENCE)
    if faults := [Fault(where=source.file, message=one) for one in (*slips, *clipped) if one]:
        raise InputError(faults)
    if ignored := tuple(c.name for c, m in zip(columns, meanings, strict=True) if m is None):
        said.insert(0, Message("identify-ignored", names=ignored))
    remarks = (*remarks, *clock.remarks, *said)
    return TimeRecord(source=source, channels=channels, remarks=remarks)


def _require_known(
    columns: Sequence[Column], meanings: Sequence[Meaning | None], given: Given
) -> None:
    """Raise one error that shows every column where what is known does not suffice."""
    known = [meaning for meaning in meanings if meaning]
    signals = {meaning.seen for meaning in known}
    has_input = bool(signals & set(FORCES)) or None not in meanings
    has_place = all(m.sensor for m in known if m.seen is Signal.ACCELERATION)
    missing = {
        "identify-missing-output": not signals & set(MOTIONS),
        "identify-missing-input": not has_input and not given.columns,
        "identify-missing-sensor": given.sensor is None and not has_place,
    }
    if not any(missing.values()):
        return
    found = tuple(
        Message(
            "identify-column-found",
            place=place,
            name=column.name,
            unit=column.unit or "?",
            what=Message(f"identify-signal-{meaning.seen}" if meaning else "identify-not-known"),
        )
        for place, (column, meaning) in enumerate(zip(columns, meanings, strict=True), start=1)
    )
    asked = tuple(Message(kind) for kind, lacks in missing.items() if lacks)
    raise broken("identify-columns-unknown", found=found, missing=asked)


def _channels(
    known: Sequence[tuple[Column, Meaning]], clock: Clock, given: Given
) -> tuple[tuple[Channel, ...], list[Message]]:
    """Channels that are of use, the inputs first, and what was decided about them."""
    forces = [pair for pair in known if pair[1].seen in FORCES]
    acting = [pair for pair in forces if pair[1].course is Course.ACTUAL]
    remarks = []
    if acting:  # the force that acts says more than the one that was asked for
        known = [pair for pair in known if pair not in forces or pair in acting]
    else:
        remarks = [
            Message("identify-set-force", name=column.name)
            for column, meaning in forces
            if meaning.course is Course.SETPOINT
        ]
    if assumed := tuple(c.name for c, m in known if m.is_assumed):
        remarks.append(Message("identify-si-assumed", names=assumed))
    # FILE@tcp goes before a column's name.
    is_alone = sum(m.seen in MOTIONS for _, m in known) == 1
    channels = []
    for column, meaning in known:
        sensor = meaning.sensor
        if meaning.seen in MOTIONS:
            sensor = (given.sensor if is_alone or sensor is None else None) or sensor
            if sensor is None:
                sensor = Sensor.ENCODER
                remarks.append(Message("identify-sensor-assumed", name=column.name))
        sign = -1.0 if meaning.course is Course.ERROR else 1.0
        scale, rotary = sign * meaning.scale, meaning.rotary
        if meaning.seen in FORCES and given.constant is not None:
            scale *= given.constant
        channels.append(
            clock.channel(column, meaning.seen, scale=scale, sensor=sensor, rotary=rotary)
        )

    def rank(channel: Channel) -> tuple[bool, int]:
        is_force = channel.signal in FORCES
        place = FORCES.index(channel.signal) if is_force else len(FORCES)
        return not (is_force and channel.signal == given.input), place

    return tuple(sorted(channels, key=rank)), remarks


def _find_clipping(values: Array, name: str) -> Message | None:
    """What is wrong with a signal that was cut off at the end of its range.

    A clipped signal runs into its largest value at full slope and stands there; a smooth one
    arrives slowly, and one of two values (PRBS, square) is there half of the time.
    """
    steps = np.abs(np.diff(values))
    moved = steps[steps > 0.0]
    if not moved.size:
        return None
    usual, quantum = float(np.median(moved)), float(moved.min())
    for end in (values.max(), values.min()):
        edges = np.flatnonzero(np.diff((values == end).astype(np.int8), prepend=0, append=0))
        starts, lengths = edges[::2], edges[1::2] - edges[::2]
        long = lengths >= PLATEAU
        share = float(lengths[long].sum()) / values.size
        if long.sum() < FEWEST_PLATEAUS or share > LARGEST_SHARE:
            continue
        entered = starts[long & (starts > 0)]
        arrival = float(np.median(steps[entered - 1])) if entered.size else 0.0
        if arrival > 0.2 * usual and arrival > 2.5 * quantum:
            count = int(long.sum())
            return Message("identify-clipped", name=name, end=float(end), count=count, share=share)
    return None


def _find_unit_slip(one: Channel, other: Channel) -> Message | None:
    """What is wrong with a velocity that is not the position's rate; or acceleration so."""
    rate = np.diff(one.values) / one.step
    mean = 0.5 * (other.values[1:] + other.values[:-1])
    width = min(9, rate.size)
    rate, mean = (np.convolve(x, np.ones(width) / width, "valid") for x in (rate, mean))
    size = float(np.linalg.norm(rate) * np.linalg.norm(mean))
    if size == 0.0 or abs(float(rate @ mean)) < 0.9 * size:
        return None
    ratio = float(np.linalg.norm(mean) / np.linalg.norm(rate))
    return (
        None if 0.7 < ratio < 1.4 else Message("identify-unit-slip", name=other.name, ratio=ratio)
    )


LEAST_LINES = 12
"""Fewer lines of a response tell nothing."""
LOWEST_HZ, HIGHEST_HZ = 5.0, 50_000.0
"""The last line of a response lies between, or its unit is wrong."""
SLACK = 1e-3
"""How far a coherence may leave 0 to 1 by rounding."""
STEEPEST = -0.7
"""Slope of the position in decades per decade of frequency that an axis with its mass stays below:
a free mass falls by two, modes bend that by less than one on the whole."""
LEAST_DECADES = 0.8
"""Band below which a resonance alone may make a response rise."""
STEEPEST_HELD = 1.0
"""The same of a structure that is held, seen at the tool: it stays level, then falls."""
PERFECT = 1.0 - 1e-9
"""A coherence of 1 in every line is that of a single average: it says nothing."""


def read_response(
    contents: ResponseContents, source: Source, given: Given, remarks: Sequence[Message]
) -> FrequencyResponse:
    """Return a response in SI."""
    said = list(remarks)
    unit = read_response_unit(contents.unit) if contents.unit else None
    given = given.over(contents.said)
    word = given.input or (unit.input if unit else "")
    output = given.output or (unit.output if unit else None)
    sensor = place_in(words_of(contents.label)) or given.sensor
    if word == SETPOINT:
        raise broken("identify-setpoint-response")
    if sensor is None and output is Signal.VELOCITY:
        sensor = Sensor.ENCODER
        said.append(Message("identify-sensor-assumed", name=source.name))
    if unit and output and unit.output is not output:
        name, signal = contents.label or "re", Message(f"identify-signal-{unit.output.value}")
        kind = "identify-column-contradicts"
        raise broken(kind, name=name, unit=contents.unit, signal=signal)
    missing = {
        "identify-say-input": not word,
        "identify-say-output": output is None,
        "identify-missing-sensor": sensor is None,
        "identify-say-constant": word == "current" and given.constant is None,
    }
    if any(missing.values()) or word not in INPUTS or output is None or sensor is None:
        asked = tuple(Message(kind) for kind, lacks in missing.items() if lacks)
        found = contents.unit or Message("identify-no-unit")
        raise broken("identify-response-unknown", found=found, missing=asked)
    scale = contents.scale or (unit.scale if unit else 1.0)
    if contents.scale is None and unit is None:
        said.append(Message("identify-unit-assumed", found=contents.unit or "-"))
    rotary = contents.rotary if contents.rotary is not None else unit.rotary if unit else None
    if rotary is None:
        rotary = word == "torque" or bool(given.rotary)
    if given.constant is not None and word != "acceleration":
        scale /= given.constant
    response = FrequencyResponse(
        source=source,
        frequency_hz=contents.frequency_hz,
        values=scale * contents.values,
        coherence=contents.coherence,
        averages=contents.averages,
        resolution_hz=contents.resolution_hz,
        input=Signal.ACCELERATION if word == "acceleration" else Signal.FORCE,
        output=output,
        sensor=sensor,
        rotary=rotary,
        remarks=tuple(said),
    )
    return settle(response, given, contents.lines)


def settle(response: FrequencyResponse, given: Given, lines: Lines = NO_LINES) -> FrequencyResponse:
    """Return a response whose lines can be used, as the axis of a profile has it, not its motor.

    Frequencies that fall are turned round, the line at 0 Hz is left out. Motor angle per torque
    becomes travel per force: with r radians per metre the force is r times the torque and the
    travel 1/r of the angle.
    """
    remarks = list(response.remarks)
    order = np.arange(response.frequency_hz.size)
    if order.size > 1 and response.frequency_hz[0] > response.frequency_hz[-1]:
        order = order[::-1]
    if order.size and response.frequency_hz[order[0]] == 0.0:
        order = order[1:]
    coherence = response.coherence[order] if response.coherence is not None else None
    response = replace(
        response, frequency_hz=response.frequency_hz[order], values=response.values[order]
    )
    kept = lines[order] if lines.size else lines
    _require_good_lines(response.frequency_hz, kept, coherence=coherence)
    is_force = response.input is Signal.FORCE
    if is_force:
        _require_falling(response)
    if coherence is not None:
        coherence = np.clip(coherence, 0.0, 1.0)
        if (coherence > PERFECT).all():
            coherence = None
            remarks.append(Message("identify-perfect-coherence"))
    if is_force and given.rotary is not None and given.rotary != response.rotary:
        turn = given.motor_turn
        if given.rotary or turn <= 0.0:
            kind = "linear-on-rotary" if given.rotary else "rotary-on-linear"
            raise broken(f"identify-{kind}")
        response = replace(response, values=response.values / turn**2, rotary=False)
        remarks.append(Message("identify-motor-to-axis", turn=turn))
    return replace(response, coherence=coherence, remarks=tuple(remarks))


def read_spectrum(
    contents: SpectrumContents, source: Source, given: Given, remarks: Sequence[Message]
) -> Spectrum:
    """Return a spectrum whose lines can be used; the line at 0 Hz is left out."""
    kept = contents.frequency_hz > 0.0
    if contents.frequency_hz[0] < 0.0:
        kept[:] = True
    frequency, density = contents.frequency_hz[kept], contents.density[kept]
    _require_good_lines(frequency, contents.lines[kept])
    if not density.max() > 0.0:
        raise broken("identify-all-zero")
    return Spectrum(
        source=source,
        frequency_hz=frequency,
        density=density,
        resolution_hz=contents.resolution_hz,
        sensor=given.sensor or Sensor.TCP,
        rotary=bool(given.rotary),
        remarks=tuple(remarks),
        all_directions=contents.all_directions,
    )


def _require_good_lines(f: Array, lines: Lines, *, coherence: Array | None = None) -> None:
    """Refuse frequencies that do not rise, are too few or out of range, and such a coherence."""
    if f.size < LEAST_LINES:
        raise broken("identify-fewer-lines-than-needed", got=f.size, least=LEAST_LINES)
    steps = np.diff(f)
    if (steps <= 0.0).any():
        row, kind = int(np.argmax(steps <= 0.0)) + 1, "identify-frequency-does-not-rise"
        raise broken(kind, line=_line(lines, row), before=f[row - 1], after=f[row])
    first, last = float(f[0]), float(f[-1])
    if not LOWEST_HZ <= last <= HIGHEST_HZ or first < 0.0:
        kind = "identify-frequency-out-of-range"
        raise broken(kind, first=first, last=last, least=LOWEST_HZ, most=HIGHEST_HZ)
    if coherence is not None:
        out = (coherence < -SLACK) | (coherence > 1.0 + SLACK)
        if out.any():
            row, kind = int(np.argmax(out)), "identify-coherence-out-of-range"
            raise broken(kind, line=_line(lines, row), got=float(coherence[row]))


def _require_falling(response: FrequencyResponse) -> None:
    """Refuse a response per force that rises like no mechanics do.

    The position per force falls with frequency or stays; one that rises is the reciprocal
    (columns swapped), or a derivative more than was said.
    """
    f, size = response.frequency_hz, np.abs(response.values)
    good = (f > 0.0) & (size > 0.0)
    if good.sum() < LEAST_LINES:
        raise broken("identify-all-zero")
    decades = np.log10(f[good])
    if decades[-1] - decades[0] < LEAST_DECADES:
        return
    # Evenly over the decades: on a linear grid the high lines would outvote the low ones.
    grid = np.linspace(decades[0], decades[-1], 200)
    course = np.interp(grid, decades, np.log10(size[good])) - response.output.derivative * grid
    slope = float(np.polyfit(grid, course, 1)[0])
    if slope > (STEEPEST_HELD if response.sensor is Sensor.TCP else STEEPEST):
        raise broken("identify-rising", slope=slope)
