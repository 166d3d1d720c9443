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
    """Numerical settings of a direct transcription.

    Parameters
    ----------
    scheme
        Integration scheme.
    intervals
        N, at least 2.
    tolerance
        IPOPT's tolerance on the optimality conditions, for an objective of about 1; a looser
        one blurs the switches over several intervals.
    max_iterations
        IPOPT's limit.
    """

    scheme: Scheme = Scheme.GAUSS
    intervals: int = 1000
    tolerance: float = 1e-11
    max_iterations: int = 3000
