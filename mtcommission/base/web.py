"""Pages that run their own script and nothing else, and ask no network for anything."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup


def render_page(folder: Path, *, style: str, script: str, **values: object) -> str:
    """Return ``page.html`` of a folder with its values; what is ``Markup`` stands as it is.

    Style and script are admitted by their hashes; the content security policy forbids all else.
    """
    policy = (
        "default-src 'none'; base-uri 'none'; form-action 'none'; "
        f"style-src {_hash_source(style)}; script-src {_hash_source(script)}"
    )
    page = fill_template(
        folder / "page.html", policy=policy, style=Markup(style), script=Markup(script), **values
    )
    # A file name may hold bytes that are no letters: they must not lose the whole page.
    return page.encode(errors="replace").decode()


def fill_template(path: Path, beside: Path | None = None, /, **values: object) -> str:
    """Return a template with its values, all text escaped.

    Others of its folder may be included, and those of a folder ``beside``.
    """
    folders = [path.parent, *([beside] if beside else [])]
    environment = Environment(
        loader=FileSystemLoader(folders), autoescape=True, undefined=StrictUndefined
    )
    return environment.get_template(path.name).render(**values)


def _hash_source(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def json_for_script(data: Mapping[str, Any]) -> Markup:
    """Return JSON that cannot end its script element: no "<" is left in it."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))
