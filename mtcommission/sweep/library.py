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

    Parameters
    ----------
    profile
        File of the machine as it is.
    folder
        Where the rows are kept.
    vary
        ``KEY=RANGE`` as on the command line.
    cases
        CSV file of cases; goes with the ranges like one more of them.
    is_paired
        Whether the ranges go together instead of each with each.
    quantity
        ``"optimal"``, ``"limits"`` or ``"run"``.
    limits
        ``NAME=VALUE`` or ``NAME=RANGE`` of states and outputs, for ``"optimal"``.
    move
        Which of the profile's moves ``"optimal"`` solves, counted from 1.
    created
        Date that the records of ``"run"`` and their sheets bear, ISO 8601; "" for none.
    engine
        None: this process.

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
        limits=limits,
        cases=None if cases is None else Path(cases),
        is_paired=is_paired,
        quantity=quantity,
        move=move,
        created=created,
    )
    return read_table(plan, run_sweep(plan, folder=Path(folder), engine=engine, resume=True))
