"""Measured files -> evidence: the one entry to everything that reads and estimates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from mtcommission.identify.measurement import Evidence, Output, Sensor


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """What the user says about the files where they do not say it themselves.

    Parameters
    ----------
    sensor
        ``--sensor``; None where it is not given. ``FILE@tcp`` goes before it.
    input
        ``--input``: force, torque, current or acceleration; "" where it is not given.
    constant
        ``--constant``: force or torque per ampere or per unit of the file [SI]; None where it is
        not given.
    output
        ``--output``; None where it is not given.
    columns
        ``--columns NAME=COLUMN``: our names to those of the file.
    rotary
        Kind of the axis by its profile; None where no profile is given.
    """

    sensor: Sensor | None = None
    input: str = ""
    constant: float | None = None
    output: Output | None = None
    columns: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    rotary: bool | None = None


def gather(files: Sequence[str], given: Given) -> Evidence:
    """Return what some files say about an axis.

    Parameters
    ----------
    files
        Names, each possibly with ``@encoder`` or ``@tcp``; ``-`` is standard input.
    given
        What the command line says about them.

    Returns
    -------
    Evidence

    Raises
    ------
    InputError
        With every fault found: file, line, what was got, how to say what is missing.
    """
    raise NotImplementedError
