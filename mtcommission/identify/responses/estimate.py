"""A time record -> what it says: the way that fits its excitation, and why it was taken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.formats.contents import refuse
from mtcommission.identify.given import Given
from mtcommission.identify.measurement import (
    FORCES,
    MOTIONS,
    Array,
    Channel,
    Finding,
    FrequencyResponse,
    Sensor,
    Signal,
    TimeRecord,
)
from mtcommission.identify.responses.averaged import by_blows, by_periods, by_windows, prepare
from mtcommission.identify.responses.excitation import find_blows, find_period

_OF_A_FORCE = ("identify-no-reference", "identify-reference-silent", "identify-hold")
"""What is said of a force in a loop, and of one that is held between samples."""

LEAST_COHERENCE = 0.3
"""Median coherence below which a record has not measured the response of the input."""

HOLD = 0.078
"""Share of the sampling frequency at which a hold takes 1 %: sin(π x)/(π x) = 0.99."""


def estimate(record: TimeRecord, given: Given) -> tuple[Finding, ...]:
    """Return what a record says about the axis, at least one finding.

    With a force it is a response: by blows, by periods, or by Welch; likewise from the motor's
    acceleration to the tool, if the user says so. Without either it is a free vibration if the
    signal dies away, else a spectrum. Raise InputError where it says too little.
    """
    motions = [c for c in record.channels if c.signal in MOTIONS]
    force: Array | None
    if given.input == Signal.ACCELERATION:
        force = _shaking(record)
        motions = [c for c in motions if c.sensor is Sensor.TCP]
    else:
        force = _force(record, given)
    if given.output is not None:
        motions = [c for c in motions if c.signal is given.output]
    motions = [c for c in motions if float(np.ptp(c.values)) > 0.0]
    if not motions:
        raise _refusal(record, "identify-no-motion")
    if force is None:
        from mtcommission.identify.responses.unforced import find_unforced  # loads scipy.signal

        found = find_unforced(record, motions)
        if not found:
            raise _refusal(record, "identify-nothing-rings")
        return found
    if float(np.ptp(force)) == 0.0:
        raise _refusal(record, "identify-no-excitation")
    return tuple(_best_of_each_sensor([_response(record, force, one, given) for one in motions]))


def _refusal(record: TimeRecord, kind: str) -> InputError:
    return refuse(record.source.name, kind, found=tuple(c.name for c in record.channels))


def _force(record: TimeRecord, given: Given) -> Array | None:
    """The force or torque that acts [SI], None where none was recorded."""
    channels = [c for c in record.channels if c.signal in FORCES]
    if not channels:
        return None
    chosen = min(channels, key=lambda c: (c.signal != given.input, FORCES.index(c.signal)))
    if chosen.signal is Signal.CURRENT and given.constant is None:
        raise _refusal(record, "identify-current-without-constant")
    return chosen.values if given.constant is None else given.constant * chosen.values


def _shaking(record: TimeRecord) -> Array:
    """The acceleration of the motor, from which the modes on a held motor are excited."""
    for channel in record.channels:
        if channel.signal is Signal.ACCELERATION and channel.sensor is Sensor.ENCODER:
            return channel.values
    raise _refusal(record, "identify-no-motor-acceleration")


def _response(record: TimeRecord, force: Array, motion: Channel, given: Given) -> FrequencyResponse:
    reference, none = record.reference, np.zeros(0)
    if reference is not None and float(np.ptp(reference)) == 0.0:
        reference = None
    by_force = given.input != Signal.ACCELERATION
    others = (c.rotary for c in record.channels if c.signal in (Signal.FORCE, Signal.TORQUE))
    told = next((one for one in (motion.rotary, *others) if one is not None), given.rotary)
    found = FrequencyResponse(
        source=record.source_of(motion),
        frequency_hz=none,
        values=none.astype(np.complex128),
        coherence=none,
        averages=None,
        resolution_hz=None,
        input=Signal.FORCE if by_force else Signal.ACCELERATION,
        output=motion.signal,
        sensor=motion.sensor or Sensor.ENCODER,
        rotary=bool(told),
        remarks=record.remarks,
    )
    signals = prepare(record.sample_time, force, motion.values, reference, found)
    if blows := find_blows(signals.input, signals.step):
        found = by_blows(signals, blows)
    else:
        period = find_period(signals.input)
        if not period and signals.reference is not None:
            period = find_period(signals.reference)
        found = by_periods(signals, period) if period else by_windows(signals)
        found = found.say(Message("identify-hold", limit=HOLD / signals.step))
    coherence = found.coherence
    if coherence is None or not coherence.size or np.quantile(coherence, 0.9) < LEAST_COHERENCE:
        raise _refusal(record, "identify-incoherent")
    if not by_force:
        kept = tuple(one for one in found.remarks if one.kind not in _OF_A_FORCE)
        found = replace(found, remarks=kept)
    if found.averages == 1.0:  # which has no coherence
        found = replace(found, coherence=None, averages=None)
    return found


def _best_of_each_sensor(found: Sequence[FrequencyResponse]) -> Iterator[FrequencyResponse]:
    """Position and rate of one sensor are one measurement: the clearer of them."""
    for sensor in dict.fromkeys(response.sensor for response in found):
        same = [response for response in found if response.sensor is sensor]
        best = max(same, key=_clarity)
        others = tuple(response.source.label for response in same if response is not best)
        yield best.say(Message("identify-same-sensor", names=others)) if others else best


def _clarity(response: FrequencyResponse) -> float:
    return float(np.median(response.coherence)) if response.coherence is not None else 0.0
