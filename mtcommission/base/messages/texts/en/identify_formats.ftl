# Measured files: what a format is called, what is wrong with a file, how a response was estimated.
# $got: as in the file; $line: in the file; $found, $names: of columns; times in s, shares from 0 to 1

identify-file-empty = is empty; record or export it again
identify-file-binary = is a binary file; export the measurement as text (CSV), XML or universal file
identify-file-foreign = is a { $format } file, which is not read here; export the measurement as CSV, XML or universal file (dataset 58)
identify-file-is-folder = is a folder; name the measured files in it
identify-file-too-large = is larger than { PLAIN($most, digits: 9) } bytes; export a shorter record, or at a lower sampling rate
identify-line-too-long = a line with more than { PLAIN($most, digits: 9) } characters; that is no table of a measurement
identify-no-table = no table of numbers in { $lines } lines (the first: "{ $first }"); write names with units in the first line and at least two columns below, separated by comma, semicolon, tab or blank
identify-too-many-columns = { $got } columns, more than { $most }; export only the signals that are needed
identify-row-length = { $got } values where the table has { $wanted } columns; the line is cut or the separator changes
identify-no-number = column { $column }: got "{ $got }", must be a number
identify-not-finite = column { $column }: got "{ $got }"; leave out the line or record again
identify-cut = line { $line } is incomplete and was left out: the file seems to be cut there
identify-overruns = samples were lost at { $count } places (overrun); the longest piece without a loss is used, { $kept } of { $of } samples
identify-negative-magnitude = a magnitude of { PLAIN($least) }, which cannot be negative; if it is in decibels, write magnitude [dB]
identify-negative-power = a negative power; are the columns swapped?
identify-no-response = no response among the columns { $found }; needed are frequency_hz with re and im, or with magnitude and phase
identify-no-such-name = got "{ $got }", which is no name of a signal; there are t, sample_time, { $names }, and for responses frequency_hz, re, im, magnitude, phase, coherence
identify-setting-unknown = the file says { $got }, which is not known; sensor is encoder or tcp, input force, torque, current or acceleration, output position, velocity or acceleration, constant a number
identify-xml-broken = is no whole XML file: { $reason }; save the measurement again
identify-xml-unknown = is XML with the root { $root }; known are SINUMERIK's ResponseTestCustom, DynamicModelAxisController and servo traces
identify-series-broken = the series { $name } is cut or holds foreign signs; save the measurement again
identify-series-short = { $name } has { $got } values, must have { $wanted }; the file is cut, save the measurement again
identify-series-missing = { $name } is missing; save the measurement with its data
identify-series-not-finite = { $name } holds values that no measurement gives (not finite, or beyond all size); measure again
identify-record-broken = record { $row }: got "{ $got }", must be a number
identify-response-taken = { $name } is taken: motor speed per { word-force }, the mechanics that the drive moves. The file also holds { $others }: { $file }@NAME takes one of them.
identify-last-response-taken = { $name } is taken: motor speed per { word-force }, measured last. The file also holds { $others }: { $file }@NAME takes one of them.
identify-hz-assumed = the file holds no sampling time that tells the unit of its frequencies: taken as Hz, up to { PLAIN($last) } Hz (assumed; in rad/s they would be 2π times lower)
identify-frequency-neither = the last line stands at { PLAIN($last) }, but a session reaches to half its sampling rate, { PLAIN($nyquist) } Hz at { TIME($step) }: that is neither in Hz nor in rad/s, so the unit of the frequencies is not known; measure with the full bandwidth again, or export the response as a table with frequency_hz
identify-axis-of-file = measured on axis { $name }
identify-setpoint-response = is the response of a closed loop from its setpoint (about 1 at low frequency): it shows the loop, not the mechanics; measure the controlled system of the speed controller (torque setpoint to actual speed), or say --input if this is wrong
identify-twincat-heads = the block of heads has no line Name with { $wanted } cells as the line SampleTime[ms]; export with the heads in the file
identify-twincat-scaled = channels with a scale factor: taken as exported with "scale values before export"
identify-uff-broken = pyuff cannot read the universal file: { $reason }
identify-uff-nothing = no frequency response and no time response in the universal file (function types { $found }); export dataset 58 with function type 4
identify-loudest-axis = { $name } is used, the direction that shakes most
identify-no-period = the first line must state the sampling period, got "{ $got }"

identify-too-few-samples = { $got } samples, must be at least { $least }
identify-no-sample-time = the file states no times; say --columns "sample_time=1 ms" (with yours)
identify-time-does-not-rise = the time goes from { PLAIN($before, digits: 9) } s to { PLAIN($after, digits: 9) } s; must rise: are the columns swapped, or the times printed with too few digits?
identify-step-out-of-range = samples { PLAIN($step) } s apart, which is no sampling of an axis; check the unit of the time column
identify-uneven = a step of { PLAIN($got) } s at { PLAIN($at, digits: 6) } s where { PLAIN($usual) } s is usual: samples are missing; record without gaps
identify-resampled = the clock is uneven by { SHARE($spread) }; the signals were interpolated to a step of { TIME($step) }
identify-clipped = { $name } runs into { PLAIN($end, digits: 6) } at { $count } places and stands there ({ SHARE($share) } of the samples): clipped or saturated; record again with less excitation or a wider range
identify-unit-slip = { $name } is { PLAIN($ratio) } times the rate of what the same sensor shows besides; one of their units is wrong
identify-fewer-lines-than-needed = { $got } lines of frequency, must be at least { $least }
identify-frequency-does-not-rise = the frequency goes from { PLAIN($before, digits: 9) } Hz to { PLAIN($after, digits: 9) } Hz; must rise: is another column the frequency (--columns frequency_hz=COLUMN)?
identify-frequency-out-of-range = lines from { PLAIN($first) } to { PLAIN($last) } Hz; the last must be from { PLAIN($least) } to { PLAIN($most, digits: 9) } Hz; check their unit and the order of the columns
identify-coherence-out-of-range = a coherence of { PLAIN($got) }, must be from 0 to 1; are the columns swapped?
identify-all-zero = all values are zero; record again
identify-rising = the response rises with frequency by { PLAIN($slope, digits: 2) } decades per decade against the position, as no mechanics do; are input and output swapped, or is the output another one than said (--output)?
identify-perfect-coherence = the coherence is 1 in every line, as of a single average: it says nothing and is not used

identify-signal-force = { word-force }
identify-signal-torque = torque
identify-signal-current = current
identify-signal-reference = reference
identify-signal-position = position
identify-signal-velocity = velocity
identify-signal-acceleration = acceleration
identify-no-unit = no unit
identify-column-found = { $place }: { $name } [{ $unit }] is { $what }
identify-columns-unknown = columns are not clear: { $found }; say { $missing }
identify-response-unknown = a response in the unit "{ $found }" is not clear; say { $missing }
identify-missing-output = which column is the motion: --columns "encoder=COLUMN [mm]" (or tcp, velocity, acceleration)
identify-missing-input = which column holds the { word-force }: --columns "{ word-force }=COLUMN" (or torque, current), or name the columns that count if there is none
identify-missing-sensor = where it was measured: --sensor encoder or --sensor tcp (or FILE@tcp)
identify-say-input = what excites: --input force, torque, current or acceleration
identify-say-output = what was measured: --output position, velocity or acceleration
identify-say-constant = --constant, the { word-force } per ampere (in N/A or N m/A), which the motor's data sheet states
identify-current-without-constant = a current (columns { $found }); say --constant, the { word-force } per ampere (in N/A or N m/A), which the motor's data sheet states
identify-column-contradicts = { $name } has the unit { $unit }, which is that of { $signal }: are columns swapped, or is the unit wrong?
identify-rotary-on-linear = the response is that of a turning motor, the axis of the profile is linear; state drive.lead (travel per turn), or convert { word-force } and travel to the axis
identify-linear-on-rotary = the response is that of a linear motion, the axis of the profile turns
identify-motor-to-axis = converted from the motor to the axis with { PLAIN($turn, digits: 6) } rad of the motor per metre
identify-sensor-assumed = { $name }: taken as the motor's encoder, since nothing else is said (--sensor)
identify-not-collocated = at { PLAIN($frequency) } Hz the mode moves against the { word-force } ({ PLAIN($share) } of the rigid body's share), which the encoder of a motor never shows: does the sensor sit at the load? Say where it sits: --sensor tcp or FILE@tcp at the load or tool, --sensor encoder for the drive's own one all the same
identify-unit-assumed = the unit of the response ("{ $found }") does not tell its scale: taken as SI; a wrong factor shows in the mass
identify-si-assumed = no unit in the file, taken as SI: { $names }
identify-ignored = columns not used: { $names }
identify-set-force = { $name } is the setpoint of the { word-force }: the delay of the current loop is part of the delay that is found

identify-no-motion = no motion among the columns { $found }, or it stands still
identify-no-excitation = the { word-force } does not change (columns { $found }); excite the axis
identify-incoherent = input and output have nothing to do with each other (coherence below 0.3; columns { $found }); excite more, or check which columns they are
identify-nothing-rings = no { word-force }, and nothing rings and dies away (columns { $found }); record { word-a-force }, or let the record end well after the move
identify-by-blows = estimated from { $count } blows, { TIME($duration) } each
identify-not-died-away = { SHARE($share) } of a response was left when the next blow came: damping is read too large; wait longer between blows
identify-single-blow = a single blow: no coherence, so intervals come from the misfit alone; strike five times or more
identify-by-periods = estimated from { $count } periods of { TIME($period) }, without leakage; intervals from their spread
identify-period-left-out = the first period was left out: the transient had not died away
identify-by-welch = estimated by Welch with a window of { TIME($window) } (lines { FREQUENCY($spacing) } apart), { $segments } segments, worth { PLAIN($averages, digits: 3) } independent averages
identify-welch-too-coarse = lines { FREQUENCY($spacing) } apart are too coarse for the sharpest peak, { FREQUENCY($width) } wide: damping is read too large; record longer
identify-joint-estimate = the recorded excitation was used (joint input-output estimate): the closed loop does not bias the response
identify-no-reference = no excitation was recorded: if the loop was closed, lines with low coherence ({ SHARE($share) } of them are below 0.9) are biased; record the excitation, too
identify-reference-silent = the recorded excitation does not move the { word-force } in these lines, so it was not used: if the loop was closed, lines with low coherence ({ SHARE($share) } of them are below 0.9) are biased
identify-same-sensor = the same sensor also gave { $names }; the clearer response is used
identify-by-decay = free vibration from { TIME($start) } on, { TIME($duration) } long; its modes explain { SHARE($explained) } of it; no { word-force }, so neither mass nor gains
identify-loop-in-decay = a setpoint was followed: these are vibrations of the axis in its closed loop, whose damping the loop changes
identify-by-power = no { word-force } was recorded and nothing dies away: taken as a spectrum, which gives frequencies and damping, neither mass nor gains
identify-hold = if the { word-force } is held between samples, as drives do, gains above { FREQUENCY($limit) } are read more than 1 % too small; sample faster if modes lie there
identify-no-motor-acceleration = no acceleration of the motor among { $found }; --input acceleration needs it beside a signal at the tool: --columns "motor_acceleration=..." and FILE@tcp
identify-unit-of = got the unit "{ $got }"; must be one of { $units }
identify-not-there = got "{ $got }", which the file does not hold; there are { $found }
