"""What may be computed: the same count everywhere, parts left out by name, an end of the whole."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from benchmarks.fuzz import LONGEST, call, fault_of, in_place
from benchmarks.mutations import dice_of, extreme_machine
from mtcommission.allowance import (
    LARGEST,
    SECOND,
    WHOLE,
    allow_part,
    allow_whole,
    find_part,
    left,
    require_room,
    spend,
)
from mtcommission.commission import recommend
from mtcommission.errors import ComputationError, Outcome, TooMuchError
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, Positioning
from mtcommission.messages.message import Message
from mtcommission.optimal.transcription.settings import TranscriptionSettings
from mtcommission.optimal.transcription.transcription import transcribe_time_optimal
from mtcommission.plant.plant import build_plant
from mtcommission.profile.shipped import read_shipped


def say(error: Message) -> str:
    return error.kind


def test_a_part_that_is_too_much_is_named_and_the_whole_goes_on() -> None:
    def find() -> str:
        spend(2.0 * SECOND)
        return "found"

    with allow_whole(40.0):
        assert find_part(find, seconds=3.0, otherwise=say) == "found"
        assert find_part(find, seconds=1.0, otherwise=say) == "outcome-too-much-to-compute"
        assert left() == pytest.approx(36.0 * SECOND, rel=1e-4)


def test_the_whole_ends_even_where_failures_of_parts_are_caught() -> None:
    def find() -> str:
        spend(2.0 * SECOND)
        return "found"

    with pytest.raises(TooMuchError) as caught, allow_whole(1.0):
        find_part(find, seconds=5.0, otherwise=say)
    assert caught.value.outcome is Outcome.TOO_MUCH_TO_COMPUTE
    assert caught.value.exit_code == 3
    assert not isinstance(caught.value, ComputationError)
    spend(1e3 * SECOND)  # outside nothing is counted


def test_parts_leave_what_cannot_be_done_without() -> None:
    with allow_whole(40.0):
        spend(34.5 * SECOND)
        with pytest.raises(ComputationError, match="too much"), allow_part(5.0):
            spend(1.0 * SECOND)
        assert left() > 4.0 * SECOND


def test_other_outcomes_of_a_part_are_not_swallowed() -> None:
    def find() -> str:
        raise ComputationError(Outcome.UNSTABLE_LOOP, Message("allowance-mesh"))

    with pytest.raises(ComputationError, match="unstable"):
        find_part(find, otherwise=say)


def test_an_array_that_is_too_large_is_refused_before_it_is_made() -> None:
    require_room(LARGEST, array="allowance-mesh")
    with pytest.raises(ComputationError, match="would have"):
        require_room(LARGEST + 1, array="allowance-mesh")


def test_a_loop_that_keeps_thousands_of_setpoints_is_refused() -> None:
    """A long delay at a short cycle took 1.1 GB."""
    machine = read_shipped("modal-two-modes").machine
    control = replace(
        machine.control, reference_delay=0.1, position_cycle=125e-6, velocity_cycle=125e-6
    )
    with pytest.raises(ComputationError, match="setpoints that it keeps") as caught:
        tune_loop(replace(machine, control=control))
    assert caught.value.outcome is Outcome.TOO_MUCH_TO_COMPUTE


def test_the_count_is_the_same_each_time() -> None:
    """Not a clock: two runs of one machine end with the same number of steps left."""
    machine = read_shipped("honing-z").machine
    used = [steps_of(machine) for _ in range(2)]
    assert used[0] == used[1] < WHOLE * SECOND / 2.0


def steps_of(machine: Machine) -> float:
    """What finding loop and limits counts."""
    given = 1e3
    with allow_whole(given):
        recommend(machine)
        return given * SECOND - left()


def test_a_shorter_move_and_fewer_payloads_take_less() -> None:
    """The remedies that the outcome names are true."""
    machine = read_shipped("honing-z").machine
    heavy = replace(machine, requirements=replace(machine.requirements, payload=(0.0, 20.0)))
    twice = replace(machine, moves=(*machine.moves, Positioning(distance=0.05, max_velocity=0.5)))
    assert steps_of(machine) < steps_of(heavy)
    assert steps_of(machine) < steps_of(twice)


@pytest.mark.parametrize("seed", [6, 7, 9])
def test_machines_that_nobody_built_end_with_an_outcome(seed: int, tmp_path: Path) -> None:
    profile = tmp_path / "dice.toml"
    profile.write_text(extreme_machine(dice_of(99, seed)), "utf-8")
    ending = in_place(partial(call, "limits", str(profile)))
    assert not fault_of("limits", ending, longest=LONGEST), ending


def test_a_transcription_ends_with_what_it_is_allowed() -> None:
    """IPOPT with 20000 intervals took more than two minutes."""
    machine = read_shipped("modal-two-modes").machine
    plant, move = build_plant(machine), machine.moves[0]
    force = machine.drive.motion_force
    for intervals, seconds in ((2000, 0.5), (40000, WHOLE)):
        settings = TranscriptionSettings(intervals=intervals)
        with pytest.raises((ComputationError, TooMuchError)) as end, allow_whole(seconds):
            transcribe_time_optimal(plant, move, force_limit=force, bounds=(), settings=settings)
        assert end.value.outcome is Outcome.TOO_MUCH_TO_COMPUTE
