"""English texts of the sheet; another language is one more file that replaces them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

from mtcommission.sheet.phrases import Phrases, polish, replace_words, translate

NAMES: Mapping[str, str] = MappingProxyType(
    {
        "F_set": "Set force F_set",
        "F": "Force F",
        "tcp": "Tool centre point",
        "tcp_vibration": "Elastic deflection at the tool",
        "x_b": "Base position x_b",
        "x_s": "Slider position x_s",
        "phi": "Tower rotation φ",
        "v_b": "Base velocity v_b",
        "v_s": "Slider velocity v_s",
        "v_phi": "Tower rotation rate v_φ",
        "x": "Position x",
        "v": "Velocity v",
        "t_f_lower_bound": "Proven lower bound of t_f",
        "relative_gap": "Relative gap to the lower bound",
        "adjoint_initial": "Adjoint at t = 0",
        "switching_slopes": "Slope of the switching function at each switch",
        "switching_law_holds": "Switching law holds on the whole interval",
        "terminal_jacobian_rank": "Rank of the Jacobian of the terminal conditions",
        "terminal_jacobian_condition": "Its condition number, scaled",
        "law_residual": "Largest deviation from the control law, relative to F_max",
        "tcp_deviation": "Permitted TCP deviation (band)",
        "tcp_gain": "Gain at the tool",
        "measured_gain": "Gain at the encoder",
        "tcp_height": "TCP height h, signed",
        "force_lag": "Time constant of the force loop T",
        "Kv": "Position gain Kv",
        "Kp": "Velocity gain Kp",
        "Tn": "Integral time Tn",
    }
)
"""Keys and signals whose names do not follow from their spelling."""

ROTARY_WORDS: Phrases = (
    (r"cable forces", "cable drag"),
    (r"The axis is linear: a rigid mass", "The axis is taken as a linear system: a rigid body"),
    (r"(?i)force on the line of the drive", "torque about the axis of the drive"),
    (r"Displacement of the tool per force", "Rotation of the tool per torque"),
    (
        r"laser interferometer or accelerometer at the tool",
        "angle measuring device, or accelerometer at a known radius",
    ),
    (r"\bforce(s?)\b", r"torque\1"),
    (r"\bForce(s?)\b", r"Torque\1"),
    (r"\bmass\b", "moment of inertia"),
    (r"\bMass\b", "Moment of inertia"),
    (r"\bdistance\b", "angle"),
    (r"\bDistance\b", "Angle"),
    (r"(?<=\d) kg\b(?!·| m)", " kg·m²"),
)
"""What is said otherwise on a rotary axis; names in the profile stay as they are spelled."""

UNTURNED = ("language", "decimal_mark", "phrases", "rotary_words", "words")
"""Fields that are not words of the sheet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Labels:
    """Texts of the sheet; the defaults are English. Braces take values already formatted."""

    language: str = "en"
    decimal_mark: str = "."
    names: Mapping[str, str] = field(default_factory=lambda: NAMES)
    phrases: Phrases = ()
    original: str = "{text}"
    rotary_words: Phrases = ROTARY_WORDS
    words: Phrases = ()

    # the printers' own words
    title: str = "Commissioning sheet"
    axis: str = "axis"
    identity: str = "Profile {name}, SHA-256 {hash}"
    disclaimer: str = "Calculated record, not an acceptance test."
    contents: str = "Contents"
    skip: str = "Skip to the verdict"
    page: str = "page"
    script_note: str = (
        "Plots: drag to zoom, double-click to reset, move the pointer (or the arrow keys) to "
        "read values. Without JavaScript the plots are in the PDF."
    )

    # words
    yes: str = "yes"
    no: str = "no"
    met: str = "met"
    not_met: str = "NOT MET"
    not_settled: str = "not settled"
    unlimited: str = "unlimited"
    no_jerk_limit: str = "no limit"
    none: str = "None."
    move: str = "Move {number}"
    velocity_step: str = "velocity step {velocity}"
    positioning: str = "positioning by {distance}"
    positioning_limited: str = "positioning by {distance} at up to {velocity}"
    quantity: str = "Quantity"
    value: str = "Value"
    key: str = "Key in the profile"
    source: str = "Source"
    acceleration: str = "Acceleration"
    jerk: str = "Jerk"
    jerk_time: str = "Jerk time"
    settling_time: str = "Settling time"
    residual: str = "Residual deviation"
    peak_deviation: str = "Peak deviation"
    time: str = "Time"
    frequency: str = "Frequency"
    damping_ratio: str = "Damping ratio"
    velocity: str = "Velocity"

    # 1 verdict
    verdict_heading: str = "Verdict and values to enter"
    verdict_met: str = "All requirements met"
    verdict_not_met: str = "Requirements NOT met"
    values_bound_by: str = "Bound by: {bound}"
    obstacle: str = "What stands in the way: {obstacle}"
    result_caption: str = "Result with these limits, worst move and worst corner"
    of_band: str = "{value}, {percent} of the permitted {band}"
    no_residual: str = "not settled; permitted {band}"
    reference: str = (
        "{move}: time-optimal reference, exact rest: {optimum}; "
        "recommended: {settling} ({more} more)."
    )
    reference_unsettled: str = (
        "{move}: time-optimal reference, exact rest: {optimum}; recommended: not settled."
    )
    reference_faster: str = (
        "{move}: time-optimal reference, exact rest: {optimum}; recommended: {settling}, "
        "{less} less, since it is judged by the band and not by exact rest."
    )
    reference_bounded: str = (
        "With its peaks bounded the reference takes {optimum}; the recommendation: {change}."
    )
    reference_composed: str = "{optimum} (composed with a cruise; proved: not below {bound})"
    reference_note: str = (
        "The reference moves the nominal machine to exact rest with ideal control; the "
        "recommendation is settled when the tool stays within the permitted deviation."
    )
    first_look_caption: str = "{move}: setpoint, response and TCP deviation, nominal machine"
    first_look_alt: str = (
        "Acceleration of setpoint and response, and TCP deviation over time: at most {peak}, "
        "settled after {settling}."
    )
    checks_caption: str = "Requirements"
    data_source: str = "Source of the machine data: {source}"
    warning_count: str = "Warnings: {count}, see the section on certificates and assumptions."
    further_warnings: str = (
        "Further warnings: {count}, see the section on certificates and assumptions."
    )
    check: str = "Requirement"
    found: str = "Found"
    permitted: str = "Permitted"
    verdict: str = "Verdict"
    where: str = "Worst case"

    warning: str = "Warning: {warning}"
    could_be_met: str = "Could be met: {requirement} {value} instead of {limit}."
    sparkline: str = "Acceleration setpoint, {move}, {duration}:"

    # 2 machine
    machine_heading: str = "Machine and axis"
    data_caption: str = "Data as calculated with"
    machine_row: str = "Machine"
    axis_row: str = "Axis"
    motion_row: str = "Motion"
    linear: str = "linear"
    rotary: str = "rotary"
    rigid_caption: str = "Rigid axis"
    moving_mass: str = "Moving mass"
    controllability: str = "Controllability: rank of the Kalman matrix"
    of_states: str = "{rank} of {count} states"
    modes_caption: str = "Modes of the structure (control off)"
    mode: str = "Mode"
    tcp_gain: str = "Gain at the tool"
    measured_gain: str = "Gain at the encoder"
    of_mode: str = "{name} of mode {mode}"
    peak_bound: str = "{name}, largest magnitude"
    requirements_heading: str = "Moves and requirements"
    requirements_caption: str = "What is required"

    # 3 limits
    limits_heading: str = "Recommended limits"
    machining_caption: str = "Limits by machining mode, each from a band of its own"
    machining_mode: str = "Machining mode"
    machining_names: Mapping[str, str] = field(
        default_factory=lambda: {
            "surface": "Surface (finishing)",
            "accuracy": "Accuracy",
            "speed": "Speed (roughing)",
        }
    )
    permitted_band: str = "Band"
    bound_by_column: str = "Bound by"
    attainable: str = "Could be met"
    attainable_caption: str = (
        "What could be met instead, each by itself or with those it names, all others kept"
    )
    attainable_band: str = "{reason}; a band of {band} could be met"
    alternatives_caption: str = "Recommendation and alternatives, in the same simulation"
    limits_name: str = "Limits"
    recommended: str = "Recommended"
    rule_heading: str = "Commissioning rule, applied by hand"
    rule_valid: str = "Valid for: {range}"
    rule_result: str = (
        "By hand: a = {acceleration}, j = {jerk} (ramp: {chosen}; bound by: {bound}), predicted "
        "residual deviation {residual}. The search needs no rule; this is to check it with a "
        "calculator."
    )
    rule_steps_caption: str = "The rule, step by step"
    rule_symbols_caption: str = "Symbols of the rule (index i: a mode; values by mode: {modes})"
    rule_symbols: Mapping[str, str] = field(
        default_factory=lambda: {
            "a": "Acceleration by the rule",
            "j": "Jerk by the rule",
            "t_j": "Jerk time by the rule, a/j",
            "band": "Permitted TCP deviation",
            "F": "Force left for motion",
            "v": "Change of velocity, or largest velocity, of each move",
            "L": "Length of each positioning move",
            "m": "Moving mass; in the force condition with the largest payload",
            "m_ff": "Mass in the feed-forward",
            "T": "Time constant of the force loop",
            "f": "Natural frequency of a mode",
            "omega": "Natural angular frequency of a mode",
            "zeta": "Damping ratio of a mode",
            "g": "Share of a mode at the tool, by itself or beside the encoder; the larger one",
            "c": "Share of a mode at the encoder",
            "R": "Share of a mode's vibration that a ramp leaves",
            "x": "Length of a ramp in periods of a mode, f t_j",
            "i": "Imaginary unit (as an index: number of the mode)",
        }
    )
    symbol: str = "Symbol"
    meaning: str = "Meaning"
    rule_step: str = "Step"
    rule_how: str = "Formula"
    rules_heading: str = "Comparison with rules of thumb"
    rules_caption: str = (
        "Rules of makers and textbooks, in the same simulation (worst move, worst corner)"
    )
    rule: str = "Rule"
    meets: str = "All met"
    compare_caption: str = (
        "Settling time against residual deviation: recommendation, alternatives and rules"
    )
    compare_alt: str = (
        "Each point is one choice of limits; further left settles sooner, further down vibrates "
        "less. Recommended: {settling} and {residual}. The numbers are in the tables."
    )
    unsettled_rules: str = "Not settled, so not in the plot: {names}."
    band: str = "band {band}"
    landscape_heading: str = "Landscape of the settling time"
    landscape_caption: str = "Worst settling time over acceleration and jerk time"
    landscape_alt: str = (
        "Map of {rows} accelerations by {columns} jerk times; settling times from {least} to "
        "{most}; the chosen point is at {acceleration} and {jerk_time}."
    )
    chosen: str = "chosen"
    residual_border: str = "residual deviation = band {band}"
    usage_border: str = "force, RMS force or a bounded peak just reached"
    hatched: str = "{caption} (hatched: not settled)"

    # compared with another record
    differences_heading: str = "Changes since the earlier record"
    compared_with: str = (
        "Compared with: {machine}, axis {axis}, calculated on {created}, profile {name}, "
        "SHA-256 {hash}."
    )
    changed_inputs: str = "Machine, moves and requirements: what changed"
    no_changed_inputs: str = "Machine, moves and requirements are the same in both records."
    changed_limits: str = "Limits, before and after"
    changed_result: str = "Result, before and after"
    changed_loop: str = "Control loop, before and after"
    before: str = "Before"
    after: str = "After"
    change: str = "Change"
    changed: str = "changed"
    unchanged: str = "same"
    not_stated: str = "not stated"
    state_feedback_used: str = "State feedback"

    # 4 motion
    motion_heading: str = "Optimum, recommendation and response"
    drive_caption: str = "{move}: force, acceleration and velocity"
    vibration_caption: str = "{move}: vibration and TCP deviation"
    motion_alt: str = (
        "Curves over time of {signals}. Set force of the response at most {force}; the tool "
        "is at most {peak} off the setpoint and settled after {settling}."
    )
    motion_note: str = (
        "All plots of a move share the time axis. Optima end in exact rest at t_f; the "
        "acceleration shown for them and for the response is F/m. The setpoint is shown as "
        "commanded; the deviation is counted from the setpoint delayed by {delay}."
    )
    time_optimal: str = "time-optimal"
    constrained: str = "time-optimal, bounded"
    damping_optimal: str = "damping-optimal"
    setpoint: str = "setpoint"
    response: str = "loop response"
    deviation: str = "TCP deviation"
    peaks_caption: str = "{move}: largest magnitudes"
    signal_head: str = "Signal"
    mode_deflection: str = "Deflection of mode {mode}"
    mode_rate: str = "Rate of mode {mode}"
    amplitudes_caption: str = "{move}: amplitudes at the tool after the setpoint ends"
    amplitude: str = "Amplitude"
    setpoint_caption: str = "{move}: segments of the setpoint"
    duration: str = "Duration"
    segment: str = "Segment"
    moving_average: str = "Moving-average filter of the control: {time}."

    comparison_heading: str = "Comparison with the optimal controls"
    comparison_note: str = (
        "Nominal machine. In the loop, the transfer time is the settling time; an optimal control "
        "ends in exact rest. Overshoot is that of the tool's velocity (velocity step) or position "
        "(positioning), relative to the target. Heat is the integral of the squared motor force."
    )
    controls_caption: str = "{move}: ways of doing the move"
    control: str = "Control"
    transfer_time: str = "Transfer time"
    overshoot: str = "Overshoot"
    peak_of: str = "Peak of {name}"
    heat: str = "Heat"
    work: str = "Work"
    fed_forward_caption: str = (
        "{move}: the optimal control itself fed forward, on the machine and on one that is "
        "a little different"
    )
    saturated_share: str = "Time without force left"
    continuous_check: str = (
        "Cross-check: the same setpoint through a continuous approximation of the loop settles "
        "after {settling} (sampled loop: {sampled}; {settling_difference}), residual deviation "
        "{residual} ({residual_difference})."
    )
    continuous_unsettled: str = (
        "Cross-check: in a continuous approximation of the loop the same setpoint does not settle "
        "(sampled loop: {sampled}); here it is no check, and nothing is judged by it."
    )

    claims: str = (
        "The paper says that a setpoint in a feedback loop overshoots at the end and takes much "
        "longer than the least time. Measured here:"
    )
    why_not: str = "Why the optimum is not simply entered:"

    # 5 loop
    loop_heading: str = "Control loop"
    diagram_caption: str = "Structure of the loop"
    diagram_alt: str = (
        "Block diagram: position controller {kv}, velocity controller {kp} with integral time "
        "{tn}, feed-forward of velocity, acceleration and jerk, force limit and force loop, "
        "mechanics, feedback of the encoder. State feedback: {feedback}."
    )
    diagram_delay: str = "Delay"
    diagram_cycle: str = "cycle {cycle}"
    diagram_late: str = "acts {time} late"
    diagram_mechanics: str = "Mechanics"
    diagram_modes: str = "modes: {count}"
    diagram_observer: str = "Observer"
    diagram_gains: str = "gains: {count}, see table"
    gains_caption: str = "Gains"
    margins_caption: str = "Stability, loop cut at the set force"
    margin: str = "Margin"
    nominal: str = "Nominal machine"
    worst_corner: str = "Worst corner"
    gain_margin: str = "Gain margin"
    gain_margin_up: str = "Gain may rise by"
    gain_margin_down: str = "Gain may fall by"
    bandwidth_short: str = "Bandwidth"
    stiffness_short: str = "Least dynamic stiffness"
    loop_corners_caption: str = "The loop in every corner of payload and spread"
    disturbance_caption: str = "Response of the tool to a step of force on the line of the drive"
    disturbance_alt: str = (
        "Displacement of the tool per force over time, one curve for each loop. Largest values: "
        "{largest}."
    )
    deflection: str = "Displacement of the tool per force"
    delays_caption: str = "Delays in each path of the loop"
    path: str = "Path"
    setpoint_age: str = "Age of the setpoint"
    dead_time: str = "Dead time (whole cycles)"
    hold: str = "Mean age of the held value"
    lag: str = "Lags (drive, filters)"
    total: str = "Sum"
    jerk_feedforward_caption: str = (
        "What the jerk feed-forward changes, recommended limits, worst case"
    )
    jerk_weight: str = "Weight of the jerk feed-forward"
    wanted_force: str = "Set force wanted, peak"
    phase_margin: str = "Phase margin"
    sensitivity_peak: str = "Sensitivity peak"
    bandwidth: str = "Bandwidth of the velocity loop (−3 dB)"
    reference_delay: str = "Reference delay τ"
    feedforward: str = "Feed-forward: {name}"
    state_feedback: str = "State feedback from {name}"
    no_state_feedback: str = "No state feedback."
    sensors: str = "Sensors: {names}."
    observed: str = "Observed states: {names}."
    position_cycle: str = "Position cycle"
    velocity_cycle: str = "Velocity cycle"
    variants_caption: str = "The loop with and without state feedback, each with its best limits"
    variant_used: str = "{name} (used)"
    damping_of: str = "Damping of mode {mode}"
    dynamic_stiffness: str = "Least dynamic stiffness at the tool"
    stiffness_at: str = "{stiffness} at {frequency}"
    bode_caption: str = "Frequency response: open loop (cut at the set force), closed velocity loop"
    bode_alt: str = (
        "Magnitude and phase over frequency. Gain margin {gain}, phase margin {phase}, "
        "bandwidth of the velocity loop {bandwidth}."
    )
    magnitude: str = "Magnitude in dB"
    phase: str = "Phase in °"
    open_loop: str = "open loop"
    closed_velocity: str = "closed velocity loop"
    poles_caption: str = "Poles of the closed loop, slowest first"
    real_part: str = "Real part"
    remarks: str = "Remarks"
    corners_caption: str = "{move}: response in every corner"
    payload: str = "Payload"
    frequencies: str = "Frequencies"
    dampings: str = "Damping"
    max_force: str = "Largest set force"
    rms_force: str = "RMS force"
    saturated: str = "Saturated"

    # robustness
    robustness_heading: str = "Robustness"
    kept_between: str = (
        "With all eigenfrequencies off by a common factor, every requirement is kept from {low} "
        "to {high}."
    )
    at_least: str = "at least {value}"
    kept_nowhere: str = (
        "The requirements are not kept even with the eigenfrequencies of the profile, so there is "
        "no frequency error to allow."
    )
    frequency_error: str = "Error of all eigenfrequencies in %"
    frequency_error_caption: str = (
        "Residual deviation and settling time over the error of the eigenfrequencies, worst "
        "payload and damping"
    )
    frequency_error_alt: str = (
        "Two curves over the common error of all eigenfrequencies. The residual deviation lies "
        "between {least} and {most}; permitted are {band}."
    )
    residual_error_caption: str = (
        "Residual deviation over the error of the eigenfrequencies, worst payload and damping"
    )
    residual_error_alt: str = (
        "A curve over the common error of all eigenfrequencies. The residual deviation lies "
        "between {least} and {most}; permitted are {band}."
    )
    no_settling_curve: str = (
        "The axis settles with none of the errors of the eigenfrequencies that were tried, {low} "
        "to {high}; so there is no curve of the settling time."
    )
    no_error_curves: str = (
        "The axis settles with none of the errors of the eigenfrequencies that were tried, {low} "
        "to {high}; so there are no curves of residual deviation and settling time."
    )
    nothing_drawn: str = (
        "The profile states no spread of frequency or damping and no range of payload, so no "
        "machines were drawn at random."
    )
    drawn: str = (
        "{samples} machines drawn from the stated spread (payload, frequencies and damping each "
        "uniform and independent; seed {seed}): {met} keep every requirement, {band} the band."
    )
    machines: str = "Machines drawn"
    least: str = "least"
    largest: str = "largest"
    share_of_machines: str = "{share} are not above"
    quantiles_caption: str = "Distribution over the machines drawn, worst move"
    histogram_caption: str = "{name} of the machines drawn"
    histogram_alt: str = (
        "Histogram: values from {low} to {high}; most machines, {most}, about {place}."
    )
    worst_machine: str = "largest residual deviation"
    slowest_machine: str = "longest settling time"
    extremes_caption: str = "The worst of the machines drawn"
    sensitivities_caption: str = "What a small change costs, worst move and worst corner"
    what_changes: str = "What changes"

    # other sizes of move
    sizes_heading: str = "Smaller and larger moves"
    sizes_note: str = (
        "A small move ends before the acceleration is reached; its ramps are shorter then and "
        "cancel no vibration. The table says for which moves the same limits keep the band "
        "(worst corner). A moving average of one period, if the control has one, cancels the "
        "vibration whatever the move; it is shown where it keeps the band on all smaller moves."
    )
    sizes_caption: str = "{move}: for which sizes the limits hold"
    filter_time: str = "Moving average"
    full_from: str = "Acceleration reached from"
    kept_from: str = "Band kept from"
    kept_to: str = "Band kept to"
    never: str = "never"
    nowhere: str = "nowhere"
    or_less: str = "{value} or less"
    or_more: str = "{value} or more"
    sizes_plot_caption: str = "{move}: residual deviation over the size of the move, worst corner"
    sizes_plot_alt: str = (
        "Residual deviation over the size of the move, a curve for each of: {ways}. "
        "Permitted are {band}."
    )

    # 6 evidence
    evidence_heading: str = "Certificates and assumptions"
    certificate_caption: str = "{move}: {what}"
    final_time: str = "Final time t_f"
    method: str = "Method"
    cost: str = "Cost"
    switches: str = "Switching times"
    largest_error: str = "Largest terminal error, relative to the peak of its state"
    weights: str = "Weights"
    assumptions: str = "Assumptions"
    warnings: str = "Warnings"
    settings_caption: str = "Numerical settings: {names}"
    setting_names: Mapping[str, str] = field(
        default_factory=lambda: {
            "gain_margin_db": "Gain margin demanded",
            "phase_margin_deg": "Phase margin demanded",
            "reserve_deg": "Phase kept in reserve for the state feedback",
            "sensitivity_peak": "Sensitivity peak allowed",
            "mode_weights": "Weights of the mode tried for the state feedback",
            "reduction": "Factor from one try of Kp to the next",
            "force_noise": "Force noise of the observer, relative to F_max",
            "position_noise": "Encoder noise of the observer",
            "least_acceleration": "Least acceleration, relative to F_max/m",
            "least_jerk_time": "Shortest jerk time",
            "longest_jerk_time": "Longest jerk time, in periods of the slowest mode",
            "slow_jerk_time": "Longest jerk time on a stiff axis, at least",
            "grid": "Grid points in each direction",
            "coarse_grid": "Grid points at which the force is simulated",
            "seeds": "Cells refined at once",
            "refinements": "Refinements, each halves a cell",
            "digits": "Significant digits of the result",
            "samples": "Machines drawn, at most",
            "sample_cycles": "Position cycles simulated over all machines drawn, at most",
            "seed": "Seed of the random numbers",
            "frequency_range": "Largest frequency error tried, relative",
            "frequency_points": "Frequency errors tried",
            "landscape": "Points of the map in each direction",
            "largest_fraction": "Largest factor on Kp tried with state feedback",
            "mode_noise": "Mode noise of the observer, relative to F_max",
            "evaluations": "Limits judged in every corner",
        }
    )
    setting: str = "Setting"
    versions_heading: str = "Versions and profile"
    versions_caption: str = "Calculated with"
    program: str = "Program"
    version: str = "Version"
    created: str = "Calculated on"
    hash_row: str = "SHA-256 of the profile"
    profile_caption: str = "Profile {name} as read"

    # measurements
    measure_heading: str = "Measurements to make on the machine"
    measure_note: str = (
        "The values are those of the nominal machine without payload. If a frequency lies outside "
        "its permitted range, correct the profile and calculate again before using the limits. "
        "Moves: {moves}."
    )
    measure_how: tuple[str, ...] = (
        "Frequencies and damping ratios: impact hammer and accelerometer at the tool, or frequency "
        "response of the drive; control off, brake released, at the middle of the travel.",
        "Moving mass: motor force over acceleration while the acceleration is constant, friction "
        "taken off by the mean of both directions.",
        "Margins and bandwidth: frequency response by the control's own measuring function, loop "
        "cut at the set force.",
        "Deviations and settling time: laser interferometer or accelerometer at the tool, with "
        "the limits of this sheet, counted from the end of the setpoint and the delayed setpoint.",
        "Forces: trace of the drive (force or current setpoint).",
    )
    measure_caption: str = "Calculated and measured values"
    measurement: str = "Measurement"
    calculated: str = "Calculated"
    measured: str = "Measured"
    difference: str = "Difference"
    measured_by: str = "Date, name"
    measure_fields: tuple[str, ...] = (
        "Measuring instruments (type, number, calibrated until)",
        "State of the machine (position of the other axes, payload, temperature)",
    )

    # 7 entry and signature
    entry_heading: str = "Parameters for the control"
    entry_caption: str = "Values for the control"
    parameter: str = "Parameter"
    also: str = "In other units"
    old_value: str = "Old value"
    new_value: str = "New value"
    entered_by: str = "Entered by"
    verified: str = "Verified"
    entry_note: str = "Verify before use. Never round the jerk up or the jerk time down."
    signature_heading: str = "Signature"
    signed_values: str = "{machine}, axis {axis}: acceleration {acceleration}, jerk {jerk}."
    signature_fields: tuple[str, ...] = (
        "Machine number, place",
        "Entered on the control (date, name, signature)",
        "Verified at the machine (date, name, signature)",
        "Remarks",
    )

    def for_rotary(self) -> Labels:
        """Return the texts of a rotary axis, which has torques for forces.

        Examples
        --------
        >>> rotary = Labels().for_rotary()
        >>> rotary.max_force, rotary.say("RMS force"), rotary.name("moving_mass")
        ('Largest set torque', 'RMS torque', 'Moving moment of inertia')
        """
        texts = {item.name: getattr(self, item.name) for item in fields(self)}
        turned: dict[str, Any] = {
            name: _turned(value, self.rotary_words)
            for name, value in texts.items()
            if name not in UNTURNED
        }
        return replace(self, words=self.rotary_words, **turned)

    def say(self, text: str) -> str:
        """Return a sentence of the record in this language, or marked as original text.

        Examples
        --------
        >>> Labels(phrases=[("slow", "langsam")], original="{text} [?]").say("fast")
        'fast [?]'
        """
        found = translate(text, self.phrases, decimal_mark=self.decimal_mark)
        if found is None and text:
            found = self.original.format(text=text)
        return replace_words(polish(found or text), self.words)

    def say_if_known(self, text: str) -> str:
        """Return a text in this language; one of the user's own stays as it is."""
        return translate(text, self.phrases, decimal_mark=self.decimal_mark) or text

    def signal(self, key: str) -> str:
        """Return the name of a state or output.

        Examples
        --------
        >>> Labels().signal("v_phi"), Labels().signal("q_column")
        ('Tower rotation rate v_φ', 'Deflection of mode column')
        """
        if key in self.names:
            return self.names[key]
        kind, _, mode = key.partition("_")
        form = {"q": self.mode_deflection, "v": self.mode_rate}.get(kind, "")
        return form.format(mode=mode) if form and mode else self.name(key)

    def name(self, key: str) -> str:
        """Return the name of a signal or of a dotted profile key.

        Examples
        --------
        >>> Labels().name("plant.base_mass"), Labels().name("v_phi")
        ('Base mass', 'Tower rotation rate v_φ')
        """
        last = key.rpartition(".")[2]
        if last in self.names:
            return self.names[last]
        words = last.replace("_", " ")
        return replace_words(words[:1].upper() + words[1:], self.words)


def _turned(
    value: str | tuple[str, ...] | Mapping[str, str], words: Phrases
) -> str | tuple[str, ...] | Mapping[str, str]:
    if isinstance(value, str):
        return replace_words(value, words)
    if isinstance(value, tuple):
        return tuple(replace_words(item, words) for item in value)
    return {key: replace_words(item, words) for key, item in value.items()}


ENGLISH = Labels()
