"""What the process gives the program: the date, and how it is asked to end."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message

ASKED = ("SIGINT", "SIGTERM", "SIGHUP")
"""How a process is asked to end; Windows knows no SIGHUP."""
LOADING = 0.05
"""Seconds after which it is looked again whether a library has loaded."""


def now() -> str:
    """Date and time of the record; SOURCE_DATE_EPOCH fixes it for repeatable builds."""
    from datetime import UTC, datetime

    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        moment = datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)
    except (ValueError, OverflowError, OSError) as error:
        message = Message("cli-no-epoch", got=str(fixed)[:40])
        raise InputError.at("SOURCE_DATE_EPOCH", message) from error
    return moment.isoformat(timespec="seconds")


@contextmanager
def end_as_if_by_keyboard() -> Iterator[None]:
    """Raise KeyboardInterrupt in the block where the process is asked to end.

    What is ignored stays so (``nohup``); outside of the main thread, which alone gets signals,
    nothing changes. A library that is interrupted while it loads never loads again, and takes the
    interruption for a fault of its own: it is waited for.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    known = [getattr(signal, name) for name in ASKED if hasattr(signal, name)]
    usual = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: old for number in known if (old := signal.getsignal(number)) in usual}
    for number in before:
        signal.signal(number, _interrupt)
    try:
        yield
    finally:
        for number, old in before.items():
            signal.signal(number, old)


def _interrupt(number: int, frame: FrameType | None) -> None:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            threading.Timer(LOADING, os.kill, (os.getpid(), number)).start()
            return
        frame = frame.f_back
    raise KeyboardInterrupt
