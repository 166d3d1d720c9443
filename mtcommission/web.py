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
    """Return ``page.html`` of a folder with its values, all text escaped.

    Parameters
    ----------
    folder
        Of the template.
    style, script
        Admitted by their hashes; the content security policy forbids everything else.
    values
        Of the template; what is ``Markup`` stands as it is.
    """
    environment = Environment(
        loader=FileSystemLoader(folder), autoescape=True, undefined=StrictUndefined
    )
    policy = (
        "default-src 'none'; base-uri 'none'; form-action 'none'; "
        f"style-src {_hash_source(style)}; script-src {_hash_source(script)}"
    )
    page = environment.get_template("page.html").render(
        policy=policy, style=Markup(style), script=Markup(script), **values
    )
    # A file name may hold bytes that are no letters: they must not lose the whole page.
    return page.encode(errors="replace").decode()


def _hash_source(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def json_for_script(data: Mapping[str, Any]) -> Markup:
    """Return JSON that cannot end its script element: no "<" is left in it."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))
