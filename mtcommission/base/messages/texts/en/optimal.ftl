# What was computed when an optimal control could not be found.
# $unit: of the signal or of the force, as the plant names it

signal-bound = |{ $signal }| <= { PLAIN($value, digits: 6) } { $unit }
value-about = { PLAIN($value, digits: 4) } { $unit }

bound-below-need = { $bound }, the move needs at least { PLAIN($least, digits: 6) } { $unit }
bound-not-positive = { $bound }, the move needs more than 0
bounds-near-least = { $bounds }: within { PLAIN($within, digits: 1, unit: "%") } % of the least possible
bounds-below-least = { $bounds }: the smallest possible is about { $least }
bounds-beyond-time = { $bounds }: t_f would be longer than { PLAIN($t_f) } s
bounds-need-longer = t_f = { PLAIN($t_f, digits: 6, unit: "ms") } ms is too short for { $bounds }: the time-optimal control under the same bounds tells how long they take

bounded-optimum-not-found = time-optimal control under { $bounds } and { PLAIN($force, digits: 6) } { $unit }
optimum-too-long = an optimal control of { PLAIN($t_f) } s is { ROUND($radians, digits: 3) } rad of what is fastest in the machine, at most { ROUND($most, digits: 2) } are computed
grid-search-stopped = search for t_f on the grid stopped at { PLAIN($t_f, digits: 6) } s
grid-program-unfinished = the linear program of { PLAIN($cells, digits: 9) } cells for { PLAIN($t_f, digits: 6) } s did not end
free-motion-rings-on = the free motion after the end takes too long to decay to be watched
band-program-gave-up = the linear program of the optimum with the band did not end
band-exchange-goes-on = further peaks of the free motion leave the band however many are held

damping-not-solved = damping-optimal control for t_f = { PLAIN($t_f, digits: 6) } s and { PLAIN($force, digits: 6) } { $unit }: solved down to a limit of { PLAIN($solved, digits: 6) } { $unit } only

ipopt-ended = IPOPT ended with { $status } after { PLAIN($iterations, digits: 9) } iterations, { $scheme } scheme, { PLAIN($intervals, digits: 9) } intervals
ipopt-ended-at = t_f = { PLAIN($t_f, digits: 6) } s: { $ended }
ipopt-went-far = IPOPT went to t_f = { PLAIN($t_f) } s
target-not-reached = { PLAIN($reach, digits: 9) } of the target is reached at t_f = { PLAIN($t_f, digits: 9) } s

force-left = { word-force } left for motion { PLAIN($force, digits: 6) } { $unit }
modes-answer-alike = { PLAIN($force, digits: 6) } { $unit } end the move after some { PLAIN($t_f, digits: 3) } s, { PLAIN($angle, digits: 2) } rad of the slowest mode; rounding then leaves { PLAIN($doubt, digits: 1) } of t_f in doubt
no-control-reaches-rest = no control for span { PLAIN($span, digits: 6) } next to { PLAIN($t_f, digits: 9) } s reaches rest
multipliers-prove-beyond = the multipliers prove a time beyond { PLAIN($t_f, digits: 3) } s
optimum-not-accurate = t_f = { PLAIN($t_f, digits: 9) } s with { PLAIN($switches, digits: 9) } switches, relative gap { PLAIN($gap, digits: 2) } (at most { PLAIN($allowed_gap, digits: 6) }), terminal error of { $state } { PLAIN($error, digits: 2) } of its peak (at most { PLAIN($allowed_error, digits: 6) })
