"""Numerical settings of the whole chain."""

from __future__ import annotations

from dataclasses import dataclass, field

from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.tuning.tuned import TuningSettings
from mtcommission.optimal.band.settings import BandSettings
from mtcommission.study.robustness import RobustnessSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Numerical settings, all printed on the sheet.

    Parameters
    ----------
    tuning, search
        Of the loop's tuning and of the choice of limits.
    comparison
        The coarser search that decides whether state feedback pays.
    robustness
        How closely the recommendation is looked at where machine or limits differ.
    band
        Of the optimum with the band and of the robust force.
    """

    tuning: TuningSettings = field(default_factory=TuningSettings)
    search: SearchSettings = field(default_factory=SearchSettings)
    comparison: SearchSettings = field(
        default_factory=lambda: SearchSettings(grid=32, coarse_grid=8, seeds=12, refinements=3)
    )
    robustness: RobustnessSettings = field(default_factory=RobustnessSettings)
    band: BandSettings = field(default_factory=BandSettings)
