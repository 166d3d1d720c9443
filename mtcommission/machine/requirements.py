"""[requirements]: what the axis must achieve, and in which corners."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits
from mtcommission.machine import readers as of
from mtcommission.machine.keys import EMPTY, Misfit, Table, keyed
from mtcommission.machine.readers import (
    Array,
    PerSignal,
    Reading,
    Signals,
    SignalValue,
    Word,
    as_typed,
)

LARGEST_FREQUENCY_SPREAD = 0.5
MODE_BANDS = {"surface": 0.4, "accuracy": 1.0, "speed": 4.0}
"""Default bands of the machining modes in units of tcp_deviation (interface)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """[requirements.modes]: allowed residual deviation (the band) in each machining mode [m]."""

    surface: float = keyed(of.BANDS, "Band for finishing.", "2 um", left_out=None)
    accuracy: float = keyed(of.BANDS, "Band for contours.", "5 um", left_out=None)
    speed: float = keyed(of.BANDS, "Band for roughing.", "20 um", left_out=None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reserve:
    """Share of what is allowed that recommendations may use; given limits may use all of it."""

    band: float = keyed(
        of.SHARES,
        "Share of band, contour and peaks that recommendations may use.",
        "0.8",
        default=0.8,
    )
    force: float = keyed(
        of.SHARES,
        "Share of set force and RMS force that recommendations may use.",
        "0.95",
        default=0.95,
    )


NO_RESERVE = Reserve(band=1.0, force=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirements:
    """[requirements]: what the axis must achieve, in every corner; inf: not asked for."""

    tcp_deviation: float = keyed(
        of.BANDS, "Half width of the band about the delayed setpoint.", "5 um"
    )
    max_settling_time: float = keyed(of.TIMES, "Longest settling time.", "0.2 s", default=inf)
    contour_deviation: float = keyed(
        of.BANDS,
        "Allowed deviation from the delayed setpoint during the whole move.",
        "20 um",
        default=inf,
    )
    contour_feed: float = keyed(
        of.VELOCITIES,
        "Largest velocity at which the contour must be kept; left out: that of each move.",
        "2 m/min",
        default=inf,
    )
    reserve: Reserve = keyed(
        Table(Reserve),
        "Share of what is allowed that recommendations may use; 1 must be said.",
        default=NO_RESERVE,
        left_out=EMPTY,
    )
    frequency_spread: float = keyed(
        of.SPREADS,
        "Relative uncertainty of all eigenfrequencies; none must be said.",
        "5 %",
        default=0.0,
        left_out=0.05,
    )
    damping_spread: float = keyed(
        of.SPREADS,
        "Relative uncertainty of all damping ratios; none must be said.",
        "30 %",
        default=0.0,
        left_out=0.3,
    )
    every_size: bool = keyed(
        Word({"every": True, "listed": False}),
        "Whether limits hold for every smaller move, too, or for the listed sizes only.",
        "every",
        key="move_sizes",
        default=False,
        left_out=True,
    )
    payload: tuple[float, float] = keyed(
        Array(of.LOADS, 2, 2),
        "Least and largest payload.",
        '["0 kg", "100 kg"]',
        default=(0.0, 0.0),
    )
    payload_radius: float = keyed(
        of.ARMS,
        "Radius of gyration of the payload about the rotary joint.",
        "0.3 m",
        default=0.0,
    )  # 0 leaves the inertia alone
    peaks: tuple[SignalValue, ...] = keyed(
        Signals(PerSignal.BOUND),
        "Bounds on states or outputs during the whole response.",
        '{ v_phi = "5 mrad/s" }',
        default=(),
    )
    modes: Modes = keyed(Table(Modes), "Band of each machining mode.", left_out=EMPTY)

    @classmethod
    def complete(
        cls, values: dict[str, Any], stated: Mapping[str, Any], reading: Reading
    ) -> dict[str, Any]:
        """Return the values with the bands that were left out."""
        given = values["modes"]
        bands = {
            mode: getattr(given, mode) or share * values["tcp_deviation"]
            for mode, share in MODE_BANDS.items()
        }
        return {**values, "modes": Modes(**bands)}

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        """Yield spreads that are too large, and what does not fit together."""
        if self.frequency_spread > LARGEST_FREQUENCY_SPREAD:
            message = Message("frequency-spread-large", got=self.frequency_spread)
            yield "frequency_spread", message
        if self.damping_spread >= 1.0:
            yield "damping_spread", Message("damping-ratio-beyond-one", got=self.damping_spread)
        if isfinite(self.contour_feed) and not isfinite(self.contour_deviation):
            yield "contour_feed", Message("contour-feed-without-deviation")
        low, high = self.payload
        if low > high:
            ends = zip(stated["payload"], self.payload, strict=True)
            first, last = (as_typed(given, end, axis.mass.si) for given, end in ends)
            yield "payload", Message("payload-reversed", first=first, last=last)
        if self.payload_radius < 0.0:
            got = self.payload_radius
            yield "payload_radius", Message("must-be-at-least", got=got, bound=0.0, unit="")
