# Limits through the loop: candidates, robustness, comparisons.

# candidates and ways
way-recommended = recommended
way-listed = listed sizes only
shaper-for-mode = { $shaper } shaper ({ $mode }, { NUMBER($frequency, digits: 3) } Hz)
shaper-of-calibration = calibrate_shaper: { $shaper } { FREQUENCY($frequency) }
source-singer = Singer & Seering 1990
source-klipper = Klipper, Resonance Compensation
source-calibrate-shaper = Klipper, calibrate_shaper at 84104bbb, its criterion computed here

# where a worst value was found; $parts: some of the others
place = { $parts }
place-move = move { $number }
place-velocity-step = step of { VELOCITY($size) }
place-distance = distance of { LENGTH($size) }
place-nominal = nominal
place-state = state { $name }
place-payload = payload { MASS($payload) }
place-frequencies = frequencies × { NUMBER($factor, digits: 6) }
place-damping = damping × { NUMBER($factor, digits: 6) }

# choice of the loop
with-state-feedback = with state feedback
without-state-feedback = without state feedback
loop-in-use = the loop that is used
time-value = { TIME($time) }
state-feedback-chosen = State feedback: best settling time { $with_it } with it, { $without } without it: it is used.
state-feedback-left-out = State feedback: best settling time { $with_it } with it, { $without } without it: it is left out.
state-feedback-stiffness = With state feedback the dynamic stiffness in the worst corner changes by { CHANGE($change) }.
state-feedback-would = State feedback (kind = "state-space" with state_feedback = "auto"; no other control has it), which is not used here: settling time { $with_it } with it, { $without } without it; dynamic stiffness in the worst corner { CHANGE($change) } with it.
# $number of loops tried; $later: what the stiffer tool may cost; $soonest: settling time of any
loop-chosen = Of { $number } loops with the margins, none softer than by the classic rule and none slower against a lasting { word-force }, this one serves the moves best, twice the stiffness counting as much as 0.7 % of the settling time: { $settling } with { STIFFNESS($stiffness, digits: 3) } dynamic stiffness in the worst corner.
# Filters of the set force that nobody asked for; $filters: the two messages that follow
loop-filters-used = Used, since the profile leaves force_filters open (force_filters = [] turns them off): { $filters }. With the classic ratios of Kv and Tn, Kp rises from { DAMPING($Kp, digits: 3) } to { DAMPING($higher, digits: 3) }, dynamic stiffness from { STIFFNESS($stiffness, digits: 3) } to { STIFFNESS($stiffer, digits: 3) } (worst corner).
loop-filter-notch = notch at { FREQUENCY($frequency) }, damping { NUMBER($damping, digits: 3) } over width { NUMBER($width, digits: 3) }
loop-filter-low-pass = low-pass at { FREQUENCY($frequency) }, damping { NUMBER($damping, digits: 3) }
loop-no-filters = No notch or low-pass in the { word-force } setpoint lets Kp and dynamic stiffness rise by 3 %.
control-needs-state-feedback = The control must offer state feedback; if yours does not, set state_feedback = "off".

# small changes

# robustness; $low, $high: ends of the range kept, $lost: requirements missed outside
frequency-spread-not-stated = The profile states no spread of the frequencies; all requirements are kept only while the eigenfrequencies are off by { $low } to { $high }. Missed outside this range: { $lost }. State a frequency spread of at least { SHARE($least) }, and run again.
frequency-end = { CHANGE($error) }
frequency-end-at-least = at least { CHANGE($error) }
missed-where-lower = { $requirement } (where they are lower)
missed-where-higher = { $requirement } (where they are higher)

# the paper's comparison
control-time-optimal = time-optimal
control-damping-optimal = damping-optimal

# the values now in the control; $stated, $others: Kv, Kp, Tn
today-in-recommended-loop = Today's gains are not stated: today's limits were simulated with the recommended loop, so only acceleration, jerk and filter are compared.
today-in-own-loop = Simulated with today's Kv, Kp and Tn; feed-forward and cycles as recommended.
today-in-mixed-loop = Simulated with today's { $stated }; { $others }, not stated, and feed-forward and cycles as recommended.
today-not-judged = Values stated in [today] were not judged: { $why }
today-unstable = The loop is unstable with today's Kv = { NUMBER($Kv) } 1/s, Kp = { DAMPING($Kp) }, Tn = { TIME($Tn) } ({ $corner }).

# what would bring more
change-dsc = Position loop in the drive (DSC)
change-interpolation = Feed-forward interpolated at the velocity cycle
change-feedforward = { word-force-first } feed-forward on
change-setpoint-filter = Setpoint filter chosen freely among those of the control
change-force-filters = Filters of the set { word-force }
change-no-filters = no filter lets Kp rise
change-lag = Half the lag of the { word-force } loop
change-dwell = Rest of { TIME($dwell) } or more after each move
change-rest = Longer rest after each move
change-spread = Frequency spread of ± { SHARE($spread) } (measured over positions and payloads)
change-state-feedback = State feedback with an observer
change-saves-little = saves less than { SHARE($share) } of the settling time
change-without-margins = no Kp keeps the margins

# What a Python prompt and a notebook show
glance = { $machine }, axis { $axis_name }: { $verdict }; a = { $acceleration }, j = { $jerk }, setpoint filter { $filter }, settling time { $settling }
glance-alt = Deviation at the tool and set { word-force } over time in every corner
glance-corners = further corners
glance-deviation = tool deviation in { $unit }
glance-end = setpoint has ended
glance-force = set { word-force } in { $unit }
glance-time = time in ms
