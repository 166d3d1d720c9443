# lists
joined-by-and = { $first } und { $second }

# what the limits end at; $requirements: one or more, joined
bound-by-requirements = { $requirements }
bound-by-nothing-met = kleinste Einschwingzeit; keine Grenzwerte erfüllen alle Anforderungen
bound-by-settling-later = Einschwingzeit (höhere Grenzwerte schwingen später ein)
bound-by-jerk-in-proportion = Ruck im Verhältnis zum Toleranzband (höchstens { JERK($jerk) })
bound-by-less-jerk-meets-nothing = mehr Ruck als mit breiterem Toleranzband: bis { JERK($jerk) } hielt nichts dieses ein
reserve-used = { $axis ->
    [rotary] Reserve aufgebraucht: Mit { SHARE($band) } des Toleranzbands und { SHARE($force) } des Drehmoments erfüllen keine Grenzwerte die Anforderungen; die empfohlenen nutzen deshalb bis zu allem davon. Temperatur, Verschleiß oder eine andere Stellung der Achse können dann eine Anforderung verletzen.
   *[linear] Reserve aufgebraucht: Mit { SHARE($band) } des Toleranzbands und { SHARE($force) } der Kraft erfüllen keine Grenzwerte die Anforderungen; die empfohlenen nutzen deshalb bis zu allem davon. Temperatur, Verschleiß oder eine andere Stellung der Achse können dann eine Anforderung verletzen.
}

# optima; $error: outcome with its remedy
optimum-composed = Die Bewegung fährt lange mit max_velocity; der gezeigte Vergleichswert ist aus zwei zeitoptimalen Geschwindigkeitssprüngen und einer Fahrt ohne Schwingung zusammengesetzt. Nichts ist schneller als { TIME($least, digits: 6) } (bewiesene Schranke, { SHARE($below, digits: 2) } darunter).
optimum-under-bounds-failed = Optimum mit Höchstwerten: { $error }.
optimum-not-exact = Das Optimum mit Höchstwerten ist höchstens { SHARE($slower, digits: 1) } langsamer als die schnellste Steuerung; genaue Bögen wurden nicht gefunden.
damping-optimum-failed = Dämpfungsoptimale Steuerung: { $error }.
damping-optimum-exceeds-velocity = Die dämpfungsoptimale Steuerung erreicht das { PLAIN($times, digits: 4) }-fache von max_velocity: ihr Funktional kennt keine Grenzen für Zustände.
static-load-of-force = static_load { SI($load, "FORCE", digits: 6) } von max_force { SI($force, "FORCE", digits: 6) }
final-time-below-least = t_f = { PLAIN($final, digits: 9, unit: "ms") } ms, aber t_f,min = { PLAIN($least, digits: 9, unit: "ms") } ms

# limits condensed from an optimum
closest-to-time-optimal = nächst der zeitoptimalen Steuerung
closest-to-constrained = nächst der beschränkten Steuerung
closest-to-damping-optimal = nächst der dämpfungsoptimalen Steuerung
with-move-number = { $name }, Bewegung { $number }

# rules of thumb; $mode: the user's name, $frequency in Hz
rule-of-thumb-no-jerk-limit = a = F_max/m, ohne Ruckgrenze
rule-of-thumb-periods = { $periods ->
    [1] j = a f ({ $mode }, { NUMBER($frequency, digits: 3) } Hz)
   *[other] j = a f / { $periods } ({ $mode }, { NUMBER($frequency, digits: 3) } Hz)
}
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
source-commissioning-rule = dieses Projekt, von Hand; Herleitung und Prüfung in docs/commissioning-rule.md
rule-description = Eine Regel für die Anwendung von Hand: jeder Rucksprung hinterlässt in jeder Eigenform eine Schwingung und im Regelkreis einen Nachlauf, beide proportional zum Ruck; Rampen von ganzen Perioden löschen die Schwingung. Von den versuchten Rampen gilt die mit der kürzesten Bewegung.
rule-advice = Zu versuchen: t_j = 1, 2, 3 Perioden jeder Eigenform und das t_j, das keine Auslöschung braucht (R = 2); die kürzeste Bewegung gilt.
rule-validity = Starre Achse mit Verzögerung und schwach gedämpften Eigenformen (15 bis 200 Hz, Dämpfung 0,5 bis 10 %), Kaskade mit voller Geschwindigkeitsvorsteuerung und selbst bestimmter Sollwertverzögerung, Streuung bis 10 %, Zuladung bis 30 % { $axis ->
    [rotary] des bewegten Trägheitsmoments
   *[linear] der bewegten Masse
}, Band 2 bis 50 µm; kein Sollwertfilter, keine Grenzen für Höchstwerte oder { $axis ->
    [rotary] Effektivmoment
   *[linear] Effektivkraft
}. Das Band wird bei den meisten Maschinen eingehalten, nicht bei allen: vor Gebrauch simulieren.
rule-no-cancelling = ohne Auslöschung
rule-periods = { $count ->
    [1] 1 Periode von { $mode }
   *[other] { $count } Perioden von { $mode }
}
rule-force = { $axis ->
    [rotary] Drehmoment
   *[linear] Kraft
}
rule-reach = { $axis ->
    [rotary] Winkel oder Geschwindigkeit
   *[linear] Weg oder Geschwindigkeit
}
rule-band = Band
rule-bound-by = begrenzt durch: { $what }
rule-for-velocity-step = beim Geschwindigkeitssprung
rule-for-positioning = beim Positionieren
rule-within-the-spread = innerhalb der Streuung
rule-speed-loop = Geschwindigkeitsregelkreis ω_v
rule-servo-sensitivity = Ruckempfindlichkeit des Regelkreises C_S
rule-unknown-mass = { $axis ->
    [rotary] unbekannter Anteil des Trägheitsmoments ε
   *[linear] unbekannter Anteil der Masse ε
}
rule-payload-sensitivity = Ruckempfindlichkeit durch die Zuladung C_P
rule-mode-sensitivity = Ruckempfindlichkeit C der Eigenform { $mode }
rule-mode-spread = Streuung der Eigenform { $mode } über die angegebene hinaus
rule-mode-vibration = Schwingung V der Eigenform { $mode }
rule-vibration-formula = R(f t_j) × Echo der Rampen davor
rule-jerk-time = Ruckzeit t_j
rule-force-acceleration = { $axis ->
    [rotary] Beschleunigung innerhalb des Drehmoments
   *[linear] Beschleunigung innerhalb der Kraft
}
rule-see-formula = siehe Formel
rule-acceleration = Beschleunigung a
rule-jerk = Ruck j
rule-residual = vorhergesagte Restabweichung
rule-needs-velocity-feedforward = velocity_feedforward ist nicht 1: den Schleppfehler kennt die Regel nicht
rule-needs-automatic-delay = reference_delay ist vorgegeben: die Regel rechnet mit der selbst bestimmten
rule-knows-no-setpoint-filter = ein Sollwertfilter ist an: die Regel zählt seine Glättung nicht mit
rule-knows-no-peaks = { $axis ->
    [rotary] Grenzen für Höchstwerte oder Effektivmoment kennt die Regel nicht
   *[linear] Grenzen für Höchstwerte oder Effektivkraft kennt die Regel nicht
}
