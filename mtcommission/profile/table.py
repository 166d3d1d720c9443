"""What every table of a profile has in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, create_model

from mtcommission.machine.keys import list_keys
from mtcommission.machine.mechanics import Misfit
from mtcommission.profile.values import Faults, Read


class Table(BaseModel):
    """A TOML table: unknown keys are faults, and nothing is converted silently."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)


def required(description: str, example: str) -> Any:
    """Return a key that must be given."""
    return Field(description=description, examples=[example])


def optional(description: str, example: str, default: object = None) -> Any:
    """Return a key that may be left out."""
    return Field(default, description=description, examples=[example])


def raise_all(faults: Sequence[Misfit]) -> None:
    """Raise the faults of a table, as pairs of key and message; nothing if there are none."""
    if faults:
        raise Faults(faults)


def keyed_table(name: str, data_type: type[Any]) -> type[Table]:
    """Return the table of the quantities that a dataclass declares; inf is what may be left out."""
    keys: dict[str, Any] = {}
    for key, one, about in list_keys(data_type):
        assert about.allowed is not None
        kind: Any = float if one.default is MISSING else float | None
        form = required if one.default is MISSING else optional
        keys[key] = (
            Annotated[kind, Read(about.allowed)],
            form(about.meaning, f'"{about.example}"'),
        )
    table: type[Table] = create_model(name, __base__=Table, **keys)
    return table
