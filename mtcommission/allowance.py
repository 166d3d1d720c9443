"""How much one command computes: counted beforehand or on the way, and never more than that.

Work is counted in steps of a nanosecond on the machine on which it was calibrated, from the sizes
of the arrays that are computed and not from a clock: the same profile ends the same way on every
computer. Whoever computes what grows with the machine, its moves or its corners says so with
``spend``; whoever can do without a part gives it an allowance of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import inf
from typing import TypeVar

from mtcommission.errors import ComputationError, Outcome, TooMuchError
from mtcommission.messages.message import Message

Found = TypeVar("Found")

SECOND = 1e9
"""Steps that take about a second of processor time (calibrated on shipped and random machines)."""

WHOLE = 43.0
"""What a command may take, about that many seconds."""

PART = 8.0
"""The same of a part that it can do without."""

KEPT, LEAST = 5.0, 0.3
"""What such parts leave of the whole, and what each gets all the same, in seconds."""

CALL = 4e3
"""Steps that any call of the numerical libraries takes, however small its arrays."""

LARGEST = 20_000_000
"""Numbers in one array at most: 160 MB, of which a few are needed at once."""


@dataclass(slots=True, kw_only=True)
class _Allowance:
    """Steps that are left of one, what it was [s]; ``whole``: of the command."""

    left: float
    seconds: float
    whole: bool


_given: ContextVar[tuple[_Allowance, ...]] = ContextVar("_given", default=())


@contextmanager
def allow_whole(seconds: float = WHOLE) -> Iterator[None]:
    """Let a command, or a case of a sweep, compute so much at most.

    Parameters
    ----------
    seconds
        About as many of processor time.

    Raises
    ------
    TooMuchError
        From within, where it takes more; what catches failures of a part lets it pass.
    """
    with _within(_Allowance(left=seconds * SECOND, seconds=seconds, whole=True)):
        yield


@contextmanager
def allow_part(seconds: float = PART) -> Iterator[None]:
    """Let a part that can be done without compute so much at most.

    Less where the whole has little left: ``KEPT`` is for what cannot be done without.

    Parameters
    ----------
    seconds
        About as many of processor time.

    Raises
    ------
    ComputationError
        TOO_MUCH_TO_COMPUTE, from within, where it takes more.
    """
    spare = min((item.left for item in _given.get() if item.whole), default=inf) / SECOND - KEPT
    seconds = max(min(seconds, spare), LEAST)
    with _within(_Allowance(left=seconds * SECOND, seconds=seconds, whole=False)):
        yield


def find_part(
    find: Callable[[], Found], *, otherwise: Callable[[Message], Found], seconds: float = PART
) -> Found:
    """Return a part that can be done without, or what stands for it.

    Parameters
    ----------
    find
        Computes it.
    otherwise
        Makes what stands for it of the outcome, where it is too much to compute.
    seconds
        About as many of processor time are allowed.

    Raises
    ------
    ComputationError
        Any other outcome.
    """
    try:
        with allow_part(seconds):
            return find()
    except ComputationError as error:
        if error.outcome is not Outcome.TOO_MUCH_TO_COMPUTE:
            raise
        return otherwise(error.message)


@contextmanager
def _within(item: _Allowance) -> Iterator[None]:
    token = _given.set((*_given.get(), item))
    try:
        yield
    finally:
        _given.reset(token)


def spend(values: float, *, calls: float = 1.0) -> None:
    """Count what is about to be computed.

    Parameters
    ----------
    values
        Numbers that are computed, times what each takes [ns].
    calls
        Of the numerical libraries.

    Raises
    ------
    TooMuchError
        The command has used up what it was allowed.
    ComputationError
        TOO_MUCH_TO_COMPUTE: a part has, that can be done without.
    """
    steps = values + CALL * calls
    for item in _given.get():  # the command's own before those of its parts
        item.left -= steps
        if item.left < 0.0:
            _stop(item)


def left() -> float:
    """Return what is left of the narrowest allowance; inf where none is given."""
    return min((max(item.left, 0.0) for item in _given.get()), default=inf)


def require_room(values: float, *, array: str) -> None:
    """Raise TOO_MUCH_TO_COMPUTE where an array would have more than ``LARGEST`` numbers.

    Parameters
    ----------
    values
        How many.
    array
        Its kind of message.
    """
    if values > LARGEST:
        detail = Message("allowance-array", what=Message(array), values=values, most=float(LARGEST))
        raise ComputationError(Outcome.TOO_MUCH_TO_COMPUTE, detail)


def _stop(item: _Allowance) -> None:
    kind = "allowance-whole" if item.whole else "allowance-part"
    detail = Message(kind, seconds=item.seconds)
    raise (TooMuchError if item.whole else ComputationError)(Outcome.TOO_MUCH_TO_COMPUTE, detail)
