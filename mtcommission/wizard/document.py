"""Profile tables -> TOML that reads well in an editor, and keeps the user's comments."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

import tomlkit

from mtcommission.messages.catalogue import Catalogue
from mtcommission.wizard.answers import Answers, Data, as_text
from mtcommission.wizard.question import title

TABLES = ("requirements.peaks", "requirements.modes")
"""Tables below a table that get a header of their own; others stand in one line."""

COLUMN = 34
"""Where the comments begin, if the line leaves room."""


def write_document(data: Data, answers: Answers, defaults: Answers, words: Catalogue) -> str:
    """Return a new profile; each key is commented by its name, [plant] by what was typed for it."""
    lines = [
        *(f"# {words.text(f'document-{line}')}" for line in ("head", "check", "assumed")),
        "",
        f"schema = {data['schema']}",
    ]
    for name, table in data.items():
        if name == "plant":
            lines += ["", *_origins(answers, defaults, words)]
        if name != "schema":
            lines += _table(name, table, words)[name == "plant" :]
    return "\n".join(lines) + "\n"


def _origins(answers: Answers, defaults: Answers, words: Catalogue) -> Iterator[str]:
    """What was typed where the profile holds derived values."""
    typed = {**answers, **defaults}
    derived = {key: text for key, text in typed.items() if key.startswith(("measured.", "pair."))}
    if way := answers.get("wizard.way", ""):
        yield f"# {title(way, words)}"
    for key, text in derived.items():
        if text:
            mark = f" ({words.text('source-accepted-default')})" if key in defaults else ""
            yield f"#   {key.partition('.')[2]} = {text}{mark}"


def update_document(text: str, data: Data) -> str:
    """Return a profile with other values; comments, order and unchanged lines stay."""
    document = tomlkit.parse(text)
    if _kind_of(document) != _kind_of(data) and "plant" in document:
        document["plant"] = data["plant"]  # another kind shares no key with it
    _merge(document, data)
    return tomlkit.dumps(document)


def _kind_of(data: Mapping[str, object]) -> str:
    plant = data.get("plant")
    return as_text(plant.get("kind", "")) if isinstance(plant, Mapping) else ""


def _merge(old: Any, new: Mapping[str, object]) -> None:
    for key in [key for key in old if key not in new]:
        del old[key]
    for key, value in new.items():
        present = old.get(key)
        if isinstance(value, dict) and isinstance(present, Mapping):
            _merge(present, value)
        elif _is_tables(value) and _is_tables(present):
            _merge_tables(present, value)
        elif present is None or _plain(present) != _plain(value):
            old[key] = value


def _merge_tables(old: Any, new: Any) -> None:
    for one, other in zip(old, new, strict=False):
        _merge(one, other)
    for table in new[len(old) :]:
        added = tomlkit.table()
        added.update(table)
        old.append(added)
    del old[len(new) :]


def _plain(value: object) -> object:
    """Values that mean the same compare equal: 0.02 and "0.02"."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return as_text(value)


def _is_tables(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _table(name: str, table: object, words: Catalogue) -> list[str]:
    if _is_tables(table) and isinstance(table, list):
        found = (["", f"[[{name}]]", *_rows(name, item, words)] for item in table)
        return [line for lines in found for line in lines]
    if not isinstance(table, dict):
        return [f"{_key(name)} = {_inline(table)}"]
    own: Data = {}
    below: Data = {}
    for key, value in table.items():
        has_header = f"{name}.{key}" in TABLES or (name == "plant" and _is_tables(value))
        (below if has_header else own)[key] = value
    lines = ["", f"[{name}]", *_rows(name, own, words)]
    for key, value in below.items():
        lines += _table(f"{name}.{key}", value, words)
    return lines


def _rows(path: str, table: Mapping[str, object], words: Catalogue) -> Iterator[str]:
    for key, value in table.items():
        row, name = f"{_key(key)} = {_inline(value)}", words.name(f"{path}.{key}")
        is_named = name != key and (key, path) != ("kind", "plant")
        yield f"{row:<{COLUMN}} # {name}" if is_named else row


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _string(key)


def _inline(value: object) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items()) + " }"
    return as_text(value) if isinstance(value, int) else _string(str(value))


def _string(text: str) -> str:
    """A basic string: JSON's escapes are TOML's, but for DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
