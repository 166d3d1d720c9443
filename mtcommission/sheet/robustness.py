"""How the recommended limits fare on machines that are a little different from the profile."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.moves import MoveEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.robustness import DistributionEntry, MonteCarloEntry, Quantile
from mtcommission.sheet.basis import find_band, kept_sentence
from mtcommission.sheet.document import Block, LinePlot, Paragraph, Table, note
from mtcommission.sheet.plots import Curve, Signals, line_plot
from mtcommission.sheet.tables import (
    MAX_FORCE,
    PEAK,
    RESIDUAL,
    RMS_FORCE,
    SETTLING,
    Quantity,
    place_columns,
    show,
    table,
    wide,
)
from mtcommission.sheet.verdict import move_title


def robustness(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield corners, frequency error and drawn machines."""
    if not record.machine.follows:  # else they stand on page 3
        yield from held_range(record, words)
    if record.robustness.monte_carlo is None:
        yield note(words.text("nothing-drawn"))
    else:
        yield from _drawn(record.robustness.monte_carlo, words)


def held_range(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield what comes about in every corner, and over the error of all frequencies."""
    for number, move in enumerate(record.moves, start=1):
        yield _corners(move, number, words)
    yield Paragraph(text=kept_sentence(record, words))
    yield from _frequency_error(record, words)


def _corners(move: MoveEntry, number: int, words: Catalogue) -> Table:
    columns = (*place_columns(move.corners), SETTLING, RESIDUAL, PEAK, MAX_FORCE, RMS_FORCE)
    saturated = Quantity("saturated", "saturated")
    return table(
        words,
        "corners-caption",
        (*columns, saturated),
        move.corners,
        strong=lambda corner: corner.settling_time is None,
        move=move_title(move.move, number, words),
    )


def _frequency_error(record: Record, words: Catalogue) -> Iterator[Block]:
    """The curves over the frequency error; where one has no point, why it is missing."""
    text, error, permitted = words.text, record.robustness.frequency_error, find_band(record)
    x = 100.0 * (np.array(error.factor) - 1.0)
    residual, settling = (
        Curve(text("recommended"), x, values)
        for values in (error.residual_deviation, error.settling_time)
    )
    ends = zip(("low", "high"), (error.factor[0], error.factor[-1]), strict=True)
    tried = {name: words.format.signed_percent(factor - 1.0) for name, factor in ends}
    limits = () if permitted is None else (permitted,)
    panels = [Signals(text("residual"), "m", [residual], limits)]
    panels.append(Signals(text("settling-time"), "s", [settling]))
    if residual.y.size:
        yield line_plot(
            words,
            "frequency-error",
            [panel for panel in panels if panel.curves[0].y.size],
            x=(text("frequency-error"), ""),
            least=show(float(residual.y.min()), words, "m"),
            most=show(float(residual.y.max()), words, "m"),
            band=show(permitted, words, "m"),
        )
    if not settling.y.size:
        yield note(text("no-error-curves", **tried))


def drawn_sentence(drawn: MonteCarloEntry, words: Catalogue) -> str:
    """Return how many machines were drawn and how many of them keep the requirements."""
    f = words.format
    return words.text(
        "drawn",
        samples=f.number(drawn.samples),
        seed=drawn.seed,
        met=f.percent(drawn.share_met),
        band=f.percent(drawn.share_in_band),
    )


def _drawn(drawn: MonteCarloEntry, words: Catalogue) -> Iterator[Block]:
    """What was drawn, the distribution, and the worst machines."""
    text, settling, residual = words.text, drawn.settling_time, drawn.residual_deviation
    ends = {0.0: text("least"), 1.0: text("largest")}

    def share(item: tuple[Quantile, Quantile]) -> str:
        named = ends.get(item[0].share)
        return named or text("share-of-machines", share=words.format.percent(item[0].share))

    quantiles = (
        Quantity("machines", share, width=1.6),
        Quantity("settling-time", lambda it: it[0].value, settling.unit, "not-settled"),
        Quantity("residual", lambda it: it[1].value, residual.unit, "not-settled"),
    )
    named = {text("worst-machine"): drawn.worst, text("slowest-machine"): drawn.slowest}
    machines = place_columns(named.values())
    extremes = (
        Quantity("machine-row", lambda it: it[0], width=1.8),
        *(_of_machine(quantity) for quantity in (*machines, SETTLING, RESIDUAL)),
    )
    both = zip(settling.quantiles, residual.quantiles, strict=True)
    yield Paragraph(text=drawn_sentence(drawn, words))
    yield table(words, "quantiles-caption", quantiles, both)
    yield from _histogram("settling_time", text("settling-time"), settling, words)
    yield from _histogram("residual_deviation", text("residual"), residual, words)
    yield table(words, "extremes-caption", extremes, named.items())


def _of_machine(quantity: Quantity) -> Quantity:
    """A quantity of the second of two: name and machine."""
    return wide(quantity, 1.0, value=lambda it: quantity.of(it[1]))


def _histogram(
    key: str, name: str, values: DistributionEntry, words: Catalogue
) -> Iterator[LinePlot]:
    """How many machines lie where; nothing where all are alike or none settles."""
    text, unit, edges = words.text, values.unit, np.array(values.histogram.edges)
    if edges.size < 3:
        return
    counts = np.array(values.histogram.counts, dtype=np.float64)
    fullest = int(counts.argmax())
    x, y = np.concatenate([edges[:1], edges]), np.concatenate([[0.0], counts, [0.0]])
    machines = Signals(
        name=text("machines"), unit="", curves=[Curve(text("machines"), x, y, stepped=True)]
    )
    yield line_plot(
        words,
        f"histogram-{key}",
        [machines],
        x=(name, unit),
        text="histogram",
        name=name,
        low=show(edges[0], words, unit),
        high=show(edges[-1], words, unit),
        most=words.format.number(counts[fullest]),
        place=show((edges[fullest] + edges[fullest + 1]) / 2, words, unit),
    )
