"""What is poor about a loop, which belongs beside the verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial, reduce
from math import floor, log10

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.tuning.cascade import CLASSIC
from mtcommission.loop.tuning.family import CLOSER, LoopFamily, tune_on_grid, tune_shape
from mtcommission.loop.tuning.tuned import CornerPlants, TunedLoop, describe_margins, has_margins
from mtcommission.machine.variations import NOMINAL, Corner
from mtcommission.messages.message import Message

LOWERED = 0.8
"""Factor from one try of a given gain to the next."""

TRIES = 32
"""A gain is looked for down to a thousandth of what was given."""

SOFTENED = 0.5
"""Set-force filters that leave less than this share of the bandwidth are warned about."""

UNDAMPED = 0.5
"""A mode that keeps less than this share of its own damping is warned about."""


def judge_given(family: LoopFamily, tuned: TunedLoop) -> tuple[Message, ...]:
    """Return what is poor about a loop with given gains, and which of them to lower.

    Empty if margins and bandwidth suffice. ``family``: of the machine with the given gains;
    ``tuned``: its loop in every corner.

    Raises
    ------
    ComputationError
        UNSTABLE_LOOP, with the corner.
    """
    found, settings = [], family.settings
    if not all(has_margins(analysis, settings=settings) for analysis in tuned.analyses):
        cure = _name_cure(family)
        _require_stable(tuned, cure)
        found.append(
            Message(
                "loop-given-gains-poor",
                margins=describe_margins(tuned.analyses),
                gain=settings.gain_margin_db,
                phase=settings.phase_margin_deg,
                peak=settings.sensitivity_peak,
                cure=cure,
            )
        )
    reached, wanted = tuned.least_bandwidth_hz, family.machine.control.minimum_bandwidth_hz
    if reached < wanted:
        found.append(Message("loop-given-gains-slow", reached=reached, wanted=wanted))
    return tuple(found)


def warn_of_filters(tuned: TunedLoop, unfiltered: TunedLoop) -> Iterator[Message]:
    """Yield what set-force filters cost in bandwidth, if that is much.

    ``tuned`` and ``unfiltered`` are the loops with and without them, both by the same rules.
    """
    with_them, without = tuned.least_bandwidth_hz, unfiltered.least_bandwidth_hz
    if with_them < SOFTENED * without:
        yield Message("loop-filters-soften", filtered=with_them, unfiltered=without)


def warn_of_modes(bench: CornerPlants, tuned: TunedLoop) -> Iterator[Message]:
    """Yield the modes that the loop damps much less than the structure does."""
    for index, mode in enumerate(bench.model.modes):
        own = [plant.modes[index].damping_ratio for plant in bench.plants]
        closed = [float(analysis.mode_damping[index]) for analysis in tuned.analyses]
        worst = min(range(len(own)), key=lambda i: closed[i] - own[i])
        if closed[worst] < UNDAMPED * own[worst]:
            yield Message(
                "loop-takes-damping", mode=mode.name, closed=closed[worst], own=own[worst]
            )


def _require_stable(tuned: TunedLoop, cure: Message) -> None:
    for corner, analysis in zip(tuned.corners, tuned.analyses, strict=True):
        if not analysis.is_stable:
            detail = Message(
                "loop-unstable",
                Kv=tuned.controller.position_gain,
                Kp=tuned.controller.velocity_gain,
                Tn=tuned.controller.integral_time,
                corner=_name_corner(corner),
                cure=cure,
            )
            raise ComputationError(Outcome.UNSTABLE_LOOP, detail)


def _name_corner(corner: Corner) -> tuple[Message, ...]:
    """What distinguishes a corner from the nominal machine."""
    if corner == NOMINAL:
        return (Message("loop-nominal-machine"),)
    found = []
    if corner.payload:
        found.append(Message("loop-corner-payload", value=corner.payload))
    if corner.frequency_factor != 1.0:
        found.append(Message("loop-corner-frequencies", value=corner.frequency_factor))
    if corner.damping_factor != 1.0:
        found.append(Message("loop-corner-damping", value=corner.damping_factor))
    return tuple(found)


def _name_cure(family: LoopFamily) -> Message:
    """The value of each given gain, nearest to it, that keeps the margins.

    The other given gains stay as they are; what is left out is tuned, as it will be then.
    """
    given = family.machine.control

    def with_gain(name: str, value: float) -> LoopFamily:
        control = replace(given, **{name: value})  # type: ignore[arg-type]
        return replace(family, machine=replace(family.machine, control=control))

    cures = []
    if given.position_gain is not None:
        Kv = _largest(given.position_gain, partial(with_gain, "position_gain"))
        cures += [Message("loop-cure-kv", value=Kv)] if Kv else []
    if given.velocity_gain is not None:
        Kp = _largest(given.velocity_gain, partial(with_gain, "velocity_gain"))
        cures += [Message("loop-cure-kp", value=Kp)] if Kp else []
        if not Kp:  # too soft for its integrator, or for Kv
            compliance = _largest(
                1.0 / given.velocity_gain, lambda value: with_gain("velocity_gain", 1.0 / value)
            )
            cures += [Message("loop-cure-kp-from", value=1.0 / compliance)] if compliance else []
    if given.integral_time is not None:
        rate = _largest(
            1.0 / given.integral_time, lambda value: with_gain("integral_time", 1.0 / value)
        )
        cures += [Message("loop-cure-tn", value=1.0 / rate)] if rate else []
    if not cures:
        return Message("loop-no-cure")
    gains = reduce(lambda one, other: Message("loop-one-or-other", first=one, second=other), cures)
    return Message("loop-cure", gains=gains)


def _largest(value: float, with_gain: Callable[[float], LoopFamily]) -> float:
    """The largest value of a gain below the given one with the margins, to three digits; or 0."""

    def seems(gain: float) -> bool:
        return tune_on_grid(with_gain(gain), CLASSIC, largest=1.0) is not None

    for power in range(1, TRIES):
        low = value * LOWERED**power
        if seems(low):
            high = low / LOWERED
            for _ in range(5):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if seems(middle) else (low, middle)
            while tune_shape(with_gain(_round_down(low)), CLASSIC, largest=1.0) is None:
                low *= CLOSER
            return _round_down(low)
    return 0.0


def _round_down(value: float) -> float:
    step = 10.0 ** (floor(log10(value)) - 2)
    return floor(value / step) * step
