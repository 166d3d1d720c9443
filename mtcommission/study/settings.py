"""Numerical settings of the whole chain."""

from __future__ import annotations

from dataclasses import dataclass, field

from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.tuning.tuned import TuningSettings
from mtcommission.optimal.band.settings import BandSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessSettings:
    """How closely to look where the machine or the limits differ a little.

    Parameters
    ----------
    samples
        Machines drawn from the stated spread (1000: half a second, and a share to within one
        or two per cent; a study may take 10 000).
    seed
        Of the generator.
    sample_cycles
        Position cycles of all samples together: on slow moves fewer machines are drawn, so that
        the time that it takes stays bounded; 100 at least.
    frequency_range
        Least range of the frequency error looked at, to either side [-]; the stated spread,
        doubled, where that is more.
    frequency_points
        To either side.
    """

    samples: int = 1000
    seed: int = 0
    sample_cycles: int = 1_000_000
    frequency_range: float = 0.1
    frequency_points: int = 40


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
