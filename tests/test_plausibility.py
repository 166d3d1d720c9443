"""What is unusual about a machine is said, each with its number; what is usual is not."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.quantities import THIN_SPACE
from mtcommission.machine.checks import check_plausibility
from mtcommission.machine.machine import Motion
from mtcommission.machine.profile.read import parse_profile
from tests.test_profile import MANIPULATOR, MODAL, cases, changed

PROFILES = Path(__file__).parent.parent / "profiles"


def remarks_on(text: str) -> str:
    machine = parse_profile(text, where="p.toml")
    catalogue = Catalogue("en", rotary=machine.motion is Motion.ROTARY)
    said = (catalogue.say(remark) for remark in check_plausibility(machine))
    return " | ".join(said).replace(THIN_SPACE, " ").replace("\N{NO-BREAK SPACE}", " ")


ON_THE_PAPER = r"""
"2 kN"  ->  "2 N"
  Max force: 2 N on 750 kg give 2.67 mm/s², which is not what machine axes do; check both units
"2 kN"  ->  "2000 kN"
  mode base: the full force bends the tool by 45 mm, 9.01×10³ times tcp_deviation = 5 µm; check
    the stiffness and the band | mode rotation: the full force bends the tool by 12.8 mm,
    2.56×10³ times tcp_deviation = 5 µm; check the stiffness and the band | Max force: 2000 kN
    on 750 kg give 2667 m/s², which is not what machine axes do; check both units
"2 kN"  ->  "2 kN"\nstatic_load = "-1.2 kN"
  Static load: 1.2 kN take more than half of max_force = 2 kN; consider a counterbalance
"2 kN"  ->  "2 kN"\ncontinuous_force = "3 kN"
  Continuous force: 3 kN is above max_force = 2 kN, so it limits nothing; the two may be swapped
"2.5 ms"  ->  "100 ms"
  Time constant of the force loop T: 100 ms is long for a force loop (servo drives: 0.5 to 5 ms)
"0.1 m/s"  ->  "0.1 m/s"\n[[moves]]\ndistance = 900\nmax_velocity = 9
  Move 2: a rigid axis would need 103 s for this move; check distance, velocity and force
velocity_step = "0.1 m/s"  ->  distance = 0.02\nmax_velocity = 30
  Move 1: Max velocity: 30 m/s is faster than machine axes move, 10 m/s; check the unit
"5 um"  ->  "50 mm"
  Permitted TCP deviation (band): 50 mm is no usual accuracy; check the unit
"5 um"  ->  "5 um"\npayload = [0, 3000]
  the payload, 3000 kg, is more than three times the moving mass, 750 kg; one set of limits will
    be slow for the empty axis
"5 um"  ->  "5 um"\nmodes = { surface = "20 um", speed = "2 um" }
  the bands of the machining modes, surface 2×10⁻⁵, accuracy 5×10⁻⁶ and speed 2×10⁻⁶ m, do not
    widen in this order; they may be swapped
"5 um"  ->  "5 um"\n[control]\nfeedforward_mass = "75 kg"
  75 kg in the feed-forward is far from the moving mass, 750 to 750 kg; the feed-forward will
    push too little or too much
"5 um"  ->  "5 um"\n[control]\nposition_gain = 4
  Kv = 4 1/s is only 0.24 (m/min)/mm; if 4 (m/min)/mm is meant, write the unit: "4 (m/min)/mm"
"5 um"  ->  "5 um"\n[control]\nminimum_bandwidth = "15 kHz"
  a least bandwidth of 1.5×10⁴ Hz is above a third of the velocity loop's sampling rate, 8000 Hz
"5 um"  ->  "5 um"\n[control]\nposition_cycle = "5.5 ms"\nvelocity_cycle = "5.5 ms"
  mode base: one period has only 3.6 position cycles of 5.5 ms; a jerk time can only be set that
    coarsely | mode rotation: 72.1 Hz is above a third of the velocity loop's sampling rate,
    181.8 Hz; no feedback can damp it | mode rotation: 72.1 Hz is above a third of the position
    loop's sampling rate, 181.8 Hz; setpoints at that cycle cannot shape it
"""
"""What is changed in the profile of the manipulator, and below it all that is said."""

ON_MODES = r"""
damping_ratio = 0.02  ->  damping_ratio = 0.35
  mode beam: damping ratio 0.35 is not what machine structures show, 0.002 to 0.3
damping_ratio = 0.02  ->  damping_ratio = 0
  mode beam: damping ratio 0 is not what machine structures show, 0.002 to 0.3 | mode beam: 40
    Hz at a damping ratio of 0 rings for ever
"40 Hz"  ->  "0.8 Hz"
  mode beam: 0.8 Hz is slower than any machine structure; check stiffness and mass | mode beam:
    0.8 Hz at a damping ratio of 0.02 rings for 45.8 s until 1 % is left | mode beam: the full
    force bends the tool by 158 mm, 3.17×10⁴ times tcp_deviation = 5 µm; check the stiffness and
    the band
tcp_gain = "2e-3 1/kg"  ->  tcp_gain = 0
  mode beam: neither tool nor encoder sees it; it costs time in the optimum for nothing
"2e-3 1/kg"  ->  "1 1/kg"
  mode beam: its gain is 300 times 1/moving_mass; check the unit of the gains | mode beam: the
    full force bends the tool by 31.7 mm, 6.33×10³ times tcp_deviation = 5 µm; check the
    stiffness and the band
"""
"""The same of the modal profile."""


@pytest.mark.parametrize(("old", "new", "expected"), cases(ON_THE_PAPER))
def test_what_is_unusual_about_the_manipulator(old: str, new: str, expected: str) -> None:
    assert remarks_on(changed(MANIPULATOR, old, new)) == expected


@pytest.mark.parametrize(("old", "new", "expected"), cases(ON_MODES))
def test_what_is_unusual_about_a_mode(old: str, new: str, expected: str) -> None:
    assert remarks_on(changed(MODAL, old, new)) == expected


def test_a_rotary_axis_is_described_in_its_own_units() -> None:
    """Else the torque of a table would be given in newtons."""
    table = (PROFILES / "rotary-table.toml").read_text(encoding="utf-8")
    weak = re.sub(
        r"^max_force = .*\ncontinuous_force = .*", 'max_force = "1 mN m"', table, flags=re.M
    )
    assert weak != table
    assert "Max torque: 1" in remarks_on(weak)
