"""What every table of a profile has in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from mtcommission.machine.mechanics import Misfit
from mtcommission.profile.values import Faults


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
