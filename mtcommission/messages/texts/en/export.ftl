# Limits in a control's own words. Controls read these files: signs of ASCII only.
# $axis_name: the user's name of the axis; $mode: of a machining mode or of a mode of vibration

# what cannot be exported
export-mode-without-limits = no limits meet the requirements of machining mode { $mode }
export-profile-edited = the profile in this record was edited: it does not have the hash of the run; run the changed profile instead
export-other-loop = the loop in this record is not the one that its profile and gains give; run the profile again with this version
export-too-small = the acceleration of { SI($acceleration, "ACCELERATION", digits: 3) } is less than one unit of this control; use --control generic
export-no-control = no control { $given }. There are: { $there_are }
export-no-control-but = no control { $given }; did you mean { $meant }? There are: { $there_are }
export-other-letter = { $control } names its axes { $letters }; this record is of axis "{ $axis_name }": begin machine.axis with one of these letters, or use --control generic
export-linear-only = { $control } limits linear axes only, this one is rotary; use --control generic

# the header
export-title = { $name }, axis { $axis_name }: limits for { $control }
export-computed = Computed { $created } by { $tool } from { $profile }
export-hash = Profile SHA-256 { $hash }
export-verify = VERIFY BEFORE USE. Calculated, not measured: not an acceptance test (ISO 230). Enter by hand, note the old values, try at reduced override.
export-safe-side = Each limit is rounded to the safe side. Units stand beside the values.
export-moving-average = These limits go with a moving-average setpoint filter of { PLAIN($time, digits: 4, unit: "ms") } ms in the control (the profile's setpoint_filter); without it they are not valid.
export-warning = WARNING: { $warning }
export-not-measured = Default accepted, not measured: { $keys }.
export-doubt = (?) means: name or unit not verified, check against the list manual of your software version.
export-verified = read in the maker's text
export-doubted = (?) check against the list manual of your software version
# $gains: which ones are exported
export-judged = Simulated with exactly these limits{ $gains ->
    [all] {" "}and these gains
    [Kv] {" "}and this Kv
   *[none] {""}
} in { $corners ->
    [1] the nominal machine
   *[other] { $corners } corners
}: settling time { $settling }, residual deviation { $residual } (recommended limits: { $recommended })
export-all-met = { $judged }; all requirements met.
export-not-all-met = { $judged }; REQUIREMENTS NOT MET: { $missed }.
export-missed = { $name } { $value }, allowed { $limit }
export-mode-missed = no limits for machining mode { $mode }
export-not-settled = not settled
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
control-generic = any control: SI values in neutral words
control-linuxcnc = LinuxCNC 2.10 and newer
control-klipper = Klipper
control-grblhal = grblHAL
control-fluidnc = FluidNC
control-marlin = Marlin
control-ros2 = ROS 2 / MoveIt

# machining modes
export-mode-surface = surface
export-mode-accuracy = accuracy
export-mode-speed = speed

# parameters
export-old = old
export-for-nc-program = For the NC program, not for the PLC: { $remark }
export-head-parameter = Parameter
export-head-new-value = new value
export-head-unit = unit
export-head-old-value = old value
export-head-meaning = meaning
limit-acceleration = acceleration
limit-deceleration = deceleration
limit-jerk = jerk
limit-itself = limit
limit-path-nci = path acceleration, deceleration, jerk (NCI)
limit-jerk-time = acceleration / jerk, rounded up
limit-axis-jerk = axis jerk
limit-axis-jerk-at-rapid = axis jerk at rapid; the maker's rule of 5 x axPathJerk was not judged
limit-recommended = recommended
limit-of-mode = { $mode }, band { $band }, met
gain-position = position gain of this loop
gain-velocity = velocity gain
gain-integral-time = integral time, rounded up
gain-kv = Kv of this loop
gain-kv-name-and-unit = Kv of this loop; name and unit
gain-feed-forward-name = velocity feed-forward of this loop; name
gain-kp-at-axis = Kp of this loop, at the axis; a rotary motor needs Nms/rad at its shaft
gain-tn-unit = Tn of this loop, rounded up; unit
delay-of-reference = delay of the reference path

# SINUMERIK
sinumerik-mode = { $dynamic }: { $about }
sinumerik-mode-unit = { $dynamic }; unit
sinumerik-jerk-filter = Alternative with the jerk filter MD32400
sinumerik-ramp-too-long = The ramp of { PLAIN($ramp, digits: 4, unit: "ms") } ms is longer than the filter's usual range of { PLAIN($longest, digits: 4, unit: "ms") } ms ({ $cycles } position cycles), so there is no alternative with the jerk filter here.
sinumerik-filter-instead = Set the filter INSTEAD of the jerk limit: raise MD32431 until it no longer acts, keep the acceleration. Both together would count the jerk time twice.
sinumerik-filter-simulated = Simulated so, it { $met ->
    [yes] meets
   *[no] DOES NOT MEET
} all requirements, settling after { $settling }. The filter also acts on moves that never reach the acceleration, where a jerk limit leaves vibration.
sinumerik-filter-on = jerk filter on
sinumerik-moving-average = moving average
sinumerik-cycles = { $count } position cycles
sinumerik-left-out = { $dynamic } IS LEFT OUT: { $why }. Do not use this mode with the old values.
sinumerik-dynamic-modes = DYNNORM and DYNPOS get the recommendation, the others the limits of a machining mode, judged with its own band. G0 may use MD32434/MD32435 (factors), JOG uses MD32420/MD32430.
sinumerik-path-jerk = The path jerk MD20600 must stay above the axis values, or it limits instead.
sinumerik-filter-already-on = If a jerk filter is already on (MD32400 = 1), its time adds to the ramp: switch it off, or use the alternative below.
sinumerik-turns = Accelerations count in revolutions, positions and bands in degrees.

# HEIDENHAIN
heidenhain-mode = Machining mode { $mode }
heidenhain-judged = Judged with a band of its own, { $band }: met.
heidenhain-left-out = LEFT OUT: { $why }.
heidenhain-path = maxPathJerk and maxPathJerkHi (default 40 m/s^3) and maxPathYank limit the path: keep them above the axis values, at least 1.75 x the largest axis value by the maker's rule.
heidenhain-filters = The position filters of the control add jerk time of their own: what they add must not be counted twice.
heidenhain-itnc = On an iTNC 530 the Kv factor is in (m/min)/mm.

# FANUC; $rapid in $length per minute, $rise in ms, $acceleration in the length's unit, as typed
fanuc-rise-time = time from standstill to rapid traverse, if 1420 = { $rapid } { $unit }
fanuc-bell-time = bell time, acceleration / jerk
fanuc-no-jerk = There is no jerk in { $length }/s^3 here: the bell time sets it.
fanuc-rapid = The largest velocity of the profile is { $rapid } { $length }/min. Leave 1420 as it is; where it is another one, enter 1620 = { $rise } ms x 1420 / { $rapid }, rounded up, so that the acceleration stays { PLAIN($acceleration, digits: 4) } { $length }/s^2. The bell time 1774 does not change.
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

# PLC
twincat-jerk-unit = MC_MoveAbsolute of TF5200 takes the jerk in mm/s^3, the TwinCAT 2 CNC took m/s^3: look at the block that you call.
twincat-no-jerk-filter = The setpoint generator needs no jerk filter beside these limits.
plcopen-unit = The unit u of the axis is taken to be 1 { $axis ->
    [rotary] degree
   *[linear] mm
}: check the axis's scaling, and multiply all three values if it differs.
plcopen-jerk-of-zero = A jerk of 0 does not mean none: it selects the default of the axis.

# open controls
linuxcnc-jerk = jerk; 0 would switch the limit off
linuxcnc-planner = jerk-limited planner
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
klipper-mode = mode { $mode }
klipper-of-mode = of mode { $mode }
klipper-no-jerk = Klipper has no jerk limit; its square_corner_velocity is a velocity step, no jerk.
klipper-shaper = The shaper quiets mode { $mode }; it makes each move longer by its own length.
marlin-fixed-time = fixed-time motion on
marlin-shaper = { $shaper } shaper on mode { $mode }; letters changed between versions
marlin-jerk = What Marlin calls "jerk" (M205) is a velocity step in mm/s, not a jerk.
marlin-build = M493 needs a build with FT_MOTION; M500 keeps the values.
