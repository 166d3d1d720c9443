"""A plan -> rows on disk, by one process, several, or a Dask cluster; always the same rows.

Work is cut into pieces by case number alone, so neither the number of workers nor an interruption
changes what is computed together.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mtcommission.errors import ComputationError, Fault, InputError, Outcome
from mtcommission.files import replace_file
from mtcommission.messages.message import Message
from mtcommission.sweep.lanes import (
    Engine,
    Lane,
    NoSchedulerError,
    end_as_if_by_keyboard,
    open_lane,
)
from mtcommission.sweep.plan import Plan, piece_size
from mtcommission.sweep.rows import DONE, Answer, Row, Work, columns, cut_work, fill_rows
from mtcommission.sweep.solve import solve_piece
from mtcommission.sweep.store import Store, disk_full, hold_folder, open_store

LOSSES = 3
"""Lost workers in a row, without a finished piece between, that end a sweep."""
RESULTS = ("rows.parquet", "rows.csv", "sweep.html")
"""What a finished sweep leaves in its folder."""
RECORDS = "records"
"""Folder of the records of whole runs in it."""
POLL = 0.5
"""Seconds between looks at the keyboard."""

Progress = Callable[[int, int, int], None]
"""Called with cases done, cases in all, and failures so far."""
Notice = Callable[[Message], None]
"""Called with what the user must know while a sweep runs."""


def run_sweep(
    plan: Plan,
    *,
    folder: Path,
    engine: Engine | None = None,
    resume: bool = False,
    progress: Progress = lambda done, total, failures: None,
    notice: Notice = lambda _: None,
) -> Store:
    """Return the store with the rows of all cases, computing those that are missing.

    ``engine``: None for this process. ``progress`` is called after each piece, ``notice`` where a
    cluster has no workers to wait for.

    Raises
    ------
    InputError
        The folder cannot be used, another sweep is at work there, or the disk is full.
    ComputationError
        WORKER_LOST if workers end again and again, SCHEDULER_LOST if a cluster's scheduler does;
        STOPPED by Ctrl-C, kill or a closed terminal.
    """
    with hold_folder(folder), end_as_if_by_keyboard():
        store = open_store(
            folder,
            digest=plan.digest,
            created=plan.created,
            resume=resume,
            results=(*RESULTS, RECORDS),
        )
        tally = _Tally(total=plan.count, progress=progress)
        left = set(range(-(-plan.count // piece_size(plan))))
        try:
            for piece, rows in store.pieces():
                left.discard(piece)
                tally.add(rows)
            plan = replace(plan, created=store.created)
            _complete(plan, store, engine or Engine(), left, tally, notice)
        except KeyboardInterrupt as error:
            kept = Message("sweep-cases-kept", **tally.counts, folder=str(folder))
            raise ComputationError(Outcome.STOPPED, kept) from error
        return store


@dataclass
class _Tally:
    """Counts for the progress bar."""

    total: int
    progress: Progress
    done: int = 0
    failures: int = 0

    @property
    def counts(self) -> dict[str, int]:
        return {"done": self.done, "count": self.total}

    def add(self, rows: Sequence[Row]) -> None:
        self.done += len(rows)
        self.failures += sum(row[-2] != DONE for row in rows)
        self.progress(self.done, self.total, self.failures)


def _complete(
    plan: Plan, store: Store, engine: Engine, left: set[int], tally: _Tally, notice: Notice
) -> None:
    """Compute the pieces that are left, anew where a worker is lost."""
    losses = 0
    while left:
        before = len(left)
        try:
            workers = min(engine.workers, len(left))
            with open_lane(replace(engine, workers=workers)) as lane:
                _work(plan, store, lane, left, tally, notice)
        except (BrokenExecutor, CancelledError) as error:
            losses = losses + 1 if len(left) == before else 1
            if losses >= LOSSES:
                detail = Message("sweep-piece-lost", **tally.counts, piece=min(left))
                raise ComputationError(Outcome.WORKER_LOST, detail) from error
        except NoSchedulerError as error:
            address = engine.scheduler
            if not losses:
                message = Message("sweep-no-scheduler", address=address, why=error.why)
                raise InputError([Fault(where="--scheduler", message=message)]) from error
            detail = Message("sweep-scheduler-gone", **tally.counts, address=address)
            raise ComputationError(Outcome.SCHEDULER_LOST, detail) from error


def _work(
    plan: Plan, store: Store, lane: Lane, left: set[int], tally: _Tally, notice: Notice
) -> None:
    """Keep a few pieces under way and write each one as it comes in."""
    table = columns(plan)
    queue, running = cut_work(plan, sorted(left)), dict[Future[Any], Work]()
    following, had_workers = next(queue, None), True
    while following or running:
        width = lane.width()
        if had_workers and not width:
            notice(Message("sweep-waits"))
        had_workers = width > 0
        while following and len(running) < width:
            running[lane.executor.submit(solve_piece, following)] = following
            following = next(queue, None)
        if not running:
            time.sleep(POLL)
        ready, _ = wait(running, timeout=POLL, return_when=FIRST_COMPLETED)
        for future in ready:
            work, answers = running.pop(future), future.result()
            rows = fill_rows(table, work, answers)
            _write_records(store, work, answers)
            store.append(work.piece, rows)
            left.discard(work.piece)
            tally.add(rows)


def _write_records(store: Store, work: Work, answers: Sequence[Answer]) -> None:
    records = store.path.parent / RECORDS
    for number, answer in enumerate(answers):
        if answer.record:
            path = records / f"case-{work.first + number:06d}.json"
            try:
                records.mkdir(exist_ok=True)
                replace_file(path, answer.record.encode())
            except OSError as error:
                raise disk_full(path, error) from error
