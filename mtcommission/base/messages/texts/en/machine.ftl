# What is unusual about a machine; everything in SI.

# $of: a name; $what: one of the remarks below
remark = { $of }: { $what }
mode-named = mode { $mode }
mode-rings-long = { ROUND($frequency, digits: 3) } Hz at a damping ratio of { ROUND($damping_ratio, digits: 3) } rings for { ROUND($time, digits: 3) } s until 1 % is left
mode-rings-for-ever = { ROUND($frequency, digits: 3) } Hz at a damping ratio of { ROUND($damping_ratio, digits: 3) } rings for ever
cycle-shorter-than-drives-have = { ROUND($cycle, digits: 3, unit: "us") } us is shorter than drives have, 31.25 us to 1 ms
mode-damping-unusual = damping ratio { ROUND($damping_ratio, digits: 3) } is not what machine structures show, { ROUND($low) } to { ROUND($high) }
mode-slow = { ROUND($frequency, digits: 3) } Hz is slower than any machine structure; check stiffness and { word-mass }
# $rate [Hz]
mode-above-velocity-sampling = { ROUND($frequency, digits: 3) } Hz is above a third of the velocity loop's sampling rate, { ROUND($rate) } Hz; no feedback can damp it
mode-above-position-sampling = { ROUND($frequency, digits: 3) } Hz is above a third of the position loop's sampling rate, { ROUND($rate) } Hz; setpoints at that cycle cannot shape it
mode-of-few-position-cycles = one period has only { ROUND($cycles, digits: 2) } position cycles of { ROUND($cycle, digits: 3, unit: "ms") } ms; a jerk time can only be set that coarsely
measured-not-described = misfit { ROUND($misfit, digits: 3) }, at most { ROUND($most) }: the model does not describe what was measured, and mass, modes and intervals of this profile may be wrong; measure again (see its first line)
mode-unseen = neither tool nor encoder sees it; it costs time in the optimum for nothing
mode-gain-large = its gain is { ROUND($ratio, digits: 3) } times 1/moving_mass; check the unit of the gains
mode-bends-far = the full { word-force } bends the tool by { LENGTH($deflection, digits: 3) }, { ROUND($ratio, digits: 3) } times tcp_deviation = { LENGTH($band, digits: 3) }; check the stiffness and the band
acceleration-unusual = { FORCE($force) }{ $axis ->
    [open-loop] { "" }
   *[other] { " " }on { MASS($mass) }
} give { ACCELERATION($acceleration, digits: 3) }, which is not what machine axes do; check both units
static-load-large = { FORCE($load) } take more than half of { word-max-force } = { FORCE($max_force) }; consider a counterbalance
continuous-force-above-max = { FORCE($force) } is above { word-max-force } = { FORCE($max_force) }, so it limits nothing; the two may be swapped
force-lag-long = { ROUND($lag, digits: 3, unit: "ms") } ms is long for a { word-force } loop (servo drives: 0.5 to 5 ms)
move-lasts-long = a rigid axis would need { ROUND($time, digits: 3) } s for this move; check { $axis ->
    [rotary] angle, velocity and torque
   *[linear] distance, velocity and { word-force }
}
move-fast = { VELOCITY($velocity) } is faster than machine axes move, { VELOCITY($fastest) }; check the unit
band-unusual = { LENGTH($band, digits: 3) } is no usual accuracy; check the unit
payload-large = the payload, { MASS($payload) }, is more than three times the moving { word-mass }, { MASS($mass) }; one set of limits will be slow for the empty axis
bands-not-widening = the bands of the machining modes, surface { ROUND($surface, digits: 3) }, accuracy { ROUND($accuracy, digits: 3) } and speed { SI($speed, "LENGTH", digits: 3) }, do not widen in this order; they may be swapped
feedforward-mass-far = { MASS($mass) } in the feed-forward is far from the moving { word-mass }, { ROUND($low) } to { SI($high, "MASS") }; the feed-forward will push too little or too much
# $gain [1/s], $in_custom [(m/min)/mm]
position-gain-without-unit = Kv = { ROUND($gain) } 1/s is only { ROUND($in_custom, digits: 3) } (m/min)/mm; if { ROUND($gain) } (m/min)/mm is meant, write the unit: "{ ROUND($gain) } (m/min)/mm"
# $bandwidth, $rate [Hz]
bandwidth-above-sampling = a least bandwidth of { ROUND($bandwidth) } Hz is above a third of the velocity loop's sampling rate, { ROUND($rate) } Hz

# On what results rest.
feature-counted = { $count } { $feature }
feature-unread = { $feature } (?)
kind-has-all = has { $has }
kind-has = has { $has }; lacks { $lacks }
assumed-acceleration-at = { ACCELERATION($acceleration) } at every velocity, which is what its curve leaves up to { VELOCITY($velocity) }
neglected-steps = open-loop steps (a stiff position loop stands in for the motor)
neglected-force-over-speed = { word-force } falling with speed ({ word-max-force } holds at the fastest)
neglected-heat = heating of the motor (state its continuous { word-force })
neglected-friction = friction and backlash (errors at standstill of their own)
neglected-encoder = encoder steps (state the encoder's resolution)
neglected-travel = modes changing over the travel (widen the spread of frequencies)

# A motor that follows its setpoint
motor-follows-assumed = the motor follows its setpoint exactly: no step is lost, and the structure does not pull it back
drive-kind-steps = this control sends steps open loop; if the motor simply follows them, state drive.kind = "position_source", with the frequencies that the modes have while the motor is held: they differ from those of a free axis
neglected-lost-steps = steps lost, and the motor yielding to the load
neglected-acceleration-over-speed = torque falling with speed (state the acceleration over the velocity)
