"""Writes docs/profile.md from the schema of profiles: ``python -m tests.profile_page``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mtcommission.machine.profile.describe import profile_schema

PAGE = Path(__file__).parent.parent / "docs" / "profile.md"

HEAD = """\
# The keys of a profile

A quantity is an SI number or a text with a unit, `"44.41 N/um"`. An unknown key is a fault with its
line; `mtcommission check PROFILE` names all of them at once. On a rotary axis (`machine.motion`)
inertia stands for mass, torque for force and rad for m. This page is written from the tables of the
machine in `mtcommission/machine/` by `python -m tests.profile_page`; a test holds the two together.
`mtcommission check PROFILE --schema` prints the same as JSON schema, for editors.
"""

TITLES = {
    "About": "[machine]",
    "Manipulator": '[plant] with kind = "manipulator"',
    "Modal": '[plant] with kind = "modal"',
    "FlexibleMode": "[[plant.modes]]",
    "BaseExcited": '[plant] with kind = "modal", below a motor that follows its setpoint',
    "HeldMode": "[[plant.modes]], below a motor that follows its setpoint",
    "Drive": "[drive]",
    "PositionSource": '[drive] with kind = "position_source": the motor follows its setpoint',
    "CurvePoint": "elements of drive.acceleration_curve",
    "VelocityStep": "[[moves]], to a velocity",
    "Positioning": "[[moves]], over a distance",
    "Requirements": "[requirements]",
    "Reserve": "reserve in [requirements]",
    "Modes": "[requirements.modes]",
    "DampingOptimal": "[damping_optimal]",
    "Control": "[control]",
    "SetpointFilter": "setpoint_filter in [control] and [today]",
    "ForceFilter": "elements of force_filters in [control]",
    "MachineState": "[[machine_states]]: of [plant] what differs there",
    "FlexibleModeInState": "[[machine_states.modes]], by their names",
    "HeldModeInState": "[[machine_states.modes]], below a motor that follows its setpoint",
    "Today": "[today]",
    "Identification": "[identified]",
    "MeasuredFile": "[[identified.files]]",
    "MeasuredMode": "[[identified.modes]]",
    "ShaperProposal": "[[identified.calibrate_shaper]]",
}
"""Where each table of the schema stands, in the order of the page."""


def write_page() -> str:
    """Return the page."""
    schema = json.loads(profile_schema())
    assert set(TITLES) == set(schema["$defs"])
    parts = [HEAD, "## Tables\n", *_rows(schema)]
    for name, title in TITLES.items():
        parts += [f"## {title}\n", *_rows(schema["$defs"][name])]
    return "\n".join(parts)


def _rows(table: dict[str, Any]) -> list[str]:
    rows = ["| key | | unit | example | left out |", "|---|---|---|---|---|"]
    for key, one in table["properties"].items():
        unit, rotary = (
            one.get(name, "").replace("no unit", "-") for name in ("x-unit", "x-unit-rotary")
        )
        unit = unit if unit == rotary else f"{unit} ({rotary})"
        default = "must be given" if key in table["required"] else _shown(one.get("default"))
        example = one.get("examples", [json.dumps(one["const"]) if "const" in one else ""])[0]
        words = f" ({', '.join(one['enum'])})" if "enum" in one else ""
        example = f"`{example}`" if example else ""
        rows.append(f"| `{key}` | {one['description']}{words} | {unit} | {example} | {default} |")
    return [*rows, ""]


def _shown(default: object) -> str:
    return "" if default is None else json.dumps(default)


if __name__ == "__main__":
    PAGE.write_text(write_page(), encoding="utf-8")
