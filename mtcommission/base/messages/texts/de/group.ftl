# Achsen, die zusammen fahren: Kreis, Ecke, ein Filter, eine Verzögerung.

stage-group = Kreise und Ecken
group-tolerance-missing = fehlt: keine Achse nennt requirements.contour_deviation; angeben, wie weit das Werkzeug von der Kontur abweichen darf, z. B. --tolerance 10um
group-feed-missing = fehlt: keine Achse nennt requirements.contour_feed oder eine Geschwindigkeit ihrer Bewegungen; den schnellsten Vorschub für Konturen angeben, z. B. --feed 6m/min
group-count = { $got } Profile erhalten; zusammen fahren { $least } oder { $most } Achsen: das Profil jeder Achse angeben
group-rotary = Achse { $name } dreht; Kreise und Ecken gibt es für Linearachsen: diese weglassen
group-same-name = Achse { $name } heißt wie die in { $other }; den Namen angeben, den die Steuerung hat, z. B. axis = "Y"
group-other-control = "{ $got }" erhalten, die erste Achse hat "{ $first }"; Achsen, die zusammen fahren, haben eine Steuerung: angleichen
group-other-drive = eine Achse hat einen Lageregelkreis, die andere folgt ihrem Sollwert; Achsen, die zusammen fahren, sind gleich angetrieben
group-other-cycle = { TIME($got) } erhalten, die erste Achse hat { TIME($first) }; Achsen, die zusammen fahren, haben einen Takt: angleichen
group-other-filter = nennt ein anderes Sollwertfilter als die erste Achse; Achsen, die zusammen fahren, brauchen dasselbe: angleichen, oder "auto" schreiben, dann wird es gewählt
group-tolerance-large = { LENGTH($got) } angegeben, darf höchstens { LENGTH($most) } sein; die Einheit dazuschreiben, z. B. 10um
group-bound-acceleration = Beschleunigungsgrenze
group-bound-jerk = Ruckgrenze
group-bound-path-acceleration = Bahnbeschleunigung
group-bound-path-jerk = Bahnruck
group-bound-velocity = Verfahrgeschwindigkeit
group-bound-entry = Toleranz: Einfahrt
group-bound-filter = Toleranz: Sollwertfilter
group-bound-delay = Toleranz: Verzögerungen
group-bound-loop = Toleranz: Regelkreis
group-bound-friction = Umkehrspitze
group-where-circle = Radius { LENGTH($radius) } bei { FEED($feed) }
group-check-circle = Kontur auf Kreisen, ohne Reibung
group-where-line = Gerade unter { NUMBER($slope, digits: 2) }° bis { FEED($feed) }
group-check-line = Kontur auf Geraden
group-check-peak = Umkehrspitze, { $name }
group-check-along = Abweichung längs, { $name }
group-check-of = { $requirement }, { $name }
group-delays-apart = Die Verzögerungen der Achsen unterscheiden sich um { TIME($apart) }, und eine Stelle für eine Wartezeit ist in dieser Steuerung nicht bekannt: Bei { FEED($feed) } macht allein das Kreise oval. Den anderen Achsen die control.force_filters von { $slowest } geben und neu rechnen.
group-other-contours = Kreise, Ecken und Geraden sind mit { LENGTH($tolerance) } beurteilt; längs der eigenen Bewegungen einer Achse contour_deviation ihres Profils: { $of }.
group-contour-of = { $name } { LENGTH($tolerance) }
group-path-friction = Bahngrenzen überschreiten die der Achsen in keiner Richtung, auch mit Reibung{ $viscous ->
    [yes] {" "}mit Ausnahme der viskosen.
   *[no] .
}
group-next-contour = weiter: derselbe Befehl mit --tolerance { $tolerance }, was diese Achsen einhalten, oder mit kleinerem --feed
group-next-peak = weiter: die Reibung von { $names } in der Steuerung kompensieren, dann einen Kreis messen; ohne Kompensation derselbe Befehl mit --tolerance { $tolerance }
group-next-path = weiter: derselbe Befehl mit größerer --tolerance oder kleinerem --feed: Die Bahngrenzen bremsen die Achsen
group-next-axis = weiter: mtcommission run { $profile }, das sagt, woran es bei der Achse { $name } allein liegt
group-peaks-forbid = Schon bei { FEED($feed) } wirft eine Umkehr von { $name } das Werkzeug um { LENGTH($peak) } heraus, mehr als { LENGTH($tolerance) }: mit diesen Spitzen ist kein Vorschub genannt. Die Reibung in der Steuerung kompensieren oder die Toleranz erhöhen; die letzten Spalten gelten ohne sie.
group-feed-without-peaks = Ohne Spitzen
group-one-circle = Nur Kreise von { LENGTH($radius) } wurden beurteilt, wie --radius verlangt: andere können die Toleranz verlassen.
group-one-plane = Nur Kreise, Ecken und Geraden von { $first } und { $second } sind beurteilt, wie --plane es sagt: auch die anderen Ebenen rechnen und die kleinsten der Bahngrenzen eingeben.
group-no-friction = Keine Reibung angegeben: Spitzen bei der Umkehr einer Achse fehlen. drive.coulomb_friction angeben oder von identify bestimmen lassen.
group-path-slows = Die Bahngrenzen machen jede Bewegung langsamer: Einschwingzeiten und Urteil rechnen mit ihnen.
group-wait-in-parts = Dass die Steuerung in Teilen eines Lagetakts wartet, wurde nicht nachgelesen (?): messen, wie oval ein Kreis ist.
group-rule-not-verified = Wie diese Steuerung Ecken fährt, wurde nicht im Handbuch nachgelesen: (?) kennzeichnet ihre Namen.
group-contour-not-kept = Mit keinen Bahngrenzen, die sich eingeben lassen, wird die Toleranz eingehalten: Toleranz erhöhen, --feed senken oder die Achsen versteifen.
group-path-without-place = Eine Stelle für Bahngrenzen ist in dieser Steuerung nicht bekannt: Die Achsgrenzen sind gesenkt, bis Kreise und Geraden die Toleranz einhalten.
group-bound-by-contour = Kontur auf Kreisen und Geraden (eine Stelle für Bahngrenzen ist nicht bekannt)
group-one-shaper = Ein Shaper für alle Achsen: er liegt auf der Eigenfrequenz einer von ihnen.
group-axes = { $name }, Achsen { $axes }
group-wait = Warten
group-delay = Verzögerung
group-angle = Ecke
group-radius = Radius
group-radius-deviation = Radiusfehler
group-form-deviation = Form
group-peak = Spitze { $name }
group-circle-of = Kreis, Radius { LENGTH($radius) }
group-corner-told = Ecken: { $kind ->
    [arc] { $name } { LENGTH($value) } der Toleranz für den Bogen.
    [junction] { $name } { VELOCITY($value) } (Geschwindigkeit bei 90°).
    [deviation] { $name } { LENGTH($value) } (Junction Deviation).
    [own] { $name } { LENGTH($value) } (eigenes Filter der Steuerung, nicht simuliert).
   *[step] { $name } Geschwindigkeitssprung einer Achse { FEED($value) }.
}
group-corner-no-arc = Ecken: kein Bogen innerhalb der Toleranz ist schneller als ein sofortiger Richtungswechsel mit den Geschwindigkeiten über dem Winkel.
group-corner-no-value = Ecken: mit den Geschwindigkeiten über dem Winkel fahren; ein Wert, der diese einhält, ist für diese Steuerung nicht bekannt.
group-tolerance = Konturtoleranz { LENGTH($tolerance) } bis { FEED($feed) }

# Export einer Gruppe: Was Steuerungen lesen, kommt ohne Sonderzeichen aus.
group-row-wait = zusätzliche Verzögerung, mit der die Achse auf die langsamste wartet
group-row-match = die Achse wartet auf die langsamste
group-row-acceleration = Bahnbeschleunigung; unterhalb der Achsgrenzen bremst sie jede Bewegung
group-row-jerk = Bahnruck; unterhalb der Achsgrenzen bremst er jede Bewegung
group-row-acceleration-on = die Obergrenze der Bahnbeschleunigung wirkt
group-row-step = Geschwindigkeitssprung, den Ecken einer Achse zumuten dürfen
group-row-speed = Geschwindigkeit am rechten Winkel
group-row-arc = wie weit die Verrundung einer Ecke von ihr abweichen darf
group-row-deviation = Junction Deviation
group-row-parabola = Abstand der Parabel von der Ecke; simuliert wurde ein Bogen
group-row-tolerance = Konturtoleranz; die eigenen Filter der Steuerung sind nicht simuliert
group-part-axis = Achse { $name }
group-part-path = Bahn aller Achsen
group-export-not-met = DIE ACHSGRUPPE ERFÜLLT NICHT ALLE ANFORDERUNGEN: { $checks }.
group-export-title = { $name }, Achsen { $axes }: aufeinander abgestimmte Grenzwerte und Regelkreise für { $control }
# $radius: mm, $feed: m/min
group-export-circle = Kreis, Radius { NUMBER($radius, digits: 4) } mm mit { NUMBER($feed, digits: 4) } m/min, aus diesem Text simuliert, ungünstigster Fall, ohne Reibung: Radius { $deviation }, Form { $form }; wie in der Ergebnisdatei bis auf Rundung, um höchstens 0,1 um oder 1 %.
group-export-other-circle = Kreis, Radius { NUMBER($radius, digits: 4) } mm mit { NUMBER($feed, digits: 4) } m/min, aus diesem Text simuliert, ungünstigster Fall, ohne Reibung: Radius { $deviation }, Form { $form }; NICHT WIE IM PROTOKOLL: Radius { $planned }, Form { $planned_form }. Der Steuerung fehlt, worauf die Gruppe baut, oder sie rundet es: die Profile für diese Steuerung rechnen.
group-export-line = Geraden bis { NUMBER($feed, digits: 4) } m/min, aus diesem Text simuliert, in der schlechtesten Richtung: Abweichung { $deviation }.
group-export-of = Achse { $name }: { $said }
group-export-without-place = NICHT IN DIESEM TEXT, weil in dieser Steuerung kein Platz dafür bekannt ist: { $values }.
group-wait-without-place = Wartezeit { $waits }
group-acceleration-without-place = Bahnbeschleunigung { SI($value, "ACCELERATION") }
group-jerk-without-place = Bahnruck { SI($value, "JERK") }
group-wait-of = { $name } { TIME($wait) }
group-export-same-name = { $control } hat für die Achsen { $names } nur einen Namen: ihnen in machine.axis eigene Buchstaben geben, die Gruppe erneut rechnen oder --control generic verwenden
group-export-no-corner = KEIN WERT FÜR ECKEN: sie mit den Geschwindigkeiten über dem Winkel aus der group.json durchfahren (als Vorschub vor der Ecke programmieren oder dort anhalten). Ein Wert gehört zu der Steuerung, für die die Gruppe gerechnet ist; es gibt keinen, wo innerhalb der Toleranz kein Verrunden schneller ist als ein sofortiger Richtungswechsel.

# Aufgezeichnete Kreise. $name, $first, $second, $later, $sooner: Achsen; $number: des Kreises
circle = Kreis { $number }
group-circle-radius = mittlerer Radius
group-circle-form = Unrundheit (größter weniger kleinster Radius)
group-circle-delay = Verzögerung, { $name }
group-circle-quadrant-peak = Umkehrspitze, { $name }
group-recorded-caption = Kreis { $number }: { $file }, { LENGTH($radius) } mit { FEED($feed) }, { $direction ->
    [clockwise] im Uhrzeigersinn
   *[counterclockwise] gegen den Uhrzeigersinn
}, { NUMBER($turns, digits: 3) } Umläufe.
# in µm/m
group-squareness-found = Als Rechtwinkligkeit herausgenommen: Der Winkel der Achsen weicht um { NUMBER($value, digits: 3) } ± { NUMBER($uncertainty, digits: 2) } µm/m vom rechten ab (positiv: kleiner als 90°).
group-squareness-unknown = Rechtwinkligkeit und ungleiche Verzögerungen sind mit Kreisen einer Richtung und eines Vorschubs nicht zu trennen: auch die Gegenrichtung aufzeichnen.
group-one-direction = die Unrundheit kann ebenso vom Winkel der Achsen kommen, der dann um { NUMBER($squareness, digits: 3) } µm/m vom rechten abwiche; auch einen Kreis in der Gegenrichtung aufzeichnen
group-radius-assumed = der programmierte Radius ist nicht bekannt, angenommen { LENGTH($radius) }; den Sollwert mit aufzeichnen oder den Ballbar kalibrieren
group-peak-not-seen = in der Aufzeichnung liegt keine ganze Umkehr; den Kreis zweimal durchlaufen
group-friction-unknown = die Ergebnisdatei nennt keine Reibung von { $name }: drive.coulomb_friction angeben und die Gruppe erneut rechnen
group-trace-radius = { $file }: kein Sollwert aufgezeichnet, als Radius wird { LENGTH($radius) } angenommen.
group-trace-too-fast = { $file }: Dieser Kreis braucht { SI($got, "ACCELERATION") }, die Bahngrenze der Gruppe ist { SI($most, "ACCELERATION") }: Er wurde mit anderen Grenzwerten gefahren oder streckenweise langsamer.
group-trace-columns = kein Kreis in den Spalten { $found }; gebraucht werden { $first } und { $second } (Istlagen, daneben { $first }_ref und { $second }_ref) oder angle und radius: mit --columns NAME=SPALTE benennen
group-trace-angle-unit = { $name } hat keine Einheit; hinter den Namen schreiben, z. B. angle [deg], oder --columns "angle={ $name } [deg]"
group-trace-no-length = { $name } [{ $unit }] ist keine Länge; die Einheit hinter den Namen schreiben, z. B. [mm], oder mit --columns eine andere Spalte angeben
group-trace-no-angle = { $name } [{ $unit }] ist kein Winkel; die Einheit hinter den Namen schreiben, z. B. [deg], oder mit --columns eine andere Spalte angeben
group-trace-size = der Kreis hat einen Radius von { LENGTH($radius) }, den kein Kreisformtest hat; die Einheiten prüfen und den ganzen Radius angeben, nicht seine Abweichung
group-trace-no-circle = ist kein Kreis: dieser Abtastwert liegt { LENGTH($off) } neben dem durch die meisten anderen; die Aufzeichnung auf den Kreis kürzen oder die Spalten prüfen
group-trace-arc = das längste Stück mit gleichbleibendem Vorschub läuft { $got }° herum; nötig ist ein ganzer Umlauf: mindestens zwei Umläufe samt Anlauf aufzeichnen
group-plot-angle = Winkel, °
group-plot-deviation = Abweichung des Radius
group-line-measured = gemessen
group-line-fitted = angepasst, ohne die Umkehrstellen
group-line-predicted = vorhergesagt, Nennfall
group-verify-one-axis = gilt für die Ergebnisdatei einer einzelnen Achse; bei einer Gruppe weglassen
# Das Blatt.
group-title = Achsgruppe
group-axes-named = Achsen { $axes }
group-verdict-heading = Urteil und Werte für die Gruppe
group-contours-heading = Kreis und Ecke, und was zu messen ist
group-missed = Nicht eingehalten: { $checks }.
group-path-acceleration = Bahnbeschleunigung
group-path-jerk = Bahnruck
group-typed-caption = Einzugeben für jede Achse und die Bahn; export group.json hat alle Parameter, mit ihren Schaltern („(?)“: nicht beim Hersteller gelesen, prüfen; „>“: im Antrieb)
group-filter-chosen = schwingt von denen, die Kreise nicht bremsen, zuerst ein
group-filter-binds = erlaubt die schnellsten Kreise
group-bound-by-axis = Grenzwert der Achse { $name }
group-bound-by-tolerance = Konturtoleranz
group-bound-by-axes = nichts (es gelten die Grenzen der Achsen)
group-path-none = die der Achsen
group-corners = Ecken
group-path-column = Bahn
group-axis-today = { $name } heute
group-axis-new = { $name } neu
group-bound-of = { $name } wird begrenzt durch: { $by }.
group-settles = Einschwingzeit (Bahn)
group-rise-time = Hochlaufzeit
group-force-filters = Kp hält seine Reserven nur mit diesen Filtern im Antrieb; sie zuerst eingeben, wie export group.json sie schreibt: { $filters }.
group-feedforward = Vorsteuerung
group-balancing = Sollwertverzögerung
group-circle-caption = Kreisformtest, wie er bei der nominellen Maschine ausfällt, Radius { LENGTH($radius) }
group-circle-alt = Kreise mit Radius { LENGTH($radius) } bei { $feeds }, die Abweichung vergrößert: ein Teilstrich ist { LENGTH($division) }, die Toleranz { LENGTH($tolerance) } nach beiden Seiten.
group-circle-band = Toleranz ± { LENGTH($tolerance) }
group-circle-nominal = Sollkreis
group-circle-division = Ein Teilstrich: { $division }
group-circle-turn = Gegen den Uhrzeigersinn (G3)
group-circle-figures = { $feed }: F { $least } bis { $largest }, G { $circular }
group-feeds-caption = Größter Vorschub auf Kreisen innerhalb { LENGTH($tolerance) }
group-corners-caption = Geschwindigkeit an Ecken (ungebremst: bei { FEED($feed) })
group-corner-speed = Vorschub
group-not-slowed = Ungebremst
group-measure-caption = Zu messen: Kreis von { LENGTH($radius) } Radius, gegen den Uhrzeigersinn, volle Umläufe; Toleranz { LENGTH($tolerance) }
group-measured-largest = Radialabweichung Fmax
group-measured-least = Radialabweichung Fmin
group-measured-circular = Kreisformabweichung G
group-worst-radius = Fehler des mittleren Radius, ohne Reibung, ungünstigster Eckfall
group-worst-form = Größter − kleinster Radius, ohne Reibung, ungünstigster Eckfall
group-measure-centre = F und G nach ISO 230-4, nach kleinsten Quadraten zentriert; berechnet für die nominelle Maschine, mit Umkehrspitzen (die Anforderungen zählen sie für sich), ohne Geometrie (Rechtwinkligkeit, Steigungs- und Geradheitsfehler kommen hinzu).
group-measure-turn = Im Uhrzeigersinn (G2) liegt eine Ellipse aus ungleichen Verzögerungen unter der anderen Diagonale; eine, die bleibt, ist ein Rechtwinkligkeitsfehler.
group-measure-peaks = Spitzen stehen hinter der Umkehr, wo die Geschwindigkeit einer Achse ihr Vorzeichen wechselt: rechts und links die von { $first }, oben und unten die von { $second }.

# Die interaktive Seite.
group-page-heading = Vorschub, Radius und Ecke ausprobieren
group-page-intro = Schieben oder tippen: Kreis und Ecke folgen, aus dieser Ergebnisdatei berechnet wie mit dem Befehl group.
group-page-no-script = Das Ausprobieren braucht JavaScript.
group-page-circle-caption = Kreis, Abweichung vergrößert
group-page-circle-note = Nominelle Maschine, gegen den Uhrzeigersinn; gestrichelt: Toleranz. Umkehrspitzen liegen zwischen denen der berechneten Vorschübe.
group-page-corner-caption = Ecke
group-page-corner-note = Nominelle Maschine, entlang der ersten Achse angefahren; gestrichelt: Toleranz um die Ecke.
group-page-values = Kreis und Ecke, ungünstigste Maschine, wo nicht nominell steht
group-page-permitted = Erlaubt
group-page-keeps = Kreise weichen bis { $value } ab, benutzen dürfen sie { $limit }; Umkehrspitzen stehen unten.
group-page-throws = Bei der Umkehr weicht das Werkzeug um { $value } ab, mehr als { $limit }.
group-page-misses = Kreise weichen um { $value } ab, mehr als die { $limit }, die sie benutzen dürfen.
group-page-too-fast = Dieser Kreis braucht eine Bahnbeschleunigung von { $value }, mehr als { $limit }.
group-page-beyond = Ein so kleiner Kreis wurde bei diesem Vorschub nicht berechnet: langsamer oder größer.
group-page-unslowed = ungebremst, { $value }: Abweichung { $size }
group-page-slowed = gebremst auf { $value }
group-page-division = ein Teilstrich { $value }
group-page-band = Toleranz ± { $value }
group-page-row-acceleration = Bahnbeschleunigung v²/R
group-page-row-largest = Größte Abweichung des Kreises
group-page-row-radius = davon mittlerer Radius
group-page-row-form = davon Form (größter weniger kleinster Radius)
group-page-row-entry = Abweichung bei der Einfahrt
group-page-row-most = Fmax, nominell, mit Umkehrspitzen
group-page-row-least = Fmin, nominell, mit Umkehrspitzen
group-page-row-circular = G, nominell, mit Umkehrspitzen
group-page-row-peak = Umkehrspitze, { $name }, nominell
group-page-row-corner = Ecke ohne Bremsen
group-page-row-speed = Geschwindigkeit an der Ecke innerhalb der Toleranz
group-page-field-feed = Vorschub
group-page-field-radius = Radius des Kreises
group-page-field-angle = Richtungsänderung an der Ecke

# in µm/m
group-may-be-scale = ein Maßstab, der durch Steigung oder Temperatur um { NUMBER($scale, digits: 3) } µm/m abweicht, wirkt ebenso; die Maßstäbe der Achsen messen
