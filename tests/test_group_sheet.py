"""The sheet of a group: what is entered, the circle test as it comes out, and the page's numbers.

If one of these fails, an engineer types in something else than what was judged, or holds a ballbar
beside a circle that this machine does not draw.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html import unescape
from math import pi
from typing import Any

import numpy as np
import pypdfium2
import pytest

from mtcommission.group.contours import find_entries, trace_circles, worst_circle
from mtcommission.group.export import export_group
from mtcommission.group.record import GroupRecord, build_group_record, read_pair
from mtcommission.group.sheet import compose_group, print_group, words_of
from mtcommission.machine.profile.read import profile_text_hash
from mtcommission.sheet.document import Table

from .group_record import mill, mill_record
from .test_sheet_browser import AXE_RUN, CHROMIUM, TELL, WIDTHS, axe_file, browse

needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="needs the browser chromium")


def html_of(found: GroupRecord, language: str = "en") -> str:
    return print_group(found, read_pair(found), language=language, with_pdf=False)[
        "sheet.html"
    ].decode()


def text_of(html: str) -> str:
    """What a page says, without its scripts."""
    plain = re.sub(r"<(script|style).*?</\1>|<[^>]*>", " ", html, flags=re.DOTALL)
    return " ".join(unescape(plain).replace("\N{NARROW NO-BREAK SPACE}", " ").split())


def text_of_pdf(pdf: bytes) -> list[str]:
    """What each page of a PDF says."""
    pages = pypdfium2.PdfDocument(pdf)
    texts = (page.get_textpage().get_text_range() for page in pages)
    return [" ".join(text.replace("\N{NARROW NO-BREAK SPACE}", " ").split()) for text in texts]


SAID = {
    "en": ("Verdict and values to enter", "Path acceleration", "Circular deviation G", "met"),
    "de": ("Urteil und Werte", "Bahnbeschleunigung", "Kreisformabweichung G", "erfüllt"),
}


@pytest.mark.parametrize("language", SAID)
def test_html_and_pdf_say_what_is_entered_and_what_to_measure(language):
    """Two axes fit on two pages; a third page would be lost on the way to the machine."""
    found, words = mill_record(), words_of(mill_record(), language)
    files = print_group(found, mill().pair, language=language)
    html, pages = text_of(files["sheet.html"].decode()), text_of_pdf(files["sheet.pdf"])
    assert len(pages) == 2

    def shown(value, unit):
        return words.format.quantity(value, unit).replace("\N{NARROW NO-BREAK SPACE}", " ")

    path = found.path
    first = [shown(path.acceleration or 0.0, "m/s^2"), shown(path.jerk or 0.0, "m/s^3")]
    exported = export_group(found, control="sinumerik").text
    names = "N32300|N32431|N32200|N32800|N32910|N42500|N20600|p1460|p1462"
    typed = re.findall(rf"^(?:{names})(?: [^\[=]+(?:\[0\])?)?=(\S+)", exported, re.MULTILINE)
    assert len(typed) == 2 * 7 + 2
    first += [value.replace(".", words.format.decimal_mark) for value in typed]
    first += [shown(axis.settling_time or 0.0, "s") for axis in found.axes]
    second = [shown(one.deviation_without_slowing, "m") for one in found.speed_over_angle]
    second += [shown(one.quadrant_peak["Y"], "m") for one in found.circle]
    for values, page in ((first, pages[0]), (second, pages[1])):
        for value in values:
            assert value in html, value
            assert value in page, value
    for phrase in SAID[language]:
        assert phrase in html
        assert phrase in " ".join(pages)


def test_a_group_that_is_not_met_says_what_peaks_forbid_and_keeps_its_two_pages():
    """A third page is lost on the way to the machine; a table of dashes says nothing."""
    narrow = replace(mill(), task=replace(mill().task, tolerance=8e-6))
    found = build_group_record(narrow, created="2026-01-01T00:00:00Z")
    peak = words_of(found, "en").format.quantity(found.circle[0].quadrant_peak["Y"], "m")
    said = f"Even at 1 m/min a reversal of Y throws the tool off by {peak}"
    assert said.replace("\N{NARROW NO-BREAK SPACE}", " ") in text_of(html_of(found))
    assert len(text_of_pdf(print_group(found, mill().pair, language="de")["sheet.pdf"])) == 2


def test_todays_values_stand_beside_the_new_ones_and_three_axes_have_their_columns():
    """What is overwritten must be seen before it is."""
    found = mill_record()
    (other, own) = found.axes
    today = '[today]\nacceleration = "1.25 m/s^2"\nposition_gain = "31.5 1/s"\n'
    text = f"{own.profile.text}\n{today}"
    profile = replace(own.profile, text=text, sha256=profile_text_hash(text.encode()))
    third = replace(own, name="Z", profile=profile)
    ahead = found.feedforward | {"Z": found.feedforward["Y"]}
    three = replace(found, axes=[other, own, third], feedforward=ahead)
    first, *_ = compose_group(three, read_pair(three), words_of(three, "en")).sections
    tables = [block for block in first.blocks if isinstance(block, Table)]
    each = next(one for one in tables if one.columns[-1].head == "Path")
    heads = [column.head for column in each.columns[2:-1]]
    assert heads == ["X today", "X new", "Y today", "Y new", "Z today", "Z new"]
    rows = {row[0]: [str(cell) for cell in row[2:]] for row in each.rows}
    assert rows["Acceleration"][4] == "1.25"
    assert rows["Kv"][4] == "1.89"  # 1000/min
    # Not stated: neither invented nor left out.
    assert rows["Tn"][4] == rows["Kv"][0] == "–"
    assert len(text_of_pdf(print_group(three, read_pair(three))["sheet.pdf"])) <= 3


def test_names_that_look_like_markup_stay_names():
    """A profile comes from anywhere; its names stand in the page, the drawing and the script."""
    name = '</script><img src=x onerror="alert(1)">&'
    found = mill_record()
    axes = [replace(axis, machine=replace(axis.machine, name=name)) for axis in found.axes]
    axes[0] = replace(axes[0], name=name)
    bad = replace(found, axes=axes, plane=[name, "Y"])
    bad = replace(bad, feedforward=found.feedforward | {name: found.feedforward["X"]})
    html = html_of(bad)
    assert "<img" not in html
    assert html.count("</script>") == html_of(found).count("</script>")
    assert f"+{name}" in unescape(html)
    assert print_group(bad, read_pair(bad))["sheet.pdf"]


ASK = """
addEventListener("load", () => {
  const {model} = groupPage;
  tell({
    circles: CIRCLES.map(([radius, feed]) => {
      const {circular, most, least, peaks} = contours.trace(model, radius, feed);
      return {...contours.circle(model, radius, feed), circular, most, least, peaks};
    }),
    corners: ANGLES.map(([angle, feed]) => contours.cornerSpeed(model, angle, feed)),
  });
});
"""


@needs_browser
def test_the_page_computes_what_the_command_does(tmp_path):
    """Sliders would show circles that nobody judged; here with the control's arcs at corners."""
    group = mill()  # behind an average, or for a narrower tolerance, they gain nothing
    axes = [replace(a, follower=replace(a.follower, setpoint_filter=None)) for a in group.axes]
    group = replace(
        group,
        task=replace(group.task, tolerance=62.5e-6),
        axes=tuple(axes),
        setpoint_filter=None,
        path=replace(group.path, acceleration=4.0),
    )
    found = build_group_record(group, created="today")
    pair, rng = read_pair(found), np.random.default_rng(7)
    circles = [
        (float(10 ** rng.uniform(-2.3, -0.8)), float(rng.uniform(0.01, 0.3))) for _ in range(12)
    ]
    circles += [(one.radius, one.feed) for one in found.circle]
    angles = [(one.angle_deg * pi / 180.0, found.feed) for one in found.speed_over_angle]
    script = TELL + ASK.replace("CIRCLES", json.dumps(circles)).replace(
        "ANGLES", json.dumps(angles)
    )
    told: Any
    told, console = browse(html_of(found), tmp_path, script)
    assert console == ""
    entries = find_entries(pair)
    near = {"rel": 1e-4, "abs": 1e-9}
    for (radius, feed), got in zip(circles, told["circles"], strict=True):
        omega = np.array([feed / radius])
        off, _ = worst_circle(pair, omega)
        assert got["radius"] == pytest.approx(radius * float(off.radius[0]), **near)
        assert got["form"] == pytest.approx(radius * float(off.form[0]), **near)
        entry = np.interp(np.log(omega), np.log(pair[0].omega), entries)
        assert got["entry"] == pytest.approx(radius * float(entry[0]), **near)
    for one, got in zip(found.circle, told["circles"][-len(found.circle) :], strict=True):
        trace = trace_circles(pair, ((one.radius, one.feed),))[0]
        # Reversals are known at some instants only.
        extremes = [got[key] for key in ("most", "least", "circular")]
        traced = [trace.largest, trace.least, trace.circular]
        assert extremes == pytest.approx(traced, rel=5e-3, abs=2e-8)
        assert got["radius"] == pytest.approx(one.radius_deviation, **near)
        assert got["form"] == pytest.approx(one.form_deviation, **near)
        peaks = [one.quadrant_peak[name] for name in found.plane]
        assert got["peaks"] == pytest.approx(peaks, rel=5e-3)
    for corner, got in zip(found.speed_over_angle, told["corners"], strict=True):
        assert got["off"] == pytest.approx(corner.deviation_without_slowing, rel=1e-6)
        assert got["speed"] == pytest.approx(corner.speed, rel=1e-4)
        assert got["arc"]["radius"] == pytest.approx(corner.arc_radius, rel=1e-9)
    assert any(corner.arc_radius for corner in found.speed_over_angle)


SLIDE = """
addEventListener("load", () => {
  const seen = () => {
    groupPage.frame();
    const drawn = key => document.getElementById(`wi-${key}`);
    return {
      circle: drawn("circle").innerHTML, corner: drawn("corner").innerHTML,
      verdict: drawn("verdict").textContent, complaint: drawn("complaint").textContent,
    };
  };
  const type = (key, value) => {
    const box = document.getElementById(`wi-${key}`);
    box.value = value;
    box.dispatchEvent(new Event("input", {bubbles: true}));
    return seen();
  };
  tell([seen(), type("radius-slider", 300), type("angle", "30"), type("feed", "many"),
        (type("feed", "12"), type("radius", "2"))]);
});
"""


@needs_browser
def test_circle_and_corner_follow_the_sliders(tmp_path):
    told: Any
    told, console = browse(html_of(mill_record()), tmp_path, TELL + SLIDE)
    assert console == ""
    begun, smaller, blunter, wrong, fast = told
    assert smaller["circle"] != begun["circle"]
    assert smaller["corner"] == begun["corner"]
    assert blunter["corner"] != smaller["corner"]
    assert blunter["circle"] == smaller["circle"]
    assert wrong["complaint"].startswith("Feed: a number from ")
    assert begun["verdict"].startswith("✓")
    assert fast["verdict"].startswith("✗")


@needs_browser
def test_nothing_is_cut_on_a_phone(tmp_path):
    script = WIDTHS.replace("const letters =", "const letters = 0; const no =").replace(
        "const over =", "const over = 0; const none ="
    )
    found, _ = browse(html_of(mill_record(), "de"), tmp_path, script, "--window-size=500,900")
    assert found["cut"] == []
    assert found["needed"] <= found["inner"]


@needs_browser
@pytest.mark.skipif(not axe_file().exists(), reason="needs axe-core")
def test_axe_finds_nothing_in_the_dark(tmp_path):
    script = axe_file().read_text(encoding="utf-8") + AXE_RUN
    dark = "--blink-settings=preferredColorScheme=0"
    found, _ = browse(html_of(mill_record(), "de"), tmp_path, script, dark)
    assert found["faults"] == []
    assert found["passes"] > 20
