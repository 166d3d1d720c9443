"""Files -> text, whatever the control's encoding -> what they hold, by the reader of their format.

The format is told by the content alone.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

from mtcommission.base.files import read_bytes
from mtcommission.base.messages.message import Message
from mtcommission.measured.formats.klipper import header_of, read_klipper
from mtcommission.measured.formats.plain import PERIOD, read_halscope, read_plain
from mtcommission.measured.formats.sinumerik import read_sinumerik
from mtcommission.measured.formats.twincat import is_twincat, read_twincat
from mtcommission.measured.formats.uff import is_uff, read_uff
from mtcommission.measured.measurement import FileContents, broken, within

LARGEST_FILE = 64_000_000
"""Bytes; a minute of ten signals at 8 kHz has half of it."""
LONGEST_LINE = 20_000
"""Characters; keeps a file without line ends from costing memory."""
_MARKS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
_BINARY = (
    (b"PK\x03\x04", "xlsx, zip"), (b"%PDF", "PDF"), (b"\x1f\x8b", "gzip"), (b"TDSm", "TDMS"),
    (b"MATLAB 5", "MAT"), (b"\x89HDF", "HDF5, MAT"), (b"\xd0\xcf\x11\xe0", "xls"),
)  # fmt: skip


def read_measured(name: str) -> bytes:
    """Return the bytes of a file, "-" for standard input; at most one more than is allowed."""
    if name == "-":
        return sys.stdin.buffer.read(LARGEST_FILE + 1)
    return read_bytes(Path(name), folder=Message("identify-file-is-folder"), most=LARGEST_FILE + 1)


def read_contents(
    data: bytes, columns: Mapping[str, str], *, where: str, response: str = ""
) -> FileContents:
    """Return what a file holds; ``where``: its name."""
    with within(where):
        if len(data) > LARGEST_FILE:
            raise broken("identify-file-too-large", most=LARGEST_FILE)
        for mark, name in _BINARY:
            if data.startswith(mark):
                raise broken("identify-file-foreign", format=name)
        if is_uff(data):
            return read_uff(data)
        text = _decode(data)
        if text.lstrip().startswith("<"):
            return read_sinumerik(data, response, file=where)
        lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        for number, line in enumerate(lines, start=1):
            if len(line) > LONGEST_LINE:
                raise broken("identify-line-too-long", line=number, most=LONGEST_LINE)
        if PERIOD.match(lines[0]):
            return read_halscope(lines)
        if is_twincat(lines):
            return read_twincat(lines)
        if header_of(lines):
            return read_klipper(lines)
        return read_plain(lines, columns)


def _decode(data: bytes) -> str:
    """The text of a file: UTF-8, UTF-16 with its mark, else Windows-1252."""
    if not data.strip():
        raise broken("identify-file-empty")
    marked = next((coding for mark, coding in _MARKS.items() if data.startswith(mark)), "")
    try:
        text = data.decode(marked or "utf-8", errors="replace" if marked else "strict")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    if "\0" in text:
        raise broken("identify-file-binary")
    return text.replace("\N{MINUS SIGN}", "-")
