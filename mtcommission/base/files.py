"""Reading that says what is wrong with a file, and writing that leaves no half-written one.

What is written replaces a file as a whole. A link stays and what it points to is replaced; a file
keeps its mode, a new one has that of the umask; devices and pipes are written into.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import BinaryIO

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message

OWN_STREAMS = {"/dev/stdout": 1, "/dev/stderr": 2}
"""Descriptors by name: they may lead into a file that holds more than what is written now."""


def read_bytes(path: Path, *, folder: Message, most: int) -> bytes:
    """Return at most ``most`` bytes of a file, or of standard input if its name is ``-``.

    ``folder``: what to say if it is a folder.

    Raises InputError if it cannot be read.
    """
    try:
        if str(path) == "-":
            return sys.stdin.buffer.read(most)
        with path.open("rb") as file:
            return file.read(most)
    except (OSError, ValueError) as error:
        match error:
            case FileNotFoundError():
                message = Message("file-missing")
            case IsADirectoryError():
                message = folder
            case OSError():
                message = Message("file-unreadable", reason=error.strerror)
            case _:
                message = Message("file-unreadable", reason=str(error))
        raise InputError.at(str(path), message) from error


def require_folder(folder: Path, *names: str, inputs: Sequence[Path] = ()) -> None:
    """Raise InputError before anything is computed if files cannot be written into a folder.

    The folder may be missing; nothing is made yet. ``inputs`` are files that must stay as they are.
    """
    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir():
        reason = Message("file-above", place=str(place))
    elif not os.access(place, os.W_OK | os.X_OK):
        reason = Message("file-no-right", folder=str(place))
    else:
        if place == folder:
            require_writable(*(str(folder / name) for name in names), inputs=inputs)
        return
    raise no_folder(folder, reason)


def no_folder(folder: Path, reason: Message | OSError) -> InputError:
    """Return the error of a folder that cannot be written, for a reason."""
    said = (reason.strerror or str(reason)) if isinstance(reason, OSError) else reason
    message = Message("file-folder-not-writable", reason=said)
    return InputError.at(str(folder), message)


def require_writable(*names: str, inputs: Sequence[Path] = ()) -> None:
    """Raise before anything is computed if a text cannot be written to one of these files.

    Of the names "" is none, "-" standard output; ``inputs`` are files that must stay as they are.

    Raises InputError with a fault for each that is a folder or write-protected, whose folder is
    missing or write-protected, that is named twice, or that is an input.
    """
    faults, places = [], list[str]()
    for name in filter(None, names):
        wrong = _twice(name, places) or _wrong_with(name, inputs)
        places.append(os.path.realpath(name))
        if wrong:
            faults.append(Fault(where=name, message=wrong))
    if faults:
        raise InputError(faults)


def _twice(name: str, places: Sequence[str]) -> Message | None:
    is_stream = name != "-" and _is_stream(Path(name))
    is_twice = os.path.realpath(name) in places and not is_stream
    return Message("file-named-twice") if is_twice else None


def _wrong_with(name: str, inputs: Sequence[Path]) -> Message | None:
    """Why a name cannot be written to; None if it can."""
    path = Path(os.path.realpath(name) if os.path.islink(name) else name)
    if name == "-":
        return None
    if path.is_dir():
        return Message("file-is-folder")
    if _is_stream(Path(name)):
        return None
    if not path.parent.is_dir():
        return Message("file-without-folder", folder=str(path.parent))
    if not os.access(path.parent, os.W_OK | os.X_OK):
        return Message("file-no-right", folder=str(path.parent))
    if any(os.path.realpath(other) == os.path.realpath(path) for other in inputs):
        return Message("file-is-input")
    if path.exists() and not os.access(path, os.W_OK):
        return Message("file-write-protected")
    return None


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files by name into a folder, made if it is missing: all or, if one fails, none.

    Raises InputError if the folder cannot be used.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with ExitStack() as ready:
            for name, content in files.items():
                ready.enter_context(_replacing(folder / name, content))
    except OSError as error:
        raise no_folder(folder, error) from error


def write_text(name: str, text: str) -> None:
    """Write a text to a file, or to standard output if the name is ``-``; raise InputError."""
    if name == "-":
        sys.stdout.write(text)
        return
    try:
        replace_file(Path(name), text.encode(errors="replace"))
    except OSError as error:
        message = Message("file-not-writable", reason=error.strerror or str(error))
        raise InputError.at(name, message) from error


def replace_file(path: Path, content: bytes | Callable[[BinaryIO], object]) -> None:
    """Write a file as a whole or not at all, following a link; into a device or pipe as it comes.

    Raises OSError if it cannot be written; what was there before is unchanged.
    """
    with _replacing(path, content):
        pass


@contextmanager
def _replacing(path: Path, content: bytes | Callable[[BinaryIO], object]) -> Iterator[None]:
    """Fill a new file beside one, which takes its place at the end, if nothing fails in between."""
    fill = content if callable(content) else lambda file: file.write(content)
    if _is_stream(path):
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        own = OWN_STREAMS.get(str(path))
        with path.open("wb") if own is None else os.fdopen(os.dup(own), "wb") as file:
            fill(file)
        yield
        return
    place = Path(os.path.realpath(path))
    fresh = place.with_name(f".mtcommission-{os.urandom(8).hex()}")
    try:
        with fresh.open("xb") as file:
            if place.exists():
                os.chmod(fresh, stat.S_IMODE(place.stat().st_mode))
            fill(file)
            file.flush()
            os.fsync(file.fileno())
        yield
        os.replace(fresh, place)
    except BaseException:
        fresh.unlink(missing_ok=True)
        raise


def _is_stream(path: Path) -> bool:
    """Whether a name stands for a device, a pipe or a socket, which nothing may replace."""
    return str(path) in OWN_STREAMS or (path.exists() and not path.is_file() and not path.is_dir())
