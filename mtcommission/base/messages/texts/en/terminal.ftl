# What the terminal prints of a machine, an optimal control, limits and a response.

terminal-head-seen = Seen by encoder
terminal-head-tool-at-full-force = Tool at { word-f-max }
terminal-head-frequencies = Freq.
terminal-head-dampings = Damp.
terminal-head-move-head = Move
terminal-head-found = Largest
terminal-limits-listed = Limits, listed moves
terminal-check-any-size = Requirement, any size
terminal-filter-with-limits = Setpoint filter, entered with a and j
terminal-loop-today = Loop today: { $gains }.
terminal-head-rigid-body-limit = Rigid-body limit
terminal-head-reason = Reason
terminal-head-arc = Arc
terminal-head-from = From
terminal-head-to = To
terminal-head-peak-deviation = Peak
terminal-head-terminal-error = Terminal error
terminal-head-settling-time = Settling
terminal-head-residual = Residual
terminal-head-meets = Met
terminal-head-basis = What it rests on
terminal-basis-loop = Loop
terminal-basis-neglected = Neglected
terminal-machine = { $name }, axis { $axis_name }
terminal-source = Source of the data: { $source }
terminal-no-warnings = No warnings.
terminal-force-on-mass = { $force } on { $mass }
terminal-time-of-move = Time of move { $number }
terminal-rigid-time = at this acceleration, no jerk limit, no vibration: no control is faster
terminal-time-optimal = Time-optimal control
terminal-damping-optimal = Damping-optimal control
terminal-arc-interior = interior
terminal-arc-boundary = { $name }, { $side ->
    [upper] upper limit
   *[lower] lower limit
}
terminal-more-arcs = { $count } more:
terminal-see-json = see --json
terminal-final-time = { $move }: t_f = { $t_f } at { word-f-max } = { PLAIN($force, digits: 6) } { $unit }, method { $method }.
terminal-grid-proves-nothing = A grid proves no lower bound of t_f; --method exact does.
terminal-lower-bound = No control is faster than { $bound } (relative gap { PLAIN($gap, digits: 1, style: "e") }).
terminal-loose-proof = At most { PLAIN($percent, digits: 1) } % slower than the optimum; exact arcs were not found.
terminal-law-in-cells = { switching-law }: kept to one cell of a mesh. Arcs named "interior" ({ PLAIN($percent, digits: 2) } % of t_f) stand for switches and touch points too close to be told apart; the proof of t_f does not rest on them. What the { word-force } does there is in --csv.
terminal-law-fails = { switching-law }: DOES NOT HOLD.
terminal-origin-of-final-time = t_f is { $origin }.
terminal-final-time-of-option = that of --t-f
terminal-final-time-of-profile = that of the profile (damping_optimal.t_f)
terminal-final-time-by-default = { PLAIN($factor, digits: 6) } times t_f,min: neither --t-f nor the profile gives one
terminal-weight = { $state } { PLAIN($value, digits: 5) } { $unit }
terminal-velocity-exceeded = max_velocity is no part of this optimum: |{ $name }| exceeds it by { PLAIN($percent, digits: 2) } %; --limit { $name }=... with --method transcription keeps it.
terminal-cost = Cost { PLAIN($cost, digits: 9) } { $unit }; the law (16) of the paper kept to { PLAIN($residual, digits: 1, style: "e") } { word-f-max }.
terminal-reached = reached
terminal-not-reached = not reached
terminal-exceeded = exceeded by { PLAIN($percent, digits: 1) } % between the points of the grid
terminal-limit = Limit: { $name } at most { $value }, { $acts }.
terminal-touched = { $limit }, touched for an instant at { PLAIN($ms, digits: 4, style: "f") } ms.
terminal-more-touches = ... and { $count } touch points more: see --json
terminal-assumed = Assumed: { $what }.
terminal-bound-by = Bound by: { $what }.
# $places: each requirement with its worst corner
terminal-worst = Worst corners: { $places }.
# $met: how many of them meet every requirement
terminal-more-rules = Rules of thumb not shown: { $count }; { $met } of them meet every requirement.
terminal-more-notes-in-sheet = More notes: { $count }, see the sheet.
terminal-more-notes-of-run = More notes: { $count }, in the sheet that mtcommission run writes.
terminal-response = Response of the loop
terminal-simulated = Simulated: a { $acceleration }, j { $jerk }, setpoint filter { $filter }; { $moves }.
terminal-saturated = { $force } saturated

switching-law = Switching law { word-f-set } = -sign({ word-lambda }) { word-f-max } (lambda: adjoint, sensitivity of t_f to the states)
# $grid, $boundary: yes or no
terminal-jerk-law = Switching law jerk = -sign({ word-lambda }) j_max: { $holds ->
    [yes] holds where no bound is kept
   *[no] not confirmed
}.
terminal-law-holds = { switching-law }: holds{ $grid ->
    [yes] { " " }within a step of the grid
   *[no] { "" }
}{ $boundary ->
    [yes] { " " }off the boundary arcs
   *[no] { "" }
}.
terminal-weights = { $chosen ->
    [stated] Weights, from the profile
   *[balanced] Weights, balanced
}: { $weights }
terminal-of-motor = what the motor follows, as stated
