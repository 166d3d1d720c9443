"""Numerical settings of a direct transcription; apart from it, since CasADi takes long to load."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Scheme(Enum):
    """Integration scheme of one interval."""

    EULER = "euler"
    TRAPEZOIDAL = "trapezoidal"
    GAUSS = "gauss"


@dataclass(frozen=True, slots=True, kw_only=True)
class TranscriptionSettings:
    """Numerical settings of a direct transcription."""

    scheme: Scheme = Scheme.GAUSS  # Integration scheme
    intervals: int = 1000  # N, at least 2
    # IPOPT's tolerance on the optimality conditions, for an objective of about 1; a looser
    # one blurs the switches over several intervals.
    tolerance: float = 1e-11
    max_iterations: int = 3000  # IPOPT's limit
