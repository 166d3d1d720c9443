# Numerical settings, by their names in the record.

setting-gain-margin-db = Verlangte Amplitudenreserve
setting-phase-margin-deg = Verlangte Phasenreserve
setting-reserve-deg = Für die Zustandsrückführung vorgehaltene Phase
setting-sensitivity-peak = Zulässiges Maximum der Empfindlichkeit
setting-position-ratios = Versuchte Kv m / Kp
setting-integral-ratios = Versuchte Tn Kp / m
setting-least-integral-share = Kp Kv / Tn relativ zur klassischen Regel, mindestens
setting-mode-weights = Versuchte Gewichte der Werkzeugschwingung für die Zustandsrückführung
setting-reduction = Faktor von einem Versuch für Kp zum nächsten
setting-force-noise = { $axis ->
    [rotary] Momentenrauschen des Beobachters, bezogen auf F_max
   *[linear] Kraftrauschen des Beobachters, bezogen auf F_max
}
setting-position-noise = Geberrauschen des Beobachters
setting-least-acceleration = Kleinste Beschleunigung, bezogen auf F_max/m
setting-least-jerk-time = Kürzeste Ruckzeit
setting-longest-jerk-time = Längste Ruckzeit, in Perioden der langsamsten Eigenform
setting-slow-jerk-time = Längste Ruckzeit einer steifen Achse, mindestens
setting-grid = Rasterpunkte je Richtung
setting-coarse-grid = { $axis ->
    [rotary] Rasterpunkte, an denen das Drehmoment simuliert wird
   *[linear] Rasterpunkte, an denen die Kraft simuliert wird
}
setting-seeds = Gleichzeitig verfeinerte Zellen
setting-refinements = Verfeinerungen, jede halbiert eine Zelle
setting-digits = Signifikante Stellen des Ergebnisses
setting-samples = Ausgeloste Maschinen, höchstens
setting-sample-cycles = Über alle Maschinen simulierte Lagereglertakte, höchstens
setting-seed = Startwert der Zufallszahlen
setting-frequency-range = Größter versuchter Frequenzfehler, relativ
setting-frequency-points = Versuchte Frequenzfehler
setting-landscape = Punkte des Kennfelds je Richtung
setting-largest-fraction = Zuerst versuchtes Kp, relativ zum symmetrischen Optimum
setting-mode-noise = Rauschen der Eigenform im Beobachter, bezogen auf F_max
setting-evaluations = In jedem Eckfall beurteilte Grenzwerte

## What they are for

settings-tuning = Reglereinstellung
settings-search = Suche
settings-comparison = Vergleichssuche
settings-robustness = Robustheit
