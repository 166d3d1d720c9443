"""Who computes: this process, several of it, or a Dask cluster, all as an executor.

A polite end of the process counts as Ctrl-C: workers end, and what is done is said. Against kill -9
nothing helps; the workers notice it by themselves, and no row is lost.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.sweep.solve import Answer, Work, solve_piece

PATIENCE = 30.0
"""Seconds that a cluster is waited for."""
POLL = 0.5
"""Seconds between looks at the keyboard."""
AHEAD = 1000
"""Pieces that a cluster gets ahead: enough for any, few enough that memory stays flat."""
QUIET = {
    # Matrices have some ten rows: a worker's own threads would only take memory.
    "OMP_NUM_THREADS": "1",
    # After kill -9 Python gives leaked semaphores back; it need not tell the user.
    "PYTHONWARNINGS": "ignore:resource_tracker",
}
"""Environment of the workers, where nothing else is asked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Engine:
    """Where the work is done: worker processes here (1: this one), or a Dask scheduler."""

    workers: int = 1
    scheduler: str = ""  # address; "" for none


class NoSchedulerError(Exception):
    """A cluster's scheduler does not answer; ``why`` in words."""

    def __init__(self, why: Message | str) -> None:
        super().__init__(why)
        self.why = why


def solve_pieces(
    works: Iterator[Work], engine: Engine, *, notice: Callable[[Message], None]
) -> Generator[tuple[Work, tuple[Answer, ...]]]:
    """Yield each piece of work with its answers, as they come in; what is dropped ends at once.

    A few pieces are under way: enough to keep every worker busy, few enough that memory stays flat.

    Raises InputError if the address is of no use, NoSchedulerError if nobody answers there,
    BrokenExecutor if a worker is lost.
    """
    if engine.workers == 1 and not engine.scheduler:
        for work in works:
            yield work, solve_piece(work)
        return
    address = engine.scheduler
    ahead = AHEAD if address else 2 * engine.workers
    running: dict[Future[tuple[Answer, ...]], Work] = {}
    with _open_cluster(address, notice) if address else _open_pool(engine.workers) as executor:
        while True:
            for work in islice(works, ahead - len(running)):
                running[executor.submit(solve_piece, work)] = work
            if not running:
                return
            ready, _ = wait(running, timeout=POLL, return_when=FIRST_COMPLETED)
            for future in ready:
                yield running.pop(future), future.result()


@contextmanager
def _open_pool(workers: int) -> Iterator[Executor]:
    others = multiprocessing.active_children()
    for name, value in QUIET.items():
        os.environ.setdefault(name, value)
    _shield_tracker()
    executor = ProcessPoolExecutor(
        workers, mp_context=multiprocessing.get_context("spawn"), initializer=_prepare_worker
    )
    try:
        yield executor
    except BaseException:
        # Nobody waits minutes for slow cases whose rows would be dropped; workers own no files.
        for worker in multiprocessing.active_children():
            if worker not in others:
                worker.kill()
        raise
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


def _prepare_worker() -> None:
    """Leave Ctrl-C to the parent, and end when the parent has ended, even by force."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _shield_tracker() -> None:
    """Start Python's process that gives semaphores back safe from a closed terminal.

    A terminal hangs up on all of its processes; this one knows to ignore Ctrl-C and kill only.
    """
    if hasattr(signal, "SIGHUP") and threading.current_thread() is threading.main_thread():
        before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
        try:
            resource_tracker.ensure_running()
        finally:
            signal.signal(signal.SIGHUP, before)


@contextmanager
def _open_cluster(address: str, notice: Callable[[Message], None]) -> Iterator[Executor]:
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        raise InputError.at("--scheduler", Message("sweep-no-cluster-extra")) from error
    scheme, separator, _ = address.partition("://")
    if separator and scheme not in ("tcp", "tls"):
        raise InputError.at("--scheduler", Message("sweep-other-scheme", address=address))
    # Dask logs pages where a scheduler is lost: we say it in a line.
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
    with _within_patience(lambda: Client(address, timeout=10)) as client:
        if not client.nthreads():
            notice(Message("sweep-waits"))
        executor = client.get_executor(pure=False)
        try:
            yield executor
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
        except Exception as error:  # Dask stumbles in many ways over what is no scheduler
            found.append(error)

    thread = threading.Thread(target=attempt, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    if not found:
        raise NoSchedulerError(Message("sweep-no-dask"))
    if isinstance(found[0], Exception):
        raise NoSchedulerError(str(found[0]) or type(found[0]).__name__) from found[0]
    return found[0]
