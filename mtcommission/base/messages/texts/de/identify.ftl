# Was in gemessenen Frequenzgängen identifiziert wurde, was gewählt wurde, was zweifelhaft ist.
# Frequenzen in Hz, Zeiten in s, Anteile von 0 bis 1; $file, $mode, $states: Namen des Benutzers

# Bereich und Ordnung
identify-band-given = Angepasst von { FREQUENCY($low) } bis { FREQUENCY($high) }, wie --band verlangt.
identify-band-cut = Von { FREQUENCY($low) } bis { FREQUENCY($high) } wurde nur { FREQUENCY($new_low) } bis { FREQUENCY($new_high) } angepasst: Außerhalb folgen die Linien keiner starren Masse mit Eigenformen (unten Reibung; oben Stromregler, Sensor oder mehr Eigenformen, als ein Modell fasst). --band legt einen anderen Bereich fest.
identify-no-lines-in-band = { $file } hat zwischen { FREQUENCY($low) } und { FREQUENCY($high) } zu wenige Linien und wurde weggelassen.
identify-too-few-in-band = { $lines } brauchbare Linien zwischen { FREQUENCY($low) } und { FREQUENCY($high) }, mindestens { $least } sind nötig; breiter messen oder mit --band einen anderen Bereich angeben
identify-background = Für eine gute Anpassung { $count ->
    [one] war ein breiter Anteil um { FREQUENCY($low) }
   *[other] waren { $count } breite Anteile zwischen { FREQUENCY($low) } und { FREQUENCY($high) }
} nötig: für eine Eigenform zu stark gedämpft und nicht im Profil.
identify-point-left-out = { $file } passt nicht zu den Polen der übrigen Punkte und wurde weggelassen: diesen Punkt noch einmal anschlagen.

# Ein Modell, das die Messung verfehlt; $low, $high [Hz], $missed: ein Anteil
identify-no-profile = Kein Profil: Das Modell beschreibt die Messung nicht: { $shows ->
    [no] weder Masse noch Eigenform zeigt sich,{" "}
   *[yes] {""}
}Abweichung { NUMBER($misfit, digits: 3) } (höchstens { NUMBER($most) }), { SHARE($missed) } des Betrags verfehlt (höchstens { SHARE($far) }).
identify-forced = Erzwungen: Das Modell beschreibt die Messung nicht: { $shows ->
    [no] weder Masse noch Eigenform zeigt sich,{" "}
   *[yes] {""}
}Abweichung { NUMBER($misfit, digits: 3) } (höchstens { NUMBER($most) }), { SHARE($missed) } des Betrags verfehlt (höchstens { SHARE($far) }).
identify-not-described = { $files }: { $axis ->
    [rotary] Eine starre Trägheit
   *[linear] Eine starre Masse
} mit Eigenformen verfehlt die Messlinien, am meisten von { FREQUENCY($low) } bis { FREQUENCY($high) }. { $cause ->
    [response] Unten fällt der Frequenzgang nicht wie der einer freien { $axis ->
        [rotary] Trägheit
       *[linear] Masse
    }: wahrscheinlich der falsche Frequenzgang (geschlossener Regelkreis ab Sollwert, anderes Signal), oder die Achse hat sich nicht bewegt. Die Drehzahlregelstrecke messen, { word-force-before }sollwert zu Istgeschwindigkeit, um eine Offsetgeschwindigkeit.
    [friction] Es liegt am unteren Ende: haftende Reibung oder Rückkopplung in der Messung. Um eine Offsetgeschwindigkeit messen, bei der die Achse nie steht, mit mehr Amplitude und möglichst weichem Lageregler; oder diese Linien mit --band weglassen.
    [modes] Es liegt am oberen Ende: mehr Eigenformen, als das Modell fasst, Stromregler oder Sensor. Diese Linien mit --band weglassen oder bis zu einer niedrigeren Frequenz mit feineren Linien messen.
   *[feedback] Es liegt mitten im Bereich: Rückkopplung in der Messung (die Anregung als v_ref mit aufzeichnen), falsche Einheit oder Spalte, oder die Maschine hat sich währenddessen verändert. Mit möglichst weichem Regler und mehr Amplitude erneut messen, mehrere Maschinenzustände einzeln.
}

# Streuungen
identify-floor = { $states ->
    [one] ein Zustand der Maschine wurde gemessen: andere Positionen, Zuladungen und Pegel sind nicht enthalten, daher mindestens { SHARE($floor) } (eine Annahme)
   *[other] { $states } Zustände stimmen auf { SHARE($floor) } überein, dem Mindesten, was Wiederholungen und Pegel an anderen Maschinen zeigten
}
identify-apart = jeder der { $states } Zustände wird für sich beurteilt, dazu die Mitte, dazwischen aber nichts (mehr Zustände messen, wo die Maschine dazwischen arbeitet); { SHARE($floor) } ist das Mindeste, was Wiederholungen und Pegel an anderen Maschinen zeigten
identify-frequency-range = { $mode } liegt in { $states } Zuständen zwischen { FREQUENCY($low) } und { FREQUENCY($high) }
identify-damping-range = { $mode } hat in { $states } Zuständen { NUMBER($low, digits: 3) } bis { NUMBER($high, digits: 3) }
identify-sigma = die doppelte Standardabweichung von { $mode } ist { SHARE($spread) }
identify-damping-unknown = die Messung zeigt die Dämpfung von { $mode } kaum: { SHARE($spread) } ist angenommen, das Größte, was ein Profil fasst; länger aufzeichnen

# Zweifel und Ratschläge
identify-mode-not-everywhere = { $mode } ist in { $states } nicht zu sehen.
identify-no-mode = Keine Eigenform gefunden: Im Bereich ist die Achse eine starre Masse. Bis zu höheren Frequenzen oder am Werkzeug messen.
identify-no-rigid-body = Im Bereich ist kein starrer Körper zu sehen: Die Masse ist unbekannt, und die Verstärkungen gelten zwischen den gemessenen Punkten, nicht als Anteil an { $axis ->
    [rotary] dem Drehmoment
   *[linear] der { word-force }
} des Antriebs. Mit dem Antrieb { word-force } zu Geschwindigkeit messen.
identify-no-force = Nur die Bewegung wurde aufgezeichnet, nicht was sie antreibt: Frequenzen und Dämpfung sind die eines Werkzeugs an einem gehaltenen Motor, wie drive.kind = "position_source" sie meint (ein Motor, der seinem Sollwert folgt, etwa ein Schrittmotor). Eine Servoachse hat ihre Eigenformen bei freiem Motor, die höher liegen: Für sie den Frequenzgang des Antriebs aufzeichnen (Drehmoment zu Drehzahl).
identify-of-belt = entlang eines Riemens aufgezeichnet (AXIS=1,1 oder 1,-1), was die Riemen einer CoreXY vergleicht, aber keine Achse ist; die Shaper von Klipper wirken auf X und Y des Werkzeugkopfs, auch bei CoreXY: TEST_RESONANCES AXIS=X und AXIS=Y aufzeichnen
identify-several-axes = die Dateinamen nennen mehrere Achsen ({ $axes }): Jede bekommt eigene Dateien (-o NEU.toml schreibt NEU-x.toml und so fort), darum weder --profile noch - angeben; oder nur die Dateien einer Achse nennen
identify-kind-replaced = identify schreibt einen modalen Aufbau: Seine Eigenformen treten an die Stelle von kind = "{ $kind }" und von allem, was in [plant] stand. Das alte Profil aufheben, wenn verglichen werden soll.
identify-core-xy = Die Shaper von Klipper wirken auf X und Y des Werkzeugkopfs, auch bei CoreXY. Dort teilen sich beide Motoren die Beschleunigung von X oder Y, aber auf einer Diagonale trägt ein Motor sie allein: drive.max_acceleration gilt für eine Achse und ist höchstens 1/√2 dessen, was ein Motor allein mitmacht.
identify-klipper-choice = calibrate_shaper (Klipper, Stand 84104bbb, sein Kriterium hier berechnet) würde { $shaper } bei { FREQUENCY($frequency) } wählen, max_accel { NUMBER($acceleration, digits: 4) } mm/s²; das lässt nach seinem Maß { SHARE($vibration) } der gemessenen Leistung übrig. run simuliert es neben der eigenen Wahl.
# $offset, $swing: eine Geschwindigkeit in SI; $shift, $interval, $reversed: Anteile
identify-friction-shifts = { $file }: Die Achse fuhr im Mittel { VELOCITY($offset) }, während die Anregung sie um { VELOCITY($swing) } (effektiv) schwingen ließ; sie lief also { SHARE($reversed) } der Zeit rückwärts, und die Reibung wechselte ihr Vorzeichen. Das kann die Eigenform bei { FREQUENCY($frequency) } um ± { SHARE($shift) } verschieben (Reibung, die als Feder statt als Dämpfer wirkt); ihr Intervall von ± { SHARE($interval) } enthält das nicht. Mit { VELOCITY($wanted) } oder schneller erneut messen, oder mit weniger Anregung.
identify-friction-may-shift = { $file }: Unten zeigt sich Reibung. Falls die Achse zeitweise rückwärts lief (ein Frequenzgang verrät das nicht), kann das die Eigenform bei { FREQUENCY($frequency) } um ± { SHARE($shift) } verschieben; ihr Intervall von ± { SHARE($interval) } enthält das nicht. Um eine Offsetgeschwindigkeit von mindestens dem Dreifachen der Effektivgeschwindigkeit der Anregung messen, oder die Aufzeichnung über der Zeit angeben.
# $bound [1/kg]
identify-no-tool-sensor = Kein Sensor am Werkzeug: tcp_gain ist nicht gemessen. { GAIN($bound) } ist der ungünstigste Fall eines Werkzeugs auf der anderen Seite der Eigenform, oder deren Anteil am Lagegeber, falls er größer ist. Ein Beschleunigungssensor am Werkzeug bei derselben Anregung, DATEI@tcp, ersetzt das; ebenso --tool-ratio, Spitze am Werkzeug durch Spitze am Motor.
identify-gains-stay = Angenommen, weil kein Sensor es zeigte, wie das Profil es angibt: { $gains }. Wer den Wert kennt, nimmt ihn aus machine.assumed.
identify-states-stay = Die Zustände des Profils bleiben, wie sie sind, denn diese Messung zeigt nur einen: { $states }. [[machine_states]], die nicht mehr gelten, herausnehmen.
identify-states-gone = Herausgenommen, weil das Profil diesen Zustand nicht mehr hat: { $keys }. Gewichte gehen gemeinsam: an ihre Stelle treten die ausgeglichenen.
identify-polarity-reversed = { $file }: Das Vorzeichen ist vertauscht (die Masse wurde negativ); es wurde gedreht.
identify-masses-differ = { $file } zeigt { MASS($mass) }, der erste Sensor { MASS($other) }: Eine der Konstanten oder Einheiten stimmt nicht, und damit auch ihre Verstärkungen nicht.
identify-mass-by-state = Die Zustände bewegen { MASS($low) } bis { MASS($high) }; das Profil enthält jeden als Zustand und in [plant] die Mitte. Ist das nur die Zuladung, genügen auch die kleinste als moving_mass und der Unterschied als payload.
# $spacing, $wanted [Hz], $window [s]
identify-lines-too-far-apart = Bei { FREQUENCY($frequency) } liegen die Linien { FREQUENCY($spacing) } auseinander, mehr als 0,8 ζ f = { FREQUENCY($wanted) }: Die Dämpfung wird zu groß. Mit Fenstern von { TIME($window) } oder länger aufzeichnen.
identify-model-error = Messpunkte und Modell weichen über das Rauschen hinaus um { SHARE($share) } des Betrags ab (nichtlineare Reibung, eine Eigenform außerhalb des Bereichs); die Intervalle enthalten das.
identify-noise-from-misfit = { $file } hat keine Kohärenz: Die Größe des Rauschens wurde aus der Abweichung bestimmt. Die Kohärenz mit exportieren.
identify-low-coherence = { $file }: Die Kohärenz liegt bei { SHARE($share) } der Linien unter 0,5. Mehr Mittelungen, stärkere Anregung oder eine Offsetgeschwindigkeit gegen die Reibung verwenden.

# Das Profil
identify-document-head = Identifiziert von mtcommission { $version } am { $date }.
identify-document-file = { $file }, SHA-256 { $hash }
identify-document-file-dated = { $file }, gemessen { $date }, SHA-256 { $hash }
identify-document-sigma = ± steht für zwei Standardabweichungen dieser Messung.
identify-document-open = Noch anzugeben; mtcommission wizard -o { $file } fragt danach:
identify-document-held = Motor folgt seinen Schritten; Eigenformen wie am Beschleunigungssensor
identify-document-printer-max-acceleration = angenommen: was die Resonanzmessung selbst am oberen Ende fährt
identify-document-name = Gemessene Achse
identify-document-states = Zustände der Maschine: die Grenzen müssen in jedem gelten.
identify-document-source = identifiziert aus { $files } am { $date }
identify-document-tool-worst = kein Sensor am Werkzeug: ungünstigster Fall
identify-document-tool-ratio = Anteil am Lagegeber × { NUMBER($ratio) } (--tool-ratio)
identify-document-merged = In ein Profil eingefügt: dessen übrige Zeilen und Kommentare sind, wie sie waren.
identify-document-too-many = Nur die { $most } Eigenformen mit den größten Verstärkungen stehen im Profil; { $left } wurden weggelassen.

# Seite und Terminal
identify-title = Identifizierte Achse
# $files: by name
identify-title-of = Identifizierte Achse: { $files }
identify-verdict = { $modes ->
    [one] Eine Eigenform
   *[other] { $modes } Eigenformen
}
identify-verdict-none = Keine Eigenform
identify-detail = { $states ->
    [one] Ein Zustand der Maschine
   *[other] { $states } Zustände der Maschine
}, { $files ->
    [one] eine Datei
   *[other] { $files } Dateien
}. ± steht für zwei Standardabweichungen der Messung.
identify-page-note = Gemessen; ± steht für zwei Standardabweichungen dieser Messung. Was sich von Tag zu Tag und von Maschine zu Maschine unterscheidet, steht in der Streuung.
identify-part-result = Ergebnis
identify-part-modes = Eigenformen
identify-part-fits = Gemessen und angepasst
identify-part-doubts = Was gewählt und weggelassen wurde, und was besser zu messen ist
identify-part-check = Das Modell gegen die Aufzeichnungen
identify-part-sources = Dateien
identify-part-profile = Profil
identify-mass = Bewegte { $axis ->
    [rotary] Trägheit
   *[linear] Masse
}
identify-delay = Totzeit
identify-band = Bereich
identify-band-from-to = { FREQUENCY($low) } bis { FREQUENCY($high) }
identify-spread-frequency = Streuung der Frequenzen
identify-spread-damping = Streuung der Dämpfung
identify-misfit = Abweichung im Verhältnis zum Rauschen
identify-head-why = Warum
identify-head-file = Datei
identify-head-sensor = Sensor
identify-head-explained = Erklärt
identify-head-held-back = Zurückgehalten
identify-not-known = nicht bekannt
identify-misfit-meaning = gewichteter Effektivwert; 1 ist so gut wie das Rauschen
identify-delay-meaning = { $axis ->
    [rotary] vom Drehmoment
   *[linear] von der { word-force }
} zum Sensor, wie aufgezeichnet
identify-lag = Verzögerung erster Ordnung
identify-lag-meaning = neben der Totzeit: Stromregler oder Filter des Sensors
identify-mass-meaning = aus dem starren Körper am unteren Ende des Bereichs
identify-band-asked = wie --band verlangt
identify-band-meaning = nach Kohärenz und Abweichung
identify-caption-modes = Eigenformen über alle Zustände, ± zwei Standardabweichungen
identify-caption-states = Eigenformen in jedem Zustand
identify-caption-check = Anteil der Signalleistung im Bereich, den das Modell aus { $axis ->
    [rotary] dem aufgezeichneten Drehmoment
   *[linear] der aufgezeichneten { word-force }
} erklärt
identify-plot-caption = { $file }: Messpunkte und angepasste Kurve
identify-plot-frequency = f in Hz
identify-plot-magnitude = |H| in { $unit }, Logarithmus zur Basis 10
identify-plot-phase = Phase in °
identify-plot-coherence = Kohärenz
identify-plot-density = Dichte, Logarithmus zur Basis 10
identify-plot-misfit = Abweichung / Rauschen
identify-line-fitted = angepasst
identify-line-error = ± 2 Standardabweichungen
identify-stage = Identifiziere
identify-next-run = Die Annahmen in { $file } ansehen, dann: mtcommission run { $file }
identify-next-check = Dann: mtcommission check { $file }, danach mtcommission run { $file }
identify-next = Dann: mtcommission wizard -o { $file }, danach mtcommission run { $file }

# Options
identify-profile-there = { $file } gibt es schon, und identify hat es nicht geschrieben; anderen Namen angeben, oder --profile { $file }, um hineinzuschreiben
identify-option-constant = „{ $got }“ angegeben, muss eine Zahl ungleich 0 in N/A oder N m/A sein, z. B. „12.5 N/A“
identify-file-twice = enthält dieselbe Messung wie { $other }, die doppelt zählte; sie einmal angeben
identify-option-number = gegeben "{ $got }", muss eine Zahl ungleich 0 sein
identify-option-band = gegeben "{ $got }", muss UNTEN:OBEN in Hz sein mit 0 < UNTEN < OBEN, z. B. 8:300
identify-option-modes = gegeben "{ $got }", muss auto oder 1 bis { $most } sein

# Der Abschnitt im Inbetriebnahmeblatt
identified-heading = Was gemessen wurde
identified-note = Identifiziert am { $date }. ± steht für zwei Standardabweichungen dieser Messung; was sich von Tag zu Tag und zwischen Positionen und Zuladungen ändert, steckt in der Streuung, die die Eckfälle enthalten.
identified-by-profile = wie im Profil angegeben
identified-assumed = nicht gemessen; angenommen { $value }
identified-changed = { $mode } wurde von Hand geändert: { $what } ist im Profil { $now }, gemessen wurde { $was }.
identified-mass-changed = Die bewegte { $axis ->
    [rotary] Trägheit
   *[linear] Masse
} wurde von Hand geändert: im Profil { $now }, gemessen { $was }.
identified-not-in-profile = { $mode } wurde gemessen, aber keine Eigenform des Profils heißt so: Die Grenzwerte kennen sie nicht, es sei denn, sie wurde umbenannt.
identified-spread-less = { $what }: Die Eckfälle enthalten ± { $now }, die Messung verlangt ± { $was }.
identified-without-evidence = Das Profil nennt keine Datei mit Messpunkten und Ratschlägen: identify -o schreibt eine daneben.
identified-evidence-missing = { $file } mit den Messpunkten und Ratschlägen fehlt neben dem Profil oder ist nicht lesbar: Werte und Intervalle sind die des Profils.
identified-evidence-differs = { $file } ist nicht die Datei, die zu diesem Profil gehört (die Prüfsumme weicht ab): Werte und Intervalle sind die des Profils.
# $now, $least, $freed [s]
identified-tool-frees = Der Anteil von { $modes } am Werkzeug wurde nicht gemessen, sondern angenommen, meist als ungünstigster Fall. Ein Sensor am Werkzeug bei derselben Messung könnte bis zu { TIME($freed) } freimachen: Zeigt er ein Werkzeug, das in diesen Eigenformen stillsteht, so ist die langsamste Bewegung nach { TIME($least) } statt { TIME($now) } eingeschwungen.
identified-tool-frees-nothing = Der Anteil von { $modes } am Werkzeug wurde nicht gemessen, sondern angenommen. Ein Sensor am Werkzeug brächte hier keine Zeit: Selbst mit einem Werkzeug, das in diesen Eigenformen stillsteht, ist die langsamste Bewegung nicht früher eingeschwungen.
identified-tool-decides = Der Anteil von { $modes } am Werkzeug wurde nicht gemessen, sondern angenommen, und die Anforderungen sind damit nicht erfüllt. Mit einem Werkzeug, das in diesen Eigenformen stillsteht, { $met ->
    [yes] wären sie erfüllt: zuerst mit einem Sensor am Werkzeug messen
   *[no] sind sie auch nicht erfüllt
}.
identify-document-measured = Was gemessen wurde, für das Inbetriebnahmeblatt: Wert und Standardabweichung. [plant] ändern, nicht dies.
identified-klipper-caption = Was calibrate_shaper aus denselben Dateien wählen würde (Klipper, Stand 84104bbb, shaper_calibrate.py; sein Kriterium hier berechnet)
identified-klipper-shaper = Shaper
identified-klipper-vibration = Restschwingung
identified-klipper-smoothing = Verrundung bei 5 m/s²
identified-klipper-max-accel = max_accel
identified-klipper-chosen = { $shaper } (empfohlen)
identified-klipper-ours = unsere: { $filter }
identified-klipper-simulated = Seine Empfehlung und unsere, an dieser Achse simuliert: ungünstigster Fall der genannten Bewegungen und Eckfälle; das Urteil gilt für jede Größe, der die Grenzwerte dienen
identify-document-printer = angenommen
