# How a computation can end without a result: what it is called, what was computed, the remedy.
# $detail: a message with the numbers

modes-have-equal-poles = two modes have the same poles, so one { word-force } cannot bring both to rest independently; merge them into one mode (add their tcp_gain and measured_gain)
outcome-equal-poles = equal poles: { $detail }: { modes-have-equal-poles }
outcome-not-controllable = not controllable: { $detail }: the drive { word-force } does not reach every state; remove the mode that it cannot excite
outcome-final-time-too-short = final time too short: { $detail }: no admissible { word-force } reaches the target so soon; give a longer t_f
outcome-bound-cannot-hold = bound cannot hold: { $detail }: no move, however slow, keeps this bound; widen it
outcome-beyond-horizon = beyond horizon: { $detail }: the bound can only be met by a move slower than the search horizon; widen the bound
outcome-modes-not-told-apart = modes not told apart: { $detail }: so strong { word-a-force } makes the move so short that all modes answer alike, closer than double precision can tell; check the unit of { word-max-force } and the masses, or lower { word-max-force }
outcome-no-convergence = no convergence: { $detail }: the iteration stopped before the required accuracy was reached; report the profile, and use --method transcription meanwhile
outcome-unstable-loop = unstable loop: { $detail }: the closed loop is unstable; change a gain as told, or leave the gains out to have them tuned
outcome-not-observable = not observable: { $detail }: the sensors do not see this state, so no feedback can use it; remove the gain, or add a second encoder with tcp_sensor = "position"
outcome-bandwidth-out-of-reach = bandwidth out of reach: { $detail }: no stable loop reaches minimum_bandwidth with the required margins; shorten force_lag and the cycles, or lower minimum_bandwidth
outcome-margins-out-of-reach = margins out of reach: { $detail }: no cascade, down to one so soft, has the required margins: it takes damping from a mode that the encoder sees; check the sign of measured_gain, or add a notch to force_filters
outcome-undamped-mode = undamped mode: { $detail }: the encoder does not see this mode, so it would ring for ever; state its damping_ratio (measured, or a cautious 0.002)
outcome-feedback-design-failed = feedback design failed: { $detail }: the Riccati equation of the state feedback or of its observer has no reliable solution for these numbers; check their units, or set control.state_feedback = "off"
outcome-no-force-left = no { word-force } left: { $detail }: the static load takes all of the { word-force }, so the axis cannot move; raise { word-max-force } or balance the load
outcome-move-too-long = move too long: { $detail }: so long a motion is not followed cycle by cycle; check the unit of { word-max-force }, or of the acceleration and jerk that were given, or state a shorter move (a smaller velocity_step, or a shorter distance at the same max_velocity: constant velocity and long constant acceleration leave no vibration, so the limits stay nearly the same; take what is cut off from max_settling_time, too)
outcome-setpoint-failed = setpoint failed: { $detail }: Ruckig found no setpoint for these limits; check that they are in SI units
outcome-worker-lost = worker lost: { $detail }: processes of the sweep ended again and again, for want of memory or because somebody ended them; continue with --resume, with fewer --workers
outcome-scheduler-lost = scheduler lost: { $detail }: start it and its workers again, and continue with --resume
outcome-stopped = stopped: { $detail }: the sweep was interrupted; continue with --resume
outcome-printing-failed = printing failed: { $detail }: the PDF could not be set; use --no-pdf and report the message

# what another program says, in its own words
foreign = { $text }
setpoint-of-limits = with a = { PLAIN($acceleration, digits: 6) } m/s^2 and j = { PLAIN($jerk, digits: 6) } m/s^3 (rad instead of m on a rotary axis): { $complaint }
