record-not-readable = keine Ergebnisdatei von mtcommission run: { $why }
record-without-profile = eine Ergebnisdatei enthält den Text des Profils, und diese Maschine wurde aus keiner Datei gerechnet; die Datei des Profils rechnen
record-steers = enthält Zeichen, die ein Terminal steuern und die kein Lauf schreibt; das Profil neu rechnen
record-not-json = keine Ergebnisdatei von mtcommission run: der Inhalt ist kein JSON; das record.json angeben, das mtcommission run schreibt
record-is-directory = ist ein Ordner; das record.json darin angeben
record-lacks-keys = keine Ergebnisdatei von mtcommission run: { $keys } fehlt
record-of-other-schema = Ergebnisdatei nach Schema { $given }, diese Version liest { $read }; das Profil erneut rechnen oder mit der Version drucken, die es schrieb
record-edited = sein Inhalt ist nicht der, den mtcommission run schrieb: es wurde geändert oder beschädigt; stattdessen das Profil ändern und erneut rechnen
record-of-other-version = eine andere Version von mtcommission hat es geschrieben; das Profil erneut rechnen oder jene Version verwenden
record-both = { $first }; { $then }
json-no-number = { $constant } ist keine Zahl in JSON
json-array = eine Liste
json-boolean = true oder false
json-whole-number = eine ganze Zahl

assumed-illustrative = die Beispielwerte des Profils
assumption-illustrative = Die Maschinendaten sind Beispielwerte, nicht die einer wirklichen Maschine.
assumption-linear = { $axis ->
    [rotary] Die Achse gilt als lineares System: starrer Körper, ein Momentenregelkreis als Verzögerung erster Ordnung und entkoppelte Eigenformen. Reibung, Umkehrspiel, Rastmomente und Momente der Energieführung bleiben außer Betracht.
   *[linear] Die Achse ist linear: eine starre Masse, ein { word-force-before }regelkreis als Verzögerung erster Ordnung und entkoppelte Eigenformen. Reibung, Umkehrspiel, Rastkräfte und Kräfte der Energieführung bleiben außer Betracht.
}
assumption-encoder = Die Geschwindigkeit ist die Differenz der Geberlage über einen Takt des Geschwindigkeitsreglers, wie Antriebe sie bilden; abgesehen von einer angegebenen Auflösung misst der Lagegeber fehlerfrei.
assumption-cycles = Lageregler und Vorsteuerung wirken einen Lagereglertakt verspätet und werden einen Takt lang gehalten; { $axis ->
    [rotary] das Drehmoment
   *[linear] die { word-force }
} wirkt einen Takt des Geschwindigkeitsreglers verspätet.
assumption-static-load = Die statische Last mindert { $axis ->
    [rotary] das Drehmoment
   *[linear] die { word-force }
} für die Bewegung um ihren Betrag; ihre Verformung ist konstant, und der Integralanteil des Geschwindigkeitsreglers nimmt sie auf.

source-default = Vorgabewert
source-stated = im Profil angegeben
source-illustrative = Beispielwert
source-accepted-default = Vorgabe übernommen, nicht gemessen
source-measured = gemessen, { $date }

path-position-setpoint = Lagesollwert
path-position-controller = Lageregler
path-wanted-state = Sollzustand
path-velocity-controller = Geschwindigkeitsregler

# Friction
assumption-linear-with-friction = { $axis ->
    [rotary] Die Suche nach den Grenzwerten ist linear: starrer Körper, ein Momentenregelkreis als Verzögerung erster Ordnung und entkoppelte Eigenformen; die Coulombsche Reibung ist von dem Drehmoment abgezogen, das übrig bleibt. Die empfohlenen Grenzwerte wurden mit der angegebenen Reibung noch einmal simuliert. Umkehrspiel, Rastmomente und Momente der Energieführung bleiben außer Betracht.
   *[linear] Die Suche nach den Grenzwerten ist linear: eine starre Masse, ein { word-force-before }regelkreis als Verzögerung erster Ordnung und entkoppelte Eigenformen; die Coulombsche Reibung ist von der { word-force } abgezogen, die übrig bleibt. Die empfohlenen Grenzwerte wurden mit der angegebenen Reibung noch einmal simuliert. Umkehrspiel, Rastkräfte und Kräfte der Energieführung bleiben außer Betracht.
}
friction-kept = Bewegung { $move } mit Coulombscher Reibung { FORCE($coulomb) } und viskoser Reibung { DAMPING($viscous) }: Einschwingzeit { TIME($settling) } (ohne: { TIME($without) }), Restabweichung { LENGTH($residual) }, { $axis ->
    [rotary] größtes Sollmoment
   *[linear] größte Soll{ word-force-behind }
} { FORCE($force) }; was geprüft wurde, ist eingehalten (ungünstigster Eckfall).
friction-broken = Bewegung { $move } mit Coulombscher Reibung { FORCE($coulomb) } und viskoser Reibung { DAMPING($viscous) }: Einschwingzeit { TIME($settling) } (ohne: { TIME($without) }), Restabweichung { LENGTH($residual) }, { $axis ->
    [rotary] größtes Sollmoment
   *[linear] größte Soll{ word-force-behind }
} { FORCE($force) }; das verletzt Band, Einschwingzeit oder { word-force } (ungünstigster Eckfall). Einschwingzeit – heißt: eine Sekunde nach dem Sollwert nicht eingeschwungen. Integralanteil erhöhen, Reibkompensation der Steuerung einschalten oder ein weiteres Band fordern.
