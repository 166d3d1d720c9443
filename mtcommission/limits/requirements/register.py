"""All requirements there are, and those that a machine has."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from math import isfinite

from mtcommission.limits.requirements.contour_deviation import CONTOUR_DEVIATION
from mtcommission.limits.requirements.peak import peak_of, peaks_of
from mtcommission.limits.requirements.requirement import Requirement
from mtcommission.limits.requirements.residual_deviation import RESIDUAL_DEVIATION
from mtcommission.limits.requirements.rms_force import RMS_FORCE
from mtcommission.limits.requirements.set_force import SET_FORCE
from mtcommission.limits.requirements.settling_time import SETTLING_TIME
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirements import NO_RESERVE

REGISTER: tuple[Requirement | Callable[[Machine], Iterable[Requirement]], ...] = (
    RESIDUAL_DEVIATION,
    SETTLING_TIME,
    CONTOUR_DEVIATION,
    peaks_of,
    SET_FORCE,
    RMS_FORCE,
)
"""All there are, in the order of records; a function: one for each of what a machine names."""


def requirements_of(machine: Machine) -> tuple[Requirement, ...]:
    """Return what a machine asks for."""
    return tuple(
        requirement
        for entry in REGISTER
        for requirement in ((entry,) if isinstance(entry, Requirement) else entry(machine))
        if isfinite(requirement.bound(machine))
    )


def read_requirement(key: str) -> Requirement:
    """Return the requirement of a record's name for it; ValueError: there is none.

    >>> read_requirement("RMS force").message
    Message('requirement-rms-force')
    """
    kind, _, signal = key.partition(" ")
    if kind == "peak" and signal:
        return peak_of(signal)
    for entry in REGISTER:
        if isinstance(entry, Requirement) and entry.key == key:
            return entry
    raise ValueError(key)


def keep_reserve(machine: Machine) -> Machine:
    """Return the machine with requirements as much stricter as its reserve; itself without one."""
    reserve, strict = machine.requirements.reserve, machine
    if reserve == NO_RESERVE:
        return machine
    for item in requirements_of(machine):
        strict = item.with_bound(strict, item.share(reserve) * item.bound(machine))
    return replace(strict, requirements=replace(strict.requirements, reserve=NO_RESERVE))
