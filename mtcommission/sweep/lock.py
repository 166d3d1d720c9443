"""One sweep at a time in a folder: a lock that dies with its process, however that ends.

The system holds the lock on an open file, so nothing is left to clean up after kill -9. Where a
file system has no locks (some network drives), there is none: the rows stay sound, each line being
written at once and checked when it is read, but two sweeps there would do their work twice.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message

NAME = ".lock"

TAKEN = {errno.EACCES, errno.EAGAIN, errno.EDEADLK}
"""How systems say that somebody else holds a lock."""

if sys.platform == "win32":
    import msvcrt

    def _take(file: BinaryIO) -> None:
        file.seek(FAR)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _take(file: BinaryIO) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


FAR = 1 << 20
"""Byte that is locked where locks keep others from reading: far behind the text."""


@contextmanager
def hold_folder(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of a folder as long as the block runs.

    Parameters
    ----------
    folder
        Made if it is missing.

    Raises
    ------
    InputError
        If another sweep is at work there, or the folder cannot be written.
    """
    path = folder / NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = path.open("a+b")
    except OSError as error:
        message = f"cannot write there ({error.strerror}); give another folder with -o"
        raise InputError(
            [Fault(where=str(folder), message=Message("verbatim", text=message))]
        ) from error
    with file:
        try:
            _take(file)
        except OSError as error:
            if error.errno in TAKEN:
                file.seek(0)
                who = file.read(20).decode(errors="replace").strip()
                message = (
                    f"another sweep is at work there{f' (process {who})' if who else ''}; "
                    "wait until it ends, or give another folder with -o"
                )
                raise InputError(
                    [Fault(where=str(folder), message=Message("verbatim", text=message))]
                ) from error
        _sign(file)
        yield


def _sign(file: BinaryIO) -> None:
    """Leave our number for the message; a full disk must not stop what needs no space."""
    try:
        file.truncate(0)
        file.write(str(os.getpid()).encode())
        file.flush()
    except OSError:
        return
