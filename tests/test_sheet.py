"""The sheet: the same numbers everywhere, nothing escapes, nothing is cut."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from dataclasses import asdict, fields, replace
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pypdfium2
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.ft2font import FT2Font
from typer.testing import CliRunner

from mtcommission.base.errors import ComputationError, InputError, Outcome
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, from_json
from mtcommission.base.messages.quantities import THIN_SPACE, Formatter
from mtcommission.base.units.symbols import read_unit
from mtcommission.cli import app
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.shipped import read_shipped, shipped_names
from mtcommission.record.machine import list_data
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry, to_plain
from mtcommission.sheet.content import remark_on_print
from mtcommission.sheet.document import (
    Form,
    Formula,
    Headline,
    LinePlot,
    Paragraph,
    Preformatted,
    Table,
    Tone,
)
from mtcommission.sheet.figures import draw_svg
from mtcommission.sheet.pdf import set_pdf
from mtcommission.verify.checks import Check, what_of

from .sheet_record import (
    HOSTILE,
    compose,
    example_record,
    five_moves_record,
    on_json,
    print_html,
    print_pdf,
    retuned,
    rotary_record,
    said,
    shipped_record,
    unsettled_record,
    with_today,
)

ENGLISH, GERMAN = Catalogue("en"), Catalogue("de")

remark_on_print = on_json(remark_on_print)

RECORDS = {
    "example": example_record,
    "unsettled": unsettled_record,
    "five moves": five_moves_record,
    "rotary": rotary_record,
}
LINEAR = Formatter()
ROTARY = Formatter(rotary=True)
SI_UNITS = ["m", "m/s", "m/s^2", "m/s^3", "s", "N", "N m", "N/m", "N s/m", "N m/rad", "Hz", "rad"]
SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


class Page(HTMLParser):
    """What a browser would see: text, elements and their attributes."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.raw: dict[str, list[str]] = {"script": [], "style": []}
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        if self.tags and self.tags[-1] in self.raw and data.strip():
            self.raw[self.tags[-1]].append(data)
        else:
            self.texts.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.texts).split())


@pytest.fixture(scope="module")
def pages():
    return {name: print_html(make()) for name, make in RECORDS.items()}


@pytest.fixture(scope="module")
def pdfs():
    return {name: print_pdf(make(), appendix=True) for name, make in RECORDS.items()}


def pdf_pages(pdf: bytes) -> list[str]:
    document = pypdfium2.PdfDocument(pdf)
    return [page.get_textpage().get_text_bounded() for page in document]


def squeeze(text: str) -> str:
    """Without white space and hyphens: where a line breaks is the printer's affair."""
    return re.sub(r"[-\s\u200b\ufffe\x02]", "", text)


def plots(document):
    return [b for section in document.sections for b in section.blocks if isinstance(b, LinePlot)]


def tables(document):
    return [b for section in document.sections for b in section.blocks if isinstance(b, Table)]


def text_cells(document):
    """Every cell that is set as text and not as a formula."""
    rows = (row for table in tables(document) for row in table.rows)
    return [cell for row in rows for cell in row if isinstance(cell, str)]


def plain(cell) -> str:
    return cell if isinstance(cell, str) else cell.text


# numbers


@given(
    value=st.floats(min_value=1e-9, max_value=1e9),
    sign=st.sampled_from([1.0, -1.0]),
    unit=st.sampled_from(SI_UNITS),
    rotary=st.booleans(),
)
def test_a_printed_quantity_read_back_is_the_number(value, sign, unit, rotary):
    """The profile reader's units are the second opinion on every factor printed."""
    f = ROTARY if rotary else LINEAR
    text = f.quantity(sign * value, unit).replace("″", " arcsec").replace("°", " deg")
    number, unit_text = re.match(r"(\S+?)[\s ]([^\d].*)", text.replace("×10", "e")).groups()
    meaning = read_unit(unit_text)[0]
    assert float(number.translate(SUPERSCRIPTS)) * meaning.si_value == pytest.approx(
        sign * value, rel=5.1e-4
    )


@pytest.mark.parametrize("name", RECORDS)
def test_the_records_of_these_tests_are_records(name):
    """Printed from another form than a run writes, a sheet would prove nothing."""
    record = RECORDS[name]()
    assert to_plain(to_entry(record, Record)) == record


# content


def block_text(block) -> str:
    if isinstance(block, Table):
        heads = " | ".join(column.head for column in block.columns)
        rows = (" | ".join(map(plain, row)) for row in block.rows)
        return "\n  ".join([block.caption, heads, *rows])
    if isinstance(block, LinePlot):
        panels = [
            f"{panel.y_label}: {', '.join(line.label for line in panel.lines)}"
            for panel in block.panels
        ]
        return "\n  ".join([block.caption, block.alt, block.x_label, *panels])
    if isinstance(block, Form):
        return "; ".join(block.fields)
    if isinstance(block, Formula):
        return f"{block.text} {block.aside}".strip()
    names = [field.name for field in fields(block)]
    return "; ".join(str(getattr(block, name)) for name in names)


def test_the_plots_show_the_numbers_of_the_record():
    record = example_record()
    found = {plot.key: plot for plot in plots(compose(record))}
    series = record["moves"][0]["series"]
    force = found["drive-1"].panels[0]
    assert force.y_label == "Set force F_set in kN"
    response = force.lines[-1]
    np.testing.assert_allclose(response.x, np.array(series["t"]) * 1e3)
    # As it is, not as a mean: its peak is the largest set force that stands beside it.
    np.testing.assert_allclose(response.y, np.array(series["signals"]["F_set"]) / 1e3)
    assert [border.y for border in force.borders] == [2.0, -2.0]
    acceleration = found["drive-1"].panels[1].lines
    np.testing.assert_allclose(acceleration[0].y, series["signals"]["a_ref"])
    np.testing.assert_allclose(
        acceleration[-1].y, np.array(series["signals"]["F"]) / record["plant"]["moving_mass"]
    )


def test_the_worst_size_that_page_one_names_is_marked_where_the_sizes_are_drawn():
    """It may be far smaller than the least that is drawn as a curve."""
    record = shipped_record("ball-screw")
    worst = record["limits"]["recommended"]["worst_sizes"][0]
    (panel,) = next(p for p in plots(compose(record)) if p.key == "sizes-1").panels
    mark = panel.lines[-1]
    assert mark.x == pytest.approx([1e3 * worst["size"]] * 2)
    assert mark.y.max() == pytest.approx(1e6 * worst["value"])
    assert any(mark.label in cell for cell in text_cells(compose(record)))


def test_what_did_not_settle_is_said_and_never_a_number():
    record = unsettled_record()
    document = compose(record)
    (headline,) = (block for block in document.sections[0].blocks if isinstance(block, Headline))
    assert not headline.is_met
    assert headline.verdict == "Requirements NOT met"
    assert "settling time" in headline.detail
    result = table_of(record, "responses", which=1)
    assert result.rows[0][3:5] == ("not settled", "not settled")
    assert not re.search(r"\b(None|nan)\b", "\n".join(text_cells(document)))
    # Axes without a curve cannot be told from a fault of the plot.
    assert "frequency-error" not in [plot.key for plot in plots(document)]


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_rotary_axis_has_torques_and_moments_of_inertia(language):
    """A field "Moving mass 8.3 kg m²" makes one doubt all other fields."""
    forces = {"en": r"\b([Ff]orces?|[Mm]ass)\b", "de": "[Kk]raft|[Kk]räft|[Mm]asse"}[language]
    document = compose(rotary_record(), language)
    blocks = (block for section in document.sections for block in section.blocks)
    shown = "\n".join(block_text(one) for one in blocks if not isinstance(one, Preformatted))
    shown = shown.replace("requirements.reserve.force", "")  # a key of the profile
    assert not re.findall(f".*(?:{forces}).*", shown)
    linear = block_text(table_of(example_record(), "measurements", language))
    assert re.search(forces, linear), "the words that are looked for"


@pytest.mark.parametrize(("name", "language"), [("force", "en"), ("Kraft", "de")])
def test_a_mode_named_as_a_word_of_the_sheet_keeps_its_name_on_a_rotary_axis(name, language):
    """A mode "Kraft" made the German sheet speak of v_Drehmoment, a signal that does not exist."""
    told = json.dumps(rotary_record()).replace("plate", "@")
    record, renamed = (json.loads(told.replace("@", mode)) for mode in ("drum", name))
    sheets = [asdict(compose(item, language)) for item in (record, renamed)]
    before, after = (json.dumps(sheet, default=str, ensure_ascii=False) for sheet in sheets)
    assert before.count("drum") > 3
    assert before.replace("drum", name) == after


def test_what_is_to_be_measured_has_its_value_and_empty_fields():
    for make in RECORDS.values():
        record = make()
        table = table_of(record, "measurements")
        assert table.is_form
        assert all(row[3:] == ("", "", "") and row[1] for row in table.rows)
        assert len(table.rows) == 4 + 2 * len(record["plant"]["modes"]) + 5 * len(record["moves"])
    rows = {row[0]: row[1:3] for row in table_of(example_record(), "measurements").rows}
    assert rows["Frequency of mode base"] == (f"50.03{THIN_SPACE}Hz", f"± 5.2{THIN_SPACE}%")
    residual = rows["Move\N{NO-BREAK SPACE}1: Residual deviation"]
    assert residual == (f"4.581{THIN_SPACE}µm", f"5.1{THIN_SPACE}µm")
    assert rows["Phase margin"][1] == "≥ 30°"
    stability = {row[0]: row[-1] for row in table_of(example_record(), "loop").rows}
    assert stability["Gain margin"] == f"≥ 6{THIN_SPACE}dB"
    assert stability["Sensitivity peak"] == "≤ 2"


def test_the_largest_force_to_measure_is_the_one_that_verify_measures():
    """If it were the set force, a trace would show a fifth less."""
    record = shipped_record("modal-two-modes")
    (row,) = (r for r in table_of(record, "measurements").rows if "Largest" in r[0])
    (move,) = record["moves"]
    by_verify = ENGLISH.say(what_of(Check(key="max force", reason=Message("verify-kept"))))
    assert row[0].partition(": ")[2].casefold() == by_verify
    actual = move["response"]["peaks"]["F"]
    assert row[1] == LINEAR.axis(actual, "N", digits=4)
    assert actual < 0.9 * move["response"]["max_force"]


def table_of(record, key, language="en", *, which=0):
    section = next(s for s in compose(record, language).sections if s.key == key)
    return [block for block in section.blocks if isinstance(block, Table)][which]


def test_a_peak_carries_the_unit_of_its_state():
    document = compose(example_record())
    cells = {row[0]: row[1] for table in tables(document) for row in table.rows}
    assert cells["Tower rotation rate v_φ, largest magnitude"] == f"5.3{THIN_SPACE}mrad/s"


# the rule


@pytest.mark.parametrize("language", ["en", "de"])
def test_every_formula_of_the_rule_is_set_and_every_symbol_explained(language):
    """The rule is to be used with a calculator, so no letter may be left to guess."""
    section = next(s for s in compose(example_record(), language).sections if s.key == "rule")
    formulas = [block for block in section.blocks if isinstance(block, Formula)]
    assert len(formulas) == 6
    words = " ".join(block.text for block in section.blocks if isinstance(block, Paragraph))
    assert not re.search("[<>^]|Originaltext", words)
    symbols, hand = (block for block in section.blocks if isinstance(block, Table))
    named = {row[0].text for row in symbols.rows}
    written = [b.text for b in formulas] + [plain(r[1]) for r in hand.rows]
    signs = " ".join(text for text in written if "≤" in text or "/" in text)
    used = set(re.findall("[A-Za-zωζεπ]+(?:_[A-Za-z]+)?", signs))
    given = {"C_S", "C_P", "C_i", "W", "W_i", "ω_v", "ε", "π", "min", "max", "exp"}  # by the steps
    assert {one.removesuffix("_i") for one in used - given} <= named
    assert all(row[2] for row in symbols.rows)


# the four media


@pytest.mark.parametrize("name", RECORDS)
def test_every_cell_of_every_table_is_in_page_and_pdf(name, pages, pdfs):
    expect_the_same(compose(RECORDS[name]()), pages[name], pdfs[name])


def expect_the_same(document, html, pdf):
    page, paper = squeeze(Page(html).text), squeeze(" ".join(pdf_pages(pdf)))
    for words in (*(section.heading for section in document.sections), *text_cells(document)):
        assert squeeze(words) in page
        assert squeeze(words) in paper


# page


def test_the_page_needs_and_admits_nothing_from_outside(pages):
    """Its policy has its own script and style; hostile text stays text."""
    html = pages["five moves"]
    page = Page(html)
    addresses = [value or "" for key, value in page.attributes if key in ("src", "href", "action")]
    assert addresses
    assert all(address.startswith("#") for address in addresses)
    assert set(re.findall(r"https?://[^\s\"'`]+", html)) == {"http://www.w3.org/2000/svg"}
    assert not [key for key, _ in page.attributes if key.startswith("on") or key == "style"]
    assert len(html.encode()) < 2e6
    policy = next(value for key, value in page.attributes if key == "content" and "src" in value)
    data, script = page.raw["script"]
    (style,) = page.raw["style"]
    for name, text in (("script-src", script), ("style-src", style)):
        digest = b64encode(sha256(text.encode()).digest()).decode()
        assert f"{name} 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert json.loads(data)["plots"]
    assert page.tags.count("script") == 2
    assert "b" not in page.tags
    assert HOSTILE in page.text
    assert "<script>alert" not in html


def test_the_page_names_each_part_once_and_describes_each_plot(pages):
    page = Page(pages["five moves"])
    identifiers = [value for key, value in page.attributes if key == "id"]
    assert len(identifiers) == len(set(identifiers))
    drawn = [value for key, value in page.attributes if key == "data-plot"]
    told = [value for key, value in page.attributes if key == "data-alt"]
    data = json.loads(page.raw["script"][0])["plots"]
    assert sorted(drawn) == sorted(data)
    assert all(len(alt or "") > 40 for alt in told)
    assert len(told) == len(drawn)


# PDF


@pytest.mark.parametrize("name", ["unsettled", "five moves"])
def test_every_pdf_page_carries_machine_hash_and_number(name, pdfs):
    record, texts = RECORDS[name](), pdf_pages(pdfs[name])
    assert 6 <= len(texts) <= 45
    for number, text in enumerate(texts, start=1):
        flat = squeeze(text)
        assert squeeze(f"page {number} / {len(texts)}") in flat
        assert record["profile"]["sha256"][:12] in flat
        assert squeeze(record["machine"]["name"]) in flat
        # The last one may hold the end of the profile alone.
        assert len(flat) > 250 or number == len(texts), "an almost empty page"


@pytest.mark.parametrize("name", RECORDS)
def test_no_text_lies_on_another(name, pdfs):
    """A caption on the sentence above it, or two numbers at one tick, cannot be read."""
    expect_nothing_covered(pdfs[name])


def expect_nothing_covered(pdf):
    for number, page in enumerate(pypdfium2.PdfDocument(pdf), start=1):
        text = page.get_textpage()
        boxes = np.array([text.get_rect(k) for k in range(text.count_rects())])
        low = np.maximum(boxes[:, None, :2], boxes[None, :, :2])
        high = np.minimum(boxes[:, None, 2:], boxes[None, :, 2:])
        # An index beside its letter is set closely; more than 4 by 1.5 pt is none.
        covered = np.triu(np.all(high - low > (4.0, 1.5), axis=2), k=1)
        told = [text.get_text_bounded(*boxes[k]) for pair in np.argwhere(covered) for k in pair]
        assert not told, (number, told)


def test_nothing_is_printed_outside_the_margins(pdfs):
    for page in pypdfium2.PdfDocument(pdfs["five moves"]):
        width, height = page.get_size()
        assert (round(width), round(height)) == (595, 842)
        image = np.asarray(page.render(scale=1).to_pil().convert("L"))
        inside = np.full(image.shape, False)
        inside[20:-20, 45:-45] = True
        assert np.all(image[~inside] > 200)


def test_fonts_are_embedded_and_headings_are_bookmarks(pdfs):
    document = pypdfium2.PdfDocument(pdfs["example"])
    titles = {mark.get_title() for mark in document.get_toc()}
    assert {section.heading for section in compose(example_record()).sections} <= titles
    raw = pypdfium2.raw
    texts = (one for page in document for one in page.get_objects(filter=[raw.FPDF_PAGEOBJ_TEXT]))
    assert all(raw.FPDFFont_GetIsEmbedded(raw.FPDFTextObj_GetFont(one)) for one in texts)


def test_the_font_has_every_character_that_the_sheet_uses():
    folder = Path(mpl.get_data_path()) / "fonts" / "ttf"
    files = [str(folder / f"DejaVuSans{kind}.ttf") for kind in ("", "-Bold")]
    known = set.intersection(*(set(FT2Font(file).get_charmap()) for file in files))
    for make in RECORDS.values():
        document = compose(make())
        used = "".join(block_text(block) for s in document.sections for block in s.blocks)
        assert not {c for c in used if ord(c) not in known and c != "\n"}


def test_letters_that_the_font_lacks_are_named_for_the_print():
    """They would come out as boxes, first seen at the machine."""
    record = example_record()
    assert remark_on_print(record) == ()
    record["machine"]["name"] = "Drehmaschine 車床 Ω é, 車"
    assert remark_on_print(record) == (Message("print-boxes", characters="車床"),)


def test_a_refusal_of_the_typesetter_is_a_named_outcome(monkeypatch, tmp_path):
    broken = tmp_path / "broken.typ"
    broken.write_text("#panic()")
    monkeypatch.setattr("mtcommission.sheet.pdf.TEMPLATE", broken)
    document = replace(compose(example_record()), sections=())
    with pytest.raises(ComputationError) as caught:
        set_pdf(document)
    assert caught.value.outcome is Outcome.PRINTING_FAILED


# languages


@pytest.mark.parametrize("name", shipped_names())
def test_german_knows_the_data_of_every_example_machine(name):
    profile = read_shipped(name)
    for item in list_data(profile.machine, build_plant(profile.machine), profile.text):
        last = item.key.rpartition(".")[2]
        assert GERMAN.name(last) != last


def test_the_command_line_prints_appendix_and_changes_on_demand(tmp_path):
    before = example_record()
    for name, record in (("before", before), ("after", retuned(before))):
        (tmp_path / f"{name}.json").write_text(json.dumps(record), encoding="utf-8")
    file, counts, html = str(tmp_path / "after.json"), [], []
    for more in ([], ["--appendix"], ["--compare", str(tmp_path / "before.json")]):
        argv = ["sheet", file, "-o", str(tmp_path / "out"), *more]
        assert CliRunner().invoke(app, argv).exit_code == 0
        paper = pdf_pages((tmp_path / "out" / "sheet.pdf").read_bytes())
        counts.append(len(paper))
        html.append((tmp_path / "out" / "sheet.html").read_text("utf-8"))
    assert counts[0] == 4
    assert counts[1] > 9
    assert html[0] == html[1], "the page always has it"
    assert counts[2] == 5
    for words in ("Changes since the earlier record", "+20 %", "10.2 µm", "not stated"):
        assert squeeze(words) in squeeze(Page(html[2]).text)
        assert squeeze(words) in squeeze(paper[4])


def test_the_german_sheet_is_the_same_on_page_and_paper_without_english_and_decimal_points():
    record = example_record()
    record["assumptions"] = [said("assumption-illustrative")]
    both = {"language": "de", "before": retuned(record)}
    document = compose(record, **both)
    html = print_html(record, **both)
    expect_the_same(document, html, print_pdf(record, **both, appendix=True))
    assert json.loads(Page(html).raw["script"][0])["decimal_mark"] == ","
    own = {"versions", "machine", "requirements"}  # the user's names, keys and sources
    for section in document.sections:
        text = " ".join(map(block_text, section.blocks))
        if section.key != "versions":
            assert not re.search(r"\d\.\d", text), section.key
        if section.key not in own:
            # "j = 10 a" and "a handbook" are names of the record
            words = re.findall(r"\b(?:the|of|with|and|not|is|in the|by|deviation)\b", text)
            assert not words, (section.key, words)
    drawn = "".join(draw_svg(plot, decimal_mark=",") for plot in plots(document))
    ticks = re.findall(r">([^<>a-z]*\d)</text>", drawn)
    assert any("," in tick for tick in ticks)
    assert not any("." in tick for tick in ticks)


# two records


def changes(before, after, language="en"):
    document = compose(after, language, before=before)
    section = next(section for section in document.sections if section.key == "differences")
    return {row[0]: row[1:] for b in section.blocks if isinstance(b, Table) for row in b.rows}


def test_two_records_show_what_changed_and_by_how_much():
    before = example_record()
    after = retuned(before)
    after["limits"]["recommended"]["jerk"] *= 1.0 + 1e-12  # rounding
    spaced = {
        name: tuple(cell.replace(THIN_SPACE, " ") for cell in row)
        for name, row in changes(before, after).items()
    }
    assert spaced["Acceleration"] == ("2.41 m/s²", "2.892 m/s²", "+20 %")
    assert spaced["Position gain Kv"] == ("42.79 1/s", "38.51 1/s", "−10 %")
    assert spaced["Permitted TCP deviation (band)"] == ("5.1 µm", "10.2 µm", "+100 %")
    assert spaced["Base mass"] == ("451 kg", "not stated", "changed")
    assert spaced["TCP height h, signed"] == ("not stated", "200 mm", "changed")
    assert spaced["Bound by"] == ("residual deviation", "set force", "changed")
    assert spaced["Settling time"] == ("105.6 ms", "not settled", "changed")
    assert not {"Jerk", "Max force"} & set(spaced)  # the same in both
    assert changes(before, before) == {}
    page = print_html(after, before=before)
    assert "of what they hang on, this changed: TCP height h, signed." in page


def test_a_move_that_became_another_is_not_compared_by_its_numbers():
    """Nor are two axes in silence, nor a rotary axis with a linear one at all."""
    before, after = example_record(), five_moves_record()
    for key in ("moves", "optima"):
        after[key] = after[key][1:2]
    sizes = after["limits"]["recommended"]
    sizes["valid_for"] = sizes["valid_for"][1:2]
    row = changes(before, after)["Move\N{NO-BREAK SPACE}1"]
    assert ("velocity step" in row[0], "positioning" in row[1], row[2]) == (True, True, "changed")
    before["machine"]["axis"] = "B"
    sections = compose(example_record(), before=before).sections
    section = next(one for one in sections if one.key == "differences")
    assert "are different axes" in section.blocks[1].text
    with pytest.raises(InputError, match="--compare: got a linear axis, must be rotary"):
        print_html(rotary_record(), before=example_record())


# today's values beside the recommended ones


def test_todays_values_stand_beside_the_recommended_ones_with_what_each_gives():
    """Whoever types new values in must see what he replaces and what he gains."""
    record = with_today(example_record())
    table = table_of(record, "responses", which=1)
    now, then = ([cell.replace(THIN_SPACE, " ") for cell in row] for row in table.rows[:2])
    assert now == ["Today", "2.03 m/s²", "17.1 m/s³", "310.1 ms", "45.2 µm", "61.3 µm", "no"]
    assert then[:4] == ["Recommended", "2.41 m/s²", "41.2 m/s³", "105.6 ms"]
    page = squeeze(Page(print_html(record)).text)
    assert squeeze("now 310.1 ms / 45.2 µm, then 105.6 ms / 4.582 µm") in page
    assert squeeze("Simulated with today's Kv; Kp, Tn, not stated") in page


def test_an_unstable_loop_of_today_is_said_and_has_no_numbers():
    """A number beside "today" would be taken for what the machine does."""
    unstable = said("today-unstable", Kv=31.0, Kp=9e5, Tn=0.02, corner=Message("place-nominal"))
    nothing = dict.fromkeys(("settling_time", "residual_deviation", "peak_deviation"))
    record = with_today(example_record())
    record["limits"]["today"] |= {"failure": unstable, **nothing}
    record["limits"]["warnings"] = [unstable]
    record["warnings"] = [*record["warnings"], unstable]
    blocks = compose(record).sections[0].blocks
    told = [b.text for b in blocks if isinstance(b, Paragraph)]
    assert ENGLISH.say(from_json(unstable)) in told
    assert table_of(record, "responses", which=1).rows[0][3:] == ("–", "–", "–", "no")


# reserve and what was assumed


@pytest.mark.parametrize(
    ("value", "verdict"),
    [(4.7e-6, "met"), (4.8e-6, "met, reserve used up"), (5.2e-6, "NOT MET")],
)
def test_the_reserve_counts_in_the_verdict_of_each_requirement(value, verdict):
    """Limits that use up the reserve break as soon as the machine is not quite as calculated."""
    record = example_record()
    (check,) = record["assessment"]["checks"]
    check |= {"value": value, "met": value <= check["limit"]}
    row = table_of(record, "verdict").rows[0]
    share = f"{100 * value / 5.1e-6:.3g}{THIN_SPACE}%"
    assert row[3:5] == (share, verdict)


def first_page(record):
    """Its rows by their names, and what stands below the verdict."""
    blocks = compose(record).sections[0].blocks
    rows = {row[0]: row[1].replace(THIN_SPACE, " ") for b in blocks if isinstance(b, Table)
            for row in b.rows if len(row) == 2}  # fmt: skip
    (headline,) = (block for block in blocks if isinstance(block, Headline))
    return rows, headline.detail.replace(THIN_SPACE, " ")


def test_the_first_page_tells_what_was_assumed_and_what_was_stated():
    """A rest of 0 s or DSC that nobody chose decides about limits: a count of them says nothing."""
    record = example_record()
    rows, _ = first_page(record)
    assert rows["Control"].startswith("free controller (state space), SI values (assumed)")
    assert not rows["Control"].endswith("(assumed)")  # of the loop all is stated
    assert rows["Frequencies"] == "judged at ± 5.2 %; all kept from −1 % to +1 %"
    damping = "judged as stated, no spread; all kept from −39 % to at least +70 %"
    assert rows["Damping ratios"] == damping
    spread = next(item for item in record["data"] if item["key"].endswith("frequency_spread"))
    spread["source"] = said("source-default")
    record["robustness"]["frequency_error"] |= {"kept_from": None, "kept_to": None}
    record["data"] += [
        {"key": key, "value": value, "unit": unit, "source": said(source)}
        for key, value, unit, source in (
            ("control.position_loop", "drive", "", "source-default"),
            ("control.position_cycle", 2e-3, "s", "source-stated"),
            ("moves[1].dwell", 0.0, "s", "source-accepted-default"),
        )
    ]
    rows, _ = first_page(record)
    kept = "requirements not kept even as stated"
    assert rows["Frequencies"] == f"judged at ± 5.2 % (assumed); {kept}"
    assert rows["Assumed"] == "Move\N{NO-BREAK SPACE}1: Dwell = 0 s"
    assert rows["Control"].endswith("(assumed: Place of the position loop)")


def test_an_assumed_value_that_binds_is_named_with_what_another_would_give():
    """Else 1.6 m/s^2 is typed in where a rest that the cycle has anyway allows 3.5."""
    record = example_record()
    record["limits"]["recommended"]["bound_by"] = said("requirement-rms-force")
    dwell = {"key": "moves[1].dwell", "value": 0.0, "unit": "s", "source": "stated by somebody"}
    record["data"].append(dwell)
    assert "assumed value" not in first_page(record)[1]
    dwell["source"] = said("source-accepted-default")
    change = said("change-dwell", dwell=2.0, acceleration=3.47)
    record["limits"]["would_bring"] = [
        {"change": change, "settling_time": 0.513, "saved": 0.2, "share": 0.3,
         "meets_requirements": True, "outcome": None}
    ]  # fmt: skip
    detail = first_page(record)[1]
    place = "Move\N{NO-BREAK SPACE}1"
    assert f"assumed value ({place}: Dwell). Rest of 2 s or more after each move: 3.47" in detail
    assert "513 ms" in detail


def test_a_tool_on_a_path_is_told_that_the_contour_counts():
    """Who reads only the residual believes that a path is kept as exactly as the standstill."""
    record = example_record()

    def told():
        blocks = compose(record).sections[0].blocks
        notes = [b.text for b in blocks if isinstance(b, Paragraph) and b.tone is Tone.NOTE]
        return notes[0].replace(THIN_SPACE, " ")

    assert "up to 9.47 µm off: for work along a path, state in the profile: Permitted" in told()
    for key, value, unit in (("contour_deviation", 2e-5, "m"), ("contour_feed", 0.05, "m/s")):
        key = f"requirements.{key}"
        record["data"].append({"key": key, "value": value, "unit": unit, "source": "x"})
    assert "contour deviation at up to 0.05 m/s" in told()
