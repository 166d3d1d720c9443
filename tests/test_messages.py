"""Every message has a text in every language, for both kinds of axis, with the same values.

If one of these fails, a user reads a key, an English sentence in a German sheet, or a force where
the axis has a torque.
"""

from __future__ import annotations

import ast
import pickle
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from fluent.syntax import FluentParser
from fluent.syntax import ast as ftl
from fluent.syntax.visitor import Visitor

import mtcommission
from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue, entries_of
from mtcommission.base.messages.message import Message

SOURCE = Path(mtcommission.__file__).parent


class _Places(Visitor):
    """Values, functions and other texts that a text speaks of."""

    def __init__(self) -> None:
        self.values: set[str] = set()
        self.functions: set[str] = set()
        self.others: set[str] = set()

    def visit_VariableReference(self, node: ftl.VariableReference) -> None:
        self.values.add(node.id.name)

    def visit_FunctionReference(self, node: ftl.FunctionReference) -> None:
        self.functions.add(node.id.name)
        self.generic_visit(node)

    def visit_MessageReference(self, node: ftl.MessageReference) -> None:
        self.others.add(node.id.name)


def _places(language: str, kind: str) -> _Places:
    places = _Places()
    entry = FluentParser().parse_entry(f"{kind} = {entries_of(language)[kind]}")
    assert isinstance(entry, ftl.Message | ftl.Term), f"{language}: {kind} is no Fluent text"
    places.visit(entry)
    for other in places.others:
        inner = _places(language, other)
        places.values |= inner.values
        places.functions |= inner.functions
    return places


def _values(language: str, kind: str) -> set[str]:
    return _places(language, kind).values - {"axis"}


def _parts(language: str, kind: str) -> list[str]:
    """The kind and the parts of its text, e.g. the reason beside a row."""
    parts = re.findall(r"^ +(\.\w+) =", entries_of(language)[kind], re.MULTILINE)
    return [kind, *(f"{kind}{part}" for part in sorted(parts))]


def _calls() -> Iterator[tuple[str, str, set[str]]]:
    """Place, kind and names of values of every message that the source makes or says."""
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call) or not node.args:
                continue
            name = node.func.id if isinstance(node.func, ast.Name) else ""
            method = node.func.attr if isinstance(node.func, ast.Attribute) else ""
            first = node.args[0]
            if (name == "Message" or method == "text") and isinstance(first, ast.Constant):
                named = [keyword.arg for keyword in node.keywords]
                if None not in named and not str(first.value).partition(".")[2]:
                    yield f"{path.name}:{node.lineno}", str(first.value), {str(n) for n in named}


def test_every_text_exists_in_every_language_with_the_same_values():
    for language in LANGUAGES:
        own = {kind for kind in entries_of(language) if not kind.startswith("help-")}
        assert own == set(entries_of("en")), language
        for kind in entries_of("en"):
            assert _values(language, kind) == _values("en", kind), f"{language}: {kind}"
            assert _parts(language, kind) == _parts("en", kind), f"{language}: {kind}"


def test_every_line_of_the_files_is_of_a_text_and_every_key_of_one_file():
    for language in LANGUAGES:
        seen: dict[str, str] = {}
        for path in sorted((SOURCE / "base" / "messages" / "texts" / language).glob("*.ftl")):
            for entry in FluentParser().parse(path.read_text(encoding="utf-8")).body:
                assert not isinstance(entry, ftl.Junk), f"{path.name}: {entry.content}"
                if isinstance(entry, ftl.Message | ftl.Term):
                    key = entry.id.name
                    assert key not in seen, f"{language}: {key} in {seen[key]} and {path.name}"
                    seen[key] = path.name


def test_every_message_that_the_source_makes_has_a_text_with_its_values():
    for place, kind, values in _calls():
        assert kind in entries_of("en"), f"{place}: no text for {kind}"
        missing = _values("en", kind) - values
        assert not missing, f"{place}: {kind} is said without {missing}"


@pytest.mark.parametrize("rotary", [False, True], ids=["linear", "rotary"])
@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_every_text_can_be_said(language, *, rotary):
    catalogue = Catalogue(language, rotary=rotary)
    for kind in entries_of(language):
        if kind.startswith("-"):
            continue
        for part in _parts(language, kind):
            said = catalogue.text(part, **dict.fromkeys(_values(language, kind), 1.5))
            assert said or '{""}' in entries_of(language)[kind], part
            assert "{" not in said, part


def test_every_outcome_tells_what_was_computed_and_survives_a_process():
    """A worker of a sweep hands its error over; a kind without a text would hide the remedy."""
    for outcome in Outcome:
        error = ComputationError(outcome, Message("requirement-peak", signal="v_b"))
        again = pickle.loads(pickle.dumps(error))
        assert str(again).startswith(f"{outcome.name.lower().replace('_', ' ')}: peak v_b: ")
        assert ": Höchstwert v_b: " in again.text(Catalogue("de"))


def test_a_text_of_the_user_is_never_taken_for_one_of_ours():
    """A machine called "settling time" is not translated; no sentence is found by its words."""
    for kind in entries_of("en"):
        if not _values("en", kind) and not kind.startswith("-"):
            words = Catalogue("en").text(kind)
            assert Catalogue("de", rotary=True).say(words) == words, kind


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_value_of_any_length_can_be_said(language):
    """A column's name of 5000 letters ended in a traceback: Fluent takes no such value."""
    said = Catalogue(language).say(Message("record-both", first="x" * 5000, then="y" * 5000))
    assert said.startswith("x" * 1000)
    assert 4000 <= len(said) < 4100
    nested = Message("record-both", first="a" * 3000, then=Message("foreign", text=said))
    assert len(Catalogue(language).say(nested)) < 4100


@pytest.mark.parametrize("language", ["en", "de"])
def test_no_text_about_an_open_loop_axis_has_a_force(language):
    """Its motor follows; what stands for a force there is the acceleration, by a placeable."""
    assert Catalogue(language, follows=True).text("word-f-set") == "a_set"
    word = {"en": "[Ff]orce", "de": "Kraft"}[language]
    force = re.compile(rf"(?<![\w$.-])(?<!input ){word}(?![\w-])|(?<=[a-zäöü])kraft\b|F_max|F_set")
    for path in (SOURCE / "base" / "messages" / "texts" / language).glob("*.ftl"):
        # They ask what the axis is, or speak of the paper's machine and of examples.
        if path.name in ("wizard.ftl", "help.ftl", "validate.ftl", "paper.ftl"):
            continue
        text = path.read_text("utf-8").partition("word-force =")[0]
        other = ("#", "   *[other]", "example-")
        lines = [one for one in text.splitlines() if not one.startswith(other)]
        assert not [one for one in lines if force.search(re.sub(r"\{[^{}]*\}", "", one))]
