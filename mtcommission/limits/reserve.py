"""What recommendations may use of what is allowed: the rest is kept for what no model knows."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.machine.machine import NO_RESERVE, Machine
from mtcommission.requirements.register import requirements_of


def keep_reserve(machine: Machine) -> Machine:
    """Return the machine with requirements as much stricter as its reserve; itself without one.

    Examples
    --------
    >>> from mtcommission.machine.machine import Reserve
    >>> from tests.machines import paper_machine
    >>> needs = replace(paper_machine().requirements, reserve=Reserve(band=0.8, force=0.95))
    >>> strict = keep_reserve(replace(paper_machine(), requirements=needs))
    >>> round(1e6 * strict.requirements.tcp_deviation, 6), strict.drive.max_force
    (4.0, 1900.0)
    """
    reserve, strict = machine.requirements.reserve, machine
    if reserve == NO_RESERVE:
        return machine
    for item in requirements_of(machine):
        strict = item.with_bound(strict, item.share(reserve) * item.bound(machine))
    return replace(strict, requirements=replace(strict.requirements, reserve=NO_RESERVE))
