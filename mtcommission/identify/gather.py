"""Measured files -> evidence: the one entry to everything that reads and estimates."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from mtcommission.base.errors import Fault, InputError
from mtcommission.identify.formats.contents import ResponseContents, TimeContents, refuse
from mtcommission.identify.formats.recognise import read_contents, read_measured
from mtcommission.identify.given import Given
from mtcommission.identify.meaning.record import read_record
from mtcommission.identify.meaning.responses import read_response, read_spectrum, settle
from mtcommission.identify.measurement import (
    Evidence,
    Finding,
    FrequencyResponse,
    Sensor,
    Source,
    TimeRecord,
)
from mtcommission.identify.responses.estimate import estimate


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
    """Return the name of a file, and which of its responses and which sensor is said behind it.

    Examples
    --------
    >>> split_name("a@b.csv@tcp")
    FileName(name='a@b.csv', response='', sensor=<Sensor.TCP: 'tcp'>)
    >>> split_name("a.xml@m_pPlant[1]")
    FileName(name='a.xml', response='m_pPlant[1]', sensor=None)
    """
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
        format=contents.format,
        measured_on=contents.measured_on,
        state=contents.state,
    )
    findings: list[Finding] = []
    records: list[TimeRecord] = []
    faults: list[Fault] = []
    items = [item for item in contents.items if response in ("", item.label)]
    if not items:
        labels = ", ".join(item.label for item in contents.items)
        raise refuse(name, "identify-no-such-response", got=response, names=labels)
    for item in items:
        own = replace(source, label=item.label)
        try:
            if isinstance(item, TimeContents):
                record = read_record(item, own, given, remarks)
                findings += [
                    settle(one, given) if isinstance(one, FrequencyResponse) else one
                    for one in estimate(record, given)
                ]
                records.append(record)
            elif isinstance(item, ResponseContents):
                findings.append(read_response(item, own, given, remarks))
            else:
                findings.append(read_spectrum(item, own, given, remarks))
        except InputError as error:
            faults += error.faults
    # Of several records in a file (clocks of a scope) the ones that say nothing are no fault.
    if faults and not (findings and any(isinstance(i, TimeContents) for i in items)):
        raise InputError(faults)
    return tuple(findings), tuple(records)
