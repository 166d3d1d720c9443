"""What is unusual about a machine is said, each with its number; what is usual is not."""

from __future__ import annotations

import re

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.quantities import THIN_SPACE
from mtcommission.machine.checks import check_plausibility
from mtcommission.machine.machine import Motion
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped
from tests.test_profile import MANIPULATOR, MODAL, changed

CONTROL = '"5 um"\n[control]\n'
ON_THE_PAPER = [
    ('"2 kN"', '"2 N"', "acceleration-unusual"),
    ('"2 kN"', '"2000 kN"', "mode-bends-far mode-bends-far acceleration-unusual"),
    ('"2 kN"', '"2 kN"\nstatic_load = "-1.2 kN"', "static-load-large"),
    ('"2 kN"', '"2 kN"\ncontinuous_force = "3 kN"', "continuous-force-above-max"),
    ('"2.5 ms"', '"100 ms"', "force-lag-long"),
    ('"0.1 m/s"', '"0.1 m/s"\n[[moves]]\ndistance = 900\nmax_velocity = 9', "move-lasts-long"),
    ('velocity_step = "0.1 m/s"', "distance = 0.02\nmax_velocity = 30", "move-fast"),
    ('"5 um"', '"50 mm"', "band-unusual"),
    ('"5 um"', '"5 um"\npayload = [0, 3000]', "payload-large"),
    ('"5 um"', '"5 um"\nmodes = { surface = "20 um", speed = "2 um" }', "bands-not-widening"),
    ('"5 um"', CONTROL + 'feedforward_mass = "75 kg"', "feedforward-mass-far"),
    ('"5 um"', CONTROL + "position_gain = 4", "position-gain-without-unit"),
    ('"5 um"', CONTROL + 'minimum_bandwidth = "15 kHz"', "bandwidth-above-sampling"),
    (
        '"5 um"',
        CONTROL + 'position_cycle = "5.5 ms"\nvelocity_cycle = "5.5 ms"',
        "mode-of-few-position-cycles mode-above-velocity-sampling mode-above-position-sampling",
    ),
]
ON_MODES = [
    ("damping_ratio = 0.02", "damping_ratio = 0.35", "mode-damping-unusual"),
    ("damping_ratio = 0.02", "damping_ratio = 0", "mode-damping-unusual mode-rings-for-ever"),
    ('"40 Hz"', '"0.8 Hz"', "mode-slow mode-rings-long mode-bends-far"),
    ('tcp_gain = "2e-3 1/kg"', "tcp_gain = 0", "mode-unseen"),
    ('"2e-3 1/kg"', '"1 1/kg"', "mode-gain-large mode-bends-far"),
]
"""What is changed in the profile of the manipulator or of modes, and what all is said."""


@pytest.mark.parametrize(
    ("text", "old", "new", "kinds"),
    [(MANIPULATOR, *case) for case in ON_THE_PAPER] + [(MODAL, *case) for case in ON_MODES],
)
def test_what_is_unusual_is_said(text, old, new, kinds):
    machine = parse_profile(changed(text, old, new), where="p.toml")
    said = [one.values.get("what", one) for one in check_plausibility(machine)]
    assert [one.kind for one in said] == kinds.split()


def remarks_on(text: str) -> str:
    machine = parse_profile(text, where="p.toml")
    catalogue = Catalogue("en", rotary=machine.motion is Motion.ROTARY)
    said = (catalogue.say(remark) for remark in check_plausibility(machine))
    return " | ".join(said).replace(THIN_SPACE, " ")


def test_each_is_said_with_its_numbers():
    assert remarks_on(changed(MODAL, '"40 Hz"', '"0.8 Hz"')) == (
        "mode beam: 0.8 Hz is slower than any machine structure; check stiffness and mass | "
        "mode beam: 0.8 Hz at a damping ratio of 0.02 rings for 45.8 s until 1 % is left | "
        "mode beam: the full force bends the tool by 158 mm, 3.17×10⁴ times tcp_deviation = 5 µm; "
        "check the stiffness and the band"
    )


def test_a_rotary_axis_is_described_in_its_own_units():
    """Else the torque of a table would be given in newtons."""
    table = read_shipped("rotary-table").text
    weak = re.sub(
        r"^max_force = .*\ncontinuous_force = .*", 'max_force = "1 mN m"', table, flags=re.M
    )
    assert weak != table
    assert "Max torque: 1" in remarks_on(weak)
