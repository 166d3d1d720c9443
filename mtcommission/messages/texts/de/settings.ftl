# Numerical settings, by their names in the record.

setting-gain-margin-db = Verlangte Amplitudenreserve
setting-phase-margin-deg = Verlangte Phasenreserve
setting-reserve-deg = Für die Zustandsrückführung vorgehaltene Phase
setting-sensitivity-peak = Zulässiges Maximum der Empfindlichkeit
setting-position-ratios = Versuchte Kv m / Kp
setting-integral-ratios = Versuchte Tn Kp / m
setting-least-integral-share = Kp Kv / Tn relativ zur klassischen Regel, mindestens
setting-longest-integral-time = Längste vorgeschlagene Tn, außer nach der klassischen Regel
setting-mode-weights = Versuchte Gewichte der Werkzeugschwingung für die Zustandsrückführung
setting-reduction = Faktor von einem Versuch für Kp zum nächsten
setting-force-noise = { $axis ->
    [rotary] Momentenrauschen des Beobachters, bezogen auf F_max
   *[linear] Kraftrauschen des Beobachters, bezogen auf F_max
}
setting-position-noise = Geberrauschen des Beobachters
setting-samples = Ausgeloste Maschinen, höchstens
setting-seed = Startwert der Zufallszahlen
setting-frequency-range = Größter versuchter Frequenzfehler, relativ
setting-frequency-points = Versuchte Frequenzfehler
setting-largest-fraction = Zuerst versuchtes Kp, relativ zum symmetrischen Optimum
setting-mode-noise = Rauschen der Eigenform im Beobachter, bezogen auf F_max
setting-cells = Zellen der Bewegung zu Beginn
setting-parts = { $axis ->
    [rotary] Teile einer Zelle, in der das Drehmoment umschaltet
   *[linear] Teile einer Zelle, in der die Kraft umschaltet
}
setting-gap = Abstand zur bewiesenen Schranke, bei dem das Verfeinern endet, relativ
setting-margin = Zwischen den Zeilen frei gehaltener Anteil des Bands
setting-velocity-margin = Zwischen den Punkten frei gehaltener Anteil von max_velocity
setting-most-velocity-margin = Zwischen den Punkten frei gehaltener Anteil von max_velocity, höchstens
setting-exchanges = Runden des Austauschs, höchstens
setting-time-tolerance = Relative Genauigkeit der Zeit auf gegebenen Zellen
setting-first-contacts = Erste Zeilen je Periode der langsamsten Eigenform
setting-radians = Abtastung der freien Bewegung, in Radiant
setting-most-samples = Abtastpunkte einer freien Bewegung, höchstens
setting-steps = Schritte des Simplexverfahrens, höchstens
setting-frequencies = Frequenzen der Streuung im ersten Programm
setting-checked-frequencies = Geprüfte Frequenzen der Streuung
setting-robust-margin = Zwischen den Frequenzen frei gehaltener Anteil des Bands

## What they are for

settings-tuning = Reglereinstellung
settings-robustness = Robustheit
settings-band = Optimum mit dem Band
