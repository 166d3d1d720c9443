"""What was identified, as the terminal shows it."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from mtcommission.cli.language import words
from mtcommission.cli.terminal import heading, warn
from mtcommission.identify.check import Checked
from mtcommission.identify.identified import Identified
from mtcommission.identify.page import mode_columns, mode_row, plus_minus
from mtcommission.units.axis_units import LINEAR, ROTARY


def describe_identified(found: Identified, checks: Sequence[Checked]) -> Group:
    """Return mass, delay, modes, spreads, the check of itself and what is in doubt.

    Parameters
    ----------
    found
        The axis.
    checks
        The model against the records.
    """
    spoken = words(rotary=found.rotary)
    say, form = spoken.text, spoken.format
    modes = Table(box=None, pad_edge=False, header_style="bold")
    for head in mode_columns(spoken):
        modes.add_column(head, overflow="fold")
    for mode in found.modes:
        modes.add_row(*mode_row(mode.name, mode, spoken, base_excited=found.is_base_excited))
    unit = ROTARY if found.rotary else LINEAR
    because = [spoken.say(why) for why in found.spread.because]
    facts = [
        f"{say('identify-mass')}: {plus_minus(found.moving_mass, unit.mass.si, spoken)}",
        f"{say('identify-delay')}: {plus_minus(found.delay, 's', spoken)}",
        *(
            f"{say('identify-band')}: "
            f"{say('identify-band-from-to', low=fit.band_hz[0], high=fit.band_hz[1])}; "
            f"{say('identify-misfit')}: {form.number(fit.misfit, digits=3)}"
            for fit in found.fits
        ),
        f"{say('identify-spread-frequency')}: ± {form.percent(found.spread.frequency)} "
        f"({because[0]})",
        f"{say('identify-spread-damping')}: ± {form.percent(found.spread.damping)} ({because[1]})",
        *(
            f"{say('identify-head-explained')}: {form.percent(one.explained)}, {one.record}"
            + (f" ({say('identify-head-held-back')})" if one.is_held_back else "")
            for one in checks
        ),
    ]
    parts: list[RenderableType] = [heading(say("identify-title")), *map(Text, facts)]
    if found.modes:
        parts += [Text(), modes]
    parts += [Text(say("identify-page-note")), *(Text(spoken.say(one)) for one in found.notes)]
    return Group(*parts, *warn(spoken, found.doubts))
