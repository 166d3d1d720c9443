"""What traces say -> the JSON of ``verify``."""

from __future__ import annotations

from mtcommission.messages.message import to_json
from mtcommission.verify.checks import Check
from mtcommission.verify.feedforward import FeedForward
from mtcommission.verify.new_limits import Limits, NewLimits
from mtcommission.verify.refine import Parameter, Refined
from mtcommission.verify.verify import Verification

Entry = dict[str, object]


def verification_entry(
    found: Verification, refined: Refined, fed: FeedForward | None, limits: NewLimits | None
) -> Entry:
    """Return what was found as JSON has it; SI, ``limit`` null where nothing is required."""
    by_key = {check.key: check.measured for check in found.checks}
    return {
        "verdict": found.verdict.value,
        "record": found.record.checksum,
        "traces": [{"file": one.file, "sha256": one.sha256} for one in found.traces],
        "setpoint": {
            "velocity": by_key.get("setpoint velocity"),
            "acceleration": by_key.get("setpoint acceleration"),
            "jerk": by_key.get("setpoint jerk"),
            "obeyed": found.obeyed,
        },
        "checks": [_check(check) for check in found.checks],
        "shift": found.shift,
        "modes": [
            {
                "name": mode.name,
                "frequency_hz": seen.frequency_hz,
                "damping_ratio": seen.damping_ratio,
                "amplitude": seen.amplitude,
                "move": number,
            }
            for number, one in enumerate(found.recorded, start=1)
            for mode, seen in zip(found.rebuilt.plant.modes, one.modes, strict=True)
            if seen is not None
        ],
        "noise_floor": found.noise_floor,
        "unexplained": found.unexplained,
        "refined": {one.name: _parameter(one) for one in refined.parameters},
        "held_back": {
            "moves": refined.tested,
            "unexplained_before": refined.unexplained_before,
            "unexplained_after": refined.unexplained_after,
            "force_unexplained": refined.force_unexplained,
        },
        "feedforward": fed
        and {
            "values": {one.key: _parameter(one) for one in fed.values},
            "moves_held_back": fed.tested,
            "deviation_before": fed.before,
            "deviation_after": fed.after,
        },
        "limits": limits and {"old": _limits(limits.old), "new": _limits(limits.new)},
        "warnings": [to_json(warning) for warning in found.warnings],
    }


def _parameter(one: Parameter) -> Entry:
    return {
        "old": one.old,
        "new": one.new.value,
        "sigma": one.new.sigma,
        "unit": one.unit,
        "changed": one.has_changed,
    }


def _limits(one: Limits | None) -> Entry | None:
    if one is None:
        return None
    return {
        "acceleration": one.acceleration,
        "jerk": one.jerk,
        "settling_time": one.settling_time,
        "met": one.met,
    }


def _check(check: Check) -> Entry:
    return {
        "name": check.name,
        "move": check.move or None,
        "mode": check.mode or None,
        "unit": check.unit,
        "predicted": check.predicted,
        "low": check.low,
        "high": check.high,
        "limit": check.limit,
        "measured": check.measured,
        "uncertainty": check.uncertainty,
        "verdict": check.verdict.value,
        "reason": to_json(check.reason),
    }
