"""README and docs/: what they link to is there, and what they call is what the program takes."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import typer.main

from mtcommission.cli import app
from mtcommission.group.contours import CornerSpeed
from mtcommission.group.judged import Circle, FeedOverRadius
from mtcommission.group.record import GroupRecord, RuleEntry

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
COMMANDS: dict[str, Any] = typer.main.get_command(app).commands  # type: ignore[attr-defined]

ids = [page.name for page in PAGES]


def anchors(page: Path) -> set[str]:
    """Headings as GitHub links to them."""
    heads = re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=ids)
def test_every_link_between_pages_leads_somewhere(page):
    for target, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)]*)\)", page.read_text("utf-8")):
        if not target.startswith("http"):
            to = page.parent / target if target else page
            assert to.exists(), f"{page.name}: {target}"
            assert not anchor or anchor in anchors(to), f"{page.name}: {target}#{anchor}"


def calls(text: str) -> list[tuple[str, list[str]]]:
    """Commands with their options, of code in the text: whole lines and between backquotes."""
    code = re.findall(r"^(?:.*&& )?mtcommission (.*)$|`(?:mtcommission )?([^`\n]+)`", text, re.M)
    words = [(line or inline).split() for line, inline in code]
    return [
        (first, [word.split("=")[0] for word in rest if re.match(r"--?[a-z]", word)])
        for first, *rest in filter(None, words)
        if first in COMMANDS
    ]


@pytest.mark.parametrize("page", PAGES, ids=ids)
def test_every_command_and_option_that_is_shown_exists(page):
    """Else somebody copies a line and is told that there is no such option."""
    for name, options in calls(page.read_text("utf-8")):
        known = {word for parameter in COMMANDS[name].params for word in parameter.opts}
        for option in options:
            assert option in known | {"--help"}, f"{page.name}: {name} {option}"


def test_readme_shows_the_way_of_an_axis():
    """What the two tests above look at is found at all."""
    shown = [name for name, _ in calls((ROOT / "README.md").read_text("utf-8"))]
    for name in ("identify", "check", "run", "export", "verify"):
        assert name in shown


def test_every_key_of_a_groups_record_is_listed():
    text = (ROOT / "docs" / "group.md").read_text("utf-8")
    for part in (GroupRecord, FeedOverRadius, Circle, CornerSpeed, RuleEntry):
        for key in (item.name for item in fields(part)):
            assert f"`{key}`" in text, key
