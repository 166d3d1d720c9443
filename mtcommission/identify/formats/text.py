"""Files -> bytes -> lines of text, whatever the control's encoding."""

from __future__ import annotations

import sys
from pathlib import Path

from mtcommission.files import read_bytes
from mtcommission.identify.formats.contents import refuse
from mtcommission.messages.message import Message

LARGEST_FILE = 64_000_000
"""Bytes; a minute of ten signals at 8 kHz has half of it."""

LONGEST_LINE = 20_000
"""Characters; keeps a file without line ends from costing memory."""

_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)


def read_measured(name: str) -> bytes:
    """Return the bytes of a file, "-" for standard input; at most one more than is allowed."""
    if name == "-":
        return sys.stdin.buffer.read(LARGEST_FILE + 1)
    return read_bytes(Path(name), folder=Message("identify-file-is-folder"), most=LARGEST_FILE + 1)


def decode(data: bytes, *, where: str) -> str:
    r"""Return the text of a file: UTF-8, UTF-16 with its mark, else Windows-1252.

    Raise InputError where it is empty or no text.

    Examples
    --------
    >>> decode(b"\xff\xfet\x00", where="a.csv")
    't'
    """
    if not data.strip():
        raise refuse(where, "identify-file-empty")
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            text = data.decode(encoding, errors="replace")
            break
    else:
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError:
            text = data.decode("cp1252", errors="replace")
    if "\0" in text:
        raise refuse(where, "identify-file-binary")
    return text.replace("\N{MINUS SIGN}", "-")


def lines_of(text: str, *, where: str) -> list[str]:
    """Return the lines of a text; raise InputError where one is far longer than any table's."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for number, line in enumerate(lines, start=1):
        if len(line) > LONGEST_LINE:
            raise refuse(where, "identify-line-too-long", line=number, most=LONGEST_LINE)
    return lines
