"""Formulas on paper: mathematics of the typesetter, made of nothing but its tree."""

from __future__ import annotations

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


def write_typst(tree: Expression) -> str:
    """Return a formula in the typesetter's notation.

    Every name of more than a letter is quoted, so that no text of a record is ever a command.

    Parameters
    ----------
    tree
        The formula.

    Examples
    --------
    >>> write_typst(Fraction(Symbol("a"), Symbol("Kp")))
    'frac(a, "Kp")'
    """
    match tree:
        case Number(digits):
            # A bare comma would part two arguments.
            return f'"{digits}"' if "," in digits else digits
        case Symbol(letter, index):
            return f"{_name(letter)}_({_name(index)})" if index else _name(letter)
        case Power(base, exponent):
            return f"{write_typst(base)}^({write_typst(exponent)})"
        case Fraction(above, below):
            return f"frac({write_typst(above)}, {write_typst(below)})"
        case Product(factors):
            return " thin ".join(map(write_typst, factors))
        case Terms(signs, terms):
            return " ".join(map(_signed, range(len(terms)), signs, terms))
        case Enclosed(inner, is_magnitude):
            left, right = "||" if is_magnitude else "()"
            return f"lr({left} {write_typst(inner)} {right})"
        case Root(inner):
            return f"sqrt({write_typst(inner)})"
        case Call(name, arguments):
            return f"{_name(name)} lr(({', '.join(map(write_typst, arguments))}))"
        case Sum(inner):
            return f"sum_i {write_typst(inner)}"
        case Relation(sides, signs):
            rest = (
                f"{sign} {write_typst(side)}" for sign, side in zip(signs, sides[1:], strict=True)
            )
            return " ".join([write_typst(sides[0]), *rest])
    raise TypeError(type(tree).__name__)


def _name(name: str) -> str:
    return name if len(name) == 1 else f'"{name}"'


def _signed(place: int, sign: str, term: Expression) -> str:
    return write_typst(term) if place == 0 and sign == "+" else f"{sign} {write_typst(term)}"
