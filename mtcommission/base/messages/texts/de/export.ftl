# Steuerungen lesen diese Dateien: Was in ihnen steht, kommt ohne Umlaute aus.

export-other-loop = der Regelkreis in dieser Ergebnisdatei ist nicht der, den sein Profil und seine Verstärkungen ergeben; das Profil mit dieser Version erneut rechnen
export-too-small = die Beschleunigung { SI($acceleration, "ACCELERATION", digits: 3) } ist kleiner als eine Einheit dieser Steuerung; --control generic verwenden
export-no-control = keine Steuerung { $given }{ $hint }
export-other-letter = { $control } nennt seine Achsen { $letters }; diese Ergebnisdatei gilt für Achse „{ $axis_name }“: machine.axis mit einem dieser Buchstaben beginnen oder --control generic verwenden
export-linear-only = { $control } begrenzt nur Linearachsen, diese ist eine Rundachse; --control generic verwenden

export-title = { $name }, Achse { $axis_name }: Grenzwerte und Regelkreis für { $control }
export-computed = Berechnet { $created } mit { $tool } aus { $profile }
export-lost-letters = Buchstaben der Namen, die dieser Text nicht fassen kann, stehen als "?".
export-hash = Profil SHA-256 { $hash }
export-verify = VOR GEBRAUCH PRÜFEN. Berechnet, nicht gemessen: keine Abnahmeprüfung (ISO 230). Von Hand eingeben, alte Werte notieren, mit kleinem Override erproben.
export-safe-side = Jeder Grenzwert ist zur sicheren Seite gerundet. Einheiten stehen neben den Werten.
export-warning = WARNUNG: { $warning }
export-not-measured = Vorgabe übernommen, nicht gemessen: { $keys }.
export-unreadable = eine Zeile des Exports fehlt, ist nicht zurückzulesen oder widerspricht einer anderen: { $row }; bitte melden
export-unstable = der Regelkreis dieses Textes ist nicht stabil{ $lacking ->
    [yes] , weil dieser Steuerung fehlt: { $left_out }
   *[no] {""}
}: { $why }; das Profil mit control.kind = "{ $kind }" rechnen und erneut exportieren
export-corners = Beurteilt für Eigenfrequenzen +- { PLAIN($frequency, digits: 3, unit: "%") } %, Dämpfungsgrade +- { PLAIN($damping, digits: 3, unit: "%") } %{ $payload ->
    [yes] , Zuladung { SI($low, "MASS") } bis { SI($high, "MASS") }
    [middle] , Zuladung { SI($low, "MASS") } bis { SI($high, "MASS") } (Vorsteuerung und Verstärkungen für die Mitte)
   *[no] {""}
}; die Reserve ist nicht abgezogen: es gilt der ganze erlaubte Wert.
export-left-out = WEGGELASSEN ODER GEÄNDERT, weil diese Steuerung nichts anderes hat: { $features }. Einschwingzeit mit allem { $before }, mit diesem Text { $after }{ $cost ->
    [grows] {" "}({ CHANGE($change) })
   *[unknown] {""}
}. Für Grenzwerte und Verstärkungen, die zu dieser Steuerung passen, das Profil mit control.kind = "{ $kind }" rechnen und erneut exportieren.
export-feature = { $what ->
    [state-feedback] Zustandsrückführung
    [velocity] Geschwindigkeitsvorsteuerung
    [acceleration] { word-force-before }vorsteuerung
    [jerk] Ruckvorsteuerung
    [delay] Verzögerung des Lagesollwerts
    [setpoint-filter] Sollwertfilter dieser Art und Länge
    [force-filters] einige { has-force-filters }
    [loop-control] Lageregelung in der Steuerung mit gehaltenen Werten
    [loop-interpolated] Lageregelung in der Steuerung mit interpolierter Vorsteuerung
   *[loop-drive] Lageregelung im Antrieb
}
export-mode-fails = die Grenzwerte der Bearbeitungsart { $mode } halten mit dem Regelkreis dieses Textes ihr Band nicht ein, { $band }
export-neutral = In neutralen Worten, denn { $why }
export-mode-left-out = ENTFÄLLT: { $why }. Diese Betriebsart nicht mit den alten Werten verwenden.
export-warning-here = WARNUNG, für den Regelkreis dieses Textes: { $warning }
export-ceiling = GESCHRIEBEN IST EINE PRAKTISCHE OBERGRENZE, angenommen: { NUMBER($ceiling, digits: 4) } mm/s², Einschwingzeit { $after }. Die Achse dieses Modells vertrüge { NUMBER($wanted, digits: 4) } mm/s², { $before }; was Extruder, Rahmen und Motortreiber vertragen, enthält es nicht. { $why } Mehr nur eingeben, wenn die eigenen es erwiesenermaßen vertragen; vertragen sie weniger, das als drive.max_acceleration angeben.
export-shaft = Verstärkung und Trägheit des Antriebs gelten an der Motorwelle: die Achse bewegt sich { LENGTH($travel) } je Radiant des Motors.
export-no-shaft = Kp und die { word-force-before }vorsteuerung gelten an der Achse (ein Linearmotor; für einen rotierenden drive.lead und drive.gear angeben).
export-set-elsewhere = Im Antrieb einzustellen oder so vorausgesetzt, damit das Ergebnis oben gilt:
export-elsewhere = im Antrieb oder vorausgesetzt
export-segments = Diese Firmware ändert die Geschwindigkeit einmal je Abschnitt von 10 ms (Konstante der Ausgabe): Rampen nahe daran oder darunter werden zu Stufen, was die Simulation nicht zeigt.
export-doubt = (?) bedeutet: Name, Einheit oder Verwendung nicht nachgelesen, im Listenhandbuch der eigenen Softwareversion prüfen.
export-verified = beim Hersteller nachgelesen
export-doubted = (?) im Listenhandbuch der eigenen Softwareversion prüfen
export-judged = Aus diesem Text simuliert, Zeile für Zeile zurückgelesen (Massen, Eigenformen, Antrieb und Bewegungen sind die des Profils), { $corners ->
    [1] im Nennfall
   *[other] in { $corners } Eckfällen
}: Einschwingzeit { $settling }, Restabweichung { $residual }
export-all-met = { $judged }; alle Anforderungen erfüllt.
export-not-all-met = { $judged }; ANFORDERUNGEN NICHT ERFÜLLT: { $missed }.
export-incomplete = { $judged }; Anforderungen erfüllt, ABER UNVOLLSTÄNDIG: { $missed }.
export-missed = { $name } { $value }, erlaubt { $limit }
# $margins: of the loop that the text makes, worst corner
export-margins-lost = zu wenig Stabilitätsreserve, { $margins }
export-mode-missed = keine Grenzwerte für die Bearbeitungsart { $mode }
export-no-limits-within = keine Grenzwerte halten das Werkzeug im Band der Bearbeitungsart { $mode }, { $band }
export-no-limits-but = keine Grenzwerte halten das Werkzeug im Band der Bearbeitungsart { $mode }, { $band } ({ $attainable } wäre einzuhalten)
export-least-vibration = KEINE BESCHLEUNIGUNG ERFÜLLT HIER DIE ANFORDERUNGEN: von den erprobten Werten lässt dieser, { PLAIN($share, digits: 3, unit: "%") } % der Empfehlung, { $shaper ->
    [yes] mit dem Shaper
   *[no] ohne Shaper
} am wenigsten Schwingung zurück.
export-share-of-acceleration = Um die Anforderungen { $shaper ->
    [yes] mit dem Shaper
   *[no] ohne Shaper
} zu erfüllen, ist die Beschleunigung { PLAIN($share, digits: 3, unit: "%") } % der Empfehlung.

control-sinumerik = SINUMERIK 840D / 828D / ONE
control-heidenhain = HEIDENHAIN auf NCK-Basis
control-fanuc = FANUC 16i / 18i / 30i
control-isg = ISG-Kern / TwinCAT CNC
control-twincat = Beckhoff TwinCAT NC / NCI
control-plcopen = PLCopen-Bausteine, CODESYS
control-generic = allgemeine Kaskade, SI-Werte
control-state-space = freier Regler (Zustandsraum), SI-Werte
control-linuxcnc = LinuxCNC ab 2.10
control-klipper = Klipper
control-grblhal = grblHAL
control-fluidnc = FluidNC
control-marlin = Marlin
control-ros2 = ROS 2 / MoveIt

value-of-unit = { QUANTITY($value, $unit) }

export-old = alt
export-for-nc-program = Für das NC-Programm, nicht für die SPS: { $remark }
unit = Einheit
limit-deceleration = Verzögerung
limit-path-nci = Bahnbeschleunigung, -verzögerung, -ruck (NCI)
limit-axis-jerk = Achsruck
limit-axis-jerk-at-rapid = Achsruck im Eilgang; die Regel des Herstellers, 5 x axPathJerk, wurde nicht beurteilt
limit-rapid = Eilgang, zu dem die Anstiegszeit gehört; so lassen, wie er ist
limit-of-mode = { $mode }, Band { $band }, erfüllt
gain-integral-time = Nachstellzeit, aufgerundet
gain-kp-at-shaft = Kp dieses Regelkreises, an der Motorwelle
gain-reference-model = Zeitkonstante des Referenzmodells vor dem Integrator
gain-kv = Kv dieses Regelkreises
gain-kv-name-and-unit = Kv dieses Regelkreises; Name und Einheit
gain-kp-at-axis = Geschwindigkeitsverstärkung, an der Achse
gain-tn-unit = Tn dieses Regelkreises, aufgerundet; Einheit
row-feedforward-velocity = Gewicht der Geschwindigkeitsvorsteuerung
row-feedforward-force = { word-force } je Beschleunigung, an der Achse
row-feedforward-jerk = { word-force } je Ruck, an der Achse
row-feedforward-inertia = Vorsteuerung: alle Trägheit, an der Welle
filter-average = Mittelwert des Sollwerts; 0: keiner darf wirken
filter-second-average = zweiter gleitender Mittelwert hinter dem ersten
filter-tap = Gewicht des Sollwerts vor so vielen Abständen, der erste der neueste
filter-tap-spacing = Abstand der Stützstellen des Sollwertfilters
filter-count = wirksame { has-force-filters }, in dieser Reihenfolge
filter-kind = Art des Filters
filter-frequency = Eigenfrequenz des Filters
filter-damping = Dämpfungsgrad: Zähler einer Bandsperre, Nenner eines Tiefpasses
filter-width = Dämpfungsgrad des Nenners der Bandsperre
row-state-gain = { word-force } je Einheit dieses Zustands, über den Beobachter zurückgeführt
delay-of-reference = Verzögerung des Lagesollwerts, bis die Vorsteuerung wirkt

sinumerik-mode = { $dynamic }: { $about }
sinumerik-mode-unit = { $dynamic }; Einheit
sinumerik-filter-on = Ruckfilter ein
moving-average = gleitender Mittelwert
sinumerik-two-averages = zwei gleitende Mittelwerte hintereinander
sinumerik-filter-off = Ruckfilter aus: seine Zeit käme zur Rampe hinzu
sinumerik-ffw-mode = 0 keine, 3 Drehzahl, 4 Moment; mit Totzeit
sinumerik-delay = ganze Verzögerung des Lagesollwerts
sinumerik-position-cycle = Lagereglertakt: Produkt (?), siehe MD10061
sinumerik-dsc = 1: Lageregelung im Antrieb (DSC; Telegramm 105, 106 oder mit Splines), 0: in der Steuerung
sinumerik-filters = wirksame Momentenfilter, je ein Bit
sinumerik-denominator-frequency = Eigenfrequenz des Nenners
sinumerik-numerator-frequency = Eigenfrequenz des Zählers
sinumerik-denominator-damping = Dämpfungsgrad des Nenners
sinumerik-numerator-damping = Dämpfungsgrad des Zählers
sinumerik-filter-kind = 1 Tiefpass, 2 zweite Ordnung mit Zähler; Reihenfolge der fünf Parameter
sinumerik-dynamic-modes = DYNNORM und DYNPOS erhalten die Empfehlung, die anderen die Grenzwerte einer Bearbeitungsart, mit deren eigenem Band beurteilt; Beschleunigung und Ruck sind ein Paar: mehr Ruck kann weniger Beschleunigung heißen. G0 nutzt gegebenenfalls MD32434/MD32435 (Faktoren), JOG nutzt MD32420/MD32430.
sinumerik-one-mode = DYNNORM und DYNPOS erhalten die Empfehlung; die übrigen Dynamikmodi behalten, was sie haben, und das wurde nicht beurteilt. G0 kann MD32434/MD32435 (Faktoren) verwenden, JOG verwendet MD32420/MD32430.
sinumerik-path-jerk = Der Bahnruck MD20600 muss über den Achswerten liegen, sonst begrenzt er.
sinumerik-turns = Beschleunigungen zählen in Umdrehungen, Lagen und Bänder in Grad.

heidenhain-path = maxPathJerk und maxPathJerkHi (Vorgabe 40 m/s^3) und maxPathYank begrenzen die Bahn: über den Achswerten halten, nach der Regel des Herstellers mindestens 1,75 x der größte Achswert.
heidenhain-filters = Die Lagefilter der Steuerung bringen eigene Ruckzeit mit: sie darf nicht doppelt gezählt werden.
heidenhain-speed-gains = Die Drehzahlverstärkungen sind hier Ströme je Drehzahl: aus Kp und Tn unten folgen sie nur mit der Drehmomentkonstante des Motors.
heidenhain-itnc = Bei einer iTNC 530 steht der Kv-Faktor in (m/min)/mm.

fanuc-rise-time = Zeit vom Stillstand bis zum Eilgang, für den Wert von 1420 unten
fanuc-bell-time = Glockenzeit, Beschleunigung / Ruck
fanuc-no-jerk = Einen Ruck in { $length }/s^3 gibt es hier nicht: die Glockenzeit bestimmt ihn.
fanuc-gain = Die Drehzahlverstärkung zählt hier relativ zur Motordatei (2021): Kp unten ist nur als Vielfaches des heutigen Werts einstellbar.
fanuc-rapid = 1420 lassen, wie es ist; ist es nicht der Wert unten, 1620 x eigener Wert / Wert unten eingeben, aufgerundet, damit die Beschleunigung { PLAIN($acceleration, digits: 4) } { $length }/s^2 bleibt. Die Glockenzeit 1774 ändert sich nicht.
fanuc-nano = AI nano contour control nimmt die Zeit aus 1773 statt 1620, und die Glockenform braucht 1603#6 (RBL) = 1.
fanuc-look-ahead = 1788/1789 (Änderung der Beschleunigung) und, nicht nachgelesen (?), 1660, 1671 und 1772 begrenzen Betriebsarten mit Vorausschau und dürfen nicht schneller sein als diese Werte.

isg-acceleration-rises = Rampenzeit, Beschleunigung steigt
isg-acceleration-falls = Rampenzeit, Beschleunigung fällt
isg-deceleration-rises = Rampenzeit, Verzögerung steigt
isg-deceleration-falls = Rampenzeit, Verzögerung fällt
isg-ramp-at-rapid = Rampenzeit bei G0
isg-acceleration-at-rapid = Beschleunigung bei G0
isg-gear-sets = getriebe[0] ist der erste Getriebesatz; die Zeilen für weitere wiederholen.
isg-own-limits = dynamik.a_max darf nicht unter diesen Beschleunigungen und dynamik.tr_min nicht über diesen Rampenzeiten liegen: der Kern würde seine eigenen Grenzen nehmen.
isg-operation-mode = wo sich der Lageregelkreis schließt; kv wirkt nur mit CNC_POSITION_CONTROL
isg-feedforward = 0 keine, 0x101 Geschwindigkeit, 0x303 Geschwindigkeit und Moment
isg-moving-average = gleitender Mittelwert; mit #FILTER ON einschalten
isg-slope = Das Profil muss TRAPEZ, SIN2 oder HSC sein: mit STEP, der Vorgabe, wirkt keine Rampenzeit.

twincat-jerk-unit = MC_MoveAbsolute aus TF5200 nimmt den Ruck in mm/s^3, die CNC von TwinCAT 2 nahm m/s^3: den aufgerufenen Baustein ansehen.
twincat-no-jerk-filter = Der Sollwertgenerator braucht neben diesen Grenzwerten keinen Ruckfilter.
twincat-kp = Kp dieses Regelkreises, an der Motorwelle; AX5000 (AX8000: 3140:01, gleiche Einheit)
twincat-tn = Tn dieses Regelkreises, aufgerundet; AX5000 (AX8000: 3140:02 in s)
twincat-kv-in-drive = Kv dieses Regelkreises; AX5000, Lageregelung im Antrieb
twincat-kv-in-nc = Kv dieses Regelkreises, (mm/s)/mm; der NC selbst, für einen Antrieb mit Drehzahlsollwert
plcopen-unit = Die Einheit u der Achse gilt als 1 { $axis ->
    [rotary] Grad
   *[linear] mm
}: die Skalierung der Achse prüfen und alle drei Werte umrechnen, wenn sie anders ist.
plcopen-jerk-of-zero = Ein Ruck von 0 bedeutet nicht keinen: er wählt die Vorgabe der Achse.
plcopen-quadratic = CODESYS: der Ruck wirkt nur mit der Rampenform quadratisch.

linuxcnc-jerk = Ruck; 0 würde die Grenze abschalten
linuxcnc-gain = Kv, für einen Antrieb, der Maschineneinheiten/s nimmt
linuxcnc-planner = ruckbegrenzter Planer
linuxcnc-path-acceleration = Obergrenze jeder Bewegung der Linearachsen: nie unter dem größten ihrer Werte, ein höherer darf stehen bleiben
linuxcnc-path-jerk = Bahnruck: der kleinste aller Linearachsen
linuxcnc-units = Für LinuxCNC 2.10 und neuer; als Maschineneinheiten gelten mm und Grad.
linuxcnc-joints = Die Gelenknummern gelten für triviale Kinematik: X Y Z A B C U V W sind die Gelenke 0 bis 8.
linuxcnc-least-jerk = MAX_LINEAR_JERK unter 1 fällt stillschweigend auf Trapeze zurück. Referenzfahrt mit PLANNER_TYPE = 0.
grblhal-builds = Die Ruckeinstellungen gibt es nur in Ausgaben mit ENABLE_JERK_ACCELERATION.
grblhal-corners = $11 (junction deviation) bestimmt, wie schnell Ecken gefahren werden, und gehört nicht hierher.
fluidnc-no-jerk = FluidNC hat noch keine Ruckgrenze veröffentlicht.
fluidnc-degrees = Der Name sagt mm, aber eine Rundachse zählt in Grad: der Wert steht in deg/s^2.
klipper-tool-head = des Werkzeugkopfs, also seiner langsamsten Achse
klipper-input-shaper = Input Shaper
klipper-of-mode = der Eigenform { $mode }
shaper-of-run = wie im Lauf
klipper-no-jerk = Klipper hat keine Ruckgrenze; square_corner_velocity ist ein Geschwindigkeitssprung, kein Ruck.
klipper-cruise = minimum_cruise_ratio (Vorgabe 0.5) senkt die Geschwindigkeit kurzer Bewegungen: sie sind ohne das simuliert.
klipper-corner = Geschwindigkeitssprung am rechten Winkel
klipper-corner-bound = square_corner_velocity: bis { NUMBER($most, digits: 3) } mm/s bleibt die Schwingung, die der Geschwindigkeitssprung hinter dem Shaper hinterlässt, für sich innerhalb des freigegebenen Anteils am Band, in jedem Eckfall von Frequenz und Dämpfung; eingetragen ist das, höchstens die Vorgabe von Klipper, { NUMBER($usual, digits: 3) } mm/s. Wie weit der Shaper die Ecke verrundet und ob der Motor so weit springen kann, enthält das Modell nicht.
klipper-three-humps = 3HUMP_EI war in Klipper von September 2025 bis 31. März 2026 fehlerhaft (ein fehlendes Komma, #7235): Klipper vorher aktualisieren.
klipper-shaper = Der Shaper verlängert jede Bewegung um seine eigene Dauer.
marlin-fixed-time = Fixed-Time Motion ein
marlin-shaper = 1 ZV, 2 ZVD, 5 EI, 6 und 7 EI mit zwei und drei Höckern, 8 MZV; die Buchstaben haben sich zwischen Versionen geändert
marlin-jerk = Was Marlin "jerk" nennt (M205), ist ein Geschwindigkeitssprung in mm/s, kein Ruck.
marlin-corner = Junction Deviation, wenn der Build sie hat
marlin-step = größter Geschwindigkeitssprung, für Builds mit CLASSIC_JERK
marlin-corner-bound = M205 J steht für einen Geschwindigkeitssprung am rechten Winkel, J = v² (sqrt(2) − 1)/a: den von { NUMBER($usual, digits: 3) } mm/s, mindestens aber die 0,01 mm und höchstens die 0,3 mm, die die Firmware annimmt; 0,01 mm sind bei der größten geschriebenen Beschleunigung { NUMBER($least, digits: 3) } mm/s. Bis { NUMBER($most, digits: 3) } mm/s bleibt die Schwingung hinter dem Shaper für sich innerhalb des freigegebenen Anteils am Band. Wie weit der Shaper die Ecke verrundet und ob der Motor so weit springen kann, enthält das Modell nicht.
marlin-step-bound = M205 J kann die Ecke hier nicht begrenzen: die Firmware weist weniger als 0,01 mm ab und behält den alten Wert, und mit 0,01 mm wird ein rechter Winkel bei der größten geschriebenen Beschleunigung mit { NUMBER($least, digits: 3) } mm/s durchfahren. Bis { NUMBER($most, digits: 3) } mm/s bleibt die Schwingung, die der Geschwindigkeitssprung hinter dem Shaper hinterlässt, für sich innerhalb des freigegebenen Anteils am Band. Eingetragen ist daher der Sprung selbst, höchstens { NUMBER($usual, digits: 3) } mm/s, für einen Build mit CLASSIC_JERK; ohne diesen schwingt die Achse an Ecken weiter aus, als das Band erlaubt. Wie weit der Shaper die Ecke verrundet und ob der Motor so weit springen kann, enthält das Modell nicht.
marlin-grid = FT Motion legt die Kopien eines Shapers um ganze Abtastwerte von 1 ms auseinander (FTM_FS = 1000 Hz, shaping.cpp, Stand 195278e4): alle Frequenzen eines Bereichs ergeben denselben Shaper, geschrieben ist seine Mitte, die daher von der gemessenen abweichen kann. Das ist simuliert; eine Ausgabe mit anderem FTM_FS formt anders.
marlin-build = M493 braucht eine Ausgabe mit FT_MOTION; M500 speichert die Werte.
ros-gain = Kv des Trajektorienreglers, Geschwindigkeit als Stellgröße
export-no-loop = Der Motor folgt dem Sollwert: hier wird nichts von einem Regelkreis eingestellt.
