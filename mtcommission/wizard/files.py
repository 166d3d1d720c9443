"""The wizard's files: what is known before the first question, and the profile at the end.

A profile is TOML that reads well in an editor; one that was there keeps the user's comments.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomlkit

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.files import write_text
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import TIME
from mtcommission.machine.profile.describe import find_unknown
from mtcommission.machine.profile.read import (
    find_key_lines,
    load_toml,
    read_key,
    read_profile_text,
)
from mtcommission.machine.readers import propose, read_path, show_key
from mtcommission.wizard import answers as own_keys
from mtcommission.wizard.answers import (
    ACCEPTED,
    Answers,
    Data,
    as_text,
    close_arrays,
    flatten,
    note_accepted,
    schema_key,
    si_value,
    to_answers,
)
from mtcommission.wizard.question import title
from mtcommission.wizard.script import OWN, list_questions

KEPT = ".answers"
"""Ending of the file beside the profile that keeps answers of an unfinished session."""

DELAYS = ("identified.delay.0", "identified.lag.0")
"""Keys of a profile that was identified, whose times are a lag of the force."""

LAG, LEAST_LAG = "drive.force_lag", 5e-5
"""A shorter delay [s] is that of a sensor: the response comes from the actual force."""

OPEN = re.compile(r"\n\n# [^\n]*\n(#   [\w.\[\]]+\n)+\Z")
"""The list of open questions at the end of an identified profile: the wizard asks them."""

COLUMN = 34
"""Where the comments of a profile begin, if the line leaves room."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """What was known before the first question."""

    answers: dict[str, str]  # from all sources; later ones win
    text: str  # of the profile that is changed; "" for a new one
    where: str  # name of the file of answers; "" without one
    lines: Mapping[str, int]  # line of each key in that file
    replaced: tuple[str, ...] = ()  # what that file changes of the profile or of kept answers

    def locate(self, fault: Fault) -> Fault:
        """Return a fault with its place in the file of answers; the profile is not written."""
        key = read_key(fault.key)
        return replace(fault, where=self.where or "answers", line=self.lines.get(key, 0))


def gather(output: Path, answers_file: Path | None) -> Source:
    """Return what is known: existing profile, then kept answers, then the file of answers.

    Raises
    ------
    InputError
        If a file cannot be read, or the file of answers has a key that nobody knows.
    """
    text, answers = "", dict[str, str]()
    if output.exists():
        text = OPEN.sub("\n", read_profile_text(output))
        answers = _of_profile(to_answers(load_toml(text, where=str(output))))
    kept = Path(f"{output}{KEPT}")
    if kept.exists():
        answers |= to_answers(load_toml(read_profile_text(kept), where=str(kept)))
    lines, replaced = dict[str, int](), tuple[str, ...]()
    if answers_file is not None:
        given, where = read_profile_text(answers_file), str(answers_file)
        data = load_toml(given, where=where)
        found = find_key_lines(given)
        lines = {".".join(map(str, path)): line for path, line in found.items()}
        said = close_arrays(_known(to_answers(data), where=where, lines=lines))
        replaced = tuple(
            f"{show_key(read_path(key))} {answers[key]} → {value or '–'}"
            for key, value in said.items()
            if not key.startswith(own_keys.OWN) and answers.get(key) and answers[key] != value
        )
        answers |= said
    where = str(answers_file or "")
    return Source(answers=answers, text=text, where=where, lines=lines, replaced=replaced)


def _of_profile(answers: dict[str, str]) -> dict[str, str]:
    """The answers of a profile: one with moves says of all that is optional that it is left out."""
    answers = close_arrays(answers)
    is_whole = any(key.startswith("moves.") and text for key, text in answers.items())
    for question in list_questions(answers):
        is_open = question.is_optional or question.choices
        if is_open and (is_whole or question.key in ("machine.motion", "drive.kind")):
            answers.setdefault(question.key, "")
    lag = sum(max(si_value(answers, key, TIME) or 0.0, 0.0) for key in DELAYS)
    if LAG not in answers and lag >= LEAST_LAG:
        answers = note_accepted({**answers, LAG: f"{1e3 * lag:.3g} ms"}, LAG)
    return answers


def keep(output: Path, answers: Answers) -> None:
    """Write the answers of an unfinished session beside the profile."""
    write_text(f"{output}{KEPT}", tomlkit.dumps(dict(answers)))


def _known(answers: dict[str, str], *, where: str, lines: Mapping[str, int]) -> dict[str, str]:
    """The answers, if each has a key of the profile or of the wizard."""
    own = (*OWN, "wizard.way", ACCEPTED)
    faults = []
    for key in answers:
        if schema_key(key) in own:
            continue
        is_own = key.startswith(own_keys.OWN)
        wrong = propose(key, own) if is_own else find_unknown(tuple(key.split(".")))
        if wrong:
            message = Message("key-unknown", hint=wrong)
            faults.append(Fault(where=where, line=lines.get(key, 0), key=key, message=message))
    if faults:
        raise InputError(sorted(faults, key=lambda fault: fault.line))
    return answers


# The profile


def write_document(data: Data, answers: Answers, defaults: Answers, words: Catalogue) -> str:
    """Return a new profile; each key is commented by its name, [plant] by what was typed for it."""
    document = tomlkit.document()
    for line in ("head", "assumed"):
        document.add(tomlkit.comment(words.text(f"document-{line}")))
    document.add(tomlkit.nl())
    for name, value in data.items():
        notes = _origins(answers, defaults, words) if name == "plant" else ()
        document.add(name, _item(name, value, words, notes))
    return tomlkit.dumps(document)


def _origins(answers: Answers, defaults: Answers, words: Catalogue) -> Iterator[str]:
    if way := answers.get("wizard.way", ""):
        yield title(way, words)
    for key, text in {**answers, **defaults}.items():
        if text and key.startswith("pair."):
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
        elif present is None or flatten(present) != flatten(value):
            old[key] = value


def _merge_tables(old: Any, new: Any) -> None:
    for one, other in zip(old, new, strict=False):
        _merge(one, other)
    for table in new[len(old) :]:
        added = tomlkit.table()
        added.update(table)
        old.append(added)
    del old[len(new) :]


def _is_table(value: object) -> bool:
    return isinstance(value, Mapping) or _is_tables(value)


def _is_tables(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)
