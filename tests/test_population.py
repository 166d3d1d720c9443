"""Random machines: within the stated ranges, the same from the same seed, and usable."""

from __future__ import annotations

from math import pi

from benchmarks.population import Population, random_machine
from mtcommission.machine.machine import moving_mass
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.modal import Modal

MACHINES = [random_machine(seed) for seed in range(300)]


def test_a_seed_is_a_machine() -> None:
    """If it failed, a printed validation could not be repeated."""
    assert random_machine(11) == random_machine(11)
    assert len({machine.drive.max_force for machine in MACHINES}) == len(MACHINES)


def test_every_machine_lies_in_the_stated_ranges() -> None:
    """If it failed, the sheet would claim a validity that was never tried."""
    ranges = Population()
    for machine in MACHINES:
        mechanics, needs = machine.mechanics, machine.requirements
        assert isinstance(mechanics, Modal)
        mass = moving_mass(machine)
        assert ranges.moving_mass.low <= mass <= ranges.moving_mass.high
        acceleration = machine.drive.max_force / mass
        assert ranges.acceleration.low <= acceleration <= ranges.acceleration.high
        assert ranges.tcp_deviation.low <= needs.tcp_deviation <= ranges.tcp_deviation.high
        assert needs.frequency_spread in ranges.frequency_spreads
        assert 0.0 <= needs.payload[1] <= ranges.payload_share.high * mass
        assert 1 <= len(mechanics.modes) <= ranges.most_modes
        frequencies = [mode.natural_frequency / (2 * pi) for mode in mechanics.modes]
        assert all(15.0 <= frequency <= 200.0 for frequency in frequencies)
        assert frequencies == sorted(frequencies)
        for mode in mechanics.modes:
            assert ranges.damping_ratio.low <= mode.damping_ratio <= ranges.damping_ratio.high
            assert 0.05 <= abs(mode.tcp_gain) * mass <= 2.0
            assert mode.measured_gain == 0.0 or 0.02 <= mode.measured_gain * mass <= 1.0


def test_ranges_are_used_to_their_ends() -> None:
    """If it failed, the validation would be narrower than it says."""
    masses = [moving_mass(machine) for machine in MACHINES]
    assert min(masses) < 60.0
    assert max(masses) > 2500.0
    steps = sum(isinstance(machine.moves[0], VelocityStep) for machine in MACHINES)
    assert 110 < steps < 190
    assert 110 < sum(machine.requirements.payload[1] > 0.0 for machine in MACHINES) < 190
