# Optima, rules of thumb, the commissioning rule, and what the chosen limits end at.

# lists
joined-by-and = { $first } and { $second }

# what the limits end at; $requirements: one or more, joined
bound-by-requirements = { $requirements }
bound-by-nothing-met = least settling time; no limits meet all requirements
bound-by-motor = no requirement; more than the motor's own acceleration less the reserve, { ACCELERATION($acceleration) }, is not looked for
bound-by-ceiling = a practical ceiling for printers, { ACCELERATION($acceleration) } (assumed)
bound-in-state = { $what } (state { $state })
bound-by-settling-later = settling time (higher limits settle later)
# $kind: key of a control for printers
ceiling-source = { $kind ->
    [marlin] There is no such list for Marlin; it is the most in Klipper's sample configurations (most have 3 m/s²).
   *[other] No sample configuration of Klipper has more (most have 3 m/s²).
}
acceleration-ceiling = The acceleration ends at a practical ceiling, assumed: { ACCELERATION($ceiling) }; what extruder, frame and motor driver take is not in the model. { $why } Type more only where yours are known to take it; where they take less, state that as drive.max_acceleration.
reserve-used = Reserve used up: no limits meet the requirements with { SHARE($band) } of the band and { SHARE($force) } of the { word-force }, so the recommended ones take up to all of it. Temperature, wear or another position of the axis may then break a requirement.

# optima; $error: outcome with its remedy
reference-not-exact = The time-optimal control was not found exactly; the reference shown is one on cells. Nothing is faster than { TIME($least, digits: 6) } (a proved bound, { SHARE($below, digits: 2) } below).
optimum-under-bounds-failed = Optimum under the bounds on peaks: { $error }.
optimum-not-exact = The optimum under the bounds on peaks is at most { SHARE($slower, digits: 1) } slower than the fastest control; exact arcs were not found.
damping-optimum-failed = Damping-optimal control: { $error }.
band-saves-nothing = Optimum with the band instead of exact rest: not computed, since it saves { SHARE($share, digits: 2) } of the time at most: even a rigid axis takes { TIME($rigid, digits: 6) }.
band-wider-than-move = Optimum with the band instead of exact rest: none, since the band, { LENGTH($band, digits: 3) }, is no smaller than the move, { LENGTH($distance, digits: 3) }: standing still keeps it.
band-optimum-failed = Optimum with the band instead of exact rest: { $error }.
robust-force-failed = { word-force-first } profile for the whole spread: { $error }.
damping-optimum-exceeds-velocity = The damping-optimal control reaches { PLAIN($times, digits: 4) } times max_velocity: its functional knows no limits on states.
static-load-of-force = static_load { FORCE($load, digits: 6) } of { word-max-force } { FORCE($force, digits: 6) }
final-time-below-least = t_f = { PLAIN($final, digits: 9, unit: "ms") } ms, but t_f,min = { PLAIN($least, digits: 9, unit: "ms") } ms

# limits condensed from an optimum
closest-to-time-optimal = closest to the time-optimal control
closest-to-constrained = closest to the constrained control
closest-to-damping-optimal = closest to the damping-optimal control
with-move-number = { $name }, move { $number }

# rules of thumb; $mode: the user's name, $frequency in Hz
rule-of-thumb-no-jerk-limit = a = { $axis ->
    [open-loop] a_max
   *[other] F_max/m
}, no jerk limit
rule-of-thumb-period = j = a f ({ $mode }, { NUMBER($frequency, digits: 3) } Hz)
rule-of-thumb-stiffness = a = e ω², j = a f
rule-of-thumb-ten = j = 10 a
rule-of-thumb-hundred = j = 100 a
rule-of-thumb-velocity = j = a²/v_max
source-naive = naive
source-zero-vibration = zero residual vibration of an undamped mode (Biagiotti & Melchiorri)
source-static-deflection = static deflection within the band (textbook)
source-grblhal = grblHAL; lower end of LinuxCNC
source-linuxcnc = upper end of LinuxCNC
source-heidenhain = HEIDENHAIN, MANUALplus 620: least axPathJerk

# the commissioning rule
commissioning-rule = commissioning rule
commissioning-rule-with = commissioning rule ({ $chosen })
source-commissioning-rule = this project, by hand; derived and validated in docs/commissioning-rule.md
rule-description = In one sentence: average one period of the softest mode, let the band set the jerk, and the { word-force } the acceleration. Why: each jerk step leaves a vibration in every mode and a following-error transient of the servo loop, both in proportion to the jerk; among moves of all sizes there is one whose steps all add, so ramps cannot be relied on to cancel anything. A moving average of fixed length acts on every size.
rule-advice = Calculate once without an average (W = 1) and once with one that is as long as a period of the mode with the largest C, at the middle of the frequencies that it may have; take what moves sooner, v/a + a/j + T_F. The limits then hold for every smaller move, too.
rule-validity = Rigid axis with lag and weakly damped modes (15 to 200 Hz, damping 0.5 to 10 %), cascade with full velocity feed-forward and automatic reference delay, spread up to 10 %, payload up to 30 % of the moving { word-mass }, band 2 to 50 µm; no setpoint filter but a moving average, no bounds on peaks, contour or RMS { word-force }. The band is met in most machines, not in all: simulate before use.
rule-no-average = no average
rule-average = moving average, { TIME($time) }
rule-force = { word-force }
rule-reach = reach
rule-bound-by = bound by { $what }
rule-for-positioning = for positioning
rule-within-the-spread = within the spread
rule-ramps = number of ramps n
rule-by-moves = 2 for a velocity step, 4 for positioning
rule-average-length = length T_F of the moving average
rule-mode-lowest = lowest frequency of mode { $mode }
rule-mode-passed = share W of mode { $mode } behind the average
rule-allowed-jerk = jerk that the band allows
rule-speed-loop = speed loop ω_v
rule-servo-sensitivity = jerk sensitivity C_S of the servo
rule-unknown-mass = unknown share of the { word-mass } ε
rule-payload-sensitivity = jerk sensitivity C_P by the payload
rule-mode-sensitivity = jerk sensitivity C of mode { $mode }
rule-jerk-time = jerk time t_j
rule-force-acceleration = acceleration within the { word-force }
rule-see-formula = see the formula
rule-acceleration = acceleration a
rule-jerk = jerk j
rule-residual = predicted residual
rule-needs-velocity-feedforward = velocity_feedforward is not 1: the following error is not in the rule
rule-needs-automatic-delay = reference_delay is given: the rule counts on the automatic one
rule-needs-jerk-limit = the control has no jerk limit: the rule counts on one
rule-knows-averages-only = a setpoint filter other than a moving average is on: the rule counts its length, not its smoothing
rule-careful-with-seen-mode = the encoder sees more of mode { $mode } than was tried (m c = { NUMBER($share, digits: 3) }, tried up to 1): the rule may be slower than need be by far
rule-knows-no-peaks = bounds on peaks, contour or RMS { word-force } are not in the rule
