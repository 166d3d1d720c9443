# The rows of the comparison with the paper: what is compared, ours, what it was judged by, and why it differs. What the paper prints stands as it prints it.

paper-place = sec. { $at }
paper-our-loop = our loop
paper-certified = certified optimum
paper-certified-to = certified optimum, relative gap { PLAIN($gap, digits: 1) }
paper-entry = λ(0) of our certificate up to the entry
paper-limits = a = { PLAIN($acceleration, digits: 3) } m/s², j = { PLAIN($jerk, digits: 3) } m/s³
paper-figure-caption = Fig. { $number }: time-optimal solution, F_max = 2 kN{ $number ->
        [5] , |v_φ| ≤ 0.005 rad/s
       *[other] { "" }
    }
paper-kalman-rank = rank of the Kalman matrix
    .basis = { json-whole-number }
    .reason = Decided after scaling the states. In SI units rounding makes its rank look like { $unscaled }.
paper-adjoint-equations = adjoint equations: largest error of a coefficient, relative to the largest
    .basis = rounding; printed coefficients against -A of our plant
paper-order = order of the constraint on v_φ
    .ours = order { $order }
    .basis = c A^(k-1) B of our plant
paper-active-damping = structural vibration damped by feedback
    .ours = damping ratios of base and tower: { PLAIN($base, digits: 2) }, { PLAIN($tower, digits: 2) } without feedback, { PLAIN($base_encoder, digits: 2) }, { PLAIN($tower_encoder, digits: 2) } with the encoder alone, { PLAIN($base_sensed, digits: 2) }, { PLAIN($tower_sensed, digits: 2) } with a second one near the tool; without jerk limit settled within 5 µm after { PLAIN($encoder, digits: 0, style: "f", unit: "ms") } and { PLAIN($sensed, digits: 0, style: "f", unit: "ms") } ms
    .basis = { paper-our-loop }
    .reason = The loop is ours, since Fig. 2 has no numbers. The encoder alone cannot see the tower: base and tower do not couple. A second one lets the loop damp it, and still it is the setpoint that decides how soon the axis settles.
paper-overshoot = terminal overshoot under feedback
    .ours = tool velocity overshoots by { PLAIN($rough, digits: 1, style: "f", unit: "%") } % (rectangular), { PLAIN($least, digits: 1, style: "f", unit: "%") } to { PLAIN($most, digits: 1, style: "f", unit: "%") } % (trapezoids as short as the optima), { PLAIN($smooth, digits: 1, style: "f", unit: "%") } % (trapezoid chosen for the loop)
    .basis = { paper-our-loop }
    .reason = It depends on the jerk: limits chosen for the loop avoid it almost entirely.
paper-transfer-time = transfer time under feedback
    .ours = settled within 5 µm after { PLAIN($smooth, digits: 1, style: "f", unit: "ms") } ms (trapezoid chosen for the loop) to { PLAIN($rough, digits: 1, style: "f", unit: "ms") } ms (rectangular): { PLAIN($smooth_share, digits: 1, style: "f") } to { PLAIN($rough_share, digits: 1, style: "f") } times { PLAIN($least, digits: 2, style: "f", unit: "ms") } ms
    .basis = { paper-our-loop }
    .reason = Counted as much larger: { PLAIN($much) } times. How far a loop comes down depends on its tuning, of which the paper says nothing.
paper-jerk-control = productivity with damping asks for jerk control
    .ours = { $limits }: peak |v_φ| { PLAIN($smooth, digits: 1, style: "f", unit: "mrad") } instead of { PLAIN($rough, digits: 1, style: "f", unit: "mrad") } mrad/s without jerk limit; settling times in the row before
    .basis = { paper-our-loop }
paper-jerk-follows = what the possible jerk depends on
    .ours = base at { PLAIN($base_soft, digits: 1, style: "f") }, { PLAIN($base, digits: 1, style: "f") }, { PLAIN($base_stiff, digits: 1, style: "f") } Hz: j = { PLAIN($j_base_soft, digits: 1, style: "f") }, { PLAIN($j_base, digits: 1, style: "f") }, { PLAIN($j_base_stiff, digits: 1, style: "f") } m/s³; tower at { PLAIN($tower_soft, digits: 1, style: "f") }, { PLAIN($tower, digits: 1, style: "f") }, { PLAIN($tower_stiff, digits: 1, style: "f") } Hz: j = { PLAIN($j_tower_soft, digits: 1, style: "f") }, { PLAIN($j_tower, digits: 1, style: "f") }, { PLAIN($j_tower_stiff, digits: 1, style: "f") } m/s³
    .basis = limits chosen anew for each machine; { paper-our-loop }
    .reason = Here the base dominates, the mode that the encoder sees. A rule is derived in docs/commissioning-rule.md and printed on the sheet. The limits are searched anew with a loop tuned anew: a jerk 6 % lower settles 2 % later, so smaller differences say nothing.
paper-switching-time = t_{ $number }
    .basis = the text: "correct up to 3-4 decimals"
paper-final-time = t_f
    .basis = { paper-switching-time.basis }
    .reason = No control reaches the target before { PLAIN($least, digits: 9, style: "f") } s (proved), so the printed t_f is too short. Explicit Euler steps err in this direction, in proportion to the step.
paper-terminal-error = { $state }(t_f) of the printed control, integrated exactly
    .basis = { PLAIN($share) } of the peak: three decimals of (12)
paper-adjoint = λ_{ $state }(0)
    .basis = what 1e-4 s in the switching times does to it, and 0.1 %
paper-adjoint-implied = λ(0) that the printed times (12) imply: largest relative deviation
    .basis = two of the printed digits
    .reason = Times and adjoint of the paper fit each other to { PLAIN($deviation, digits: 1, style: "f", unit: "%") } %; the rounding of (12) to 1e-6 s explains { PLAIN($rounding, digits: 1, unit: "%") } %. The rest of what separates our λ(0) from the printed one, up to { PLAIN($off, digits: 1, style: "f", unit: "%") } %, are the times, above all those of the second arc, only { PLAIN($arc, digits: 2, style: "f", unit: "ms") } ms long.
paper-hamiltonian = H at t = 0 with the printed λ(0)
    .basis = three digits
    .reason = H = 0 demands λ_F(0) = -T / F_max = -1.25e-6; printed is -1.2503e-6.
paper-switching-law = switching law
    .ours = holds on the whole interval; { $zeros } zeros of λ_F, at the switches
    .basis = certificate, and zeros of the adjoint integrated apart from it
paper-law-as-printed = the reader may verify (9) with the printed λ(0)
    .ours = integrated forward λ_F has { $forward } zeros instead of 5, the last at { PLAIN($last, digits: 1, style: "f", unit: "ms") } ms; backward from H = 0 it has { $backward }, off by up to { PLAIN($off, digits: 2, style: "f", unit: "ms") } ms
    .basis = (8) by matrix exponentials
    .reason = The force lag makes errors of λ(0) grow like e^(t/T), by { PLAIN($growth, digits: 1) } over t_f: six or seven printed digits do not last. The law itself holds, see the row before.
paper-jacobian-rank = rank of the 6 x 6 Jacobian of the terminal conditions
    .basis = { json-whole-number }
    .reason = Full rank proves a strict local optimum; that it is global, our lower bound proves, with a relative gap of { PLAIN($gap, digits: 1) }.
paper-switches = number of switches at F_max = 2 kN
    .ours = { $switches }, { $control } first
    .basis = { paper-certified }
paper-switches-everywhere = number of switches for all F_max > 0
    .ours = { $found ->
        [0] { $usual } throughout
       *[other] { $usual }, but { $exceptions }
    }
    .basis = { $count } certified optima from { PLAIN($lowest) } to { PLAIN($highest, digits: 6) } N, largest relative gap { PLAIN($gap, digits: 1) }
    .reason = Within the machine's own range (F_max ≤ { PLAIN($range, unit: "kN") } kN) a double zero of the switching function opens into two more switches. The optimum is unique and proved, so five switches are slower there. The shortest arc is at most { PLAIN($arc, digits: 0, style: "f", unit: "us") } µs long: easily lost on a grid. Between the forces looked at nothing is proved.
paper-switches-between = { $switches } from { PLAIN($lowest, digits: 1, style: "f") } to { PLAIN($highest, digits: 1, style: "f") } N
paper-switches-beyond = number of switches beyond these forces
    .ours = { $usual } from { PLAIN($highest, digits: 6) } to { PLAIN($farthest, digits: 6) } N, where t_f = { PLAIN($t_f, digits: 3, style: "f", unit: "ms") } ms; below { PLAIN($weak) } N the switches, counted from t_f, move by less than { PLAIN($moved, digits: 2, unit: "ns") } ns
    .basis = { $count } certified optima, and theory for the rest
    .reason = In less than { PLAIN($half, digits: 3, style: "f", unit: "ms") } ms, half a damped period of the tower, no combination of 1, e^(-t/T) and the modes' functions has more than five zeros, and five conditions of rest need at least five switches. Small forces move for so long that what the start excites has decayed at the end: there the switches are those of one limit.
paper-bounded-time = t_f under |v_φ| ≤ 0.005
    .basis = one unit of the last printed decimal
    .reason = No control is faster than { PLAIN($least, digits: 9, style: "f") } s (proved): rounded to four decimals 0.0523. Again the printed time is a little too short, so that the t_f = 0.0522 s of sec. 6 cannot be reached under the bound.
paper-increase = increase of t_f over (12), relative
    .basis = 1e-4 s in either time
    .reason = The paper's own two times give { PLAIN($own, digits: 4) }, with which ours is compared.
paper-boundary-arcs = boundary arcs
    .ours = { $held }
    .basis = { paper-certified-to }
paper-bang-arcs = bang arcs before, between and after them
    .ours = { $arcs }; touch points: { $count ->
        [0] none
       *[other] { $touches }
    }
    .basis = { paper-certified-to }
    .reason = The shortest arc ({ $control }, { PLAIN($length, digits: 1, style: "f", unit: "us") } µs from { PLAIN($start, digits: 3, style: "f", unit: "ms") } ms) is { PLAIN($steps, digits: 1, style: "f") } steps of the paper's grid of 10000 long, and a touch point is one instant: both are easily lost on a grid. A constraint of order 2 admits both.
paper-touch = { $side } at { PLAIN($t, digits: 3, style: "f", unit: "ms") } ms
paper-second-derivative = second derivative of S_1
    .ours = relative error of the printed formula { PLAIN($off, digits: 1) }, corrected { PLAIN($off_corrected, digits: 1) }
    .basis = c A (A x + B F_set) along the time-optimal control
    .reason = Misprint: factors 1/J are missing; the units show it, too.
paper-boundary-control = boundary control
    .ours = along our boundary arcs the printed formula is off by up to { PLAIN($off, digits: 2) } F_max, the corrected one by { PLAIN($off_corrected, digits: 1) } F_max
    .basis = F_set of the certified control
    .reason = Misprint: the same factors 1/J are missing.
paper-inside = boundary control inside the control set
    .ours = |F_set| ≤ { PLAIN($largest, digits: 1, style: "f") } N on the boundary arcs, F_max = { PLAIN($limit, digits: 6) } N
    .basis = { paper-certified }
paper-switching-function = switching function on the boundary arc
    .ours = zero at entry to { PLAIN($at_entry, digits: 1) } of |λ_F(0)|
    .basis = { paper-entry }, by matrix exponentials
    .reason = Misprint: subscripts I and U belong to another machine, a voice-coil motor.
paper-multiplier = multiplier µ_1 of the bound
    .correct = the same + d/J λ_vφ
    .ours = λ_F drifts to { PLAIN($drift, digits: 2) } of |λ_F(0)| with the printed formula, to { PLAIN($held, digits: 1) } with the corrected one; µ_1 ≥ { PLAIN($least, digits: 0, style: "f") } s/rad on the arc
    .basis = (8) with µ_1 along our first boundary arc; λ_F must stay 0
    .reason = Misprint: d² λ_F / dt² = 0 contains d/J λ_vφ, too, and λ_vφ does not vanish on the arc.
paper-jumps = jumps of the adjoint at entry and exit
    .ours = at the first entry from { PLAIN($before, digits: 5) } to { PLAIN($after, digits: 5) } s²/rad
    .basis = { paper-entry }; inside, d λ_F/dt = 0 fixes it
    .reason = Downwards, as the bound from above demands; µ_1 keeps λ_F at 0 from there.
paper-peak-rate = peak rate, { $control ->
        [damping] damping-optimal
        [bounded] time-optimal, bounded
       *[free] time-optimal, free
    }
    .correct = v_φ instead of φ
    .basis = 0.2 %; 1e-4 s in t_f does 0.5 %
    .reason = Misprint: printed as the maximum norm of φ; it is that of v_φ. φ itself stays below { PLAIN($angle, digits: 2) } rad.
paper-weight = weight of { $state }
    .basis = 2 %: a grid blurs the switches of the motion that is balanced
paper-terms = terms of the functional
    .ours = 1 : { PLAIN($x_b, digits: 3) } : { PLAIN($phi, digits: 3) } : { PLAIN($v_b, digits: 3) } : { PLAIN($v_phi, digits: 3) } along the damping-optimal motion, J = { PLAIN($cost, digits: 7) } N² s
    .basis = within a decade
    .reason = F_set², x_b, φ, v_b, v_φ. The paper does not say along which motion; equal integrals of all terms along the time-optimal motion of sec. 5.1 give all four weights to { PLAIN($off, digits: 1, style: "f", unit: "%") } %. The two rates are what the optimisation then reduces.
paper-control-law = largest deviation from the control law, over F_max
    .basis = along the whole motion, with the adjoint of our solution
    .reason = The problem is convex: where an adjoint fits, the control is optimal.
paper-continuous = the optimal control is continuous
    .ours = largest jump { PLAIN($jump, digits: 1) } F_max, at the joints of { $arcs } arcs
    .basis = ends of neighbouring arcs
paper-saturated = saturated linear-quadratic control
    .ours = arcs: { $arcs }; max |F_set| { PLAIN($largest, digits: 1, style: "f") } N
    .basis = arcs of the damping-optimal control
paper-functional = matrix D and adjoint equation of the functional
    .ours = { $states } states; with the corrected equation (16) holds, rows above
    .basis = number of states
    .reason = Misprint: six entries for seven states, and the dot over λ is missing.
paper-least-time = t_f must be larger than the minimal time
    .ours = t_f = { PLAIN($longer, digits: 6) } s is solved; no control reaches the target before { PLAIN($least, digits: 9, style: "f") } s
    .basis = lower bound of the certificate
paper-oscillation = time-optimal trajectories oscillate
    .ours = v_φ changes its sign { $changes } times in { PLAIN($t_f, digits: 1, style: "f", unit: "ms") } ms and swings up to { PLAIN($rate, digits: 1, style: "f", unit: "mrad") } mrad/s
    .basis = the certified control of sec. 5.1
paper-more-force = higher F_max leads to higher vibrations
    .ours = from { PLAIN($least) } to { PLAIN($most) } N the peak of |v_φ| grows from { PLAIN($rate, digits: 1, style: "f", unit: "mrad") } to { PLAIN($highest_rate, digits: 1, style: "f", unit: "mrad") } mrad/s, that of |φ| from { PLAIN($angle, digits: 0, style: "f", unit: "urad") } to { PLAIN($largest_angle, digits: 0, style: "f", unit: "urad") } µrad
    .basis = { $count } certified optima, evenly spaced by ratio
    .reason = { $falls ->
        [0] {""}
       *[other] A trend, not a law: on { $falls } of the { $steps } steps between these forces the peak of |v_φ| falls.
    }
paper-bound-helps = the bound on v_φ reduces the largest |φ|, too
    .ours = from { PLAIN($free, digits: 1, style: "f", unit: "urad") } to { PLAIN($bounded, digits: 1, style: "f", unit: "urad") } µrad, by { PLAIN($less, digits: 0, style: "f", unit: "%") } %
    .basis = peaks of the two certified controls
paper-rate-between = peak rate of the damping-optimal control between the other two
    .ours = { PLAIN($rate, digits: 2, style: "f", unit: "mrad") } mrad/s: { PLAIN($over, digits: 2, style: "f") } times the bound, { PLAIN($share, digits: 0, style: "f", unit: "%") } % of the free time-optimal control
    .basis = damping-optimal and certified time-optimal control, F_max = { PLAIN($limit) } N
paper-bounds-damp = state constraints improve the damping
    .ours = peak |v_φ| { PLAIN($less, digits: 0, style: "f", unit: "%") } % lower for { PLAIN($longer, digits: 0, style: "f", unit: "%") } % more time
    .basis = the two certified controls
paper-hints = optimal controls give hints for the jerk limit
    .ours = profiles closest to the optima have j = { PLAIN($free, digits: 0, style: "f") }, { PLAIN($bounded, digits: 0, style: "f") }, { PLAIN($damped, digits: 0, style: "f") } m/s³ and settle in the loop after { PLAIN($soonest, digits: 0, style: "f", unit: "ms") } ms at best; { $limits } after { PLAIN($settling, digits: 0, style: "f", unit: "ms") } ms
    .basis = { paper-our-loop }
    .reason = An optimal force cancels vibration by its switches, which no jerk-limited profile has. So the hints are bounds from above and starting points; the limits themselves have to be searched with the loop closed.
