"""The document that one hands over: four pages, each full, nothing torn.

If one of these fails, somebody hands over a page with three lines on it, or letters that nobody
can read.
"""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np
import pypdfium2
import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.profile.shipped import shipped_names
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry
from mtcommission.sheet.document import Paragraph
from mtcommission.sheet.loop import bode

from .sheet_record import (
    compose,
    example_record,
    not_met,
    print_html,
    print_pdf,
    said,
    shipped_record,
    with_today,
)

FULL = 2 / 3
"""Share of the height between header and footer that a page must use."""
TOP, BOTTOM = 62, 842 - 57
"""What header and footer leave of A4 [pt]."""
SMALLEST, FULLEST = 7.95, 7.45
"""Letters [pt], 8 but for rounding; in tables of a page that would not fit otherwise."""


def fill(page) -> float:
    """How far down a page is used."""
    image = np.asarray(page.render(scale=1).to_pil().convert("L"))
    rows = np.flatnonzero((image[TOP:BOTTOM] < 200).any(axis=1))
    return float(rows.max() / (BOTTOM - TOP))


def sizes(page) -> list[float]:
    """Size of the letters of every piece of text, in pictures, too [pt]."""
    return [
        item.get_font_size() * max(abs(item.get_matrix().d), abs(item.get_matrix().b))
        for item in page.get_objects(filter=[pypdfium2.raw.FPDF_PAGEOBJ_TEXT], max_depth=8)
    ]


@pytest.mark.parametrize(
    ("name", "change", "language"),
    [
        *((name, dict, ("en", "de")[i % 2]) for i, name in enumerate(shipped_names())),
        ("milling-manipulator", with_today, "de"),
        ("ball-screw", with_today, "de"),
        ("rack-gantry", not_met, "en"),
        ("honing-z", not_met, "de"),
    ],
)
def test_a_sheet_has_four_full_pages(name, change, language):
    """Of every example machine with its own numbers, with old values, and one that misses."""
    record = change(shipped_record(name))
    pages = list(pypdfium2.PdfDocument(print_pdf(record, language=language)))
    assert len(pages) == 4
    used = [fill(page) for page in pages]
    assert min(used) >= FULL, used
    broken = re.findall(r"\d\u202f\S+/\r?\n.*", pages[0].get_textpage().get_text_range())
    assert not broken  # a number from its unit, or within it
    letters = [size for page in pages for size in sizes(page)]
    assert len(letters) > 200
    is_full = (name, change) == ("ball-screw", with_today)
    assert min(letters) >= (FULLEST if is_full else SMALLEST), sorted(letters)[:3]


def test_four_parts_then_everything_else_and_no_heading_at_the_foot_of_a_page():
    """In the appendix, too, where sections follow one another."""
    record = shipped_record("honing-z")
    document = compose(record)
    kinds = [section.is_appendix for section in document.sections]
    assert kinds[:4] == [False] * 4
    assert all(kinds[4:])
    assert len(kinds) > 12
    html = print_html(record)
    places = [html.index(f'id="{section.key}"') for section in document.sections]
    appendix = html.index('id="appendix"')
    assert all(a < b for a, b in pairwise([*places[:4], appendix, *places[4:]]))
    headings = {section.heading for section in document.sections}
    pdf = pypdfium2.PdfDocument(print_pdf(record, appendix=True))
    last = [page.get_textpage().get_text_bounded().splitlines() for page in pdf]
    assert len(last) > 8
    for lines in last:
        # the footer has two lines
        assert not headings & set(lines[-4:-2]), lines[-6:]


def test_the_margins_in_the_bode_plot_end_on_the_curves():
    """A margin drawn at another frequency would be as long as something else."""
    record = to_entry(example_record(), Record)
    gain, phase = (
        next(line for line in panel.lines if "margin" in line.label)
        for panel in bode(record, Catalogue("en")).panels
    )
    assert gain.y[0] == 0.0
    assert abs(gain.y[1]) == pytest.approx(record.loop.gain_margin_db, abs=0.02)
    assert (phase.y[0] + 180.0) % 360.0 == 0.0
    assert abs(phase.y[1] - phase.y[0]) == pytest.approx(record.loop.phase_margin_deg, abs=0.1)


def test_a_dash_among_the_least_times_has_its_reason_beside_it():
    """The reason stood in the appendix only, that the paper does not have."""
    record = shipped_record("rack-gantry")
    first, shares = record["optima"][0], {"rigid": 0.61, "share": 0.0123}
    remark = said("band-saves-nothing", **shares)
    first |= {"band": None, "robust": None, "remarks": [*first["remarks"], remark]}
    notes = [b.text for b in compose(record).sections[1].blocks if isinstance(b, Paragraph)]
    reason = Catalogue().say(Message("band-saves-nothing", **shares))
    assert f"Move\N{NO-BREAK SPACE}1: {reason}" in notes
