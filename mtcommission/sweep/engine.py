"""A plan -> rows on disk, by one process, several, or a Dask cluster; always the same rows.

Work is cut into pieces by case number alone (``pieces``), so neither the number of workers nor an
interruption changes what is computed together.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from ssl import SSLError
from typing import Any

from mtcommission.errors import ComputationError, Fault, InputError, Outcome
from mtcommission.files import replace_file
from mtcommission.messages.message import Message
from mtcommission.sweep.cases import Plan, check_plan
from mtcommission.sweep.lock import hold_folder
from mtcommission.sweep.pieces import count_pieces, cut_work, piece_size
from mtcommission.sweep.rows import DONE, Answer, Work
from mtcommission.sweep.signals import end_as_if_by_keyboard, shield_tracker
from mtcommission.sweep.solve import solve_piece
from mtcommission.sweep.store import (
    Finished,
    Opened,
    append,
    disk_full,
    open_store,
    read_finished,
)

LOSSES = 3
"""Lost workers in a row, without a finished piece between, that end a sweep."""
RESULTS = ("rows.parquet", "rows.csv", "sweep.html")
"""What a finished sweep leaves in its folder."""
RECORDS = "records"
"""Folder of the records of whole runs in it."""
PATIENCE = 30.0
"""Seconds that a cluster is waited for."""

POLL = 0.5
"""Seconds between looks at the keyboard."""

Progress = Callable[[int, int, int], None]
"""Called with cases done, cases in all, and failures so far."""
Notice = Callable[[Message], None]
"""Called with what the user must know while a sweep runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Engine:
    """Where the work is done.

    Parameters
    ----------
    workers
        Processes on this machine, no more than there are pieces of work; 1 stays in this one.
    scheduler
        Address of a Dask scheduler; "" for none.
    """

    workers: int = 1
    scheduler: str = ""


class Immediate(Executor):
    """The executor of one process: computes when it is asked."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Return the finished future of a call."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


def run_sweep(
    plan: Plan,
    *,
    folder: Path,
    engine: Engine | None = None,
    resume: bool = False,
    progress: Progress = lambda done, total, failures: None,
    notice: Notice = lambda _: None,
) -> Opened:
    """Return the store with the rows of all cases, computing those that are missing.

    Parameters
    ----------
    plan
        What to compute.
    folder
        Where the rows go.
    engine
        None: this process.
    resume
        Whether to continue what is there.
    progress
        Called after each piece.
    notice
        Called where a cluster has no workers to wait for.

    Raises
    ------
    InputError
        If the plan or the folder cannot be used, another sweep is at work there, or the disk is
        full.
    ComputationError
        WORKER_LOST if workers end again and again, SCHEDULER_LOST if a cluster's scheduler does;
        STOPPED by Ctrl-C, kill or a closed terminal.
    """
    check_plan(plan)
    with hold_folder(folder), end_as_if_by_keyboard():
        store, tally = _begin(plan, folder, resume=resume, progress=progress)
        plan = replace(plan, created=store.created)
        try:
            _complete_pieces(plan, store, engine or Engine(), tally, notice)
        except KeyboardInterrupt as error:
            kept = Message(
                "sweep-cases-kept", done=tally.done, count=plan.count, folder=str(folder)
            )
            raise ComputationError(Outcome.STOPPED, kept) from error
        return store


def _begin(plan: Plan, folder: Path, *, resume: bool, progress: Progress) -> tuple[Opened, _Tally]:
    """The store, and the count of what stands in it already."""
    # Rows of pieces that were cut otherwise would be sorted into the wrong places.
    digest = f"{plan.digest}/{piece_size(plan)}"
    store = open_store(
        folder, digest=digest, created=plan.created, resume=resume, results=(*RESULTS, RECORDS)
    )
    tally = _Tally(total=plan.count, progress=progress)
    for finished in read_finished(store):
        tally.add(finished)
    return store, tally


def _complete_pieces(
    plan: Plan, store: Opened, engine: Engine, tally: _Tally, notice: Notice
) -> None:
    """Compute what is missing, anew where a worker is lost."""
    left = set(range(count_pieces(plan))) - store.pieces
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
                detail = Message(
                    "sweep-piece-lost", done=tally.done, count=plan.count, piece=min(left)
                )
                raise ComputationError(Outcome.WORKER_LOST, detail) from error
        except _NoSchedulerError as error:
            if not losses:
                place = engine.scheduler
                raise _wrong_address("sweep-no-scheduler", place, why=error.why) from error
            detail = Message(
                "sweep-scheduler-gone",
                address=engine.scheduler,
                done=tally.done,
                count=plan.count,
            )
            raise ComputationError(Outcome.SCHEDULER_LOST, detail) from error


class _Tally:
    """Counts for the progress bar."""

    def __init__(self, *, total: int, progress: Progress) -> None:
        self.total, self.done, self.failures = total, 0, 0
        self.progress = progress

    def add(self, finished: Finished) -> None:
        self.done += len(finished.rows)
        self.failures += sum(row[-2] != DONE for row in finished.rows)
        self.progress(self.done, self.total, self.failures)


def _work(
    plan: Plan, store: Opened, lane: Lane, left: set[int], tally: _Tally, notice: Notice
) -> None:
    """Keep a few pieces under way and write each one as it comes in."""
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
            work = running.pop(future)
            answers = future.result()
            _keep(store, work, answers)
            left.discard(work.piece)
            tally.add(Finished(piece=work.piece, rows=tuple(answer.row for answer in answers)))


def _keep(store: Opened, work: Work, answers: tuple[Answer, ...]) -> None:
    records = store.path.parent / RECORDS
    for number, answer in enumerate(answers):
        if answer.record:
            path = records / f"case-{work.first + number:06d}.json"
            try:
                records.mkdir(exist_ok=True)
                replace_file(path, answer.record.encode())
            except OSError as error:
                raise disk_full(path, error) from error
    append(store, Finished(piece=work.piece, rows=tuple(answer.row for answer in answers)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lane:
    """An executor and how many pieces it gets ahead.

    Parameters
    ----------
    executor
        Of ``concurrent.futures``, or one that behaves so.
    width
        Tells how many pieces are to be under way: enough to keep every worker busy, so that memory
        stays flat; 0 while there is no worker.
    """

    executor: Executor
    width: Callable[[], int]


class _NoSchedulerError(Exception):
    """A cluster's scheduler does not answer; ``why`` in words."""

    def __init__(self, why: Message | str) -> None:
        super().__init__(why)
        self.why = why


@contextmanager
def open_lane(engine: Engine) -> Iterator[Lane]:
    """Yield what runs the work; what has not begun is dropped at the end."""
    if engine.scheduler:
        with _open_cluster(engine.scheduler) as lane:
            yield lane
        return
    alone = engine.workers == 1
    others = multiprocessing.active_children()
    executor = Immediate() if alone else _open_pool(engine.workers)
    width = 1 if alone else 2 * engine.workers
    try:
        yield Lane(executor=executor, width=lambda: width)
    except BaseException:
        # Nobody waits minutes for slow cases whose rows would be dropped; workers own no files.
        for worker in multiprocessing.active_children():
            if worker not in others:
                worker.kill()
        raise
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


def _open_pool(workers: int) -> Executor:
    # Matrices have some ten rows: threads inside a worker cost more than they give, and the order
    # of summation would change with their number.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    shield_tracker()
    return ProcessPoolExecutor(
        workers, mp_context=multiprocessing.get_context("spawn"), initializer=_prepare_worker
    )


def _prepare_worker() -> None:
    """Leave Ctrl-C to the parent, and end when the parent has ended, even by force."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _open_cluster(address: str) -> Iterator[Lane]:
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        message = Message("sweep-no-cluster-extra")
        raise InputError([Fault(where="--scheduler", message=message)]) from error
    scheme, separator, _ = address.partition("://")
    if separator and scheme not in ("tcp", "tls"):
        raise _wrong_address("sweep-other-scheme", address)
    _hush()
    try:
        client = _within_patience(lambda: Client(address, timeout=10))
    except TypeError as error:
        # What Dask says where tls:// finds no certificate among its settings.
        raise _wrong_address("sweep-no-certificate", address) from error
    except (OSError, ValueError) as error:
        why = _last_words(error)
        if any(isinstance(cause, SSLError | FileNotFoundError) for cause in _chain(error)):
            raise _wrong_address("sweep-certificate-refused", address, why=why) from error
        raise _NoSchedulerError(why) from error
    except _NoSchedulerError:
        raise
    except Exception as error:  # what listens there is no scheduler: Dask stumbles over its answer
        raise _NoSchedulerError(Message("sweep-no-dask")) from error

    def width() -> int:
        try:
            return 2 * int(sum(client.nthreads().values()))
        except OSError as error:
            raise BrokenExecutor(str(error)) from error

    with client:
        executor = client.get_executor(pure=False)
        try:
            yield Lane(executor=executor, width=width)
        except KilledWorker as error:
            raise BrokenExecutor(str(error)) from error
        finally:
            executor.shutdown(wait=False)  # else Ctrl-C waits for what no worker computes


def _within_patience(connect: Callable[[], Any]) -> Any:
    """What is connected; somebody may listen, but never say what Dask waits for."""
    found: list[Any] = []

    def attempt() -> None:
        try:
            found.append(connect())
        except Exception as error:
            found.append(error)

    thread = threading.Thread(target=attempt, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    if not found:
        raise _NoSchedulerError(Message("sweep-no-dask"))
    if isinstance(found[0], Exception):
        raise found[0]
    return found[0]


def _wrong_address(kind: str, address: str, **values: Message | str) -> InputError:
    message = Message(kind, address=address, **values)
    return InputError([Fault(where="--scheduler", message=message)])


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    """An error, what caused it, and so on."""
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _last_words(error: BaseException) -> str:
    """What the innermost cause that says anything says."""
    said = [getattr(cause, "strerror", None) or str(cause) for cause in _chain(error)]
    return next(filter(None, reversed(said)), type(error).__name__)


def _hush() -> None:
    """Keep the pages to itself that Dask logs where a scheduler is lost: we say it in a line."""
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
