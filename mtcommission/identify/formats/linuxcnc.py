"""LinuxCNC: what halscope saves, and what halsampler prints.

Formats read in src/hal/utils/scope_files.c (a line with the sampling period in ns, names of the
channels, values, all with ``;``) and src/hal/components/sampler_usr.c (values with blanks, no
names, with ``-t`` the number of the sample first; ``overrun`` where samples were lost).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from mtcommission.base.messages.message import Message
from mtcommission.identify.formats.contents import Column, FileContents, TimeContents, refuse
from mtcommission.identify.formats.heads import split_head
from mtcommission.identify.formats.table import read_table

PERIOD = re.compile(r"^#\s*Sampling period is\s+(\d{1,12})\s*ns", re.IGNORECASE)


def read_halscope(lines: Sequence[str], *, where: str) -> FileContents:
    """Return the channels of a file that halscope saved."""
    match = PERIOD.match(lines[0])
    period = 1e-9 * int(match[1]) if match else 0.0
    if period <= 0.0:
        raise refuse(where, "identify-no-period", line=1, got=lines[0].strip()[:60])
    alone = ";" not in "".join(lines[1:40])
    body = [f"{line};0" for line in lines[1:]] if alone else lines[1:]
    table = read_table(body, where=where, first_line=2)
    heads = [split_head(head) for head in table.heads[: -1 if alone else None]]
    columns = tuple(
        Column(name=name or str(place + 1), unit=unit, values=table.values[:, place])
        for place, (name, unit) in enumerate(heads)
    )
    record = TimeContents(sample_time=period, columns=columns, lines=table.lines)
    format_ = Message("identify-format-halscope")
    return FileContents(format=format_, items=(record,), remarks=table.remarks)
