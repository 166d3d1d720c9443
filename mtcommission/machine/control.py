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
    """Gain of the state-space extension on one state.

    Parameters
    ----------
    state
        Name of the plant state.
    value
        Set force per unit of that state's deviation [N/unit].
    """

    state: str
    value: float


class FilterKind(Enum):
    """Kinds of set-force filter."""

    NOTCH = "notch"
    LOW_PASS = "low_pass"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFilter:
    """One filter in the set-force path.

    Parameters
    ----------
    kind
        Notch or second-order low-pass.
    natural_frequency
        [rad/s].
    damping
        Denominator damping ratio of the low-pass, numerator damping ratio of the notch [-].
    width
        Denominator damping ratio of the notch [-]: its depth is damping / width. 1 is the widest
        without overshoot. Without effect on a low-pass.
    """

    kind: FilterKind
    natural_frequency: float
    damping: float
    width: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Today:
    """What the control holds now; None for what is not known, which is then as recommended.

    Parameters
    ----------
    acceleration, jerk
        [m/s², m/s³].
    position_gain, velocity_gain, integral_time
        Kv [1/s], Kp [N s/m], Tn [s].
    setpoint_filter
        Behind the setpoint generator; None: none.
    """

    acceleration: float
    jerk: float | None
    position_gain: float | None = None
    velocity_gain: float | None = None
    integral_time: float | None = None
    setpoint_filter: SetpointFilter | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """The cascade as the profile states it; None means "left out: tune it and print it".

    Parameters
    ----------
    kind
        Which control: what it lacks is neither tuned nor simulated nor exported.
    position_loop
        Where its position loop closes.
    position_gain
        Kv [1/s].
    velocity_gain
        Kp [N s/m].
    integral_time
        Tn [s].
    reference_model_time
        Time constant of the reference model in the integral branch [s]; 0 = none.
    velocity_feedforward, acceleration_feedforward, jerk_feedforward
        Weights [-].
    feedforward_mass
        [kg]; None: moving mass at mid payload.
    reference_delay
        τ [s]; None: chosen so that feed-forward and feedback meet.
    position_cycle, velocity_cycle
        [s]; the position cycle is a whole multiple of the velocity cycle.
    tcp_sensor
        Second encoder.
    state_feedback
        Auto, off, or given by ``state_gains``.
    state_gains
        Gains for ``StateFeedback.GIVEN``.
    setpoint_filter
        Behind the setpoint generator, as given; None: none given.
    seeks_setpoint_filter
        Whether one is chosen together with the limits; else it is ``setpoint_filter``, or none.
    force_filters
        Filters in the set-force path, in order.
    seeks_force_filters
        Whether those that let Kp rise are used; otherwise they are only suggested.
    minimum_bandwidth_hz
        What tuning must at least reach, closed velocity loop, -3 dB [Hz]; 0 = none.
    """

    kind: ControlKind = GENERIC
    position_loop: PositionLoop = PositionLoop.CONTROL
    position_gain: float | None = None
    velocity_gain: float | None = None
    integral_time: float | None = None
    reference_model_time: float = 0.0
    velocity_feedforward: float = 1.0
    acceleration_feedforward: float = 1.0
    jerk_feedforward: float = 0.0
    feedforward_mass: float | None = None
    reference_delay: float | None = None
    position_cycle: float = 2e-3
    velocity_cycle: float = 125e-6
    tcp_sensor: TcpSensor = TcpSensor.NONE
    state_feedback: StateFeedback = StateFeedback.OFF
    state_gains: tuple[StateGain, ...] = ()
    setpoint_filter: SetpointFilter | None = None
    seeks_setpoint_filter: bool = False
    force_filters: tuple[ForceFilter, ...] = ()
    seeks_force_filters: bool = False
    minimum_bandwidth_hz: float = 0.0

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
