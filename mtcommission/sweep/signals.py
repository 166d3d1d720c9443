"""A polite end of the process counts as Ctrl-C: workers end, and what is done is said.

Without that ``kill``, a closed terminal or a shutdown would end the parent alone. Against kill -9
nothing helps; the workers notice it by themselves, Python's tracker gives back the semaphores of
the pool, and no row is lost.
"""

from __future__ import annotations

import os
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
    """Start the process that gives semaphores back: quiet, and safe from a closed terminal.

    A terminal hangs up on all of its processes; this one knows to ignore Ctrl-C and kill only. Of
    "leaked semaphores" it need not tell: it gives them back, and nobody can do anything about it.
    """
    if not hasattr(signal, "SIGHUP") or threading.current_thread() is not threading.main_thread():
        return
    filters = os.environ.get("PYTHONWARNINGS")
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    os.environ["PYTHONWARNINGS"] = f"{filters},{QUIET}" if filters else QUIET
    try:
        resource_tracker.ensure_running()
    finally:
        signal.signal(signal.SIGHUP, before)
        if filters is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = filters


QUIET = "ignore:resource_tracker"
"""How its warnings begin."""
