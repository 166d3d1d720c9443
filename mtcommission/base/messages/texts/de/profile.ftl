hint-did-you-mean = ; ist „{ $name }“ gemeint?
hint-there-are = ; es gibt { $names }
hint-moves-header = ; die Überschrift als [[moves]] schreiben
hint-key = ; einen Schlüssel nennen, wie Meldungen ihn schreiben
a-table = eine Tabelle
a-date = ein Datum oder eine Uhrzeit
a-huge-integer = eine ganze Zahl jenseits aller Grenzen

file-missing = diese Datei gibt es nicht; den Namen prüfen
file-is-directory = ist ein Ordner; ein Profil (.toml) darin nennen
file-unreadable = nicht lesbar: { $reason }
file-too-large = ist größer als { PLAIN($most, digits: 9) } Byte; das ist keine solche Datei
file-binary = ist eine Binär- oder UTF-16-Datei; das Profil als UTF-8-Text speichern
file-is-json = ist JSON wie die Ergebnisdatei eines Laufs; das Maschinenprofil (.toml) angeben, oder sie an sheet oder export
file-not-utf8 = Byte { $byte } ist kein UTF-8; das Profil als UTF-8-Text speichern
file-empty = ist leer; von einem mitgelieferten Profil ausgehen (mtcommission profiles list)
profile-unknown = kein mitgeliefertes Profil { $got }{ $hint }

toml-nested-deeply = ist zu tief verschachtelt; ein Profil braucht höchstens drei Ebenen
toml-refused = kein TOML: { $got } ; diese oder die Zeile davor berichtigen: Texte und Werte mit Einheit stehen in Anführungszeichen, Zahlen haben einen Punkt, jede Klammer wird geschlossen, und jeder Schlüssel steht nur einmal

key-unknown = unbekannter Schlüssel{ $hint }
key-misspelt = unbekannter Schlüssel; ist „{ $meant }“ gemeint, das fehlt?
key-not-stated = „{ $got }“ angegeben, das hier nicht steht{ $hint }
key-missing = fehlt; { $remedy }
add-schema = schema = 1 ergänzen
add-value = den Wert Ihrer Maschine ergänzen, zum Beispiel { $key } = { $example }
add-table = eine Tabelle { $header } ergänzen
add-kind-of-keys = kind = "{ $kind }" ergänzen, zu dem die übrigen Schlüssel gehören

got-other-word = { $got } angegeben, muss { $words } sein{ $hint }
got-no-text = { $got } angegeben, muss ein Text in Anführungszeichen sein
got-no-signals = { $got } angegeben, muss eine Tabelle von Signalen sein
got-no-signals-or-word = { $got } angegeben, muss { $words } oder eine Tabelle von Signalen sein
# $words: was statt einer Tabelle stehen darf
got-no-filter = { $got } angegeben, muss { $words } oder eine Tabelle mit kind sein
got-no-quantity = { $got } angegeben, { $expected }
got-infinite = { $got } angegeben, muss eine endliche Zahl sein
array-too-short = { $length } Elemente angegeben, mindestens { $least } nötig
array-too-long = zu viele Elemente angegeben, höchstens { $most } erlaubt
text-too-long = { $length } Zeichen angegeben, höchstens { $most } sind erlaubt
text-with-control-characters = Steuerzeichen angegeben; sie entfernen
name-no-identifier = „{ $got }“ angegeben, müssen Buchstaben, Ziffern und _ sein, nicht mit einer Ziffer am Anfang
name-empty = leerer Text angegeben, einen Namen nennen
no-such-signal = kein solches Signal{ $hint }
or-word = { $what }, oder "{ $word }"
must-be-above = { $got } angegeben, muss > { PLAIN($bound, digits: 6) }{ $unit } sein
must-be-at-least = { $got } angegeben, muss >= { PLAIN($bound, digits: 6) }{ $unit } sein
must-be-between = { $got } angegeben, muss zwischen { PLAIN($low, digits: 6) } und { PLAIN($high, digits: 6) }{ $unit } liegen; die Einheit prüfen

static-load-takes-all = { $got } gegen { word-max-force } = { $most } angegeben; der Betrag muss kleiner sein, sonst bleibt nichts für die Bewegung
friction-takes-all = { $got } angegeben, muss unter dem liegen, was { word-max-force } neben static_load lässt: { PLAIN($left, digits: 6) } { $unit }
move-with-neither = weder velocity_step noch distance angegeben, genau eines angeben
move-with-both = velocity_step und distance angegeben, genau eines angeben
max-velocity-without-distance = gehört zu einer Bewegung mit distance; distance angeben oder den Schlüssel entfernen
frequency-spread-large = { $got } angegeben, muss zwischen 0 und 0,5 (50 %) liegen
damping-spread-beyond-one = { $got } angegeben, das hebt einen Dämpfungsgrad im ungünstigsten Eckfall auf { PLAIN($largest, digits: 3) }; muss < 1 bleiben; höchstens { PLAIN($allowed, digits: 3) } ({ PLAIN($allowed, digits: 3, unit: "%") } %) angeben
payload-reversed = { $first } bis { $last } angegeben, die kleinste kommt zuerst
cycle-no-multiple = { $got } angegeben, das { PLAIN($ratio, digits: 6) }-Fache von velocity_cycle = { $velocity_cycle }; muss ein ganzes Vielfaches sein

lead-of-rotary-axis = eine Rundachse hat keine Steigung; entfernen und drive.gear angeben (Motorumdrehungen je Umdrehung der Achse)
gear-without-lead = ein Getriebe an einer Linearachse braucht drive.lead (Weg je Umdrehung von Spindel oder Ritzel) daneben; beide angeben oder den Schlüssel entfernen
contour-feed-without-deviation = gehört zu contour_deviation; das angeben oder den Schlüssel entfernen
control-closes-elsewhere = { $got } angegeben; kind = "{ $control }" schließt den Lageregelkreis anders: { $has } schreiben oder den Schlüssel weglassen
control-without-feedforward = { $got } angegeben; kind = "{ $control }" hat nur { $has }; 0 schreiben oder den Schlüssel weglassen
# $has: vorhandene Arten und das Wort für keines
control-without-filter = { $got } angegeben; kind = "{ $control }" hat keinen solchen Sollwertfilter: { $has } schreiben
filter-key-missing = fehlt: ein Filter mit kind = "{ $kind }" braucht diesen Wert
filter-key-unused = bedeutet bei einem Filter mit kind = "{ $kind }" nichts: entfernen
filter-taps-sum = die Summe der Koeffizienten ist { PLAIN($sum, digits: 6) } und muss 1 sein, sonst käme die Achse nicht ans Ziel: jeden durch die Summe teilen
filter-without-end = { $got } angegeben: hinter einem solchen Filter endet ein Sollwert nie, daher ließe sich weder eine Einschwingzeit noch ein Beweis für jede Größe der Bewegung angeben; eine andere Art wählen, oder "none" mit ausgeschaltetem Filter in der Steuerung
control-with-fewer-filters = { $got } Filter angegeben; kind = "{ $control }" hat { $most } im Momentensollwert; nicht mehr angeben
delay-below-drive = { $got } angegeben; ein Antrieb, der den Lageregelkreis schließt, kennt keinen neueren Sollwert als den vor zwei Lagereglertakten: mindestens { PLAIN($least, digits: 6) } s schreiben oder den Schlüssel weglassen
waits-long = lässt den Sollwert { TIME($delay) } warten, das sind { ROUND($cycles, digits: 3) } Lagereglertakte von { TIME($cycle) }; höchstens { $most } sind erlaubt: Einheit prüfen oder einen längeren control.position_cycle angeben

# Motor folgt dem Sollwert. $drive: Art des Antriebs, zu der der Schlüssel gehört
key-of-other-drive = gehört zu drive.kind = "{ $drive }"; entfernen, oder diese Art von Antrieb angeben
curve-does-not-rise = jede Geschwindigkeit muss größer als die vorige sein
key-without-other = sagt allein nichts: { $other } daneben angeben oder den Schlüssel entfernen
motor-held-needs-modes = zu drive.kind = "position_source" gehört kind = "modal", mit den Frequenzen der Eigenformen bei festgehaltenem Motor
no-loop-to-set = drive.kind = "position_source" hat keinen Regelkreis: der Motor folgt dem Sollwert; den Schlüssel entfernen
acceleration-weighed = das Funktional wichtet das Quadrat der Soll-Beschleunigung schon mit 1, und F ist dieselbe; das Gewicht entfernen und die übrigen durch 1 plus dieses teilen
payload-of-position-source = ein Motor, der dem Sollwert folgt, bewegt jede Zuladung gleich, aber jede hat eigene Frequenzen: den Schlüssel entfernen und requirements.frequency_spread weiten
move-beyond-motor = { $got } angegeben, der Motor folgt aber nur { PLAIN($limit, digits: 6) } { $unit }, nach drive.max_velocity, step_rate mal step_length oder dem Ende von acceleration_curve

example-about = { $name }, Achse { $axis_name } ({ $motion ->
    [rotary] drehend
   *[linear] linear
}; Eigenformen bei { $modes })
control-lacks = kind = "{ $control }" hat das nicht: { $what }; den Schlüssel weglassen
control-filter-range = { $got } angegeben; kind = "{ $control }" nimmt hier { $low } bis { $high }
