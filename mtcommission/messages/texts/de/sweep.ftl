sweep-no-text = ist kein UTF-8-Text; als CSV in UTF-8 speichern
sweep-table-too-large = ist größer als { PLAIN($most, digits: 12) } Bytes; auf mehrere Reihen verteilen
sweep-table-without-cases = braucht eine Kopfzeile mit Schlüsseln und darunter mindestens einen Fall
sweep-table-too-long = hat { PLAIN($count, digits: 12) } Fälle, höchstens { PLAIN($most, digits: 12) } sind möglich
sweep-no-csv = ist kein CSV: { $reason }
sweep-count-of-cells = braucht { $wanted } Werte, erhalten { $got }
sweep-empty-cell = { $key }: hat keinen Wert
sweep-two-units = { $key }: erhalten "{ $got }" unter einer Überschrift in { $unit }, muss eine bloße Zahl sein

sweep-varies-twice = ist zweimal verändert; einmal angeben
sweep-unequal-lengths = braucht für jeden Schlüssel gleich viele Werte, erhalten { $got }
sweep-no-axis = erhalten { $got }, muss SCHLÜSSEL=BEREICH sein
sweep-empty-value = erhalten { $got } mit einem leeren Wert
sweep-no-range = erhalten { $got }: { $reason }
sweep-forms-of-ranges = muss START:STOP:COUNT, log:START:STOP:COUNT, random:LOW:HIGH:COUNT:SEED oder eine Liste mit Kommas sein
sweep-ends-with-two-units = beide Enden mit derselben Einheit schreiben oder beide ohne (SI)
sweep-no-whole-number = { $got } muss eine ganze Zahl sein
sweep-count-of-range = die Anzahl muss zwischen 1 und { PLAIN($most, digits: 12) } liegen
sweep-logarithm-of-zero = ein logarithmischer Bereich braucht Enden > 0
sweep-no-number = { $got } beginnt nicht mit einer Zahl
sweep-no-toml = TOML-Syntax: { $reason }
sweep-no-element = das Profil hat kein solches Element; sie zählen ab 1 in Klammern, z. B. { $example }; ein fehlendes erst dort eintragen
sweep-no-key = diesen Schlüssel gibt es nicht; Elemente von Listen haben Nummern, z. B. { $example }
sweep-taken-from-profile = geht nur mit --quantity optimal; { $quantity } entnimmt es dem Profil

sweep-folder-in-use = dort arbeitet eine andere Reihenrechnung; ihr Ende abwarten oder mit -o einen anderen Ordner angeben
sweep-folder-in-use-by = dort arbeitet eine andere Reihenrechnung (Prozess { $process }); ihr Ende abwarten oder mit -o einen anderen Ordner angeben
sweep-folder-holds-one = enthält schon eine Reihenrechnung; mit --resume fortsetzen oder einen anderen Ordner angeben
sweep-folder-holds-another = enthält eine andere Reihenrechnung (anderes Profil, andere Bereiche, Größe oder Version); einen anderen Ordner angeben oder die Optionen, mit denen sie begonnen wurde
sweep-folder-holds-foreign = enthält { $names }, von keinem Sweep geschrieben oder im Ganzen beschädigt; einen anderen Ordner angeben
sweep-lock-is-link = { $name } ist ein Verweis
sweep-lines-set-aside = beschädigte Zeilen des Speichers: { $lines }; nach { $file } gelegt, ihre Fälle wurden neu gerechnet
sweep-disk-full = kann nicht geschrieben werden ({ $reason }); alle Zeilen davor sind erhalten: Platz schaffen und mit --resume fortsetzen
sweep-cases-kept = { PLAIN($done, digits: 12) } von { PLAIN($count, digits: 12) } Fällen liegen in { $folder }
sweep-piece-lost = { PLAIN($done, digits: 12) } von { PLAIN($count, digits: 12) } Fällen sind gespeichert, Stück { PLAIN($piece, digits: 12) } nicht
sweep-no-cluster-extra = braucht den Zusatz für Rechnerverbünde: pip install "mtcommission[cluster]"
sweep-no-scheduler = unter { $address } antwortet kein Scheduler; ihn starten mit: dask scheduler
