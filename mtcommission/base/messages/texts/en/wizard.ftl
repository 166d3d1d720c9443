# Questions of the wizard: ask-KEY is what is asked, -where where to find it, -empty what an empty answer means.
# $number: which element of an array, $name: the last part of the key

ask-machine-name = Name of the machine
ask-machine-axis = Name of the axis
ask-machine-axis-where = The axis letter in NC programs, e.g. X, Y, Z, B, C.
ask-machine-motion = Linear or rotary axis
ask-machine-motion-where = A rotary axis takes inertia for mass, torque for force and angles for lengths.
ask-machine-source = Where the numbers come from
ask-machine-source-where = E.g. data sheet and date, or measured on the machine; printed on the sheet.
ask-drive-kind = Servo, or an open-loop axis (stepper)
ask-drive-kind-where = Open loop: a stepper, or a servo so stiff that only the structure rings; its frequencies are those with the motor held, as an accelerometer shows them.
ask-drive-max-acceleration-where = What it does without losing steps at the top speed; by data sheet: torque there / (r x moved mass).
ask-drive-max-velocity-where = The steps per second of the control x the travel per step, or where the torque ends.
ask-drive-max-velocity-empty = that of each move
choice-servo = servo
choice-position-source = open loop (position source)
ask-drive-max-force-where = { $axis ->
    [rotary] Motor data sheet: peak torque x gear ratio.
   *[linear] Motor data sheet: peak force; or the peak torque at the shaft in N m, which lead and gear turn into a force.
}
ask-drive-force-lag-where = Drive's current loop: rise time to 63 %; servo drives have 0.5 to 5 ms.
ask-drive-continuous-force-where = Motor data sheet: rated or stall value, the thermal (RMS) limit.
ask-drive-continuous-force-empty = no thermal limit
ask-drive-static-load-where = { $axis ->
    [rotary] Weight or process torque that the drive holds; swivel axis off its balance: mass x 9.81 m/s^2 x distance of the centre; else 0.
   *[linear] Weight or process force that the drive holds; vertical axis without full counterbalance: mass x 9.81 m/s^2; else 0.
}
ask-wizard-way = Known of the mechanics
ask-wizard-way-where = Motor and load: two masses with a spring. Bode plot: mode by mode, with its share at the tool; a file with the response answers for all of it: leave with q, run mtcommission identify FILE -o PROFILE, and come back. Tower: slider with a tool column on a base that gives way (the paper's machine).
ask-mass-where = Weights of the parts list or CAD.
ask-plant-rotary-inertia-where = CAD; or from the measured tilting frequency and the rotary stiffness.
ask-plant-lever-arm-where = Drawing: line of motor or ball screw against the guideways.
ask-plant-tcp-height-where = Drawing; negative if the tower tilts backwards when it is pushed forwards.
ask-stiffness-where = Data sheet of mounts and guideways, or from a measurement: k = m (2 pi f)^2, with the inertia for m where it turns.
ask-damping-where = d = 2 x damping ratio x sqrt(k m), with the inertia for m where it turns; ratios of 0.02 to 0.05 are common.
ask-moves-distance = Move { $number }: distance, or velocity at its end
ask-moves-distance-empty = no more
ask-moves-distance-where = The limits serve all moves that you list: take the typical and the hardest, e.g. a short and a long one.
ask-moves-max-velocity-where = Rapid traverse of the axis, from the control or its data sheet.
ask-moves-dwell-where = Cools the motor: with 0 s the axis never pauses, and the continuous { $axis ->
    [rotary] torque
   *[linear] force
} may cost acceleration. Enter alone marks it as assumed.
ask-moves-velocity-step = Move { $number }: velocity at the end
ask-requirements-tcp-deviation-where = Half the tolerance that you leave to vibration, not the whole tolerance of the part.
ask-requirements-max-settling-time-where = Cycle time calculation: from the start of the move until the tool is quiet.
ask-requirements-frequency-spread-where = 5 % for measured values, 10 to 20 % for calculated ones; costs some speed. With 0 % the limits fit exactly these frequencies.
ask-requirements-damping-spread-where = Damping is rarely known to better than 30 %, but it matters little.
ask-requirements-payload = Largest payload
ask-requirements-payload-where = Workpiece, pallet or tool; the limits then hold from empty to this.
ask-requirements-contour-deviation-where = While the tool moves. Only for a tool that works on its way (contours); one that must be still at the end needs none.
ask-requirements-contour-deviation-empty = quiet at the end
ask-control-kind-where = What it lacks is neither used nor promised; where yours is not listed, take the generic cascade. Limits and gains are printed in its own names by mtcommission export.
ask-control-position-loop-where = In the drive is DSC (SINUMERIK: MD32640 = 1); it lets Kv rise. Not known takes what the control does unless told otherwise, the next line, and marks it as assumed.
ask-control-empty = as the control has it
ask-control-position-cycle-where = Control: interpolation or position cycle, 0.5 to 4 ms.
ask-control-velocity-cycle-where = Drive: speed controller cycle; the position cycle is a whole multiple.
ask-control-position-gain-where = Control: Kv factor, servo gain; (m/min)/mm or 1/s.
ask-gain-empty = tune it
ask-control-velocity-gain-where = { $axis ->
    [rotary] Drive: speed controller gain, turned to the axis: x (gear ratio)^2.
   *[linear] Drive: speed controller gain, turned to the axis: x (2 pi / lead)^2.
}
ask-control-state-feedback = State feedback
ask-control-integral-time-where = Drive: reset time of the speed controller.
ask-control-integral-time-empty = tune it
ask-drive-lead-where = Screw: lead; pinion: pitch circle x pi. Turns torque, inertia and gains at the motor shaft into values at the axis, and back.
ask-drive-lead-empty = linear motor
name-gear = { $axis ->
    [rotary] Turns of the motor per turn of the axis
   *[linear] Turns of the motor per turn of screw or pinion
}
ask-drive-gear-where = { $axis ->
    [rotary] Gearbox; 1 for a torque motor.
   *[linear] Gearbox or belt; 1 where the motor sits on it.
}
ask-drive-encoder-resolution-where = Encoder and drive: signal period / interpolation, or travel per turn / counts.
ask-today-acceleration = Acceleration limit in the control now
ask-today-acceleration-where = The sheet then shows what today's values give beside the recommended ones.
ask-today-jerk = Jerk limit in the control now
ask-today-jerk-where = In units of the axis; where the control has a time: acceleration / time.
ask-pair-motor-mass = { $axis ->
    [rotary] Inertia on the motor's side, seen at the axis
   *[linear] Mass on the motor's side, seen at the axis
}
ask-pair-motor-mass-where = { $axis ->
    [rotary] Rotor and gearbox: inertia x (gear ratio)^2.
   *[linear] Rotor, coupling, screw, gearbox: their inertia at the motor shaft in kg m^2, which lead and gear turn into a mass; moving part of a linear motor: its mass.
}
ask-pair-load-mass = { $axis ->
    [rotary] Inertia on the tool's side of the spring
   *[linear] Mass on the tool's side of the spring
}
ask-pair-load-mass-where = { $axis ->
    [rotary] Table or head with everything that it carries.
   *[linear] Table, gantry or head with everything that it carries.
}
ask-pair-stiffness = Stiffness between the two
ask-pair-stiffness-where = { $axis ->
    [rotary] Gear or worm, shaft in torsion, coupling in series, at the axis: data sheets.
   *[linear] Screw, nut and bearings in series, belt, rack, coupling: data sheets.
}
ask-pair-damping-ratio = Damping ratio of the load against the held motor
ask-pair-frequency = Eigenfrequency of the load while the motor holds
ask-pair-frequency-where = Brake or position loop on, tap the load; in a Bode plot of the motor the antiresonance.
ask-plant-moving-mass-where = { $axis ->
    [rotary] Torque over angular acceleration at low frequencies.
   *[linear] Force over acceleration at low frequencies, rotor included; or the whole inertia at the motor shaft in kg m^2.
}
ask-modes-frequency-empty = no more
ask-frequency-where = Frequency response from force to acceleration, or a tap with an accelerometer: the peak.
ask-plant-modes-frequency-held-where = With the motor held: the peak of an accelerometer at the tool (resonances_x.csv), or after a tap.
ask-damping-ratio-where = Half the relative 3 dB width of the peak; machine structures show 0.01 to 0.1.
ask-plant-modes-tcp-gain-where = Residue of the frequency response force to tool; 1/modal mass for the mode shape 1 at force and tool. Enter takes the worst case of a tool on its far side, marked as assumed.

# $text: a question; $meaning: its -empty
ask-or-leave-empty = { $text } (empty: { $meaning })
ask-left-out = left out
ask-wizard-change = Number or key of what is to be changed
ask-wizard-change-empty = write the profile
ask-wizard-change-where = A number of the list, or any key of a profile, e.g. drive.max_force; < goes back to the questions.
ask-wizard-run = Compute the limits now

# Choices, as shown; what is kept is the English one.
choice-rotary = rotary
choice-off = off
choice-control = in the control
choice-interpolated = in the control, feed-forward interpolated
choice-drive = in the drive (DSC)
choice-notch = notch
choice-low-pass = low-pass
choice-tower-masses-and-stiffness = tower: masses and stiffness
choice-motor-and-load-masses-and-stiffness = motor and load: masses and stiffness
choice-motor-and-load-masses-and-measured-eigenfrequency = motor and load: masses and measured eigenfrequency
choice-modes-from-a-bode-plot = modes from a Bode plot

# At every question.
wizard-begin = Profile { $file }. Enter takes the value in [brackets].
wizard-commands = At every question: ? help, < back, q quit.
wizard-back = back
wizard-help = help
wizard-quit = quit
wizard-settled = Not asked, since it has a sound default or can be left out:
wizard-no-such-key = got "{ $got }"; type a number of the list or a key of a profile
# $key, $message: of a fault
wizard-not-possible = Not possible: { $key }: { $message }
# $how: wizard-left-by-user, wizard-input-ended or wizard-interrupted; $where: key of a question
wizard-kept = { $how } at { $where }; answers kept in { $file }, the same command goes on from there
wizard-left-by-user = quit
wizard-input-ended = input ended
wizard-interrupted = interrupted
wizard-replaced = { $file } replaces what was stated before: { $values }
wizard-taken-as = taken as { $what }
wizard-follows = = { $what }
wizard-example-behind = e.g. { $example }
wizard-leave-out = Enter alone leaves it out; - removes a value given before.

# What is wrong or unusual about a reply.
reply-missing = an answer is needed here, e.g. { $example }
reply-no-choice = got "{ $got }"; choose one of: { $choices }
reply-unprintable = got control characters or bytes of another encoding; type plain text
# $unit: with a blank before it, or empty

# What follows from the answers; $frequency [Hz].
insight-mode = mode { $mode } at { FREQUENCY($frequency) }, damping ratio { PLAIN($damping_ratio, digits: 3) }
insight-deflection = mode { $mode } bends the tool by { LENGTH($deflection) } at { $by ->
    [held] full acceleration
   *[free] full force, statically
}
insight-no-force = weight or process force leave { FORCE($force) } of the drive's force: the axis cannot move; go back with < and correct one of the two
insight-acceleration = rigid-body acceleration at most { ACCELERATION($acceleration) } ({ FORCE($force) } on { MASS($mass) })
insight-rotor-unknown = the { MASS($mass) } must contain the rotor: each kg·cm² at the motor shaft is { MASS($each) } at the axis

# Comments of a profile that the wizard writes.
document-head = Machine profile for mtcommission; a quantity is a text with a unit, or a number in SI.
document-assumed = Take a key out of assumed as soon as somebody knows its value.
wizard-by-hand = entered by hand
