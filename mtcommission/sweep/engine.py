"""A plan -> answers on disk, by one process, several, or a Dask cluster; always the same rows.

Work is cut into pieces by case number alone, so neither the number of workers nor an interruption
changes what is computed together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, CancelledError
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from mtcommission.base.errors import ComputationError, InputError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.base.process import end_as_if_by_keyboard
from mtcommission.sweep.lanes import Engine, NoSchedulerError, solve_pieces
from mtcommission.sweep.plan import Plan, piece_size
from mtcommission.sweep.solve import DONE, Answer, Work, cut_work, place_of_record
from mtcommission.sweep.store import Store, hold_folder, open_store, write_safely

LOSSES = 3
"""Lost workers in a row, without a finished piece between, that end a sweep."""
RESULTS = ("rows.parquet", "rows.csv", "sweep.html")
"""What a finished sweep leaves in its folder."""

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
    """Return the store with the answers of all cases, computing those that are missing.

    ``engine``: None for this process. ``progress`` is called after each piece, ``notice`` where a
    cluster has no workers to wait for.

    Raises InputError: the folder cannot be used, another sweep is at work there, or the disk is
    full. Raises ComputationError: WORKER_LOST if workers end again and again, SCHEDULER_LOST if a
    cluster's scheduler does; STOPPED by Ctrl-C, kill or a closed terminal.
    """
    with hold_folder(folder), end_as_if_by_keyboard():
        results = (*RESULTS, str(Path(place_of_record(0)).parent))
        store = open_store(
            folder, digest=plan.digest, created=plan.created, resume=resume, results=results
        )
        run = _Run(
            plan=replace(plan, created=store.created),
            store=store,
            left=set(range(-(-plan.count // piece_size(plan)))),
            progress=progress,
            notice=notice,
        )
        try:
            for piece, answers in store.pieces():
                run.count(piece, answers)
            run.complete(engine or Engine())
        except KeyboardInterrupt as error:
            kept = Message("sweep-cases-kept", **run.counts, folder=str(folder))
            raise ComputationError(Outcome.STOPPED, kept) from error
        return store


@dataclass(kw_only=True)
class _Run:
    """What is left to do, and who is told."""

    plan: Plan
    store: Store
    left: set[int]  # pieces
    progress: Progress
    notice: Notice
    done: int = 0
    failures: int = 0

    @property
    def counts(self) -> dict[str, int]:
        return {"done": self.done, "count": self.plan.count}

    def count(self, piece: int, answers: Sequence[Answer]) -> None:
        """A piece that an interruption left twice counts once."""
        if piece in self.left:
            self.left.discard(piece)
            self.done += len(answers)
            self.failures += sum(answer.outcome != DONE for answer in answers)
            self.progress(self.done, self.plan.count, self.failures)

    def complete(self, engine: Engine) -> None:
        """Compute the pieces that are left, anew where a worker is lost."""
        losses = 0
        while self.left:
            before = len(self.left)
            works = cut_work(self.plan, sorted(self.left))
            own = replace(engine, workers=min(engine.workers, before))
            try:
                with closing(solve_pieces(works, own, notice=self.notice)) as solved:
                    for work, answers in solved:
                        self.write(work, answers)
            except (BrokenExecutor, CancelledError) as error:
                losses = losses + 1 if len(self.left) == before else 1
                if losses >= LOSSES:
                    detail = Message("sweep-piece-lost", **self.counts, piece=min(self.left))
                    raise ComputationError(Outcome.WORKER_LOST, detail) from error
            except NoSchedulerError as error:
                address = engine.scheduler
                if not losses:
                    message = Message("sweep-no-scheduler", address=address, why=error.why)
                    raise InputError.at("--scheduler", message) from error
                detail = Message("sweep-scheduler-gone", **self.counts, address=address)
                raise ComputationError(Outcome.SCHEDULER_LOST, detail) from error

    def write(self, work: Work, answers: Sequence[Answer]) -> None:
        """Write a piece as it comes in, the records of whole runs first."""
        for number, answer in enumerate(answers):
            if answer.record:
                place = place_of_record(work.first + number)
                write_safely(self.store.path.parent / place, answer.record.encode())
        self.store.append(work.piece, answers)
        self.count(work.piece, answers)
