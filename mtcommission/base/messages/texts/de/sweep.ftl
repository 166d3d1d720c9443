sweep-no-text = ist kein UTF-8-Text; als CSV in UTF-8 speichern
sweep-table-too-large = ist größer als { PLAIN($most, digits: 12) } Bytes; auf mehrere Reihen verteilen
sweep-table-without-cases = braucht eine Kopfzeile mit Schlüsseln und darunter mindestens einen Fall
sweep-table-too-wide = hat { $count } Spalten; höchstens { $most } Schlüssel werden zusammen verändert
sweep-table-too-long = hat { PLAIN($count, digits: 12) } Fälle, höchstens { PLAIN($most, digits: 12) } sind möglich
sweep-no-csv = ist kein CSV: { $reason }
sweep-count-of-cells = braucht { $wanted } Werte, erhalten { $got }
sweep-empty-cell = { $key }: hat keinen Wert
sweep-two-units = { $key }: erhalten "{ $got }" unter einer Überschrift in { $unit }, muss eine bloße Zahl sein

sweep-varies-twice = ist zweimal verändert; einmal angeben
sweep-unequal-lengths = braucht für jeden Schlüssel gleich viele Werte, erhalten { $got }
sweep-no-axis = erhalten { $got }, muss SCHLÜSSEL=BEREICH sein
sweep-empty-value = hat einen leeren Wert
sweep-no-range = erhalten { $got }: { $reason }
sweep-forms-of-ranges = muss START:STOP:COUNT, log:START:STOP:COUNT, random:LOW:HIGH:COUNT:SEED oder eine Liste mit Kommas sein
sweep-ends-with-two-units = beide Enden mit derselben Einheit schreiben oder beide ohne (SI)
sweep-count-of-range = die Anzahl muss zwischen 1 und { PLAIN($most, digits: 12) } liegen
sweep-logarithm-of-zero = ein logarithmischer Bereich braucht Enden > 0
sweep-no-number = { $got } beginnt nicht mit einer Zahl
sweep-no-element = das Profil hat kein solches Element; sie zählen ab 1 in Klammern, z. B. { $example }; ein fehlendes erst dort eintragen
sweep-no-key = diesen Schlüssel gibt es nicht; Elemente von Listen haben Nummern, z. B. { $example }
sweep-taken-from-profile = geht nur mit --quantity optimal; { $quantity } entnimmt es dem Profil

sweep-folder-in-use = dort arbeitet eine andere Reihenrechnung; ihr Ende abwarten oder mit -o einen anderen Ordner angeben
sweep-folder-holds-one = enthält schon eine Reihenrechnung; mit --resume fortsetzen oder einen anderen Ordner angeben
sweep-folder-holds-another = enthält eine andere Reihenrechnung (anderes Profil, andere Bereiche, Größe oder Version); einen anderen Ordner angeben oder die Optionen, mit denen sie begonnen wurde
sweep-folder-holds-foreign = enthält { $names }, von keinem Sweep geschrieben oder im Ganzen beschädigt; einen anderen Ordner angeben
sweep-lock-is-link = { $name } ist ein Verweis
sweep-disk-full = kann nicht geschrieben werden ({ $reason }); alle Zeilen davor sind erhalten: Platz schaffen und mit --resume fortsetzen
sweep-cases-kept = { PLAIN($done, digits: 12) } von { PLAIN($count, digits: 12) } Fällen liegen in { $folder }
sweep-piece-lost = { PLAIN($done, digits: 12) } von { PLAIN($count, digits: 12) } Fällen sind gespeichert, Stück { PLAIN($piece, digits: 12) } nicht
sweep-waits = der Rechnerverbund hat keinen Prozess; es wird auf einen gewartet (starten mit: dask worker ADRESSE), Strg-C beendet
sweep-scheduler-gone = { $address } antwortet nicht mehr; { PLAIN($done, digits: 12) } von { PLAIN($count, digits: 12) } Fällen sind gespeichert
sweep-no-cluster-extra = braucht den Zusatz für Rechnerverbünde: pip install "mtcommission[cluster]"
sweep-no-dask = was dort lauscht, spricht nicht wie Dask
sweep-no-scheduler = kein Scheduler antwortet unter { $address } ({ $why }); mit „dask scheduler“ starten und die Adresse angeben, die er ausgibt; tls:// braucht Zertifikate in den Einstellungen von Dask (docs/sweeps.md)
sweep-other-scheme = { $address } angegeben, muss eine Adresse sein, wie dask scheduler sie nennt, tcp://RECHNER:PORT oder tls://RECHNER:PORT

sweep-column-key = Veränderter Schlüssel des Profils.
sweep-column-case = Nummer des Falls, ab 0; in einem Gitter läuft der letzte Schlüssel am schnellsten.
    .head = Fall
sweep-column-t-f = Kürzeste Zeit der Bewegung bis zum völligen Stillstand (zeitoptimal); bei limits der langsamsten Bewegung.
    .head = t_f
sweep-column-t-f-lower-bound = Schneller ist keine Steuerung: bewiesen mit der adjungierten Gleichung.
    .head = Bewiesene Schranke von t_f
sweep-column-relative-gap = (t_f - t_f_lower_bound) / t_f.
    .head = Relative Lücke
sweep-column-certified = Ob die Lücke höchstens 1e-9 ist.
    .head = Bewiesen
sweep-column-switches = Anzahl der Umschaltungen der zeitoptimalen Steuerung.
    .head = Umschaltungen
sweep-column-switching-times = Ihre Umschaltzeiten, durch Leerzeichen getrennt.
sweep-column-peak = Größter Betrag von { $name } während der Bewegung und danach.
    .head = Höchstwert: { $name }
sweep-column-acceleration = Empfohlene Beschleunigungsgrenze.
    .head = Beschleunigung
sweep-column-jerk = Empfohlene Ruckgrenze.
    .head = Ruck
sweep-column-jerk-time = Beschleunigungsgrenze durch Ruckgrenze.
    .head = Ruckzeit
sweep-column-settling-time = Vom Start, bis das Werkzeug im Band bleibt; langsamste Bewegung, ungünstigster Fall der Unsicherheit.
    .head = Einschwingzeit
sweep-column-residual-deviation = Größte Abweichung des Werkzeugs nach dem Ende des Sollwerts, ungünstigster Fall der Unsicherheit.
    .head = Restabweichung
sweep-column-peak-deviation = Größte Abweichung des Werkzeugs überhaupt, ungünstigster Fall der Unsicherheit.
    .head = Größte Abweichung
sweep-column-requirements-met = Ob alle Anforderungen in jedem Fall der Unsicherheit erfüllt sind.
    .head = Alles erfüllt
sweep-column-bound-by = Was höhere Grenzen verhindert.
    .head = Begrenzt durch
sweep-column-obstacle = Die Anforderung, die nicht erfüllt ist; leer, wo alle erfüllt sind.
    .head = Nicht erfüllt
sweep-column-record = Ergebnisdatei der ganzen Rechnung, neben dieser Tabelle.
    .head = Ergebnisdatei
sweep-column-outcome = „done“ (berechnet), oder wie die Rechnung endete.
    .head = Ausgang
sweep-column-message = Warum es kein Ergebnis gibt, und was zu tun ist.
    .head = Warum keines

sweep-asked = Berechnet: { $parts }.
sweep-asked-move = Bewegung { $move } von { $of }
sweep-asked-bound = |{ $name }| höchstens { $bound }
sweep-summary = { PLAIN($count, digits: 12) } Fälle: { $ends }; { $kind ->
        [certified] zertifiziert
       *[requirements_met] alle Anforderungen erfüllt
    }: { PLAIN($met, digits: 12) }
sweep-count-done = { PLAIN($count, digits: 12) } berechnet
sweep-not-certified = nicht zertifiziert, zuerst in Fall { PLAIN($case, digits: 12) }: höchstens { PLAIN($gap, digits: 2) } der Zeit über der kürzestmöglichen (zertifiziert: 1e-9)
sweep-first-in = zuerst in Fall { PLAIN($case, digits: 12) }

sweep-page-title = Parameterstudie: { $name }
sweep-page-units = Die Einheiten stehen in den Spaltenköpfen; rows.csv enthält dasselbe in SI. Berechnet, nicht gemessen.
sweep-page-script = Diagramme und Tabelle brauchen JavaScript; rows.csv enthält dieselben Zeilen.
sweep-page-heading = Über dem, was sich ändert
sweep-page-horizontal = Waagrecht
sweep-page-vertical = Senkrecht
sweep-page-logarithmic = logarithmisch
sweep-page-good = { $kind ->
        [certified] zertifiziert
       *[requirements_met] alle Anforderungen erfüllt
    }
sweep-page-marks = Grüner Punkt: { $good }; rotes Kreuz: nicht. Dünne Linien verbinden Fälle, die sich sonst in nichts unterscheiden. Band grün: alle Fälle dort sind es; gelb: einige; rot: keiner. Mit dem Zeiger einen Punkt ablesen, mit einem Klick sein Profil zeigen.
sweep-page-trade = Zeit gegen Schwingung, oder zwei beliebige Spalten
sweep-page-ringed = Umringt: kein anderer Fall ist in einem so niedrig und im anderen niedriger (Pareto-Front).
sweep-page-map = Karte über zwei Schlüsseln
sweep-page-scale = Weiß: kein Ergebnis; rote Marke: nicht { $good }. Gleiche Schritte für gleiche Plätze in der Liste der Werte.
sweep-page-rows = Zeilen
sweep-page-back = Zurück
sweep-page-on = Weiter
sweep-page-sort = Ein Klick auf den Spaltenkopf sortiert; der Zeiger darauf zeigt, was die Spalte bedeutet.
sweep-page-profile = Profil eines Falls
sweep-page-choose = Einen Fall im Diagramm oder in der Tabelle wählen.
sweep-page-case = Fall %1
sweep-page-over = %1 über %2
sweep-page-over-two = %1 über %2 (nach rechts) und %3 (nach oben); hell: %4, dunkel: %5
sweep-page-numbers = Zahlen: %1
sweep-page-page = Seite %1 von %2
sweep-page-chosen = Fall %1; was sich ändert, steht in SI.
sweep-page-front = Zielkonflikt
