# What was chosen for the feedback loop, by which rule, what is poor about it, and what failed.

# One remark of two sentences; $first and $second are messages.

# By which rule a gain was chosen
loop-kp-symmetrical-optimum = Kp by the symmetrical optimum, m / (2 T_σ).
# $fraction: of the optimum
loop-kp-largest = Kp = { PLAIN($fraction, digits: 2) } × the symmetrical optimum, m / (2 T_σ): the largest that keeps the margins in every corner.
loop-tn-yaskawa = Tn = 4 m / Kp (Yaskawa's lower bound for the speed loop).
loop-kv-damping-one = Kv = Kp / (4 m): speed loop damping 1.
# $ratio: Tn Kp / m and Kv m / Kp
loop-tn-searched = Tn = { PLAIN($ratio, digits: 3) } m / Kp, by the search.
loop-kv-searched = Kv = { PLAIN($ratio, digits: 3) } Kp / m, by the search.
loop-reference-delay = Reference delay: 1.5 position cycles + 1 velocity cycle + the { word-force } lag that the jerk feed-forward leaves + the filters, so that feed-forward and feedback meet.

# State feedback; $mode, $modes: names of modes as the profile spells them
loop-unseen-modes = The sensors do not see mode { $modes }: no feedback can damp it.
# $detail: one of the next two, or why the design failed
loop-no-state-feedback = No state feedback: { $detail }.
loop-sees-no-mode = the sensors see no mode that moves the tool
loop-state-feedback-loses = none keeps the margins, minimum_bandwidth and the stiffness of the cascade by the classic rule
loop-state-feedback = State feedback (LQR around the cascade, Kalman observer on { $sensors }): damping ratio of mode { $mode } { NUMBER($own, digits: 3) } without control, { NUMBER($feedback, digits: 3) } with it.
loop-observed-encoder-and-tcp = encoder and tcp

loop-lacks-bandwidth = the fastest loop with the margins has { PLAIN($reached, digits: 3) } Hz, minimum_bandwidth is { PLAIN($wanted, digits: 3) } Hz

# Poles of which a mode holds a share; frequencies in Hz

# Margins: dB, degrees; they may be infinite
loop-without-margins = none: the loop is unstable (worst corner)
loop-margins = { PLAIN($gain, digits: 3) } dB, { PLAIN($phase, digits: 3) } degrees, sensitivity peak { PLAIN($peak, digits: 3) } (worst corner)
loop-given-gains-poor = The given gains are used as given, but their margins are poor: { $margins }; wanted are { PLAIN($gain, digits: 3) } dB, { PLAIN($phase, digits: 3) } degrees, sensitivity peak at most { PLAIN($peak, digits: 3) }. { $cure }.
loop-given-gains-slow = With the given gains the closed velocity loop reaches { PLAIN($reached, digits: 3) } Hz in its worst corner, less than minimum_bandwidth = { PLAIN($wanted, digits: 3) } Hz.
loop-filters-soften = The { $axis ->
    [rotary] set-torque
   *[linear] set-force
} filters make the loop soft: its bandwidth is { PLAIN($filtered, digits: 3) } Hz with them, { PLAIN($unfiltered, digits: 3) } Hz without.
loop-takes-damping = The loop takes damping from mode { $mode }: its damping ratio is { NUMBER($closed, digits: 3) } in the closed loop, { NUMBER($own, digits: 3) } without control.

# What to change; $gains: the messages that follow
loop-cure = The margins would hold with { $gains }, all other given values as they are
loop-no-cure = No single gain, changed up to a thousandfold, cures that; leave the gains out to have them tuned
loop-cure-kv = Kv up to { NUMBER($value) } 1/s
loop-cure-kp = Kp up to { NUMBER($value) } { $axis ->
    [rotary] N m s/rad
   *[linear] N s/m
}
loop-cure-kp-from = Kp from { NUMBER($value) } { $axis ->
    [rotary] N m s/rad
   *[linear] N s/m
} on
loop-cure-tn = Tn from { TIME($value) } on

# Details of outcomes that end the tuning
loop-unstable = with Kv = { NUMBER($Kv) } 1/s, Kp = { SI($Kp, "DAMPING") }, Tn = { PLAIN($Tn) } s ({ $corner }). { $cure }
loop-no-margins = at Kp = { SI($Kp, "DAMPING") }, { SHARE($share) } of the symmetrical optimum, there are { $margins }
loop-mode-without-damping = mode { $mode } ({ PLAIN($frequency) } Hz) has damping ratio 0
loop-hidden-states = state feedback of { $states }
# $error: what the solver said
loop-observer-failed = observer: { $error }
loop-gains-failed = gains: { $error }

loop-motor-follows = no loop to tune: the motor follows its setpoint, { TIME($delay) } late, which is what two setpoints take; the acceleration judged is that of the setpoint behind its filter, which is the motor's own
move-of-many-cycles = a move of { PLAIN($time) } s is { ROUND($cycles, digits: 3) } velocity cycles of { TIME($cycle) }, followed are { ROUND($most, digits: 3) } at most
