"""Who computes: this process, several of it, or a Dask cluster, all through one interface.

A polite end of the process counts as Ctrl-C: workers end, and what is done is said. Against kill -9
nothing helps; the workers notice it by themselves, and no row is lost.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import Any

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message

PATIENCE = 30.0
"""Seconds that a cluster is waited for."""
QUIET = {
    # Matrices have some ten rows: threads inside a worker cost more than they give, and the order
    # of summation would change with their number.
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    # After kill -9 Python gives leaked semaphores back; it need not tell the user.
    "PYTHONWARNINGS": "ignore:resource_tracker",
}
"""Environment of the workers, where nothing else is asked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Engine:
    """Where the work is done: worker processes here (1: this one), or a Dask scheduler."""

    workers: int = 1
    scheduler: str = ""  # address; "" for none


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lane:
    """An executor and how many pieces it gets ahead.

    Enough to keep every worker busy, few enough that memory stays flat; 0 while there is no worker.
    """

    executor: Executor
    width: Callable[[], int]


class NoSchedulerError(Exception):
    """A cluster's scheduler does not answer; ``why`` in words."""

    def __init__(self, why: Message | str) -> None:
        super().__init__(why)
        self.why = why


class _Immediate(Executor):
    """The executor of one process: computes when it is asked."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Return the finished future of a call."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@contextmanager
def open_lane(engine: Engine) -> Iterator[Lane]:
    """Yield what runs the work; what has not begun is dropped at the end.

    Raises InputError if the address is of no use, NoSchedulerError if nobody answers there.
    """
    if engine.scheduler:
        with _open_cluster(engine.scheduler) as lane:
            yield lane
        return
    alone = engine.workers == 1
    others = multiprocessing.active_children()
    executor = _Immediate() if alone else _open_pool(engine.workers)
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
    for name, value in QUIET.items():
        os.environ.setdefault(name, value)
    _shield_tracker()
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
def _open_cluster(address: str) -> Iterator[Lane]:
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
    client = _within_patience(lambda: Client(address, timeout=10))

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
        except Exception as error:  # Dask stumbles in many ways over what is no scheduler
            found.append(error)

    thread = threading.Thread(target=attempt, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    if not found:
        raise NoSchedulerError(Message("sweep-no-dask"))
    if isinstance(found[0], Exception):
        raise NoSchedulerError(_last_words(found[0])) from found[0]
    return found[0]


def _last_words(error: BaseException) -> str:
    """What the innermost cause that says anything says."""
    chain: list[BaseException] = []
    cause: BaseException | None = error
    while cause is not None:
        chain.append(cause)
        cause = cause.__cause__ or cause.__context__
    said = [getattr(one, "strerror", None) or str(one) for one in chain]
    return next(filter(None, reversed(said)), type(error).__name__)
