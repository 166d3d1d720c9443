"""What was identified -> the JSON of ``identify``."""

from __future__ import annotations

import numpy as np

from mtcommission.identify.check import Checked
from mtcommission.identify.fit.estimate import Estimate
from mtcommission.identify.identified import Identified
from mtcommission.messages.message import to_json

Entry = dict[str, object]


def identified_entry(found: Identified, *, checks: tuple[Checked, ...], profile: str) -> Entry:
    """Return what was identified as JSON has it.

    Parameters
    ----------
    found
        The axis.
    checks
        The model against the records.
    profile
        Text of the profile.
    """
    measured = found.measurements
    bands = [fit.band_hz for fit in found.fits]
    misfits = [fit.misfit for fit in found.fits]
    return {
        "files": list(dict.fromkeys(one.source.file for one in measured)),
        "sensor": {one.source.name: one.sensor.value for one in measured},
        "band_hz": [min(b[0] for b in bands), max(b[1] for b in bands)] if bands else None,
        "moving_mass": _estimate(found.moving_mass),
        "delay": _estimate(found.delay),
        "modes": [
            {
                "name": mode.name,
                "frequency_hz": _estimate(mode.frequency_hz),
                "damping_ratio": _estimate(mode.damping_ratio),
                "measured_gain": _estimate(mode.measured_gain),
                "tcp_gain": _estimate(mode.tcp_gain),
            }
            for mode in found.modes
        ],
        "states": [
            {
                "name": state.name,
                "moving_mass": _estimate(state.moving_mass),
                "modes": [
                    {
                        "frequency_hz": _estimate(mode.frequency_hz),
                        "damping_ratio": _estimate(mode.damping_ratio),
                        "measured_gain": _estimate(mode.measured_gain),
                        "tcp_gain": _estimate(mode.tcp_gain),
                    }
                    for mode in state.modes
                ],
            }
            for state in found.states
        ],
        "spread": {
            "frequency": found.spread.frequency,
            "damping": found.spread.damping,
            "because": [to_json(why) for why in found.spread.because],
        },
        "misfit": float(np.sqrt(np.mean(np.square(misfits)))) if misfits else None,
        "checks": [
            {"record": one.record, "explained": one.explained, "held_back": one.is_held_back}
            for one in checks
        ],
        "warnings": [to_json(message) for message in found.warnings],
        "profile": profile,
    }


def _estimate(one: Estimate | None) -> Entry | None:
    return None if one is None else {"value": one.value, "sigma": one.sigma}
