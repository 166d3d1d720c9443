# candidates and ways
way-recommended = empfohlen
way-listed = nur angegebene Größen
shaper-for-mode = { $shaper }-Shaper ({ $mode }, { NUMBER($frequency, digits: 3) } Hz)
shaper-of-calibration = calibrate_shaper: { $shaper } { FREQUENCY($frequency) }
source-singer = Singer & Seering 1990
source-klipper = Klipper, Resonance Compensation
source-calibrate-shaper = Klipper, calibrate_shaper, Stand 84104bbb, sein Kriterium hier berechnet

# where a worst value was found; $parts: some of the others
place = { $parts }
place-move = Bewegung { $number }
place-velocity-step = Sprung um { VELOCITY($size) }
place-distance = Weg { LENGTH($size) }
place-nominal = Nennfall
place-state = Zustand { $name }
place-payload = Zuladung { MASS($payload) }
place-frequencies = Frequenzen × { NUMBER($factor, digits: 6) }
place-damping = Dämpfung × { NUMBER($factor, digits: 6) }

# choice of the loop
with-state-feedback = mit Zustandsrückführung
without-state-feedback = ohne Zustandsrückführung
loop-in-use = der verwendete Regelkreis
time-value = { TIME($time) }
state-feedback-chosen = Zustandsrückführung: beste Einschwingzeit { $with_it } mit ihr, { $without } ohne sie: sie wird verwendet.
state-feedback-left-out = Zustandsrückführung: beste Einschwingzeit { $with_it } mit ihr, { $without } ohne sie: sie wird weggelassen.
state-feedback-stiffness = Mit Zustandsrückführung ändert sich die dynamische Steifigkeit im ungünstigsten Eckfall um { CHANGE($change) }.
state-feedback-would = Zustandsrückführung (kind = "state-space" mit state_feedback = "auto"; keine andere Steuerung hat sie), die hier nicht verwendet wird: Einschwingzeit { $with_it } mit ihr, { $without } ohne sie; dynamische Steifigkeit im ungünstigsten Eckfall { CHANGE($change) } mit ihr.
loop-chosen = Von { $number } Regelkreisen mit den Reserven, keiner weicher als nach der klassischen Regel und keiner langsamer gegen { $axis ->
    [rotary] ein bleibendes Drehmoment
   *[other] eine bleibende { word-force }
}, dient dieser den Bewegungen am besten; doppelte Steifigkeit zählt so viel wie 0,7 % der Einschwingzeit: { $settling } bei { STIFFNESS($stiffness, digits: 3) } dynamischer Steifigkeit im ungünstigsten Eckfall.
loop-filters-used = Verwendet, weil das Profil force_filters offenlässt (force_filters = [] schaltet sie ab): { $filters }. Mit den klassischen Verhältnissen von Kv und Tn steigen Kp von { DAMPING($Kp, digits: 3) } auf { DAMPING($higher, digits: 3) } und die dynamische Steifigkeit von { STIFFNESS($stiffness, digits: 3) } auf { STIFFNESS($stiffer, digits: 3) } (ungünstigster Eckfall).
loop-filter-notch = Bandsperre bei { FREQUENCY($frequency) }, Dämpfung { NUMBER($damping, digits: 3) } zu Breite { NUMBER($width, digits: 3) }
loop-filter-low-pass = Tiefpass bei { FREQUENCY($frequency) }, Dämpfung { NUMBER($damping, digits: 3) }
loop-no-filters = Keine Bandsperre und kein Tiefpass im { word-force-before }sollwert lässt Kp und dynamische Steifigkeit um 3 % steigen.
control-needs-state-feedback = Die Steuerung muss eine Zustandsrückführung bieten; wenn Ihre das nicht tut, state_feedback = "off" setzen.

# small changes

# robustness; $low, $high: ends of the range kept, $lost: requirements missed outside
frequency-spread-not-stated = Das Profil gibt keine Streuung der Frequenzen an; alle Anforderungen sind nur erfüllt, solange die Eigenfrequenzen um { $low } bis { $high } abweichen. Außerhalb davon verletzt: { $lost }. Eine Streuung der Frequenzen von mindestens { SHARE($least) } angeben und neu rechnen.
frequency-end = { CHANGE($error) }
frequency-end-at-least = mindestens { CHANGE($error) }
missed-where-lower = { $requirement } (wo sie tiefer liegen)
missed-where-higher = { $requirement } (wo sie höher liegen)

# the paper's comparison
control-time-optimal = zeitoptimal
control-damping-optimal = dämpfungsoptimal

# the values now in the control; $stated, $others: Kv, Kp, Tn
today-in-recommended-loop = Die heutigen Verstärkungen sind nicht angegeben: die heutigen Grenzwerte wurden mit dem empfohlenen Regelkreis simuliert, verglichen werden also nur Beschleunigung, Ruck und Filter.
today-in-own-loop = Simuliert mit heutigem Kv, Kp und Tn; Vorsteuerung und Takte wie empfohlen.
today-in-mixed-loop = Simuliert mit heutigem { $stated }; { $others }, nicht angegeben, sowie Vorsteuerung und Takte wie empfohlen.
today-not-judged = Die in [today] angegebenen Werte wurden nicht beurteilt: { $why }
today-unstable = Der Regelkreis ist instabil mit den heutigen Werten Kv = { NUMBER($Kv) } 1/s, Kp = { DAMPING($Kp) }, Tn = { TIME($Tn) } ({ $corner }).

# what would bring more
change-dsc = Lageregelung im Antrieb (DSC)
change-interpolation = Vorsteuerung im Geschwindigkeitsreglertakt interpoliert
change-feedforward = { word-force-before }vorsteuerung ein
change-setpoint-filter = Sollwertfilter frei gewählt unter denen der Steuerung
change-force-filters = { $axis ->
    [rotary] Filter des Solldrehmoments
   *[linear] Filter der Soll{ word-force-behind }
}
change-no-filters = kein Filter erlaubt ein höheres Kp
change-lag = Halbe Verzögerung der { word-force-before }regelung
change-dwell = Ruhezeit ab { TIME($dwell) } je Bewegung
change-rest = Längere Ruhezeit nach jeder Bewegung
change-spread = Streuung der Frequenzen von ± { SHARE($spread) } (über Positionen und Zuladungen gemessen)
change-state-feedback = Zustandsrückführung mit Beobachter
change-saves-little = spart weniger als { SHARE($share) } der Einschwingzeit
change-without-margins = kein Kp hält die Reserven ein

# Was eine Python-Konsole und ein Notebook zeigen
glance = { $machine }, Achse { $axis_name }: { $verdict }; a = { $acceleration }, j = { $jerk }, Sollwertfilter { $filter }, Einschwingzeit { $settling }
glance-alt = Abweichung am Werkzeug und Soll{ word-force-behind } über der Zeit in jedem Eckfall
glance-corners = weitere Eckfälle
glance-deviation = Abweichung am Werkzeug in { $unit }
glance-end = Sollwert zu Ende
glance-force = Soll{ word-force-behind } in { $unit }
glance-time = Zeit in ms
