either = { $first } oder { $last }

option-between = { $got } angegeben, muss zwischen { $least } und { PLAIN($most, digits: 12) } liegen
option-not-positive = { $got } angegeben, muss > 0 { $unit } sein
option-no-such-move = { $got } angegeben, das Profil hat die Bewegungen 1 bis { $count }
option-force-below-static-load = { PLAIN($force, digits: 6) } { $unit } angegeben, muss über dem liegen, was statische Last und Reibung nehmen: { PLAIN($load, digits: 6) } { $unit }
option-given-twice = { $name } ist { $count }-mal angegeben; jeden Zustand oder Ausgang einmal angeben
option-final-time-is-found = gehört zu --kind damping; eine zeitoptimale Steuerung findet ihre Endzeit selbst
option-jerk-of-what-follows = gehört zu --kind time, --method exact und drive.kind = "position_source"; hinter einem Regelkreis begrenzt die Zeitkonstante des { word-force-before }regelkreises den Ruck
option-jerk-all-but-jumps = mit { PLAIN($jerk, digits: 6) } { $unit } erreicht die Beschleunigung ihre Grenze in { TIME($ramp) }, so gut wie sofort; ohne --jerk springt sie
option-bounds-need-transcription = Schranken an einer dämpfungsoptimalen Steuerung brauchen --method transcription
option-step-or-distance = verträgt sich nicht mit --velocity-step; eines von beiden angeben
option-no-signal = kein Zustand oder Ausgang { $got }{ $hint }

file-folder-not-writable = dort kann nicht geschrieben werden ({ $reason }); mit -o einen anderen Ordner angeben
file-above = { $place } ist eine Datei
file-no-right = kein Recht, in { $folder } zu schreiben
file-is-folder = ist ein Ordner; einen Dateinamen angeben
file-without-folder = es gibt keinen Ordner { $folder }; ihn erst anlegen oder einen anderen Namen angeben
file-not-writable = diese Datei kann nicht geschrieben werden ({ $reason }); einen anderen Namen angeben
file-is-input = wird von diesem Befehl auch gelesen; einen anderen Namen angeben
file-named-twice = ist für zwei Ergebnisse genannt; jedem eine eigene Datei geben
file-write-protected = ist schreibgeschützt; einen anderen Namen angeben oder das Schreiben erlauben

cli-no-profile = kein Profil angegeben; eine TOML-Datei angeben
cli-no-record = keine Ergebnisdatei angegeben; das record.json eines Laufs angeben, oder --control ? für die Liste
cli-file-exists = gibt es schon; einen anderen Namen angeben
print-boxes = sheet.pdf hat keine Zeichen für { $characters } und druckt Kästchen dafür; sheet.html zeigt sie, oder den Namen in lateinischen, griechischen oder kyrillischen Buchstaben schreiben
cli-interrupted = abgebrochen; jede Datei ist ganz: wie zuvor oder, wenn sie gerade geschrieben wurde, neu
cli-no-epoch = "{ $got }" angegeben, muss Sekunden seit 1970 sein; sonst die Variable löschen
cli-file-system = Standardausgabe oder Arbeitsordner
cli-internal-error = interner Fehler, bitte mit dem Profil einsenden: { $error }
cli-written = geschrieben: { $files }
cli-written-into = geschrieben in { $folder }: { $files }
cli-next-run = weiter: mtcommission run { $profile }
cli-next-export = weiter: mtcommission export { $record } --control { $control }
cli-list-of-controls = (--control ? nennt die Steuerungen)
cli-failed-cases = { $count } gescheitert

stage-optimal-controls = optimale Steuerungen
stage-feedback-loop = Regelkreis
stage-responses = Zeitverläufe und Faustregeln
stage-attainable = was einzuhalten wäre
stage-machining-modes = Bearbeitungsarten
stage-improvements = mögliche Verbesserungen
stage-sheet = Blatt
stage-response = Zeitverlauf

# Gains of the loop, as the profile names them
simulated-ramp-of-a-cycle = Die Rampe a/j = { TIME($ramp, digits: 3) } ist kürzer als der Lagetakt, in dem eine Steuerung ihren Sollwert sendet: simuliert mit einer Rampe von einem Takt, { TIME($cycle, digits: 3) }.
option-jerk-needed = die Steuerung begrenzt den Ruck, der zu prüfende Grenzwert ist also nötig, z. B. --jerk 100m/s^3
simulated-without-filter = Ohne Sollwertfilter simuliert: Das Profil lässt ihn offen (auto). Mit control.setpoint_filter angeben, hinter welchem beurteilt werden soll.
simulated-with-loop = Regelkreis, Fehlendes eingestellt: Kv { RATE($Kv) }, Kp { DAMPING($Kp) }, Tn { TIME($Tn) }.
simulated-with-filters = Filter im { word-force-before }sollwert: { $filters }.
simulated-without-loop = Gesteuerte Achse: es gibt keinen Regelkreis einzustellen.

# Ein Aufruf, der zu den Befehlen nicht passt.
usage-see = { $wrong }; siehe { $command } --help
usage-missing = { $what } fehlt
usage-no-option = die Option { $got } gibt es nicht{ $hint }
usage-no-command = diesen Befehl gibt es nicht; es gibt: { $names }
usage-there-are = { " " }(es gibt: { $names })
usage-value = { $option } nimmt nur dort einen Wert, wo --help einen zeigt
usage-number = { $option } muss eine ganze Zahl sein
usage-too-many = mehr Dateien oder Namen, als der Befehl nimmt
option-form = „{ $got }“ angegeben, muss { $form } sein
option-one-of = „{ $got }“ angegeben, muss eines davon sein: { $allowed }
