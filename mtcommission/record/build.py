"""Commissioning -> Record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from math import isinf

from mtcommission.commission import Commissioning
from mtcommission.errors import Fault, InputError
from mtcommission.machine.plausibility import check_plausibility
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, kalman_rank
from mtcommission.record.comparisons import comparison_entry
from mtcommission.record.data import list_assumptions, list_data, machine_entry, profile_entry
from mtcommission.record.files import find_checksum
from mtcommission.record.identified import read_evidence
from mtcommission.record.limits import limits_part
from mtcommission.record.loop import loop_part
from mtcommission.record.moves import assessment_part, move_entry
from mtcommission.record.optima import optima_entry
from mtcommission.record.robustness import robustness_part
from mtcommission.record.schema.identified import IdentifiedPart, ToolSensorEntry
from mtcommission.record.schema.machine import ModeEntry, PlantEntry
from mtcommission.record.schema.record import SCHEMA, Profile, Record, Tool
from mtcommission.record.schema.values import Words
from mtcommission.record.shape import entry_of, to_plain
from mtcommission.record.what_if import what_if_part
from mtcommission.version import __version__


def record_run(found: Commissioning, *, created: str) -> Record:
    """Return the record of a machine that was read from its profile.

    Parameters
    ----------
    found
        With the profile that it came from; what was measured stands beside that.
    created
        Date and time, ISO 8601.

    Raises
    ------
    InputError
        If the machine came from no profile, whose text a record holds.
    """
    source, machine = found.profile, found.machine
    if source is None:
        raise InputError([Fault(where=machine.name, message=Message("record-without-profile"))])
    return build_record(
        found,
        profile=profile_entry(source),
        created=created,
        warnings=[remark.with_key() for remark in check_plausibility(machine)],
        identified=read_evidence(machine, source.path.parent),
    )


def build_record(
    commissioning: Commissioning,
    *,
    profile: Profile,
    created: str,
    warnings: Sequence[Words],
    identified: IdentifiedPart | None = None,
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
    identified
        What was measured on the axis.
    """
    machine, plant = commissioning.machine, commissioning.plant
    robustness = robustness_part(machine, commissioning.robustness)
    limits = limits_part(commissioning, improvements=commissioning.improvements)
    record = Record(
        schema=SCHEMA,
        checksum="",
        tool=Tool(name="mtcommission", version=__version__, libraries=_library_versions()),
        created=created,
        profile=profile,
        machine=machine_entry(machine),
        data=list_data(machine, plant, profile.text),
        settings=_settings_entry(commissioning),
        assumptions=[*list_assumptions(machine), *_friction(commissioning, is_kept=True)],
        warnings=[
            *warnings,
            *limits.warnings,
            *commissioning.tuned.warnings,
            *robustness.warnings,
            *_friction(commissioning, is_kept=False),
        ],
        plant=_plant_entry(plant),
        optima=[
            optima_entry(plant, item, within)
            for item, within in zip(commissioning.optima, commissioning.within_band, strict=True)
        ],
        limits=limits,
        loop=loop_part(commissioning),
        moves=[move_entry(plant, commissioning.tuned, result) for result in commissioning.moves],
        comparisons=[
            comparison_entry(machine, plant, item, result)
            for item, result in zip(commissioning.comparisons, commissioning.moves, strict=True)
        ],
        robustness=robustness,
        assessment=assessment_part(commissioning.assessment, machine.requirements.reserve),
        identified=identified
        and replace(
            identified,
            tool_sensor=entry_of(ToolSensorEntry, freed)
            if (freed := commissioning.tool_sensor)
            else None,
        ),
        what_if=what_if_part(
            machine,
            plant,
            commissioning.tuned,
            commissioning.choice.limits,
            commissioning.today,
        ),
    )
    return replace(record, checksum=find_checksum(to_plain(record)))


def _friction(commissioning: Commissioning, *, is_kept: bool) -> list[Message]:
    """What the stated friction does to moves that keep their requirements, or do not."""
    drive = commissioning.machine.drive
    return [
        Message(
            "friction-kept" if is_kept else "friction-broken",
            move=one.number,
            coulomb=drive.coulomb_friction,
            viscous=drive.viscous_friction,
            settling="" if isinf(one.settling_time) else one.settling_time,
            without="" if isinf(one.without_friction) else one.without_friction,
            residual=one.residual_deviation,
            force=one.max_force,
        )
        for one in commissioning.friction
        if one.is_kept is is_kept
    ]


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


def _library_versions() -> dict[str, str]:
    names = ("casadi", "highspy", "ruckig", "control", "numpy", "scipy")
    return {name: version(name) for name in names}
