"""Writing that leaves no half-written file behind, and asks beforehand whether it may."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import NamedTemporaryFile

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message


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
        reason = f"{place} is a file" if place != folder else "this is a file"
    elif not os.access(place, os.W_OK | os.X_OK):
        reason = f"no right to write into {place}"
    else:
        return
    message = f"cannot write there ({reason}); give another folder with -o"
    raise InputError([Fault(where=str(folder), message=Message("verbatim", text=message))])


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
            reason = "is a folder; give a file name"
        elif not path.parent.is_dir():
            reason = f"there is no folder {path.parent}; make it first, or give another name"
        elif not os.access(path.parent, os.W_OK | os.X_OK):
            reason = f"no right to write into {path.parent}; give another name"
        else:
            continue
        faults.append(Fault(where=name, message=Message("verbatim", text=reason)))
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
        message = f"cannot write there ({error.strerror}); give another folder with -o"
        raise InputError(
            [Fault(where=str(folder), message=Message("verbatim", text=message))]
        ) from error


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
        message = f"cannot write this file ({error.strerror}); give another name"
        raise InputError([Fault(where=name, message=Message("verbatim", text=message))]) from error


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
