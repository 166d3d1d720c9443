"""The numbers of the studies, and which settings stand on the sheet."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from mtcommission.loop.tuning.tuned import TUNING


@dataclass(frozen=True, slots=True, kw_only=True)
class StudySettings:
    """Design choices and empirical numbers: of the loop that is used, and of the studies."""

    # Which loop: what a stiffer tool is worth, as a smooth price, so that a machine that is a
    # little better never gets a loop that is much slower.
    stiffness_exponent: float = 0.01  # twice the stiffness is worth 0.7 % of the settling time
    sooner: float = 0.98  # state feedback is worth its effort if the moves settle 2 % sooner,
    stiffer: float = 1.2  # or as soon with a tool that is 20 % stiffer
    centres: int = 2  # loops about which others are looked at
    beside: int = 4  # kinds of setpoint filters of a first look, the best of another loop first
    finalists: int = 3  # loops whose limits are sought more closely,
    beside_best: int = 2  # about so many places behind the first of them,
    too_late: float = 1.1  # a first look goes no further than this share of the least time,
    too_dear: float = 1.03  # unless their price at a first look is beyond that of the least one
    push_time: float = 0.3  # of the response to a step of force [s]
    other_filter: float = 0.6  # how far about it another filter may serve the listed sizes [-]
    # Improvements.
    known_spread: float = 0.02  # frequencies of a machine whose modes were measured [-]
    worth: float = 0.01  # a change that saves less of the time is not judged [-]
    long_rest: float = 3600.0  # with which no move heats the motor [s]
    rest_tries: int = 4  # how often a rest that does not suffice yet is made longer,
    rest_factor: float = 1.5  # and by how much
    # Attainable: by what requirements are relaxed at most (what needs more is no requirement), and
    # halvings of that range: the least factor is found to within 12 %.
    largest_factor: float = 1e3
    halvings: int = 6
    # Robustness: how far frequencies may be off (twice the spread if that is more), in how many
    # steps to either side.
    frequency_range: float = 0.1
    frequency_points: int = 15
    # An eigenfrequency is off by that much even where it was measured (resolution,
    # temperature, place on the axis); damping, of one day or another, by half.
    known_frequency: float = 0.02
    least_damping: float = 0.3
    most_damping: float = 1.7
    damping_points: int = 15
    together: int = 64  # machines whose loops are looked at at once: their tables fit the cache
    samples: int = 24  # of free motion to a period
    mean_cycles: int = 400  # position cycles summed for a mean
    # Sizes of moves looked at, as shares of the listed one; their ramps differ by 3 %.
    smallest: float = 0.01
    largest: float = 3.0
    sizes: int = 96
    size_samples: int = 48  # of free motion to a period
    followed: float = 1.0  # what creeps for longer with friction, an engineer calls off [s]


STUDY = StudySettings()

PRINTED = {
    "tuning": asdict(TUNING),
    "robustness": {
        "frequency_range": STUDY.frequency_range,
        "frequency_points": STUDY.frequency_points,
    },
}
"""Numerical settings that stand on the sheet."""
