"""The sentences about the paper's comparison must carry readable numbers in units of the trade."""

from __future__ import annotations

from dataclasses import replace
from math import inf, pi
from pathlib import Path

import numpy as np
import pytest

from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.variations import NOMINAL
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import THIN_SPACE
from mtcommission.profile.read import read_profile
from mtcommission.study.optimum import (
    ComparedControl,
    FedForward,
    explain_why_not,
    state_claims,
)

ROTARY = read_profile(Path(__file__).parent.parent / "profiles" / "rotary-table.toml")


def unspaced(text: str) -> str:
    return text.replace(THIN_SPACE, " ")


def fed(settling: float, residual: float) -> FedForward:
    return FedForward(
        corner=NOMINAL,
        settling_time=settling,
        residual_deviation=residual,
    )


def why_not(machine: Machine, residual: float) -> list[str]:
    ours = fed(0.08, machine.requirements.tcp_deviation)
    rows = [
        (Message("control-time-optimal"), [fed(12.3456, residual)]),
        (Message("recommended-limits"), [ours]),
    ]
    words = Catalogue(rotary=machine.motion is Motion.ROTARY)
    return [unspaced(words.say(sentence)) for sentence in explain_why_not(machine, rows)]


@pytest.mark.parametrize(
    ("degrees", "words"), [(5.0 / 3600.0, "5″."), (0.05, "180″."), (0.25, "0.25°.")]
)
def test_rotary_axis_speaks_of_degrees_and_arc_seconds(degrees: float, words: str) -> None:
    """The same sheet's tables print degrees and seconds of arc; a sentence said µrad."""
    machine = replace(
        ROTARY, requirements=replace(ROTARY.requirements, tcp_deviation=10.0 / 3600.0 * pi / 180.0)
    )
    sentences = why_not(machine, degrees * pi / 180.0)
    assert sentences[0].endswith(f"where it leaves {words}")
    assert sentences[-1].startswith("The band is 10″, ")


def compared(transfer: float, overshoot: float) -> ComparedControl:
    return ComparedControl(
        name=Message("way-recommended"),
        transfer_time=transfer,
        overshoot=overshoot,
        peaks=np.zeros(1),
        max_force=1.0,
        heat=1.0,
        work=1.0,
    )


def test_claims_are_written_without_powers_of_ten() -> None:
    """A slow move of a soft axis read 'takes 1.235e+04 ms'."""
    controls = [compared(12.3456, 31.4), compared(inf, 1e-5), compared(0.010001, 0.0)]
    first, second = (unspaced(Catalogue().say(claim)) for claim in state_claims(controls))
    assert first == (
        "The rectangular acceleration setpoint overshoots by 3140 % and takes 12.35 s, "
        "1234 times the least time of 10 ms."
    )
    assert second.endswith("does not settle, where the least time is 10 ms.")
