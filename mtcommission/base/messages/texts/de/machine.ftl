remark = { $of }: { $what }
mode-named = Eigenform { $mode }
mode-rings-long = { ROUND($frequency, digits: 3) } Hz mit einem Dämpfungsgrad von { ROUND($damping_ratio, digits: 3) } klingt { ROUND($time, digits: 3) } s nach, bis 1 % übrig ist
mode-rings-for-ever = { ROUND($frequency, digits: 3) } Hz mit einem Dämpfungsgrad von { ROUND($damping_ratio, digits: 3) } klingt nie ab
cycle-shorter-than-drives-have = { ROUND($cycle, digits: 3, unit: "us") } us ist kürzer, als Antriebe es können, 31.25 us bis 1 ms
mode-damping-unusual = Dämpfungsgrad { ROUND($damping_ratio, digits: 3) } ist nicht der von Maschinengestellen, { ROUND($low) } bis { ROUND($high) }
mode-slow = { ROUND($frequency, digits: 3) } Hz ist langsamer als jedes Maschinengestell; Steifigkeit und { word-mass } prüfen
mode-above-velocity-sampling = { ROUND($frequency, digits: 3) } Hz liegt über einem Drittel der Abtastrate des Geschwindigkeitsreglers, { ROUND($rate) } Hz; keine Rückführung kann sie dämpfen
mode-above-position-sampling = { ROUND($frequency, digits: 3) } Hz liegt über einem Drittel der Abtastrate des Lagereglers, { ROUND($rate) } Hz; Sollwerte in diesem Takt können sie nicht formen
mode-of-few-position-cycles = eine Periode hat nur { ROUND($cycles, digits: 2) } Lagereglertakte von { ROUND($cycle, digits: 3, unit: "ms") } ms; so grob ist die Ruckzeit einstellbar
measured-not-described = Abweichung { ROUND($misfit, digits: 3) }, höchstens { ROUND($most) }: Das Modell beschreibt die Messung nicht; Masse, Eigenformen und Intervalle dieses Profils können falsch sein; erneut messen (siehe seine erste Zeile)
mode-unseen = weder Werkzeug noch Lagegeber sehen sie; sie kostet im Optimum umsonst Zeit
mode-gain-large = ihre Verstärkung ist das { ROUND($ratio, digits: 3) }-Fache von 1/moving_mass; die Einheit der Verstärkungen prüfen
mode-bends-far = { $axis ->
    [rotary] das volle Drehmoment
   *[linear] die volle { word-force }
} verformt das Werkzeug um { LENGTH($deflection, digits: 3) }, das { ROUND($ratio, digits: 3) }-Fache von tcp_deviation = { LENGTH($band, digits: 3) }; Steifigkeit und Band prüfen
acceleration-unusual = { FORCE($force) }{ $axis ->
    [open-loop] { "" }
   *[other] { " " }an { MASS($mass) }
} ergeben { ACCELERATION($acceleration, digits: 3) }, was Maschinenachsen nicht tun; beide Einheiten prüfen
static-load-large = { FORCE($load) } brauchen mehr als die Hälfte von { word-max-force } = { FORCE($max_force) }; einen Gewichtsausgleich erwägen
continuous-force-above-max = { FORCE($force) } liegt über { word-max-force } = { FORCE($max_force) } und begrenzt nichts; sind beide vertauscht?
force-lag-long = { ROUND($lag, digits: 3, unit: "ms") } ms ist lang für einen { word-force-before }regelkreis (Servoantriebe: 0,5 bis 5 ms)
move-lasts-long = eine starre Achse brauchte { ROUND($time, digits: 3) } s für diese Bewegung; { $axis ->
    [rotary] Winkel, Geschwindigkeit und Drehmoment
   *[linear] Weg, Geschwindigkeit und { word-force }
} prüfen
move-fast = { VELOCITY($velocity) } ist schneller, als Maschinenachsen fahren, { VELOCITY($fastest) }; die Einheit prüfen
band-unusual = { LENGTH($band, digits: 3) } ist keine übliche Genauigkeit; die Einheit prüfen
payload-large = die Zuladung, { MASS($payload) }, ist mehr als das Dreifache { $axis ->
    [rotary] des bewegten Trägheitsmoments
   *[linear] der bewegten Masse
}, { MASS($mass) }; ein Satz Grenzwerte ist für die leere Achse langsam
bands-not-widening = die Bänder der Bearbeitungsarten, surface { ROUND($surface, digits: 3) }, accuracy { ROUND($accuracy, digits: 3) } und speed { SI($speed, "LENGTH", digits: 3) }, werden in dieser Folge nicht weiter; sind sie vertauscht?
feedforward-mass-far = { MASS($mass) } in der Vorsteuerung liegt weit { $axis ->
    [rotary] vom bewegten Trägheitsmoment
   *[linear] von der bewegten Masse
}, { ROUND($low) } bis { SI($high, "MASS") }; die Vorsteuerung schiebt zu wenig oder zu viel
position-gain-without-unit = Kv = { ROUND($gain) } 1/s ist nur { ROUND($in_custom, digits: 3) } (m/min)/mm; wenn { ROUND($gain) } (m/min)/mm gemeint ist, die Einheit dazuschreiben: "{ ROUND($gain) } (m/min)/mm"
bandwidth-above-sampling = eine Mindestbandbreite von { ROUND($bandwidth) } Hz liegt über einem Drittel der Abtastrate des Geschwindigkeitsreglers, { ROUND($rate) } Hz

feature-counted = { $count } { $feature }
feature-unread = { $feature } (?)
kind-has-all = hat { $has }
kind-has = hat { $has }; ohne { $lacks }
assumed-acceleration-at = { ACCELERATION($acceleration) } bei jeder Geschwindigkeit: so viel lässt die Kennlinie bis { VELOCITY($velocity) }
neglected-steps = ungeregelte Schritte (statt des Motors eine steife Lageregelung)
neglected-force-over-speed = { $axis ->
    [rotary] mit der Drehzahl fallendes Drehmoment ({ word-max-force } gilt für die höchste)
   *[linear] mit der Geschwindigkeit fallende { word-force } ({ word-max-force } gilt für die höchste)
}
neglected-heat = Erwärmung des Motors (Dauer{ word-force-behind } angeben)
neglected-friction = Reibung und Umkehrspiel (eigene Fehler im Stillstand)
neglected-encoder = Geberstufen (Auflösung des Lagegebers angeben)
neglected-travel = Eigenformen über den Verfahrweg (Streuung der Frequenzen weiten)

# Motor folgt dem Sollwert
motor-follows-assumed = der Motor folgt dem Sollwert genau: kein Schritt geht verloren, und die Struktur zieht ihn nicht zurück
drive-kind-steps = diese Steuerung gibt ungeregelte Schritte aus; folgt der Motor ihnen einfach, drive.kind = "position_source" angeben, mit den Frequenzen der Eigenformen bei festgehaltenem Motor: sie sind andere als die der freien Achse
neglected-lost-steps = verlorene Schritte, und dass der Motor der Last nachgibt
neglected-acceleration-over-speed = mit der Drehzahl fallendes Drehmoment (Beschleunigung über der Geschwindigkeit angeben)
