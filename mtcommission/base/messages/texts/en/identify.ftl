# What was identified in measured responses, what was chosen, and what is in doubt.
# Frequencies in Hz, times in s, shares from 0 to 1; $file, $mode, $states: names of the user

# The band and the order
identify-band-given = Fitted from { FREQUENCY($low) } to { FREQUENCY($high) } as --band asks.
identify-band-cut = Of { FREQUENCY($low) } to { FREQUENCY($high) } only { FREQUENCY($new_low) } to { FREQUENCY($new_high) } was fitted: beyond it the lines do not obey a rigid mass with modes (friction at the low end; current loop, sensor or more modes than a model holds at the high end). --band sets another.
identify-no-lines-in-band = { $file } has too few lines between { FREQUENCY($low) } and { FREQUENCY($high) } and was left out.
identify-too-few-in-band = { $lines } usable lines between { FREQUENCY($low) } and { FREQUENCY($high) }, at least { $least } are needed; measure a wider band or give another --band
identify-background = { $count ->
    [one] A broad term about { FREQUENCY($low) } was
   *[other] { $count } broad terms between { FREQUENCY($low) } and { FREQUENCY($high) } were
} needed for a good fit: too strongly damped for a mode, and not in the profile.
identify-point-left-out = { $file } does not obey the poles that the other points show and was left out: strike that point again.

# A fit that misses what was measured; $low, $high [Hz], $missed: a share
identify-no-profile = No profile: the model does not describe what was measured: { $shows ->
    [no] neither mass nor mode shows,{" "}
   *[yes] {""}
}misfit { NUMBER($misfit, digits: 3) } (at most { NUMBER($most) }), { SHARE($missed) } of the magnitude missed (at most { SHARE($far) }).
identify-forced = Forced: the model does not describe what was measured: { $shows ->
    [no] neither mass nor mode shows,{" "}
   *[yes] {""}
}misfit { NUMBER($misfit, digits: 3) } (at most { NUMBER($most) }), { SHARE($missed) } of the magnitude missed (at most { SHARE($far) }).
identify-not-described = { $files }: a rigid { $axis ->
    [rotary] inertia
   *[linear] mass
} with modes misses the measured lines, most of all from { FREQUENCY($low) } to { FREQUENCY($high) }. { $cause ->
    [response] At the low end it does not fall with frequency as a free { $axis ->
        [rotary] inertia
       *[linear] mass
    } does: probably the wrong response (a closed loop from its setpoint, another signal), or the axis did not move. Measure the controlled system of the speed controller, { word-force } setpoint to actual velocity, about an offset speed.
    [friction] It lies at the low end: friction that sticks, or feedback in the measurement. Measure about an offset speed at which the axis never stands, with more amplitude and the position loop as soft as it may be; or leave these lines out with --band.
    [modes] It lies at the high end: more modes than the model holds, the current loop or the sensor. Leave these lines out with --band, or measure to lower frequencies with finer lines.
   *[feedback] It lies in the middle of the band: feedback in the measurement (record the excitation, too, as v_ref), a wrong unit or column, or a machine that changed meanwhile. Measure again with the loop as soft as it may be and more amplitude, or several states of the machine one by one.
}

# Spreads
identify-floor = { $states ->
    [one] one state of the machine was measured: other positions, payloads and levels are not in it, so { SHARE($floor) } at least (an assumption)
   *[other] { $states } states agree within { SHARE($floor) }, the least that repeats and levels of other machines showed
}
identify-apart = each of the { $states } states is judged by itself, and the middle, but nothing else between them (measure more states where the machine works in between); { SHARE($floor) } is the least that repeats and levels of other machines showed
identify-frequency-range = { $mode } lies between { FREQUENCY($low) } and { FREQUENCY($high) } in { $states } states
identify-damping-range = { $mode } has { NUMBER($low, digits: 3) } to { NUMBER($high, digits: 3) } in { $states } states
identify-sigma = twice the standard error of { $mode } is { SHARE($spread) }
identify-damping-unknown = the measurement hardly shows the damping of { $mode }: { SHARE($spread) } is assumed, the most that a profile takes; record longer

# Doubts and advice
identify-mode-not-everywhere = { $mode } does not show in { $states }.
identify-no-mode = No mode was found: within the band the axis is a rigid mass. Measure to higher frequencies, or at the tool.
identify-no-rigid-body = No rigid body shows in the band: the mass is not known, and gains are those between the measured points, not shares of the drive's { word-force }. Measure { word-force } to speed with the drive.
identify-no-force = Only the motion was recorded, not what drives it: frequencies and damping are those of a tool on a motor that is held, as drive.kind = "position_source" means them (a motor that follows its setpoint, such as a stepper). A servo axis has its modes with the motor free, which lie higher: for it record the response of the drive (torque to speed).
identify-of-belt = recorded along a belt (AXIS=1,1 or 1,-1), which compares the belts of a CoreXY but is no axis; Klipper's shapers act on X and Y of the tool head, on a CoreXY, too: record TEST_RESONANCES AXIS=X and AXIS=Y
identify-several-axes = the names of the files tell several axes ({ $axes }): each gets files of its own (-o NEW.toml writes NEW-x.toml and so on), so neither --profile nor - can be given; or name the files of one axis only
identify-kind-replaced = identify writes a modal plant: its modes take the place of kind = "{ $kind }" and of all that stood in [plant]. Keep the old profile if you want to compare.
identify-core-xy = Klipper's shapers act on X and Y of the tool head, on a CoreXY, too. There both motors share the acceleration of X or Y, but on a diagonal one motor carries all of it: drive.max_acceleration is that of one axis, at most 1/√2 of what a motor alone follows.
identify-klipper-choice = calibrate_shaper (Klipper at 84104bbb, its criterion computed here) would choose { $shaper } at { FREQUENCY($frequency) }, max_accel { NUMBER($acceleration, digits: 4) } mm/s², which leaves { SHARE($vibration) } of the measured power by its measure. run simulates it beside our own choice.
# $offset, $swing: a velocity in SI; $shift, $interval, $reversed: shares
identify-friction-shifts = { $file }: the axis moved at { VELOCITY($offset) } on average while the excitation swung it by { VELOCITY($swing) } (rms), so that it ran backwards { SHARE($reversed) } of the time and friction changed its sign. That can shift the mode at { FREQUENCY($frequency) } by ± { SHARE($shift) } (friction that acts as a spring in place of a damper), and its interval of ± { SHARE($interval) } does not hold it. Measure again at { VELOCITY($wanted) } or faster, or with less excitation.
identify-friction-may-shift = { $file }: friction shows at the low end. If the axis ran backwards at times (a response does not tell), that can shift the mode at { FREQUENCY($frequency) } by ± { SHARE($shift) }, and its interval of ± { SHARE($interval) } does not hold it. Measure about an offset speed of at least three times the rms velocity of the excitation, or give the record over time.
# $bound [1/kg]
identify-no-tool-sensor = No sensor at the tool: tcp_gain is not measured. { GAIN($bound) } is the worst case of a tool on the far side of the mode, or its share at the encoder if that is larger. An accelerometer at the tool during the same excitation, FILE@tcp, replaces it; so does --tool-ratio, peak at the tool by peak at the motor.
identify-gains-stay = Assumed, since no sensor showed it, as the profile states it: { $gains }. Take it out of machine.assumed if you know it.
identify-states-stay = The states of the profile stay as they are, for this measurement shows one alone: { $states }. Take out [[machine_states]] that no longer hold.
identify-states-gone = Left out, since the profile has no such state any more: { $keys }. Weights go together: the balanced ones stand in their place.
identify-polarity-reversed = { $file }: the sign is reversed (the mass came out negative); it was turned.
identify-masses-differ = { $file } shows { MASS($mass) }, the first sensor { MASS($other) }: one of the constants or units is off, and so are its gains.
identify-mass-by-state = The states move { MASS($low) } to { MASS($high) }; the profile holds each as a state, and in [plant] the middle. If that is the payload alone, the least one as moving_mass and the difference as payload do as well.
# $spacing, $wanted [Hz], $window [s]
identify-lines-too-far-apart = At { FREQUENCY($frequency) } lines are { FREQUENCY($spacing) } apart, more than 0.8 ζ f = { FREQUENCY($wanted) }: the damping comes out too large. Record with windows of { TIME($window) } or longer.
identify-model-error = Measured points and model differ by { SHARE($share) } of the magnitude beyond the noise (nonlinear friction, a mode outside the band); the intervals contain it.
identify-noise-from-misfit = { $file } has no coherence: the size of its noise was taken from the misfit. Export the coherence, too.
identify-low-coherence = { $file }: the coherence is below 0.5 on { SHARE($share) } of the lines. Use more averages, more excitation, or an offset speed against friction.

# The profile
identify-document-head = Identified by mtcommission { $version } on { $date }.
identify-document-file = { $file }, SHA-256 { $hash }
identify-document-file-dated = { $file }, measured { $date }, SHA-256 { $hash }
identify-document-sigma = ± values are two standard errors of this measurement.
identify-document-open = Still to be said; mtcommission wizard -o { $file } asks for it:
identify-document-held = motor follows its steps; modes as an accelerometer shows them
identify-document-printer-max-acceleration = assumed: what the resonance test itself drives at its upper end
identify-document-name = Measured axis
identify-document-states = States of the machine: limits are to serve each of them.
identify-document-source = identified from { $files } on { $date }
identify-document-tool-worst = no sensor at the tool: worst case
identify-document-tool-ratio = encoder's share × { NUMBER($ratio) } (--tool-ratio)
identify-document-merged = Merged into a profile: its other lines and comments are as they were.
identify-document-too-many = Only the { $most } modes with the largest gains are in the profile; { $left } were left out.

# Page and terminal
identify-title = Identified axis
# $files: by name
identify-title-of = Identified axis: { $files }
identify-verdict = { $modes ->
    [one] One mode
   *[other] { $modes } modes
}
identify-verdict-none = No mode
identify-detail = { $states ->
    [one] One state of the machine
   *[other] { $states } states of the machine
}, { $files ->
    [one] one file
   *[other] { $files } files
}. ± is two standard errors of the measurement.
identify-page-note = Measured; ± is two standard errors of this measurement. What differs from day to day and from machine to machine is in the spread.
identify-part-result = Result
identify-part-modes = Modes
identify-part-fits = Measured and fitted
identify-part-doubts = What was chosen, left out, and what to measure better
identify-part-check = The model against the records
identify-part-sources = Files
identify-part-profile = Profile
identify-mass = Moving { $axis ->
    [rotary] inertia
   *[linear] mass
}
identify-delay = Delay
identify-band = Band
identify-band-from-to = { FREQUENCY($low) } to { FREQUENCY($high) }
identify-spread-frequency = Spread of frequencies
identify-spread-damping = Spread of damping
identify-misfit = Misfit, in units of the noise
identify-head-why = Why
identify-head-file = File
identify-head-sensor = Sensor
identify-head-explained = Explained
identify-head-held-back = Held back
identify-not-known = not known
identify-misfit-meaning = weighted rms; 1 is as good as the noise
identify-delay-meaning = from { word-force } to sensor, as recorded
identify-lag = Lag
identify-lag-meaning = first order, beside the delay: the current loop, or a filter of the sensor
identify-mass-meaning = from the rigid body at the low end of the band
identify-band-asked = as --band asks
identify-band-meaning = by coherence and misfit
identify-caption-modes = Modes over all states, ± two standard errors
identify-caption-states = Modes in each state
identify-caption-check = Share of the signal's power in the band that the model explains from the recorded { word-force }
identify-plot-caption = { $file }: measured points and fitted curve
identify-plot-frequency = f in Hz
identify-plot-magnitude = |H| in { $unit }, logarithm to 10
identify-plot-phase = phase in °
identify-plot-coherence = coherence
identify-plot-density = density, logarithm to 10
identify-plot-misfit = misfit / noise
identify-line-fitted = fitted
identify-line-error = ± 2 standard errors
identify-stage = Identifying
identify-next-run = Look at what is assumed in { $file }, then: mtcommission run { $file }
identify-next-check = Then: mtcommission check { $file }, then mtcommission run { $file }
identify-next = Then: mtcommission wizard -o { $file }, then mtcommission run { $file }

# Options
identify-profile-there = { $file } is there and was not written by identify; give another name, or --profile { $file } to merge into it
identify-option-constant = got "{ $got }", must be a number other than 0 in N/A or N m/A, e.g. "12.5 N/A"
identify-file-twice = holds the same measurement as { $other }, which would count twice; give it once
identify-option-number = got "{ $got }", must be a number other than 0
identify-option-band = got "{ $got }", must be LOW:HIGH in Hz with 0 < LOW < HIGH, e.g. 8:300
identify-option-modes = got "{ $got }", must be auto or 1 to { $most }

# The sheet's section
identified-heading = What was measured
identified-note = Identified on { $date }. ± is two standard errors of this measurement; what differs from day to day, and between positions and payloads, is in the spread, which the corners hold.
identified-by-profile = as the profile states it
identified-assumed = not measured; assumed { $value }
identified-changed = { $mode } was changed by hand: { $what } is { $now } in the profile, { $was } was measured.
identified-mass-changed = The moving { $axis ->
    [rotary] inertia
   *[linear] mass
} was changed by hand: { $now } in the profile, { $was } was measured.
identified-not-in-profile = { $mode } was measured, but no mode of the profile has this name: these limits do not know it unless it was renamed.
identified-spread-less = { $what }: the corners hold ± { $now }, the measurement asks for ± { $was }.
identified-without-evidence = The profile names no file with measured points and advice: identify -o writes one beside it.
identified-evidence-missing = { $file } with the measured points and the advice is missing beside the profile or cannot be read: values and intervals are those of the profile.
identified-evidence-differs = { $file } is not the file that belongs to this profile (its checksum differs): values and intervals are those of the profile.
# $now, $least, $freed [s]
identified-tool-frees = The share of { $modes } at the tool was not measured but assumed, mostly as the worst case. A sensor at the tool during the same measurement could free up to { TIME($freed) }: if it shows a tool that stands still in these modes, the slowest move settles after { TIME($least) } in place of { TIME($now) }.
identified-tool-frees-nothing = The share of { $modes } at the tool was not measured but assumed. A sensor at the tool would free no time here: even with a tool that stands still in these modes the slowest move settles no sooner.
identified-tool-decides = The share of { $modes } at the tool was not measured but assumed, and the requirements are not met with it. With a tool that stands still in these modes they { $met ->
    [yes] would be met: measure with a sensor at the tool first
   *[no] are not met either
}.
identify-document-measured = What was measured, for the sheet: value and standard error. Change [plant], not this.
identified-klipper-caption = What calibrate_shaper would choose from the same files (Klipper at 84104bbb, shaper_calibrate.py; its criterion computed here)
identified-klipper-shaper = Shaper
identified-klipper-vibration = Vibration left
identified-klipper-smoothing = Smoothing at 5 m/s²
identified-klipper-max-accel = max_accel
identified-klipper-chosen = { $shaper } (recommended)
identified-klipper-ours = ours: { $filter }
identified-klipper-simulated = Its recommendation and ours, simulated on this axis: worst of the listed moves and corners; the verdict is on every size that the limits serve
identify-document-printer = assumed
