"""Formulas on the page and on paper: both printers set the same tree, and nothing but it."""

from __future__ import annotations

import pytest

from mtcommission.messages.formula import (
    Expression,
    Root,
    Sum,
    call,
    from_json,
    symbol,
    with_decimal_mark,
)
from mtcommission.sheet.mathml import write_mathml
from mtcommission.sheet.typst_math import write_typst


def test_both_printers_set_the_same_signs() -> None:
    a, modes = symbol("a"), Sum(symbol("C_i") ** 2)
    tree = (-(2 * Root(abs(a)))).at_most(call("min", a / symbol("Kp"), modes))
    assert write_typst(tree) == (
        '- 2 thin sqrt(lr(| a |)) ≤ "min" lr((frac(a, "Kp"), sum_i C_(i)^(2)))'
    )
    marks = write_mathml(tree)
    for mark in ("<mo>−</mo>", "<msqrt>", "<mo>≤</mo>", "<mfrac>", "<mo>∑</mo>", "<msub>"):
        assert mark in marks
    assert marks.count("<mrow>") == marks.count("</mrow>")


def test_a_decimal_comma_is_no_argument() -> None:
    """Set bare, min(0,4 T) would have two arguments, and the German rule another meaning."""
    tree = with_decimal_mark(call("max", 0.4 * symbol("T"), 2), ",")
    assert write_typst(tree) == '"max" lr(("0,4" thin T, 2))'
    assert "<mn>0,4</mn>" in write_mathml(tree)


@pytest.mark.parametrize("entry", [["panic", "a"], "panic", ["Divide", "a", "read"]])
def test_a_name_in_a_record_is_no_command_of_the_typesetter(entry: object) -> None:
    """A record from elsewhere could otherwise run what it likes while its sheet is printed."""
    tree: Expression = from_json(entry)
    words = {word for word in write_typst(tree).replace("frac(", "").split() if len(word) > 1}
    assert not any(word.startswith(("panic", "read")) for word in words)


@pytest.mark.parametrize("entry", ["#panic()", "<b>", ["<script>", "a"], ["a b", "c"], 'a"b'])
def test_what_is_no_name_is_no_formula_or_stays_text(entry: object) -> None:
    try:
        tree = from_json(entry)
    except ValueError:
        return
    assert "<script>" not in write_mathml(tree)
    assert write_typst(tree).count('"') % 2 == 0
