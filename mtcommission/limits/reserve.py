"""What recommendations may use of what is allowed: the rest is kept for what no model knows."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.machine.machine import NO_RESERVE, Machine


def keep_reserve(machine: Machine) -> Machine:
    """Return the machine with requirements as much stricter as its reserve.

    Parameters
    ----------
    machine
        ``requirements.reserve`` states the shares: of band, contour and peaks, and of the set
        force and the RMS force. A settling time is wanted as it is.

    Returns
    -------
    Machine
        Itself where the whole may be used.

    Examples
    --------
    >>> from mtcommission.machine.machine import Reserve
    >>> from tests.machines import paper_machine
    >>> needs = replace(paper_machine().requirements, reserve=Reserve(band=0.8, force=0.95))
    >>> strict = keep_reserve(replace(paper_machine(), requirements=needs))
    >>> round(1e6 * strict.requirements.tcp_deviation, 6), strict.drive.max_force
    (4.0, 1900.0)
    """
    needs, drive, reserve = machine.requirements, machine.drive, machine.requirements.reserve
    if reserve == NO_RESERVE:
        return machine
    return replace(
        machine,
        requirements=replace(
            needs,
            tcp_deviation=reserve.band * needs.tcp_deviation,
            contour_deviation=reserve.band * needs.contour_deviation,
            peaks=tuple(replace(peak, bound=reserve.band * peak.bound) for peak in needs.peaks),
            reserve=NO_RESERVE,
        ),
        drive=replace(
            drive,
            max_force=drive.max_force - drive.motion_force + reserve.force * drive.motion_force,
            continuous_force=reserve.force * drive.continuous_force,
        ),
    )
