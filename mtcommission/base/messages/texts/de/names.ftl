# Names of states, outputs and keys of the profile.

name = { $key }
name-F-set = Soll{ word-force-behind } { word-f-set }
name-F = { word-force } F
name-tcp = Werkzeugbezugspunkt (TCP)
name-tcp-vibration = Elastische Auslenkung am Werkzeug
name-x-b = Gestelllage x_b
name-x-s = Schlittenlage x_s
name-phi = Drehung des Aufbaus φ
name-v-b = Gestellgeschwindigkeit v_b
name-v-s = Schlittengeschwindigkeit v_s
name-v-phi = Drehgeschwindigkeit des Aufbaus v_φ
name-x = Lage x
name-v = Geschwindigkeit v
name-t-f-lower-bound = Bewiesene untere Schranke von t_f
name-relative-gap = Relativer Abstand zur unteren Schranke
name-switching-law-holds = Schaltgesetz überall erfüllt
name-law-residual = Größte Abweichung vom Steuergesetz, bezogen auf { word-f-max }
name-tcp-deviation = Zulässige TCP-Abweichung (Band)
name-tcp-gain = Verstärkung am Werkzeug
name-measured-gain = Verstärkung am Lagegeber
name-tcp-height = TCP-Höhe h, mit Vorzeichen
name-force-lag = Zeitkonstante des { word-force-before }regelkreises T
name-Kv = Lagereglerverstärkung Kv
name-Kp = Geschwindigkeitsverstärkung Kp
name-Tn = Nachstellzeit Tn
name-encoder = Lagegeber
name-kind = Art der Steuerung
name-reserve = Reserve
name-position-loop = Ort der Lageregelung
name-lead = Weg je Umdrehung der Spindel
name-encoder-resolution = Auflösung des Lagegebers
name-contour-deviation = Zulässige Konturabweichung
name-contour-feed = Größter Vorschub dafür
name-band = Reserve: nutzbarer Anteil am Band
name-force = { $axis ->
    [rotary] Reserve: nutzbarer Anteil am Drehmoment
   *[linear] Reserve: nutzbarer Anteil an der { word-force }
}
name-base-mass = Gestellmasse
name-slider-mass = Schlittenmasse
name-rotary-inertia = Drehträgheit
name-lever-arm = Hebelarm
name-base-stiffness = Gestellsteifigkeit
name-base-damping = Gestelldämpfung
name-rotary-stiffness = Drehsteifigkeit
name-rotary-damping = Drehdämpfung
name-moving-mass = { $axis ->
    [rotary] Bewegtes Trägheitsmoment
   *[linear] Bewegte Masse
}
name-frequency = Eigenfrequenz
name-damping-ratio = Dämpfungsgrad
name-max-acceleration = Größte Beschleunigung des Motors
name-position-cycle = Lagereglertakt
name-velocity-cycle = Geschwindigkeitsreglertakt
name-drive-kind = Art des Antriebs
name-max-force = { $axis ->
    [rotary] Größtes Drehmoment
   *[linear] Größte { word-force }
}
name-continuous-force = Dauer{ word-force-behind }
name-static-load = Statische Last
name-coulomb-friction = Coulombsche Reibung
name-viscous-friction = Viskose Reibung
name-velocity-step = Geschwindigkeitssprung
name-distance = { $axis ->
    [rotary] Winkel
   *[linear] Weg
}
name-max-velocity = Höchstgeschwindigkeit
name-dwell = Verweilzeit
name-max-settling-time = Größte Einschwingzeit
name-frequency-spread = Streuung der Frequenzen
name-damping-spread = Streuung der Dämpfungen
name-payload-radius = Trägheitsradius der Zuladung
name-surface = Band für Oberflächen
name-accuracy = Band für Genauigkeit
name-speed = Band für Geschwindigkeit
name-payload-least = Zuladung (kleinste)
name-payload-largest = Zuladung (größte)

## $mode: as the profile names it

mode-deflection = Auslenkung der Eigenform { $mode }
mode-rate = Auslenkungsgeschwindigkeit der Eigenform { $mode }
