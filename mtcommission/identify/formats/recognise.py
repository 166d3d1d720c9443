"""Which format a file has, by its content alone."""

from __future__ import annotations

from collections.abc import Mapping

from mtcommission.identify.formats.contents import FileContents, refuse
from mtcommission.identify.formats.klipper import header_of, read_klipper
from mtcommission.identify.formats.linuxcnc import PERIOD, read_halscope
from mtcommission.identify.formats.plain import read_plain
from mtcommission.identify.formats.sinumerik import read_sinumerik
from mtcommission.identify.formats.text import LARGEST_FILE, decode, lines_of
from mtcommission.identify.formats.twincat import is_twincat, read_twincat
from mtcommission.identify.formats.uff import is_uff, read_uff

_BINARY = (
    (b"PK\x03\x04", "xlsx, zip"), (b"%PDF", "PDF"), (b"\x1f\x8b", "gzip"), (b"TDSm", "TDMS"),
    (b"MATLAB 5", "MAT"), (b"\x89HDF", "HDF5, MAT"), (b"\xd0\xcf\x11\xe0", "xls"),
)  # fmt: skip


def read_contents(
    data: bytes, columns: Mapping[str, str], *, where: str, response: str = ""
) -> FileContents:
    """Return what a file holds.

    Raise InputError where no reader knows it, or the one that does finds it broken.
    """
    if len(data) > LARGEST_FILE:
        raise refuse(where, "identify-file-too-large", most=LARGEST_FILE)
    for mark, name in _BINARY:
        if data.startswith(mark):
            raise refuse(where, "identify-file-foreign", format=name)
    if is_uff(data):
        return read_uff(data, where=where)
    text = decode(data, where=where)
    if text.lstrip().startswith("<"):
        return read_sinumerik(data, where=where, response=response)
    lines = lines_of(text, where=where)
    if PERIOD.match(lines[0]):
        return read_halscope(lines, where=where)
    if is_twincat(lines):
        return read_twincat(lines, where=where)
    if header_of(lines):
        return read_klipper(lines, where=where)
    return read_plain(lines, columns, where=where)
