"""A kind of plant that the package has never heard of, added from outside by one call.

If one of these tests failed, a new kind of plant would need more than its own file: it would be
computed wrongly, left as it was, or taken for another kind somewhere on the way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt
from pathlib import Path
from typing import Any, ClassVar, Self

import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits, Dimension
from mtcommission.machine.keys import Misfit, keyed
from mtcommission.machine.mechanics import KINDS, FlexibleMode, Mechanics, ModeStates, register
from mtcommission.machine.profile.describe import profile_schema, questions
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.readers import MASSES, RATIOS, STIFFNESSES
from mtcommission.record.record import load_record
from mtcommission.verify.prediction import rebuild
from tests.recorded_traces import Spoilt, record_moves, write_csv
from tests.test_verify import limits_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Belt(Mechanics):
    """Two masses and a belt: the motor drives the first one, the tool sits on the second."""

    kind: ClassVar = "belt"
    position: ClassVar = "x"
    velocity: ClassVar = "v"

    motor_mass: float = keyed(MASSES, "Motor and pulleys, at the belt.", "20 kg")
    load_mass: float = keyed(MASSES, "What the belt pulls.", "60 kg")
    belt_stiffness: float = keyed(STIFFNESSES, "Stiffness of the belt.", "2 N/um")
    belt_damping: float = keyed(RATIOS, "Damping ratio.", "0.03")

    @property
    def moving_mass(self) -> float:
        return self.motor_mass + self.load_mass

    @property
    def modes(self) -> tuple[FlexibleMode]:
        """Eigenvectors of two masses and a spring, in the form q'' + ... = F."""
        m1, m2, whole = self.motor_mass, self.load_mass, self.moving_mass
        return (
            FlexibleMode(
                name="belt",
                natural_frequency=sqrt(self.belt_stiffness * whole / (m1 * m2)),
                damping_ratio=self.belt_damping,
                tcp_gain=-1.0 / whole,
                measured_gain=m2 / (m1 * whole),
            ),
        )

    def mode_states(self) -> tuple[ModeStates]:
        return (ModeStates("q", "w"),)

    @classmethod
    def states(cls, modes: Sequence[str], axis: AxisUnits) -> dict[str, Dimension]:
        elastic = {"q": axis.modal_deflection, "w": axis.modal_rate}
        return {"x": axis.length, "v": axis.velocity, **elastic, "F": axis.force}

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        (mode,) = self.modes
        heavier = replace(self, load_mass=self.load_mass + payload)
        omega = mode.natural_frequency * frequency
        return heavier.renew(
            mass=heavier.moving_mass,
            modes=[
                replace(mode, natural_frequency=omega, damping_ratio=self.belt_damping * damping)
            ],
        )

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        load = mass - self.motor_mass
        (mode,) = modes
        stiffness = mode.natural_frequency**2 * self.motor_mass * load / mass
        return replace(
            self, load_mass=load, belt_stiffness=stiffness, belt_damping=mode.damping_ratio
        )

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        if not 0.0 <= self.belt_damping < 1.0:
            yield "belt_damping", Message("damping-ratio-beyond-one", got=self.belt_damping)


PROFILE = """\
schema = 1
[machine]
name = "Shuttle"
axis = "X"
source = "drawing"
[plant]
kind = "belt"
motor_mass = "20 kg"
load_mass = "60 kg"
belt_stiffness = "2 N/um"
belt_damping = 0.03
[drive]
force_lag = "1 ms"
max_force = "600 N"
[[moves]]
distance = "200 mm"
max_velocity = "1 m/s"
[requirements]
tcp_deviation = "0.1 mm"
"""
OMEGA = sqrt(2e6 * 80 / (20 * 60))


@pytest.fixture(autouse=True)
def kind(monkeypatch):
    monkeypatch.setitem(KINDS, Belt.kind, Belt)  # so that it is gone after the test
    register(Belt)


def test_its_faults_have_line_and_remedy_and_schema_and_questions_know_it():
    text = PROFILE.replace('"2 N/um"', '"2 kg"').replace("motor_mass", "motormass")
    with pytest.raises(InputError) as refused:
        parse_profile(text.replace('"belt"', '"belts"'), where="p.toml")
    assert [str(fault) for fault in refused.value.faults] == [
        'p.toml:7: plant.kind: got "belts", must be "manipulator", "modal" or "belt"; '
        'did you mean "belt"?',
        'p.toml:8: plant.motormass: unknown key; did you mean "motor_mass", which is missing?',
        'p.toml:10: plant.belt_stiffness: got "2 kg"; must be in N/m, N/mm, N/um or kN/mm',
    ]
    assert "Stiffness of the belt." in profile_schema()
    asked = {one.key: one for one in questions("belt")}
    assert asked["plant.belt_stiffness"].example == "2 N/um"
    source = '[drive]\nkind = "position_source"\nmax_acceleration = 5\n'
    held = PROFILE.replace('[drive]\nforce_lag = "1 ms"\nmax_force = "600 N"\n', source)
    with pytest.raises(InputError, match="with the frequencies that the modes have while the mot"):
        parse_profile(held, where="p.toml")


def test_it_goes_through_check_run_export_and_verify(tmp_path, monkeypatch, run):
    """A load that is heavier than its profile says comes back in the keys of this kind."""
    monkeypatch.chdir(tmp_path)
    Path("belt.toml").write_text(PROFILE, encoding="utf-8")
    code, said, _ = run("check", "belt.toml")
    assert code == 0
    assert f"{OMEGA / (2 * pi):.2f}" in said
    assert run("run", "belt.toml", "-o", "out", "--no-pdf")[0] == 0
    assert "plant.belt_stiffness" in Path("out/sheet.html").read_text(encoding="utf-8")
    assert run("export", "out/record.json", "--control", "generic")[0] == 0
    record = load_record(Path("out/record.json"))
    rebuilt = rebuild(record)
    how = Spoilt(payload=20.0, noise=1e-7, step=5e-4)
    write_csv(Path("move.csv"), record_moves(rebuilt, limits_of(record), how))
    words = ("verify", "out/record.json", "move.csv", "--refine", "new.toml")
    assert run(*words)[0] == 1
    text = Path("new.toml").read_text(encoding="utf-8")
    new = parse_profile(text, where="new.toml").mechanics
    assert isinstance(new, Belt)
    assert new.load_mass == pytest.approx(80.0, rel=0.03)
    assert new.modes[0].natural_frequency == pytest.approx(OMEGA, rel=1e-4)
    assert new.motor_mass == 20.0
    assert "from the frequencies and the mass of a recorded move" in text
