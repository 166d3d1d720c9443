"""Record -> the neutral document that all printers show: four pages and an appendix."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.machine import MachineEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.verified import Verified
from mtcommission.sheet.differences import differences
from mtcommission.sheet.document import HASH_DIGITS, Document, document
from mtcommission.sheet.evidence import certificates, comparisons, versions
from mtcommission.sheet.identified import identified
from mtcommission.sheet.limits import landscape, limits_section, rule, rules
from mtcommission.sheet.loop import loop_details, third_page
from mtcommission.sheet.machine import machine_data, requirements
from mtcommission.sheet.measurements import fourth_page
from mtcommission.sheet.responses import motions, move_sizes, second_page
from mtcommission.sheet.robustness import robustness
from mtcommission.sheet.verdict import first_page, type_in

if TYPE_CHECKING:
    from mtcommission.export.write import Export


def words_for(machine: MachineEntry, language: str) -> Catalogue:
    """Return the texts of a language for an axis."""
    return Catalogue(language, rotary=machine.motion == "rotary", follows=machine.follows)


def compose(
    record: Record,
    language: str = "en",
    *,
    before: Record | None = None,
    verified: Verified | None = None,
    typed: Export | Message | None = None,
) -> Document:
    """Return the sheet of a record.

    ``before`` is an earlier record of the axis, to tell what changed since; ``verified`` what
    ``verify`` found; ``typed`` the record's ``type_in``, where that is known already.

    Raises
    ------
    InputError
        If the two records cannot be compared.
    """
    words, profile = words_for(record.machine, language), record.profile
    typed = type_in(record) if typed is None else typed
    return document(
        words,
        script_note="script-note",
        title=words.text("title"),
        machine=record.machine.name,
        axis=f"{words.text('axis')} {record.machine.axis}",
        identity=words.text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=record.created,
        disclaimer=words.text("disclaimer"),
        sections=(
            first_page(record, typed, words),
            second_page(record, words),
            third_page(record, words),
            fourth_page(record, typed, words, verified),
            *(() if before is None else (differences(before, record, words),)),
            # The evidence: data, assumptions, studies, certificates, settings, profile.
            limits_section(record, words),
            machine_data(record, words),
            *identified(record, words),
            requirements(record, words),
            motions(record, words),
            *move_sizes(record, words),
            robustness(record, words),
            loop_details(record, words),
            rules(record, words),
            rule(record, words),
            landscape(record, words),
            comparisons(record, words),
            certificates(record, words),
            versions(record, words),
        ),
    )
