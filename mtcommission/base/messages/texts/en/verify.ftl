# A recorded move beside the record of a run.
# Times in s, lengths in m (rad), shares from 0 to 1; $file, $name, $names, $mode: names of the user

verify-stage = Comparing
verify-title = Verification

# The verdict
verify-verdict-holds = Holds
verify-verdict-does-not-hold = Does not hold
verify-verdict-cannot-tell = Cannot tell
verify-verdict-in-part = Cannot tell for all moves: move { $known } holds, move { $missing } was not recorded
verify-verdict-except = What can be judged holds; cannot be told: { $what }
verify-verdict-nothing = Cannot tell: { $what }
verify-detail = { $moves ->
    [one] One move
   *[other] { $moves } moves
} recorded. { $obeyed ->
    [yes] The control sent what was entered.
    [no] The control did not send what was entered.
   *[other] Whether the control sent what was entered cannot be told.
}
verify-disclaimer = Measured beside calculated, not an acceptance test.
verify-unexplained = Of the deviation { SHARE($share) } (RMS) are not explained by the prediction.

# What is checked
verify-setpoint-velocity = velocity of the setpoint
verify-setpoint-acceleration = acceleration of the setpoint
verify-setpoint-jerk = jerk of the setpoint
verify-peak-deviation = peak deviation
verify-max-force = largest actual { word-force }
verify-reference-delay = delay to the setpoint
verify-frequency = closed-loop frequency
verify-damping-ratio = closed-loop damping ratio

# Why
verify-kept = kept, uncertainty included
verify-missed = missed by more than the uncertainty
verify-within-noise = the uncertainty reaches across the bound; repeat it with finer resolution or less noise
verify-planned = { $by ->
    [trace] what acceleration and jerk, as entered, reach in a move of this size (in the trace: { QUANTITY($entered, $unit) })
   *[entry] what was planned with { QUANTITY($entered, $unit) } entered
}
verify-setpoint-obeyed = keeps to { verify-planned } (means over { TIME($width) })
verify-setpoint-above = above { verify-planned } (means over { TIME($width) })
verify-setpoint-below = never reaches { verify-planned } (means over { TIME($width) })
verify-setpoint-coarse = the setpoint is recorded too coarsely (mean over { TIME($width) }); record more digits or a shorter cycle
verify-setpoint-no-plan = no plan for this move (mean over { TIME($width) })
verify-cut = the record ends before the setpoint does
verify-other-setpoint = the control sent something else than was entered
verify-no-tool = neither the tool nor the encoder was recorded
verify-encoder-only = only the encoder was recorded, and it does not show what { $mode } does at the tool; record at the tool
verify-no-state = no recorded signal shows it
verify-other-move = not one of the moves that the record promises it for
verify-too-short = the record ends { TIME($got) } after the setpoint; the slowest mode needs { TIME($needed) }
verify-noise-above-band = the noise floor { LENGTH($noise) } is above the band { LENGTH($band) }
verify-no-force = { word-force } was not recorded
verify-dwell-not-recorded = the bound is for the mean over { TIME($needed) }, move and dwell; { TIME($got) } of it were recorded
verify-delay-not-recorded = the setpoint was recorded behind the delay, which is therefore not seen
verify-mode-not-seen = the mode does not stand out in the dwell

# Warnings
verify-behind-delay = { $file }: what was measured comes earlier than predicted by { TIME($delay) }, which is the delay of the control: the setpoint was recorded behind this delay, and is judged so. If it was recorded before it, the delay does not act in the control.
verify-planner-exceeds = The control exceeds what was entered: { $what } { QUANTITY($measured, $unit) }, planned { QUANTITY($planned, $unit) }. Look there before at the mechanics: axis or dynamic mode, jerk limit switched off, another parameter set.
verify-planner-below = The control never reaches what was entered: { $what } { QUANTITY($measured, $unit) }, planned { QUANTITY($planned, $unit) }. Look for another limit: override, path acceleration, dynamic mode, setpoint filter.
verify-moves-missing = Not recorded: move { $moves } of the record. What it promises there cannot be told.
verify-moves-unknown = { $file }: { $moves ->
    [one] one move of { QUANTITY($size, $unit) } is
   *[other] { $moves } moves, the first of { QUANTITY($size, $unit) }, are
} none of the record's. Is the trace of this axis?
verify-begins-moving = { $file } begins in the middle of a move, which was left out; begin at rest.
verify-moves-with-gaps = { $file }: moves with lost samples were left out ({ $count }).
verify-many-moves = { $used } of { $found } moves were compared.
verify-gap = No samples from { TIME($begin) } to { TIME($end) }.
verify-si-assumed = { $name } has no unit, taken as SI.
verify-at-motor = { $name } [{ $unit }] is at the motor's shaft; converted by lead and gear of the profile.
verify-setpoint-from-velocity = No position of the setpoint: integrated from { $name }.
verify-reversed = { $name } runs against the setpoint; its sign was turned.

# Files that cannot be used
verify-no-time-record = holds no signals over time; record a move with setpoint and actual position
verify-missing-setpoint = no setpoint among the columns { $found }; give --columns x_ref=COLUMN, or record the position setpoint: without it nobody can tell what the control asked for
verify-missing-measured = nothing measured among the columns { $found }; give --columns encoder=COLUMN, tcp=COLUMN, following_error=COLUMN or acceleration=COLUMN
verify-two-columns = { $names } may each be { $role }; say which by --columns { $role }=COLUMN
verify-constant-missing = { $name } is a current; give { $axis ->
    [rotary] --constant, the torque per ampere at the axis, e.g. --constant 1.2
   *[linear] --constant, the { word-force } per ampere, e.g. --constant 80
}
verify-other-motion = { $name } [{ $unit }] belongs to another kind of axis; state drive.lead (and drive.gear) in the profile, or record values of the axis
verify-other-travel = { $name } travels { NUMBER($ratio, digits: 3) } times as far as { $reference }; one of the units is wrong, give it by --columns NAME=COLUMN [unit]
verify-no-motion = { $name } does not move
verify-no-move = no move begins at rest in these traces; record from standstill to the end of the dwell

# The page
verify-part-overlay = Measured over predicted
verify-part-sources = Sources
verify-caption-checks = Every promise
verify-caption-sources = Recorded files
verify-head-what = Promise
verify-head-predicted = Predicted (corners)
verify-head-columns = Columns
verify-plot-caption = { $file }, move from { TIME($begin) } on
verify-plot-time = time from the start of the setpoint
verify-plot-tcp = deviation of the tool
verify-plot-encoder = deviation of the encoder
verify-plot-force = { word-force }
verify-plot-difference = measured less predicted
verify-line-low = predicted, lowest corner
verify-line-high = predicted, highest corner
verify-line-band = band
verify-line-tool-band = band of the tool
verify-line-difference = measured less nominal

# Parameters as the traces show them
verify-part-differences = What is different
verify-caption-parameters = Parameters as the traces show them
verify-caption-feedforwards = Feed-forward as it should be, by the following error
verify-parameter-reference-delay = delay of the reference path
verify-parameter-feedforward-mass = { $axis ->
    [rotary] inertia of the acceleration's feed-forward
   *[linear] mass of the acceleration's feed-forward
}
verify-parameter-jerk-feedforward = feed-forward of the jerk
verify-parameter-friction-feedforward = feed-forward against Coulomb friction
verify-two-masses = { $axis ->
    [rotary] The inertia of the feed-forward is the one to enter in the control ({ word-force } per acceleration); the moving inertia is that of the mechanics and belongs in the profile, where --refine writes it.
   *[linear] The mass of the feed-forward is the one to enter in the control ({ word-force } per acceleration); the moving mass is that of the mechanics and belongs in the profile, where --refine writes it.
}
verify-feedforward-brings = { $moves ->
    [0] With these values the encoder would stay { $after } from the delayed setpoint instead of { $before } (RMS; of the same move, one alone was recorded).
   *[other] With what the first half of the moves says, the encoder would stay { $after } from the delayed setpoint in the second half instead of { $before } (RMS).
}
verify-caption-limits = Limits that follow
verify-head-old = Record
verify-head-new = Trace
verify-parameter-mass = { $axis ->
    [rotary] moving inertia (payload included)
   *[linear] moving mass (payload included)
}
verify-parameter-frequency = open-loop frequency
verify-parameter-damping-ratio = open-loop damping ratio
verify-parameter-is-same = as before, within two standard errors
verify-tested = { $moves ->
    [0] Not tested on other moves (one move alone was recorded): old and new parameters leave
   *[other] Tested on { $moves } moves that were held back: old and new parameters leave
} { SHARE($before) } and { SHARE($after) } (RMS) of the deviation.
verify-force-left = Of the { word-force } { SHARE($share) } are left.
verify-no-limits = No limits for the refined profile: { $why }
verify-renewed = from a recorded move, ± { $error }
verify-renewed-derived = from the frequencies and the mass of a recorded move
verify-renewed-head = Refined by mtcommission verify on { $date }; ± are two standard errors.

# On the sheet
measure-verdict = Recorded moves, verify: { $verdict }.
verdict-of-other-form = is no verdict of mtcommission verify
verdict-of-other-record = is about another record; run verify with this one
verify-setpoint-from-error = No position of the setpoint: the sum of { $name } and { $error }, taken as what the loop compares.
verify-plot-acceleration-measured = acceleration of the tool
