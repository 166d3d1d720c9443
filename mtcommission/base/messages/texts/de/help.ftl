# Was --help sagt: zu jedem Befehl und Parameter; Englisch steht, wo sie erklärt sind.

help-usage = Aufruf
help-options = Optionen
help-options-placeholder = [OPTIONEN]
help-arguments = Argumente
help-commands = Befehle
help-commands-placeholder = BEFEHL ...
help-required = [nötig]
help-default = { "[Vorgabe: " }
help-help = Diesen Text zeigen.
help-program = Grenzen von Beschleunigung und Ruck für Achsen von Werkzeugmaschinen, aus dem mechanischen Modell.
help-program-more = Vom Datenblatt zu den Werten für die Steuerung: wizard, run, export.
help-exit-codes = Rückgabewerte: 0 fertig und alle Anforderungen erfüllt, 1 eine Anforderung ist nicht erfüllt, 2 falsche Eingabe, 3 eine Rechnung endete mit benanntem Ergebnis, 130 mit Strg-C abgebrochen.
help-version = Version.
help-language = Sprache der Ausgabe; Vorgabe: LANG der Umgebung, sonst en.

# Was mehrere Befehle haben
help-profile = Maschinenprofil (TOML).
help-record = record.json eines Laufs; export und verify nehmen auch group.json.
help-output = Ordner.
help-json-file = Ergebnis als JSON schreiben; - für den Bildschirm.
help-csv-file = Bewegung als CSV schreiben; - für den Bildschirm.
help-f-max = Kraftgrenze für diesen Aufruf, z. B. 2kN.
help-sizes = Größen der Bewegung, für die die Grenzwerte gelten.
help-no-pdf = Das PDF weglassen.
help-appendix = Auch die Nachweise drucken; im HTML stehen sie immer.
help-columns = Unser Name zu einem der Datei.
help-constant = Kraft oder Drehmoment je Ampere [N/A, N m/A].
help-move = Welche Bewegung des Profils.
help-limit = Z. B. v_phi=5mrad/s; mehrfach möglich.

help-wizard = Nach der Maschine fragen und ein kommentiertes Profil schreiben.
help-wizard-output = Profil, das geschrieben oder geändert wird.
help-answers = Antworten (TOML, mit den Schlüsseln des Profils).
help-yes = Für Offenes die Vorgaben nehmen, statt zu fragen.
help-run-after = Danach gleich run.

help-identify = Aus gemessenen Frequenzgängen Masse, Verzögerung und Eigenformen eines Profils.
help-identify-more = Liest Tabellen von Frequenzgängen und Signalen, Dateien von SINUMERIK, TwinCAT, LinuxCNC, Klipper und UFF. Klippers resonances_x_... und resonances_y_... zugleich: NEW-x.toml und NEW-y.toml.
help-files = Messungen; FILE@tcp, FILE@encoder, FILE@RESPONSE.
help-identify-profile = Profil, das die Eigenformen aufnimmt.
help-identify-output = Profil, das geschrieben wird.
help-sensor = Wo der Sensor sitzt.
help-input = Was die Achse anregt.
help-measured = Was er zeigt.
help-band = Linien für die Anpassung [Hz]; Vorgabe: wird gewählt.
help-modes = Anzahl der Eigenformen.
help-tool-ratio = Überhöhung am Werkzeug durch Überhöhung am Motor, falls bekannt.
help-force = Ein Profil auch schreiben, wenn kein Modell passt, mit Vermerk.
help-page = Gemessenes über dem Modell, als Seite.

help-check = Ein Profil prüfen; Eigenformen, Grenzen des starren Körpers und Warnungen zeigen.
help-schema = Stattdessen das JSON-Schema der Profile zeigen.

help-run = Grenzwerte berechnen; Datensatz, Blatt und Sollwert schreiben.
help-run-more = DIR bekommt record.json, sheet.html, sheet.pdf und für jede Bewegung eine setpoint.csv.

help-limits = Beschleunigung und Ruck empfehlen, Faustregeln daneben.
help-limits-page = Nur eine Seite zum Probieren von Werten, ohne den Rest.

help-optimal = Eine optimale Steuerung berechnen.
help-kind = Was möglichst klein wird.
help-t-f = Endzeit (damping), z. B. 52.2ms.
help-velocity-step = Bewegung anstelle derer des Profils.
help-distance = Bewegung anstelle derer des Profils.
help-method = Exakt mit Beweis, oder auf einem Gitter ohne (nötig für damping mit --limit).
help-scheme = Transkription: euler, trapezoidal oder gauss.
help-intervals = Transkription: Intervalle.
help-jerk = Ruckgrenze einer Achse ohne Regelkreis.

help-simulate = Einen Sollwert durch den Regelkreis schicken und bewerten.
help-simulate-more = Der Regelkreis ist der des Profils, was immer probiert wird.
help-acceleration = Z. B. 2m/s^2.
help-simulate-jerk = Z. B. 100m/s^3; nötig, wo die Steuerung den Ruck begrenzt.
help-setpoint-filter = Länge eines gleitenden Mittelwerts, z. B. 20ms; Shaper mit Frequenz und Dämpfungsgrad, z. B. zvd:40Hz:0.05; none.
help-simulate-move = Nur diese Bewegung des Profils, ab 1 gezählt; sonst alle.
help-size = Ihr Weg oder Geschwindigkeitssprung.
help-payload = Einer weiteren Maschine, z. B. 50kg.
help-frequency-error = Dieser Maschine, z. B. 7%.

help-export = Die Grenzwerte in den Namen und Einheiten einer Steuerung schreiben.
help-export-more = Text zum Eintippen von Hand, zu prüfen; an eine Steuerung wird nichts gesendet.
help-control = Z. B. sinumerik; ? zeigt alle.
help-export-output = - für den Bildschirm.
help-as-csv = Stattdessen eine Liste der Parameter zum Abhaken.

help-sheet = Das Blatt noch einmal drucken, allein aus dem Datensatz.
help-compare = Früheres record.json: sagt, was sich geändert hat.
help-verified = Von verify: trägt ein, was gemessen wurde.

help-verify = Aufgezeichnete Bewegungen neben der Vorhersage: stimmt sie, und warum nicht.
help-verify-more = Sagt zuerst, ob die Steuerung gesendet hat, was eingegeben war. Liest, was identify liest.
help-traces = Aufgezeichnete Bewegungen oder Kreise.
help-renewed = Profil, wie es die Aufzeichnungen zeigen.
help-verify-output = Ordner für die Seite.

help-sweep = Viele Fälle berechnen; eine Tabelle und eine Seite schreiben.
help-sweep-more = RANGE ist START:STOP:COUNT, log:START:STOP:COUNT, random:LOW:HIGH:COUNT:SEED oder eine Liste mit Kommas. Mehrere ergeben ein Gitter. DIR bekommt rows.parquet, rows.csv und sweep.html.
help-sweep-f-max = Z. B. 0.5kN:4kN:100, log:300:20e3:50.
help-vary = Z. B. plant.slider_mass=600:900:7.
help-cases = CSV: Schlüssel, dann ein Fall je Zeile.
help-paired = Bereiche gehen miteinander statt jeder mit jedem.
help-quantity = Was berechnet wird.
help-sweep-limit = Für optimal, z. B. v_phi=5mrad/s oder v_phi=4mrad/s:20mrad/s:9.
help-workers = Prozesse; 0: einer je Kern.
help-scheduler = Dask, z. B. tcp://host:8786.
help-resume = Fortsetzen, was in DIR liegt.

help-validate = Die Zahlen und Aussagen der Veröffentlichung neben unsere stellen.
help-validate-more = Rückgabewert 1, wenn eine außerhalb ihrer Toleranz liegt.
help-validate-all-rows = Jede Zeile, nicht nur was nicht wie gedruckt stimmt.
help-validate-output = validation.html dorthin schreiben.

help-profiles = Die mitgelieferten Beispielmaschinen.
help-profiles-list = Die Beispielmaschinen mit der Herkunft ihrer Zahlen zeigen.
help-profiles-show = Eine Beispielmaschine ausgeben.
help-profiles-copy = Eine Beispielmaschine als Anfang kopieren; überschreibt nie eine Datei.
help-name = Aus profiles list.
help-file = Vorgabe: NAME.toml hier.

help-group = Achsen, die zusammen fahren: ein Filter, eine Verzögerung, Grenzwerte; Kreis und Ecke.
help-group-more = DIR bekommt group.json, sheet.html und sheet.pdf.
help-profiles-of-axes = Profil jeder Achse, zwei oder drei.
help-tolerance = Größte Konturabweichung, z. B. 10um; Vorgabe: die kleinste der Profile.
help-plane = Die Achsen der Kreise und Ecken, z. B. XY.
help-feed = Schnellster Vorschub für Konturen, z. B. 6m/min.
help-radius = Eines Kreises, der dabei die Toleranz hält, z. B. 10mm.
