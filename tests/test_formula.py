"""Formulas of the record: what is typed is what is set, and both mean the same numbers."""

from __future__ import annotations

from math import exp, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mtcommission.messages.formula import (
    Call,
    Enclosed,
    Expression,
    Fraction,
    Number,
    Power,
    Product,
    Relation,
    Root,
    Sum,
    Symbol,
    Terms,
    find_symbols,
)
from mtcommission.sheet.formula import parse_formula
from mtcommission.sheet.mathml import write_mathml
from mtcommission.sheet.typst_math import write_typst


def value(tree: Expression, known: dict[str, float]) -> float:
    """What a formula is worth; the sum is over one mode."""
    match tree:
        case Number(digits):
            return float(digits)
        case Symbol(letter, index):
            return known[f"{letter}_{index}" if index else letter]
        case Power(base, exponent):
            return float(value(base, known) ** value(exponent, known))
        case Fraction(above, below):
            return value(above, known) / value(below, known)
        case Product(factors):
            product = 1.0
            for factor in factors:
                product *= value(factor, known)
            return product
        case Terms(signs, terms):
            return sum(
                (-1.0 if sign == "-" else 1.0) * value(term, known)
                for sign, term in zip(signs, terms, strict=True)
            )
        case Enclosed(inner, is_magnitude):
            return abs(value(inner, known)) if is_magnitude else value(inner, known)
        case Root(inner):
            return float(value(inner, known) ** 0.5)
        case Sum(inner):
            return value(inner, known)
        case Call(name, arguments):
            functions = {"min": min, "max": max, "exp": lambda x: exp(x)}
            return float(functions[name](*(value(part, known) for part in arguments)))
        case Relation(sides, _):
            return value(sides[-1], known)


NUMBERS = st.floats(min_value=0.1, max_value=9.0)


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
def test_a_formula_means_what_a_programmer_reads(a, t, w, k):
    """A fraction that took in too much would set a wrong formula on every sheet."""
    known = {"a": a, "t_j": t, "ω_v": w, "Kp": k, "π": pi}
    for text, expected in {
        "a/t_j": a / t,
        "a Kp/omega_v^2 t_j": a * k / w**2 * t,
        "1.5 a - Kp/(2 t_j) + 3": 1.5 * a - k / (2 * t) + 3,
        "root(a^2 + (Kp t_j)^2)": (a**2 + (k * t) ** 2) ** 0.5,
        "|a - Kp| / Kp": abs(a - k) / k,
        "min(a, 1.3 t_j/(omega_v (Kp + 1/a)))": min(a, 1.3 * t / (w * (k + 1 / a))),
        "0.8 sum a Kp/omega_v^2": 0.8 * a * k / w**2,
        "a (1 + exp(-omega_v t_j/Kp))": a * (1 + exp(-w * t / k)),
        "2 pi a^2": 2 * pi * a**2,
    }.items():
        tree = parse_formula(text)
        assert tree is not None
        assert value(tree, known) == pytest.approx(expected, rel=1e-12), text


@pytest.mark.parametrize(
    "text",
    [
        "see the formula",
        "3 periods of base",
        "a +",
        "(a",
        "|a",
        "a ^",
        "a $ b",
        "",
        "<script>alert(1)</script>",
        "#panic()",
        'a "b"',
        "(" * 5000 + "a" + ")" * 5000,
    ],
)
def test_a_text_that_is_no_formula_stays_text(text):
    assert parse_formula(text) is None


def test_symbols_carry_their_index():
    tree = parse_formula("C_S^2 <= omega_v R(f t_j)")
    assert tree is not None
    assert find_symbols(tree) == {
        Symbol("C", "S"),
        Symbol("ω", "v"),
        Symbol("f"),
        Symbol("t", "j"),
    }


def test_both_printers_set_the_same_signs():
    tree = parse_formula("-2 root(|a|) <= min(a/Kp, sum C_i^2)")
    assert tree is not None
    assert write_typst(tree) == (
        '- 2 thin sqrt(lr(| a |)) ≤ "min" lr((frac(a, "Kp"), sum_i C_(i)^(2)))'
    )
    marks = write_mathml(tree)
    for mark in ("<mo>−</mo>", "<msqrt>", "<mo>≤</mo>", "<mfrac>", "<mo>∑</mo>", "<msub>"):
        assert mark in marks
    assert marks.count("<mrow>") == marks.count("</mrow>")


def test_a_decimal_comma_is_no_argument():
    """Set bare, min(0,4 T) would have two arguments, and the German rule another meaning."""
    tree = parse_formula("max(0.4 T, 2)", decimal_mark=",")
    assert tree is not None
    assert write_typst(tree) == '"max" lr(("0,4" thin T, 2))'
    assert "<mn>0,4</mn>" in write_mathml(tree)
