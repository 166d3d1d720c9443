"""Formulas in the page: MathML, which browsers set without any help."""

from __future__ import annotations

from html import escape

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
)

THIN = '<mspace width="0.17em"></mspace>'


def write_mathml(tree: Expression) -> str:
    """Return a formula as a ``math`` element with fractions of full size.

    Parameters
    ----------
    tree
        The formula.

    Examples
    --------
    >>> write_mathml(Symbol("t", "j"))
    '<math displaystyle="true"><msub><mi>t</mi><mi>j</mi></msub></math>'
    """
    return f'<math displaystyle="true">{_mark(tree)}</math>'


def _mark(tree: Expression) -> str:
    match tree:
        case Number(digits):
            return f"<mn>{escape(digits)}</mn>"
        case Symbol(letter, index):
            name = f"<mi>{escape(letter)}</mi>"
            return f"<msub>{name}<mi>{escape(index)}</mi></msub>" if index else name
        case Power(base, exponent):
            return f"<msup>{_row(base)}{_row(exponent)}</msup>"
        case Fraction(above, below):
            return f"<mfrac>{_row(above)}{_row(below)}</mfrac>"
        case Product(factors):
            return THIN.join(map(_mark, factors))
        case Terms(signs, terms):
            return "".join(map(_signed, range(len(terms)), signs, terms))
        case Enclosed(inner, is_magnitude):
            left, right = "||" if is_magnitude else "()"
            return f"<mrow><mo>{left}</mo>{_mark(inner)}<mo>{right}</mo></mrow>"
        case Root(inner):
            return f"<msqrt>{_mark(inner)}</msqrt>"
        case Call(name, arguments):
            listed = "<mo>,</mo>".join(map(_mark, arguments))
            return f"<mi>{escape(name)}</mi><mrow><mo>(</mo>{listed}<mo>)</mo></mrow>"
        case Sum(inner):
            return f"<munder><mo>∑</mo><mi>i</mi></munder>{_mark(inner)}"
        case Relation(sides, signs):
            rest = (
                f"<mo>{sign}</mo>{_mark(side)}" for sign, side in zip(signs, sides[1:], strict=True)
            )
            return _mark(sides[0]) + "".join(rest)
    raise TypeError(type(tree).__name__)


def _row(tree: Expression) -> str:
    return f"<mrow>{_mark(tree)}</mrow>"


def _signed(place: int, sign: str, term: Expression) -> str:
    shown = "" if place == 0 and sign == "+" else f"<mo>{sign.replace('-', '−')}</mo>"
    return shown + _mark(term)
