# What is wrong with a profile: $got is what stands there, $hint a proposal or empty.

hint-did-you-mean = ; did you mean "{ $name }"?
hint-there-are = ; there are { $names }
hint-moves-header = ; write the header as [[moves]]
hint-key = ; name a key as messages spell it
# $first may be several, separated by commas
a-table = a table
a-date = a date or time
a-huge-integer = an integer beyond all bounds

# The file.
file-missing = there is no such file; check the name
file-is-directory = is a directory; name a profile (.toml) in it
file-unreadable = cannot be read: { $reason }
file-too-large = is larger than { PLAIN($most, digits: 9) } bytes; that is no such file
file-binary = is a binary or UTF-16 file; save the profile as UTF-8 text
file-is-json = is JSON, as the record of a run is; give the machine profile (.toml), or the record to sheet or export
file-not-utf8 = byte { $byte } is not UTF-8; save the profile as UTF-8 text
file-empty = is empty; start from a shipped profile (mtcommission profiles list)
profile-unknown = no shipped profile { $got }{ $hint }

# TOML.
toml-nested-deeply = is nested too deeply; a profile needs no more than three levels
toml-refused = no TOML: { $got } ; mend this line or the one above: texts and values with a unit stand in quotes, numbers take a point, brackets are closed, and a key stands once

# Keys.
key-unknown = unknown key{ $hint }
key-misspelt = unknown key; did you mean "{ $meant }", which is missing?
key-not-stated = got "{ $got }", which is not stated here{ $hint }
key-missing = missing; { $remedy }
add-schema = add schema = 1
# $example: as TOML
add-value = add the value of your machine, for example { $key } = { $example }
add-table = add a table { $header }
add-kind-of-keys = add kind = "{ $kind }", to which the other keys belong

# Values.
got-other-word = got { $got }, must be { $words }{ $hint }
got-no-text = got { $got }, must be a text in quotes
got-no-signals = got { $got }, must be a table of signals
got-no-signals-or-word = got { $got }, must be { $words } or a table of signals
# $words: what may stand in place of a table
got-no-filter = got { $got }, must be { $words } or a table with kind
got-no-quantity = got { $got }, { $expected }
got-infinite = got { $got }, must be a finite number
array-too-short = got { $length } elements, at least { $least } needed
array-too-long = got too many elements, at most { $most } allowed
text-too-long = got { $length } characters, at most { $most } are allowed
text-with-control-characters = got control characters, remove them
name-no-identifier = got "{ $got }", must be letters, digits and _, not beginning with a digit
name-empty = got an empty text, give a name
no-such-signal = no such signal{ $hint }
# $what: what is wrong with a number in place of which a word may stand
or-word = { $what }, or "{ $word }"
# $unit: with a blank before it, or empty; the bounds are in it
must-be-above = got { $got }, must be > { PLAIN($bound, digits: 6) }{ $unit }
must-be-at-least = got { $got }, must be >= { PLAIN($bound, digits: 6) }{ $unit }
must-be-between = got { $got }, must be from { PLAIN($low, digits: 6) } to { PLAIN($high, digits: 6) }{ $unit }; check the unit

# What does not fit together.
static-load-takes-all = got { $got } against { word-max-force } = { $most }; its amount must be smaller, or no { word-force } is left for motion
friction-takes-all = got { $got }, must be below what { word-max-force } leaves beside static_load, { PLAIN($left, digits: 6) } { $unit }
move-with-neither = got neither of velocity_step and distance, give exactly one
move-with-both = got both of velocity_step and distance, give exactly one
max-velocity-without-distance = belongs to a move with distance; give distance, or remove it
frequency-spread-large = got { $got }, must be from 0 to 0.5 (50 %)
damping-spread-beyond-one = got { $got }, which raises a damping ratio to { PLAIN($largest, digits: 3) } in the worst corner, where it must stay < 1; state at most { PLAIN($allowed, digits: 3) } ({ PLAIN($allowed, digits: 3, unit: "%") } %)
payload-reversed = got { $first } to { $last }, the least comes first
# [s]
cycle-no-multiple = got { $got }, { PLAIN($ratio, digits: 6) } times velocity_cycle = { $velocity_cycle }; must be a whole multiple

# What a kind of control does not have. $has: keys or words of the profile, or empty.
lead-of-rotary-axis = a rotary axis has no lead; remove it, and give drive.gear (turns of the motor per turn of the axis)
gear-without-lead = a gear on a linear axis needs drive.lead (travel per turn of screw or pinion) beside it; give both, or remove it
contour-feed-without-deviation = belongs to contour_deviation; give that, or remove it
control-closes-elsewhere = got { $got }; kind = "{ $control }" closes its position loop otherwise: write { $has }, or leave the key out
control-without-feedforward = got { $got }; kind = "{ $control }" has only { $has }; write 0, or leave the key out
# $has: kinds that it has and the word for none
control-without-filter = got { $got }; kind = "{ $control }" has no such setpoint filter: write { $has }
filter-key-missing = missing: a filter with kind = "{ $kind }" needs it
filter-key-unused = means nothing to a filter with kind = "{ $kind }": remove it
filter-taps-sum = got taps whose sum is { PLAIN($sum, digits: 6) }, must be 1, or the axis would not arrive where it should: divide each by the sum
filter-without-end = got { $got }: behind such a filter a setpoint never ends, so no time of settling and no proof for every size of move could be stated; choose another kind, or "none" with the filter off in the control
control-with-fewer-filters = got { $got } filters; kind = "{ $control }" has { $most } in the torque setpoint; write no more
delay-below-drive = got { $got }; a drive that closes the position loop knows no newer setpoint than that of two position cycles ago: write at least { PLAIN($least, digits: 6) } s, or leave the key out
waits-long = makes the setpoint wait { TIME($delay) }, which is { ROUND($cycles, digits: 3) } position cycles of { TIME($cycle) }; must be at most { $most } of them: check the unit, or state a longer control.position_cycle

# A motor that follows its setpoint. $drive: the kind of drive to which the key belongs
key-of-other-drive = belongs to drive.kind = "{ $drive }"; remove it, or state that kind of drive
curve-does-not-rise = each velocity must be larger than the one before it
key-without-other = says nothing alone: state { $other } beside it, or remove it
motor-held-needs-modes = with drive.kind = "position_source" write kind = "modal", with the frequencies that the modes have while the motor is held
no-loop-to-set = drive.kind = "position_source" has no loop: the motor follows its setpoint; remove the key
acceleration-weighed = the functional weighs the square of the set acceleration by 1 already, and F is the same; remove the weight, and divide the others by 1 plus it
payload-of-position-source = a motor that follows its setpoint moves any payload alike, but each has frequencies of its own: remove the key, and widen requirements.frequency_spread
move-beyond-motor = got { $got }, but the motor follows only { PLAIN($limit, digits: 6) } { $unit }, by drive.max_velocity, step_rate times step_length, or the end of acceleration_curve

# The example machines. $motion: linear or rotary, $modes: frequencies
example-about = { $name }, axis { $axis_name } ({ $motion ->
    [rotary] rotary
   *[linear] linear
}; modes at { $modes })
control-lacks = kind = "{ $control }" has no { $what }; leave the key out
control-filter-range = got { $got }; kind = "{ $control }" takes { $low } to { $high } here
