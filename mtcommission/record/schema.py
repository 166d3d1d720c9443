"""The record's exact shape, as the project's interface states it.

All numbers are SI without suffix unless the key says otherwise (``_hz``, ``_db``, ``_deg``).
JSON knows no infinity: a settling time that was not reached, or a limit that was not set, is
null.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from mtcommission.machine.identified import Estimate, MeasuredFile, MeasuredMode, ShaperProposal
from mtcommission.messages.formula import Expression
from mtcommission.messages.message import Message

SCHEMA = 3

Words: TypeAlias = Message | str
"""What the catalogue says, or the user's own words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """Program and version, and the versions of the libraries that computed."""

    name: str
    version: str
    libraries: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The machine profile as read."""

    name: str
    sha256: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Datum:
    """One machine datum as the sheet shows it: its key in the profile, value and SI unit."""

    key: str
    value: float | str
    unit: str
    source: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeEntry:
    """A flexible mode of the plant."""

    name: str
    frequency_hz: float
    damping_ratio: float
    tcp_gain: float
    measured_gain: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantEntry:
    """The plant: x' = A x + B F_set and its outputs, rows over the states.

    Where the motor follows its setpoint, F is its acceleration and B the column of its jerk.
    """

    states: list[str]
    units: dict[str, str]
    A: list[list[float]]
    B: list[float]
    outputs: dict[str, list[float]]
    modes: list[ModeEntry]
    controllability_rank: int
    moving_mass: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """A sampled motion for the plots; ``signals`` by name (F_set, then every state and output)."""

    t: list[float]
    signals: dict[str, list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineEntry:
    """What the machine is called, and where its data come from.

    ``drive`` is ``servo``, or ``position_source`` where the motor follows its setpoint.
    """

    name: str
    axis: str
    motion: str
    source: str
    kind: str
    drive: str = "servo"

    @property
    def follows(self) -> bool:
        """Whether the motor follows its setpoint."""
        return self.drive != "servo"


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcEntry:
    """An arc of an optimal control."""

    t_start: float
    t_end: float
    control: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TouchPointEntry:
    """Where a limit is touched for a moment."""

    t: float
    limit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ProofEntry:
    """What proves a least time; null: not known."""

    t_f_lower_bound: float | None
    relative_gap: float | None
    adjoint_initial: dict[str, float]
    switching_slopes: list[float]
    switching_law_holds: bool
    terminal_jacobian_rank: int | None
    terminal_jacobian_condition: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LawEntry:
    """How well a damping-optimal control keeps its law."""

    adjoint_initial: dict[str, float]
    law_residual: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimumEntry:
    """An optimal control as `optimal --json` prints it, with its motion for the plots."""

    kind: str
    method: str
    f_max: float
    move: dict[str, float]
    limits: dict[str, float]
    t_f: float
    arcs: list[ArcEntry]
    switching_times: list[float]
    touch_points: list[TouchPointEntry]
    peaks: dict[str, float]
    terminal_error: dict[str, float]
    cost: float | None
    cost_terms: dict[str, float]
    weights: dict[str, float]
    certificate: ProofEntry | LawEntry
    series: Series


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSegment:
    """A set force and how long it acts [N or N m, s]."""

    duration: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BandEntry:
    """The fastest control to a state from which the free motion keeps the tool within the band.

    ``lower_bound`` is proved, ``gap`` is what lies between it and ``t_f``, relative to ``t_f``.
    The reference lies ``offset`` beyond the place at which the tool comes to rest [m or rad].
    """

    t_f: float
    lower_bound: float
    gap: float
    band: float
    offset: float
    segments: list[ForceSegment]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustEntry:
    """The fastest force found after which all ``machines`` of the spread keep the band.

    ``peak`` is the largest deviation afterwards, over those machines [m or rad].
    """

    t_f: float
    band: float
    offset: float
    machines: int
    peak: float
    segments: list[ForceSegment]


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimaEntry:
    """The optima of one move; ``constrained`` is null where the profile bounds no peaks.

    ``band`` is null where it was not found, ``robust`` where there is no spread, too; then
    ``remarks`` say why.
    """

    move: dict[str, float]
    time: OptimumEntry
    constrained: OptimumEntry | None
    damping: OptimumEntry | None
    band: BandEntry | None
    robust: RobustEntry | None
    remarks: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilterEntry:
    """A filter of the control in the setpoint.

    Lengths of averages [s], and a shaper's mode [Hz, -]. The filtered setpoint is the sum of
    copies, ``delays`` later [s] and times ``shares`` [-], behind the averages; ``duration`` is by
    how much it lengthens every setpoint [s].
    """

    kind: str
    time: float
    second_time: float
    frequency_hz: float
    damping_ratio: float
    delays: list[float]
    shares: list[float]
    duration: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SizesEntry:
    """Between which sizes of a move all requirements were judged [m/s or m, as the move]."""

    smallest: float
    largest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstSizeEntry:
    """The worst of all sizes of move for one requirement.

    ``value``: worst of the sizes that were looked at; ``bound``: what no size between them exceeds
    either, null where that was not proved. ``move``: its number, from 1; ``size``: velocity step or
    distance of the worst.
    """

    requirement: str
    value: float
    bound: float | None
    move: int
    size: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsEntry:
    """Limits for the control, what binds them, and where they were judged.

    ``frequency_range``: every requirement is kept where all eigenfrequencies are off by a factor
    between these two [-]; null: not even at those of the profile. ``damping_range``: likewise,
    of all damping ratios. ``valid_for``: by move; ``worst_sizes``: empty where the listed sizes
    alone count.
    """

    acceleration: float
    jerk: float
    jerk_time: float
    setpoint_filter: SetpointFilterEntry | None
    bound_by: Words
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    frequency_range: list[float] | None
    damping_range: list[float] | None
    valid_for: list[SizesEntry]
    worst_sizes: list[WorstSizeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class TodayEntry:
    """The values now in the control, judged like the recommended ones.

    ``jerk`` is null where the control has no limit of the jerk; ``jerk_time`` is then the ramp
    that was simulated. ``stated`` names those of Kv, Kp and Tn that are today's, ``basis`` says
    it as a sentence. All that was to be judged is null
    where ``failure`` says why it cannot be told, e.g. that the loop is unstable.
    """

    acceleration: float
    jerk: float | None
    jerk_time: float
    setpoint_filter: SetpointFilterEntry | None
    Kv: float
    Kp: float
    Tn: float
    stated: list[str]
    basis: Words
    failure: Message | None
    bound_by: Message | None
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float | None
    meets_requirements: bool
    keeps_reserve: bool
    frequency_range: list[float] | None
    valid_for: list[SizesEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedLimits:
    """Limits and what they reach, worst over moves and corners.

    ``keeps_reserve``: they need no more of what is allowed than recommendations may use.
    """

    acceleration: float
    jerk: float
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    meets_requirements: bool
    keeps_reserve: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedEntry(JudgedLimits):
    """Limits for the listed sizes alone: what it costs to serve every smaller move, too."""

    setpoint_filter: SetpointFilterEntry | None
    valid_for: list[SizesEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative(JudgedLimits):
    """Other limits, and why they are shown."""

    name: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleResult(Alternative):
    """A maker's or textbook's rule, in the same simulation."""

    source: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFormulaEntry:
    """One formula of the rule, and where it holds."""

    tree: Expression
    aside: Message | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStepEntry:
    """One line of the hand calculation."""

    name: Words
    formula: Expression | Message
    value: float | None
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleText:
    """The commissioning rule, in words and as a formula, with its range, applied here."""

    text: Words
    formula: list[RuleFormulaEntry]
    advice: Words
    valid_for: Words
    acceleration: float
    jerk: float
    jerk_time: float
    average: float
    chosen: Words
    bound_by: Words
    predicted_settling_time: float | None
    predicted_residual: float | None
    steps: list[RuleStepEntry]
    warnings: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class Landscape:
    """Worst case over (a, t_j): ``settling_time[i][k]`` at acceleration i, jerk time k.

    ``usage`` is the share of the force limit (and of bounded peaks and RMS force) that is used.
    """

    acceleration: list[float]
    jerk_time: list[float]
    settling_time: list[list[float | None]]
    residual_deviation: list[list[float | None]]
    usage: list[list[float | None]]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeLimitsEntry:
    """Limits for one machining mode, from a band of its own.

    Where none were found that meet all requirements with this band, ``meets_requirements`` is
    false, ``reason`` says so, and all values are null: nothing must be typed in. ``attainable``
    is then the least residual deviation that was found with all other requirements kept, i.e.
    the band that could be asked for [m]; null if there is none.
    """

    name: str
    band: float
    acceleration: float | None
    jerk: float | None
    jerk_time: float | None
    bound_by: Words
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float | None
    meets_requirements: bool
    reason: Words
    attainable: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class AttainableEntry:
    """A requirement that stands in the way: ``value`` could be met instead of ``limit``.

    All other requirements are kept then, by these limits. Names as in the verdict's checks.
    ``together_with``: the requirements that must give way, too, where none helps alone.
    """

    requirement: str
    limit: float
    value: float
    unit: str
    acceleration: float
    jerk: float
    together_with: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveSizesEntry:
    """The same limits on smaller and larger moves than the profile's, worst over the corners.

    ``way``: "recommended", "commissioning rule", or "moving average" (the setpoint filter with
    the length of one period, without a jerk limit: ``jerk`` null; only where it keeps the band
    on all smaller moves). ``size`` is the velocity step [m/s] or the distance [m]; ``own`` that
    of the profile's move. From ``full_from`` on the acceleration is reached (a²/j, or 2 a³/j²;
    null: never). The band is kept for all sizes from ``kept_from`` to ``kept_to``, about
    ``own`` (both null if not even there); an end of ``size`` means: at least so far.
    """

    way: Words
    acceleration: float
    jerk: float | None
    setpoint_filter: SetpointFilterEntry | None
    move: dict[str, float]
    own: float
    size: list[float]
    settling_time: list[float | None]
    residual_deviation: list[float | None]
    full_from: float | None
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ImprovementEntry:
    """What a single change would bring.

    ``saved`` is what the settling time is less than with the recommendation [s], ``share`` the same
    relative to that [-]. ``outcome`` says why numbers are null, or what was not judged;
    empty where all was.
    """

    name: str
    change: Words
    settling_time: float | None
    saved: float | None
    share: float | None
    meets_requirements: bool
    outcome: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsPart:
    """All about the limits.

    ``attainable`` is empty if all requirements are met, or if no single one is the obstacle.
    ``listed_only`` is null where the listed sizes alone count anyway, or where no limits are met.
    ``today`` is null where the profile does not state the values now in the control.
    ``warnings`` are part of the record's warnings, too. ``would_bring`` is empty but in a record.
    """

    recommended: LimitsEntry
    listed_only: ListedEntry | None
    today: TodayEntry | None
    modes: list[ModeLimitsEntry]
    attainable: list[AttainableEntry]
    move_sizes: list[MoveSizesEntry]
    alternatives: list[Alternative]
    rules: list[RuleResult]
    rule: RuleText
    landscape: Landscape
    search: dict[str, float]
    warnings: list[Words]
    would_bring: list[ImprovementEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """The linear nominal loop from [x_ref, v_ref, a_ref, j_ref] to the outputs."""

    A: list[list[float]]
    B: list[list[float]]
    C: list[list[float]]
    D: list[list[float]]
    dt: float
    states: list[str]
    inputs: list[str]
    outputs: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedforwardEntry:
    """Weights of the feed-forward [-], and the mass by which acceleration becomes force."""

    velocity: float
    acceleration: float
    jerk: float
    mass: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ObserverEntry:
    """The predicting observer at the velocity cycle: x̂⁺ = A x̂ + B F_set + L (y - C x̂)."""

    states: list[str]
    sensors: list[str]
    A: list[list[float]]
    B: list[float]
    C: list[list[float]]
    L: list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Margins:
    """How good a loop is; ``dynamic_stiffness`` in N/m or N m/rad."""

    gain_margin_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float
    bandwidth_hz: float | None
    dynamic_stiffness: float


@dataclass(frozen=True, slots=True, kw_only=True)
class VariantEntry(Margins):
    """The loop without or with state feedback, each with its own best limits."""

    name: Message
    used: bool
    mode_damping: dict[str, float]
    weakest_frequency_hz: float
    settling_time: float | None
    residual_deviation: float | None
    max_force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateEntry(Margins):
    """A loop that was tried with the limits that suit it best; margins and stiffness worst case.

    ``classic``: by the classic rule; ``used``: everything else in the record is about this one.
    """

    Kv: float
    Kp: float
    Tn: float
    state_feedback: bool
    settling_time: float | None
    meets_requirements: bool
    classic: bool
    used: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopCornerEntry(Margins):
    """How good the loop is in one corner of payload and spread, the nominal machine first.

    ``dynamic_stiffness`` is the least disturbance force per tool displacement over all
    frequencies [N/m, N m/rad]; ``mode_damping`` the damping ratio of each mode in the closed
    loop [-].
    """

    payload: float
    frequency_factor: float
    damping_factor: float
    mode_damping: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class DelayEntry:
    """What delays one path of the loop, all in seconds.

    ``setpoint_age`` is how old the setpoint is that is taken, ``dead_time`` whole cycles until it
    acts, ``hold`` the mean age of a held value, ``lag`` first-order lags (drive, filters);
    ``total`` their sum.
    """

    path: Message
    setpoint_age: float
    dead_time: float
    hold: float
    lag: float
    total: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JerkFeedforwardEntry:
    """The recommended limits with some weight of the jerk feed-forward, worst case.

    ``max_force`` is the largest |F_set| that the loop asks for, whatever the drive can give.
    """

    weight: float
    used: bool
    reference_delay: float
    max_force: float
    settling_time: float | None
    residual_deviation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFilterEntry:
    """A filter in the set-force path: (s² + 2 ζ ω s + ω²) / (s² + 2 d ω s + ω²), or the low-pass.

    ``natural_frequency`` is ω [rad/s], ``damping`` ζ and ``width`` d [-].
    """

    kind: str
    natural_frequency: float
    damping: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EncoderNoiseEntry:
    """What the steps of the encoder do, worst corner, either way: tool [m], set force [N]."""

    tool: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FeatureEntry:
    """Whether the kind of control has something, and where that was read.

    ``parameters`` are its names in the control; not ``verified``: printed with "(?)".
    """

    name: str
    has: bool
    parameters: str
    source: str
    verified: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopPart:
    """The controller and how good its loop is; margins with the loop cut at F_set.

    From ``kind`` to ``observer`` it is all that a second program needs beside ``plant``, defined
    in docs/feedback-loop.md. ``kind`` names the control, ``jerk`` how it limits the jerk
    (``limit``, ``time``, ``none``), ``position_loop`` where its position loop closes
    (``control``, ``interpolated``, ``drive``), ``features`` what it has. ``reference_age`` and
    ``velocity_age`` say how old the setpoint is from which wanted state and velocity are taken
    [s]. ``motion_force`` is the bound of F_set [N]; ``encoder_resolution`` 0: not stated; then
    ``encoder_noise`` is null.

    ``gain_margin_up_db`` and ``gain_margin_down_db`` say by how much the gain may rise and fall
    (null: by any amount), ``gain_margin_db`` is the smaller one. ``worst_corner`` and
    ``worst_mode_damping`` are the least favourable values over ``corners``. ``disturbance`` is
    the tool's displacement per newton (m/N, rad/(N m)) after a step of force on the line of the
    drive, by the name of the loop. ``candidates`` are the loops that were tried, soonest first,
    and ``reasons`` say why one of them is used. ``remarks`` say which rule chose what;
    ``warnings`` say what is poor about the loop, and are part of the record's warnings, too.

    Where the motor follows its setpoint there is no loop: gains, margins and stiffness are null,
    what is told of them is empty, and ``closed_loop`` still moves the axis.
    """

    kind: str
    jerk: str
    position_loop: str
    features: list[FeatureEntry]
    Kv: float | None
    Kp: float | None
    Tn: float | None
    reference_model_time: float
    reference_delay: float
    reference_age: float
    velocity_age: float
    state_feedback: dict[str, float]
    feedforward: FeedforwardEntry
    position_cycle: float
    velocity_cycle: float
    force_lag: float
    motion_force: float
    force_filters: list[ForceFilterEntry]
    encoder_resolution: float
    encoder_noise: EncoderNoiseEntry | None
    sensors: list[str]
    observer: ObserverEntry
    closed_loop: ClosedLoop
    poles: list[list[float]]
    gain_margin_db: float | None
    gain_margin_up_db: float | None
    gain_margin_down_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float | None
    bandwidth_hz: float | None
    dynamic_stiffness: float | None
    weakest_frequency_hz: float | None
    mode_damping: dict[str, float]
    candidates: list[CandidateEntry]
    reasons: list[Words]
    variants: list[VariantEntry]
    worst_corner: Margins | None
    worst_mode_damping: dict[str, float]
    corners: list[LoopCornerEntry]
    delays: list[DelayEntry]
    disturbance: Series
    jerk_feedforward: list[JerkFeedforwardEntry]
    bode: Series
    remarks: list[Words]
    warnings: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """One segment of Ruckig's profile."""

    duration: float
    jerk: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointEntry:
    """The setpoint of a move with the recommended limits."""

    duration: float
    setpoint_filter: SetpointFilterEntry | None
    segments: list[Segment]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseEntry:
    """A closed-loop response in one corner."""

    payload: float
    frequency_factor: float
    damping_factor: float
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    mode_amplitudes: dict[str, float]
    peaks: dict[str, float]
    max_force: float
    rms_force: float
    saturated: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveEntry:
    """One move with the recommended limits: nominal response, corners, motion for the plots."""

    move: dict[str, float]
    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    series: Series


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedEntry:
    """One way of doing a move, in the loop or by an optimal control on the plant."""

    name: Words
    transfer_time: float | None
    overshoot: float
    peaks: dict[str, float]
    max_force: float
    heat: float
    work: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FedForwardEntry:
    """An optimal control fed forward while the loop corrects, or the limits, on one machine."""

    control: Words
    payload: float
    frequency_factor: float
    damping_factor: float
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    saturated_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ContinuousEntry:
    """The recommended setpoint through the continuous approximation of the loop.

    The differences are relative to the sampled loop on the nominal machine, by which all is
    judged [-]; null where a loop does not settle.
    """

    settling_time: float | None
    residual_deviation: float
    settling_difference: float | None
    residual_difference: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonEntry:
    """One move in the loop and by its optima.

    ``claims`` measure the two claims of the paper, terminal overshoot and a transfer time much
    larger than the least one, a sentence each for the rectangular and the trapezoidal setpoint;
    ``why_not_the_optimum`` says what each optimum does when it is fed forward.
    """

    controls: list[ComparedEntry]
    fed_forward: list[FedForwardEntry]
    claims: list[Words]
    why_not_the_optimum: list[Words]
    continuous: ContinuousEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against what was found; ``value`` null = not settled.

    ``reserve`` is the share of the limit that a recommendation may use [-]; 1: all of it.
    """

    name: str
    value: float | None
    limit: float
    reserve: float
    unit: str
    met: bool
    where: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentPart:
    """The verdict."""

    met: bool
    checks: list[Check]
    obstacle: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationPart:
    """What ``simulate`` prints: the first move's setpoint and response, and all moves.

    ``warnings`` say what is poor about the loop.
    """

    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    moves: list[MoveEntry]
    warnings: list[Words]
    assessment: AssessmentPart


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantile:
    """The least value that so many of the samples do not exceed; null: not settled."""

    share: float
    value: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class HistogramEntry:
    """Samples between ``edges[i]`` and ``edges[i + 1]``: ``counts[i]``.

    One bin without width where all samples are alike; empty where none settles.
    """

    edges: list[float]
    counts: list[int]


@dataclass(frozen=True, slots=True, kw_only=True)
class DistributionEntry:
    """One quantity over the samples, in ``unit``.

    ``quantiles`` are over all samples (share 0: the least, 1: the largest), the histogram over
    those that settle; ``not_settled`` counts the others.
    """

    unit: str
    quantiles: list[Quantile]
    histogram: HistogramEntry
    not_settled: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleEntry:
    """One machine that was drawn [kg, -, -], and what the limits do on it [s, m]."""

    payload: float
    frequency_factor: float
    damping_factor: float
    settling_time: float | None
    residual_deviation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class MonteCarloEntry:
    """The recommended limits on machines drawn from the stated spread.

    Payload, frequency factor and damping factor are drawn uniformly and independently.
    ``share_met``: of samples that keep every requirement (band, settling time, force, peaks,
    RMS force); ``share_in_band``: the band alone [-]. ``worst`` has the largest residual
    deviation, ``slowest`` the longest settling time; worst over the moves each.
    """

    samples: int
    seed: int
    share_met: float
    share_in_band: float
    settling_time: DistributionEntry
    residual_deviation: DistributionEntry
    worst: SampleEntry
    slowest: SampleEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyErrorEntry:
    """The recommended limits where all eigenfrequencies are off by a common factor [-].

    Settling time [s] and residual deviation [m], worst over moves and over the ends of payload
    and damping. Every requirement is kept from ``kept_from`` to ``kept_to`` (both null if not
    even at factor 1); an end that is the first or last ``factor`` may lie further out.
    """

    factor: list[float]
    settling_time: list[float | None]
    residual_deviation: list[float | None]
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingErrorEntry:
    """The recommended limits where all damping ratios are off by a common factor [-].

    ``factor``: those looked at; ``kept_from`` and ``kept_to`` as for the frequencies.
    """

    factor: list[float]
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SensitivityEntry:
    """What a small change of limits or machine costs, worst over moves and corners.

    ``change`` is e.g. "jerk +10 %"; values after it [s, m] and relative to before [-]; null:
    not settled.
    """

    change: Words
    settling_time: float | None
    residual_deviation: float | None
    settling_change: float | None
    residual_change: float | None
    meets_requirements: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessPart:
    """How the recommended limits fare where machine or limits differ a little.

    ``monte_carlo`` is null where the profile states neither spread nor a range of payload.
    ``warnings`` say on what unstated knowledge the verdict hangs; they are part of the record's
    warnings, too.
    """

    monte_carlo: MonteCarloEntry | None
    frequency_error: FrequencyErrorEntry
    damping_error: DampingErrorEntry
    sensitivities: list[SensitivityEntry]
    warnings: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpreadEntry:
    """What the corners must hold [-], and why; ``because`` is empty where only a profile tells."""

    frequency: float
    damping: float
    because: list[Message]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredStateEntry:
    """One state of the machine: position, payload or level; its modes have the axis' names."""

    name: str
    moving_mass: Estimate | None
    modes: list[MeasuredMode]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponseEntry:
    """Measured points of a response or of a spectrum, and the curve that was fitted.

    ``magnitude`` and ``error`` (standard error of real and imaginary part) in ``unit``; ``missed``:
    distance of point and curve in that error. A spectrum has no such error and no phase, and its
    scale means nothing.
    """

    name: str
    unit: str
    misfit: float | None
    frequency_hz: list[float]
    magnitude: list[float]
    error: list[float] | None
    phase_deg: list[float] | None
    coherence: list[float] | None
    missed: list[float] | None
    curve_hz: list[float]
    curve_magnitude: list[float]
    curve_phase_deg: list[float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordCheckEntry:
    """Share of a record's power in the band that the identified model explains."""

    record: str
    explained: float
    held_back: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolSensorEntry:
    """What a sensor at the tool could free: the settling time where the modes stand still there.

    ``modes`` are those whose share at the tool was assumed; ``least`` is null where no limits meet
    the requirements even then.
    """

    modes: list[str]
    settling_time: float | None
    least: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedPart:
    """What was measured on the axis.

    ``formats`` (by name of a source), ``states``, ``responses``, ``checks`` and ``warnings`` come
    from the file beside the profile; without it they are empty, and the warnings say so.
    """

    created: str
    rotary: bool
    base_excited: bool
    sources: list[MeasuredFile]
    formats: dict[str, Message]
    band_hz: list[float] | None
    moving_mass: Estimate | None
    delay: Estimate | None
    lag: Estimate | None
    modes: list[MeasuredMode]
    states: list[MeasuredStateEntry]
    spread: SpreadEntry
    misfit: float | None
    checks: list[RecordCheckEntry]
    warnings: list[Message]
    responses: list[MeasuredResponseEntry]
    tool_sensor: ToolSensorEntry | None = None
    proposals: list[ShaperProposal] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class SampledEntry:
    """The nominal loop at the velocity cycle, for whoever closes it on other machines.

    X over ``states``: the plant's first, F_set at ``pending``, what the position cycle hands down
    from ``held`` on. X⁺ = ``cycle`` X in a velocity cycle; after ``cycles`` of these the states
    from ``held`` on become ``by_state`` X, X from before them, plus ``by_setpoint`` times (x_ref,
    v_ref, a_ref, j_ref) at that time, then one position cycle earlier, and so on. Where the motor
    follows, what is handed down are its position, velocity, acceleration and jerk.
    """

    follows: bool
    velocity_cycle: float
    cycles: int
    reference_delay: float
    states: list[str]
    pending: int
    held: int
    cycle: list[list[float]]
    by_state: list[list[float]]
    by_setpoint: list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedModeEntry:
    """Where a mode stands in the plant; payload p divides its terms by 1 + p ``payload_share``."""

    deflection: int
    rate: int
    payload_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalEntry:
    """A row over the plant's states; ``bound`` is null where nothing bounds its magnitude."""

    name: str
    unit: str
    bound: float | None
    row: list[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedPlantEntry:
    """The nominal plant, and what payload, frequency and damping change in it.

    The force moves the state ``velocity`` by 1/(``moving_mass`` + payload); where the motor
    follows, the last state is its acceleration and B the jerk's. ``signals``: the motor's force,
    then what ``requirements.peaks`` bounds.
    """

    A: list[list[float]]
    B: list[float]
    tcp: list[float]
    signals: list[SignalEntry]
    position: int
    velocity: int
    moving_mass: float
    modes: list[VariedModeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class NoisyCornerEntry:
    """A corner, and what the steps of the encoder add there either way [m, N]."""

    payload: float
    frequency_factor: float
    damping_factor: float
    tool_noise: float
    force_noise: float


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedsEntry:
    """What moves are judged by; null: not asked for. ``every_size``: smaller moves count, too."""

    tcp_deviation: float
    max_settling_time: float | None
    contour_deviation: float | None
    contour_feed: float | None
    motion_force: float
    continuous_force: float | None
    static_load: float
    every_size: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownLimitsEntry:
    """Limits to begin with: ``today`` or ``recommended``; ``loop`` where it is another one."""

    name: str
    acceleration: float
    jerk: float
    setpoint_filter: SetpointFilterEntry | None
    loop: SampledEntry | None


@dataclass(frozen=True, slots=True, kw_only=True)
class WhatIfPart:
    """All that it takes to run other limits, moves and machines through the loop again.

    ``jerk``: how the control limits the jerk (``limit``, ``time``, ``none``); ``averages``: from
    which to which length it can set a moving average [s]; null: it has none.
    """

    jerk: str
    loop: SampledEntry
    plant: VariedPlantEntry
    corners: list[NoisyCornerEntry]
    moves: list[dict[str, float]]
    requirements: NeedsEntry
    limits: list[KnownLimitsEntry]
    force_filters: list[ForceFilterEntry]
    averages: list[float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """A whole commissioning; ``checksum`` is the SHA-256 of all the rest.

    ``what_if`` is null where no loop was closed.
    """

    schema: int
    checksum: str
    tool: Tool
    created: str
    profile: Profile
    machine: MachineEntry
    data: list[Datum]
    settings: dict[str, float | str]
    assumptions: list[Words]
    warnings: list[Words]
    plant: PlantEntry
    optima: list[OptimaEntry]
    limits: LimitsPart
    loop: LoopPart
    moves: list[MoveEntry]
    comparisons: list[ComparisonEntry]
    robustness: RobustnessPart
    assessment: AssessmentPart
    identified: IdentifiedPart | None = None
    what_if: WhatIfPart | None = None
