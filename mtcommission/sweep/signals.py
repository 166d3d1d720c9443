"""A polite end of the process counts as Ctrl-C: workers end, and what is done is said.

Without that ``kill``, a closed terminal or a shutdown would end the parent alone, and Python would
complain of "leaked semaphores", which the pool of workers never came to give back. Against
kill -9 nothing helps; the workers notice it by themselves, and no row is lost.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from types import FrameType

POLITE = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Windows knows no SIGHUP."""


@contextmanager
def end_as_if_by_keyboard() -> Iterator[None]:
    """Raise KeyboardInterrupt in the block where the process is asked to end.

    What is ignored stays so (``nohup``); outside of the main thread, which alone gets signals,
    nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in POLITE}
    replaced = [number for number in POLITE if before[number] is signal.SIG_DFL]
    for number in replaced:
        signal.signal(number, _interrupt)
    try:
        yield
    finally:
        for number in replaced:
            signal.signal(number, before[number])


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def shield_tracker() -> None:
    """Start the process that gives semaphores back so that a closed terminal does not end it.

    A terminal hangs up on all of its processes. This one knows to ignore Ctrl-C and kill only.
    """
    if not hasattr(signal, "SIGHUP") or threading.current_thread() is not threading.main_thread():
        return
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        resource_tracker.ensure_running()
    finally:
        signal.signal(signal.SIGHUP, before)
