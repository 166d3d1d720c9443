# Axes that move together: circle, corner, one filter, one delay.

stage-group = circles and corners
group-tolerance-missing = missing: no axis states requirements.contour_deviation; write how far the tool may be off the contour, e.g. --tolerance 10um
group-feed-missing = missing: no axis states requirements.contour_feed or a velocity of its moves; write the fastest feed at which contours are followed, e.g. --feed 6m/min
group-count = got { $got } profiles; axes that move together are { $least } or { $most }: give the profile of each
group-rotary = axis { $name } turns; circles and corners are those of linear axes: leave it out
group-same-name = axis { $name } has the name of that in { $other }; write the name that the control has, e.g. axis = "Y"
group-other-control = got "{ $got }", the first axis has "{ $first }"; axes that move together have one control: make them alike
group-other-drive = one axis has a position loop, the other follows its setpoint; axes that move together are driven alike
group-other-cycle = got { TIME($got) }, the first axis has { TIME($first) }; axes that move together have one cycle: make them alike
group-other-filter = gives another setpoint filter than the first axis; axes that move together need the same: make them alike, or write "auto" for it to be chosen
group-tolerance-large = got { LENGTH($got) }, must be { LENGTH($most) } at most; write the unit, e.g. 10um
group-bound-acceleration = acceleration limit
group-bound-jerk = jerk limit
group-bound-path-acceleration = path acceleration
group-bound-path-jerk = path jerk
group-bound-velocity = velocity of the moves
group-bound-entry = tolerance: entry
group-bound-filter = tolerance: setpoint filter
group-bound-delay = tolerance: unequal delays
group-bound-loop = tolerance: loop
group-bound-friction = peak at reversal
group-where-circle = radius { LENGTH($radius) } at { FEED($feed) }
group-check-circle = contour on circles, friction apart
group-where-line = line at { NUMBER($slope, digits: 2) }° up to { FEED($feed) }
group-check-line = contour on lines
group-check-peak = peak at reversal, { $name }
group-check-along = deviation along, { $name }
group-check-of = { $requirement }, { $name }
group-delays-apart = The delays of the axes differ by { TIME($apart) }, and no place for a wait is known in this control: at { FEED($feed) } that alone makes circles oval. Give the other axes the control.force_filters of { $slowest } and compute again.
group-other-contours = Circles, corners and lines are judged within { LENGTH($tolerance) }; along the own moves of an axis the contour_deviation of its profile: { $of }.
group-contour-of = { $name } { LENGTH($tolerance) }
group-path-friction = Path limits exceed those of the axes in no direction, friction included{ $viscous ->
    [yes] {" "}but for the viscous one.
   *[no] .
}
group-next-contour = next: the same command with --tolerance { $tolerance }, which these axes keep, or with a lower --feed
group-next-peak = next: let the control compensate the friction of { $names }, then measure a circle; uncompensated, the same command with --tolerance { $tolerance }
group-next-path = next: the same command with a larger --tolerance or a lower --feed: limits of the path slow the axes
group-next-axis = next: mtcommission run { $profile }, which says what hinders axis { $name } alone
group-peaks-forbid = Even at { FEED($feed) } a reversal of { $name } throws the tool off by { LENGTH($peak) }, more than { LENGTH($tolerance) }: no feed is given with these peaks. Let the control compensate friction, or raise the tolerance; the last columns hold without them.
group-feed-without-peaks = Without peaks
group-one-circle = Only circles of { LENGTH($radius) } were judged, as --radius asks: others may leave the tolerance.
group-one-plane = Only circles, corners and lines of { $first } and { $second } were judged, as --plane says: compute the other planes, too, and type in the least of their path limits.
group-no-friction = No friction is stated: peaks where an axis reverses are left out. Write drive.coulomb_friction, or let identify find it.
group-path-slows = The limits of the path make every move slower: settling times and verdict count with them.
group-wait-in-parts = That the control waits in parts of a position cycle was not read (?): measure how oval a circle is.
group-rule-not-verified = How this control takes corners was not read in its manual: (?) marks its names.
group-contour-not-kept = No limits of the path that can be told keep the tolerance: raise the tolerance, lower --feed, or stiffen the axes.
group-path-without-place = No place for path limits is known in this control: the limits of the axes are lowered until circles and lines keep the tolerance.
group-bound-by-contour = contour on circles and lines (no place for path limits is known)
group-one-shaper = One shaper for all axes: it is on the mode of one of them.
group-axes = { $name }, axes { $axes }
group-wait = Wait
group-delay = Delay
group-angle = Corner
group-radius = Radius
group-radius-deviation = Radius error
group-form-deviation = Form
group-peak = Peak { $name }
group-circle-of = Circle, radius { LENGTH($radius) }
group-corner-told = Corners: { $kind ->
    [arc] { $name } { LENGTH($value) } of the tolerance for the arc.
    [junction] { $name } { VELOCITY($value) } (speed at 90°).
    [deviation] { $name } { LENGTH($value) } (junction deviation).
    [own] { $name } { LENGTH($value) } (the control's own filter, not simulated).
   *[step] { $name } velocity step of an axis { FEED($value) }.
}
group-corner-no-arc = Corners: no arc within the tolerance is faster than to turn at once at the speeds over the angle.
group-corner-no-value = Corners: pass them at the speeds over the angle; no value that keeps these is known for this control.
group-tolerance = Contour tolerance { LENGTH($tolerance) } up to { FEED($feed) }

# Export of a group: what controls read comes without special letters.
group-row-wait = extra delay, by which the axis waits for the slowest
group-row-match = the axis waits for the slowest
group-row-acceleration = path acceleration; where below the limits of the axes it slows every move
group-row-jerk = path jerk; where below the limits of the axes it slows every move
group-row-acceleration-on = the ceiling of the path acceleration acts
group-row-step = step of velocity that corners may ask of an axis
group-row-speed = speed at a right angle
group-row-arc = how far the rounding of a corner may be off it
group-row-deviation = junction deviation
group-row-parabola = distance of the parabola from the corner; an arc was simulated
group-row-tolerance = contour tolerance; the control's own filters are not simulated
group-part-axis = Axis { $name }
group-part-path = Path of all axes
group-export-not-met = THE GROUP DOES NOT MEET ALL REQUIREMENTS: { $checks }.
group-export-title = { $name }, axes { $axes }: limits and loops that go together, for { $control }
# $radius: mm, $feed: m/min
group-export-circle = Circle, radius { NUMBER($radius, digits: 4) } mm at { NUMBER($feed, digits: 4) } m/min, simulated from this text, worst case, friction apart: radius { $deviation }, form { $form }; as in the record but for rounding, by 0.1 um or 1 % at most.
group-export-other-circle = Circle, radius { NUMBER($radius, digits: 4) } mm at { NUMBER($feed, digits: 4) } m/min, simulated from this text, worst case, friction apart: radius { $deviation }, form { $form }; NOT AS IN THE RECORD: radius { $planned }, form { $planned_form }. The control lacks what the group counts on, or rounds it: compute the profiles for this control.
group-export-line = Lines up to { NUMBER($feed, digits: 4) } m/min, simulated from this text, in the worst direction: off by { $deviation }.
group-export-of = Axis { $name }: { $said }
group-export-without-place = NOT IN THIS TEXT, for no place of it is known in this control: { $values }.
group-wait-without-place = wait { $waits }
group-acceleration-without-place = path acceleration { SI($value, "ACCELERATION") }
group-jerk-without-place = path jerk { SI($value, "JERK") }
group-wait-of = { $name } { TIME($wait) }
group-export-same-name = { $control } has one name for the axes { $names }: give them letters of their own in machine.axis, compute the group again, or use --control generic
group-export-no-corner = NO VALUE FOR CORNERS: pass them at the speeds over the angle of the record (program them as feed before the corner, or stop there). A value belongs to the control that the group was computed for; there is none where no rounding within the tolerance is faster than turning at once.

# Recorded circles. $name, $first, $second, $later, $sooner: axes; $number: of the circle
circle = Circle { $number }
group-circle-radius = mean radius
group-circle-form = oval (largest less smallest radius)
group-circle-delay = delay, { $name }
group-circle-quadrant-peak = peak at reversal, { $name }
group-recorded-caption = Circle { $number }: { $file }, { LENGTH($radius) } at { FEED($feed) }, { $direction ->
    [clockwise] clockwise
   *[counterclockwise] counterclockwise
}, { NUMBER($turns, digits: 3) } turns.
# in µm/m
group-squareness-found = Left out as squareness: the angle of the axes is off a right one by { NUMBER($value, digits: 3) } ± { NUMBER($uncertainty, digits: 2) } µm/m (positive: less than 90°).
group-squareness-unknown = Squareness cannot be told from unequal delays by circles of one direction and feed: record the other direction, too.
group-one-direction = the oval may as well be the angle of the axes, off a right one by { NUMBER($squareness, digits: 3) } µm/m; record a circle in the other direction, too
group-radius-assumed = nobody told the programmed radius, taken as { LENGTH($radius) }; record the setpoint, or calibrate the ballbar
group-peak-not-seen = no whole reversal lies in the record; let the circle go on for two turns
group-friction-unknown = the record states no friction of { $name }: write drive.coulomb_friction and compute the group again
group-trace-radius = { $file }: no setpoint recorded, the radius is taken as { LENGTH($radius) }.
group-trace-too-fast = { $file }: this circle needs { SI($got, "ACCELERATION") }, the group's path limit is { SI($most, "ACCELERATION") }: it was driven with other limits, or slower in part.
group-trace-columns = no circle among the columns { $found }; needed are { $first } and { $second } (actual positions; { $first }_ref and { $second }_ref beside them), or angle and radius: name them by --columns NAME=COLUMN
group-trace-angle-unit = { $name } has no unit; write it behind the name, e.g. angle [deg], or --columns "angle={ $name } [deg]"
group-trace-no-length = { $name } [{ $unit }] is no length; write its unit behind the name, e.g. [mm], or give another column by --columns
group-trace-no-angle = { $name } [{ $unit }] is no angle; write its unit behind the name, e.g. [deg], or give another column by --columns
group-trace-size = the circle has a radius of { LENGTH($radius) }, which no circle test has; look at the units, and give the whole radius, not its deviation
group-trace-no-circle = is no circle: this sample is { LENGTH($off) } off the one through most of them; cut the record to the circle, or look at the columns
group-trace-arc = the longest stretch at constant feed goes round { $got }°; a whole turn is needed: record at least two turns, with their run-in
group-plot-angle = angle, °
group-plot-deviation = deviation of the radius
group-line-measured = measured
group-line-fitted = fitted, reversals apart
group-line-predicted = predicted, nominal machine
group-verify-one-axis = is for the record of one axis; leave it out for a group
# The sheet.
group-title = Axis group
group-axes-named = axes { $axes }
group-verdict-heading = Verdict and values to enter for the group
group-contours-heading = Circle and corner, and what to measure
group-missed = Not kept: { $checks }.
group-path-acceleration = Path acceleration
group-path-jerk = Path jerk
group-typed-caption = Typed in for each axis and the path; export group.json has every parameter, with its switches ("(?)": not read in a maker's text, verify; ">": in the drive)
group-filter-chosen = settles first of those that leave circles alone
group-filter-binds = allows the fastest circles
group-bound-by-axis = limit of axis { $name }
group-bound-by-tolerance = contour tolerance
group-bound-by-axes = nothing (the limits of the axes hold)
group-path-none = those of the axes
group-corners = Corners
group-path-column = Path
group-axis-today = { $name } today
group-axis-new = { $name } new
group-bound-of = { $name } is bound by: { $by }.
group-settles = Settling with path limits
group-rise-time = Rise time
group-force-filters = Kp keeps its margins only with these filters in the drive; enter them first, as export group.json writes them: { $filters }.
group-feedforward = Feed-forward
group-balancing = Delay of setpoint
group-circle-caption = Circle test as it comes out in the nominal machine, radius { LENGTH($radius) }
group-circle-alt = Circles of radius { LENGTH($radius) } at { $feeds }, the deviation magnified: one division is { LENGTH($division) }, the tolerance { LENGTH($tolerance) } on either side.
group-circle-band = Tolerance ± { LENGTH($tolerance) }
group-circle-nominal = Nominal circle
group-circle-division = One division: { $division }
group-circle-turn = Counterclockwise (G3)
group-circle-figures = { $feed }: F { $least } to { $largest }, G { $circular }
group-feeds-caption = Largest feed of circles within { LENGTH($tolerance) }
group-corners-caption = Speed at corners (unslowed: at { FEED($feed) })
group-corner-speed = Speed
group-not-slowed = Unslowed
group-measure-caption = To measure: circle of { LENGTH($radius) }, counterclockwise, full turns; tolerance { LENGTH($tolerance) }
group-measured-largest = Radial deviation Fmax
group-measured-least = Radial deviation Fmin
group-measured-circular = Circular deviation G
group-worst-radius = Error of the mean radius, friction apart, worst corner
group-worst-form = Largest − smallest radius, friction apart, worst corner
group-measure-centre = F and G as in ISO 230-4, centred by least squares; calculated for the nominal machine, peaks at reversal included (the requirements count them apart), geometry left out (squareness, pitch and straightness errors add to it).
group-measure-turn = Clockwise (G2) an ellipse from unequal delays lies under the other diagonal; one that stays is squareness.
group-measure-peaks = Peaks stand behind the reversals, where the sign of an axis' velocity changes: right and left those of { $first }, above and below those of { $second }.

# The interactive page.
group-page-heading = Try feed, radius and corner
group-page-intro = Slide or type: circle and corner follow, computed from this record as the command group does.
group-page-no-script = Trying values needs JavaScript.
group-page-circle-caption = Circle, deviation magnified
group-page-circle-note = Nominal machine, counterclockwise; dashed: tolerance. Peaks at reversals lie between those of the feeds that were computed.
group-page-corner-caption = Corner
group-page-corner-note = Nominal machine, entered along the first axis; dashed: tolerance about the corner.
group-page-values = Circle and corner, worst corner of the machine unless nominal is said
group-page-permitted = Permitted
group-page-keeps = Circles come out within { $value }, they may use { $limit }; peaks at reversal stand below.
group-page-throws = A reversal throws the tool off by { $value }, more than { $limit }.
group-page-misses = Circles are off by { $value }, more than the { $limit } they may use.
group-page-too-fast = This circle needs a path acceleration of { $value }, more than { $limit }.
group-page-beyond = So small a circle was not computed at this feed: slower, or larger.
group-page-unslowed = unslowed, { $value }: off by { $size }
group-page-slowed = slowed to { $value }
group-page-division = one division { $value }
group-page-band = tolerance ± { $value }
group-page-row-acceleration = Path acceleration v²/R
group-page-row-largest = Largest deviation of the circle
group-page-row-radius = of it mean radius
group-page-row-form = of it form (largest less smallest radius)
group-page-row-entry = Deviation at the entry
group-page-row-most = Fmax, nominal, reversals included
group-page-row-least = Fmin, nominal, reversals included
group-page-row-circular = G, nominal, reversals included
group-page-row-peak = Peak at reversal, { $name }, nominal
group-page-row-corner = Corner without slowing
group-page-row-speed = Speed at the corner within the tolerance
group-page-field-feed = Feed
group-page-field-radius = Radius of the circle
group-page-field-angle = Change of direction at the corner

# in µm/m
group-may-be-scale = a scale that is off by { NUMBER($scale, digits: 3) } µm/m, by pitch or temperature, does the same; measure the scales of the axes
