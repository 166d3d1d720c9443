"""Records as text and files: JSON without infinities."""

from __future__ import annotations

import json
from math import isfinite
from pathlib import Path
from typing import cast

from mtcommission.errors import Fault, InputError
from mtcommission.record.schema import SCHEMA, Record


def dump_json(value: object) -> str:
    """Return JSON text without infinities (they are null), ready to be written."""
    return json.dumps(_finite(value), allow_nan=False, ensure_ascii=False, indent=1) + "\n"


def load_record(path: Path) -> Record:
    """Return a record from its file.

    Parameters
    ----------
    path
        A ``record.json`` of this schema.

    Returns
    -------
    Record

    Raises
    ------
    InputError
        If the file is no such record; says what is wrong.
    """
    try:
        text = path.read_text("utf-8")
        data = json.loads(text)
    except (OSError, ValueError) as error:
        message = f"not a record of mtcommission run: {error}"
        raise InputError([Fault(where=str(path), message=message)]) from error
    missing = (
        sorted(Record.__required_keys__ - data.keys()) if isinstance(data, dict) else ["all keys"]
    )
    if missing:
        message = f"not a record of mtcommission run: {', '.join(missing)} missing"
        raise InputError([Fault(where=str(path), message=message)])
    if data["schema"] != SCHEMA:
        message = (
            f"record schema {data['schema']!r}, this version reads {SCHEMA}; "
            "run the profile again, or print it with the version that wrote it"
        )
        raise InputError([Fault(where=str(path), key="schema", message=message)])
    return cast(Record, data)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return value
