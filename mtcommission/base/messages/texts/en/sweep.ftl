# Faults of a sweep: its options, its table of cases, its folder.

sweep-no-text = is not UTF-8 text; save it as CSV in UTF-8
sweep-table-too-large = is larger than { PLAIN($most, digits: 12) } bytes; split it into several sweeps
sweep-table-without-cases = needs a header of keys and at least one case below it
sweep-table-too-wide = has { $count } columns; at most { $most } keys are varied together
sweep-table-too-long = has { PLAIN($count, digits: 12) } cases, must be at most { PLAIN($most, digits: 12) }
sweep-no-csv = is no CSV: { $reason }
sweep-count-of-cells = needs { $wanted } values, got { $got }
sweep-empty-cell = { $key }: has no value
sweep-two-units = { $key }: got "{ $got }" below a heading in { $unit }, must be a plain number

sweep-varies-twice = varies twice; give it once
sweep-unequal-lengths = needs as many values for each key, got { $got }
sweep-no-axis = got { $got }, must be KEY=RANGE
sweep-empty-value = has an empty value
sweep-no-range = got { $got }: { $reason }
sweep-forms-of-ranges = must be START:STOP:COUNT, log:START:STOP:COUNT or random:LOW:HIGH:COUNT:SEED, or a comma list
sweep-ends-with-two-units = write both ends with the same unit, or both without (SI)
sweep-count-of-range = the count must be 1 to { PLAIN($most, digits: 12) }
sweep-logarithm-of-zero = a logarithmic range needs ends > 0
sweep-no-number = { $got } does not begin with a number
sweep-no-element = the profile has no such element; they count from 1 in brackets, e.g. { $example }; write a missing one there first
sweep-no-key = there is no such key; elements of arrays go by number, e.g. { $example }
sweep-taken-from-profile = only goes with --quantity optimal; { $quantity } takes it from the profile

sweep-folder-in-use = another sweep is at work there; wait until it ends, or give another folder with -o
sweep-folder-holds-one = holds a sweep already; continue it with --resume or give another folder
sweep-folder-holds-another = holds another sweep (other profile, ranges, quantity or version); give another folder, or the options it was begun with
sweep-folder-holds-foreign = holds { $names }, which no sweep of ours wrote or whose beginning and rows are all damaged; give another folder
sweep-lock-is-link = { $name } is a link
sweep-disk-full = cannot write ({ $reason }); all rows before are kept: free space and continue with --resume
sweep-cases-kept = { PLAIN($done, digits: 12) } of { PLAIN($count, digits: 12) } cases are on disk in { $folder }
sweep-piece-lost = { PLAIN($done, digits: 12) } of { PLAIN($count, digits: 12) } cases are on disk, piece { PLAIN($piece, digits: 12) } is not
sweep-waits = the cluster has no worker; waiting for one (start it with: dask worker ADDRESS), Ctrl-C ends
sweep-scheduler-gone = { $address } answers no more; { PLAIN($done, digits: 12) } of { PLAIN($count, digits: 12) } cases are on disk
sweep-no-cluster-extra = needs the cluster extra: pip install "mtcommission[cluster]"
sweep-no-dask = what listens there does not speak as Dask does
sweep-no-scheduler = no scheduler answers at { $address } ({ $why }); start it with: dask scheduler, and give its address as it prints it; tls:// needs certificates in the settings of Dask (docs/sweeps.md)
sweep-other-scheme = got { $address }, must be an address as dask scheduler prints it, tcp://HOST:PORT or tls://HOST:PORT

sweep-column-key = Varied key of the profile.
sweep-column-case = Number of the case, from 0; of a grid the last key runs fastest.
    .head = Case
sweep-column-t-f = Least time of the move to exact rest, time-optimal; of the slowest move for limits.
    .head = t_f
sweep-column-t-f-lower-bound = No control is quicker than this: proved by the adjoint.
    .head = Proved bound of t_f
sweep-column-relative-gap = (t_f - t_f_lower_bound) / t_f.
    .head = Relative gap
sweep-column-certified = Whether the gap is at most 1e-9.
    .head = Proved
sweep-column-switches = Number of switches of the time-optimal control.
    .head = Switches
sweep-column-switching-times = Times of its switches, separated by blanks.
sweep-column-peak = Greatest magnitude of { $name } during the move and after it.
    .head = Peak: { $name }
sweep-column-acceleration = Recommended acceleration limit.
    .head = Acceleration
sweep-column-jerk = Recommended jerk limit.
    .head = Jerk
sweep-column-jerk-time = Acceleration limit over jerk limit.
    .head = Jerk time
sweep-column-settling-time = From start until the tool stays in its band; slowest move, worst corner.
    .head = Settling time
sweep-column-residual-deviation = Greatest deviation of the tool after the setpoint's end, worst corner.
    .head = Residual deviation
sweep-column-peak-deviation = Greatest deviation of the tool at any time, worst corner.
    .head = Peak deviation
sweep-column-requirements-met = Whether all requirements are met in every corner.
    .head = All met
sweep-column-bound-by = What keeps the recommended limits from being higher.
    .head = Bound by
sweep-column-obstacle = The requirement that is not met; empty where all are.
    .head = Not met
sweep-column-record = Record of the whole run, beside this table.
    .head = Record
sweep-column-outcome = "done", or how the computation ended.
    .head = Outcome
sweep-column-message = Why there is no result, and what to do.
    .head = Why none

sweep-asked = Quantity: { $parts }.
sweep-asked-move = move { $move } of { $of }
sweep-asked-bound = |{ $name }| at most { $bound }
sweep-summary = { PLAIN($count, digits: 12) } cases: { $ends }; { $kind ->
        [certified] certified
       *[requirements_met] requirements met
    }: { PLAIN($met, digits: 12) }
sweep-count-done = { PLAIN($count, digits: 12) } done
sweep-not-certified = not certified, first in case { PLAIN($case, digits: 12) }: at most { PLAIN($gap, digits: 2) } of its time above the least possible (certified: 1e-9)
sweep-first-in = first in case { PLAIN($case, digits: 12) }

sweep-page-title = Sweep: { $name }
sweep-page-units = Units stand in the headings; rows.csv holds the same in SI. Calculated, not measured.
sweep-page-script = The plots and the table need JavaScript; rows.csv holds the same rows.
sweep-page-heading = Over what varies
sweep-page-horizontal = Horizontal
sweep-page-vertical = Vertical
sweep-page-logarithmic = logarithmic
sweep-page-good = { $kind ->
        [certified] certified
       *[requirements_met] all requirements met
    }
sweep-page-marks = Green point: { $good }; red cross: not. Thin lines join cases that differ in nothing else. Band green: all cases there are; yellow: some; red: none. Move the pointer to read a point, click it for its profile.
sweep-page-trade = Trade-off of time against vibration, or of any two columns
sweep-page-ringed = Ringed: no other case is as low in one and lower in the other (Pareto front).
sweep-page-map = Map over two keys
sweep-page-scale = White: no result; red mark: not { $good }. Equal steps for equal places in the list of values.
sweep-page-rows = Rows
sweep-page-back = Previous
sweep-page-on = Next
sweep-page-sort = Click a heading to sort; rest the pointer on it to read what it means.
sweep-page-profile = Profile of a case
sweep-page-choose = Choose a case in a plot or in the table.
sweep-page-case = case %1
sweep-page-over = %1 over %2
sweep-page-over-two = %1 over %2 (right) and %3 (up); light: %4, dark: %5
sweep-page-numbers = numbers: %1
sweep-page-page = Page %1 of %2
sweep-page-chosen = Case %1; values that vary stand in SI.
sweep-page-front = Trade-off
