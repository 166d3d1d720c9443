"""Responses and spectra of files -> SI, with what the user says about them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mtcommission.errors import Fault, InputError
from mtcommission.identify.formats.contents import Lines, ResponseContents, SpectrumContents
from mtcommission.identify.formats.heads import words_of
from mtcommission.identify.formats.sinumerik import SETPOINT
from mtcommission.identify.given import Given
from mtcommission.identify.meaning.checks import (
    find_bad_coherence,
    find_bad_frequency,
    find_rising,
)
from mtcommission.identify.meaning.columns import place_in
from mtcommission.identify.meaning.units import read_response_unit
from mtcommission.identify.measurement import (
    FrequencyResponse,
    Input,
    Output,
    Sensor,
    Source,
    Spectrum,
)
from mtcommission.messages.message import Message

PERFECT = 1.0 - 1e-9
"""A coherence of 1 in every line is that of a single average: it says nothing."""


def read_response(
    contents: ResponseContents, source: Source, given: Given, remarks: tuple[Message, ...]
) -> FrequencyResponse:
    """Return a response in SI.

    Raise InputError with every fault; what is missing is asked for in one of them.
    """
    where, said = source.name, list(remarks)
    unit = read_response_unit(contents.unit) if contents.unit else None
    word = given.input or contents.input or (unit.input if unit else "")
    output = given.output or contents.output or (unit.output if unit else None)
    sensor = place_in(words_of(contents.label)) or given.sensor or contents.sensor
    if word == SETPOINT:
        raise InputError([Fault(where=where, message=Message("identify-setpoint-response"))])
    if sensor is None and output is Output.VELOCITY:
        sensor = Sensor.ENCODER
        said.append(Message("identify-sensor-assumed", name=where))
    if unit and output and unit.output is not output:
        message = Message(
            "identify-column-contradicts", name=str(contents.label or "re"), unit=contents.unit,
            signal=Message(f"identify-signal-{unit.output.value}"),
        )  # fmt: skip
        raise InputError([Fault(where=where, message=message)])
    missing = _missing(word, output, sensor, given)
    if missing or word not in _MISSING_NONE or output is None or sensor is None:
        found = contents.unit or Message("identify-no-unit")
        message = Message("identify-response-unknown", found=found, missing=missing)
        raise InputError([Fault(where=where, message=message)])
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
        input=Input.ACCELERATION if word == "acceleration" else Input.FORCE,
        output=output,
        sensor=sensor,
        rotary=rotary,
        remarks=tuple(said),
    )
    turn = given.motor_turn or contents.motor_turn
    return on_axis(check_response(response, contents.lines), given.rotary, turn)


_MISSING_NONE = ("force", "torque", "current", "acceleration")


def _missing(
    word: str, output: Output | None, sensor: Sensor | None, given: Given
) -> tuple[Message, ...]:
    """What must be said, and how."""
    missing = []
    if not word:
        missing.append(Message("identify-say-input"))
    if output is None:
        missing.append(Message("identify-say-output"))
    if sensor is None:
        missing.append(Message("identify-missing-sensor"))
    if word == "current" and given.constant is None:
        missing.append(Message("identify-say-constant"))
    return tuple(missing)


def check_response(response: FrequencyResponse, lines: Lines) -> FrequencyResponse:
    """Return a response whose lines can be used.

    Frequencies that fall are turned round, the line at 0 Hz is left out.

    Raises
    ------
    InputError
        With every fault of its numbers.
    """
    where = response.source.name
    order = np.arange(response.frequency_hz.size)
    if order.size > 1 and response.frequency_hz[0] > response.frequency_hz[-1]:
        order = order[::-1]
    if order.size and response.frequency_hz[order[0]] == 0.0:
        order = order[1:]
    frequency, values = response.frequency_hz[order], response.values[order]
    coherence = response.coherence[order] if response.coherence is not None else None
    kept = lines[order] if lines.size else lines
    fault = find_bad_frequency(frequency, kept, where=where)
    if fault is None and coherence is not None:
        fault = find_bad_coherence(coherence, kept, where=where)
    if fault is None and response.input is Input.FORCE:
        fault = find_rising(
            frequency,
            values,
            response.output.derivative,
            is_held=response.sensor is Sensor.TCP,
            where=where,
        )
    if fault:
        raise InputError([fault])
    remarks = response.remarks
    if coherence is not None:
        coherence = np.clip(coherence, 0.0, 1.0)
        if (coherence > PERFECT).all():
            coherence, remarks = None, (*remarks, Message("identify-perfect-coherence"))
    return replace(
        response, frequency_hz=frequency, values=values, coherence=coherence, remarks=remarks
    )


def on_axis(
    response: FrequencyResponse, rotary: bool | None, motor_turn: float
) -> FrequencyResponse:
    """Return a response as the axis of a profile has it, not its motor.

    Motor angle per torque becomes travel per force: with r radians per metre the force is r times
    the torque and the travel 1/r of the angle.

    Raises
    ------
    InputError
        Motor and axis do not go together.
    """
    if rotary is None or rotary == response.rotary or response.input is Input.ACCELERATION:
        return response
    if rotary or motor_turn <= 0.0:
        kind = "identify-linear-on-rotary" if rotary else "identify-rotary-on-linear"
        raise InputError([Fault(where=response.source.name, message=Message(kind))])
    return replace(
        response,
        values=response.values / motor_turn**2,
        rotary=False,
        remarks=(*response.remarks, Message("identify-motor-to-axis", turn=motor_turn)),
    )


def read_spectrum(
    contents: SpectrumContents, source: Source, given: Given, remarks: tuple[Message, ...]
) -> Spectrum:
    """Return a spectrum whose lines can be used; the line at 0 Hz is left out.

    Raise InputError with the fault of its lines.
    """
    kept = contents.frequency_hz > 0.0
    if not kept.all() and contents.frequency_hz[0] < 0.0:
        kept = np.ones_like(kept)
    frequency = contents.frequency_hz[kept]
    fault = find_bad_frequency(frequency, contents.lines[kept], where=source.name)
    if fault is None and not contents.density[kept].max() > 0.0:
        fault = Fault(where=source.name, message=Message("identify-all-zero"))
    if fault:
        raise InputError([fault])
    return Spectrum(
        source=source,
        frequency_hz=frequency,
        density=contents.density[kept],
        resolution_hz=contents.resolution_hz,
        averages=None,
        output=Output.ACCELERATION,
        sensor=given.sensor or Sensor.TCP,
        rotary=bool(given.rotary),
        remarks=remarks,
        all_directions=contents.all_directions,
    )
