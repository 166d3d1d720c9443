"""For what the verdict holds, and on what it rests: control, reserve, measured and assumed data."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.robustness import DampingErrorEntry, FrequencyErrorEntry
from mtcommission.sheet.machine_part import datum, datum_name

ILLUSTRATIVE = "source-illustrative"
NOT_STATED = {"source-default", ILLUSTRATIVE, "source-accepted-default"}
"""Sources of values that nobody stated for this machine."""


OF_LOOP = ("control.position_loop", "control.position_cycle", "control.velocity_cycle")

MARKED = (
    *("control.", "requirements.reserve", "requirements.payload (least)"),
    *("requirements.frequency_spread", "requirements.damping_spread"),
)
"""Beginnings of the keys that other rows of page 1 mark, or that the largest payload stands for."""

NAMED = 3
"""Illustrative data that page 1 names; the rest it counts. Of a real machine it names all."""


def holds_rows(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """Return for which moves, frequencies, damping ratios and payloads all is kept."""
    text = words.text
    return (
        (text("basis-sizes"), _sizes(record, words)),
        (text("basis-frequencies"), _frequencies(record, words)),
        (text("basis-damping"), _damping(record, words)),
        *_payload(record, words),
    )


def basis_rows(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """Return the control and its loop, the reserve, and what the encoder's steps do."""
    text = words.text
    return (
        (text("basis-control"), _control(record, words)),
        (text("basis-reserve"), _reserve(record, words)),
        *_encoder(record, words),
    )


def data_rows(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """Return where the machine data come from: stated, measured, and assumed."""
    text = words.text
    source = words.say(record.machine.source)
    if record.identified is None:
        rows = [(text("basis-data"), text("measured-nothing", source=source))]
    else:
        part = record.identified
        modes = ", ".join(mode.name for mode in part.modes)
        measured = text("measured-modes", modes=modes, date=part.created[:10])
        rows = [(text("basis-data"), source), (text("basis-measured"), measured)]
    return (*rows, *assumed_rows(record, words))


def assumed_rows(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """Return the other values that nobody stated, in one row; nothing where all were."""
    said, examples = list[str](), list[str]()
    for item in record.data:
        source = item.source.kind if isinstance(item.source, Message) else ""
        if source in NOT_STATED and not item.key.startswith(MARKED):
            value = datum(item, record.plant.units, words)
            named = f"{datum_name(item, words)} = {value}"
            (examples if source == ILLUSTRATIVE else said).append(named)
    said += examples[:NAMED]
    if not said:
        return ()
    listed, more = "; ".join(said), len(examples) - NAMED
    if more > 0:
        listed = words.text("assumed-more", names=listed, count=more)
    return ((words.text("basis-assumed"), listed),)


def is_assumed(record: Record, key: str) -> bool:
    """Return whether a key, or one that begins so, was not stated by anybody."""
    sources = [item.source for item in record.data if item.key.startswith(key)]
    return any(isinstance(s, Message) and s.kind in NOT_STATED for s in sources)


def _control(record: Record, words: Catalogue) -> str:
    f, loop = words.format, record.loop
    where = words.text(
        "no-position-loop" if record.machine.follows else f"position-loop-{loop.position_loop}",
        position_cycle=f.quantity(loop.position_cycle, "s"),
        velocity_cycle=f.quantity(loop.velocity_cycle, "s"),
    )
    name = _marked(record, "control.kind", control_name(loop.kind, words), words)
    stated = [item for item in record.data if item.key in OF_LOOP]
    assumed = [item for item in stated if is_assumed(record, item.key)]
    if len(assumed) == len(stated):
        return f"{name}; {words.text('assumed', value=where) if stated else where}"
    names = ", ".join(datum_name(item, words) for item in assumed)
    return f"{name}; {words.text('assumed-of', value=where, names=names) if assumed else where}"


def control_name(kind: str, words: Catalogue) -> str:
    """Return the name of a kind of control."""
    return words.known(f"control-kind-{kind}", words.known(f"control-{kind}", kind))


def _frequencies(record: Record, words: Catalogue) -> str:
    kept = _kept(record.robustness.frequency_error, words)
    return f"{_spread(record, 'frequency_spread', words)}; {kept}"


def _damping(record: Record, words: Catalogue) -> str:
    kept = _kept(record.robustness.damping_error, words)
    return f"{_spread(record, 'damping_spread', words)}; {kept}"


def _spread(record: Record, name: str, words: Catalogue) -> str:
    key = f"requirements.{name}"
    spread = _number(record, key)
    if not spread:
        return words.text("spread-none")
    return _marked(record, key, words.text("spread", spread=spread), words)


def _reserve(record: Record, words: Catalogue) -> str:
    band, force = (_number(record, f"requirements.reserve.{name}") for name in ("band", "force"))
    return _marked(
        record, "requirements.reserve", words.text("reserve-kept", band=band, force=force), words
    )


def _sizes(record: Record, words: Catalogue) -> str:
    """For which sizes of move the limits hold, the worst of them, and what that costs."""
    text, f, limits = words.text, words.format, record.limits

    def shown(move: dict[str, float], size: float) -> str:
        return f.axis(size, "m/s" if "velocity_step" in move else "m")

    moves = [item.move for item in record.moves]
    sizes = limits.recommended.valid_for
    own = ", ".join(shown(move, item.largest) for move, item in zip(moves, sizes, strict=True))
    if any(item.smallest > 0.0 for item in sizes):
        return text("sizes-listed", moves=own)
    said = [text("sizes-every", moves=own)]
    units = {check.name: check.unit for check in record.assessment.checks}
    for worst in limits.recommended.worst_sizes:
        if worst.bound is not None:  # else only some sizes were looked at
            at, unit = shown(moves[worst.move - 1], worst.size), units[worst.requirement]
            found, bound = f.quantity(worst.value, unit), f.quantity(worst.bound, unit)
            said.append(text("sizes-worst", residual=found, size=at, bound=bound))
    alone, together = limits.listed_only, limits.recommended.settling_time
    if alone and alone.settling_time and together and together > alone.settling_time:
        cost = f.quantity(together - alone.settling_time, "s")
        said.append(text("sizes-cost", cost=cost))
    return "; ".join(said)


def _payload(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """The range of payload, where there is one."""
    low, high = (_number(record, f"requirements.payload ({end})") for end in ("least", "largest"))
    if high <= low:
        return ()
    f = words.format
    said = words.text("payload-from-to", low=f.axis(low, "kg"), high=f.axis(high, "kg"))
    return ((words.text("payload"), _marked(record, "requirements.payload", said, words)),)


def _encoder(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """What the steps of the encoder do, where they are stated."""
    f, loop = words.format, record.loop
    if loop.encoder_noise is None:
        return ()
    said = words.text(
        "encoder-steps",
        resolution=f.axis(loop.encoder_resolution, "m"),
        tool=f.axis(loop.encoder_noise.tool, "m"),
        force=f.axis(loop.encoder_noise.force, "N"),
    )
    return ((words.name("encoder"), said),)


def _number(record: Record, key: str) -> float:
    values = (item.value for item in record.data if item.key == key)
    value = next(values, 0.0)
    return value if isinstance(value, float | int) else 0.0


def _marked(record: Record, key: str, shown: str, words: Catalogue) -> str:
    """A value, and that nobody stated it where that is so."""
    return words.text("assumed", value=shown) if is_assumed(record, key) else shown


def kept_sentence(record: Record, words: Catalogue) -> str:
    """Return between which frequency errors every requirement is kept, as a sentence."""
    kept = _kept_ends(record.robustness.frequency_error, words)
    return words.text("kept-between", **kept) if kept else words.text("kept-nowhere")


def _kept(error: FrequencyErrorEntry | DampingErrorEntry, words: Catalogue) -> str:
    """The same in few words."""
    kept = _kept_ends(error, words)
    return words.text("all-kept-between", **kept) if kept else words.text("not-kept-nominally")


def _kept_ends(error: FrequencyErrorEntry | DampingErrorEntry, words: Catalogue) -> dict[str, str]:
    """Both ends of the range that is kept; empty if not even the profile's own values are."""
    text, f = words.text, words.format
    low, high = error.kept_from, error.kept_to
    if low is None or high is None:
        return {}
    shown = {}
    for name, end, tried in (("low", low, error.factor[0]), ("high", high, error.factor[-1])):
        value = f.signed_percent(end - 1.0)
        # Beyond the last one tried nothing is known.
        shown[name] = text("at-least", value=value) if end == tried else value
    return shown
