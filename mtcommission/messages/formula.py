"""Formulas as trees: built where they are known, in the notation of Python, and set by the sheet.

A formula is written with Python's own operators (``a / t_j``, ``root(x**2 + y**2).at_most(band)``);
brackets come by themselves where they are needed. Records hold it as MathJSON (cortexjs.io), nested
lists of a name and its arguments; ``write_formula`` says it in one line of plain signs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType

GREEK: Mapping[str, str] = MappingProxyType(
    {
        "omega": "ω",
        "zeta": "ζ",
        "eps": "ε",
        "phi": "φ",
        "tau": "τ",
        "sigma": "σ",
        "lambda": "λ",
        "pi": "π",
    }
)
"""Letters by their names in plain signs."""

_NAMES = {letter: name for name, letter in GREEK.items()}


class Expression:
    """Any part of a formula; arithmetic with it makes larger ones."""

    __slots__ = ()

    def __add__(self, other: Expression | float) -> Expression:
        signs, terms = _terms(self)
        return Terms((*signs, "+"), (*terms, _closed(other, Relation)))

    def __radd__(self, other: float) -> Expression:
        return _number(other) + self

    def __sub__(self, other: Expression | float) -> Expression:
        signs, terms = _terms(self)
        return Terms((*signs, "-"), (*terms, _closed(other, Terms, Relation)))

    def __rsub__(self, other: float) -> Expression:
        return _number(other) - self

    def __neg__(self) -> Expression:
        return Terms(("-",), (_closed(self, Terms),))

    def __mul__(self, other: Expression | float) -> Expression:
        first, second = _closed(self, Terms, Sum), _closed(other, Terms)
        before = first.factors if isinstance(first, Product) else (first,)
        behind = second.factors if isinstance(second, Product) else (second,)
        return Product((*before, *behind))

    def __rmul__(self, other: float) -> Expression:
        return _number(other) * self

    def __truediv__(self, other: Expression | float) -> Expression:
        return Fraction(self, _number(other))

    def __rtruediv__(self, other: float) -> Expression:
        return _number(other) / self

    def __pow__(self, exponent: Expression | float) -> Expression:
        return Power(_closed(self, Terms, Product, Fraction, Sum, Power), _number(exponent))

    def __abs__(self) -> Expression:
        return Enclosed(self, is_magnitude=True)

    def equals(self, other: Expression | float) -> Relation:
        """Return ``self = other``."""
        return Relation((self, _number(other)), ("=",))

    def at_most(self, other: Expression | float) -> Relation:
        """Return ``self ≤ other``."""
        return Relation((self, _number(other)), ("≤",))


@dataclass(frozen=True, slots=True)
class Number(Expression):
    """A number as written."""

    digits: str


@dataclass(frozen=True, slots=True)
class Symbol(Expression):
    """A letter with an index, which may be empty."""

    letter: str
    index: str = ""


@dataclass(frozen=True, slots=True)
class Power(Expression):
    """``base`` to the ``exponent``."""

    base: Expression
    exponent: Expression


@dataclass(frozen=True, slots=True)
class Fraction(Expression):
    """``above`` over ``below``."""

    above: Expression
    below: Expression


@dataclass(frozen=True, slots=True)
class Product(Expression):
    """Factors beside each other."""

    factors: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Terms(Expression):
    """Terms with their signs, "+" or "-"; a "+" in front is not printed."""

    signs: tuple[str, ...]
    terms: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Enclosed(Expression):
    """An expression between ``(`` and ``)``, or between bars."""

    inner: Expression
    is_magnitude: bool = False


@dataclass(frozen=True, slots=True)
class Root(Expression):
    """A square root."""

    inner: Expression


@dataclass(frozen=True, slots=True)
class Call(Expression):
    """A function of its arguments."""

    name: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Sum(Expression):
    """The sum of a product over the modes."""

    inner: Expression


@dataclass(frozen=True, slots=True)
class Relation(Expression):
    """Sides with the signs between them: ``=`` or ``≤``."""

    sides: tuple[Expression, ...]
    signs: tuple[str, ...]


def symbol(name: str) -> Symbol:
    """Return a symbol by its name in plain signs.

    Examples
    --------
    >>> symbol("omega_v")
    Symbol(letter='ω', index='v')
    """
    letter, _, index = name.partition("_")
    return Symbol(GREEK.get(letter, letter), GREEK.get(index, index))


def call(name: str, *arguments: Expression | float) -> Call:
    """Return a function of its arguments, e.g. ``call("min", 1, x)``."""
    return Call(name, tuple(map(_number, arguments)))


def find_symbols(tree: Expression) -> set[Symbol]:
    """Return every symbol of a formula.

    Examples
    --------
    >>> sorted(s.letter for s in find_symbols(symbol("a") / symbol("t_j")))
    ['a', 't']
    """
    return {tree} if isinstance(tree, Symbol) else set().union(*map(find_symbols, _parts(tree)))


def _parts(tree: Expression) -> tuple[Expression, ...]:
    match tree:
        case Power(base, exponent):
            return base, exponent
        case Fraction(above, below):
            return above, below
        case Product(parts) | Terms(_, parts) | Call(_, parts) | Relation(parts, _):
            return parts
        case Enclosed(inner) | Root(inner) | Sum(inner):
            return (inner,)
    return ()


def with_decimal_mark(tree: Expression, mark: str) -> Expression:
    """Return a formula whose numbers have a language's decimal mark.

    Examples
    --------
    >>> write_formula(with_decimal_mark(0.4 * symbol("T"), ","))
    '0,4 T'
    """

    def marked(part: object) -> object:
        if isinstance(part, tuple):
            return tuple(map(marked, part))
        return with_decimal_mark(part, mark) if isinstance(part, Expression) else part

    if isinstance(tree, Number):
        return Number(tree.digits.replace(".", mark))
    return type(tree)(*(marked(getattr(tree, item.name)) for item in fields(tree)))  # type: ignore[arg-type]


def write_formula(tree: Expression) -> str:
    """Return a formula in one line of plain signs, as one types it.

    Examples
    --------
    >>> a, t = symbol("a"), symbol("t_j")
    >>> write_formula((a * (1 + t) ** 2 / (2 * t)).at_most(symbol("omega")))
    'a (1 + t_j)^2/(2 t_j) <= omega'
    """
    write = write_formula
    match tree:
        case Number(digits):
            return digits
        case Symbol(letter, index):
            return "_".join(_NAMES.get(part, part) for part in (letter, index) if part)
        case Power(base, exponent):
            return f"{write(base)}^{write(exponent)}"
        case Fraction(above, below):
            over = write(_closed(above, Terms))
            return f"{over}/{write(_closed(below, Terms, Product, Fraction))}"
        case Product(factors):
            return " ".join(map(write, factors))
        case Terms(signs, terms):
            text = "".join(
                f" {sign} {write(term)}" for sign, term in zip(signs, terms, strict=True)
            )
            return text[3:] if signs[0] == "+" else f"-{text[3:]}"
        case Enclosed(inner, is_magnitude):
            return f"|{write(inner)}|" if is_magnitude else f"({write(inner)})"
        case Root(inner):
            return f"root({write(inner)})"
        case Call(name, arguments):
            return f"{name}({', '.join(map(write, arguments))})"
        case Sum(inner):
            return f"sum {write(inner)}"
        case Relation(sides, signs):
            signed = zip(signs, sides[1:], strict=True)
            return write(sides[0]) + "".join(f" {_PLAIN[sign]} {write(x)}" for sign, x in signed)
    raise TypeError(type(tree).__name__)


_PLAIN = {"=": "=", "≤": "<="}
_HEADS = {"=": "Equal", "≤": "LessEqual"}

DEEPEST = 40
"""Nesting of a formula that is read; a record from elsewhere may be deeper than Python follows."""

LARGEST = 1e15
"""Number of a formula that is read."""


def to_json(tree: Expression) -> object:
    """Return a formula as MathJSON.

    Examples
    --------
    >>> to_json((symbol("a") / 2).at_most(symbol("Kp")))
    ['LessEqual', ['Divide', 'a', 2], 'Kp']
    """
    match tree:
        case Number(digits):
            return float(digits) if "." in digits else int(digits)
        case Symbol():
            return write_formula(tree)
        case Terms(signs, terms):
            parts = [
                ["Negate", to_json(term)] if sign == "-" else to_json(term)
                for sign, term in zip(signs, terms, strict=True)
            ]
            return ["Add", *parts] if len(parts) > 1 else parts[0]
        case Enclosed(inner, is_magnitude):
            return ["Abs" if is_magnitude else "Delimiter", to_json(inner)]
        case Call(name, arguments):
            return [name, *map(to_json, arguments)]
        case Relation(sides, signs):
            return [_HEADS[signs[0]], *map(to_json, sides)]
    heads = {Power: "Power", Fraction: "Divide", Product: "Multiply", Root: "Sqrt", Sum: "Sum"}
    return [heads[type(tree)], *map(to_json, _parts(tree))]


def from_json(entry: object, *, depth: int = DEEPEST) -> Expression:
    """Return the formula that ``to_json`` was given.

    Raises
    ------
    ValueError
        No formula.

    Examples
    --------
    >>> write_formula(from_json(["Divide", "a", "t_j"]))
    'a/t_j'
    """
    if isinstance(entry, str) and entry.replace("_", "").isalnum():
        return symbol(entry)
    if isinstance(entry, (int, float)) and not isinstance(entry, bool) and abs(entry) <= LARGEST:
        return Number(f"{entry:g}")
    if not isinstance(entry, list) or len(entry) < 2 or not isinstance(entry[0], str) or not depth:
        raise ValueError("must be a formula: [name, arguments...], a symbol or a number")
    head, *rest = entry
    if head in ("Add", "Negate"):
        return _read_terms(rest if head == "Add" else [entry], depth=depth - 1)
    parts = tuple(from_json(part, depth=depth - 1) for part in rest)
    if head == "Multiply":
        return Product(parts)
    for sign, name in _HEADS.items():
        if head == name:
            return Relation(parts, (sign,) * (len(parts) - 1))
    makers: dict[str, Callable[..., Expression]] = {
        "Power": Power,
        "Divide": Fraction,
        "Sqrt": Root,
        "Sum": Sum,
        "Abs": abs,
        "Delimiter": Enclosed,
    }
    if head not in makers:
        return Call(head, parts)
    if len(parts) != (2 if head in ("Power", "Divide") else 1):
        raise ValueError(f"{head}: got {len(parts)} arguments")
    return makers[head](*parts)


def _read_terms(entries: list[object], *, depth: int) -> Terms:
    signs, terms = [], []
    for entry in entries:
        is_minus = isinstance(entry, list) and len(entry) == 2 and entry[0] == "Negate"
        signs.append("-" if is_minus else "+")
        terms.append(from_json(entry[1] if is_minus else entry, depth=depth))  # type: ignore[index]
    return Terms(tuple(signs), tuple(terms))


def _number(value: Expression | float) -> Expression:
    return value if isinstance(value, Expression) else Number(f"{value:g}")


def _closed(value: Expression | float, *kinds: type[Expression]) -> Expression:
    """A part in brackets if it is one of these kinds."""
    part = _number(value)
    return Enclosed(part) if isinstance(part, kinds) else part


def _terms(value: Expression) -> tuple[tuple[str, ...], tuple[Expression, ...]]:
    return (value.signs, value.terms) if isinstance(value, Terms) else (("+",), (value,))
