"""What a kind of control has; where that was read stands in docs/controls.md."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import inf
from typing import Final


class Jerk(Enum):
    """How a control takes a limit of the jerk."""

    LIMIT = "limit"
    TIME = "time"
    NONE = "none"


class PositionLoop(Enum):
    """Where the position loop closes, and how the setpoint gets from cycle to cycle.

    ``CONTROL``: in the control at the position cycle; what it hands down is held.
    ``INTERPOLATED``: the same, but velocity and force feed-forward are interpolated at the velocity
    cycle. ``DRIVE``: in the drive at the velocity cycle, which interpolates the setpoint, too
    (dynamic servo control).
    """

    CONTROL = "control"
    INTERPOLATED = "interpolated"
    DRIVE = "drive"


NOTCH: Final = "notch"
LOW_PASS: Final = "low_pass"
"""Kinds of filter in the torque setpoint, as in profiles."""

MOVING_AVERAGE, TWO_AVERAGES, FIR = "moving_average", "two_moving_averages", "fir"
KLIPPER_SHAPERS = ("zv", "mzv", "zvd", "ei", "2hump_ei", "3hump_ei")
MARLIN_SHAPERS = (
    *("marlin_zv", "marlin_mzv", "marlin_zvd", "marlin_zvdd", "marlin_zvddd"),
    *("marlin_ei", "marlin_2hump_ei", "marlin_3hump_ei"),
)
SHAPERS = KLIPPER_SHAPERS + MARLIN_SHAPERS
"""Kinds of setpoint filter, as in profiles: averages, taps, and shapers. The EI family without a
word is Klipper's since September 2025; Marlin's, on its grid of samples, is the classical one."""

LONGEST_AVERAGE = 0.2
"""Longest average that is looked for where a control does not bound it [s]: empirical."""

MOST_CYCLES, WHOLE = 100, 1e-6
"""Position cycles among which a whole multiple of a step is sought, and what is whole [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterChoice:
    """A kind of setpoint filter that a control has, and how far it can be set."""

    kind: str  # as in profiles
    least_cycles: float = 0.0  # an average acts between these lengths [position cycles]
    most_cycles: float = inf
    advised_cycles: float = inf  # what the maker advises at most; 0: not to use it at all
    longest: float = LONGEST_AVERAGE  # that a search tries, whatever the cycle [s]
    step: float = 0.0  # lengths are whole multiples of it [s]; 0: any
    least_frequency_hz: float = 0.0  # of a shaper
    most_frequency_hz: float = inf
    least_damping: float = 0.0  # damping ratios that a shaper takes
    most_damping: float = 0.99

    def unit(self, position_cycle: float) -> float:
        """Return what lengths of an average are whole multiples of [s].

        A control averages over whole position cycles, whatever is typed: the least number of them
        that is a whole multiple of the step, too.

        Examples
        --------
        >>> FilterChoice(kind="moving_average", step=1e-6).unit(2e-3)
        0.002
        >>> FilterChoice(kind="moving_average", step=1e-3).unit(0.4e-3)
        0.002
        """
        for count in range(1, MOST_CYCLES):
            steps = count * position_cycle / self.step if self.step else 1.0
            if abs(steps - round(steps)) < WHOLE * steps:
                return count * position_cycle
        return position_cycle

    def possible_times(self, position_cycle: float) -> tuple[float, float]:
        """Return between which lengths an average acts [s]."""
        return self.least_cycles * position_cycle, self.most_cycles * position_cycle

    def nearest_damping(self, ratio: float) -> float:
        """Return the nearest damping ratio that a shaper takes."""
        return min(max(self.least_damping, ratio), self.most_damping)

    def times(self, position_cycle: float) -> tuple[float, float]:
        """Return between which lengths of an average to choose [s]; reversed: none is advised."""
        least, most = self.possible_times(position_cycle)
        return least, min(self.longest, most, self.advised_cycles * position_cycle)


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlKind:
    """What a kind of control has; what it lacks is neither tuned nor simulated nor exported."""

    key: str  # for ``control.kind`` and ``export --control``
    unread: tuple[str, ...] = ()  # of what is below, what was not read in a maker's text: "(?)"
    follows_steps: bool = False  # steps go out open loop: the loop only stands in for the motor
    jerk: Jerk = Jerk.LIMIT
    modes: tuple[str, ...] = ()  # its columns of limits by machining mode; empty: one set of limits
    setpoint_filters: tuple[FilterChoice, ...] = ()  # one at a time
    velocity_feedforward: bool = True
    acceleration_feedforward: bool = True
    jerk_feedforward: bool = False
    reference_delay: bool = True  # the position setpoint can wait for the fed-forward force
    position_loops: tuple[PositionLoop, ...] = (PositionLoop.CONTROL,)  # the usual one first
    position_cycle: float = 2e-3  # usual [s]
    velocity_cycle: float = 125e-6
    force_filters: int = 0  # how many filters (notch, low-pass) the torque setpoint has
    state_feedback: bool = False
    largest_acceleration: float = inf
    """More than this is not recommended on a linear axis, whatever the model allows [m/s²]:
    practical and assumed, for what frame and tool take is not in the model."""

    @property
    def has_jerk_limit(self) -> bool:
        """Whether the jerk is limited at all, be it by a number or by a time."""
        return self.jerk is not Jerk.NONE

    def find_filter(self, kind: str) -> FilterChoice | None:
        """Return how far a kind of setpoint filter can be set; None: the control lacks it."""
        return next((choice for choice in self.setpoint_filters if choice.kind == kind), None)
