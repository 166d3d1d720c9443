"""The control of an axis: its cascade and filters as stated, and what it holds today."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mtcommission.control_kinds.kind import ControlKind, PositionLoop
from mtcommission.control_kinds.kinds import GENERIC
from mtcommission.machine.setpoint_filter import SetpointFilter


class TcpSensor(Enum):
    """Second encoder near the tool."""

    NONE = "none"
    POSITION = "position"


class StateFeedback(Enum):
    """How the state-space extension gets its gains."""

    AUTO = "auto"
    OFF = "off"
    GIVEN = "given"


@dataclass(frozen=True, slots=True, kw_only=True)
class StateGain:
    """Gain of the state-space extension on one state."""

    state: str  # name of the plant state
    value: float  # set force per unit of that state's deviation [N/unit]


class FilterKind(Enum):
    """Kinds of set-force filter."""

    NOTCH = "notch"
    LOW_PASS = "low_pass"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFilter:
    """One filter in the set-force path."""

    kind: FilterKind  # notch or second-order low-pass
    natural_frequency: float  # [rad/s]
    damping: float  # denominator damping ratio of a low-pass, numerator one of a notch [-]
    width: float = 1.0
    """Denominator damping ratio of the notch [-]: its depth is damping / width. 1 is the widest
    without overshoot. Without effect on a low-pass."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Today:
    """What the control holds now; None for what is not known, which is then as recommended."""

    acceleration: float  # [m/s²]
    jerk: float | None  # [m/s³]
    position_gain: float | None = None  # Kv [1/s]
    velocity_gain: float | None = None  # Kp [N s/m]
    integral_time: float | None = None  # Tn [s]
    setpoint_filter: SetpointFilter | None = None  # behind the setpoint generator; None: none


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """The cascade as the profile states it; None means "left out: tune it and print it"."""

    kind: ControlKind = GENERIC  # what it lacks is neither tuned nor simulated nor exported
    position_loop: PositionLoop = PositionLoop.CONTROL  # where it closes
    position_gain: float | None = None  # Kv [1/s]
    velocity_gain: float | None = None  # Kp [N s/m]
    integral_time: float | None = None  # Tn [s]
    reference_model_time: float = 0.0  # time constant in the integral branch [s]; 0: none
    velocity_feedforward: float = 1.0  # weight [-]
    acceleration_feedforward: float = 1.0  # weight [-]
    jerk_feedforward: float = 0.0  # weight [-]
    feedforward_mass: float | None = None  # [kg]; None: moving mass at mid payload
    reference_delay: float | None = None  # τ [s]; None: chosen so that feed-forward meets feedback
    position_cycle: float = 2e-3  # [s], a whole multiple of the velocity cycle
    velocity_cycle: float = 125e-6  # [s]
    tcp_sensor: TcpSensor = TcpSensor.NONE  # second encoder
    state_feedback: StateFeedback = StateFeedback.OFF  # auto, off, or given by ``state_gains``
    state_gains: tuple[StateGain, ...] = ()  # for ``StateFeedback.GIVEN``
    setpoint_filter: SetpointFilter | None = None  # behind the generator, as given; None: no filter
    seeks_setpoint_filter: bool = False
    """Whether one is chosen together with the limits; else it is ``setpoint_filter``, or none."""
    force_filters: tuple[ForceFilter, ...] = ()  # in the set-force path, in order
    seeks_force_filters: bool = False
    """Whether those that let Kp rise are used; otherwise they are only suggested."""
    minimum_bandwidth_hz: float = 0.0
    """What tuning must at least reach, closed velocity loop, -3 dB [Hz]; 0: none."""

    @property
    def has_given_gains(self) -> bool:
        """Whether Kv, Kp or Tn are given."""
        gains = (self.position_gain, self.velocity_gain, self.integral_time)
        return any(gain is not None for gain in gains)

    @property
    def leaves_all_to_rules(self) -> bool:
        """Whether nothing of the loop is given or demanded, so nothing can be poor about it."""
        given = self.has_given_gains or self.force_filters or self.state_gains
        return not given and self.minimum_bandwidth_hz == 0.0
