# Eine aufgezeichnete Bewegung neben der Ergebnisdatei einer Berechnung.
# Zeiten in s, Längen in m (rad), Anteile von 0 bis 1; $file, $name, $names, $mode: Namen des Benutzers

verify-stage = Vergleich
verify-title = Nachweis an der Maschine

# Das Urteil
verify-verdict-holds = Eingehalten
verify-verdict-does-not-hold = Nicht eingehalten
verify-verdict-cannot-tell = Nicht zu entscheiden
verify-verdict-in-part = Nicht für alle Bewegungen zu entscheiden: Bewegung { $known } eingehalten, Bewegung { $missing } nicht aufgezeichnet
verify-verdict-except = Was zu beurteilen ist, ist eingehalten; nicht zu entscheiden: { $what }
verify-verdict-nothing = Nicht zu entscheiden: { $what }
verify-detail = { $moves ->
    [one] Eine Bewegung
   *[other] { $moves } Bewegungen
} aufgezeichnet. { $obeyed ->
    [yes] Die Steuerung gab aus, was eingegeben war.
    [no] Die Steuerung gab nicht aus, was eingegeben war.
   *[other] Ob die Steuerung ausgab, was eingegeben war, ist nicht zu entscheiden.
}
verify-disclaimer = Gemessen neben berechnet, keine Abnahmeprüfung.
verify-unexplained = Von der Abweichung erklärt die Vorhersage { SHARE($share) } (Effektivwert) nicht.

# Was geprüft wird
verify-setpoint-velocity = Geschwindigkeit des Sollwerts
verify-setpoint-acceleration = Beschleunigung des Sollwerts
verify-setpoint-jerk = Ruck des Sollwerts
verify-peak-deviation = größte Abweichung
verify-max-force = { $axis ->
    [rotary] größtes Istmoment
   *[linear] größte Ist{ word-force-behind }
}
verify-reference-delay = Verzug gegen den Sollwert
verify-frequency = Frequenz (geregelt)
verify-damping-ratio = Dämpfungsgrad (geregelt)

# Warum
verify-kept = eingehalten, die Unsicherheit eingeschlossen
verify-missed = um mehr als die Unsicherheit verfehlt
verify-within-noise = die Unsicherheit reicht über die Grenze; mit feinerer Auflösung oder weniger Rauschen wiederholen
verify-planned = { $by ->
    [trace] was die eingegebenen Werte von Beschleunigung und Ruck bei einer Bewegung dieser Größe erreichen (in der Aufzeichnung: { QUANTITY($entered, $unit) })
   *[entry] was mit der Eingabe { QUANTITY($entered, $unit) } geplant ist
}
verify-setpoint-obeyed = hält ein, { verify-planned } (Mittelwerte über { TIME($width) })
verify-setpoint-above = über dem, { verify-planned } (Mittelwerte über { TIME($width) })
verify-setpoint-below = erreicht nie, { verify-planned } (Mittelwerte über { TIME($width) })
verify-setpoint-coarse = der Sollwert ist zu grob aufgezeichnet (Mittel über { TIME($width) }); mehr Stellen oder kürzeren Takt aufzeichnen
verify-setpoint-no-plan = für diese Bewegung gibt es keinen Plan (Mittel über { TIME($width) })
verify-cut = die Aufzeichnung endet vor dem Sollwert
verify-other-setpoint = die Steuerung gab etwas anderes aus, als eingegeben war
verify-no-tool = weder Werkzeug noch Lagegeber aufgezeichnet
verify-encoder-only = nur der Lagegeber ist aufgezeichnet, und er zeigt nicht, was { $mode } am Werkzeug macht; am Werkzeug aufzeichnen
verify-no-state = kein aufgezeichnetes Signal zeigt es
verify-other-move = keine der Bewegungen, für die die Ergebnisdatei es zusagt
verify-too-short = die Aufzeichnung endet { TIME($got) } nach dem Sollwert; die langsamste Eigenform braucht { TIME($needed) }
verify-noise-above-band = das Rauschen { LENGTH($noise) } liegt über dem Band { LENGTH($band) }
verify-no-force = { word-force } nicht aufgezeichnet
verify-dwell-not-recorded = die Grenze gilt im Mittel über { TIME($needed) }, Bewegung und Verweilzeit; davon sind { TIME($got) } aufgezeichnet
verify-delay-not-recorded = der Sollwert ist hinter dem Verzug aufgezeichnet, der deshalb nicht zu sehen ist
verify-mode-not-seen = die Eigenform hebt sich nach der Bewegung nicht ab

# Warnungen
verify-behind-delay = { $file }: das Gemessene kommt um { TIME($delay) } früher als vorhergesagt, so viel wie der Verzug der Steuerung: der Sollwert ist hinter diesem Verzug aufgezeichnet und wird so beurteilt. Ist er davor aufgezeichnet, so wirkt der Verzug in der Steuerung nicht.
verify-planner-exceeds = Die Steuerung überschreitet, was eingegeben war: { $what } { QUANTITY($measured, $unit) }, geplant { QUANTITY($planned, $unit) }. Dort vor der Mechanik suchen: Achs- oder Dynamikmodus, Ruckbegrenzung ausgeschaltet, anderer Parametersatz.
verify-planner-below = Die Steuerung erreicht nie, was eingegeben war: { $what } { QUANTITY($measured, $unit) }, geplant { QUANTITY($planned, $unit) }. Nach einer anderen Grenze suchen: Override, Bahnbeschleunigung, Dynamikmodus, Sollwertfilter.
verify-moves-missing = Nicht aufgezeichnet: Bewegung { $moves } der Ergebnisdatei. Was sie dafür zusagt, ist nicht zu entscheiden.
verify-moves-unknown = { $file }: { $moves ->
    [one] eine Bewegung von { QUANTITY($size, $unit) } ist
   *[other] { $moves } Bewegungen, die erste von { QUANTITY($size, $unit) }, sind
} keine der Ergebnisdatei. Gehört die Aufzeichnung zu dieser Achse?
verify-begins-moving = { $file } beginnt mitten in einer Bewegung, die ausgelassen wurde; im Stillstand beginnen.
verify-moves-with-gaps = { $file }: Bewegungen mit verlorenen Werten wurden ausgelassen ({ $count }).
verify-many-moves = { $used } von { $found } Bewegungen wurden verglichen.
verify-gap = Keine Werte von { TIME($begin) } bis { TIME($end) }.
verify-si-assumed = { $name } hat keine Einheit, als SI gelesen.
verify-at-motor = { $name } [{ $unit }] gilt an der Motorwelle; mit Steigung und Getriebe des Profils umgerechnet.
verify-setpoint-from-velocity = Keine Lage des Sollwerts: aus { $name } integriert.
verify-reversed = { $name } läuft gegen den Sollwert; das Vorzeichen wurde gedreht.

# Dateien, mit denen nichts anzufangen ist
verify-no-time-record = enthält keine Signale über der Zeit; eine Bewegung mit Soll- und Istlage aufzeichnen
verify-missing-setpoint = kein Sollwert unter den Spalten { $found }; --columns x_ref=SPALTE angeben oder die Solllage aufzeichnen: ohne sie weiß niemand, was die Steuerung verlangt hat
verify-missing-measured = nichts Gemessenes unter den Spalten { $found }; --columns encoder=SPALTE, tcp=SPALTE, following_error=SPALTE oder acceleration=SPALTE angeben
verify-two-columns = { $names } können jeweils { $role } sein; durch --columns { $role }=SPALTE sagen, welche
verify-constant-missing = { $name } ist ein Strom; { $axis ->
    [rotary] --constant angeben, das Drehmoment je Ampere an der Achse, z. B. --constant 1.2
   *[linear] --constant angeben, die { word-force } je Ampere, z. B. --constant 80
}
verify-other-motion = { $name } [{ $unit }] gehört zu einer anderen Art von Achse; drive.lead (und drive.gear) im Profil angeben oder Werte der Achse aufzeichnen
verify-other-travel = { $name } bewegt sich { NUMBER($ratio, digits: 3) }-mal so weit wie { $reference }; eine der Einheiten stimmt nicht, durch --columns NAME=SPALTE [Einheit] angeben
verify-no-motion = { $name } bewegt sich nicht
verify-no-move = keine Bewegung beginnt im Stillstand; vom Stillstand bis zum Ende der Verweilzeit aufzeichnen

# Die Seite
verify-part-overlay = Gemessen über vorhergesagt
verify-part-sources = Quellen
verify-caption-checks = Jede Zusage
verify-caption-sources = Aufgezeichnete Dateien
verify-head-what = Zusage
verify-head-predicted = Vorhergesagt (Eckfälle)
verify-head-columns = Spalten
verify-plot-caption = { $file }, Bewegung ab { TIME($begin) }
verify-plot-time = Zeit ab Beginn des Sollwerts
verify-plot-tcp = Abweichung des Werkzeugs
verify-plot-encoder = Abweichung des Lagegebers
verify-plot-force = { word-force }
verify-plot-difference = gemessen weniger vorhergesagt
verify-line-low = vorhergesagt, tiefster Eckfall
verify-line-high = vorhergesagt, höchster Eckfall
verify-line-band = Band
verify-line-tool-band = Band des Werkzeugs
verify-line-difference = gemessen weniger nominell

# Parameter, wie sie die Aufzeichnungen zeigen
verify-part-differences = Was anders ist
verify-caption-parameters = Parameter, wie sie die Aufzeichnungen zeigen
verify-caption-feedforwards = Vorsteuerung, wie sie nach dem Schleppfehler sein sollte
verify-parameter-reference-delay = Verzögerung des Sollwertpfads
verify-parameter-feedforward-mass = { $axis ->
    [rotary] vorgesteuertes Trägheitsmoment
   *[linear] vorgesteuerte Masse
}
verify-parameter-jerk-feedforward = Vorsteuerung des Rucks
verify-parameter-friction-feedforward = Vorsteuerung gegen Coulombsche Reibung
verify-two-masses = { $axis ->
    [rotary] Das vorgesteuerte Trägheitsmoment ist in die Steuerung einzutragen ({ word-force } je Beschleunigung); das bewegte Trägheitsmoment ist das der Mechanik und gehört ins Profil, wohin --refine es schreibt.
   *[linear] Die vorgesteuerte Masse ist in die Steuerung einzutragen ({ word-force } je Beschleunigung); die bewegte Masse ist die der Mechanik und gehört ins Profil, wohin --refine sie schreibt.
}
verify-feedforward-brings = { $moves ->
    [0] Mit diesen Werten bliebe der Lagegeber { $after } statt { $before } vom verzögerten Sollwert (Effektivwert; an derselben Bewegung, nur eine ist aufgezeichnet).
   *[other] Mit dem, was die erste Hälfte der Bewegungen sagt, bliebe der Lagegeber in der zweiten { $after } statt { $before } vom verzögerten Sollwert (Effektivwert).
}
verify-caption-limits = Grenzwerte, die daraus folgen
verify-head-old = Ergebnisdatei
verify-head-new = Aufzeichnung
verify-parameter-mass = { $axis ->
    [rotary] bewegtes Trägheitsmoment (samt Zuladung)
   *[linear] bewegte Masse (samt Zuladung)
}
verify-parameter-frequency = Frequenz (ungeregelt)
verify-parameter-damping-ratio = Dämpfungsgrad (ungeregelt)
verify-parameter-is-same = wie bisher, innerhalb zweier Standardfehler
verify-tested = { $moves ->
    [0] Nicht an anderen Bewegungen geprüft (nur eine ist aufgezeichnet): alte und neue Parameter lassen
   *[other] An { $moves } zurückgehaltenen Bewegungen geprüft: alte und neue Parameter lassen
} { SHARE($before) } und { SHARE($after) } (Effektivwert) der Abweichung übrig.
verify-force-left = { $axis ->
    [rotary] Vom Drehmoment
   *[linear] Von der { word-force }
} bleiben { SHARE($share) }.
verify-no-limits = Keine Grenzwerte für das verfeinerte Profil: { $why }
verify-renewed = aus einer aufgezeichneten Bewegung, ± { $error }
verify-renewed-derived = aus Frequenzen und Masse einer aufgezeichneten Bewegung
verify-renewed-head = Verfeinert durch mtcommission verify am { $date }; ± sind zwei Standardfehler.

# On the sheet
measure-verdict = Aufgezeichnete Bewegungen, verify: { $verdict }.
verdict-of-other-form = ist kein Urteil von mtcommission verify
verdict-of-other-record = gehört zu einer anderen Ergebnisdatei; verify mit diesem ausführen
verify-setpoint-from-error = Keine Lage des Sollwerts: Summe aus { $name } und { $error }, als das, was der Regler vergleicht.
verify-plot-acceleration-measured = Beschleunigung des Werkzeugs
