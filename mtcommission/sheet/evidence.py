"""Appendix: the ways of doing a move, certificates, and the versions that computed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import pairwise

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import symbol
from mtcommission.record.schema.comparisons import ComparedEntry, FedForwardEntry
from mtcommission.record.schema.optima import ArcEntry, OptimumEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
from mtcommission.sheet.document import (
    Block,
    Bullets,
    Paragraph,
    Preformatted,
    Subheading,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.responses import flexible_rates, named_optima
from mtcommission.sheet.tables import (
    MAX_FORCE,
    PEAK,
    RESIDUAL,
    SETTLING,
    Quantity,
    member,
    pairs,
    place_columns,
    show,
    table,
)
from mtcommission.sheet.verdict import move_title


def comparisons(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield for each move what the ways of doing it cost and reach, and the optima fed forward."""
    text = words.text
    yield note(text("comparison-note"))
    both = zip(record.moves, record.comparisons, strict=True)
    for number, (move, entry) in enumerate(both, start=1):
        short = text("move", number=number)
        yield Subheading(text=move_title(move.move, number, words))
        yield _controls(record, entry.controls, short, words)
        yield from _said(text("claims"), entry.claims, words)
        yield from _fed_forward(entry.fed_forward, short, words)
        yield from _said(text("why-not"), entry.why_not_the_optimum, words)


def _said(lead: str, sentences: list[Words], words: Catalogue) -> Iterator[Block]:
    """Sentences of the record behind the words that lead to them."""
    if sentences:
        yield Paragraph(text=lead)
        yield Bullets(items=tuple(map(words.say, sentences)))


def _controls(record: Record, controls: list[ComparedEntry], move: str, words: Catalogue) -> Table:
    units = record.plant.units

    def overshoot(item: ComparedEntry) -> str:
        return words.format.signed_percent(item.overshoot).removeprefix("+")

    columns = (
        Quantity("control", "name", width=2.0),
        Quantity("transfer-time", "transfer_time", "s", "not-settled"),
        Quantity("overshoot", overshoot, "%"),
        *(
            Quantity(Message("peak-of", name=symbol(rate)), member(rate, "peaks"), units[rate])
            for rate in flexible_rates(record.plant.states)
        ),
        MAX_FORCE,
        Quantity("heat", "heat", "N^2 m^2 s" if words.rotary else "N^2 s"),
        Quantity("work", "work", "J"),
    )
    return table(words, "controls-caption", columns, controls, move=move)


def _fed_forward(entries: list[FedForwardEntry], move: str, words: Catalogue) -> Iterator[Block]:
    """The machines on which a control settles; those on which none does as a sentence."""
    settled = [entry for entry in entries if entry.settling_time is not None]
    lost = Counter(words.say(entry.control) for entry in entries if entry.settling_time is None)
    said = "; ".join(f"{name}: {count}" for name, count in lost.items())
    columns = (
        Quantity("control", "control", width=1.4),
        *place_columns(settled),
        *(SETTLING, RESIDUAL, PEAK),
        Quantity("saturated-share", "saturated_share", "%"),
    )
    if settled:
        yield table(words, "fed-forward-caption", columns, settled, move=move)
    if lost:
        yield Paragraph(text=words.text("fed-forward-lost", machines=said))


def certificates(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield certificates, assumptions and warnings."""
    text = words.text
    yield Subheading(text=text("assumptions"))
    yield _sentences(record.assumptions, Tone.PLAIN, words)
    yield Subheading(text=text("warnings"))
    yield _sentences(record.warnings, Tone.WARNING, words)
    for number, optima in enumerate(record.optima, start=1):
        move = move_title(optima.move, number, words)
        for name, _, optimum in named_optima(optima, words):
            caption = text("certificate-caption", move=move, what=name)
            yield pairs(words, caption, _certificate(optimum, words))


def _sentences(items: Sequence[Words], tone: Tone, words: Catalogue) -> Block:
    if not items:
        return Paragraph(text=words.text("none"))
    return Bullets(items=tuple(map(words.say, items)), tone=tone)


def _certificate(optimum: OptimumEntry, words: Catalogue) -> list[tuple[str, str]]:
    text, f = words.text, words.format
    rows = [
        (text("final-time"), f.quantity(optimum.t_f, "s")),
        (text("method"), words.known(f"method-{optimum.method}", optimum.method)),
        (text("switches"), ", ".join(f.quantity(t, "s") for t in _changes(optimum.arcs))),
        (text("largest-error"), f.number(_largest_error(optimum), digits=2)),
    ]
    if optimum.cost is not None:
        unit = "N^2 m^2 s" if words.rotary else "N^2 s"
        rows.append((text("cost"), f.quantity(optimum.cost, unit)))
    if optimum.weights:
        rows.append((text("weights"), _evidence("", optimum.weights, words)))
    for key, value in asdict(optimum.certificate).items():
        rows.append((words.name(key), _evidence(key, value, words)))
    return [row for row in rows if row[1]]


def _changes(arcs: list[ArcEntry]) -> list[float]:
    """When the kind of control changes [s]; arcs within the force bound run into another."""
    return [arc.t_end for arc, after in pairwise(arcs) if arc.control != after.control]


def _largest_error(optimum: OptimumEntry) -> float:
    """Of the terminal state, relative to the state's peak."""
    peaks = optimum.peaks
    errors = (abs(e) / peaks[name] for name, e in optimum.terminal_error.items() if peaks.get(name))
    return max(errors, default=0.0)


def _evidence(
    key: str, value: float | bool | dict[str, float] | list[float] | None, words: Catalogue
) -> str:
    number = words.format.number
    if isinstance(value, dict):
        return "; ".join(f"{symbol(name)} = {number(one)}" for name, one in value.items())
    if isinstance(value, list):
        return "; ".join(map(number, value))
    return show(value, words, "s" if key.startswith("t_f") else "")


def versions(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield program, libraries, hash and text of the profile."""
    text, tool, profile = words.text, record.tool, record.profile
    rows = [(tool.name, tool.version), *tool.libraries.items(), (text("created"), record.created)]
    yield pairs(words, text("versions-caption"), rows, first="program")
    yield Paragraph(text=f"{text('hash-row')}:")
    yield Paragraph(text=profile.sha256, tone=Tone.CODE)
    yield Preformatted(caption=text("profile-caption", name=profile.name), text=profile.text)
