"""Responses and spectra of files -> SI, with what the user says about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.columns import place_in, read_response_unit
from mtcommission.identify.formats.contents import (
    NO_LINES,
    Lines,
    ResponseContents,
    SpectrumContents,
    refuse,
)
from mtcommission.identify.formats.sinumerik import SETPOINT
from mtcommission.identify.formats.table import words_of
from mtcommission.identify.measurement import (
    INPUTS,
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
    Source,
    Spectrum,
)
from mtcommission.identify.record import find_bad_lines, find_rising

PERFECT = 1.0 - 1e-9
"""A coherence of 1 in every line is that of a single average: it says nothing."""


def read_response(
    contents: ResponseContents, source: Source, given: Given, remarks: Sequence[Message]
) -> FrequencyResponse:
    """Return a response in SI."""
    where, said = source.name, list(remarks)
    unit = read_response_unit(contents.unit) if contents.unit else None
    given = given.over(contents.said)
    word = given.input or (unit.input if unit else "")
    output = given.output or (unit.output if unit else None)
    sensor = place_in(words_of(contents.label)) or given.sensor
    if word == SETPOINT:
        raise refuse(where, "identify-setpoint-response")
    if sensor is None and output is Signal.VELOCITY:
        sensor = Sensor.ENCODER
        said.append(Message("identify-sensor-assumed", name=where))
    if unit and output and unit.output is not output:
        name, signal = contents.label or "re", Message(f"identify-signal-{unit.output.value}")
        kind = "identify-column-contradicts"
        raise refuse(where, kind, name=name, unit=contents.unit, signal=signal)
    missing = {
        "identify-say-input": not word,
        "identify-say-output": output is None,
        "identify-missing-sensor": sensor is None,
        "identify-say-constant": word == "current" and given.constant is None,
    }
    if any(missing.values()) or word not in INPUTS or output is None or sensor is None:
        asked = tuple(Message(kind) for kind, lacks in missing.items() if lacks)
        found = contents.unit or Message("identify-no-unit")
        raise refuse(where, "identify-response-unknown", found=found, missing=asked)
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
    where, remarks = response.source.name, list(response.remarks)
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
    fault = find_bad_lines(response.frequency_hz, kept, where=where, coherence=coherence)
    is_force = response.input is Signal.FORCE
    if fault is None and is_force and (rising := find_rising(response)):
        fault = Fault(where=where, message=rising)
    if fault:
        raise InputError([fault])
    if coherence is not None:
        coherence = np.clip(coherence, 0.0, 1.0)
        if (coherence > PERFECT).all():
            coherence = None
            remarks.append(Message("identify-perfect-coherence"))
    if is_force and given.rotary is not None and given.rotary != response.rotary:
        turn = given.motor_turn
        if given.rotary or turn <= 0.0:
            raise refuse(
                where, f"identify-{'linear-on-rotary' if given.rotary else 'rotary-on-linear'}"
            )
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
    fault = find_bad_lines(frequency, contents.lines[kept], where=source.name)
    if fault is None and not density.max() > 0.0:
        fault = Fault(where=source.name, message=Message("identify-all-zero"))
    if fault:
        raise InputError([fault])
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
