"""Input shapers as controls have them, with the numbers that are typed in."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.study.shapers import Shaper, zero_vibration


@dataclass(frozen=True, slots=True, kw_only=True)
class TypedShaper:
    """A zero-vibration shaper as a control knows it.

    Parameters
    ----------
    order
        1: ZV, 2: ZVD (its derivative vanishes, too).
    frequency_hz
        Natural frequency that is typed in [Hz].
    damping_ratio
        Typed in [-].
    """

    order: int
    frequency_hz: float
    damping_ratio: float

    @property
    def name(self) -> str:
        """Name in lower case."""
        return self.impulses.name.lower()

    @property
    def impulses(self) -> Shaper:
        """What the control does with these numbers."""
        return zero_vibration(
            self.order, frequency_hz=self.frequency_hz, damping_ratio=self.damping_ratio
        )
