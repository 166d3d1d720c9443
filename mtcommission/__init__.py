"""Acceleration and jerk limits for machine tool axes, from the mechanical model.

``run`` computes a machine, ``make_record`` what the sheet is printed from; both load the rest
when they are called.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mtcommission.base import __version__

if TYPE_CHECKING:
    from pathlib import Path

    from mtcommission.commission.commission import Commissioning
    from mtcommission.machine.machine import Machine
    from mtcommission.record.record import Record

__all__ = ["__version__", "make_record", "run"]


def run(profile: Path | str | Machine) -> Commissioning:
    """Return optima, recommended limits, their response and the verdict.

    Like the commands in one thread of BLAS, whatever the process allows: the order of summation
    changes with their number, and so would the last digits. ``profile`` is a file, or a machine
    that was read from one and changed. docs/python.md tells what is returned, and the shape and
    unit of every time series.

    Raises
    ------
    InputError
        With every fault of the profile.
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    from threadpoolctl import threadpool_limits

    from mtcommission.commission.commission import commission
    from mtcommission.machine.machine import Machine
    from mtcommission.machine.profile.read import parse_profile, read_source

    if isinstance(profile, Machine):
        source, machine = None, profile
    else:
        source = read_source(profile)
        machine = parse_profile(source.text, where=str(profile))
    with threadpool_limits(limits=1, user_api="blas"):
        return commission(machine, profile=source)


def make_record(found: Commissioning) -> Record:
    """Return the record of a machine that was run from its file, for the sheet and exports.

    In one thread, like ``run``; raises InputError if it was run from a machine instead.
    """
    from threadpoolctl import threadpool_limits

    from mtcommission.base.process import now
    from mtcommission.record.record import record_run

    with threadpool_limits(limits=1, user_api="blas"):
        return record_run(found, created=now())
