"""One sweep at a time in a folder: a lock that dies with its process, however that ends.

The system holds the lock on an open file, so nothing is left to clean up after kill -9. Where a
file system has no locks (some network drives), there is none: the rows stay sound, each line being
written at once and checked when it is read, but two sweeps there would do their work twice.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from mtcommission.errors import Fault, InputError
from mtcommission.files import no_folder, replace_file
from mtcommission.messages.message import Message

NAME = ".mtcommission-sweep.lock"
OWNER = ".mtcommission-sweep.process"
"""Holds the number of the process: Windows lets nobody read a file that is locked."""

UNKNOWN = {errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP}
"""How file systems say that they have no locks."""


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
    for name in (NAME, OWNER):
        if (folder / name).is_symlink():
            raise no_folder(folder, Message("sweep-lock-is-link", name=name))
    lock, owner = FileLock(folder / NAME, timeout=0, fallback_to_soft=False), folder / OWNER
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout as error:
        raise InputError([Fault(where=str(folder), message=_in_use(owner))]) from error
    except OSError as error:
        if error.errno not in UNKNOWN:
            raise no_folder(folder, error) from error
    with suppress(OSError):  # a full disk must not stop what needs no space
        replace_file(owner, str(os.getpid()).encode())
    try:
        yield
    finally:
        lock.release()


def _in_use(owner: Path) -> Message:
    with suppress(OSError, ValueError):
        return Message("sweep-folder-in-use-by", process=str(int(owner.read_text()[:20])))
    return Message("sweep-folder-in-use")
