"""The cascade alone: given gains as given, the rest by rule, Kp lowered until the margins hold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.cascade import build_cascade, explain_cascade
from mtcommission.loop.tuning.judgement import (
    judge_given,
    warn_of_filters,
    warn_of_modes,
)
from mtcommission.loop.tuning.tuned import (
    CornerPlants,
    TunedLoop,
    TuningSettings,
    close_loop,
    close_within_margins,
    corner_plants,
    describe_margins,
    scan_corners,
)
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message

LEAST_FRACTION = 0.01
"""Below a hundredth of the symmetrical optimum a loop is not tuned but given up (empirical)."""


def tune_cascade(machine: Machine, settings: TuningSettings) -> TunedLoop:
    """Return the cascade alone, with the minimum bandwidth.

    Parameters
    ----------
    machine, settings
        As for ``tune_loop``; what the profile says about state feedback does not count.

    Returns
    -------
    TunedLoop

    Raises
    ------
    ComputationError
        BANDWIDTH_OUT_OF_REACH, and those of ``close_cascade``.
    """
    tuned = close_cascade(machine, settings)
    lacking = lacking_bandwidth(machine, tuned)
    if lacking:
        raise ComputationError(Outcome.BANDWIDTH_OUT_OF_REACH, lacking)
    return tuned


def lacking_bandwidth(machine: Machine, tuned: TunedLoop) -> Message | None:
    """Return what a cascade by the rules lacks; None if nothing, and for given gains.

    Parameters
    ----------
    machine, tuned
        The machine and its cascade.

    Returns
    -------
    Message or None
    """
    given = machine.control
    reached, wanted = tuned.least_bandwidth_hz, given.minimum_bandwidth_hz
    if given.velocity_gain is not None or reached >= wanted:
        return None
    return Message("loop-lacks-bandwidth", reached=reached, wanted=wanted)


def close_cascade(machine: Machine, settings: TuningSettings) -> TunedLoop:
    """Return the cascade alone, even if it lacks bandwidth.

    Parameters
    ----------
    machine, settings
        As for ``tune_cascade``.

    Returns
    -------
    TunedLoop
        With what there is to warn of.

    Raises
    ------
    ComputationError
        UNSTABLE_LOOP, MARGINS_OUT_OF_REACH or UNDAMPED_MODE.
    """
    bench = corner_plants(machine)
    tuned = _close_cascade(machine, bench, settings)
    tuned = replace(tuned, remarks=explain_cascade(machine, tuned.controller))

    def build(changed: Machine) -> Controller:
        return build_cascade(changed, bench.model, fraction=1.0)

    warnings = list(warn_of_modes(bench, tuned))
    if machine.control.has_given_gains:
        warnings += judge_given(machine, bench, tuned, settings=settings, build=build)
    return replace(tuned, warnings=(*warnings, *filter_warnings(machine, tuned, settings)))


def design_cascade(machine: Machine, bench: CornerPlants, settings: TuningSettings) -> Controller:
    """Return the gains of the cascade: given ones as given, the others as if none was given.

    Parameters
    ----------
    machine, bench, settings
        The machine, its plants in every corner, and required margins.

    Returns
    -------
    Controller

    Raises
    ------
    ComputationError
        MARGINS_OUT_OF_REACH or UNDAMPED_MODE.
    """
    given = machine.control
    if given.velocity_gain is not None:
        _require_damping(bench)
        return build_cascade(machine, bench.model, fraction=1.0)
    found = _close_by_rule(machine, bench, settings).controller
    Kv, Tn = given.position_gain, given.integral_time
    return replace(
        found,
        position_gain=found.position_gain if Kv is None else Kv,
        integral_time=found.integral_time if Tn is None else Tn,
    )


def _close_cascade(machine: Machine, bench: CornerPlants, settings: TuningSettings) -> TunedLoop:
    if machine.control.has_given_gains:
        return close_loop(bench, design_cascade(machine, bench, settings))
    return _close_by_rule(machine, bench, settings)


def filter_warnings(
    machine: Machine, tuned: TunedLoop, settings: TuningSettings
) -> tuple[Message, ...]:
    """Return the warning that set-force filters make a loop soft, if they do.

    Parameters
    ----------
    machine, tuned, settings
        The machine, its loop, and required margins.

    Returns
    -------
    tuple of Message
    """
    if not machine.control.force_filters:
        return ()
    without = replace(machine, control=replace(machine.control, force_filters=()))
    return tuple(warn_of_filters(tuned, close_cascade(without, settings)))


def _require_damping(bench: CornerPlants) -> None:
    """A mode without damping that the encoder does not see rings for ever under any cascade."""
    for mode in bench.model.modes:
        if mode.damping_ratio == 0.0 and mode.measured_gain == 0.0:
            raise ComputationError(
                Outcome.UNDAMPED_MODE,
                Message("loop-mode-without-damping", mode=mode.name, frequency=mode.frequency_hz),
            )


