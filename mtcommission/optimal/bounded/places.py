"""Places on the time axis, in remaining time: single points, and intervals that hold a bound."""

from __future__ import annotations

from dataclasses import dataclass, replace

FORCE = -1
"""Index by which a constraint point means the force limit, which boundary control keeps there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstraintPoint:
    """A point where a bound is imposed."""

    remaining: float  # Remaining time [s]
    limit: int  # Index of the bound; ``FORCE`` inside an interior where boundary control is limited
    side: int  # +1 or -1
    weight: float = 0.0  # Multiplier, >= 0

    def stretched(self, share: float) -> ConstraintPoint:
        """Return the point with its time multiplied."""
        return replace(self, remaining=self.remaining * share)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcInterior:
    """An interval on which a bound is held and σ = 0."""

    # start, end: Remaining times, start > end [s].
    start: float
    end: float
    limit: int  # Index of the bound
    side: int  # +1 or -1

    def stretched(self, share: float) -> ArcInterior:
        """Return the interval with all times multiplied."""
        return replace(self, start=self.start * share, end=self.end * share)

    def holds(self, remaining: float) -> bool:
        """Return whether a remaining time lies inside."""
        return self.end < remaining < self.start
