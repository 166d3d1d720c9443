"""Reading that says what is wrong with a file, and writing that leaves no half-written one."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import NamedTemporaryFile

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message


def read_bytes(path: Path, *, folder: Message, most: int = -1) -> bytes:
    """Return what a file holds.

    Parameters
    ----------
    path
        Of the file.
    folder
        What to say if it is a folder.
    most
        Bytes that are read; -1 for all.

    Returns
    -------
    bytes

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
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
        raise InputError([Fault(where=str(path), message=message)]) from error


def require_folder(folder: Path) -> None:
    """Raise before anything is computed if files cannot be written into a folder.

    Parameters
    ----------
    folder
        May be missing; nothing is made yet.

    Raises
    ------
    InputError
        If it is a file, or may not be written to.
    """
    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir():
        is_above = place != folder
        reason = Message("file-above", place=str(place)) if is_above else Message("file-itself")
    elif not os.access(place, os.W_OK | os.X_OK):
        reason = Message("file-no-right", folder=str(place))
    else:
        return
    raise no_folder(folder, reason)


def no_folder(folder: Path, reason: Message | OSError) -> InputError:
    """Return the error of a folder that cannot be written, for a reason."""
    said = str(reason.strerror) if isinstance(reason, OSError) else reason
    message = Message("file-folder-not-writable", reason=said)
    return InputError([Fault(where=str(folder), message=message)])


def require_writable(*names: str) -> None:
    """Raise before anything is computed if a text cannot be written to one of these files.

    Parameters
    ----------
    names
        File names; "" and "-" (standard output) are always good.

    Raises
    ------
    InputError
        With a fault for each that is a folder or whose folder is missing or write-protected.
    """
    faults = []
    for name in names:
        path = Path(name)
        if name in ("", "-"):
            continue
        if path.is_dir():
            message = Message("file-is-folder")
        elif not path.parent.is_dir():
            message = Message("file-without-folder", folder=str(path.parent))
        elif not os.access(path.parent, os.W_OK | os.X_OK):
            message = Message("file-folder-closed", folder=str(path.parent))
        else:
            continue
        faults.append(Fault(where=name, message=message))
    if faults:
        raise InputError(faults)


def write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files into a folder, each under a temporary name first.

    Parameters
    ----------
    folder
        Made if it is missing.
    files
        Contents by name.

    Raises
    ------
    InputError
        If the folder cannot be used.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            _replace(folder / name, content)
    except OSError as error:
        raise no_folder(folder, error) from error


def write_text(name: str, text: str) -> None:
    """Write a text to a file, or to standard output if the name is ``-``.

    Parameters
    ----------
    name
        File name or ``-``.
    text
        Content.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if name == "-":
        sys.stdout.write(text)
        return
    try:
        _replace(Path(name), text.encode())
    except OSError as error:
        message = Message("file-not-writable", reason=str(error.strerror))
        raise InputError([Fault(where=name, message=message)]) from error


def _replace(path: Path, content: bytes) -> None:
    with NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
        try:
            file.write(content)
            file.close()
            os.chmod(file.name, 0o644)
            os.replace(file.name, path)
        except OSError:
            file.close()
            Path(file.name).unlink(missing_ok=True)
            raise
