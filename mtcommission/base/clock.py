"""The date of a record."""

from __future__ import annotations

import os

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message


def now() -> str:
    """Date and time of the record; SOURCE_DATE_EPOCH fixes it for repeatable builds."""
    from datetime import UTC, datetime

    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        moment = datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)
    except (ValueError, OverflowError, OSError) as error:
        message = Message("cli-no-epoch", got=str(fixed)[:40])
        raise InputError([Fault(where="SOURCE_DATE_EPOCH", message=message)]) from error
    return moment.isoformat(timespec="seconds")
