"""Finished cases on disk: a log that is only appended to, usable after any interruption.

Each line holds the rows of one piece of work behind a checksum, says whose sweep it is, and is
synchronised to disk before the next. A line that is torn or damaged counts as not there: its cases
are computed again. One sweep at a time works in a folder: a lock that the system holds on an open
file, so that nothing is left to clean up after kill -9. Where a file system has no locks (some
network drives) two sweeps would do their work twice; the rows stay sound.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zlib import crc32

from filelock import FileLock, Timeout

from mtcommission.errors import Fault, InputError
from mtcommission.files import no_folder
from mtcommission.messages.message import Message
from mtcommission.sweep.rows import Row

NAME = "mtcommission-sweep.log"
LOCK = ".mtcommission-sweep.lock"

NO_LOCKS = {errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP}
"""How file systems say that they have no locks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """The log of one sweep."""

    path: Path
    plan: str  # hash of what is computed; each line bears it
    created: str  # when the sweep was begun

    def append(self, piece: int, rows: Sequence[Row]) -> None:
        """Write the rows of one piece and wait until they are on the disk.

        Raises
        ------
        InputError
            The disk is full or gone; the file is as long as before.
        """
        entry = {"plan": self.plan, "created": self.created, "piece": piece, "rows": rows}
        try:
            _append_line(self.path, entry)
        except OSError as error:
            raise disk_full(self.path, error) from error

    def pieces(self) -> Iterator[tuple[int, tuple[Row, ...]]]:
        """Yield number and rows of the finished pieces, in the order in which they came in."""
        for entry in _entries(self.path):
            if "piece" in entry:
                yield int(entry["piece"]), tuple(tuple(row) for row in entry["rows"])


def open_store(
    folder: Path, *, digest: str, created: str, resume: bool, results: Sequence[str]
) -> Store:
    """Return the store of a folder, which is made if it is missing, new or continued.

    ``results`` are files that a sweep leaves; where they are without a store, somebody else wrote
    them. A continued sweep keeps its first date; one that ended before its first row begins anew.

    Raises
    ------
    InputError
        There are rows already and ``resume`` was not asked for, they belong to another sweep, there
        are files that no sweep of ours wrote, or the folder cannot be written.
    """
    path = folder / NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = (NAME,) if os.path.lexists(path) else results
        is_ours = path.is_file() and not path.is_symlink() and _is_log(path)
        foreign = [name for name in names if os.path.lexists(folder / name) and not is_ours]
        if foreign:
            raise _refused(folder, Message("sweep-folder-holds-foreign", names=", ".join(foreign)))
        entries = _entries(path) if is_ours else ()
        begun = [(entry["plan"], entry["created"]) for entry in entries if "piece" in entry]
        if begun and not resume:
            raise _refused(folder, Message("sweep-folder-holds-one"))
        if any(plan != digest for plan, _ in begun):
            raise _refused(folder, Message("sweep-folder-holds-another"))
        if begun:
            return Store(path=path, plan=digest, created=str(begun[0][1]))
        path.unlink(missing_ok=True)
        _append_line(path, {"plan": digest, "created": created})
    except OSError as error:
        raise no_folder(folder, error) from error
    return Store(path=path, plan=digest, created=created)


def _is_log(path: Path) -> bool:
    """Whether a sound line is there, or nothing but the torn first one."""
    with closing(_entries(path)) as entries:
        is_sound = next(entries, None) is not None
    return is_sound or b"\n" not in path.read_bytes()


def _entries(path: Path) -> Generator[dict[str, Any]]:
    """What the sound lines of a log hold."""
    with path.open("rb") as file:
        for line in file:
            text = line[9:-1]
            if line.endswith(b"\n") and line[:9] == _checksum(text):
                entry = json.loads(text)
                if isinstance(entry, dict):
                    yield entry


def _append_line(path: Path, entry: dict[str, Any]) -> None:
    """Append one line with its checksum; on failure the file is as long as before."""
    text = json.dumps(entry, separators=(",", ":")).encode()
    line = _checksum(text) + text + b"\n"
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


def _refused(folder: Path, message: Message) -> InputError:
    return InputError([Fault(where=str(folder), message=message)])


def disk_full(path: Path, error: OSError) -> InputError:
    """Return the error of a file that could not be written while the rows before are kept."""
    message = Message("sweep-disk-full", reason=str(error.strerror))
    return InputError([Fault(where=str(path), message=message)])


@contextmanager
def hold_folder(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of a folder, made if it is missing, as long as the block runs.

    Raises
    ------
    InputError
        Another sweep is at work there, or the folder cannot be written.
    """
    if (folder / LOCK).is_symlink():
        raise no_folder(folder, Message("sweep-lock-is-link", name=LOCK))
    lock = FileLock(folder / LOCK, timeout=0, fallback_to_soft=False)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout as error:
        raise _refused(folder, Message("sweep-folder-in-use")) from error
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise no_folder(folder, error) from error
    try:
        yield
    finally:
        lock.release()
