"""Machine profile (TOML) -> Machine: units to SI, every fault at once, with file and line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mtcommission.errors import Fault, InputError
from mtcommission.files import read_bytes
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.base_excited import BaseExcited
from mtcommission.plant.kinds import KINDS
from mtcommission.plant.modal import Modal
from mtcommission.plant.plant import OUTPUTS
from mtcommission.profile.build import build_machine
from mtcommission.profile.drive_tables import POSITION_SOURCE
from mtcommission.profile.faults import list_faults
from mtcommission.profile.lines import KeyPath, find_key_lines, show_key
from mtcommission.profile.model import MOST_ASSUMED, ProfileTable
from mtcommission.profile.plant_tables import MOTOR_HELD, PLANT_TABLES
from mtcommission.profile.syntax import load_toml
from mtcommission.profile.values import Context, describe, find_close, one_of
from mtcommission.units.axis_units import LINEAR, ROTARY, of_position_source
from mtcommission.units.quantities import Dimension

LARGEST_FILE = 200_000
"""Bytes; a profile has a few thousand. Each of its faults costs another reading."""


def read_profile(path: Path | str) -> Machine:
    """Return the machine that a profile file describes.

    Parameters
    ----------
    path
        TOML file in UTF-8, with or without byte order mark.

    Returns
    -------
    Machine
        SI.

    Raises
    ------
    InputError
        With every fault found.
    """
    return parse_profile(read_profile_text(path), where=str(path))


def read_profile_text(path: Path | str) -> str:
    """Return the text of a profile file, without byte order mark.

    Parameters
    ----------
    path
        TOML file in UTF-8.

    Raises
    ------
    InputError
        If the file cannot be read as text.
    """
    return decode_profile(read_profile_bytes(path), where=str(path))


def read_profile_bytes(path: Path | str) -> bytes:
    """Return a profile file as it is; raise InputError if it cannot be read."""
    return read_bytes(Path(path), folder=Message("file-is-directory"), most=LARGEST_FILE + 1)


def decode_profile(data: bytes, *, where: str) -> str:
    """Return the text of a profile's bytes, without byte order mark.

    Parameters
    ----------
    data
        From ``read_profile_bytes``.
    where
        Name for messages.

    Raises
    ------
    InputError
        If they are no text of a profile's size.
    """
    if data.lstrip()[:1] == b"{":
        raise _file_fault(where, Message("file-is-json"))
    if len(data) > LARGEST_FILE:
        raise _file_fault(where, Message("file-too-large", most=LARGEST_FILE))
    if b"\0" in data:
        raise _file_fault(where, Message("file-binary"))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = Message("file-not-utf8", byte=f"0x{data[error.start]:02x}")
        raise InputError([Fault(where=where, line=line, message=message)]) from error


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileSource:
    """A profile as it stood in its file.

    Parameters
    ----------
    path
        Of the file; what was measured stands beside it.
    sha256
        Of its bytes, 64 hexadecimal digits.
    text
        Without byte order mark.
    """

    path: Path
    sha256: str
    text: str


def read_source(path: Path | str) -> ProfileSource:
    """Return a profile's text and hash, from one reading: a pipe gives it only once.

    Parameters
    ----------
    path
        TOML file in UTF-8.

    Raises
    ------
    InputError
        If the file cannot be read as text.
    """
    data = read_profile_bytes(path)
    text = decode_profile(data, where=str(path))
    return ProfileSource(path=Path(path), sha256=profile_text_hash(data), text=text)


def profile_text_hash(data: bytes) -> str:
    """Return the SHA-256 of a profile's bytes, as 64 hexadecimal digits.

    Parameters
    ----------
    data
        The file as it is on disk.

    Examples
    --------
    >>> profile_text_hash(b"")[:8]
    'e3b0c442'
    """
    return sha256(data).hexdigest()


def parse_profile(text: str, *, where: str) -> Machine:
    """Return the machine that a profile text describes.

    Parameters
    ----------
    text
        TOML.
    where
        Name for messages, e.g. the file name.

    Returns
    -------
    Machine
        SI.

    Raises
    ------
    InputError
        With every fault found, ordered by line.
    """
    if not text.strip():
        raise InputError([Fault(where=where, line=1, message=Message("file-empty"))])
    parsed = load_toml(text, where=where)
    data, wrong_kind = _mend_kind(parsed.data)
    data = _hold_motor(data)
    faults, lines = list(parsed.faults), find_key_lines(parsed.text)
    if wrong_kind:
        line = lines.line_of(("plant", "kind"))
        faults.append(Fault(where=where, line=line, key="plant.kind", message=wrong_kind))
    for path, wrong_key in _misspelt(parsed.data):
        line = lines.line_of(path)
        faults.append(Fault(where=where, line=line, key=show_key(path), message=wrong_key))
    refused = {fault.line for fault in parsed.faults}
    try:
        table = ProfileTable.model_validate(data, context=_context(data))
    except ValidationError as error:
        found = list_faults(error, where=where, lines=lines)
        # What stands in a line that is no TOML has been said already.
        faults += [fault for fault in found if fault.line not in refused]
        raise InputError(sorted(faults, key=lambda fault: fault.line)) from error
    if faults:
        raise InputError(faults)
    return build_machine(table)


def profile_schema() -> str:
    """Return the JSON schema of profiles, as JSON text.

    Returns
    -------
    str
        Quantities carry their SI unit as ``x-unit`` and ``x-unit-rotary``.

    Examples
    --------
    >>> json.loads(profile_schema())["title"]
    'ProfileTable'
    """
    schema = ProfileTable.model_json_schema(by_alias=True)
    # Two of the plant's tables are of one kind, so its keys tell them apart, not the tag.
    schema["properties"]["plant"].pop("discriminator")
    return json.dumps(schema, indent=2)


def _file_fault(where: str, message: Message) -> InputError:
    return InputError([Fault(where=where, message=message)])


def _mend_kind(data: dict[str, Any]) -> tuple[dict[str, Any], Message | None]:
    """Return the data with the likeliest kind of plant, and what is wrong with the one given.

    Without a kind nothing else in [plant] could be checked.
    """
    plant = data.get("plant")
    given = plant.get("kind", "") if isinstance(plant, dict) else ""
    if not isinstance(plant, dict) or (isinstance(given, str) and given in KINDS):
        return data, None
    kind = find_close(given, KINDS) if isinstance(given, str) else ""
    shared = {name: sum(key in PLANT_TABLES[name].model_fields for key in plant) for name in KINDS}
    kind = kind or max(shared, key=lambda name: shared[name])
    if "kind" in plant:
        hint = Message("hint-did-you-mean", name=kind)
        words = one_of(tuple(KINDS))
        wrong = Message("got-other-word-for", got=describe(given), words=words, hint=hint)
    else:
        wrong = Message("key-missing", remedy=Message("add-kind-of-keys", kind=kind))
    return {**data, "plant": {**plant, "kind": kind}}, wrong


def _hold_motor(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data with a modal plant tagged that stands below a motor that follows."""
    plant, drive = data.get("plant"), data.get("drive")
    follows = isinstance(drive, dict) and drive.get("kind") == POSITION_SOURCE
    if follows and isinstance(plant, dict) and plant["kind"] == Modal.kind:
        return {**data, "plant": {**plant, "kind": MOTOR_HELD}}
    return data


def _misspelt(data: dict[str, Any]) -> Iterator[tuple[KeyPath, Message]]:
    """Keys in machine.assumed that the profile does not state, and what is wrong with each."""
    machine = data.get("machine")
    named = machine.get("assumed") if isinstance(machine, dict) else None
    stated = [show_key(path) for path in _paths(data) if path[:2] != ("machine", "assumed")]
    for place, key in enumerate(named[:MOST_ASSUMED] if isinstance(named, list) else ()):
        if isinstance(key, str) and key not in stated:
            close = find_close(key, stated)
            hint = Message("hint-did-you-mean", name=close) if close else Message("hint-key")
            yield ("machine", "assumed", place), Message("key-not-stated", got=key, hint=hint)


def _paths(value: object, path: KeyPath = ()) -> Iterator[KeyPath]:
    """The path of every table, array and value."""
    if path:
        yield path
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _paths(inner, (*path, name))
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from _paths(inner, (*path, place))


def _context(data: Mapping[str, Any]) -> Context:
    """Return what values depend on, from data that may still be wrong."""
    machine, plant = data.get("machine"), data.get("plant")
    is_rotary = isinstance(machine, dict) and machine.get("motion") == "rotary"
    axis = ROTARY if is_rotary else LINEAR
    states: dict[str, Dimension] = {}
    if isinstance(plant, dict) and (table := PLANT_TABLES.get(plant["kind"])):
        kind = table.data_type
        modes = plant.get("modes")
        tables = modes if isinstance(modes, list) else []
        names = [str(mode.get("name")) for mode in tables if isinstance(mode, dict)]
        measured = of_position_source(axis) if kind is BaseExcited else axis
        states = kind.states(names, measured)
    outputs = dict.fromkeys(OUTPUTS, axis.length)
    return Context(axis=axis, states=states, outputs=outputs)
