"""The example machines that come with the package."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine
from mtcommission.machine.profile.read import parse_profile, read_profile_text
from mtcommission.machine.readers import propose

WIDTH = 80


@dataclass(frozen=True, slots=True, kw_only=True)
class ShippedProfile:
    """An example machine."""

    name: str  # as ``profiles show`` and ``profiles copy`` take it
    machine: Machine
    text: str  # the commented file


def shipped_names() -> tuple[str, ...]:
    """Return the names of the shipped profiles, in alphabetical order."""
    return tuple(sorted(path.stem for path in _folder().glob("*.toml")))


def read_shipped(name: str) -> ShippedProfile:
    """Return a shipped profile, with or without ``.toml``; raise InputError if there is none."""
    known, wanted = shipped_names(), name.strip().removesuffix(".toml")
    if wanted not in known:
        message = Message("profile-unknown", got=repr(name), hint=propose(wanted, known))
        raise InputError.at("profiles", message)
    text = read_profile_text(_folder() / f"{wanted}.toml")
    return ShippedProfile(
        name=wanted, machine=parse_profile(text, where=f"{wanted}.toml"), text=text
    )


def describe_shipped(profile: ShippedProfile, words: Catalogue) -> str:
    """Return name, machine and source of a shipped profile for a terminal of 80 columns."""
    machine = profile.machine
    frequencies = (mode.frequency_hz for mode in machine.mechanics.modes)
    modes = [words.format.quantity(one, "Hz", digits=3) for one in frequencies]
    about = words.text(
        "example-about",
        name=machine.name,
        axis_name=machine.axis,
        motion=machine.motion.value,
        modes=", ".join(modes),
    )
    lines = [profile.name]
    for sentence in (about, words.text("terminal-source", source=machine.source)):
        lines += wrap(sentence, WIDTH, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines) + "\n"


def _folder() -> Path:
    """Inside the package when installed from a wheel, beside it in a source tree."""
    package = Path(__file__).parents[2]
    installed = package / "profiles"
    return installed if installed.is_dir() else package.parent / "profiles"
