"""Measured files of one axis -> what was found, its statement, and a profile that holds it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mtcommission.identify.check import check_records
from mtcommission.identify.document import Writing, kind_replaced, merge_profile, write_profile
from mtcommission.identify.entry import identified_json, identified_part
from mtcommission.identify.gather import gather
from mtcommission.identify.given import Given
from mtcommission.identify.identified import Identified
from mtcommission.identify.states import identify
from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.files import dump_json
from mtcommission.record.identified import IdentifiedPart


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredAxis:
    """What measured files say of an axis."""

    found: Identified
    part: IdentifiedPart  # as the record holds it
    profile: str  # TOML; lacks what no response tells; "" where no model describes the files

    @property
    def json(self) -> str:
        """Points, fit and advice, which the profile names as its evidence."""
        return dump_json(identified_json(self.part, profile=self.profile))


def identify_files(
    files: Sequence[str],
    given: Given,
    *,
    words: Callable[[bool], Catalogue],
    created: str,
    target: str,
    evidence: str,
    before: str = "",
    axis: str = "X",
    tool_ratio: float | None = None,
    band_hz: tuple[float, float] | None = None,
    count: int | None = None,
    forced: bool = False,
) -> MeasuredAxis:
    """Return what files say of an axis, merged into the profile ``before`` where there is one.

    ``words`` of the comments, by whether the axis turns; ``target``: where the profile will stand;
    ``evidence``: the file that it names; ``forced``: write it although no model fits.

    Raises
    ------
    InputError
        A file cannot be read, or leaves open what its columns are; or the profile is not valid.
    """
    found = identify(gather(files, given), band_hz=band_hz, count=count)
    checks = check_records(found, force_per_unit=given.constant, band_hz=band_hz, count=count)
    part = identified_part(found, checks=checks, created=created)
    part = replace(part, warnings=[*part.warnings, *kind_replaced(before)])
    how = Writing(
        date=created[:10],
        file=target,
        tool_ratio=tool_ratio,
        words=words(found.rotary),
        part=part,
        evidence=evidence,
        axis=axis,
    )
    text = ""
    if found.doubt is None or forced:
        text = merge_profile(before, found, how) if before else write_profile(found, how)
    return MeasuredAxis(found=found, part=part, profile=text)


def name_from(profile: str, evidence: str) -> str:
    """Return the name of a file as a profile states it; "" where one of them is no file."""
    if {profile, evidence} & {"", "-"}:
        return ""
    place, folder = Path(evidence).resolve(), Path(profile).resolve().parent
    return place.name if place.parent == folder else str(place)
