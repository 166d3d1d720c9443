# The interactive page. The script fills in what stands in braces.

cli-page-written = written: { $file }; open it in a browser and try other values
what-if-heading = What if: try other values
what-if-intro = Slide or type: the page runs the sampled loop of this record again, in every corner, as the command simulate does. { $today ->
    [yes] Today's values and the recommendation stay
   *[no] The recommendation stays
} beside what you try, for the same move.
what-if-no-script = Trying values needs JavaScript. Without it, use the command simulate.
what-if-slider = slider
# $number: of the move; $size: with its unit
what-if-load = Load
what-if-values = Values side by side
what-if-tried = Tried
what-if-take = Take these
what-if-taken = Copied.
what-if-command = Command line that simulates the tried values, and the rows for the control
what-if-response = Tried: blue, its corners thin; recommended: green{ $today ->
    [yes] ; today: orange
   *[no] {""}
}. The upright line is where the band begins to count for what is tried; what exceeds 12 bands is cut off.
what-if-sizes-caption = Residual deviation over the size of the move
what-if-sizes = Worst of all machines, with the tried values. Tap or drag to try a size.
what-if-landscape-caption = Settling time over acceleration and jerk time
what-if-landscape = Strong tint: slow; hatched: a requirement is not met. A field judges only the chosen move at the chosen size, on its worst machine; other moves and sizes are judged only for the tried values. Tap or drag to try values. { $today ->
    [yes] Rings: recommended (green), today (orange).
   *[no] Ring: recommended (green).
}
what-if-bode-caption = Open loop with a notch
what-if-bode = Cut at the set { word-force }; now: green, with the notch: blue. Drag the point for frequency and depth.
what-if-margins = Margins with the notch
what-if-margins-now = Now, nominal
what-if-margins-tried = Tried, nominal
what-if-margins-worst = Now, worst corner
what-if-margins-worst-tried = Tried, worst corner
what-if-notch-note = The notch takes the place of the first notch in the loop, if it has one. It changes the margins here, not the response above: for that, write the line into [control] of the profile and run again.
what-if-no-notch = No notch: depth 0 dB.
what-if-unstable = unstable
what-if-field-size = Size of the move
what-if-field-error = Frequency error
what-if-field-notch-frequency = Notch frequency
what-if-field-notch-width = Notch width (damping of the denominator)
what-if-field-notch-depth = Notch depth
what-if-duration = Duration of the setpoint
what-if-ramp = The jerk time is shorter than the position cycle, in which a control sends its setpoint: computed with a ramp of { $value }, as the command simulate does.
what-if-frequencies = frequencies × { $factor }
what-if-damping = damping × { $factor }
what-if-all-corners = (worst of all { $count } machines)
what-if-worst-so-far = (worst { $count } of { $all } machines so far)
what-if-all-met = All requirements met by this move on all { $count } machines.
what-if-missed-check = { $name }: { $value }, allowed { $limit }
what-if-saturated = This asks for more { word-force } than there is; the command simulate shows the saturated motion.
what-if-tried-machine = The machine with { $place } is looked at besides; its residual deviation is { $value }.
what-if-sizes-met = Requirements kept at all { $count } sizes of move that were looked at (from 1 % up; the command simulate bounds those between, too).
what-if-sizes-missed = At { $missed } of { $count } sizes of move a requirement is missed; the worst is { $size } with { $value }.
what-if-landscape-range = Settling times from { $least } to { $most }.
what-if-landscape-none = No values on this map meet all requirements.
what-if-landscape-running = The map is being computed …
what-if-out-of-range = { $name }: a number from { $low } to { $high }; computed with { $value }
