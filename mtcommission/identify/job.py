"""Measured files of one axis -> what was found, its JSON, and a profile that holds it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.identify.gather import gather
from mtcommission.identify.identified import Identified, identify
from mtcommission.identify.measurement import Given
from mtcommission.identify.profile import Writing, kind_replaced, merge_profile, write_profile
from mtcommission.record.identified import IdentifiedPart
from mtcommission.record.shape import dump_json, to_plain


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredAxis:
    """What measured files say of an axis."""

    found: Identified
    profile: str  # TOML; lacks what no response tells; "" where no model describes the files

    @property
    def part(self) -> IdentifiedPart:
        """As the record holds it."""
        return self.found.part

    @property
    def json(self) -> str:
        """Points, fit and advice, which the profile names as its evidence."""
        entry: dict[str, Any] = {
            "files": list(self.found.files),
            "sensor": {one.name: one.sensor for one in self.part.sources},
            **to_plain(self.part),
            "profile": self.profile,
        }
        return dump_json(entry)


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
    found = identify(
        gather(files, given),
        created=created,
        force_per_unit=given.constant,
        band_hz=band_hz,
        count=count,
    )
    warnings = [*found.part.warnings, *kind_replaced(before)]
    found = replace(found, part=replace(found.part, warnings=warnings))
    how = Writing(
        file=target,
        tool_ratio=tool_ratio,
        words=words(found.part.rotary),
        evidence=evidence,
        axis=axis,
    )
    text = ""
    if found.doubt is None or forced:
        text = merge_profile(before, found, how) if before else write_profile(found, how)
    return MeasuredAxis(found=found, profile=text)


def name_from(profile: str, evidence: str) -> str:
    """Return the name of a file as a profile states it; "" where one of them is no file."""
    if {profile, evidence} & {"", "-"}:
        return ""
    place, folder = Path(evidence).resolve(), Path(profile).resolve().parent
    return place.name if place.parent == folder else str(place)
