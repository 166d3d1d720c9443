"""The page in a real browser: offline, without a complaint, with plots that zoom, for everybody.

Needs chromium; the test of accessibility needs axe-core, too (see ``.ci/run``).
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from base64 import b64encode
from hashlib import sha256
from html import unescape
from pathlib import Path
from typing import Any

import pypdfium2
import pytest

from .sheet_record import (
    example_record,
    five_moves_record,
    print_html,
    retuned,
    rotary_record,
    shipped_record,
)

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs the browser chromium")

CUT = ("--proxy-server=127.0.0.1:9", "--host-resolver-rules=MAP * ~NOTFOUND")
"""The network is cut: every name is unknown, and the only proxy refuses."""

TELL = """
const tell = found => {
  const told = document.createElement("pre");
  told.id = "told";
  told.textContent = JSON.stringify(found);
  document.body.append(told);
};
"""

ZOOM = (
    """
const faults = [];
addEventListener("error", event => faults.push(event.message));
addEventListener("securitypolicyviolation", event => faults.push(event.blockedURI));
"""
    + TELL
    + """
const curves = svg => [...svg.querySelectorAll("path, rect, text, circle")]
  .map(part => (part.getAttribute("d") ?? "") + part.getAttribute("x") + part.textContent).join();
const drag = (svg, from, to) => {
  const box = svg.getBoundingClientRect();
  const at = share => ({
    clientX: box.left + share * box.width,
    clientY: box.top + (0.3 + 0.3 * share) * box.height,
    bubbles: true,
  });
  svg.dispatchEvent(new PointerEvent("pointerdown", at(from)));
  svg.dispatchEvent(new PointerEvent("pointermove", at(to)));
  svg.dispatchEvent(new PointerEvent("pointerup", at(to)));
};
addEventListener("load", () => {
  const plots = {};
  for (const host of document.querySelectorAll("[data-plot]")) {
    const svg = host.querySelector("svg"), before = curves(svg);
    drag(svg, 0.3, 0.6);
    const zoomed = curves(svg);
    svg.dispatchEvent(new MouseEvent("dblclick", {bubbles: true}));
    svg.dispatchEvent(new PointerEvent("pointerleave"));
    const restored = curves(svg);
    svg.dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowRight", bubbles: true}));
    plots[host.dataset.plot] = {
      zooms: zoomed !== before, restores: restored === before,
      tells: svg.querySelectorAll("tspan").length, curves: svg.querySelectorAll("path").length,
    };
    svg.dispatchEvent(new PointerEvent("pointerleave"));
  }
  const one = key => document.querySelector(`[data-plot="${key}"] svg`);
  const ticks = svg => [...svg.querySelectorAll("text[text-anchor=middle]")]
    .map(text => text.textContent).join();
  drag(one("drive-1"), 0.3, 0.6);
  const linked = [one("drive-1"), one("vibration-1"), one("drive-2")].map(ticks);
  const requests = performance.getEntriesByType("resource").map(entry => entry.name);
  tell({faults, plots, linked, requests});
});
"""
)


def browse(html: str, folder: Path, script: str, *options: str) -> tuple[dict[str, Any], str]:
    """What a script found in the page, and what the browser wrote on its console.

    The page's policy stays; it admits this one script more.
    """
    digest = b64encode(sha256(script.encode()).digest()).decode()
    admitting = html.replace("script-src ", f"script-src 'sha256-{digest}' ", 1)
    assert admitting != html
    # Before the page's own scripts, so that it hears of their faults.
    file = folder / "page.html"
    file.write_text(admitting.replace("<title>", f"<script>{script}</script><title>", 1), "utf-8")
    command = [str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    command += ["--enable-logging=stderr", "--virtual-time-budget=20000", *CUT, *options]
    # The budget is of virtual time: on a busy machine it can end before the page's next frame is
    # drawn, and what waits for that frame tells nothing. Then the page is opened again.
    for attempt in range(3):
        finished = subprocess.run(
            [*command, f"--user-data-dir={folder / f'user-{attempt}'}", file.as_uri()],
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
        )
        told = re.search('<pre id="told">(.*?)</pre>', finished.stdout, re.DOTALL)
        if told:
            break
    assert told, finished.stderr
    console = "\n".join(line for line in finished.stderr.splitlines() if "CONSOLE" in line)
    return json.loads(unescape(told[1])), console


@pytest.fixture(scope="module")
def page():
    return print_html(five_moves_record())


def test_the_page_works_offline_and_every_plot_zooms(page, tmp_path):
    """Read from disk, beside a machine without a network, by people who look closely."""
    found, console = browse(page, tmp_path, ZOOM)
    assert console == ""
    assert found["faults"] == []
    assert found["requests"] == []
    assert len(found["plots"]) > 14
    for key, plot in found["plots"].items():
        assert plot["zooms"], key
        assert plot["restores"], key
        assert plot["tells"] > 0, key
        assert plot["curves"] > 3, key
    drive, vibration, other = found["linked"]
    assert drive == vibration != other


def test_a_fault_in_the_page_would_be_seen(page, tmp_path):
    """The test above would find nothing in a broken page either, if it could not look."""
    broken = page.replace("<main>", '<main><img src="https://example.org/x.png" alt="x">', 1)
    found, console = browse(broken, tmp_path, ZOOM)
    assert found["faults"] == ["https://example.org/x.png"]
    assert "Content Security Policy" in console


WIDTHS = (
    TELL
    + """
addEventListener("load", () => {
  const right = part => part.getBoundingClientRect().right;
  const cut = [...document.querySelectorAll("h1, h2, .headline *")]
    .filter(part => right(part) > right(part.closest("section, header")))
    .map(part => part.textContent);
  const curves = [...document.querySelectorAll("[data-plot]")];
  const letters = Math.min(...curves.map(host => 12 * host.firstChild.getScreenCTM().a));
  const over = Math.max(...curves.flatMap(host =>
    [...host.querySelectorAll("text")].map(text => right(text) - right(host))));
  const needed = document.documentElement.scrollWidth;
  const tall = Math.max(...[...document.querySelectorAll(".formula")]
    .map(formula => formula.scrollHeight - formula.clientHeight));
  tell({cut, inner: innerWidth, needed, letters, over, tall});
});
"""
)


def test_nothing_is_cut_on_a_phone(tmp_path):
    """The values to enter are read at the machine, from whatever has a screen."""
    record = rotary_record()
    record["limits"]["recommended"]["jerk"] = 123456.0
    # The whole hash of the earlier record is the longest word of a sheet.
    html = print_html(record, language="de", before=rotary_record())
    found, _ = browse(html, tmp_path, WIDTHS, "--window-size=500,900")
    assert found["inner"] <= 500
    assert found["cut"] == []
    assert found["needed"] <= found["inner"]
    # Curves drawn for a desk had letters of 4 px on a telephone.
    assert found["letters"] > 11.0
    assert found["over"] < 1.0
    # Formulas that are a little too tall for their line had scroll bars, each of them.
    assert found["tall"] <= 0


def test_nothing_is_cut_on_paper(tmp_path):
    """Paper does not scroll: the last columns of wide tables were cut off at its edge."""
    page, pdf = tmp_path / "page.html", tmp_path / "page.pdf"
    page.write_text(print_html(rotary_record(), language="de"), "utf-8")
    command = [str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", *CUT]
    command += ["--no-pdf-header-footer", f"--print-to-pdf={pdf}"]
    command += [f"--user-data-dir={tmp_path / 'user'}", page.as_uri()]
    subprocess.run(command, capture_output=True, timeout=120, check=True)
    for number, sheet in enumerate(pypdfium2.PdfDocument(pdf), start=1):
        text = sheet.get_textpage()
        right = max(text.get_rect(k)[2] for k in range(text.count_rects()))
        # 18 mm of margin are 51 pt; the box of a letter is a little wider than its ink.
        assert right < sheet.get_width() - 48.0, number


def axe_file() -> Path:
    """Where AXE_CORE says that axe-core is, or where ``npm install --global`` puts it."""
    if "AXE_CORE" in os.environ:
        return Path(os.environ["AXE_CORE"])
    if shutil.which("npm") is None:
        return Path("axe.min.js")
    root = subprocess.run(["npm", "root", "-g"], capture_output=True, text=True, check=True)
    return Path(root.stdout.strip()) / "axe-core" / "axe.min.js"


AXE_RUN = (
    TELL
    + """
addEventListener("load", () => axe.run(document).then(found => {
  const faults = found.violations.map(v => [v.id, ...v.nodes.map(node => node.failureSummary)]);
  const ground = getComputedStyle(document.body).backgroundColor;
  tell({faults, passes: found.passes.length, ground});
}));
"""
)


@pytest.mark.skipif(not axe_file().exists(), reason="needs axe-core")
def test_axe_finds_nothing_in_light_and_dark_and_can_find(page, tmp_path):
    """People who cannot see the plots, or not the colours, sign sheets, too."""
    script = axe_file().read_text(encoding="utf-8") + AXE_RUN
    before = example_record()
    record = before | {"what_if": shipped_record("ball-screw")["what_if"]}
    german = print_html(record, language="de", before=retuned(before))
    light, _ = browse(page, tmp_path, script, "--blink-settings=preferredColorScheme=1")
    dark, _ = browse(german, tmp_path, script, "--blink-settings=preferredColorScheme=0")
    assert light["faults"] == dark["faults"] == []
    assert min(light["passes"], dark["passes"]) > 20
    assert light["ground"] == "rgb(255, 255, 255)"
    assert dark["ground"] == "rgb(22, 22, 22)"
    mute = page.replace('<html lang="en">', "<html>")
    found, _ = browse(mute, tmp_path, script)
    assert "html-has-lang" in {fault[0] for fault in found["faults"]}
