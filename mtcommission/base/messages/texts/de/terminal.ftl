terminal-head-seen = Vom Lagegeber gesehen
terminal-head-tool-at-full-force = Werkzeug bei { word-f-max }
terminal-head-frequencies = Freq.
terminal-head-dampings = Dämpf.
terminal-head-move-head = Bew.
terminal-head-found = Höchstwert
terminal-limits-listed = Gelistete Bewegungen
terminal-check-any-size = Anforderung, jede Größe
terminal-filter-with-limits = Filter, mit a und j einzugeben
terminal-loop-today = Regelkreis heute: { $gains }.
terminal-head-rigid-body-limit = Grenze des starren Körpers
terminal-head-reason = Grund
terminal-head-arc = Bogen
terminal-head-from = Von
terminal-head-to = Bis
terminal-head-peak-deviation = Spitze
terminal-head-terminal-error = Endfehler
terminal-head-settling-time = Einschw.
terminal-head-residual = Rest
terminal-head-meets = i.O.
terminal-head-basis = Grundlage
terminal-basis-loop = Regelkreis
terminal-basis-neglected = Vernachlässigt
terminal-machine = { $name }, Achse { $axis_name }
terminal-source = Quelle der Daten: { $source }
terminal-no-warnings = Keine Warnungen.
terminal-force-on-mass = { $force } an { $mass }
terminal-time-of-move = Zeit der Bewegung { $number }
terminal-rigid-time = mit dieser Beschleunigung, ohne Ruckbegrenzung, ohne Schwingung: keine Steuerung ist schneller
terminal-time-optimal = Zeitoptimale Steuerung
terminal-damping-optimal = Dämpfungsoptimale Steuerung
terminal-arc-interior = innen
terminal-arc-boundary = { $name }, { $side ->
    [upper] obere Grenze
   *[lower] untere Grenze
}
terminal-more-arcs = { $count } weitere:
terminal-see-json = siehe --json
terminal-final-time = { $move }: t_f = { $t_f } bei { word-f-max } = { PLAIN($force, digits: 6) } { $unit }, Verfahren { $method }.
terminal-grid-proves-nothing = Ein Gitter beweist keine untere Schranke von t_f; --method exact tut es.
terminal-lower-bound = Keine Steuerung ist schneller als { $bound } (relative Lücke { PLAIN($gap, digits: 1, style: "e") }).
terminal-loose-proof = Höchstens { PLAIN($percent, digits: 1) } % langsamer als das Optimum; genaue Bögen wurden nicht gefunden.
terminal-law-in-cells = { switching-law }: bis auf eine Zelle eines Netzes erfüllt. Bögen namens „innen“ ({ PLAIN($percent, digits: 2) } % von t_f) stehen für Umschaltungen und Berührpunkte, die zu dicht liegen, um unterschieden zu werden; der Beweis von t_f ruht nicht auf ihnen. Wie { word-force } dort verläuft, steht in --csv.
terminal-law-fails = { switching-law }: NICHT ERFÜLLT.
terminal-origin-of-final-time = t_f ist { $origin }.
terminal-final-time-of-option = das von --t-f
terminal-final-time-of-profile = das des Profils (damping_optimal.t_f)
terminal-final-time-by-default = das { PLAIN($factor, digits: 6) }-Fache von t_f,min: weder --t-f noch das Profil gibt eines an
terminal-weight = { $state } { PLAIN($value, digits: 5) } { $unit }
terminal-velocity-exceeded = max_velocity ist kein Teil dieses Optimums: |{ $name }| überschreitet sie um { PLAIN($percent, digits: 2) } %; --limit { $name }=... mit --method transcription hält sie ein.
terminal-cost = Kosten { PLAIN($cost, digits: 9) } { $unit }; Gesetz (16) der Veröffentlichung bis auf { PLAIN($residual, digits: 1, style: "e") } { word-f-max } erfüllt.
terminal-reached = erreicht
terminal-not-reached = nicht erreicht
terminal-exceeded = zwischen den Punkten des Gitters um { PLAIN($percent, digits: 1) } % überschritten
terminal-limit = Grenze: { $name } höchstens { $value }, { $acts }.
terminal-touched = { $limit }, bei { PLAIN($ms, digits: 4, style: "f") } ms nur einen Augenblick berührt.
terminal-more-touches = ... und { $count } weitere Berührpunkte: siehe --json
terminal-assumed = Angenommen: { $what }.
terminal-bound-by = Begrenzt durch: { $what }.
terminal-worst = Ungünstigste Fälle: { $places }.
terminal-more-rules = Nicht gezeigte Faustregeln: { $count }; { $met } davon erfüllen alle Anforderungen.
terminal-more-notes-in-sheet = Weitere Hinweise: { $count }, siehe Blatt.
terminal-more-notes-of-run = Weitere Hinweise: { $count }, im Blatt, das mtcommission run schreibt.
terminal-response = Antwort des Regelkreises
terminal-simulated = Simuliert: a { $acceleration }, j { $jerk }, Sollwertfilter { $filter }; { $moves }.
terminal-saturated = { $force } begrenzt

switching-law = Schaltgesetz { word-f-set } = -sign({ word-lambda }) { word-f-max } (lambda: Adjungierte, Empfindlichkeit von t_f gegen die Zustände)
terminal-jerk-law = Schaltgesetz Ruck = -sign({ word-lambda }) j_max: { $holds ->
    [yes] gilt, wo keine Schranke gehalten wird
   *[no] nicht bestätigt
}.
terminal-law-holds = { switching-law }: erfüllt{ $grid ->
    [yes] { " " }bis auf einen Schritt des Gitters
   *[no] { "" }
}{ $boundary ->
    [yes] { " " }außerhalb der Randbögen
   *[no] { "" }
}.
terminal-weights = { $chosen ->
    [stated] Gewichte, aus dem Profil
   *[balanced] Gewichte, ausgewogen
}: { $weights }
terminal-of-motor = so weit folgt der Motor laut Profil
