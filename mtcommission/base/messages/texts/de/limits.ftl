# lists
joined-by-and = { $first } und { $second }

# what the limits end at; $requirements: one or more, joined
bound-by-requirements = { $requirements }
bound-by-nothing-met = kleinste Einschwingzeit; keine Grenzwerte erfüllen alle Anforderungen
bound-by-motor = keine Anforderung; mehr als die eigene Beschleunigung des Motors abzüglich der Reserve, { ACCELERATION($acceleration) }, wird nicht gesucht
bound-by-ceiling = eine praktische Obergrenze für Drucker, { ACCELERATION($acceleration) } (angenommen)
bound-in-state = { $what } (Zustand { $state })
bound-by-settling-later = Einschwingzeit (höhere Grenzwerte schwingen später ein)
ceiling-source = { $kind ->
    [marlin] Für Marlin gibt es keine solche Liste; es ist die größte in den Beispielkonfigurationen von Klipper (die meisten haben 3 m/s²).
   *[other] Keine Beispielkonfiguration von Klipper hat mehr (die meisten 3 m/s²).
}
acceleration-ceiling = Die Beschleunigung endet an einer praktischen Obergrenze, angenommen: { ACCELERATION($ceiling) }; was Extruder, Rahmen und Motortreiber vertragen, enthält das Modell nicht. { $why } Mehr nur eingeben, wenn die eigenen es erwiesenermaßen vertragen; vertragen sie weniger, das als drive.max_acceleration angeben.
reserve-used = { $axis ->
    [rotary] Reserve aufgebraucht: Mit { SHARE($band) } des Bandes und { SHARE($force) } des Drehmoments erfüllen keine Grenzwerte die Anforderungen; die empfohlenen nutzen deshalb bis zu allem davon. Temperatur, Verschleiß oder eine andere Stellung der Achse können dann eine Anforderung verletzen.
   *[linear] Reserve aufgebraucht: Mit { SHARE($band) } des Bandes und { SHARE($force) } der { word-force } erfüllen keine Grenzwerte die Anforderungen; die empfohlenen nutzen deshalb bis zu allem davon. Temperatur, Verschleiß oder eine andere Stellung der Achse können dann eine Anforderung verletzen.
}

# optima; $error: outcome with its remedy
reference-not-exact = Die zeitoptimale Steuerung wurde nicht exakt gefunden; der gezeigte Vergleichswert ist eine auf Zellen. Nichts ist schneller als { TIME($least, digits: 6) } (bewiesene Schranke, { SHARE($below, digits: 2) } darunter).
optimum-under-bounds-failed = Optimum mit Höchstwerten: { $error }.
optimum-not-exact = Das Optimum mit Höchstwerten ist höchstens { SHARE($slower, digits: 1) } langsamer als die schnellste Steuerung; genaue Bögen wurden nicht gefunden.
damping-optimum-failed = Dämpfungsoptimale Steuerung: { $error }.
band-saves-nothing = Optimum mit dem Band statt exakter Ruhe: nicht berechnet, denn es spart höchstens { SHARE($share, digits: 2) } der Zeit: selbst eine starre Achse braucht { TIME($rigid, digits: 6) }.
band-wider-than-move = Optimum mit dem Band statt exakter Ruhe: keines, denn das Band, { LENGTH($band, digits: 3) }, ist nicht kleiner als die Bewegung, { LENGTH($distance, digits: 3) }: Stillstand hält es ein.
band-optimum-failed = Optimum mit dem Band statt exakter Ruhe: { $error }.
robust-force-failed = { word-force-before }verlauf für die ganze Streuung: { $error }.
damping-optimum-exceeds-velocity = Die dämpfungsoptimale Steuerung erreicht das { PLAIN($times, digits: 4) }-fache von max_velocity: ihr Funktional kennt keine Grenzen für Zustände.
static-load-of-force = static_load { FORCE($load, digits: 6) } von { word-max-force } { FORCE($force, digits: 6) }
final-time-below-least = t_f = { PLAIN($final, digits: 9, unit: "ms") } ms, aber t_f,min = { PLAIN($least, digits: 9, unit: "ms") } ms

# limits condensed from an optimum
closest-to-time-optimal = nächst der zeitoptimalen Steuerung
closest-to-constrained = nächst der beschränkten Steuerung
closest-to-damping-optimal = nächst der dämpfungsoptimalen Steuerung
with-move-number = { $name }, Bewegung { $number }

# rules of thumb; $mode: the user's name, $frequency in Hz
rule-of-thumb-no-jerk-limit = a = { $axis ->
    [open-loop] a_max
   *[other] F_max/m
}, ohne Ruckgrenze
rule-of-thumb-period = j = a f ({ $mode }, { NUMBER($frequency, digits: 3) } Hz)
rule-of-thumb-stiffness = a = e ω², j = a f
rule-of-thumb-ten = j = 10 a
rule-of-thumb-hundred = j = 100 a
rule-of-thumb-velocity = j = a²/v_max
source-naive = naheliegend
source-zero-vibration = keine Restschwingung einer ungedämpften Eigenform (Biagiotti & Melchiorri)
source-static-deflection = statische Verformung innerhalb des Bands (Lehrbuch)
source-grblhal = grblHAL; unteres Ende bei LinuxCNC
source-linuxcnc = oberes Ende bei LinuxCNC
source-heidenhain = HEIDENHAIN, MANUALplus 620: kleinster axPathJerk

# the commissioning rule
commissioning-rule = Inbetriebnahmeregel
commissioning-rule-with = Inbetriebnahmeregel ({ $chosen })
source-commissioning-rule = dieses Projekt, von Hand; Herleitung und Prüfung in docs/commissioning-rule.md
rule-description = In einem Satz: über eine Periode der weichsten Eigenform mitteln, den Ruck aus dem Band nehmen und die Beschleunigung aus { $axis ->
    [rotary] dem Drehmoment
   *[linear] der { word-force }
}. Warum: jeder Rucksprung hinterlässt in jeder Eigenform eine Schwingung und im Regelkreis einen Nachlauf, beide proportional zum Ruck; unter Bewegungen aller Größen gibt es eine, bei der sich alle Sprünge addieren, auf Auslöschung durch Rampen ist also kein Verlass. Ein gleitender Mittelwert fester Länge wirkt bei jeder Größe.
rule-advice = Einmal ohne Mittelwert rechnen (W = 1) und einmal mit einem, der so lang ist wie eine Periode der Eigenform mit dem größten C, in der Mitte der Frequenzen, die sie haben kann; es gilt, was sich eher bewegt hat: v/a + a/j + T_F. Die Grenzwerte gelten dann auch für jede kleinere Bewegung.
rule-validity = Starre Achse mit Verzögerung und schwach gedämpften Eigenformen (15 bis 200 Hz, Dämpfung 0,5 bis 10 %), Kaskade mit voller Geschwindigkeitsvorsteuerung und selbst bestimmter Sollwertverzögerung, Streuung bis 10 %, Zuladung bis 30 % { $axis ->
    [rotary] des bewegten Trägheitsmoments
   *[linear] der bewegten Masse
}, Band 2 bis 50 µm; kein Sollwertfilter außer einem gleitenden Mittelwert, keine Grenzen für Höchstwerte, Kontur oder Effektiv{ word-force-behind }. Das Band wird bei den meisten Maschinen eingehalten, nicht bei allen: vor Gebrauch simulieren.
rule-no-average = ohne Mittelwert
rule-average = gleitender Mittelwert, { TIME($time) }
rule-force = { word-force }
rule-reach = { $axis ->
    [rotary] Winkel oder Geschwindigkeit
   *[linear] Weg oder Geschwindigkeit
}
rule-bound-by = begrenzt durch: { $what }
rule-for-positioning = beim Positionieren
rule-within-the-spread = innerhalb der Streuung
rule-ramps = Zahl der Rampen n
rule-by-moves = 2 beim Geschwindigkeitssprung, 4 beim Positionieren
rule-average-length = Länge T_F des gleitenden Mittelwerts
rule-mode-lowest = tiefste Frequenz der Eigenform { $mode }
rule-mode-passed = Anteil W der Eigenform { $mode } hinter dem Mittelwert
rule-allowed-jerk = Ruck, den das Band erlaubt
rule-speed-loop = Geschwindigkeitsregelkreis ω_v
rule-servo-sensitivity = Ruckempfindlichkeit des Regelkreises C_S
rule-unknown-mass = { $axis ->
    [rotary] unbekannter Anteil des Trägheitsmoments ε
   *[linear] unbekannter Anteil der Masse ε
}
rule-payload-sensitivity = Ruckempfindlichkeit durch die Zuladung C_P
rule-mode-sensitivity = Ruckempfindlichkeit C der Eigenform { $mode }
rule-jerk-time = Ruckzeit t_j
rule-force-acceleration = { $axis ->
    [rotary] Beschleunigung innerhalb des Drehmoments
   *[linear] Beschleunigung innerhalb der { word-force }
}
rule-see-formula = siehe Formel
rule-acceleration = Beschleunigung a
rule-jerk = Ruck j
rule-residual = vorhergesagte Restabweichung
rule-needs-velocity-feedforward = velocity_feedforward ist nicht 1: den Schleppfehler kennt die Regel nicht
rule-needs-automatic-delay = reference_delay ist vorgegeben: die Regel rechnet mit der selbst bestimmten
rule-needs-jerk-limit = die Steuerung hat keine Ruckgrenze: die Regel rechnet mit einer
rule-knows-averages-only = ein anderer Sollwertfilter als ein gleitender Mittelwert ist an: die Regel zählt seine Länge mit, seine Glättung nicht
rule-careful-with-seen-mode = der Lagegeber sieht mehr von der Eigenform { $mode } als erprobt (m c = { NUMBER($share, digits: 3) }, erprobt bis 1): die Regel kann weit langsamer sein als nötig
rule-knows-no-peaks = Grenzen für Höchstwerte, Kontur oder Effektiv{ word-force-behind } kennt die Regel nicht
