"""Measured files -> evidence: the one entry to everything that reads and estimates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from hashlib import sha256
from pathlib import Path, PurePath
from typing import NamedTuple

import numpy as np

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.averaged import average
from mtcommission.measured.formats.recognise import read_contents, read_measured
from mtcommission.measured.measurement import (
    MOTIONS,
    Array,
    Channel,
    Evidence,
    Finding,
    FrequencyResponse,
    Given,
    Item,
    ResponseContents,
    Sensor,
    Signal,
    Source,
    TimeContents,
    TimeRecord,
    refuse,
    within,
)
from mtcommission.measured.signals import read_record, read_response, read_spectrum, settle


def gather(files: Sequence[str], given: Given) -> Evidence:
    """Return what some files say about an axis.

    Raise InputError with every fault found: file, line, what was got, how to say what is missing.
    """
    findings: list[Finding] = []
    records: list[TimeRecord] = []
    faults: list[Fault] = []
    names: dict[bytes, str] = {}
    for text in files:
        name, response, sensor = split_name(text)
        try:
            data = read_measured(name)
            # As two measurements it would halve every interval.
            if (first := names.setdefault(sha256(data).digest(), text)) is not text:
                raise refuse(name, "identify-file-twice", other=first)
            one = replace(given, sensor=sensor or given.sensor)
            found, used = read_file(data, one, name=name, response=response)
            findings += found
            records += used
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    return Evidence(findings=tuple(findings), records=tuple(records))


class FileName(NamedTuple):
    """A file of the command line, FILE[@RESPONSE][@SENSOR]."""

    name: str
    response: str
    sensor: Sensor | None


def split_name(text: str) -> FileName:
    """Return the name of a file, and which of its responses and which sensor is said behind it."""
    name, _, said = text.rpartition("@")
    sensor = Sensor(said) if name and said in tuple(Sensor) else None
    text = name if sensor else text
    # A file's name with its ending, and a name without one.
    found = re.match(r"(.*\.\w+)@([\w\[\]-]+)$", text, re.DOTALL)
    if found and not Path(text).exists():
        return FileName(found[1], found[2], sensor)
    return FileName(text, "", sensor)


def read_file(
    data: bytes, given: Given, *, name: str, response: str = ""
) -> tuple[tuple[Finding, ...], tuple[TimeRecord, ...]]:
    """Return what one file says, and the time records it was estimated from.

    Raise InputError with every fault of the file, and what must be said about it.
    """
    contents = read_contents(data, given.columns, where=name, response=response)
    given, remarks = given.over(contents.said), contents.remarks
    source = Source(
        file=name,
        sha256=sha256(data).hexdigest(),
        is_klipper_raw=contents.is_klipper_raw,
        measured_on=contents.measured_on,
        state=contents.state,
    )
    findings: list[Finding] = []
    records: list[TimeRecord] = []
    faults: list[Fault] = []
    items = [item for item in contents.items if response in ("", item.label)]
    if not items:
        labels = ", ".join(item.label for item in contents.items)
        raise refuse(name, "identify-not-there", got=response, found=labels)
    for item in items:
        try:
            found, used = _read_item(item, replace(source, label=item.label), given, remarks)
            findings += found
            records += used
        except InputError as error:
            faults += error.faults
    # Of several records in a file (clocks of a scope) the ones that say nothing are no fault.
    if faults and not (findings and any(isinstance(i, TimeContents) for i in items)):
        raise InputError(faults)
    return tuple(findings), tuple(records)


def _read_item(
    item: Item, source: Source, given: Given, remarks: Sequence[Message]
) -> tuple[list[Finding], list[TimeRecord]]:
    """What one record, response or spectrum of a file says, and the record."""
    if isinstance(item, TimeContents):
        with within(source.file):
            record = read_record(item, source, given, remarks)
        return [_settled(one, given) for one in estimate(record, given)], [record]
    with within(source.name):
        if isinstance(item, ResponseContents):
            return [read_response(item, source, given, remarks)], []
        return [read_spectrum(item, source, given, remarks)], []


def _settled(found: Finding, given: Given) -> Finding:
    if not isinstance(found, FrequencyResponse):
        return found
    with within(found.source.name):
        return settle(found, given)


_NAME = re.compile(
    r"(?:resonances|calibration_data|raw_data|shaper_calibrate)_(?:axis=)?([xyz])(?![a-z])",
    re.IGNORECASE,
)
_BELT = re.compile(r"axis=-?[0-9.]+,-?[0-9.]+", re.IGNORECASE)
"""TEST_RESONANCES AXIS=1,1: a direction, as for comparing the belts of a CoreXY."""


def by_axis(files: Sequence[str]) -> dict[str, list[str]]:
    """Return the files of each axis that their names tell, in the order given.

    Raise InputError where one was recorded along a belt.
    """
    belts = [file for file in files if _BELT.search(PurePath(file).name)]
    if belts:
        raise InputError([Fault(where=one, message=Message("identify-of-belt")) for one in belts])
    told = [_NAME.search(PurePath(file).name) for file in files]
    found: dict[str, list[str]] = {}
    for file, name in zip(files, told, strict=True):
        axis = name[1].upper() if name and all(told) else ""
        found.setdefault(axis, []).append(file)
    return found


def of_axis(file: str, axis: str) -> str:
    """Return the name of a file that is written for one of several axes; "": for the only one."""
    path = PurePath(file)
    return (
        str(path.with_name(f"{path.stem}-{axis.lower()}{path.suffix}")) if file and axis else file
    )


_OF_A_FORCE = ("identify-no-reference", "identify-reference-silent", "identify-hold")
"""What is said of a force in a loop, and of one that is held between samples."""
LEAST_COHERENCE = 0.3
"""Median coherence below which a record has not measured the response of the input."""


def estimate(record: TimeRecord, given: Given) -> tuple[Finding, ...]:
    """Return what a record says about the axis, at least one finding.

    With a force it is a response: by blows, by periods, or by Welch; likewise from the motor's
    acceleration to the tool, if the user says so. Without either it is a free vibration if the
    signal dies away, else a spectrum. Raise InputError where it says too little.
    """
    motions = [c for c in record.channels if c.signal in MOTIONS]
    force = record.force
    if given.input == Signal.ACCELERATION:
        force = _shaking(record)
        motions = [c for c in motions if c.sensor is Sensor.TCP]
    elif force and force.signal is Signal.CURRENT and given.constant is None:
        raise _refusal(record, "identify-current-without-constant")
    if given.output is not None:
        motions = [c for c in motions if c.signal is given.output]
    motions = [c for c in motions if float(np.ptp(c.values)) > 0.0]
    if not motions:
        raise _refusal(record, "identify-no-motion")
    if force is None:
        from mtcommission.identify.unforced import find_unforced  # loads scipy.signal

        if unforced := find_unforced(record, motions):
            return unforced
        raise _refusal(record, "identify-nothing-rings")
    if float(np.ptp(force.values)) == 0.0:
        raise _refusal(record, "identify-no-excitation")
    found = [_response(record, force.values, one, given) for one in motions]
    return tuple(_best_of_each_sensor(found))


def _refusal(record: TimeRecord, kind: str) -> InputError:
    return refuse(record.source.name, kind, found=tuple(c.name for c in record.channels))


def _shaking(record: TimeRecord) -> Channel:
    """The acceleration of the motor, from which the modes on a held motor are excited."""
    for channel in record.channels:
        if channel.signal is Signal.ACCELERATION and channel.sensor is Sensor.ENCODER:
            return channel
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
    found = average(record.sample_time, force, motion.values, reference, found)
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
