
loop-kp-symmetrical-optimum = Kp nach dem symmetrischen Optimum, m / (2 T_σ).
loop-kp-largest = Kp = { PLAIN($fraction, digits: 2) } × symmetrisches Optimum, m / (2 T_σ): das größte, mit dem die Reserven in allen Eckfällen eingehalten sind.
loop-tn-yaskawa = Tn = 4 m / Kp (Untergrenze nach Yaskawa für den Geschwindigkeitsregelkreis).
loop-kv-damping-one = Kv = Kp / (4 m): Dämpfungsgrad 1 des Geschwindigkeitsregelkreises.
loop-tn-searched = Tn = { PLAIN($ratio, digits: 3) } m / Kp, aus der Suche.
loop-kv-searched = Kv = { PLAIN($ratio, digits: 3) } Kp / m, aus der Suche.
loop-reference-delay = Sollwertverzögerung: 1,5 Lagereglertakte + 1 Geschwindigkeitsreglertakt + der Teil der { word-force-before }verzögerung, den die Ruckvorsteuerung übrig lässt + die Filter, damit Vorsteuerung und Regelung zusammentreffen.

loop-unseen-modes = Die Geber sehen die Eigenform { $modes } nicht: keine Rückführung kann sie dämpfen.
loop-no-state-feedback = Keine Zustandsrückführung: { $detail }.
loop-sees-no-mode = die Geber sehen keine Eigenform, die das Werkzeug bewegt
loop-state-feedback-loses = keine hält die Reserven, minimum_bandwidth und die Steifigkeit der Kaskade nach der klassischen Regel ein
loop-state-feedback = Zustandsrückführung (LQR um die Kaskade, Kalman-Beobachter an { $sensors }): Dämpfungsgrad der Eigenform { $mode } { NUMBER($own, digits: 3) } ohne Regelung, { NUMBER($feedback, digits: 3) } mit ihr.
loop-observed-encoder-and-tcp = Lagegeber und TCP

loop-lacks-bandwidth = der schnellste Regelkreis mit den Reserven hat { PLAIN($reached, digits: 3) } Hz, minimum_bandwidth ist { PLAIN($wanted, digits: 3) } Hz

loop-without-margins = keine: der Regelkreis ist instabil (ungünstigster Eckfall)
loop-margins = { PLAIN($gain, digits: 3) } dB, { PLAIN($phase, digits: 3) }°, Maximum der Empfindlichkeit { PLAIN($peak, digits: 3) } (ungünstigster Eckfall)
loop-given-gains-poor = Die vorgegebenen Verstärkungen werden unverändert verwendet, haben aber schwache Reserven: { $margins }; gewollt sind { PLAIN($gain, digits: 3) } dB, { PLAIN($phase, digits: 3) }°, Maximum der Empfindlichkeit höchstens { PLAIN($peak, digits: 3) }. { $cure }.
loop-given-gains-slow = Mit den vorgegebenen Verstärkungen erreicht der Geschwindigkeitsregelkreis im ungünstigsten Eckfall { PLAIN($reached, digits: 3) } Hz, weniger als minimum_bandwidth = { PLAIN($wanted, digits: 3) } Hz.
loop-filters-soften = Die { word-force-before }sollwertfilter machen den Regelkreis weich: seine Bandbreite ist { PLAIN($filtered, digits: 3) } Hz mit ihnen, { PLAIN($unfiltered, digits: 3) } Hz ohne sie.
loop-takes-damping = Der Regelkreis entdämpft die Eigenform { $mode }: ihr Dämpfungsgrad ist { NUMBER($closed, digits: 3) } im geschlossenen Kreis, { NUMBER($own, digits: 3) } ohne Regelung.

loop-cure = Die Reserven wären eingehalten mit { $gains }, alle anderen Vorgaben unverändert
loop-no-cure = Keine Verstärkung allein, bis auf das Tausendfache geändert, behebt das; ohne Vorgaben werden sie eingestellt
loop-cure-kv = Kv bis { NUMBER($value) } 1/s
loop-cure-kp = Kp bis { NUMBER($value) } { $axis ->
    [rotary] N m s/rad
   *[linear] N s/m
}
loop-cure-kp-from = Kp ab { NUMBER($value) } { $axis ->
    [rotary] N m s/rad
   *[linear] N s/m
}
loop-cure-tn = Tn ab { TIME($value) }

loop-unstable = mit Kv = { NUMBER($Kv) } 1/s, Kp = { SI($Kp, "DAMPING") }, Tn = { PLAIN($Tn) } s ({ $corner }). { $cure }
loop-no-margins = bei Kp = { SI($Kp, "DAMPING") }, { SHARE($share) } des symmetrischen Optimums, gibt es { $margins }
loop-mode-without-damping = Eigenform { $mode } ({ PLAIN($frequency) } Hz) hat den Dämpfungsgrad 0
loop-hidden-states = Zustandsrückführung von { $states }
loop-observer-failed = Beobachter: { $error }
loop-gains-failed = Verstärkungen: { $error }

loop-motor-follows = kein Regelkreis einzustellen: der Motor folgt dem Sollwert, um { TIME($delay) } verspätet, so lange wie zwei Sollwerte brauchen; beurteilt wird die Beschleunigung des gefilterten Sollwerts, sie ist die des Motors
move-of-many-cycles = eine Bewegung von { PLAIN($time) } s sind { ROUND($cycles, digits: 3) } Geschwindigkeitsreglertakte von { TIME($cycle) }, verfolgt werden höchstens { ROUND($most, digits: 3) }
