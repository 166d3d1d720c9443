"""Profile tables -> TOML that reads well in an editor, and keeps the user's comments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import tomlkit

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.wizard.answers import Answers, Data, as_text
from mtcommission.wizard.question import title

COLUMN = 34
"""Where the comments begin, if the line leaves room."""


def write_document(data: Data, answers: Answers, defaults: Answers, words: Catalogue) -> str:
    """Return a new profile; each key is commented by its name, [plant] by what was typed for it."""
    document = tomlkit.document()
    for line in ("head", "check", "assumed"):
        document.add(tomlkit.comment(words.text(f"document-{line}")))
    document.add(tomlkit.nl())
    for name, value in data.items():
        notes = _origins(answers, defaults, words) if name == "plant" else ()
        document.add(name, _item(name, value, words, notes))
    return tomlkit.dumps(document)


def _origins(answers: Answers, defaults: Answers, words: Catalogue) -> Iterator[str]:
    """What was typed where the profile holds derived values."""
    typed = {**answers, **defaults}
    derived = {key: text for key, text in typed.items() if key.startswith(("measured.", "pair."))}
    if way := answers.get("wizard.way", ""):
        yield title(way, words)
    for key, text in derived.items():
        if text:
            mark = f" ({words.text('source-accepted-default')})" if key in defaults else ""
            yield f"  {key.partition('.')[2]} = {text}{mark}"


def _item(path: str, value: object, words: Catalogue, notes: Iterable[str] = ()) -> Any:
    """A value of a profile with its comments; tables stand behind the keys beside them."""
    if _is_tables(value) and isinstance(value, list):
        tables = tomlkit.aot()
        tables.extend(_item(path, one, words) for one in value)
        return tables
    if not isinstance(value, Mapping):
        return tomlkit.item(value)
    table = tomlkit.table()
    for note in notes:
        table.add(tomlkit.comment(note))
    for key, inner in sorted(value.items(), key=lambda one: _is_table(one[1])):
        item, name = _item(f"{path}.{key}", inner, words), words.name(f"{path}.{key}")
        table.add(key, item)
        if name != key and (key, path) != ("kind", "plant") and not _is_table(inner):
            item.comment(name)
            width = COLUMN - len(f"{tomlkit.key(key).as_string()} = {item.as_string()}")
            item.trivia.comment_ws = " " * max(width, 1)
    return table


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


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping) or _is_tables(value)


def _is_tables(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)
