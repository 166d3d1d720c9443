"""Responses and spectra of files -> SI, with what the user says about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.identify.columns import place_in, read_response_unit
from mtcommission.identify.formats.contents import (
    NO_LINES,
    Lines,
    ResponseContents,
    SpectrumContents,
    broken,
)
from mtcommission.identify.formats.sinumerik import SETPOINT
from mtcommission.identify.formats.table import words_of
from mtcommission.identify.measurement import (
    INPUTS,
    Array,
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
    Source,
    Spectrum,
)

LEAST_LINES = 12
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

    def line(row: int) -> int:
        return int(lines[row]) if lines.size else 0

    if f.size < LEAST_LINES:
        raise broken("identify-fewer-lines-than-needed", got=f.size, least=LEAST_LINES)
    steps = np.diff(f)
    if (steps <= 0.0).any():
        row, kind = int(np.argmax(steps <= 0.0)) + 1, "identify-frequency-does-not-rise"
        raise broken(kind, line=line(row), before=f[row - 1], after=f[row])
    first, last = float(f[0]), float(f[-1])
    if not LOWEST_HZ <= last <= HIGHEST_HZ or first < 0.0:
        kind = "identify-frequency-out-of-range"
        raise broken(kind, first=first, last=last, least=LOWEST_HZ, most=HIGHEST_HZ)
    if coherence is not None:
        out = (coherence < -SLACK) | (coherence > 1.0 + SLACK)
        if out.any():
            row, kind = int(np.argmax(out)), "identify-coherence-out-of-range"
            raise broken(kind, line=line(row), got=float(coherence[row]))


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
