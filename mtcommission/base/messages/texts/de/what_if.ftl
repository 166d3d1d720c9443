# Die interaktive Seite. Was in Klammern steht, setzt das Skript ein.

cli-page-written = geschrieben: { $file }; im Browser öffnen und andere Werte probieren
what-if-heading = Was wäre, wenn: andere Werte probieren
what-if-intro = Schieben oder eintippen: Die Seite rechnet den abgetasteten Regelkreis dieses Blatts neu, in jedem Eckfall, wie der Befehl simulate. { $today ->
    [yes] Die heutigen Werte und die Empfehlung stehen
   *[no] Die Empfehlung steht
} für dieselbe Bewegung daneben.
what-if-no-script = Werte zu probieren braucht JavaScript. Ohne hilft der Befehl simulate.
what-if-slider = Schieber
# $number: of the move; $size: with its unit
what-if-load = Laden
what-if-values = Werte nebeneinander
what-if-tried = Probiert
what-if-take = Diese nehmen
what-if-taken = Kopiert.
what-if-command = Befehlszeile, die die probierten Werte simuliert, und die Zeilen für die Steuerung
what-if-response = Probiert: blau, die Eckfälle dünn; empfohlen: grün{ $today ->
    [yes] ; heute: orange
   *[no] {""}
}. Ab der senkrechten Linie zählt das Band für das Probierte; was 12 Bänder übersteigt, ist abgeschnitten.
what-if-sizes-caption = Restabweichung über der Größe der Bewegung
what-if-sizes = Schlechteste aller Maschinen, mit den probierten Werten. Tippen oder ziehen, um eine Größe zu probieren.
what-if-landscape-caption = Einschwingzeit über Beschleunigung und Ruckzeit
what-if-landscape = Kräftig getönt: langsam; schraffiert: eine Anforderung ist nicht erfüllt. Ein Feld beurteilt nur die gewählte Bewegung in der gewählten Größe, an der ungünstigsten Maschine; andere Bewegungen und Größen werden nur mit den probierten Werten beurteilt. Tippen oder ziehen, um Werte zu probieren. { $today ->
    [yes] Ringe: empfohlen (grün), heute (orange).
   *[no] Ring: empfohlen (grün).
}
what-if-bode-caption = Offener Kreis mit Bandsperre
what-if-bode = Im { word-force-before }sollwert aufgetrennt; jetzt: grün, mit der Bandsperre: blau. Punkt ziehen für Frequenz und Tiefe.
what-if-margins = Reserven mit der Bandsperre
what-if-margins-now = Jetzt, nominal
what-if-margins-tried = Probiert, nominal
what-if-margins-worst = Jetzt, ungünstigster Eckfall
what-if-margins-worst-tried = Probiert, ungünstigster Eckfall
what-if-notch-note = Die Bandsperre tritt an die Stelle der ersten im Kreis, wenn er eine hat. Sie ändert hier die Reserven, nicht die Antwort oben: Dafür die Zeile in [control] des Profils schreiben und neu rechnen.
what-if-no-notch = Keine Bandsperre: Tiefe 0 dB.
what-if-unstable = instabil
what-if-field-size = Größe der Bewegung
what-if-field-error = Frequenzfehler
what-if-field-notch-frequency = Frequenz der Bandsperre
what-if-field-notch-width = Breite der Bandsperre (Dämpfung des Nenners)
what-if-field-notch-depth = Tiefe der Bandsperre
what-if-duration = Dauer des Sollwerts
what-if-ramp = Die Ruckzeit ist kürzer als der Lagetakt, in dem eine Steuerung ihren Sollwert sendet: gerechnet mit einer Rampe von { $value }, wie beim Befehl simulate.
what-if-frequencies = Frequenzen × { $factor }
what-if-damping = Dämpfung × { $factor }
what-if-all-corners = (schlechteste von allen { $count } Maschinen)
what-if-worst-so-far = (bisher die schlechtesten { $count } von { $all } Maschinen)
what-if-all-met = Alle Anforderungen von dieser Bewegung auf allen { $count } Maschinen erfüllt.
what-if-missed-check = { $name }: { $value }, erlaubt { $limit }
what-if-saturated = Das verlangt mehr { word-force }, als da ist; der Befehl simulate zeigt die begrenzte Bewegung.
what-if-tried-machine = Die Maschine mit { $place } wird zusätzlich betrachtet; ihre Restabweichung ist { $value }.
what-if-sizes-met = Anforderungen bei allen { $count } betrachteten Größen der Bewegung gehalten (ab 1 %; der Befehl simulate begrenzt auch die dazwischen).
what-if-sizes-missed = Bei { $missed } von { $count } Größen der Bewegung wird eine Anforderung verfehlt; am schlechtesten { $size } mit { $value }.
what-if-landscape-range = Einschwingzeiten von { $least } bis { $most }.
what-if-landscape-none = Keine Werte dieser Karte erfüllen alle Anforderungen.
what-if-landscape-running = Die Karte wird berechnet …
what-if-out-of-range = { $name }: eine Zahl von { $low } bis { $high }; gerechnet wird mit { $value }
