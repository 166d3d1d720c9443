"""Commissioning -> Record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version

from mtcommission import __version__
from mtcommission.commission import Commissioning
from mtcommission.limits.optima import Optima
from mtcommission.plant.plant import Plant, kalman_rank
from mtcommission.record.comparisons import comparison_entry
from mtcommission.record.data import describe_move, list_assumptions, list_data
from mtcommission.record.files import find_checksum
from mtcommission.record.limits import limits_part
from mtcommission.record.loop import loop_part
from mtcommission.record.moves import assessment_part, move_entry
from mtcommission.record.optima import optimum_entry
from mtcommission.record.robustness import robustness_part
from mtcommission.record.schema import (
    SCHEMA,
    MachineEntry,
    ModeEntry,
    OptimaEntry,
    PlantEntry,
    Profile,
    Record,
    Tool,
    Words,
)
from mtcommission.record.shape import entry_of, to_plain


def build_record(
    commissioning: Commissioning, *, profile: Profile, created: str, warnings: Sequence[Words]
) -> Record:
    """Return the record of a commissioning.

    Parameters
    ----------
    commissioning
        What was computed.
    profile
        Name, hash and text of the profile that it came from.
    created
        Date and time, ISO 8601.
    warnings
        Physical warnings about the profile; those about its loop and its robustness are added.

    Returns
    -------
    Record
    """
    machine, plant = commissioning.machine, commissioning.plant
    robustness = robustness_part(machine, commissioning.robustness)
    limits = limits_part(commissioning)
    record = Record(
        schema=SCHEMA,
        checksum="",
        tool=Tool(name="mtcommission", version=__version__, libraries=_library_versions()),
        created=created,
        profile=profile,
        machine=entry_of(
            MachineEntry, machine, motion=machine.motion.value, kind=machine.mechanics.kind
        ),
        data=list_data(machine, plant, profile.text),
        settings=_settings_entry(commissioning),
        assumptions=[*list_assumptions(machine)],
        warnings=[
            *warnings,
            *limits.warnings,
            *commissioning.tuned.warnings,
            *robustness.warnings,
        ],
        plant=_plant_entry(plant),
        optima=[_optima_entry(plant, item) for item in commissioning.optima],
        limits=limits,
        loop=loop_part(commissioning),
        moves=[move_entry(plant, commissioning.tuned, result) for result in commissioning.moves],
        comparisons=[
            comparison_entry(machine, plant, item, result)
            for item, result in zip(commissioning.comparisons, commissioning.moves, strict=True)
        ],
        robustness=robustness,
        assessment=assessment_part(commissioning.assessment, machine.requirements.reserve),
    )
    return replace(record, checksum=find_checksum(to_plain(record)))


def _settings_entry(commissioning: Commissioning) -> dict[str, float | str]:
    """Every numerical setting, with the name of its group."""
    found: dict[str, float | str] = {}
    for group, values in asdict(commissioning.settings).items():
        for name, value in values.items():
            shown = value if isinstance(value, int | float) else ", ".join(map(str, value))
            found[f"{group}.{name}"] = shown
    return found


def _plant_entry(plant: Plant) -> PlantEntry:
    return entry_of(
        PlantEntry,
        plant,
        units=dict(zip(plant.signals, plant.signal_units, strict=True)),
        outputs=dict(zip(plant.outputs, plant.C.tolist(), strict=True)),
        modes=[entry_of(ModeEntry, mode) for mode in plant.modes],
        controllability_rank=kalman_rank(plant),
    )


def _optima_entry(plant: Plant, item: Optima) -> OptimaEntry:
    return OptimaEntry(
        move=describe_move(item.move),
        time=optimum_entry(plant, item.time),
        constrained=optimum_entry(plant, item.constrained) if item.constrained else None,
        damping=optimum_entry(plant, item.damping) if item.damping else None,
        remarks=list(item.remarks),
    )


def _library_versions() -> dict[str, str]:
    names = ("casadi", "highspy", "ruckig", "control", "numpy", "scipy")
    return {name: version(name) for name in names}
