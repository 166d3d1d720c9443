"""Other limits: today's, by machining mode, by rules of thumb, and by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.checks import say_filter, say_jerk
from mtcommission.machine.moves import Positioning, largest_velocity
from mtcommission.record.limits import Alternative, LimitsPart, ListedEntry
from mtcommission.record.machine import ModeEntry
from mtcommission.record.shape import Words, finite_or_none
from mtcommission.sheet.document import (
    Block,
    Formula,
    Paragraph,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.tables import (
    ACCELERATION,
    JERK_TIME,
    PEAK,
    RESIDUAL,
    SETTLING,
    Quantity,
    show,
    table,
)
from mtcommission.sheet.verdict import find_band, find_number
from mtcommission.study.attainable import ModeLimits

if TYPE_CHECKING:
    from mtcommission.record.record import Record

MEETS = Quantity(
    "meets",
    lambda item: Message(
        "no"
        if not item.meets_requirements
        else "yes"
        if item.keeps_reserve
        else "yes-without-reserve"
    ),
)
"""Whether limits meet all requirements, and whether that takes the reserve."""


def jerk_column(shortest: float, words: Catalogue, *, width: float = 1.5) -> Quantity:
    """Return the column of jerk limits; ``shortest``: ramp that limits the jerk [s].

    A jerk in degrees needs the most room.
    """
    return Quantity(
        "jerk", lambda it: say_jerk(it.acceleration, it.jerk, shortest, words), "", width=width
    )


def limits_columns(shortest: float, words: Catalogue) -> tuple[Quantity, ...]:
    """Return what limits are, what they give, and whether that meets all requirements."""
    return (
        replace(ACCELERATION, width=1.32),
        jerk_column(shortest, words, width=1.4),
        replace(SETTLING, width=1.2),
        replace(RESIDUAL, width=1.2),
        replace(PEAK, width=1.2),
        replace(MEETS, width=1.15),
    )


def is_of_calibration(item: Alternative) -> bool:
    """Return whether limits are those that ``calibrate_shaper`` would choose."""
    return isinstance(item.name, Message) and item.name.kind == "shaper-of-calibration"


def other_limits(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield today's and other limits that serve, with what they give."""
    text, part = words.text, record.limits
    serving = [
        item
        for item in (*part.alternatives, *part.rules)
        if item.meets_requirements or is_of_calibration(item)
    ]
    listed = part.listed_only
    named: list[tuple[str, object]] = [
        *([(text("today"), part.today)] if part.today else []),
        (text("recommended"), part.recommended),
        *([(_listed_name(listed, part, words), listed)] if listed else []),
        *((words.say(item.name), item) for item in serving),
    ]
    name = Quantity("limits-name", lambda it: it[0], width=2.28)

    def known(quantity: Quantity) -> Quantity:
        """What today's values give is not known where they cannot be judged."""
        missing = "" if part.today and part.today.failure else quantity.missing
        return replace(quantity, missing=missing).within(itemgetter(1))

    yield table(
        words,
        "alternatives-caption",
        (name, *map(known, limits_columns(record.loop.shortest_ramp, words))),
        named,
        strong=lambda it: it[1] is part.recommended,
    )


def _listed_name(listed: ListedEntry, part: LimitsPart, words: Catalogue) -> str:
    """What limits for the listed sizes alone are called, with their filter where it is another."""
    own, name = listed.setpoint_filter, words.text("listed-short")
    if own == part.recommended.setpoint_filter:
        return name
    return f"{name} ({words.text('setpoint-filter')}: {say_filter(own, words)})"


def limits_by_mode(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the limits after the usual machining modes."""

    def name(mode: ModeLimits) -> str:
        return words.known(f"machining-{mode.name}", mode.name)

    def jerk(mode: ModeLimits) -> str | None:
        if mode.acceleration is None:
            return None
        return say_jerk(mode.acceleration, mode.jerk, record.loop.shortest_ramp, words)

    columns = (
        Quantity("machining-mode", name, width=1.7),
        Quantity("permitted-band", "band", "m", width=1.2),
        replace(ACCELERATION, width=1.2),
        Quantity("jerk", jerk, "", width=1.7),
        replace(JERK_TIME, width=1.2),
        replace(SETTLING, width=1.2),
        Quantity("meets", "meets_requirements", width=0.8),
    )
    modes = record.limits.modes
    yield table(words, "", columns, modes)
    for mode in modes:
        if not mode.meets_requirements:
            least = "none" if mode.attainable is None else show(mode.attainable, words, "m")
            yield note(words.text("mode-not-met", mode=name(mode), band=least))


def rules(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield limits condensed from the optima, and rules of thumb, with what they give."""
    columns = (
        Quantity("rule", "name", width=2.2),
        Quantity("source", "source", width=2.3),
        *limits_columns(record.loop.shortest_ramp, words),
    )
    every = [*record.limits.alternatives, *record.limits.rules]
    if every:
        yield table(words, "rules-caption", columns, every)


def rule(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the commissioning rule in words and formulas, its symbols, and the steps by hand."""
    text, part = words.text, record.limits.rule
    result = text(
        "rule-result",
        acceleration=show(part.acceleration, words, "m/s^2"),
        jerk=show(part.jerk, words, "m/s^3"),
        chosen=words.say(part.chosen),
        bound=words.say(part.bound_by),
        residual=show(part.predicted_residual, words, "m", "not-settled"),
    )
    steps = (
        Quantity("rule-step", "name", width=1.6),
        Quantity("rule-how", lambda it: _formula(it.formula, words), width=2.4),
        Quantity("value", "value", lambda it: "" if it.unit == "1" else it.unit),
    )
    yield Paragraph(text=words.say(part.text))
    yield Paragraph(text=result)
    for item in part.formula:
        aside = words.say(item.aside) if item.aside else ""
        yield Formula(text=item.text.replace(".", words.format.decimal_mark), aside=aside)
    yield Paragraph(text=words.say(part.advice))
    yield _symbols(record, words)
    yield table(words, "rule-steps-caption", steps, part.steps)
    yield note(text("rule-valid", range=words.say(part.valid_for)))
    for line in part.warnings:
        yield Paragraph(text=words.say(line), tone=Tone.WARNING)


def _formula(formula: Words, words: Catalogue) -> Words | Formula:
    if isinstance(formula, Message):
        return formula
    return Formula(text=formula.replace(".", words.format.decimal_mark))


def _share(mode: ModeEntry) -> float:
    return max(abs(mode.tcp_gain), abs(mode.tcp_gain - mode.measured_gain))


def _velocities(record: Record) -> list[float | None]:
    return [finite_or_none(largest_velocity(entry.move)) for entry in record.moves]


def _distances(record: Record) -> list[float]:
    moves = [entry.move for entry in record.moves]
    return [move.distance for move in moves if isinstance(move, Positioning)]


SYMBOLS: tuple[tuple[str, str, Callable[[Record], Any], str], ...] = (
    ("a", "acceleration", lambda r: r.limits.rule.acceleration, "m/s^2"),
    ("j", "jerk", lambda r: r.limits.rule.jerk, "m/s^3"),
    ("t_j", "jerk-time", lambda r: r.limits.rule.jerk_time, "s"),
    ("T_F", "rule-symbol-T-F", lambda r: r.limits.rule.average, "s"),
    ("n", "rule-symbol-n", lambda _: None, ""),
    ("band", "name-tcp-deviation", find_band, "m"),
    ("F", "rule-symbol-F", lambda r: r.optima[0].time.f_max, "N"),
    ("v", "rule-symbol-v", _velocities, "m/s"),
    ("L", "rule-symbol-L", _distances, "m"),
    ("m", "rule-symbol-m", lambda r: r.plant.moving_mass, "kg"),
    ("m_ff", "rule-symbol-m-ff", lambda r: r.loop.feedforward.mass, "kg"),
    ("T", "name-force-lag", lambda r: find_number(r, "drive.force_lag"), "s"),
    ("T_p", "name-position-cycle", lambda r: r.loop.position_cycle, "s"),
    ("T_v", "name-velocity-cycle", lambda r: r.loop.velocity_cycle, "s"),
    ("Kv", "name-Kv", lambda r: r.loop.Kv, "1/s"),
    ("Kp", "name-Kp", lambda r: r.loop.Kp, "N s/m"),
    ("Tn", "name-Tn", lambda r: r.loop.Tn, "s"),
    ("f", "name-frequency", lambda r: [mode.frequency_hz for mode in r.plant.modes], "Hz"),
    ("ω", "rule-symbol-omega", lambda _: "2 π f", ""),
    ("s", "name-frequency-spread", lambda r: find_number(r, "requirements.frequency_spread"), "%"),
    ("ζ", "name-damping-ratio", lambda r: [mode.damping_ratio for mode in r.plant.modes], "%"),
    ("g", "rule-symbol-g", lambda r: list(map(_share, r.plant.modes)), "1/kg"),
    ("c", "rule-symbol-c", lambda r: [mode.measured_gain for mode in r.plant.modes], "1/kg"),
    ("R", "rule-symbol-R", lambda _: None, ""),
    ("x", "rule-symbol-x", lambda _: None, ""),
    ("i", "rule-symbol-i", lambda _: None, ""),
)
"""Letters of the rule: what each means, its value (a list: by mode or move) and its unit."""


def _symbols(record: Record, words: Catalogue) -> Table:
    values = {letter: value(record) for letter, _, value, _ in SYMBOLS}

    def shown(item: tuple[str, str, object, str]) -> str:
        value = values[item[0]]
        if isinstance(value, list):
            return "; ".join(show(one, words, item[3]) for one in value)
        return show(value, words, item[3])

    columns = (
        Quantity("symbol", lambda item: Formula(text=item[0]), width=0.6),
        Quantity("meaning", lambda item: words.text(item[1]), width=2.6),
        Quantity("value", shown, "", width=1.6),
    )
    known = [item for item in SYMBOLS if values[item[0]] != []]
    modes = "; ".join(mode.name for mode in record.plant.modes)
    return table(words, "rule-symbols-caption", columns, known, modes=modes)
