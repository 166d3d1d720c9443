"""What is poor about a loop, in sentences that belong beside the verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import floor, log10

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.tuned import (
    CornerPlants,
    TunedLoop,
    TuningSettings,
    answer_corners,
    close_within_margins,
    describe_margins,
    has_margins,
)
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import NOMINAL
from mtcommission.messages.message import Message

LOWERED = 0.9
"""Factor from one try of a given gain to the next."""

TRIES = 25
"""A gain is looked for down to 8 % of what was given."""

SOFTENED = 0.5
"""Set-force filters that leave less than this share of the bandwidth are warned about."""

UNDAMPED = 0.5
"""A mode that keeps less than this share of its own damping is warned about."""

Build = Callable[[Machine], Controller]


def has_given_gains(machine: Machine) -> bool:
    """Return whether the profile gives Kv, Kp or Tn."""
    given = machine.control
    gains = (given.position_gain, given.velocity_gain, given.integral_time)
    return any(gain is not None for gain in gains)


def judge_given(
    machine: Machine,
    bench: CornerPlants,
    tuned: TunedLoop,
    *,
    settings: TuningSettings,
    build: Build,
) -> tuple[str, ...]:
    """Return what is poor about a loop with given gains, and which of them to lower.

    Parameters
    ----------
    machine
        With the given gains.
    bench, tuned
        The machine in every corner and its loop there.
    settings
        Required margins.
    build
        The controller of a machine whose gains are all given.

    Returns
    -------
    tuple of str
        Empty if margins and bandwidth suffice.

    Raises
    ------
    ComputationError
        UNSTABLE_LOOP, with the corner.
    """
    found = []
    if not all(has_margins(analysis, settings=settings) for analysis in tuned.analyses):
        cure = _name_cure(machine, bench, tuned.controller, settings=settings, build=build)
        _require_stable(machine, tuned, cure)
        found.append(
            f"The given gains are used as given, but their margins are poor: "
            f"{describe_margins(tuned.analyses)}; wanted are {settings.gain_margin_db:g} dB, "
            f"{settings.phase_margin_deg:g} degrees, sensitivity peak at most "
            f"{settings.sensitivity_peak:g}. {cure}"
        )
    wanted = machine.control.minimum_bandwidth_hz
    if tuned.least_bandwidth_hz < wanted:
        found.append(
            f"With the given gains the closed velocity loop reaches "
            f"{tuned.least_bandwidth_hz:.3g} Hz in its worst corner, less than "
            f"minimum_bandwidth = {wanted:.3g} Hz."
        )
    return tuple(found)


def warn_of_filters(tuned: TunedLoop, unfiltered: TunedLoop) -> Iterator[str]:
    """Yield what set-force filters cost in bandwidth, if that is much.

    Parameters
    ----------
    tuned, unfiltered
        The loops with and without them, both by the same rules.

    Yields
    ------
    str
    """
    with_them, without = tuned.least_bandwidth_hz, unfiltered.least_bandwidth_hz
    if with_them < SOFTENED * without:
        yield (
            f"The set-force filters make the loop soft: its bandwidth is {with_them:.3g} Hz with "
            f"them, {without:.3g} Hz without."
        )


def warn_of_modes(bench: CornerPlants, tuned: TunedLoop) -> Iterator[str]:
    """Yield the modes that the loop damps much less than the structure does.

    Parameters
    ----------
    bench, tuned
        The machine in every corner and its loop there.

    Yields
    ------
    str
    """
    for index, mode in enumerate(bench.model.modes):
        own = [plant.modes[index].damping_ratio for plant in bench.plants]
        closed = [float(analysis.mode_damping[index]) for analysis in tuned.analyses]
        worst = min(range(len(own)), key=lambda i: closed[i] - own[i])
        if closed[worst] < UNDAMPED * own[worst]:
            yield (
                f"The loop takes damping from mode {mode.name}: its damping ratio is "
                f"{closed[worst]:.3g} in the closed loop, {own[worst]:.3g} without control."
            )


def _require_stable(machine: Machine, tuned: TunedLoop, cure: str) -> None:
    for corner, analysis in zip(tuned.corners, tuned.analyses, strict=True):
        if not analysis.is_stable:
            gains = tuned.controller
            where = "the nominal machine" if corner == NOMINAL else str(corner)
            detail = (
                f"with Kv = {gains.position_gain:.4g} 1/s, "
                f"Kp = {gains.velocity_gain:.4g} {machine.axis_units.damping.si}, "
                f"Tn = {gains.integral_time:.4g} s on {where}. {cure}"
            )
            raise ComputationError(
                Outcome.UNSTABLE_LOOP, Message("verbatim", text=detail.rstrip("."))
            )


def _name_cure(
    machine: Machine,
    bench: CornerPlants,
    controller: Controller,
    *,
    settings: TuningSettings,
    build: Build,
) -> str:
    """The largest value of each given gain that keeps the margins, the others as they are."""
    given = machine.control
    fixed = replace(machine, control=replace(given, velocity_gain=controller.velocity_gain))
    answers = answer_corners(bench, controller)

    def keeps(**gains: float) -> bool:
        changed = replace(fixed, control=replace(fixed.control, **gains))  # type: ignore[arg-type]
        found = close_within_margins(bench, build(changed), answers, settings=settings)
        return found is not None

    cures = []
    if given.position_gain is not None:
        Kv = _largest(given.position_gain, lambda value: keeps(position_gain=value))
        cures += [f"Kv up to {Kv:.4g} 1/s"] if Kv else []
    if given.velocity_gain is not None:
        Kp = _largest(given.velocity_gain, lambda value: keeps(velocity_gain=value))
        cures += [f"Kp up to {Kp:.4g} {machine.axis_units.damping.si}"] if Kp else []
    if given.integral_time is not None:
        rate = _largest(1.0 / given.integral_time, lambda value: keeps(integral_time=1.0 / value))
        cures += [f"Tn from {1e3 / rate:.4g} ms on"] if rate else []
    if not cures:
        return "No single gain cures that; leave the gains out to have them tuned."
    return f"The margins would hold with {' or '.join(cures)}, all other given values as they are."


def _largest(value: float, keeps: Callable[[float], bool]) -> float:
    """The largest value of a gain below the given one that keeps, to three digits; 0 if none."""
    for power in range(1, TRIES):
        low = value * LOWERED**power
        if keeps(low):
            high = low / LOWERED
            for _ in range(4):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if keeps(middle) else (low, middle)
            step = 10.0 ** (floor(log10(low)) - 2)
            return floor(low / step) * step
    return 0.0
