"""Numerical settings of the whole chain."""

from __future__ import annotations

from dataclasses import dataclass, field

from mtcommission.loop.tuning.tuned import TuningSettings
from mtcommission.optimal.band.settings import BandSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessSettings:
    """How closely to look where the machine or the limits differ a little.

    Parameters
    ----------
    samples
        Machines drawn from the stated spread (200: a share to within three per cent).
    seed
        Of the generator.
    frequency_range
        Least range of the frequency error looked at, to either side [-]; the stated spread,
        doubled, where that is more.
    frequency_points
        To either side.
    """

    samples: int = 200
    seed: int = 0
    frequency_range: float = 0.1
    frequency_points: int = 15


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Numerical settings, all printed on the sheet.

    Parameters
    ----------
    tuning
        Of the loop's tuning.
    robustness
        How closely the recommendation is looked at where machine or limits differ.
    band
        Of the optimum with the band and of the robust force.
    """

    tuning: TuningSettings = field(default_factory=TuningSettings)
    robustness: RobustnessSettings = field(default_factory=RobustnessSettings)
    band: BandSettings = field(default_factory=BandSettings)
