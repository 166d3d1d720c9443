# What the command line says: options, files, the end of a command.

either = { $first } or { $last }

option-between = got { $got }, must be { $least } to { PLAIN($most, digits: 12) }
option-not-positive = got { $got }, must be > 0 { $unit }
option-no-such-move = got { $got }, the profile has moves 1 to { $count }
# $force, $load: SI, printed as typed
option-force-below-static-load = got { PLAIN($force, digits: 6) } { $unit }, must be above what static load and friction take, { PLAIN($load, digits: 6) } { $unit }
option-given-twice = { $name } is given { $count } times; give each state or output once
option-final-time-is-found = goes with --kind damping; a time-optimal control finds its own final time
option-jerk-of-what-follows = goes with --kind time, --method exact and drive.kind = "position_source"; behind a loop the { word-force } lag limits the jerk
option-jerk-all-but-jumps = with { PLAIN($jerk, digits: 6) } { $unit } the acceleration reaches its limit within { TIME($ramp) }, all but at once; leave --jerk out, which lets it jump
option-bounds-need-transcription = bounds on a damping-optimal control need --method transcription
option-step-or-distance = cannot go with --velocity-step; give one of them
option-no-signal = no state or output { $got }{ $hint }

file-folder-not-writable = cannot write there ({ $reason }); give another folder with -o
file-above = { $place } is a file
file-no-right = no right to write into { $folder }
file-is-folder = is a folder; give a file name
file-without-folder = there is no folder { $folder }; make it first, or give another name
file-not-writable = cannot write this file ({ $reason }); give another name
file-is-input = is read by this command, too; give another name
file-named-twice = is named for two results; give each its own file
file-write-protected = is write-protected; give another name, or allow writing

cli-no-profile = got no profile; give a TOML file
cli-no-record = got no record; give the record.json of a run, or --control ? for the list
cli-file-exists = exists already; give another name
print-boxes = sheet.pdf has no letters for { $characters } and prints boxes in their place; sheet.html shows them, or write the name in Latin, Greek or Cyrillic letters
cli-interrupted = interrupted; every file is whole: as it was before, or, if it was just being written, new
cli-no-epoch = got "{ $got }", must be seconds since 1970, or unset it
cli-file-system = standard output or working folder
cli-internal-error = internal error, please report it with the profile: { $error }
cli-written = written: { $files }
cli-written-into = written into { $folder }: { $files }
cli-next-run = next: mtcommission run { $profile }
cli-next-export = next: mtcommission export { $record } --control { $control }
cli-list-of-controls = (--control ? lists the controls)
cli-failed-cases = { $count } failed

# The running stage, beside the spinner.
stage-optimal-controls = optimal controls
stage-feedback-loop = feedback loop
stage-responses = responses and rules of thumb
stage-attainable = what could be met
stage-machining-modes = machining modes
stage-improvements = potential improvements
stage-sheet = sheet
stage-response = response

# Gains of the loop, as the profile names them
simulated-ramp-of-a-cycle = The ramp a/j = { TIME($ramp, digits: 3) } is shorter than the position cycle, in which a control sends its setpoint: simulated with a ramp of one cycle, { TIME($cycle, digits: 3) }.
option-jerk-needed = the control limits the jerk, so the limit to be tried is needed, e.g. --jerk 100m/s^3
simulated-without-filter = Simulated without a setpoint filter: the profile leaves it open (auto). State control.setpoint_filter to judge limits behind one.
simulated-with-loop = Loop, tuned where left open: Kv { RATE($Kv) }, Kp { DAMPING($Kp) }, Tn { TIME($Tn) }.
simulated-with-filters = Filters of the set { word-force }: { $filters }.
simulated-without-loop = Open-loop axis: there is no loop to tune.

# A call that does not fit the commands.
usage-see = { $wrong }; see { $command } --help
usage-missing = { $what } is missing
usage-no-option = there is no option { $got }{ $hint }
usage-no-command = there is no such command; there are: { $names }
usage-there-are = { " " }(there are: { $names })
usage-value = { $option } takes a value just where --help shows one
usage-number = { $option } must be a whole number
usage-too-many = more files or names than the command takes
option-form = got "{ $got }", must be { $form }
option-one-of = got "{ $got }", must be one of: { $allowed }
