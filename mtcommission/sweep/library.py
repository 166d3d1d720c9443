"""A sweep from Python: the same plan, engine and rows as the command's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mtcommission.sweep.engine import run_sweep
from mtcommission.sweep.lanes import Engine
from mtcommission.sweep.request import read_plan
from mtcommission.sweep.table import SweepTable, read_table


def sweep(
    profile: str | Path,
    *,
    folder: str | Path,
    vary: Sequence[str] = (),
    cases: str | Path | None = None,
    is_paired: bool = False,
    quantity: str = "optimal",
    limits: Sequence[str] = (),
    move: int = 1,
    created: str = "",
    engine: Engine | None = None,
) -> SweepTable:
    """Return the rows of a sweep as columns; what is in the folder already is not computed again.

    Everything as on the command line: ``vary`` takes ``KEY=RANGE``, ``limits`` ``NAME=VALUE`` or
    ``NAME=RANGE``, ``cases`` a CSV file, ``created`` the date that records bear; ``engine`` None
    is this process.

    Raises InputError with every fault found, or if the folder holds another sweep. Raises
    ComputationError: WORKER_LOST, SCHEDULER_LOST or STOPPED.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = sweep("profiles/milling-manipulator.toml", folder=folder,
    ...         vary=["drive.max_force=2kN,4kN"])
    >>> [round(t_f, 6) for t_f in table.frame["t_f"]]
    [0.04352, 0.026324]
    """
    plan = read_plan(
        Path(profile),
        vary=vary,
        limits=limits,
        cases=None if cases is None else Path(cases),
        is_paired=is_paired,
        quantity=quantity,
        move=move,
        created=created,
    )
    return read_table(plan, run_sweep(plan, folder=Path(folder), engine=engine, resume=True))
