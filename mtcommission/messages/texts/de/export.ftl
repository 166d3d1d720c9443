# Steuerungen lesen diese Dateien: Was in ihnen steht, kommt ohne Umlaute aus.

export-mode-without-limits = keine Grenzwerte erfüllen die Anforderungen der Bearbeitungsart { $mode }
export-profile-edited = das Profil in diesem Protokoll wurde geändert: es hat nicht die Prüfsumme des Laufs; stattdessen das geänderte Profil rechnen
export-other-loop = der Regelkreis in diesem Protokoll ist nicht der, den sein Profil und seine Verstärkungen ergeben; das Profil mit dieser Version erneut rechnen
export-too-small = die Beschleunigung { SI($acceleration, "ACCELERATION", digits: 3) } ist kleiner als eine Einheit dieser Steuerung; --control generic verwenden
export-no-control = keine Steuerung { $given }. Es gibt: { $there_are }
export-no-control-but = keine Steuerung { $given }; ist { $meant } gemeint? Es gibt: { $there_are }
export-other-letter = { $control } nennt seine Achsen { $letters }; dieses Protokoll gilt für Achse „{ $axis_name }“: machine.axis mit einem dieser Buchstaben beginnen oder --control generic verwenden
export-linear-only = { $control } begrenzt nur Linearachsen, diese ist eine Rundachse; --control generic verwenden

export-title = { $name }, Achse { $axis_name }: Grenzwerte fuer { $control }
export-computed = Berechnet { $created } mit { $tool } aus { $profile }
export-hash = Profil SHA-256 { $hash }
export-verify = VOR GEBRAUCH PRUEFEN. Berechnet, nicht gemessen: keine Abnahmepruefung (ISO 230). Von Hand eingeben, alte Werte notieren, mit kleinem Override erproben.
export-safe-side = Jeder Grenzwert ist zur sicheren Seite gerundet. Einheiten stehen neben den Werten.
export-moving-average = Diese Grenzwerte gelten mit einem gleitenden Mittelwert des Sollwerts ueber { PLAIN($time, digits: 4, unit: "ms") } ms in der Steuerung (setpoint_filter des Profils); ohne ihn gelten sie nicht.
export-warning = WARNUNG: { $warning }
export-not-measured = Vorgabe uebernommen, nicht gemessen: { $keys }.
export-doubt = (?) bedeutet: Name oder Einheit nicht nachgelesen, im Listenhandbuch der eigenen Softwareversion pruefen.
export-verified = beim Hersteller nachgelesen
export-doubted = (?) im Listenhandbuch der eigenen Softwareversion pruefen
export-judged = Simuliert mit genau diesen Grenzwerten{ $gains ->
    [all] {" "}und diesen Verstaerkungen
    [Kv] {" "}und diesem Kv
   *[none] {""}
} { $corners ->
    [1] im Nennfall
   *[other] in { $corners } Eckfaellen
}: Einschwingzeit { $settling }, Restabweichung { $residual } (empfohlene Grenzwerte: { $recommended })
export-all-met = { $judged }; alle Anforderungen erfuellt.
export-not-all-met = { $judged }; ANFORDERUNGEN NICHT ERFUELLT: { $missed }.
export-missed = { $name } { $value }, erlaubt { $limit }
export-mode-missed = keine Grenzwerte fuer die Bearbeitungsart { $mode }
export-not-settled = nicht eingeschwungen
export-no-limits-within = keine Grenzwerte halten das Werkzeug im Toleranzband der Bearbeitungsart { $mode }, { $band }
export-no-limits-but = keine Grenzwerte halten das Werkzeug im Toleranzband der Bearbeitungsart { $mode }, { $band } ({ $attainable } waere einzuhalten)
export-least-vibration = KEINE BESCHLEUNIGUNG ERFUELLT HIER DIE ANFORDERUNGEN: von den erprobten Werten laesst dieser, { PLAIN($share, digits: 3, unit: "%") } % der Empfehlung, { $shaper ->
    [yes] mit dem Shaper
   *[no] ohne Shaper
} am wenigsten Schwingung zurueck.
export-share-of-acceleration = Um die Anforderungen { $shaper ->
    [yes] mit dem Shaper
   *[no] ohne Shaper
} zu erfuellen, ist die Beschleunigung { PLAIN($share, digits: 3, unit: "%") } % der Empfehlung.

control-sinumerik = SINUMERIK 840D / 828D / ONE
control-heidenhain = HEIDENHAIN auf NCK-Basis
control-fanuc = FANUC 16i / 18i / 30i
control-isg = ISG-Kern / TwinCAT CNC
control-twincat = Beckhoff TwinCAT NC / NCI
control-plcopen = PLCopen-Bausteine, CODESYS
control-generic = jede Steuerung: SI-Werte in neutralen Worten
control-linuxcnc = LinuxCNC ab 2.10
control-klipper = Klipper
control-grblhal = grblHAL
control-fluidnc = FluidNC
control-marlin = Marlin
control-ros2 = ROS 2 / MoveIt

export-mode-surface = Oberflaeche
export-mode-accuracy = Genauigkeit
export-mode-speed = Geschwindigkeit

export-old = alt
export-for-nc-program = Fuer das NC-Programm, nicht fuer die SPS: { $remark }
export-head-parameter = Parameter
export-head-new-value = neuer Wert
export-head-unit = Einheit
export-head-old-value = alter Wert
export-head-meaning = Bedeutung
limit-acceleration = Beschleunigung
limit-deceleration = Verzoegerung
limit-jerk = Ruck
limit-itself = Grenzwert
limit-path-nci = Bahnbeschleunigung, -verzoegerung, -ruck (NCI)
limit-jerk-time = Beschleunigung / Ruck, aufgerundet
limit-axis-jerk = Achsruck
limit-axis-jerk-at-rapid = Achsruck im Eilgang; die Regel des Herstellers, 5 x axPathJerk, wurde nicht beurteilt
limit-recommended = empfohlen
limit-of-mode = { $mode }, Toleranzband { $band }, erfuellt
gain-position = Lageverstaerkung dieses Regelkreises
gain-velocity = Geschwindigkeitsverstaerkung
gain-integral-time = Nachstellzeit, aufgerundet
gain-kv = Kv dieses Regelkreises
gain-kv-name-and-unit = Kv dieses Regelkreises; Name und Einheit
gain-feed-forward-name = Geschwindigkeitsvorsteuerung dieses Regelkreises; Name
gain-kp-at-axis = Kp dieses Regelkreises, an der Achse; ein rotierender Motor braucht Nms/rad an seiner Welle
gain-tn-unit = Tn dieses Regelkreises, aufgerundet; Einheit
delay-of-reference = Verzoegerung des Sollwertpfads

sinumerik-mode = { $dynamic }: { $about }
sinumerik-mode-unit = { $dynamic }; Einheit
sinumerik-jerk-filter = Alternative mit dem Ruckfilter MD32400
sinumerik-ramp-too-long = Die Rampe von { PLAIN($ramp, digits: 4, unit: "ms") } ms ist laenger als der uebliche Bereich des Filters von { PLAIN($longest, digits: 4, unit: "ms") } ms ({ $cycles } Lagereglertakte), daher gibt es hier keine Alternative mit dem Ruckfilter.
sinumerik-filter-instead = Den Filter STATT der Ruckgrenze setzen: MD32431 erhoehen, bis es nicht mehr wirkt, die Beschleunigung behalten. Beide zusammen wuerden die Ruckzeit doppelt zaehlen.
sinumerik-filter-simulated = So simuliert { $met ->
    [yes] erfuellt er
   *[no] ERFUELLT ER NICHT
} alle Anforderungen, Einschwingzeit { $settling }. Der Filter wirkt auch bei Bewegungen, die die Beschleunigung nie erreichen; dort laesst eine Ruckgrenze Schwingung zurueck.
sinumerik-filter-on = Ruckfilter ein
sinumerik-moving-average = gleitender Mittelwert
sinumerik-cycles = { $count } Lagereglertakte
sinumerik-left-out = { $dynamic } ENTFAELLT: { $why }. Diese Betriebsart nicht mit den alten Werten verwenden.
sinumerik-dynamic-modes = DYNNORM und DYNPOS erhalten die Empfehlung, die anderen die Grenzwerte einer Bearbeitungsart, mit deren eigenem Toleranzband beurteilt. G0 nutzt gegebenenfalls MD32434/MD32435 (Faktoren), JOG nutzt MD32420/MD32430.
sinumerik-path-jerk = Der Bahnruck MD20600 muss ueber den Achswerten liegen, sonst begrenzt er.
sinumerik-filter-already-on = Ist schon ein Ruckfilter ein (MD32400 = 1), kommt seine Zeit zur Rampe hinzu: ausschalten oder die Alternative unten verwenden.
sinumerik-turns = Beschleunigungen zaehlen in Umdrehungen, Lagen und Toleranzbaender in Grad.

heidenhain-mode = Bearbeitungsart { $mode }
heidenhain-judged = Mit eigenem Toleranzband beurteilt, { $band }: erfuellt.
heidenhain-left-out = ENTFAELLT: { $why }.
heidenhain-path = maxPathJerk und maxPathJerkHi (Vorgabe 40 m/s^3) und maxPathYank begrenzen die Bahn: ueber den Achswerten halten, nach der Regel des Herstellers mindestens 1,75 x der groesste Achswert.
heidenhain-filters = Die Lagefilter der Steuerung bringen eigene Ruckzeit mit: sie darf nicht doppelt gezaehlt werden.
heidenhain-itnc = Bei einer iTNC 530 steht der Kv-Faktor in (m/min)/mm.

fanuc-rise-time = Zeit vom Stillstand bis zum Eilgang, wenn 1420 = { $rapid } { $unit }
fanuc-bell-time = Glockenzeit, Beschleunigung / Ruck
fanuc-no-jerk = Einen Ruck in { $length }/s^3 gibt es hier nicht: die Glockenzeit bestimmt ihn.
fanuc-rapid = Die groesste Geschwindigkeit des Profils ist { $rapid } { $length }/min. 1420 lassen, wie es ist; hat es einen anderen Wert, 1620 = { $rise } ms x 1420 / { $rapid } eingeben, aufgerundet, damit die Beschleunigung { PLAIN($acceleration, digits: 4) } { $length }/s^2 bleibt. Die Glockenzeit 1774 aendert sich nicht.
fanuc-nano = AI nano contour control nimmt die Zeit aus 1773 statt 1620, und die Glockenform braucht 1603#6 (RBL) = 1.
fanuc-look-ahead = 1788/1789 (Aenderung der Beschleunigung) und, nicht nachgelesen (?), 1660, 1671 und 1772 begrenzen Betriebsarten mit Vorausschau und duerfen nicht schneller sein als diese Werte.

isg-acceleration-rises = Rampenzeit, Beschleunigung steigt
isg-acceleration-falls = Rampenzeit, Beschleunigung faellt
isg-deceleration-rises = Rampenzeit, Verzoegerung steigt
isg-deceleration-falls = Rampenzeit, Verzoegerung faellt
isg-ramp-at-rapid = Rampenzeit bei G0
isg-acceleration-at-rapid = Beschleunigung bei G0
isg-gear-sets = getriebe[0] ist der erste Getriebesatz; die Zeilen fuer weitere wiederholen.
isg-own-limits = dynamik.a_max darf nicht unter diesen Beschleunigungen und dynamik.tr_min nicht ueber diesen Rampenzeiten liegen: der Kern wuerde seine eigenen Grenzen nehmen.

twincat-jerk-unit = MC_MoveAbsolute aus TF5200 nimmt den Ruck in mm/s^3, die CNC von TwinCAT 2 nahm m/s^3: den aufgerufenen Baustein ansehen.
twincat-no-jerk-filter = Der Sollwertgenerator braucht neben diesen Grenzwerten keinen Ruckfilter.
plcopen-unit = Die Einheit u der Achse gilt als 1 { $axis ->
    [rotary] Grad
   *[linear] mm
}: die Skalierung der Achse pruefen und alle drei Werte umrechnen, wenn sie anders ist.
plcopen-jerk-of-zero = Ein Ruck von 0 bedeutet nicht keinen: er waehlt die Vorgabe der Achse.

linuxcnc-jerk = Ruck; 0 wuerde die Grenze abschalten
linuxcnc-planner = ruckbegrenzter Planer
linuxcnc-path-jerk = Bahnruck: der kleinste aller Linearachsen
linuxcnc-units = Fuer LinuxCNC 2.10 und neuer; als Maschineneinheiten gelten mm und Grad.
linuxcnc-joints = Die Gelenknummern gelten fuer triviale Kinematik: X Y Z A B C U V W sind die Gelenke 0 bis 8.
linuxcnc-least-jerk = MAX_LINEAR_JERK unter 1 faellt stillschweigend auf Trapeze zurueck. Referenzfahrt mit PLANNER_TYPE = 0.
grblhal-builds = Die Ruckeinstellungen gibt es nur in Ausgaben mit ENABLE_JERK_ACCELERATION.
grblhal-corners = $11 (junction deviation) bestimmt, wie schnell Ecken gefahren werden, und gehoert nicht hierher.
fluidnc-no-jerk = FluidNC hat noch keine Ruckgrenze veroeffentlicht.
fluidnc-degrees = Der Name sagt mm, aber eine Rundachse zaehlt in Grad: der Wert steht in deg/s^2.
klipper-tool-head = des Werkzeugkopfs, also seiner langsamsten Achse
klipper-input-shaper = Input Shaper
klipper-mode = Eigenform { $mode }
klipper-of-mode = der Eigenform { $mode }
klipper-no-jerk = Klipper hat keine Ruckgrenze; square_corner_velocity ist ein Geschwindigkeitssprung, kein Ruck.
klipper-shaper = Der Shaper beruhigt die Eigenform { $mode }; er verlaengert jede Bewegung um seine eigene Dauer.
marlin-fixed-time = Fixed-Time Motion ein
marlin-shaper = { $shaper }-Shaper auf Eigenform { $mode }; die Buchstaben haben sich zwischen Versionen geaendert
marlin-jerk = Was Marlin "jerk" nennt (M205), ist ein Geschwindigkeitssprung in mm/s, kein Ruck.
marlin-build = M493 braucht eine Ausgabe mit FT_MOTION; M500 speichert die Werte.
