validate-title = Die Zahlen der Veröffentlichung neben unseren
validate-disclaimer = Berechnet, nicht gemessen.
validate-explained = Nichts bleibt unerklärt
validate-unexplained = Einige Zeilen liegen außerhalb der Toleranz
validate-remark = { $source }. Jede Zahl und Aussage der Veröffentlichung steht wie gedruckt, auf Englisch. Bei einem Druckfehler wird die Berichtigung angegeben und beurteilt; wo eine Aussage nicht gilt, sagt die Zeile, was sie widerlegt.
validate-count = { $count } Zeilen: { $agrees } stimmen überein, { $corrected } mit Berichtigung, { $differs } weichen begründet ab, { $out } außerhalb der Toleranz.
validate-all-rows = Die übrigen Zeilen stimmen wie gedruckt: --all zeigt sie hier, -o DIR auf einer Seite.
validate-tested-by = Toleranz oder Prüfung von { $names }: { $basis }.
validate-part-figures = Bild 4 und 5 noch einmal
validate-head-printed = Gedruckt
validate-head-correct = Richtig
validate-head-ours = Unser Wert
validate-head-tolerance = Toleranz
validate-head-place = Stelle
validate-is-agrees = stimmt
validate-is-corrected = stimmt mit Berichtigung
validate-is-differs = weicht begründet ab
validate-is-out = AUSSERHALB DER TOLERANZ
validate-told = { $what ->
    [paper] gedruckt
    [correct] richtig
   *[ours] unser Ergebnis
}: { $value }
validate-part-plant = Strecke (Abschn. 2)
validate-part-feedback = Regelung (Abschn. 3)
validate-part-time = Zeitoptimale Steuerung (Abschn. 5.1)
validate-part-structure = Struktur der Steuerung (Abschn. 5)
validate-part-bound = Schranke der Drehgeschwindigkeit des Turms (Abschn. 5.2)
validate-part-damping = Dämpfungsoptimale Steuerung (Abschn. 6)
validate-part-vibration = Schwingung (Abschn. 4 bis 6)
validate-part-conclusion = Schluss (Abschn. 7)
validate-stage-loops = Regelkreise
validate-stage-switches = Umschaltungen über der Kraft
