"""Formulas built as trees: they mean what Python computes, and survive being written down."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mtcommission.messages.formula import (
    Call,
    Expression,
    Number,
    Root,
    Sum,
    call,
    from_json,
    symbol,
    to_json,
    write_formula,
)

LEAVES = st.one_of(
    st.sampled_from(["a", "t_j", "omega_v", "Kp", "zeta"]).map(symbol),
    st.sampled_from(["2", "0.18", "1.5"]).map(Number),
)
TREES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda pair: pair[0] + pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] - pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] * pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] / pair[1]),
        inner.map(lambda part: part**2),
        inner.map(lambda part: -part),
        inner.map(abs),
        inner.map(Root),
        inner.map(Sum),
        st.tuples(inner, inner).map(lambda pair: call("min", *pair)),
    ),
    max_leaves=12,
)


@given(TREES, TREES)
def test_a_formula_survives_the_record(left: Expression, right: Expression) -> None:
    """If it failed, a sheet printed again from its record would state another formula."""
    for tree in (left, left.at_most(right), left.equals(right)):
        assert from_json(to_json(tree)) == tree


def test_brackets_come_where_they_are_needed() -> None:
    a, b, c = symbol("a"), symbol("b"), symbol("C_i")
    for tree, text in {
        a * (b + 1): "a (b + 1)",
        (a - b) / (a * b): "(a - b)/(a b)",
        a - (b - c): "a - (b - C_i)",
        (a * c) ** 2: "(a C_i)^2",
        (a / b) ** 2: "(a/b)^2",
        -a * b: "(-a) b",
        -(a * b) / c: "(-a b)/C_i",
        Sum(a * c) * b: "(sum a C_i) b",
        a / (b / c): "a/(b/C_i)",
        abs(a - b) / b: "|a - b|/b",
        1.5 / a: "1.5/a",
        2 - a: "2 - a",
    }.items():
        assert write_formula(tree) == text


@pytest.mark.parametrize(
    "entry",
    [
        None,
        True,
        [],
        ["Divide", "a"],
        ["Power", "a", 2, 3],
        [1, 2],
        {"a": 1},
        "two words",
        "<script>",
        float("nan"),
        10**400,
        ["Add"],
    ],
)
def test_what_is_no_formula_is_refused(entry: object) -> None:
    with pytest.raises(ValueError, match=r"formula|arguments"):
        from_json(entry)


def test_a_formula_deeper_than_python_follows_is_refused() -> None:
    entry: object = "a"
    for _ in range(5000):
        entry = ["Abs", entry]
    with pytest.raises(ValueError, match="formula"):
        from_json(entry)


def test_a_function_keeps_its_name() -> None:
    assert from_json(["R", "x"]) == Call("R", (symbol("x"),))
