"""A value with its standard error."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A value and its standard error, in the same unit.

    Parameters
    ----------
    value
        Best estimate.
    sigma
        Standard error of this measurement; what differs between machines is not in it.
    """

    value: float
    sigma: float

    @property
    def relative(self) -> float:
        """Standard error by value [-]."""
        return abs(self.sigma / self.value) if self.value else inf
