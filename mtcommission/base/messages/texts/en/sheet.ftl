# The commissioning sheet, and the summary on the terminal.

## The printers' own words

title = Commissioning sheet
axis = axis
identity = Profile { $name }, SHA-256 { $hash }
disclaimer = Calculated record, not an acceptance test.
contents = Contents
skip = Skip to the content
page = page
appendix = Appendix
script-note = Plots: drag to zoom, double-click to reset, move the pointer (or the arrow keys) to read values.

## Words

yes = yes
no = no
met = met
not-met = NOT MET
not-settled = not settled
unlimited = unlimited
no-jerk-limit = no limit
setpoint-filter = Setpoint filter
no-setpoint-filter = none
# $kind: of the setpoint filter; $shaper: its name in capitals; $count: of taps
filter-name = { $kind ->
    [moving_average] moving average
    [two_moving_averages] two moving averages
    [fir] FIR of { $count } taps
   *[other] shaper { $shaper }
}
filter-of-length = Filter length
filter-of-second-length = Second filter length
filter-of-frequency = Filter frequency
filter-of-damping = Filter damping ratio
none = None.
move = Move{ "\u00A0" }{ $number }
velocity-step = velocity step { $velocity }
positioning = positioning by { $distance }
positioning-limited = positioning by { $distance } at up to { $velocity }
in-unit = { $name } in { $unit }
quantity = Quantity
value = Value
key = Key in the profile
source = Source
acceleration = Acceleration
jerk = Jerk
jerk-time = Jerk time
settling-time = Settling time
residual = Residual deviation
peak-deviation = Peak deviation
time = Time
velocity = Velocity

## Verdict

verdict-heading = Verdict and values to enter
verdict-met = All requirements met
as-typed = The acceleration to type is { $acceleration }; what this sheet shows beside it is of the run, with { $wanted }.
verdict-incomplete = Requirements met, BUT INCOMPLETE
verdict-missed = Requirements NOT met as typed
verdict-not-met = Requirements NOT met
values-bound-by = Bound by: { $bound }
# $data: their names; another-gives: $change and what it would $given
assumed-binds = What binds rests on an assumed value ({ $data })
another-gives = . { $change }: { $given }.
another-unknown = : state it.
obstacle = Limiting requirement: { $obstacle }
what-they-give = Settles after { $settling }, residual deviation { $residual } (listed moves, worst corner).
today = Today
now-and-then = Settling time / residual deviation: now { $now }, then { $then }.
now-no-result = no result (see the warning)
holds-caption = For what they hold
basis-caption = What this rests on (assumed: neither stated nor measured)
basis-data = Machine data
basis-assumed = Assumed
measured-modes = { $modes }; on { $date }, intervals in sheet.html
measured-nothing = { $source }; nothing was measured on this machine
assumed-more = { $names } and { $count } more
payload-from-to = { $low } to { $high }
basis = What
basis-damping = Damping ratios
basis-sizes = Sizes of move
assumed-of = { $value } (assumed: { $names })
assumed = { $value } (assumed)
spread = judged at ± { SHARE($spread) }
spread-none = judged as stated, no spread
all-kept-between = all kept from { $low } to { $high }
not-kept-nominally = requirements not kept even as stated
reserve-kept = recommendations use up to { SHARE($band) } of the band, { SHARE($force) } of the { word-force }
position-loop-at = { $place ->
    [none] open-loop axis, no position loop; simulated every { $position_cycle }
    [control] position loop in the control, every { $position_cycle }; velocity loop every { $velocity_cycle }
    [interpolated] position loop in the control, every { $position_cycle }; feed-forward interpolated every { $velocity_cycle }
   *[drive] position loop in the drive (DSC), every { $velocity_cycle }; setpoint every { $position_cycle }
}
judged-in-motion = A tool working along a path is judged by the { $requirements }, one that must be still at the end by the residual deviation.
# $feed: up to which velocity it counts, or none
judged-to-feed = { $requirement }{ $feed ->
    [none] { "" }
   *[other] { " at up to " }{ $feed }
}
judged-at-rest = Judged once the tool must be still. During the move it is up to { $peak } off: for work along a path, state in the profile: { $keys }.
encoder-steps = steps of { $resolution } move the tool by up to ± { $tool } and the set { word-force } by ± { $force }
share-used = Used
yes-without-reserve = yes, reserve used
met-without-reserve = met, reserve used up
reference = { $move }: time-optimal reference, exact rest: { $optimum }; recommended: { $compared ->
    [unsettled] not settled
    [sooner] { $settling }, { $share } less, since it is judged by the band and not by exact rest
   *[later] { $settling } ({ $share } more)
}.
checks-caption = Requirements
checks-any-size-caption = Requirements, any size of the moves
warning-count = { $others ->
    [yes] Further warnings
   *[no] Warnings
}: { $count }, see the appendix, certificates and assumptions.
check = Requirement
found = Found
permitted = Permitted
verdict = Verdict
where = Worst case
warning = Warning: { $warning }
could-be-met = Could be met: { $requirement } { $value } instead of { $limit }.

## Machine

machine-heading = Machine and axis
machine-row = Machine
axis-row = Axis
linear = linear
modes-caption = Modes of the structure (control off)
mode = Mode
of-mode = { $name } of mode { $mode }
peak-bound = { $name }, largest magnitude
requirements-heading = Moves and requirements

## Limits

limits-heading = Limits by machining mode, acceleration and jerk in pairs
machining-mode = Machining mode
machining-surface = Surface (finishing)
machining-accuracy = Accuracy
machining-speed = Speed (roughing)
permitted-band = Band
bound-by-column = Bound by
# $band: that could be met, or none
mode-not-met = { $mode }: no limits were found that meet all requirements with this band{ $band ->
    [none] .
   *[other] ; a band of { $band } could be met.
}
alternatives-caption = Limits beside each other, in the same simulation (worst move, worst corner)
listed-short = For the listed sizes only
limits-name = Limits
recommended = Recommended
rule-heading = Commissioning rule, applied by hand
rule-valid = Valid for: { $range }
rule-result = By hand: a = { $acceleration }, j = { $jerk } ({ $chosen }; a bound by: { $bound }), predicted residual deviation { $residual }, for every smaller move, too. The search needs no rule; this is to check it with a calculator.
rule-steps-caption = The rule, step by step
rule-symbols-caption = Symbols of the rule (index i: a mode; values by mode: { $modes })
rule-symbol-F = { word-force-first } left for motion
rule-symbol-v = Change of velocity, or largest velocity, of each move
rule-symbol-L = Length of each positioning move
rule-symbol-m = Moving { word-mass }; in the { word-force } condition with the largest payload
rule-symbol-m-ff = { $axis ->
    [rotary] Moment of inertia in the feed-forward
   *[linear] Mass in the feed-forward
}
rule-symbol-omega = Natural angular frequency of a mode
rule-symbol-g = Share of a mode at the tool, by itself or beside the encoder; the larger one
rule-symbol-c = Share of a mode at the encoder
rule-symbol-T-F = Length of the moving average
rule-symbol-n = Ramps of acceleration: 2 in a velocity step, 4 in positioning
rule-symbol-R = Vibration after an average over that of a single push
rule-symbol-x = Length of the average in periods of a mode, f T_F
rule-symbol-i = Imaginary unit (as an index: number of the mode)
symbol = Symbol
meaning = Meaning
meaning-with-doubt = { meaning }; (?): not verified
rule-step = Step
rule-how = Formula
rules-heading = Comparison with rules of thumb
rules-caption = Limits from the optima, and rules of makers and textbooks, in the same simulation (worst move, worst corner)
rule = Rule
meets = All met

## Compared with another record

differences-heading = Changes since the earlier record
compared-with = Compared with: { $machine }, axis { $axis_name }, calculated on { $created }, profile { $name }, SHA-256 { $hash }.
compared-other-axis = { $before } and { $after } are different axes: no row below is a change that somebody made to one axis.
changed-inputs = Machine, moves and requirements: what changed
no-changed-inputs = Machine, moves and requirements are the same in both records.
changed-gains = The gains suit the axis and its loop; of what they hang on, this changed: { $causes }.
changed-gains-by-moves = Of what the margins hang on nothing changed: with the rest another loop serves the moves best.
changed-outcome = Limits, result and loop: what changed
before = Before
after = After
change = Change
changed = changed
not-stated = not stated

## Motion

responses-heading = Responses
responses-caption = { $move }: setpoint, tool deviation, { word-force }; nominal machine
yardstick-caption = Moves of the nominal machine beside the least times that the { word-force } allows (how much longer each takes)
move-head = Move
exact-rest = Least time, exact rest
within-band = Least time, in the band
robust-short = In the band over the spread
motions-heading = Optimum, recommendation and response
drive-caption = { $move }: { word-force }, acceleration and velocity
vibration-caption = { $move }: vibration and TCP deviation
motion-note = All plots of a move share the time axis. Optima end in exact rest at t_f; the acceleration shown for them and for the response is F/m. The setpoint is shown as commanded; the deviation is counted from the setpoint delayed by { $delay }.
constrained = time-optimal, bounded
setpoint = setpoint
response = loop response
deviation = TCP deviation
peaks-caption = { $move }: largest magnitudes
signal-head = Signal
control = Control

## Loop

loop-heading = Control loop: margins and stiffness
loop-details-heading = Control loop, details
loop-why = Why this loop:
gain-margin-at = gain margin { $margin }
phase-margin-at = phase margin { $margin }
filter-at = filter at { $frequency }
open-loop-measured = open loop with the measured axis ({ $file })
margins-caption = Stability, loop cut at the set { word-force }
margin = Margin
nominal = Nominal machine
worst-corner = Worst corner
gain-margin = Gain margin
gain-margin-up = Gain may rise by
gain-margin-down = Gain may fall by
loop-corners-caption = The loop in every corner of payload and spread
disturbance-caption = { $axis ->
    [rotary] Response of the tool to a step of torque about the axis of the drive
   *[linear] Response of the tool to a step of { word-force } on the line of the drive
}
deflection = { $axis ->
    [rotary] Rotation of the tool per torque
   *[linear] Displacement of the tool per { word-force }
}
delays-caption = Delays in each path of the loop
path = Path
setpoint-age = Age of the setpoint
dead-time = Dead time (whole cycles)
hold = Mean age of the held value
lag = Lags (drive, filters)
total = Sum
phase-margin = Phase margin
sensitivity-peak = Sensitivity peak
bandwidth = Bandwidth of the velocity loop (−3 dB)
bandwidth-again = { $bandwidth } (antiresonance), again to { $last }
bandwidth-short = Bandwidth
reference-delay = Reference delay τ
sensors = Sensors: { $names }.
sensor-encoder = encoder
sensor-tcp = tool
observed = Observed states: { $names }.
variants-caption = The loop with and without state feedback, each with its best limits
variant-used = { $name } (used)
damping-of = Damping of mode { $mode }
dynamic-stiffness = Least dynamic stiffness at the tool
stiffness-at = { $stiffness } at { $frequency }
bode-caption = Frequency response: open loop (cut at the set { word-force }), closed velocity loop
magnitude = Magnitude in dB
phase = Phase in °
open-loop = open loop
closed-velocity = closed velocity loop
remarks = Remarks
corners-caption = { $move }: response in every corner
payload = Payload
frequencies = Frequencies
machine-state = State
dampings = Damping
max-force = Largest set { word-force }
saturated = Saturated

has-jerk = jerk limit
has-modes = limits by machining mode
has-setpoint-filters = setpoint filter
has-velocity-feedforward = velocity feed-forward
has-acceleration-feedforward = { word-force } feed-forward
has-jerk-feedforward = jerk feed-forward
has-reference-delay = balancing of the setpoint
has-force-filters = filters in the { word-force } setpoint
has-state-feedback = state feedback

## Robustness

robustness-heading = Robustness
kept-between = With all eigenfrequencies off by a common factor, every requirement is kept from { $low } to { $high }.
at-least = at least { $value }
kept-nowhere = The requirements are not kept even with the eigenfrequencies of the profile, so there is no frequency error to allow.
frequency-error = Error of all eigenfrequencies in %
frequency-error-caption = Over the error of the eigenfrequencies, worst payload and damping

## Other sizes of move

sizes-heading = Smaller and larger moves
sizes-listed = only those listed: { $moves }
sizes-every = every one up to { $moves }
sizes-worst = worst { $residual } at { $size }, none above { $bound }
sizes-cost = costs { $cost } against the listed sizes alone, in the same loop
sizes-caption = { $move }: for which sizes the limits hold
filter-time = Filter adds
full-from = Acceleration reached from
kept-from = Band kept from
kept-to = Band kept to
never = never
nowhere = nowhere
or-less = { $value } or less
or-more = { $value } or more
sizes-plot-caption = { $move }: residual deviation over the size of the move, worst corner

## Evidence

certificates-heading = Certificates and assumptions
certificate-caption = { $move }: { $what }
final-time = Final time t_f
method = Method
method-exact = exact
method-transcription = transcription
switches = Switching times
largest-error = Largest terminal error, relative to the peak of its state
assumptions = Assumptions
warnings = Warnings
versions-heading = Versions and profile
program = Program
version = Version
created = Calculated on
hash-row = SHA-256 of the profile
profile-caption = Profile { $name } as read

## Measurements

measurements-heading = Measurements to make on the machine
measure-note = The values are those of the nominal machine without payload. If a frequency lies outside its permitted range, correct the profile and calculate again before using the limits. Moves: { $moves }.
measure-how-1 = { $axis ->
    [open-loop] Frequencies and damping ratios: accelerometer at the tool, motor energised and at rest (held), impact or a swept excitation by the motor; at the middle of the travel.
   *[other] Frequencies and damping ratios: impact hammer and accelerometer at the tool, or frequency response of the drive; control off, brake released, at the middle of the travel.
}
measure-how-2 = Moving { word-mass }: motor { word-force } over acceleration while the acceleration is constant, friction taken off by the mean of both directions.
measure-how-3 = Margins and bandwidth: frequency response by the control's own measuring function, loop cut at the set { word-force }.
measure-how-4 = { $axis ->
    [rotary] Deviations and settling time: angle measuring device, or accelerometer at a known radius, with the limits of this sheet, against the delayed setpoint.
   *[linear] Deviations and settling time: laser interferometer or accelerometer at the tool, with the limits of this sheet, against the delayed setpoint.
}
measure-how-5 = { word-force-first }: trace of the drive, the actual { word-force } or current, sampled as fast as it can; the set { word-force } jumps with each setpoint and is larger.
measure-caption = Calculated and measured values
measurement = Measurement
calculated = Calculated
measured = Measured
difference = Difference
measured-by = Date, name
measure-field-1 = Measuring instruments (type, number, calibrated until)
measure-field-2 = State of the machine (position of the other axes, payload, temperature)

## Entry and signature

# $jerk: how the control takes it, or none; $mark: stands before such a row
neutral-name = { $setting ->
    [force-feedforward] { has-acceleration-feedforward }
    [filters] { word-force } filters
    [tap] tap { $number }
   *[other] { $name }
}
entry-caption = Values to enter (verify before use; never round { $jerk ->
    [none] acceleration up
    [time] acceleration up, jerk time down
   *[limit] acceleration or jerk up
}; { $mark } must be so)
parameter = Parameter
# $why: a fault
entry-none = No values to type in here: { $why }
old-value = Old
new-value = New
signature-heading = Signature
signed-values = { $machine }, axis { $axis_name }: acceleration { $acceleration }, jerk { $jerk }, setpoint filter { $filter }.
signature-field-1 = Machine number, place
signature-field-2 = Entered on the control (date, name, signature)
signature-field-3 = Verified at the machine (date, name, signature)

## Faults

# $got, $wanted: linear or rotary
compared-with-other-motion = got a { $got ->
    [rotary] rotary axis, must be linear
   *[linear] linear axis, must be rotary
} like the record to be printed

## Potential improvements

improvements-caption = Potential improvements: slowest move, worst corner, one thing changed at a time
# $loop: none on an open-loop axis
improvements-note = Each computed: { $loop ->
    [none] limits chosen for each.
   *[other] loop tuned again (same ratios of Kv and Tn to Kp), limits chosen for each.
} Changes do not add up.
# $listed: yes where a table says what more is gained by
improvements-none = { $listed ->
    [yes] Less or nothing is gained by
   *[no] Potential improvements, one thing changed at a time: less than 1 % or nothing is gained by
}: { $changes }.
improvement-saved = Saved
improvement-share = Change of time
plot-alt = Curves over { $along }. { $panels }.
line-measured = measured
frequency = Frequency
