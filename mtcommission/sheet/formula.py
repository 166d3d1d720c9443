"""A formula of the record, written in plain signs, as a tree: ``C_i = m |g_i|/omega_i^3``.

The record writes formulas as one types them: ``^`` and ``_`` raise and lower, a space
multiplies, ``name(`` without a space calls a function, ``sum`` takes the product behind it.
"""

from __future__ import annotations

import re

from mtcommission.messages.formula import (
    GREEK,
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
    symbol,
)

FUNCTIONS = ("min", "max", "exp", "sin", "cos", "R")
WORDS = ("Kp", "Kv", "Tn", "band", "x_ref", "v_ref", "a_ref", "j_ref", *GREEK)
"""Names of more than one letter; any other word makes a text no formula."""

LONGEST = 400
"""Characters of a formula; a record from elsewhere may nest deeper than Python can follow."""

SIGNS = {"<=": "≤", ">=": "≥", "=": "="}
TOKEN = re.compile(r"\s*(\d+\.?\d*|[A-Za-z]+(?:_\w+)?\(?|<=|>=|[-+/^()|=,])")


def parse_formula(text: str, *, decimal_mark: str = ".") -> Expression | None:
    """Return a formula as a tree; None if the text is not a formula from end to end.

    Parameters
    ----------
    text
        In plain signs, with decimal points.
    decimal_mark
        For the numbers of the tree.

    Examples
    --------
    >>> parse_formula("a / t_j")
    Fraction(above=Symbol(letter='a', index=''), below=Symbol(letter='t', index='j'))
    >>> parse_formula("see the formula") is None
    True
    """
    if len(text) > LONGEST:
        return None
    tokens, end = [], 0
    while match := TOKEN.match(text, end):
        tokens.append(match[1])
        end = match.end()
    if text[end:].strip() or not tokens:
        return None
    parser = _Parser(tokens, decimal_mark)
    try:
        found = parser.relation()
    except _NoFormulaError:
        return None
    return found if parser.is_at_end else None


class _NoFormulaError(Exception):
    """The text is no formula."""


class _Parser:
    """Recursive descent over the tokens."""

    def __init__(self, tokens: list[str], decimal_mark: str) -> None:
        self._tokens = tokens
        self._mark = decimal_mark
        self._at = 0
        self._bars = 0

    @property
    def is_at_end(self) -> bool:
        return self._at == len(self._tokens)

    def relation(self) -> Expression:
        sides, signs = [self._terms()], []
        while self._next in SIGNS:
            signs.append(SIGNS[self._take()])
            sides.append(self._terms())
        return Relation(tuple(sides), tuple(signs)) if signs else sides[0]

    @property
    def _next(self) -> str:
        return "" if self.is_at_end else self._tokens[self._at]

    def _take(self, expected: str = "") -> str:
        token = self._next
        if not token or (expected and token != expected):
            raise _NoFormulaError
        self._at += 1
        return token

    def _terms(self) -> Expression:
        signs = [self._take() if self._next == "-" else "+"]
        terms = [self._product()]
        while self._next in ("+", "-"):
            signs.append(self._take())
            terms.append(self._product())
        return Terms(tuple(signs), tuple(terms)) if len(terms) > 1 or signs != ["+"] else terms[0]

    def _product(self) -> Expression:
        factors = [self._factor()]
        while True:
            if self._next == "/":
                self._take()
                # 1/2 a is (1/2) a, and m c/w is (m c)/w: what stands before goes above.
                above = factors[0] if len(factors) == 1 else Product(tuple(factors))
                factors = [Fraction(_bare(above), _bare(self._power()))]
            elif self._starts_a_factor():
                factors.append(self._factor())
            else:
                return factors[0] if len(factors) == 1 else Product(tuple(factors))

    def _starts_a_factor(self) -> bool:
        token = self._next
        if token == "|":
            return not self._bars
        return bool(token) and (token == "(" or token[0].isalnum())

    def _factor(self) -> Expression:
        if self._next != "sum":
            return self._power()
        self._take()
        return Sum(self._product())

    def _power(self) -> Expression:
        base = self._atom()
        if self._next != "^":
            return base
        self._take()
        return Power(base, self._atom())

    def _atom(self) -> Expression:
        token = self._take()
        if token[0].isdigit():
            return Number(token.replace(".", self._mark))
        if token == "(":
            return self._until(")", is_magnitude=False)
        if token == "|" and not self._bars:
            return self._until("|", is_magnitude=True)
        if token.endswith("("):
            return self._call(token[:-1])
        if not token[0].isalpha():
            raise _NoFormulaError
        return _symbol(token)

    def _until(self, end: str, *, is_magnitude: bool) -> Expression:
        bars, self._bars = self._bars, int(is_magnitude)
        inner = self._terms()
        self._take(end)
        self._bars = bars
        return Enclosed(inner, is_magnitude)

    def _call(self, name: str) -> Expression:
        bars, self._bars = self._bars, 0
        arguments = [self._terms()]
        while self._next == ",":
            self._take()
            arguments.append(self._terms())
        self._take(")")
        self._bars = bars
        if name == "root" and len(arguments) == 1:
            return Root(arguments[0])
        if name not in FUNCTIONS:
            raise _NoFormulaError
        return Call(name, tuple(arguments))


def _bare(part: Expression) -> Expression:
    """A fraction needs no brackets around what stands above or below."""
    return part.inner if isinstance(part, Enclosed) and not part.is_magnitude else part


def _symbol(token: str) -> Symbol:
    letter, _, _ = token.partition("_")
    if len(letter) > 1 and letter not in WORDS and token not in WORDS:
        raise _NoFormulaError
    return symbol(token)
