"""[identified] of a profile: what was measured, for the sheet, and the file with the points."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

import tomlkit
from tomlkit.items import Table

from mtcommission.machine.identified import (
    LONGEST_FILE,
    MOST_FILES,
    Estimate,
    MeasuredMode,
    ShaperProposal,
)
from mtcommission.plant.modal import MOST_MODES
from mtcommission.record.identified import IdentifiedPart, evidence_checksum
from mtcommission.record.shape import to_plain
from mtcommission.units.axis_units import LINEAR, ROTARY

LONGEST_TIME = 1.0
"""Standard error of a delay that nothing determines [s]."""


def evidence_file(profile: str) -> str:
    """Return the name of the file with points and advice that belongs beside a profile.

    Examples
    --------
    >>> evidence_file("axes/x.toml")
    'axes/x.identified.json'
    """
    return str(PurePath(profile).with_suffix(".identified.json"))


def statement(part: IdentifiedPart, *, evidence: str, names: dict[str, str] | None = None) -> Table:
    """Return [identified] as tomlkit has it."""
    unit = ROTARY if part.rotary else LINEAR
    table = tomlkit.table()
    table["date"] = part.created[:10]
    if part.band_hz:
        table["band"] = [f"{f:.6g} Hz" for f in part.band_hz]
    if part.misfit is not None:
        table["misfit"] = float(f"{part.misfit:.3g}")
    if part.moving_mass:
        table["moving_mass"] = _pair(part.moving_mass, unit.mass.si)
    for key, one in (("delay", part.delay), ("lag", part.lag)):
        if one:
            table[key] = [f"{one.value:.6g} s", f"{min(one.sigma, LONGEST_TIME):.3g} s"]
    if evidence:
        table["evidence"] = evidence
        table["checksum"] = evidence_checksum(to_plain(part))
    for key, rows in (
        ("calibrate_shaper", [_proposal(one) for one in part.proposals]),
        ("files", [_file(one) for one in part.sources[:MOST_FILES]]),
        ("modes", [_mode(m, part, names or {}) for m in part.modes[: 4 * MOST_MODES]]),
    ):
        tables = tomlkit.aot()
        for row in rows:
            inner = tomlkit.table()
            inner.update(row)
            tables.append(inner)
        if rows:
            table[key] = tables
    return table


def _file(one: Any) -> dict[str, str]:
    name = "".join(letter for letter in one.name if letter.isprintable())
    return {"name": name[-LONGEST_FILE:], "sensor": one.sensor, "sha256": one.sha256}


def _proposal(one: ShaperProposal) -> dict[str, str | float | bool]:
    return {
        "shaper": one.shaper,
        "frequency": f"{one.frequency_hz:.6g} Hz",
        "vibration": float(f"{one.vibration:.3g}"),
        "smoothing": f"{1e3 * one.smoothing:.3g} mm",
        "max_acceleration": f"{one.max_acceleration:.6g} m/s^2",
        "recommended": one.is_recommended,
    }


def _mode(mode: MeasuredMode, part: IdentifiedPart, names: dict[str, str]) -> dict[str, Any]:
    gain = "" if part.base_excited else (ROTARY if part.rotary else LINEAR).gain.si
    found: dict[str, Any] = {
        "name": names.get(mode.name, mode.name),
        "frequency": _pair(mode.frequency_hz, "Hz"),
        "damping_ratio": _pair(mode.damping_ratio, ""),
    }
    if part.moving_mass is not None or part.base_excited:
        for key, one in (("measured_gain", mode.measured_gain), ("tcp_gain", mode.tcp_gain)):
            if one is not None:
                found[key] = _pair(one, gain)
    return found


def _pair(one: Estimate, unit: str) -> list[Any]:
    """Value and standard error; one larger than the value says that nothing determines it."""
    value, sigma = f"{one.value:.6g}", f"{min(one.sigma, abs(one.value)):.3g}"
    return [f"{value} {unit}", f"{sigma} {unit}"] if unit else [float(value), float(sigma)]
