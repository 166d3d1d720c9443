"""Finished cases on disk: a log that is only appended to, usable after any interruption.

Each line holds the answers of one piece of work behind a checksum, says whose sweep it is, and is
synchronised to disk before the next. A line that is torn or damaged counts as not there: its cases
are computed again. One sweep at a time works in a folder: a lock that the system holds on an open
file, so that nothing is left to clean up after kill -9. Where a file system has no locks (some
network drives) two sweeps would do their work twice; the rows stay sound.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO
from zlib import crc32

from filelock import FileLock, Timeout

from mtcommission.base.errors import InputError
from mtcommission.base.files import no_folder, replace_file
from mtcommission.base.messages.message import Message
from mtcommission.sweep.solve import Answer

NAME = "mtcommission-sweep.log"
LOCK = ".mtcommission-sweep.lock"

NO_LOCKS = {errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP}
"""How file systems say that they have no locks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """The log of one sweep."""

    path: Path
    plan: str  # hash of what is computed
    created: str  # when the sweep was begun

    def append(self, piece: int, answers: Sequence[Answer]) -> None:
        """Write the answers of one piece, without records, and wait until they are on the disk.

        Raises InputError: the disk is full or gone; the file is as long as before.
        """
        kept = [(one.cells, one.outcome, one.message) for one in answers]
        text = json.dumps([self.plan, self.created, piece, kept], separators=(",", ":")).encode()
        try:
            _append_line(self.path, _checksum(text) + text + b"\n")
        except OSError as error:
            raise _disk_full(self.path, error) from error

    def pieces(self) -> Iterator[tuple[int, tuple[Answer, ...]]]:
        """Yield number and answers of the finished pieces, in the order in which they came in."""
        for _, _, piece, answers in _entries(self.path):
            kept = (Answer(cells=tuple(cells), outcome=o, message=m) for cells, o, m in answers)
            yield piece, tuple(kept)


def open_store(
    folder: Path, *, digest: str, created: str, resume: bool, results: Sequence[str]
) -> Store:
    """Return the store of a folder, which is made if it is missing, new or continued.

    ``results`` are files that a sweep leaves; where they are without a store, somebody else wrote
    them. A continued sweep keeps its first date; one that ended before its first row begins anew.

    Raises InputError: there are rows already and ``resume`` was not asked for, they belong to
    another sweep, there are files that no sweep of ours wrote, or the folder cannot be written.
    """
    path = folder / NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = (NAME,) if os.path.lexists(path) else results
        foreign = [name for name in names if os.path.lexists(folder / name) and not _is_log(path)]
        if foreign:
            raise InputError.at(
                str(folder), Message("sweep-folder-holds-foreign", names=", ".join(foreign))
            )
        begun = [(plan, date) for plan, date, *_ in _entries(path)]
        if begun and not resume:
            raise InputError.at(str(folder), Message("sweep-folder-holds-one"))
        if any(plan != digest for plan, _ in begun):
            raise InputError.at(str(folder), Message("sweep-folder-holds-another"))
        if not begun:
            path.unlink(missing_ok=True)
    except OSError as error:
        raise no_folder(folder, error) from error
    return Store(path=path, plan=digest, created=begun[0][1] if begun else created)


def _is_log(path: Path) -> bool:
    """Whether a line of ours is there, or nothing but the torn first one."""
    if not path.is_file() or path.is_symlink():
        return False
    data = path.read_bytes()
    return b"\n" not in data or any(line[8:10] == b" [" for line in data.split(b"\n"))


def _entries(path: Path) -> Iterator[Any]:
    """Plan, date, piece and answers of the sound lines of a log, if there is one."""
    if path.exists():
        with path.open("rb") as file:
            for line in file:
                text = line[9:-1]
                if line.endswith(b"\n") and line[:9] == _checksum(text):
                    yield json.loads(text)


def _append_line(path: Path, line: bytes) -> None:
    """Append one line; on failure the file is as long as before."""
    with path.open("a+b", buffering=0) as file:
        before = file.seek(0, os.SEEK_END)
        if before:
            file.seek(before - 1)
            line = line if file.read(1) == b"\n" else b"\n" + line  # the last line is torn
        try:
            while line:
                line = line[file.write(line) :]
            os.fsync(file.fileno())
        except OSError:
            file.truncate(before)
            raise


def _checksum(text: bytes) -> bytes:
    return b"%08x " % crc32(text)


def write_safely(path: Path, content: bytes | Callable[[BinaryIO], object]) -> None:
    """Write a file of a sweep as a whole; raise InputError: it cannot be, all rows are kept."""
    try:
        path.parent.mkdir(exist_ok=True)
        replace_file(path, content)
    except OSError as error:
        raise _disk_full(path, error) from error


def _disk_full(path: Path, error: OSError) -> InputError:
    return InputError.at(str(path), Message("sweep-disk-full", reason=str(error.strerror)))


@contextmanager
def hold_folder(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of a folder, made if it is missing, as long as the block runs.

    Raises InputError: another sweep is at work there, or the folder cannot be written.
    """
    if (folder / LOCK).is_symlink():
        raise no_folder(folder, Message("sweep-lock-is-link", name=LOCK))
    lock = FileLock(folder / LOCK, timeout=0, fallback_to_soft=False)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout as error:
        raise InputError.at(str(folder), Message("sweep-folder-in-use")) from error
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise no_folder(folder, error) from error
    try:
        yield
    finally:
        lock.release()
