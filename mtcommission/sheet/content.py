"""Record -> the neutral document that all printers show: four pages and an appendix."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.record.read_back import Verified
from mtcommission.record.record import Record
from mtcommission.sheet.appendix import (
    certificates,
    machine_data,
    requirements,
    robustness,
    versions,
)
from mtcommission.sheet.differences import differences
from mtcommission.sheet.document import HASH_DIGITS, Block, Document, Section, document
from mtcommission.sheet.identified import identified
from mtcommission.sheet.limits import limits_by_mode, rule, rules
from mtcommission.sheet.loop import loop_details, third_page
from mtcommission.sheet.measurements import fourth_page
from mtcommission.sheet.responses import motions, move_sizes, second_page
from mtcommission.sheet.tables import words_for
from mtcommission.sheet.verdict import first_page, type_in

if TYPE_CHECKING:
    from mtcommission.export.write import Export


APPENDIX: tuple[tuple[str, str, Callable[[Record, Catalogue], Iterable[Block]]], ...] = (
    ("limits", "limits", limits_by_mode),
    ("machine", "machine", machine_data),
    ("identified", "identified", identified),
    ("requirements", "requirements", requirements),
    ("motions", "motion", motions),
    ("sizes", "sizes", move_sizes),
    ("robustness", "robustness", robustness),
    ("loop-details", "loop-details", loop_details),
    ("rules", "rules", rules),
    ("rule", "rule", rule),
    ("certificates", "evidence", certificates),
    ("versions", "versions", versions),
)
"""The evidence behind the pages: key, heading and blocks of each section."""


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
    follows = record.machine.follows
    loop = "robustness" if follows else "loop"
    pages: list[tuple[str, str, Iterable[Block]]] = [
        ("verdict", "verdict", first_page(record, typed, words)),
        ("responses", "responses", second_page(record, words)),
        (loop, loop, third_page(record, words)),
        ("measurements", "measure", fourth_page(record, typed, words, verified)),
    ]
    if before is not None:
        pages.append(("differences", "differences", differences(before, record, words)))
    appendix = [(key, head, evidence(record, words)) for key, head, evidence in APPENDIX]
    sections = [
        Section(
            key=f"{key}-details" if key == "robustness" and follows and is_appendix else key,
            heading=words.text(f"{head}-heading"),
            blocks=tuple(blocks),
            is_appendix=is_appendix,
        )
        for is_appendix, parts in ((False, pages), (True, appendix))
        for key, head, blocks in parts
    ]
    return document(
        words,
        script_note="script-note",
        title=words.text("title"),
        machine=record.machine.name,
        axis=f"{words.text('axis')} {record.machine.axis}",
        identity=words.text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=record.created,
        disclaimer=words.text("disclaimer"),
        sections=tuple(section for section in sections if section.blocks),
    )
