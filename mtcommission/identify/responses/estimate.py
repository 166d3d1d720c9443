"""A time record -> what it says: the way that fits its excitation, and why it was taken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mtcommission.errors import Fault, InputError
from mtcommission.identify.given import Given
from mtcommission.identify.measurement import (
    FORCES,
    MOTIONS,
    Array,
    Channel,
    Finding,
    FreeVibration,
    FrequencyResponse,
    Input,
    Output,
    Sensor,
    Signal,
    Spectrum,
    TimeRecord,
)
from mtcommission.identify.responses.averaged import (
    Estimate,
    Signals,
    by_blows,
    by_periods,
    by_windows,
    prepare,
)
from mtcommission.identify.responses.excitation import find_blows, find_period
from mtcommission.messages.message import Message

_OF_A_FORCE = ("identify-no-reference", "identify-reference-silent", "identify-hold")
"""What is said of a force in a loop, and of one that is held between samples."""

LEAST_COHERENCE = 0.3
"""Median coherence below which a record has not measured the response of the input."""

HOLD = 0.078
"""Share of the sampling frequency at which a hold takes 1 %: sin(π x)/(π x) = 0.99."""

KLIPPER_RAW = "identify-format-klipper-raw"


def estimate(record: TimeRecord, given: Given) -> tuple[Finding, ...]:
    """Return what a record says about the axis, at least one finding.

    With a force it is a response: by blows, by periods, or by Welch; likewise from the motor's
    acceleration to the tool, if the user says so. Without either it is a free vibration if the
    signal dies away, else a spectrum.

    Raises
    ------
    InputError
        The record has no signal of use, or says too little.
    """
    motions = [c for c in record.channels if c.signal in MOTIONS]
    force: Array | None
    if given.input == Input.ACCELERATION:
        force = _shaking(record)
        motions = [c for c in motions if c.sensor is Sensor.TCP]
    else:
        force = _force(record, given)
    if given.output is not None:
        motions = [c for c in motions if c.signal.value == given.output.value]
    motions = [c for c in motions if float(np.ptp(c.values)) > 0.0]
    if not motions:
        raise _refusal(record, "identify-no-motion")
    if force is None:
        return tuple(_free(record, motions))
    if float(np.ptp(force)) == 0.0:
        raise _refusal(record, "identify-no-excitation")
    found = [_response(record, force, motion, given) for motion in motions]
    return tuple(_best_of_each_sensor(found))


def _refusal(record: TimeRecord, kind: str) -> InputError:
    names = tuple(channel.name for channel in record.channels)
    return InputError([Fault(where=record.source.name, message=Message(kind, found=names))])


def _force(record: TimeRecord, given: Given) -> Array | None:
    """The force or torque that acts [SI], None where none was recorded."""
    channels = [c for c in record.channels if c.signal in FORCES]
    if given.input in ("force", "torque", "current"):
        same = [c for c in channels if c.signal.value == given.input]
        channels = same or channels
    if not channels:
        return None
    if len(channels) > 1:
        order = {signal: place for place, signal in enumerate(FORCES)}
        channels.sort(key=lambda channel: order[channel.signal])
    chosen = channels[0]
    if chosen.signal is Signal.CURRENT and given.constant is None:
        raise _refusal(record, "identify-current-without-constant")
    factor = 1.0 if given.constant is None else given.constant
    return factor * chosen.values


def _shaking(record: TimeRecord) -> Array:
    """The acceleration of the motor, from which the modes on a held motor are excited."""
    for channel in record.channels:
        if channel.signal is Signal.ACCELERATION and channel.sensor is Sensor.ENCODER:
            return channel.values
    raise _refusal(record, "identify-no-motor-acceleration")


def _response(record: TimeRecord, force: Array, motion: Channel, given: Given) -> FrequencyResponse:
    kind = Output(motion.signal.value)
    reference = next((c.values for c in record.channels if c.signal is Signal.REFERENCE), None)
    if reference is not None and float(np.ptp(reference)) == 0.0:
        reference = None
    signals = prepare(record.sample_time, force, motion.values, reference, kind=kind)
    lines, remarks = _lines(signals)
    if given.input == Input.ACCELERATION:
        remarks = [one for one in remarks if one.kind not in _OF_A_FORCE]
    coherence = lines.coherence
    if not coherence.size or float(np.quantile(coherence, 0.9)) < LEAST_COHERENCE:
        raise _refusal(record, "identify-incoherent")
    return FrequencyResponse(
        source=replace(record.source, label=_label(record, motion)),
        frequency_hz=lines.frequency_hz,
        values=lines.values,
        coherence=coherence if lines.averages > 1.0 else None,
        averages=lines.averages if lines.averages > 1.0 else None,
        resolution_hz=lines.resolution_hz,
        input=Input.ACCELERATION if given.input == Input.ACCELERATION else Input.FORCE,
        output=kind,
        sensor=motion.sensor or Sensor.ENCODER,
        rotary=_rotary(record, motion, given),
        remarks=(*record.remarks, *remarks),
    )


def _label(record: TimeRecord, motion: Channel) -> str:
    return " ".join(part for part in (record.source.label, motion.name) if part)


def _rotary(record: TimeRecord, motion: Channel, given: Given) -> bool:
    told = motion.rotary
    if told is None:
        others = (c.rotary for c in record.channels if c.signal in (Signal.FORCE, Signal.TORQUE))
        told = next((one for one in others if one is not None), given.rotary)
    return bool(told)


def _lines(signals: Signals) -> Estimate:
    """The response in lines, by the way that fits the excitation, and what is to be said of it."""
    if blows := find_blows(signals.input, signals.step):
        return by_blows(signals, blows)
    period = find_period(signals.input)
    if not period and signals.reference is not None:
        period = find_period(signals.reference)
    lines, said = by_periods(signals, period) if period else by_windows(signals)
    return lines, [*said, Message("identify-hold", limit=HOLD / signals.step)]


def _best_of_each_sensor(found: Sequence[FrequencyResponse]) -> Iterator[FrequencyResponse]:
    """Position and rate of one sensor are one measurement: the clearer of them."""
    for sensor in dict.fromkeys(response.sensor for response in found):
        same = [response for response in found if response.sensor is sensor]
        best = max(same, key=_clarity)
        others = tuple(response.source.label for response in same if response is not best)
        said = (Message("identify-same-sensor", names=others),) if others else ()
        yield replace(best, remarks=(*best.remarks, *said))


def _clarity(response: FrequencyResponse) -> float:
    return float(np.median(response.coherence)) if response.coherence is not None else 0.0


def _free(record: TimeRecord, motions: Sequence[Channel]) -> Iterator[Finding]:
    # With scipy.signal, which is slow to load.
    from mtcommission.identify.responses.free_vibration import (
        begins,
        find_start,
        fit_ringing,
        is_decay,
    )
    from mtcommission.identify.responses.power import estimate_power, power_as_klipper

    reference = next((c.values for c in record.channels if c.signal is Signal.REFERENCE), None)
    found: list[Finding] = []
    for motion in motions:
        start = find_start(reference, motion.values)
        rest = motion.values[start:]
        seen: dict[str, Any] = {
            "source": replace(record.source, label=_label(record, motion)),
            "output": Output(motion.signal.value),
            "sensor": motion.sensor or Sensor.ENCODER,
            "rotary": bool(motion.rotary),
        }
        is_free = reference is not None or begins(motion.values, start)
        if rest.size >= 64 and is_free and is_decay(rest):
            ringing = fit_ringing(rest, record.sample_time)
            if ringing.modes:
                said = Message(
                    "identify-by-decay",
                    start=start * record.sample_time,
                    duration=ringing.duration,
                    explained=ringing.explained,
                )
                more = (Message("identify-loop-in-decay"),) if reference is not None else ()
                remarks = (*record.remarks, said, *more)
                found.append(FreeVibration(modes=ringing.modes, remarks=remarks, **seen))
                continue
        if motion.signal is Signal.ACCELERATION:
            power = estimate_power(motion.values, record.sample_time)
            remarks = (*record.remarks, Message("identify-by-power"))
            found.append(Spectrum(remarks=remarks, **seen, **power._asdict()))
    spectra = [one for one in found if isinstance(one, Spectrum)]
    if len(spectra) > 1:  # of one sensor's directions the one that shakes most
        loudest = max(spectra, key=lambda one: float(one.density.max()))
        whole = power_as_klipper(record) if record.source.format.kind == KLIPPER_RAW else None
        found = [
            replace(loudest, all_directions=whole) if one is loudest else one
            for one in found
            if not isinstance(one, Spectrum) or one is loudest
        ]
    if not found:
        raise _refusal(record, "identify-nothing-rings")
    yield from found
