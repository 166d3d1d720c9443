# The commissioning sheet, and the summary on the terminal.

## The printers' own words

title = Inbetriebnahmeblatt
axis = Achse
identity = Profil { $name }, SHA-256 { $hash }
disclaimer = Berechnetes Blatt, keine Abnahmeprüfung.
contents = Inhalt
skip = Zum Inhalt springen
page = Seite
appendix = Anhang
script-note = Diagramme: Ziehen vergrößert, Doppelklick setzt zurück, Zeiger oder Pfeiltasten zeigen Werte.

## Words

yes = ja
no = nein
met = erfüllt
not-met = NICHT ERFÜLLT
not-settled = nicht eingeschwungen
unlimited = unbegrenzt
no-jerk-limit = ohne Grenze
setpoint-filter = Sollwertfilter
no-setpoint-filter = keiner
# $kind: des Sollwertfilters; $shaper: sein Name in Großbuchstaben; $count: der Koeffizienten
filter-name = { $kind ->
    [moving_average] gleitender Mittelwert
    [two_moving_averages] zwei gleitende Mittelwerte
    [fir] FIR mit { $count } Koeffizienten
   *[other] Shaper { $shaper }
}
filter-of-length = Filterlänge
filter-of-second-length = Zweite Filterlänge
filter-of-frequency = Filterfrequenz
filter-of-damping = Dämpfungsgrad des Filters
none = Keine.
move = Bewegung{ "\u00A0" }{ $number }
velocity-step = Geschwindigkeitssprung { $velocity }
positioning = Positionieren um { $distance }
positioning-limited = Positionieren um { $distance } mit höchstens { $velocity }
in-unit = { $name } in { $unit }
quantity = Größe
value = Wert
key = Schlüssel im Profil
source = Quelle
acceleration = Beschleunigung
jerk = Ruck
jerk-time = Ruckzeit
settling-time = Einschwingzeit
residual = Restabweichung
peak-deviation = Größte Abweichung
time = Zeit
velocity = Geschwindigkeit

## Verdict

verdict-heading = Ergebnis und einzugebende Werte
verdict-met = Alle Anforderungen erfüllt
as-typed = Einzugeben ist die Beschleunigung { $acceleration }; was dieses Blatt daneben zeigt, gilt für die der Rechnung, { $wanted }.
verdict-incomplete = Erfüllt, ABER UNVOLLSTÄNDIG
verdict-missed = Anforderungen so eingegeben NICHT erfüllt
verdict-not-met = Anforderungen NICHT erfüllt
values-bound-by = Begrenzt durch: { $bound }
# $data: their names; another-gives: $change and what it would $given
assumed-binds = Was begrenzt, beruht auf einem angenommenen Wert ({ $data })
another-gives = . { $change }: { $given }.
another-unknown = : ihn angeben.
obstacle = Begrenzende Anforderung: { $obstacle }
what-they-give = Eingeschwungen nach { $settling }, Restabweichung { $residual } (angegebene Bewegungen, ungünstigster Fall).
today = Heute
now-and-then = Einschwingzeit / Restabweichung: jetzt { $now }, dann { $then }.
now-no-result = kein Ergebnis (siehe Warnung)
holds-caption = Wofür sie gelten
basis-caption = Worauf das beruht (angenommen: weder angegeben noch gemessen)
basis-data = Maschinendaten
basis-assumed = Angenommen
measured-modes = { $modes }; am { $date }, Intervalle in sheet.html
measured-nothing = { $source }; an dieser Maschine wurde nichts gemessen
assumed-more = { $names } und { $count } weitere
payload-from-to = { $low } bis { $high }
basis = Was
basis-damping = Dämpfungsgrade
basis-sizes = Größen der Bewegung
assumed-of = { $value } (angenommen: { $names })
assumed = { $value } (angenommen)
spread = beurteilt bei ± { SHARE($spread) }
spread-none = beurteilt wie angegeben, ohne Streuung
all-kept-between = alles eingehalten von { $low } bis { $high }
not-kept-nominally = Anforderungen schon wie angegeben nicht eingehalten
reserve-kept = { $axis ->
    [rotary] Empfehlungen nutzen höchstens { SHARE($band) } des Bandes, { SHARE($force) } des Drehmoments
   *[linear] Empfehlungen nutzen höchstens { SHARE($band) } des Bandes, { SHARE($force) } der { word-force }
}
position-loop-at = { $place ->
    [none] gesteuerte Achse ohne Lageregler; simuliert alle { $position_cycle }
    [control] Lageregler in der Steuerung, { $position_cycle }; Geschwindigkeitsregler { $velocity_cycle }
    [interpolated] Lageregler in der Steuerung, { $position_cycle }; Vorsteuerung interpoliert, { $velocity_cycle }
   *[drive] Lageregler im Antrieb (DSC), { $velocity_cycle }; Sollwert { $position_cycle }
}
judged-in-motion = Fährt das Werkzeug eine Bahn ab, zählt: { $requirements }; muss es am Ende stillstehen: die Restabweichung.
# $feed: up to which velocity it counts, or none
judged-to-feed = { $requirement }{ $feed ->
    [none] { "" }
   *[other] { " bis " }{ $feed }
}
judged-at-rest = Beurteilt ab dem Stillstand. Vorher weicht das Werkzeug bis { $peak } ab: für Bahnen im Profil angeben: { $keys }.
encoder-steps = { $axis ->
    [rotary] Stufen von { $resolution } bewegen das Werkzeug bis ± { $tool }, das Sollmoment bis ± { $force }
   *[linear] Stufen von { $resolution } bewegen das Werkzeug bis ± { $tool }, die Soll{ word-force-behind } bis ± { $force }
}
share-used = Genutzt
yes-without-reserve = ja, Reserve verbraucht
met-without-reserve = erfüllt, Reserve verbraucht
reference = { $move }: zeitoptimaler Vergleichswert, exakte Ruhe: { $optimum }; empfohlen: { $compared ->
    [unsettled] nicht eingeschwungen
    [sooner] { $settling }, { $share } weniger, da am Band und nicht an exakter Ruhe gemessen
   *[later] { $settling } ({ $share } mehr)
}.
checks-caption = Anforderungen
checks-any-size-caption = Anforderungen, jede Größe der Bewegungen
warning-count = { $others ->
    [yes] Weitere Warnungen
   *[no] Warnungen
}: { $count }, siehe Anhang, Nachweise und Annahmen.
check = Anforderung
found = Ist
permitted = Zulässig
verdict = Urteil
where = Ungünstigster Fall
warning = Warnung: { $warning }
could-be-met = Erreichbar: { $requirement } { $value } statt { $limit }.

## Machine

machine-heading = Maschine und Achse
machine-row = Maschine
axis-row = Achse
linear = linear
modes-caption = Eigenformen der Struktur (ohne Regelung)
mode = Eigenform
of-mode = { $name } der Eigenform { $mode }
peak-bound = { $name }, größter Betrag
requirements-heading = Bewegungen und Anforderungen

## Limits

limits-heading = Grenzwerte je Bearbeitungsart, Beschleunigung und Ruck als Paare
machining-mode = Bearbeitungsart
machining-surface = Oberfläche (Schlichten)
machining-accuracy = Genauigkeit
machining-speed = Geschwindigkeit (Schruppen)
permitted-band = Band
bound-by-column = Begrenzt durch
# $band: that could be met, or none
mode-not-met = { $mode }: Mit diesem Band wurden keine Grenzwerte gefunden, die alle Anforderungen erfüllen{ $band ->
    [none] .
   *[other] ; erreichbar wäre ein Band von { $band }.
}
alternatives-caption = Grenzwerte nebeneinander, in derselben Simulation (ungünstigste Bewegung, ungünstigster Eckfall)
listed-short = Nur für die angegebenen Größen
limits-name = Grenzwerte
recommended = Empfohlen
rule-heading = Inbetriebnahmeregel, von Hand angewandt
rule-valid = Gültig für: { $range }
rule-result = Von Hand: a = { $acceleration }, j = { $jerk } ({ $chosen }; a begrenzt durch: { $bound }), vorhergesagte Restabweichung { $residual }, auch bei jeder kleineren Bewegung. Die Suche braucht keine Regel; diese dient zur Kontrolle mit dem Taschenrechner.
rule-steps-caption = Die Regel, Schritt für Schritt
rule-symbols-caption = Formelzeichen der Regel (Index i: eine Eigenform; Werte je Eigenform: { $modes })
rule-symbol-F = { $axis ->
    [rotary] Für die Bewegung verfügbares Drehmoment
   *[linear] Für die Bewegung verfügbare { word-force }
}
rule-symbol-v = Geschwindigkeitsänderung oder größte Geschwindigkeit jeder Bewegung
rule-symbol-L = { $axis ->
    [rotary] Winkel
   *[linear] Weg
} jeder Positionierbewegung
rule-symbol-m = { $axis ->
    [rotary] Bewegtes Trägheitsmoment; in der Momentenbedingung mit der größten Zuladung
   *[linear] Bewegte Masse; in der { word-force-before }bedingung mit der größten Zuladung
}
rule-symbol-m-ff = { word-mass } in der Vorsteuerung
rule-symbol-omega = Eigenkreisfrequenz
rule-symbol-g = Anteil einer Eigenform am Werkzeug, allein oder gegen den Lagegeber; der größere
rule-symbol-c = Anteil einer Eigenform am Lagegeber
rule-symbol-T-F = Länge des gleitenden Mittelwerts
rule-symbol-n = Beschleunigungsrampen: 2 beim Geschwindigkeitssprung, 4 beim Positionieren
rule-symbol-R = Schwingung nach einem Mittelwert, bezogen auf die nach einem einzelnen Anstoß
rule-symbol-x = Länge des Mittelwerts in Perioden einer Eigenform, f T_F
rule-symbol-i = Imaginäre Einheit (als Index: Nummer der Eigenform)
symbol = Zeichen
meaning = Bedeutung
meaning-with-doubt = { meaning }; (?): nicht nachgelesen
rule-step = Schritt
rule-how = Formel
rules-heading = Vergleich mit Faustregeln
rules-caption = Grenzen aus den Optima und Regeln von Herstellern und Lehrbüchern, in derselben Simulation (ungünstigste Bewegung, ungünstigster Eckfall)
rule = Regel
meets = Alles erfüllt

## Compared with another record

differences-heading = Änderungen seit dem früheren Blatt
compared-with = Verglichen mit: { $machine }, Achse { $axis_name }, berechnet am { $created }, Profil { $name }, SHA-256 { $hash }.
compared-other-axis = { $before } und { $after } sind verschiedene Achsen: keine Zeile unten ist eine Änderung an einer Achse.
changed-inputs = Maschine, Bewegungen und Anforderungen: was sich geändert hat
no-changed-inputs = Maschine, Bewegungen und Anforderungen sind auf beiden Blättern dieselben.
changed-gains = Die Verstärkungen passen zu Achse und Regelkreis; von dem, woran sie hängen, hat sich geändert: { $causes }.
changed-gains-by-moves = Von dem, woran die Reserven hängen, hat sich nichts geändert: Mit dem Übrigen dient ein anderer Regelkreis den Bewegungen am besten.
changed-outcome = Grenzwerte, Ergebnis und Regelkreis: was sich geändert hat
before = Vorher
after = Nachher
change = Änderung
changed = geändert
not-stated = nicht angegeben

## Motion

responses-heading = Zeitverläufe
responses-caption = { $move }: Sollwert, Werkzeugabweichung, { word-force }; Nennmaschine
yardstick-caption = { $axis ->
    [rotary] Bewegungen der Nennmaschine neben den kürzesten Zeiten, die das Drehmoment erlaubt (um so viel länger)
   *[linear] Bewegungen der Nennmaschine neben den kürzesten Zeiten, die die { word-force } erlaubt (um so viel länger)
}
move-head = Bewegung
exact-rest = Kürzeste Zeit, exakte Ruhe
within-band = Kürzeste Zeit, im Band
robust-short = Im Band über die Streuung
motions-heading = Optimum, Empfehlung und Antwort
drive-caption = { $move }: { word-force }, Beschleunigung und Geschwindigkeit
vibration-caption = { $move }: Schwingung und TCP-Abweichung
motion-note = Alle Diagramme einer Bewegung haben dieselbe Zeitachse. Optima enden bei t_f in exakter Ruhe; ihre Beschleunigung und die der Antwort ist F/m. Der Sollwert ist gezeigt wie vorgegeben; die Abweichung zählt gegen den um { $delay } verzögerten Sollwert.
constrained = zeitoptimal, beschränkt
setpoint = Sollwert
response = Antwort des Regelkreises
deviation = TCP-Abweichung
peaks-caption = { $move }: größte Beträge
signal-head = Signal
control = Steuerung

## Loop

loop-heading = Regelkreis: Reserven und Steifigkeit
loop-details-heading = Regelkreis, Einzelheiten
loop-why = Warum dieser Regelkreis:
gain-margin-at = Amplitudenreserve { $margin }
phase-margin-at = Phasenreserve { $margin }
filter-at = Filter bei { $frequency }
open-loop-measured = offener Kreis mit der gemessenen Achse ({ $file })
margins-caption = { $axis ->
    [rotary] Stabilität, Kreis am Sollmoment aufgetrennt
   *[linear] Stabilität, Kreis an der Soll{ word-force-behind } aufgetrennt
}
margin = Reserve
nominal = Nennmaschine
worst-corner = Ungünstigster Eckfall
gain-margin = Amplitudenreserve
gain-margin-up = Verstärkung darf steigen um
gain-margin-down = Verstärkung darf fallen um
loop-corners-caption = Der Regelkreis in jedem Eckfall von Zuladung und Streuung
disturbance-caption = { $axis ->
    [rotary] Antwort des Werkzeugs auf einen Momentensprung um die Achse des Antriebs
   *[linear] Antwort des Werkzeugs auf einen { word-force-before }sprung in der Wirklinie des Antriebs
}
deflection = { $axis ->
    [rotary] Drehung des Werkzeugs je Drehmoment
   *[linear] Auslenkung des Werkzeugs je { word-force }
}
delays-caption = Verzögerungen in jedem Pfad des Regelkreises
path = Pfad
setpoint-age = Alter des Sollwerts
dead-time = Totzeit (ganze Takte)
hold = Mittleres Alter des gehaltenen Werts
lag = Verzögerungsglieder (Antrieb, Filter)
total = Summe
phase-margin = Phasenreserve
sensitivity-peak = Maximum der Empfindlichkeit
bandwidth = Bandbreite des Geschwindigkeitsregelkreises (−3 dB)
bandwidth-again = { $bandwidth } (Antiresonanz), wieder bis { $last }
bandwidth-short = Bandbreite
reference-delay = Sollwertverzögerung τ
sensors = Geber: { $names }.
sensor-encoder = Lagegeber
sensor-tcp = Werkzeug
observed = Beobachtete Zustände: { $names }.
variants-caption = Regelkreis mit und ohne Zustandsrückführung, je mit den besten Grenzwerten
variant-used = { $name } (verwendet)
damping-of = Dämpfungsgrad der Eigenform { $mode }
dynamic-stiffness = Kleinste dynamische Steifigkeit am Werkzeug
stiffness-at = { $stiffness } bei { $frequency }
bode-caption = { $axis ->
    [rotary] Frequenzgang: offener Kreis (am Sollmoment aufgetrennt), geschlossener Geschwindigkeitsregelkreis
   *[linear] Frequenzgang: offener Kreis (an der Soll{ word-force-behind } aufgetrennt), geschlossener Geschwindigkeitsregelkreis
}
magnitude = Betrag in dB
phase = Phase in °
open-loop = offener Kreis
closed-velocity = geschlossener Geschwindigkeitsregelkreis
remarks = Bemerkungen
corners-caption = { $move }: Verlauf in jedem Eckfall
payload = Zuladung
frequencies = Frequenzen
machine-state = Zustand
dampings = Dämpfungen
max-force = { $axis ->
    [rotary] Größtes Sollmoment
   *[linear] Größte Soll{ word-force-behind }
}
saturated = Gesättigt

has-jerk = Ruckgrenze
has-modes = Grenzwerte je Bearbeitungsart
has-setpoint-filters = Sollwertfilter
has-velocity-feedforward = Geschwindigkeitsvorsteuerung
has-acceleration-feedforward = { word-force-before }vorsteuerung
has-jerk-feedforward = Ruckvorsteuerung
has-reference-delay = Symmetrierung des Sollwerts
has-force-filters = Filter im { word-force-before }sollwert
has-state-feedback = Zustandsrückführung

## Robustness

robustness-heading = Robustheit
kept-between = Weichen alle Eigenfrequenzen um denselben Faktor ab, sind alle Anforderungen von { $low } bis { $high } eingehalten.
at-least = mind. { $value }
kept-nowhere = Die Anforderungen sind schon mit den Eigenfrequenzen des Profils nicht eingehalten; für einen Frequenzfehler bleibt nichts übrig.
frequency-error = Fehler aller Eigenfrequenzen in %
frequency-error-caption = Über dem Fehler der Eigenfrequenzen, ungünstigste Zuladung und Dämpfung

## Other sizes of move

sizes-heading = Kleinere und größere Bewegungen
sizes-listed = nur die angegebenen: { $moves }
sizes-every = jede bis { $moves }
sizes-worst = am größten { $residual } bei { $size }, keine über { $bound }
sizes-cost = kostet { $cost } gegenüber den angegebenen allein, im selben Regelkreis
sizes-caption = { $move }: für welche Größen die Grenzwerte gelten
filter-time = Filter verlängert um
full-from = Beschleunigung erreicht ab
kept-from = Band eingehalten ab
kept-to = Band eingehalten bis
never = nie
nowhere = nirgends
or-less = { $value } oder weniger
or-more = { $value } oder mehr
sizes-plot-caption = { $move }: Restabweichung über der Größe der Bewegung, ungünstigster Eckfall

## Evidence

certificates-heading = Nachweise und Annahmen
certificate-caption = { $move }: { $what }
final-time = Endzeit t_f
method = Verfahren
method-exact = exakt
method-transcription = Transkription
switches = Schaltzeitpunkte
largest-error = Größter Endfehler, bezogen auf den Höchstwert seines Zustands
assumptions = Annahmen
warnings = Warnungen
versions-heading = Versionen und Profil
program = Programm
version = Version
created = Berechnet am
hash-row = SHA-256 des Profils
profile-caption = Profil { $name }, wie gelesen

## Measurements

measurements-heading = Messungen an der Maschine
measure-note = Die Werte gelten für die Nennmaschine ohne Zuladung. Liegt eine Frequenz außerhalb des zulässigen Bereichs: Profil berichtigen und neu rechnen, bevor die Grenzwerte gelten. Bewegungen: { $moves }.
measure-how-1 = { $axis ->
    [open-loop] Eigenfrequenzen und Dämpfungsgrade: Beschleunigungsaufnehmer am Werkzeug, Motor bestromt und in Ruhe (gehalten), Impuls oder Anregung durch den Motor mit wandernder Frequenz; Mitte des Verfahrwegs.
   *[other] Eigenfrequenzen und Dämpfungsgrade: Impulshammer und Beschleunigungsaufnehmer am Werkzeug oder Frequenzgang des Antriebs; Regelung aus, Bremse gelöst, Mitte des Verfahrwegs.
}
measure-how-2 = { $axis ->
    [rotary] Bewegtes Trägheitsmoment: Motormoment durch Beschleunigung bei gleichbleibender Beschleunigung, ohne die Reibung (Mittel aus beiden Richtungen).
   *[linear] Bewegte Masse: Motor{ word-force-behind } durch Beschleunigung bei gleichbleibender Beschleunigung, ohne die Reibung (Mittel aus beiden Richtungen).
}
measure-how-3 = { $axis ->
    [rotary] Reserven und Bandbreite: Frequenzgang mit der Messfunktion der Steuerung, Kreis am Sollmoment aufgetrennt.
   *[linear] Reserven und Bandbreite: Frequenzgang mit der Messfunktion der Steuerung, Kreis an der Soll{ word-force-behind } aufgetrennt.
}
measure-how-4 = { $axis ->
    [rotary] Abweichungen und Einschwingzeit: Winkelmessgerät oder Beschleunigungsaufnehmer auf bekanntem Radius, mit den Grenzwerten dieses Blattes, gegen den verzögerten Sollwert.
   *[linear] Abweichungen und Einschwingzeit: Laserinterferometer oder Beschleunigungsaufnehmer am Werkzeug, mit den Grenzwerten dieses Blattes, gegen den verzögerten Sollwert.
}
measure-how-5 = { word-force }: Aufzeichnung des Antriebs, Ist{ word-force-behind } oder Iststrom, so schnell abgetastet wie möglich; der Sollwert springt mit jedem Lagesollwert und ist größer.
measure-caption = Berechnete und gemessene Werte
measurement = Messung
calculated = Berechnet
measured = Gemessen
difference = Differenz
measured-by = Wer, wann
measure-field-1 = Messmittel (Typ, Nummer, kalibriert bis)
measure-field-2 = Zustand der Maschine (Stellung der anderen Achsen, Zuladung, Temperatur)

## Entry and signature

# $jerk: how the control takes it, or none
neutral-name = { $setting ->
    [acceleration] Beschleunigung
    [jerk] Ruck
    [average] Gleitender Mittelwert
    [second-average] Zweiter gleitender Mittelwert
    [shaper] Sollwertfilter
    [shaper-frequency] Filterfrequenz
    [shaper-damping] Dämpfungsgrad des Filters
    [tap] Gewicht { $number }
    [tap-spacing] Abstand der Gewichte
    [state-gain] Zustandsrückführung { $number }
    [position-loop] Ort der Lageregelung
    [position-cycle] Lagereglertakt
    [velocity-cycle] Geschwindigkeitsreglertakt
    [reference-model] Referenzmodell
    [velocity-feedforward] Geschwindigkeitsvorsteuerung
    [force-feedforward] { word-force-before }vorsteuerung
    [jerk-feedforward] Ruckvorsteuerung
    [reference-delay] Sollwertverzögerung τ
    [filters] { has-force-filters }
    [filter-kind] Filter { $number }: Art
    [filter-frequency] Filter { $number }: Frequenz
    [filter-damping] Filter { $number }: Dämpfung
    [filter-width] Filter { $number }: Breite
    [wait] Wartezeit
    [together] { $number ->
        [jerk] Bahnruck
       *[acceleration] Bahnbeschleunigung
    }
   *[other] { $name }
}
entry-caption = Einzugebende Werte (vor Gebrauch prüfen; { $jerk ->
    [none] Beschleunigung nie aufrunden
    [time] Beschleunigung nie auf-, Ruckzeit nie abrunden
   *[limit] Beschleunigung und Ruck nie aufrunden
}; { $mark } muss so sein)
parameter = Parameter
# $why: a fault
entry-none = Hier keine einzugebenden Werte: { $why }
old-value = Alt
new-value = Neu
signature-heading = Unterschrift
signed-values = { $machine }, Achse { $axis_name }: Beschleunigung { $acceleration }, Ruck { $jerk }, Sollwertfilter { $filter }.
signature-field-1 = Maschinennummer, Aufstellort
signature-field-2 = An der Steuerung eingegeben (Datum, Name, Unterschrift)
signature-field-3 = An der Maschine geprüft (Datum, Name, Unterschrift)

## Faults

# $got, $wanted: linear or rotary
compared-with-other-motion = die Achse ist { $got ->
    [rotary] rotatorisch, muss linear
   *[linear] linear, muss rotatorisch
} sein wie die des Blattes, das gedruckt wird

## Potential improvements

improvements-caption = Mögliche Verbesserungen: langsamste Bewegung, ungünstigster Eckfall, je eine Änderung
# $loop: none on an open-loop axis
improvements-note = Alles gerechnet: { $loop ->
    [none] Grenzwerte für jede gewählt.
   *[other] Kp neu eingestellt (Kv und Tn im alten Verhältnis), Grenzwerte für jede gewählt.
} Änderungen addieren sich nicht.
# $listed: yes where a table says what more is gained by
improvements-none = { $listed ->
    [yes] Weniger oder nichts bringen
   *[no] Mögliche Verbesserungen, je eine Änderung: weniger als 1 % oder nichts bringen
}: { $changes }.
improvement-saved = Gespart
improvement-share = Zeitänderung
plot-alt = Kurven über { $along }. { $panels }.
line-measured = gemessen
frequency = Frequenz
