"""Record -> the neutral document that all printers show."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema import Record
from mtcommission.record.verified import Verified
from mtcommission.sheet.comparison_part import comparisons
from mtcommission.sheet.difference_part import differences
from mtcommission.sheet.entry_part import parameters, signatures
from mtcommission.sheet.evidence_part import certificates, versions
from mtcommission.sheet.identified_part import identified
from mtcommission.sheet.improvements_part import improvements
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


def compose(
    record: Record,
    language: str = "en",
    *,
    before: Record | None = None,
    verified: Verified | None = None,
) -> Document:
    """Return the sheet of a record.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code, e.g. "en".
    before
        An earlier record of the axis, to tell what changed since.
    verified
        What ``verify`` found about this record.

    Returns
    -------
    Document

    Raises
    ------
    InputError
        If the two records cannot be compared.
    """
    axis = record.machine
    words = Catalogue(language, rotary=axis.motion == "rotary", follows=axis.follows)
    text = words.text
    profile = record.profile
    changes = () if before is None else (differences(before, record, words),)
    return Document(
        language=language,
        title=text("title"),
        machine=record.machine.name,
        axis=f"{text('axis')} {record.machine.axis}",
        identity=text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=record.created,
        disclaimer=text("disclaimer"),
        contents_heading=text("contents"),
        skip_link=text("skip"),
        script_note=text("script-note"),
        page_word=text("page"),
        sections=(
            verdict(record, words, picture=first_look(record, words)),
            *changes,
            machine_data(record, words),
            *identified(record, words),
            requirements(record, words),
            limits(record, words),
            rule(record, words),
            rules(record, words),
            *improvements(record, words),
            motions(record, words),
            comparisons(record, words),
            landscape(record, words),
            robustness(record, words),
            *move_sizes(record, words),
            loop(record, words),
            parameters(record, words),
            measurements(record, words, verified),
            certificates(record, words),
            versions(record, words),
            signatures(record, words),
        ),
    )
