# Limits in a control's own words. Controls read these files: signs of ASCII only.
# $axis_name: the user's name of the axis; $mode: of a machining mode or of a mode of vibration

# what cannot be exported
export-other-loop = the loop in this record is not the one that its profile and gains give; run the profile again with this version
export-too-small = the acceleration of { SI($acceleration, "ACCELERATION", digits: 3) } is less than one unit of this control; use --control generic
export-no-control = no control { $given }{ $hint }
export-other-letter = { $control } names its axes { $letters }; this record is of axis "{ $axis_name }": begin machine.axis with one of these letters, or use --control generic
export-linear-only = { $control } limits linear axes only, this one is rotary; use --control generic

# the header
export-title = { $name }, axis { $axis_name }: limits and loop for { $control }
export-computed = Computed { $created } by { $tool } from { $profile }
export-lost-letters = Letters of the names that this text cannot hold stand as "?".
export-hash = Profile SHA-256 { $hash }
export-verify = VERIFY BEFORE USE. Calculated, not measured: not an acceptance test (ISO 230). Enter by hand, note the old values, try at reduced override.
export-safe-side = Each limit is rounded to the safe side. Units stand beside the values.
export-warning = WARNING: { $warning }
export-not-measured = Default accepted, not measured: { $keys }.
export-unreadable = a row of the export is missing, cannot be read back, or contradicts another one: { $row }; please report this
export-unstable = the loop of this text is not stable{ $lacking ->
    [yes] , because this control lacks { $left_out }
   *[no] {""}
}: { $why }; run the profile with control.kind = "{ $kind }" and export again
export-corners = Judged for frequencies +- { PLAIN($frequency, digits: 3, unit: "%") } %, damping ratios +- { PLAIN($damping, digits: 3, unit: "%") } %{ $payload ->
    [yes] , payload { SI($low, "MASS") } to { SI($high, "MASS") }
    [middle] , payload { SI($low, "MASS") } to { SI($high, "MASS") } (feed-forward and gains for the middle)
   *[no] {""}
}, and the reserve is not counted: all of each allowed value.
export-left-out = LEFT OUT OR CHANGED, because this control has nothing else: { $features }. Settling time with all of it { $before }, with this text { $after }{ $cost ->
    [grows] {" "}({ CHANGE($change) })
   *[unknown] {""}
}. For limits and gains that suit this control, run the profile with control.kind = "{ $kind }" and export again.
export-feature = { $what ->
    [state-feedback] state feedback
    [velocity] velocity feed-forward
    [acceleration] { word-force } feed-forward
    [jerk] jerk feed-forward
    [delay] delay of the position setpoint
    [setpoint-filter] setpoint filter of this kind and length
    [force-filters] some filters of the set { word-force }
    [loop-control] position loop in the control with held values
    [loop-interpolated] position loop in the control with interpolated feed-forward
   *[loop-drive] position loop in the drive
}
export-mode-fails = the limits of machining mode { $mode } do not keep its band, { $band }, with the loop of this text
export-neutral = In neutral words, since { $why }
export-mode-left-out = LEFT OUT: { $why }. Do not use this mode with the old values.
export-warning-here = WARNING, for the loop of this text: { $warning }
# $wanted, $ceiling: mm/s^2
export-ceiling = WRITTEN IS A PRACTICAL CEILING, assumed: { NUMBER($ceiling, digits: 4) } mm/s², settling time { $after }. The axis of this model would take { NUMBER($wanted, digits: 4) } mm/s², { $before }; what extruder, frame and motor driver take is not in it. { $why } Type more only where yours are known to take it; where they take less, state that as drive.max_acceleration.
export-shaft = Gain and inertia of the drive count at the motor's shaft: the axis moves { LENGTH($travel) } per radian of the motor.
export-no-shaft = Kp and the { word-force } feed-forward stand at the axis (a linear motor; for a rotary one state drive.lead and drive.gear).
export-set-elsewhere = Set in the drive, or must be so, for the result above to hold:
export-elsewhere = in the drive, or must be so
export-segments = This firmware changes the velocity once in a segment of 10 ms (a constant of the build): ramps near or below that become steps, which the simulation does not show.
export-doubt = (?) means: name, unit or use not verified, check against the list manual of your software version.
export-verified = read in the maker's text
export-doubted = (?) check against the list manual of your software version
# $gains: which ones are exported
export-judged = Simulated from this text, read back row by row (masses, modes, drive and moves are those of the profile), in { $corners ->
    [1] the nominal machine
   *[other] { $corners } corners
}: settling time { $settling }, residual deviation { $residual }
export-all-met = { $judged }; all requirements met.
export-not-all-met = { $judged }; REQUIREMENTS NOT MET: { $missed }.
export-incomplete = { $judged }; requirements met, BUT INCOMPLETE: { $missed }.
export-missed = { $name } { $value }, allowed { $limit }
# $margins: of the loop that the text makes, worst corner
export-margins-lost = too little margin, { $margins }
export-mode-missed = no limits for machining mode { $mode }
export-no-limits-within = no limits keep the tool within the band of machining mode { $mode }, { $band }
export-no-limits-but = no limits keep the tool within the band of machining mode { $mode }, { $band } ({ $attainable } could be met)
export-least-vibration = NO ACCELERATION MEETS THE REQUIREMENTS HERE: the value is the one of those tried, { PLAIN($share, digits: 3, unit: "%") } % of the recommendation, that leaves least vibration { $shaper ->
    [yes] with the shaper
   *[no] without one
}.
export-share-of-acceleration = To meet the requirements { $shaper ->
    [yes] with the shaper
   *[no] without one
}, the acceleration is { PLAIN($share, digits: 3, unit: "%") } % of the recommendation.

# makers and products, by what --control takes
control-sinumerik = SINUMERIK 840D / 828D / ONE
control-heidenhain = HEIDENHAIN, NCK-based
control-fanuc = FANUC 16i / 18i / 30i
control-isg = ISG kernel / TwinCAT CNC
control-twincat = Beckhoff TwinCAT NC / NCI
control-plcopen = PLCopen motion blocks, CODESYS
control-generic = generic cascade, SI values
control-state-space = free controller (state space), SI values
control-linuxcnc = LinuxCNC 2.10 and newer
control-klipper = Klipper
control-grblhal = grblHAL
control-fluidnc = FluidNC
control-marlin = Marlin
control-ros2 = ROS 2 / MoveIt

value-of-unit = { QUANTITY($value, $unit) }

# parameters
export-old = old
export-for-nc-program = For the NC program, not for the PLC: { $remark }
unit = Unit
limit-deceleration = deceleration
limit-path-nci = path acceleration, deceleration, jerk (NCI)
limit-axis-jerk = axis jerk
limit-axis-jerk-at-rapid = axis jerk at rapid; the maker's rule of 5 x axPathJerk was not judged
limit-rapid = rapid traverse of the rise time; leave it as it is
limit-of-mode = { $mode }, band { $band }, met
gain-integral-time = integral time, rounded up
gain-kp-at-shaft = Kp of this loop, at the motor's shaft
gain-reference-model = time constant of the reference model before the integrator
gain-kv = Kv of this loop
gain-kv-name-and-unit = Kv of this loop; name and unit
gain-kp-at-axis = velocity gain, at the axis
gain-tn-unit = Tn of this loop, rounded up; unit
row-feedforward-velocity = weight of the velocity feed-forward
row-feedforward-force = { word-force } per acceleration, at the axis
row-feedforward-jerk = { word-force } per jerk, at the axis
row-feedforward-inertia = feed-forward: all inertia, at the motor's shaft
filter-average = moving average of the setpoint; 0: none may act
filter-second-average = second moving average behind the first
filter-tap = weight of the setpoint this many spacings ago, the first the newest
filter-tap-spacing = time between the taps of the setpoint filter
filter-count = filters of the set { word-force } that act, in this order
filter-kind = kind of the filter of the set { word-force }
filter-frequency = its natural frequency
filter-damping = damping ratio: numerator of a notch, denominator of a low-pass
filter-width = damping ratio of the notch's denominator
row-state-gain = { word-force } per unit of this state, fed back through the observer
delay-of-reference = delay of the position setpoint until the fed-forward { word-force } acts

# SINUMERIK
sinumerik-mode = { $dynamic }: { $about }
sinumerik-mode-unit = { $dynamic }; unit
sinumerik-filter-on = jerk filter on
moving-average = moving average
sinumerik-two-averages = two moving averages behind each other
sinumerik-filter-off = jerk filter off: its time would add to the ramp
sinumerik-ffw-mode = 0 none, 3 speed, 4 torque, both with a pure delay
sinumerik-delay = whole delay of the position setpoint
sinumerik-position-cycle = position cycle: product (?), see MD10061
sinumerik-dsc = 1: position loop in the drive (DSC; telegram 105, 106 or with splines), 0: in the control
sinumerik-filters = torque filters that act, one bit each
sinumerik-denominator-frequency = natural frequency of the denominator
sinumerik-numerator-frequency = natural frequency of the numerator
sinumerik-denominator-damping = damping ratio of the denominator
sinumerik-numerator-damping = damping ratio of the numerator
sinumerik-filter-kind = 1 low-pass, 2 second order with a numerator; order of the five parameters
sinumerik-dynamic-modes = DYNNORM and DYNPOS get the recommendation, the others the limits of a machining mode, judged with its own band; acceleration and jerk are a pair: more jerk can mean less acceleration. G0 may use MD32434/MD32435 (factors), JOG uses MD32420/MD32430.
sinumerik-one-mode = DYNNORM and DYNPOS get the recommendation; the other dynamic modes keep what they hold, which was not judged. G0 may use MD32434/MD32435 (factors), JOG uses MD32420/MD32430.
sinumerik-path-jerk = The path jerk MD20600 must stay above the axis values, or it limits instead.
sinumerik-turns = Accelerations count in revolutions, positions and bands in degrees.

# HEIDENHAIN
heidenhain-path = maxPathJerk and maxPathJerkHi (default 40 m/s^3) and maxPathYank limit the path: keep them above the axis values, at least 1.75 x the largest axis value by the maker's rule.
heidenhain-filters = The position filters of the control add jerk time of their own: what they add must not be counted twice.
heidenhain-speed-gains = The speed gains here are currents per speed: they follow from Kp and Tn below only with the motor's torque constant.
heidenhain-itnc = On an iTNC 530 the Kv factor is in (m/min)/mm.

# FANUC; $rapid in $length per minute, $rise in ms, $acceleration in the length's unit, as typed
fanuc-rise-time = time from standstill to rapid traverse, for the value of 1420 below
fanuc-bell-time = bell time, acceleration / jerk
fanuc-no-jerk = There is no jerk in { $length }/s^3 here: the bell time sets it.
fanuc-gain = The velocity gain here is relative to that of the motor's file (2021): Kp below can be set only as a multiple of today's.
fanuc-rapid = Leave 1420 as it is; where it is not the value below, enter 1620 x own value / value below, rounded up, so that the acceleration stays { PLAIN($acceleration, digits: 4) } { $length }/s^2. The bell time 1774 does not change.
fanuc-nano = AI nano contour control takes the time from 1773 instead of 1620, and the bell form needs 1603#6 (RBL) = 1.
fanuc-look-ahead = 1788/1789 (acceleration change) and, not verified (?), 1660, 1671 and 1772 limit look-ahead modes and must not be faster than these values.

# ISG
isg-acceleration-rises = ramp time, acceleration rises
isg-acceleration-falls = ramp time, acceleration falls
isg-deceleration-rises = ramp time, deceleration rises
isg-deceleration-falls = ramp time, deceleration falls
isg-ramp-at-rapid = ramp time at G0
isg-acceleration-at-rapid = acceleration at G0
isg-gear-sets = getriebe[0] is the first gear set; repeat the lines for others.
isg-own-limits = dynamik.a_max must not be below these accelerations nor dynamik.tr_min above these ramp times: the kernel would use its own limits instead.
isg-operation-mode = where the position loop closes; kv acts only with CNC_POSITION_CONTROL
isg-feedforward = 0 none, 0x101 velocity, 0x303 velocity and torque
isg-moving-average = moving average; switch it on with #FILTER ON
isg-slope = The slope must be TRAPEZ, SIN2 or HSC: with STEP, the default, no ramp time acts at all.

# PLC
twincat-jerk-unit = MC_MoveAbsolute of TF5200 takes the jerk in mm/s^3, the TwinCAT 2 CNC took m/s^3: look at the block that you call.
twincat-no-jerk-filter = The setpoint generator needs no jerk filter beside these limits.
twincat-kp = Kp of this loop, at the motor's shaft; AX5000 (AX8000: 3140:01, the same unit)
twincat-tn = Tn of this loop, rounded up; AX5000 (AX8000: 3140:02 in s)
twincat-kv-in-drive = Kv of this loop; AX5000, position loop in the drive
twincat-kv-in-nc = Kv of this loop, (mm/s)/mm; the NC's own, for a drive that takes velocities
plcopen-unit = The unit u of the axis is taken to be 1 { $axis ->
    [rotary] degree
   *[linear] mm
}: check the axis's scaling, and multiply all three values if it differs.
plcopen-jerk-of-zero = A jerk of 0 does not mean none: it selects the default of the axis.
plcopen-quadratic = CODESYS: the jerk acts only with the ramp type quadratic.

# open controls
linuxcnc-jerk = jerk; 0 would switch the limit off
linuxcnc-gain = Kv, for a drive that takes machine units/s
linuxcnc-planner = jerk-limited planner
linuxcnc-path-acceleration = ceiling of every move of the linear axes: never below the largest of their values, a higher one may stay
linuxcnc-path-jerk = path jerk: the least of all linear axes
linuxcnc-units = For LinuxCNC 2.10 and newer; machine units are taken to be mm and degrees.
linuxcnc-joints = Joint numbers assume trivial kinematics: X Y Z A B C U V W are joints 0 to 8.
linuxcnc-least-jerk = MAX_LINEAR_JERK below 1 silently falls back to trapezoids. Home with PLANNER_TYPE = 0.
grblhal-builds = The jerk settings exist only in builds with ENABLE_JERK_ACCELERATION.
grblhal-corners = $11 (junction deviation) sets how fast corners are taken and is not part of this.
fluidnc-no-jerk = FluidNC has released no jerk limit.
fluidnc-degrees = The name says mm, but a rotary axis counts in degrees: the value is in deg/s^2.
klipper-tool-head = of the tool head, so of its slowest axis
klipper-input-shaper = input shaper
klipper-of-mode = of mode { $mode }
shaper-of-run = as in the run
klipper-no-jerk = Klipper has no jerk limit; its square_corner_velocity is a velocity step, no jerk.
klipper-cruise = minimum_cruise_ratio (default 0.5) lowers the velocity of short moves: they are simulated without.
klipper-corner = step of velocity at a right angle
klipper-corner-bound = square_corner_velocity: up to { NUMBER($most, digits: 3) } mm/s the vibration that the step of velocity leaves behind the shaper stays by itself within the reserved share of the band, in every corner of frequency and damping; written is that, at most Klipper's default of { NUMBER($usual, digits: 3) } mm/s. How far the shaper rounds the corner, and whether the motor can jump so far, are not in the model.
klipper-three-humps = 3HUMP_EI was faulty in Klipper from September 2025 until 31 March 2026 (a missing comma, #7235): update Klipper before using it.
klipper-shaper = The shaper makes each move longer by its own length.
marlin-fixed-time = fixed-time motion on
marlin-shaper = 1 ZV, 2 ZVD, 5 EI, 6 and 7 EI with two and three humps, 8 MZV; letters changed between versions
marlin-jerk = What Marlin calls "jerk" (M205) is a velocity step in mm/s, not a jerk.
marlin-corner = junction deviation, for builds with it
marlin-step = largest step of velocity, for builds with CLASSIC_JERK
marlin-corner-bound = M205 J stands for a step of velocity at a right angle, J = v² (sqrt(2) − 1)/a: that of { NUMBER($usual, digits: 3) } mm/s, but at least the 0.01 mm and at most the 0.3 mm that the firmware takes; 0.01 mm is { NUMBER($least, digits: 3) } mm/s with the acceleration that is written at most. Up to { NUMBER($most, digits: 3) } mm/s the vibration that it leaves behind the shaper stays by itself within the reserved share of the band. How far the shaper rounds the corner, and whether the motor can jump so far, are not in the model.
marlin-step-bound = M205 J cannot hold the corner here: the firmware refuses less than 0.01 mm and keeps the old value, and 0.01 mm takes a right angle at { NUMBER($least, digits: 3) } mm/s with the acceleration that is written at most. Up to { NUMBER($most, digits: 3) } mm/s the vibration that the step of velocity leaves behind the shaper stays by itself within the reserved share of the band. So the step itself is written, at most { NUMBER($usual, digits: 3) } mm/s, for a build with CLASSIC_JERK; a build without it rings at corners by more than the band. How far the shaper rounds the corner, and whether the motor can jump so far, are not in the model.
marlin-grid = FT motion places a shaper's copies whole samples of 1 ms apart (FTM_FS = 1000 Hz, shaping.cpp at 195278e4): every frequency of a range gives the same shaper, here its middle is written, so it may differ from the measured one. This is simulated; a build with another FTM_FS shapes otherwise.
marlin-build = M493 needs a build with FT_MOTION; M500 keeps the values.
ros-gain = Kv of the trajectory controller, velocity command interface
export-no-loop = The motor follows its setpoint: nothing of a loop is set here.
