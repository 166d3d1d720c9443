"""A sweep from Python: the same plan, engine and rows as the command's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mtcommission.sweep.engine import Engine, run_sweep
from mtcommission.sweep.request import read_plan
from mtcommission.sweep.table import SweepTable, read_table


def sweep(
    profile: str | Path,
    *,
    vary: Sequence[str],
    folder: str | Path,
    quantity: str = "optimal",
    is_paired: bool = False,
    engine: Engine | None = None,
) -> SweepTable:
    """Return the rows of a sweep as columns; what is in the folder already is not computed again.

    Parameters
    ----------
    profile
        File of the machine as it is.
    vary
        ``KEY=RANGE`` as on the command line.
    folder
        Where the rows are kept.
    quantity
        ``"optimal"``, ``"limits"`` or ``"run"``.
    is_paired
        Whether the ranges go together instead of each with each.
    engine
        None: this process.

    Returns
    -------
    SweepTable

    Raises
    ------
    InputError
        With every fault found; if the folder holds another sweep.
    ComputationError
        WORKER_LOST or STOPPED.

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
        f_max="",
        vary=vary,
        limits=[],
        cases=None,
        is_paired=is_paired,
        quantity=quantity,
        move=1,
        created="",
    )
    return read_table(plan, run_sweep(plan, folder=Path(folder), engine=engine, resume=True))
