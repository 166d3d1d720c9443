"""The whole commissioning of one case; apart from its limits: the record needs python-control."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256

from mtcommission.commission import commission
from mtcommission.machine.machine import Machine
from mtcommission.machine.plausibility import check_plausibility
from mtcommission.record.build import build_record
from mtcommission.record.files import dump_json
from mtcommission.record.identified import read_evidence
from mtcommission.record.schema.record import Profile
from mtcommission.sweep.chain import chain_cells
from mtcommission.sweep.store import Cell


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseRun:
    """A whole commissioning of one case.

    Parameters
    ----------
    cells
        Result columns.
    record
        ``record.json`` as text.
    """

    cells: tuple[Cell, ...]
    record: str


def run_case(machine: Machine, *, text: str, name: str, created: str) -> CaseRun:
    """Return the whole commissioning of a case.

    Parameters
    ----------
    machine
        Of the case.
    text, name
        Its profile.
    created
        Date for the record.

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    found = commission(machine)
    warnings = [remark.with_key() for remark in check_plausibility(machine)]
    profile = Profile(name=name, sha256=sha256(text.encode()).hexdigest(), text=text)
    identified = read_evidence(machine, None)
    record = build_record(
        found, profile=profile, created=created, warnings=warnings, identified=identified
    )
    cells = chain_cells(
        found.plant, found.optima, found.moves, found.recommended, found.choice.bound_by
    )
    return CaseRun(cells=cells, record=dump_json(record))
