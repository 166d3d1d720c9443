# Gemessene Dateien: wie ein Format heißt, was an einer Datei falsch ist, wie geschätzt wurde.

identify-file-empty = ist leer; neu aufzeichnen oder exportieren
identify-file-binary = ist eine Binärdatei; die Messung als Text (CSV), XML oder Universal File exportieren
identify-file-foreign = ist eine Datei vom Typ { $format }, die hier nicht gelesen wird; die Messung als CSV, XML oder Universal File (Dataset 58) exportieren
identify-file-is-folder = ist ein Ordner; die gemessenen Dateien darin nennen
identify-file-too-large = ist größer als { PLAIN($most, digits: 9) } Byte; eine kürzere Aufzeichnung oder mit kleinerer Abtastrate exportieren
identify-line-too-long = eine Zeile mit mehr als { PLAIN($most, digits: 9) } Zeichen; das ist keine Messtabelle
identify-no-table = keine Zahlentabelle in { $lines } Zeilen (die erste: „{ $first }“); in die erste Zeile Namen mit Einheiten, darunter mindestens zwei Spalten schreiben, getrennt durch Komma, Semikolon, Tabulator oder Leerzeichen
identify-too-many-columns = { $got } Spalten, mehr als { $most }; nur die nötigen Signale exportieren
identify-row-length = { $got } Werte, die Tabelle hat { $wanted } Spalten; die Zeile ist abgeschnitten oder das Trennzeichen wechselt
identify-no-number = Spalte { $column }: „{ $got }“ angegeben, muss eine Zahl sein
identify-not-finite = Spalte { $column }: „{ $got }“ angegeben; die Zeile weglassen oder neu aufzeichnen
identify-cut = Zeile { $line } ist unvollständig und wurde weggelassen: die Datei ist dort wohl abgeschnitten
identify-overruns = an { $count } Stellen gingen Abtastwerte verloren (overrun); das längste Stück ohne Verlust wird benutzt, { $kept } von { $of } Werten
identify-negative-magnitude = ein Betrag von { PLAIN($least) }, der nicht negativ sein kann; wenn er in Dezibel steht, magnitude [dB] schreiben
identify-negative-power = eine negative Leistung; sind die Spalten vertauscht?
identify-no-response = kein Frequenzgang unter den Spalten { $found }; nötig sind frequency_hz mit re und im oder mit magnitude und phase
identify-no-such-name = „{ $got }“ angegeben, kein Name eines Signals; es gibt t, sample_time, { $names }, und für Frequenzgänge frequency_hz, re, im, magnitude, phase, coherence
identify-setting-unknown = die Datei sagt { $got }, das ist nicht bekannt; sensor ist encoder oder tcp, input force, torque, current oder acceleration, output position, velocity oder acceleration, constant eine Zahl
identify-xml-broken = ist keine ganze XML-Datei: { $reason }; die Messung neu speichern
identify-xml-unknown = ist XML mit der Wurzel { $root }; bekannt sind ResponseTestCustom, DynamicModelAxisController und Servo-Traces der SINUMERIK
identify-series-broken = die Reihe { $name } ist abgeschnitten oder enthält fremde Zeichen; die Messung neu speichern
identify-series-short = { $name } hat { $got } Werte, es müssen { $wanted } sein; die Datei ist abgeschnitten, die Messung neu speichern
identify-series-missing = { $name } fehlt; die Messung mit ihren Daten speichern
identify-series-not-finite = { $name } enthält Werte, die keine Messung liefert (nicht endlich oder über alle Maßen groß); neu messen
identify-record-broken = Datensatz { $row }: „{ $got }“ angegeben, muss eine Zahl sein
identify-response-taken = { $name } wird genommen: Motordrehzahl je { word-force }, die Mechanik, die der Antrieb bewegt. Die Datei enthält auch { $others }: { $file }@NAME nimmt einen davon.
identify-last-response-taken = { $name } wird genommen: Motordrehzahl je { word-force }, zuletzt gemessen. Die Datei enthält auch { $others }: { $file }@NAME nimmt einen davon.
identify-hz-assumed = Die Datei enthält keine Abtastzeit, die die Einheit ihrer Frequenzen verrät: als Hz gelesen, bis { PLAIN($last) } Hz (angenommen; in rad/s lägen sie um 2π tiefer)
identify-frequency-neither = Die letzte Linie liegt bei { PLAIN($last) }; eine Sitzung reicht aber bis zur halben Abtastrate, { PLAIN($nyquist) } Hz bei { TIME($step) }: Das passt weder in Hz noch in rad/s, die Einheit der Frequenzen ist also nicht bekannt; mit voller Bandbreite erneut messen oder den Frequenzgang als Tabelle mit frequency_hz exportieren
identify-axis-of-file = gemessen an Achse { $name }
identify-setpoint-response = ist der Führungsfrequenzgang eines geschlossenen Regelkreises (etwa 1 bei kleinen Frequenzen): er zeigt den Regelkreis, nicht die Mechanik; die Regelstrecke des Drehzahlreglers messen (Momentensollwert zu Drehzahlistwert), oder --input angeben, wenn das nicht stimmt
identify-twincat-heads = der Kopfblock hat keine Zeile Name mit { $wanted } Zellen wie die Zeile SampleTime[ms]; mit dem Kopf in der Datei exportieren
identify-twincat-scaled = Kanäle mit Skalierungsfaktor: als skaliert exportiert angenommen („Scale values before export“)
identify-uff-broken = pyuff kann das Universal File nicht lesen: { $reason }
identify-uff-nothing = kein Frequenzgang und kein Zeitsignal im Universal File (Funktionstypen { $found }); Dataset 58 mit Funktionstyp 4 exportieren
identify-loudest-axis = { $name } wird benutzt, die Richtung, die am stärksten schwingt
identify-no-period = die erste Zeile muss die Abtastzeit nennen, steht dort: „{ $got }“

identify-too-few-samples = { $got } Abtastwerte, es müssen mindestens { $least } sein
identify-no-sample-time = die Datei nennt keine Zeiten; --columns "sample_time=1 ms" angeben (mit der eigenen Zeit)
identify-time-does-not-rise = die Zeit geht von { PLAIN($before, digits: 9) } s auf { PLAIN($after, digits: 9) } s; sie muss steigen: sind Spalten vertauscht oder die Zeiten mit zu wenigen Stellen gedruckt?
identify-step-out-of-range = { PLAIN($step) } s zwischen den Abtastwerten, so wird keine Achse abgetastet; die Einheit der Zeitspalte prüfen
identify-uneven = ein Schritt von { PLAIN($got) } s bei { PLAIN($at, digits: 6) } s, wo { PLAIN($usual) } s üblich sind: Abtastwerte fehlen; ohne Lücken aufzeichnen
identify-resampled = der Takt ist um { SHARE($spread) } ungleichmäßig; die Signale wurden auf einen Schritt von { TIME($step) } interpoliert
identify-clipped = { $name } läuft an { $count } Stellen auf { PLAIN($end, digits: 6) } und bleibt dort ({ SHARE($share) } der Werte): übersteuert oder begrenzt; mit weniger Anregung oder größerem Messbereich neu aufzeichnen
identify-unit-slip = { $name } ist das { PLAIN($ratio) }-Fache der Ableitung dessen, was derselbe Sensor sonst zeigt; eine der beiden Einheiten ist falsch
identify-fewer-lines-than-needed = { $got } Frequenzlinien, es müssen mindestens { $least } sein
identify-frequency-does-not-rise = die Frequenz geht von { PLAIN($before, digits: 9) } Hz auf { PLAIN($after, digits: 9) } Hz; sie muss steigen: ist eine andere Spalte die Frequenz (--columns frequency_hz=SPALTE)?
identify-frequency-out-of-range = Linien von { PLAIN($first) } bis { PLAIN($last) } Hz; die letzte muss zwischen { PLAIN($least) } und { PLAIN($most, digits: 9) } Hz liegen; ihre Einheit und die Reihenfolge der Spalten prüfen
identify-coherence-out-of-range = eine Kohärenz von { PLAIN($got) }, sie muss zwischen 0 und 1 liegen; sind Spalten vertauscht?
identify-all-zero = alle Werte sind null; neu aufzeichnen
identify-rising = der Frequenzgang steigt gegen die Lage um { PLAIN($slope, digits: 2) } Dekaden je Dekade, wie es keine Mechanik tut; sind Ein- und Ausgang vertauscht, oder ist der Ausgang ein anderer als angegeben (--output)?
identify-perfect-coherence = die Kohärenz ist in jeder Linie 1, wie bei einer einzigen Mittelung: sie sagt nichts und wird nicht benutzt

identify-signal-force = { word-force }
identify-signal-torque = Drehmoment
identify-signal-current = Strom
identify-signal-reference = Sollwert
identify-signal-position = Lage
identify-signal-velocity = Geschwindigkeit
identify-signal-acceleration = Beschleunigung
identify-no-unit = keine Einheit
identify-column-found = { $place }: { $name } [{ $unit }] ist { $what }
identify-columns-unknown = Spalten sind nicht klar: { $found }; anzugeben: { $missing }
identify-response-unknown = ein Frequenzgang mit der Einheit „{ $found }“ ist nicht klar; anzugeben: { $missing }
identify-missing-output = welche Spalte die Bewegung ist: --columns "encoder=SPALTE [mm]" (oder tcp, velocity, acceleration)
identify-missing-input = welche Spalte { word-force } enthält: --columns "force=SPALTE [N]" (oder torque, current), oder die Spalten, die zählen, wenn es keine gibt
identify-missing-sensor = wo gemessen wurde: --sensor encoder oder --sensor tcp (oder DATEI@tcp)
identify-say-input = was anregt: --input force, torque, current oder acceleration
identify-say-output = was gemessen wurde: --output position, velocity oder acceleration
identify-say-constant = --constant, { word-force } je Ampere (in N/A oder N m/A), aus dem Datenblatt des Motors
identify-current-without-constant = ein Strom (Spalten { $found }); --constant angeben, { word-force } je Ampere (in N/A oder N m/A), aus dem Datenblatt des Motors
identify-column-contradicts = { $name } hat die Einheit { $unit }, eine Einheit für { $signal }: sind Spalten vertauscht, oder ist die Einheit falsch?
identify-rotary-on-linear = der Frequenzgang gehört zu einem drehenden Motor, die Achse des Profils ist linear; drive.lead angeben (Weg je Umdrehung) oder { word-force } und Weg auf die Achse umrechnen
identify-linear-on-rotary = der Frequenzgang gehört zu einer linearen Bewegung, die Achse des Profils dreht
identify-motor-to-axis = vom Motor auf die Achse umgerechnet mit { PLAIN($turn, digits: 6) } rad des Motors je Meter
identify-sensor-assumed = { $name }: als Lagegeber des Motors angenommen, da nichts anderes angegeben ist (--sensor)
identify-not-collocated = bei { PLAIN($frequency) } Hz bewegt sich die Eigenform der Anregung entgegen ({ PLAIN($share) } vom Anteil des starren Körpers), was der Lagegeber eines Motors nie zeigt: Sitzt der Sensor an der Last? Angeben, wo er sitzt: --sensor tcp oder DATEI@tcp an Last oder Werkzeug, --sensor encoder, wenn es doch der eigene Lagegeber des Antriebs ist
identify-unit-assumed = die Einheit des Frequenzgangs („{ $found }“) nennt keinen Maßstab: als SI angenommen; ein falscher Faktor zeigt sich in der Masse
identify-si-assumed = keine Einheit in der Datei, als SI angenommen: { $names }
identify-ignored = nicht benutzte Spalten: { $names }
identify-set-force = { $name } ist ein { word-force-before }sollwert: die Verzögerung des Stromreglers ist Teil der gefundenen Totzeit

identify-no-motion = keine Bewegung unter den Spalten { $found }, oder sie steht still
identify-no-excitation = { word-force } bleibt gleich (Spalten { $found }); die Achse anregen
identify-incoherent = Ein- und Ausgang haben nichts miteinander zu tun (Kohärenz unter 0,3; Spalten { $found }); stärker anregen oder prüfen, welche Spalten es sind
identify-nothing-rings = ohne { word-force }, und nichts schwingt aus (Spalten { $found }); { word-a-force } aufzeichnen oder die Aufzeichnung erst lange nach der Bewegung enden lassen
identify-by-blows = geschätzt aus { $count } Schlägen von je { TIME($duration) }
identify-not-died-away = beim nächsten Schlag waren noch { SHARE($share) } einer Antwort übrig: die Dämpfung wird zu groß gelesen; zwischen den Schlägen länger warten
identify-single-blow = ein einziger Schlag: keine Kohärenz, die Intervalle kommen nur aus der Abweichung; fünfmal oder öfter schlagen
identify-by-periods = geschätzt aus { $count } Perioden von { TIME($period) }, ohne Leckeffekt; Intervalle aus ihrer Streuung
identify-period-left-out = die erste Periode wurde weggelassen: der Einschwingvorgang war noch nicht abgeklungen
identify-by-welch = geschätzt nach Welch mit einem Fenster von { TIME($window) } (Linienabstand { FREQUENCY($spacing) }), { $segments } Abschnitten, so viel wert wie { PLAIN($averages, digits: 3) } unabhängige Mittelungen
identify-welch-too-coarse = Linien im Abstand { FREQUENCY($spacing) } sind zu grob für die schärfste Spitze, die { FREQUENCY($width) } breit ist: die Dämpfung wird zu groß gelesen; länger aufzeichnen
identify-joint-estimate = die aufgezeichnete Anregung wurde benutzt (gemeinsame Schätzung von Ein- und Ausgang): der geschlossene Regelkreis verfälscht den Frequenzgang nicht
identify-no-reference = keine Anregung aufgezeichnet: bei geschlossenem Regelkreis sind Linien mit kleiner Kohärenz ({ SHARE($share) } liegen unter 0,9) verfälscht; die Anregung mit aufzeichnen
identify-reference-silent = die aufgezeichnete Anregung ändert { word-force } in diesen Linien nicht und wurde nicht benutzt: bei geschlossenem Regelkreis sind Linien mit kleiner Kohärenz ({ SHARE($share) } liegen unter 0,9) verfälscht
identify-same-sensor = derselbe Sensor lieferte auch { $names }; der klarere Frequenzgang wird benutzt
identify-by-decay = freie Schwingung ab { TIME($start) }, { TIME($duration) } lang; ihre Eigenformen erklären { SHARE($explained) } davon; ohne { word-force } weder Masse noch Verstärkungen
identify-loop-in-decay = ein Sollwert wurde gefahren: das sind Schwingungen der Achse im geschlossenen Regelkreis, der ihre Dämpfung ändert
identify-by-power = { word-force } nicht aufgezeichnet, und nichts schwingt aus: als Spektrum genommen, das Frequenzen und Dämpfung gibt, weder Masse noch Verstärkungen
identify-hold = wenn { word-force } zwischen den Abtastwerten gehalten wird, wie es Antriebe tun, werden Verstärkungen oberhalb von { FREQUENCY($limit) } um mehr als 1 % zu klein gelesen; schneller abtasten, wenn dort Eigenformen liegen
identify-no-motor-acceleration = keine Beschleunigung des Motors unter { $found }; --input acceleration braucht sie neben einem Signal am Werkzeug: --columns "motor_acceleration=..." und DATEI@tcp
identify-unit-of = Einheit „{ $got }“; nötig ist eine von { $units }
identify-not-there = „{ $got }“ angegeben, die Datei enthält es nicht; es gibt { $found }
