"""Numerical settings of the whole chain."""

from __future__ import annotations

from dataclasses import dataclass, field

from mtcommission.loop.tuning.tuned import TuningSettings
from mtcommission.optimal.band.settings import BandSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessSettings:
    """How closely to look where the machine or the limits differ a little."""

    samples: int = 200  # drawn from the stated spread: a share to within three per cent
    seed: int = 0  # of the generator
    frequency_range: float = 0.1  # of the error, to either side; twice the spread if that is more
    frequency_points: int = 15  # to either side


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Numerical settings, all printed on the sheet."""

    tuning: TuningSettings = field(default_factory=TuningSettings)
    robustness: RobustnessSettings = field(default_factory=RobustnessSettings)
    band: BandSettings = field(default_factory=BandSettings)
