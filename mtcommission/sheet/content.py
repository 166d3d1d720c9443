"""Record -> the neutral document that all printers show."""

from __future__ import annotations

from mtcommission.record.schema import Record
from mtcommission.sheet.comparison_part import comparisons
from mtcommission.sheet.difference_part import differences
from mtcommission.sheet.entry_part import parameters, signatures
from mtcommission.sheet.evidence_part import certificates, versions
from mtcommission.sheet.format import formatter_of
from mtcommission.sheet.labels_en import Labels
from mtcommission.sheet.limits_part import landscape, limits, rules
from mtcommission.sheet.loop_part import loop
from mtcommission.sheet.machine_part import machine_data, requirements
from mtcommission.sheet.measure_part import measurements
from mtcommission.sheet.model import Document
from mtcommission.sheet.motion_part import first_look, motions
from mtcommission.sheet.robustness_part import robustness
from mtcommission.sheet.rule_part import rule
from mtcommission.sheet.sizes_part import move_sizes
from mtcommission.sheet.verdict_part import verdict

HASH_DIGITS = 12
"""Digits of the profile's hash on each page; the whole hash stands once under "Versions"."""


def compose(record: Record, labels: Labels, *, before: Record | None = None) -> Document:
    """Return the sheet of a record.

    Parameters
    ----------
    record
        A whole commissioning.
    labels
        Texts of the language.
    before
        An earlier record of the axis, to tell what changed since.

    Returns
    -------
    Document

    Raises
    ------
    InputError
        If the two records cannot be compared.
    """
    f = formatter_of(record.machine.motion, labels)
    profile = record.profile
    changes = () if before is None else (differences(before, record, f),)
    return Document(
        language=labels.language,
        title=labels.title,
        machine=record.machine.name,
        axis=f"{labels.axis} {record.machine.axis}",
        identity=labels.identity.format(name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=record.created,
        disclaimer=labels.disclaimer,
        contents_heading=labels.contents,
        skip_link=labels.skip,
        script_note=labels.script_note,
        page_word=labels.page,
        sections=(
            verdict(record, f, picture=first_look(record, f)),
            *changes,
            machine_data(record, f),
            requirements(record, f),
            limits(record, f),
            rule(record, f),
            rules(record, f),
            motions(record, f),
            comparisons(record, f),
            landscape(record, f),
            robustness(record, f),
            *move_sizes(record, f),
            loop(record, f),
            parameters(record, f),
            measurements(record, f),
            certificates(record, f),
            versions(record, f),
            signatures(record, f),
        ),
    )
