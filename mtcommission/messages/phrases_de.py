"""Sentences of the record in German: English pattern and German text."""

from __future__ import annotations

PHRASES: tuple[tuple[str, str], ...] = (
    # checks, bounds, places
    ("residual deviation", "Restabweichung"),
    ("settling time", "Einschwingzeit"),
    ("set force", "Sollkraft"),
    ("RMS force", "Effektivkraft"),
    ("force limit", "Kraftgrenze"),
    ("peak {name}", "Höchstwert {name}"),
    ("{-one}, together with {-others}", "{one}, zusammen mit {others}"),
    (
        "least settling time; no limits meet all requirements",
        "kleinste Einschwingzeit; keine Grenzwerte erfüllen alle Anforderungen",
    ),
    (
        "settling time (higher limits settle later)",
        "Einschwingzeit (höhere Grenzwerte schwingen später ein)",
    ),
    ("nominal", "Nennfall"),
    ("not settled", "nicht eingeschwungen"),
    ("payload {1} kg", "Zuladung {1} kg"),
    ("frequencies x {1}", "Frequenzen × {1}"),
    ("damping x {1}", "Dämpfung × {1}"),
    ("payload {1} kg, {-rest}", "Zuladung {1} kg, {rest}"),
    ("frequencies x {1}, {-rest}", "Frequenzen × {1}, {rest}"),
    ("move {1}, {-rest}", "Bewegung {1}, {rest}"),
    # ways and variants
    ("closest to the time-optimal control", "nächst der zeitoptimalen Steuerung"),
    ("closest to the damping-optimal control", "nächst der dämpfungsoptimalen Steuerung"),
    ("{-name}, move {1}", "{name}, Bewegung {1}"),
    ("time-optimal", "zeitoptimal"),
    ("damping-optimal", "dämpfungsoptimal"),
    ("constrained time-optimal", "zeitoptimal, beschränkt"),
    ("time-optimal control, on the plant", "zeitoptimale Steuerung, an der Strecke"),
    (
        "constrained time-optimal control, on the plant",
        "beschränkt-zeitoptimale Steuerung, an der Strecke",
    ),
    ("damping-optimal control, on the plant", "dämpfungsoptimale Steuerung, an der Strecke"),
    ("trapezoidal acceleration, in the loop", "trapezförmige Beschleunigung, im Regelkreis"),
    ("rectangular acceleration, in the loop", "rechteckförmige Beschleunigung, im Regelkreis"),
    ("with state feedback", "mit Zustandsrückführung"),
    ("without state feedback", "ohne Zustandsrückführung"),
    ("exact", "exakt"),
    ("transcription", "Transkription"),
    ("composed", "zusammengesetzt"),
    ("encoder", "Lagegeber"),
    ("tcp", "Sensor am TCP"),
    ("velocity", "Geschwindigkeit"),
    ("acceleration", "Beschleunigung"),
    ("jerk", "Ruck"),
    ("mass", "Masse"),
    # sources and rules
    ("default", "Vorgabewert"),
    ("illustrative", "Beispielwert"),
    ("illustrative numbers", "Beispielwerte"),
    ("illustrative numbers; derivation in the profile", "Beispielwerte; Herleitung im Profil"),
    ("stated in the profile", "im Profil angegeben"),
    ("default accepted, not measured", "Vorgabe übernommen, nicht gemessen"),
    ("a = F_max/m, no jerk limit", "a = F_max/m, ohne Ruckgrenze"),
    ("j = a f ({name}, {1} Hz)", "j = a f ({name}, {1} Hz)"),
    ("j = a f / {1} ({name}, {2} Hz)", "j = a f / {1} ({name}, {2} Hz)"),
    ("j = {formula}", "j = {formula}"),
    ("a = {formula}", "a = {formula}"),
    ("naive", "naheliegend"),
    (
        "zero residual vibration of an undamped mode (Biagiotti & Melchiorri)",
        "keine Restschwingung einer ungedämpften Eigenform (Biagiotti & Melchiorri)",
    ),
    (
        "static deflection within the band (textbook)",
        "statische Verformung innerhalb des Bands (Lehrbuch)",
    ),
    ("grblHAL; lower end of LinuxCNC", "grblHAL; unteres Ende bei LinuxCNC"),
    ("upper end of LinuxCNC", "oberes Ende bei LinuxCNC"),
    (
        "HEIDENHAIN, MANUALplus 620: least axPathJerk",
        "HEIDENHAIN, MANUALplus 620: kleinster axPathJerk",
    ),
    ("commissioning rule", "Inbetriebnahmeregel"),
    (
        "this project, by hand; derived and validated in docs/commissioning-rule.md",
        "dieses Projekt, von Hand; Herleitung und Prüfung in docs/commissioning-rule.md",
    ),
    ("{kind} shaper ({name}, {1} Hz)", "{kind}-Shaper ({name}, {1} Hz)"),
    ("moving average 1/f ({name}, {1} Hz)", "gleitender Mittelwert 1/f ({name}, {1} Hz)"),
    ("Singer & Seering 1990", "Singer & Seering 1990"),
    ("Singhose, Seering & Singer 1994", "Singhose, Seering & Singer 1994"),
    ("Klipper, Resonance Compensation", "Klipper, Resonance Compensation"),
    (
        "jerk filter of the controls, Biagiotti & Melchiorri 2008",
        "Ruckfilter der Steuerungen, Biagiotti & Melchiorri 2008",
    ),
    # the commissioning rule
    (
        "A rule to apply by hand: each jerk step leaves a vibration in every mode and a tail of "
        "the servo loop, both in proportion to the jerk; ramps of whole periods cancel the "
        "vibration. Of the ramps tried, the one with the shortest motion is taken.",
        "Eine Regel für die Anwendung von Hand: jeder Rucksprung hinterlässt in jeder Eigenform "
        "eine Schwingung und im Regelkreis einen Nachlauf, beide proportional zum Ruck; Rampen "
        "von ganzen Perioden löschen die Schwingung. Von den versuchten Rampen gilt die mit der "
        "kürzesten Bewegung.",
    ),
    ("no cancelling", "ohne Auslöschung"),
    ("{1} period of {name}", "{1} Periode von {name}"),
    ("{1} periods of {name}", "{1} Perioden von {name}"),
    ("force", "Kraft"),
    ("reach", "Weg oder Geschwindigkeit"),
    ("band", "Band"),
    ("bound by {-what}", "begrenzt durch: {what}"),
    ("see the formula", "siehe Formel"),
    ("R(f t_j) x echo of the ramps before", "R(f t_j) × Echo der Rampen davor"),
    ("within the spread", "innerhalb der Streuung"),
    ("for a velocity step", "beim Geschwindigkeitssprung"),
    ("for positioning", "beim Positionieren"),
    (
        "Try t_j = {list} periods of each mode, and the t_j that needs no cancelling (R = 2); take "
        "the shortest motion.",
        "Zu versuchen: t_j = {list} Perioden jeder Eigenform und das t_j, das keine Auslöschung "
        "braucht (R = 2); die kürzeste Bewegung gilt.",
    ),
    ("speed loop omega_v", "Geschwindigkeitsregelkreis ω_v"),
    ("servo compliance C_S", "Nachgiebigkeit des Regelkreises C_S"),
    ("unknown share of the mass eps", "unbekannter Anteil der Masse ε"),
    ("payload compliance C_P", "Nachgiebigkeit durch die Zuladung C_P"),
    ("compliance C of mode {name}", "Nachgiebigkeit C der Eigenform {name}"),
    ("vibration V of mode {name}", "Schwingung V der Eigenform {name}"),
    (
        "spread of mode {name} beyond the stated one",
        "Streuung der Eigenform {name} über die angegebene hinaus",
    ),
    ("jerk time t_j", "Ruckzeit t_j"),
    ("acceleration within the force", "Beschleunigung innerhalb der Kraft"),
    ("acceleration a", "Beschleunigung a"),
    ("jerk j", "Ruck j"),
    ("predicted residual", "vorhergesagte Restabweichung"),
    (
        "Rigid axis with lag and weakly damped modes ({1} to {2} Hz, damping {3} to {4} %), "
        "cascade with full velocity feed-forward and automatic reference delay, spread up to {5} "
        "%, payload up to {6} % of the moving mass, band {7} to {8} um; no setpoint filter, no "
        "bounds on peaks or RMS force. The band is met in most machines, not in all: simulate "
        "before use.",
        "Starre Achse mit Verzögerung und schwach gedämpften Eigenformen ({1} bis {2} Hz, Dämpfung "
        "{3} bis {4} %), Kaskade mit voller Geschwindigkeitsvorsteuerung und selbst bestimmter "
        "Sollwertverzögerung, Streuung bis {5} %, Zuladung bis {6} % der bewegten Masse, Band {7} "
        "bis {8} µm; kein Sollwertfilter, keine Grenzen für Höchstwerte oder Effektivkraft. Das "
        "Band wird bei den meisten Maschinen eingehalten, nicht bei allen: vor Gebrauch "
        "simulieren.",
    ),
    (
        "velocity_feedforward is not {1}: the following error is not in the rule",
        "velocity_feedforward ist nicht {1}: den Schleppfehler kennt die Regel nicht",
    ),
    (
        "reference_delay is given: the rule counts on the automatic one",
        "reference_delay ist vorgegeben: die Regel rechnet mit der selbst bestimmten",
    ),
    (
        "a setpoint filter is on: the rule does not count its smoothing",
        "ein Sollwertfilter ist an: die Regel zählt seine Glättung nicht mit",
    ),
    (
        "bounds on peaks or RMS force are not in the rule",
        "Grenzen für Höchstwerte oder Effektivkraft kennt die Regel nicht",
    ),
    # other sizes of move, and what could be met
    ("recommended", "empfohlen"),
    ("moving average", "gleitender Mittelwert"),
    (
        "no limits were found that meet all requirements with this band",
        "es wurden keine Grenzwerte gefunden, die mit diesem Band alle Anforderungen erfüllen",
    ),
    ("the loop that is used", "der verwendete Regelkreis"),
    # paths of the loop
    ("position setpoint", "Lagesollwert"),
    ("position controller", "Lageregler"),
    ("velocity ahead", "Geschwindigkeitsvorsteuerung"),
    ("wanted state", "Sollzustand"),
    ("force ahead", "Kraftvorsteuerung"),
    ("velocity controller", "Geschwindigkeitsregler"),
    # small changes
    ("jerk {1} %", "Ruck {1} %"),
    ("acceleration {1} %", "Beschleunigung {1} %"),
    ("frequencies {1} %", "Frequenzen {1} %"),
    ("damping {1} %", "Dämpfung {1} %"),
    # assumptions
    (
        "The machine data are illustrative, not those of a real machine.",
        "Die Maschinendaten sind Beispielwerte, nicht die einer wirklichen Maschine.",
    ),
    (
        "tcp_height is taken as the height of the tool centre point above the rotary joint, so "
        "the tool stands at x_s - x_b + h phi as seen from the base; the paper names h but gives "
        "no equation and no sign.",
        "tcp_height gilt als Höhe des Werkzeugbezugspunkts über dem Drehgelenk; das Werkzeug steht "
        "vom Gestell aus gesehen bei x_s − x_b + h φ. Die Veröffentlichung nennt h, aber weder "
        "Gleichung noch Vorzeichen.",
    ),
    (
        "tcp_height is taken as the height of the tool centre point below the rotary joint, so "
        "the tool stands at x_s - x_b + h phi as seen from the base; the paper names h but gives "
        "no equation and no sign.",
        "tcp_height gilt als Höhe des Werkzeugbezugspunkts unter dem Drehgelenk; das Werkzeug "
        "steht vom Gestell aus gesehen bei x_s − x_b + h φ. Die Veröffentlichung nennt h, aber "
        "weder Gleichung noch Vorzeichen.",
    ),
    (
        "The axis is linear: a rigid mass, a first-order force lag and decoupled flexible modes.",
        "Die Achse ist linear: eine starre Masse, ein Kraftregelkreis als Verzögerung erster "
        "Ordnung und entkoppelte Eigenformen.",
    ),
    (
        "Friction, backlash, cogging and cable forces are left out.",
        "Reibung, Umkehrspiel, Rastkräfte und Kräfte der Energieführung bleiben außer Betracht.",
    ),
    (
        "The encoder measures without error; velocity is the exact rate of the encoder position "
        "at each velocity cycle.",
        "Der Lagegeber misst fehlerfrei; die Geschwindigkeit ist die exakte Ableitung der "
        "Geberlage in jedem Takt des Geschwindigkeitsreglers.",
    ),
    (
        "Position controller and feed-forward act one position cycle late and are held for one "
        "cycle; the force acts one velocity cycle late.",
        "Lageregler und Vorsteuerung wirken einen Lagereglertakt verspätet und werden einen Takt "
        "lang gehalten; die Kraft wirkt einen Takt des Geschwindigkeitsreglers verspätet.",
    ),
    (
        "The time-optimal reference demands exact rest of all modes; the recommendation is judged "
        "by a band, so the two answer different questions.",
        "Der zeitoptimale Vergleichswert verlangt exakte Ruhe aller Eigenformen; die Empfehlung "
        "wird an einem Toleranzband gemessen. Beide beantworten verschiedene Fragen.",
    ),
    (
        "A calculated record is not an acceptance test (e.g. ISO 230); confirm on the machine.",
        "Ein berechnetes Protokoll ist keine Abnahmeprüfung (z. B. ISO 230); an der Maschine "
        "bestätigen.",
    ),
    (
        "The static load takes its amount from the force available for motion; its deflection is "
        "constant and taken up by the integral part of the velocity loop.",
        "Die statische Last mindert die Kraft für die Bewegung um ihren Betrag; ihre Verformung "
        "ist konstant, und der Integralanteil des Geschwindigkeitsreglers nimmt sie auf.",
    ),
    # remarks on the loop
    (
        "Kp by the symmetrical optimum, m / (2 T_sigma).",
        "Kp nach dem symmetrischen Optimum, m / (2 T_σ).",
    ),
    (
        "Kp by the symmetrical optimum, m / (2 T_sigma) x {1} (lowered until the margins hold).",
        "Kp nach dem symmetrischen Optimum, m / (2 T_σ) × {1} (gesenkt, bis die Reserven "
        "eingehalten sind).",
    ),
    (
        "Tn = 4 m / Kp (Yaskawa's lower bound for the speed loop).",
        "Tn = 4 m / Kp (Untergrenze nach Yaskawa für den Geschwindigkeitsregelkreis).",
    ),
    (
        "Tn by Yaskawa's lower bound.",
        "Tn nach der Untergrenze von Yaskawa.",
    ),
    (
        "Kv = Kp / (4 m): speed loop damping 1.",
        "Kv = Kp / (4 m): Dämpfungsgrad 1 des Geschwindigkeitsregelkreises.",
    ),
    (
        "Reference delay: 1.5 position cycles + 1 velocity cycle + the force lag that the jerk "
        "feed-forward leaves + the filters, so that feed-forward and feedback meet.",
        "Sollwertverzögerung: 1,5 Lagereglertakte + 1 Geschwindigkeitsreglertakt + der Teil der "
        "Kraftverzögerung, den die Ruckvorsteuerung übrig lässt + die Filter, damit Vorsteuerung "
        "und Regelung zusammentreffen.",
    ),
    (
        "The sensors do not see mode {name}: no feedback can damp it.",
        "Die Geber sehen die Eigenform {name} nicht: keine Rückführung kann sie dämpfen.",
    ),
    ("No state feedback.", "Keine Zustandsrückführung."),
    (
        "No state feedback: its design failed ({detail}).",
        "Keine Zustandsrückführung: ihr Entwurf ist gescheitert ({detail}).",
    ),
    (
        "No state feedback: none damps mode {name} better than the cascade alone (damping ratio "
        "{1}) with the margins kept.",
        "Keine Zustandsrückführung: keine dämpft bei eingehaltenen Reserven die Eigenform {name} "
        "besser als die Kaskade allein (Dämpfungsgrad {1}).",
    ),
    (
        "State feedback is needed: the fastest cascade with the margins has {1} Hz, "
        "minimum_bandwidth is {2} Hz.",
        "Die Zustandsrückführung ist nötig: die schnellste Kaskade mit den Reserven hat {1} Hz, "
        "minimum_bandwidth ist {2} Hz.",
    ),
    (
        "State feedback (LQR around the cascade, Kalman observer on {-sensors}): damping ratio of "
        "mode {name} {1} without control, {2} with the cascade, {3} with state feedback.",
        "Zustandsrückführung (LQR um die Kaskade, Kalman-Beobachter an {sensors}): Dämpfungsgrad "
        "der Eigenform {name} {1} ohne Regelung, {2} mit der Kaskade, {3} mit "
        "Zustandsrückführung.",
    ),
    (
        "Best settling time {-time} with it, {-other} without it: it is used.",
        "Beste Einschwingzeit {time} damit, {other} ohne sie: sie wird verwendet.",
    ),
    (
        "Best settling time {-time} with it, {-other} without it: it is left out.",
        "Beste Einschwingzeit {time} damit, {other} ohne sie: sie wird weggelassen.",
    ),
    ("{1} ms", "{1} ms"),
    (
        "The given gains are used as given, but their margins are poor: {1} dB, {2} degrees, "
        "sensitivity peak {3} (worst corner); wanted are {4} dB, {5} degrees, sensitivity peak at "
        "most {6}.",
        "Die vorgegebenen Verstärkungen werden unverändert verwendet, haben aber schwache "
        "Reserven: {1} dB, {2}°, Maximum der Empfindlichkeit {3} (ungünstigster Eckfall); gewollt "
        "sind {4} dB, {5}°, Maximum der Empfindlichkeit höchstens {6}.",
    ),
    (
        "The margins would hold with {-gains}, all other given values as they are.",
        "Die Reserven wären eingehalten mit {gains}, alle anderen Vorgaben unverändert.",
    ),
    ("Kv up to {1} 1/s", "Kv bis {1} 1/s"),
    ("Kp up to {1} N s/m", "Kp bis {1} N s/m"),
    ("Kp up to {1} N m s/rad", "Kp bis {1} N m s/rad"),
    ("Tn from {1} ms on", "Tn ab {1} ms"),
    ("{-one} or {-other}", "{one} oder {other}"),
    (
        "No single gain cures that; leave the gains out to have them tuned.",
        "Keine Verstärkung allein behebt das; ohne Vorgaben werden sie eingestellt.",
    ),
    (
        "With the given gains the closed velocity loop reaches {1} Hz in its worst corner, less "
        "than minimum_bandwidth = {2} Hz.",
        "Mit den vorgegebenen Verstärkungen erreicht der Geschwindigkeitsregelkreis im "
        "ungünstigsten Eckfall {1} Hz, weniger als minimum_bandwidth = {2} Hz.",
    ),
    (
        "The set-force filters make the loop soft: its bandwidth is {1} Hz with them, {2} Hz "
        "without.",
        "Die Kraftsollwertfilter machen den Regelkreis weich: seine Bandbreite ist {1} Hz mit "
        "ihnen, {2} Hz ohne sie.",
    ),
    (
        "The loop takes damping from mode {name}: its damping ratio is {1} in the closed loop, {2} "
        "without control.",
        "Der Regelkreis entdämpft die Eigenform {name}: ihr Dämpfungsgrad ist {1} im geschlossenen "
        "Kreis, {2} ohne Regelung.",
    ),
    (
        "Mode {name} and the servo mix in the closed loop: the damping ratio shown is that of the "
        "poles at {1} Hz, which hold {2} % of the mode; {3} % of it ring at {4} Hz with {5}.",
        "Eigenform {name} und Antriebsregelung mischen sich im geschlossenen Kreis: Der angegebene "
        "Dämpfungsgrad gehört zu den Polen bei {1} Hz, die {2} % der Eigenform enthalten; {3} % "
        "von ihr schwingen bei {4} Hz mit {5}.",
    ),
    (
        "Kp by the symmetrical optimum, m / (2 T_sigma) x {1} (the state feedback allows more).",
        "Kp nach dem symmetrischen Optimum, m / (2 T_σ) × {1} (die Zustandsrückführung lässt mehr "
        "zu).",
    ),
    (
        "With it the tool is {1} times as stiff against a disturbance.",
        "Damit ist das Werkzeug {1}-mal so steif gegen eine Störung.",
    ),
    (
        'The control must offer state feedback; if yours does not, set state_feedback = "off".',
        "Die Steuerung muss eine Zustandsrückführung bieten; wenn Ihre das nicht tut, "
        'state_feedback = "off" setzen.',
    ),
    # the paper's claims, and why the optimum is not fed forward
    (
        "The rectangular acceleration setpoint {-overshoot} and {-transfer}.",
        "Der rechteckige Beschleunigungssollwert {overshoot} und {transfer}.",
    ),
    (
        "The trapezoidal one with the recommended limits {-overshoot} and {-transfer}.",
        "Der trapezförmige mit den empfohlenen Grenzwerten {overshoot} und {transfer}.",
    ),
    ("overshoots by {1} %", "schwingt um {1} % über"),
    ("does not overshoot (less than 0.05 %)", "schwingt nicht über (weniger als 0,05 %)"),
    (
        "takes {1} ms, {2} times the least time of {3} ms",
        "braucht {1} ms, das {2}-Fache der kürzesten Zeit von {3} ms",
    ),
    (
        "does not settle, where the least time is {1} ms",
        "schwingt nicht ein; die kürzeste Zeit ist {1} ms",
    ),
    ("recommended limits", "empfohlene Grenzwerte"),
    (
        "Fed forward, the {-name} control {-outcome}, where it leaves {1} {unit}.",
        "Vorgesteuert: Die Steuerung „{name}“ {outcome}; dort lässt sie {1} {unit} übrig.",
    ),
    (
        "The setpoint with the recommended limits {-outcome}, where it leaves {1} {unit}.",
        "Der Sollwert mit den empfohlenen Grenzwerten {outcome}; dort lässt er {1} {unit} übrig.",
    ),
    (
        "settles after {-one} on the machine as stated and after {-other} on the worst one",
        "schwingt auf der Maschine laut Angaben nach {one} ein, auf der ungünstigsten nach {other}",
    ),
    ("no time looked at", "keiner betrachteten Zeit"),
    (
        "The band is {1} {unit}, the machines differ by up to {2} % in frequency, and controls "
        "take acceleration and jerk, not a force every velocity cycle.",
        "Das Band ist {1} {unit}, die Maschinen unterscheiden sich um bis zu {2} % in der "
        "Frequenz, und Steuerungen nehmen Beschleunigung und Ruck entgegen, keine Kraft in jedem "
        "Geschwindigkeitsreglertakt.",
    ),
    # remarks on the optima
    (
        "The optimum under the bounds on peaks is at most {1} % slower than the fastest control; "
        "exact arcs were not found.",
        "Das Optimum mit Höchstwerten ist höchstens {1} % langsamer als die schnellste Steuerung; "
        "genaue Bögen wurden nicht gefunden.",
    ),
    (
        "The damping-optimal control reaches {1} times max_velocity: its functional knows no "
        "limits on states.",
        "Die dämpfungsoptimale Steuerung erreicht das {1}-fache von max_velocity: ihr Funktional "
        "kennt keine Grenzen für Zustände.",
    ),
    ("Optimum under the bounds on peaks: {-error}.", "Optimum mit Höchstwerten: {error}."),
    ("Damping-optimal control: {-error}.", "Dämpfungsoptimale Steuerung: {error}."),
    (
        "final time too short: t_f = {1} ms, but t_f,min = {2} ms: no admissible force reaches "
        "the target so soon; give a longer t_f",
        "Endzeit zu kurz: t_f = {1} ms, aber t_f,min = {2} ms: keine zulässige Kraft erreicht das "
        "Ziel so früh; ein längeres t_f vorgeben",
    ),
    (
        "The move cruises at max_velocity for long; the reference shown is composed of two "
        "time-optimal velocity steps and a cruise at rest. Nothing is faster than {1} ms (a proved "
        "bound, {2} % below).",
        "Die Bewegung fährt lange mit max_velocity; der gezeigte Vergleichswert ist aus zwei "
        "zeitoptimalen Geschwindigkeitssprüngen und einer Fahrt ohne Schwingung zusammengesetzt. "
        "Nichts ist schneller als {1} ms (bewiesene Schranke, {2} % darunter).",
    ),
    (
        "t_f of the damping-optimal control is the profile's.",
        "t_f der dämpfungsoptimalen Steuerung stammt aus dem Profil.",
    ),
    # warnings
    (
        "The profile states no spread of the frequencies; all requirements are kept only while "
        "the eigenfrequencies are off by {-range}. Missed outside this range: {-lost}. State "
        "requirements.frequency_spread, at least {1} %, and run again.",
        "Das Profil gibt keine Streuung der Frequenzen an; alle Anforderungen sind nur erfüllt, "
        "solange die Eigenfrequenzen um {range} abweichen. Außerhalb davon verletzt: {lost}. "
        "requirements.frequency_spread angeben, mindestens {1} %, und neu rechnen.",
    ),
    ("{-name} (where they are lower)", "{name} (wo sie tiefer liegen)"),
    ("{-name} (where they are lower) and {-rest}", "{name} (wo sie tiefer liegen) und {rest}"),
    ("{-name} (where they are higher)", "{name} (wo sie höher liegen)"),
    ("{-name} (where they are higher) and {-rest}", "{name} (wo sie höher liegen) und {rest}"),
    ("{1} % to {2} %", "{1} % bis {2} %"),
    ("{1} % to at least {2} %", "{1} % bis mindestens {2} %"),
    ("at least {1} % to {2} %", "mindestens {1} % bis {2} %"),
    (
        "mode {name}: damping ratio {1} is below what machine structures show, {2} to {3}",
        "Eigenform {name}: Dämpfungsgrad {1} liegt unter dem von Maschinengestellen, {2} bis {3}",
    ),
    (
        "mode {name}: damping ratio {1} is above what machine structures show, {2} to {3}",
        "Eigenform {name}: Dämpfungsgrad {1} liegt über dem von Maschinengestellen, {2} bis {3}",
    ),
    (
        "mode {name}: {1} Hz is slower than any machine structure; check stiffness and mass",
        "Eigenform {name}: {1} Hz ist langsamer als jedes Maschinengestell; Steifigkeit und Masse "
        "prüfen",
    ),
    (
        "mode {name}: {1} Hz is above a third of the velocity loop's sampling rate, {2} Hz; no "
        "feedback can damp it",
        "Eigenform {name}: {1} Hz liegt über einem Drittel der Abtastrate des "
        "Geschwindigkeitsreglers, {2} Hz; keine Rückführung kann sie dämpfen",
    ),
    (
        "mode {name}: {1} Hz is above a third of the position loop's sampling rate, {2} Hz; "
        "setpoints at that cycle cannot shape it",
        "Eigenform {name}: {1} Hz liegt über einem Drittel der Abtastrate des Lagereglers, {2} Hz; "
        "Sollwerte in diesem Takt können sie nicht formen",
    ),
    (
        "mode {name}: one period has only {1} position cycles of {2} ms; a jerk time can only be "
        "set that coarsely",
        "Eigenform {name}: eine Periode hat nur {1} Lagereglertakte von {2} ms; so grob ist die "
        "Ruckzeit einstellbar",
    ),
    (
        "mode {name}: neither tool nor encoder sees it; it costs time in the optimum for nothing",
        "Eigenform {name}: weder Werkzeug noch Lagegeber sehen sie; sie kostet im Optimum umsonst "
        "Zeit",
    ),
    (
        "mode {name}: its gain is {1} times 1/moving_mass; check the unit of the gains",
        "Eigenform {name}: ihre Verstärkung ist das {1}-Fache von 1/moving_mass; die Einheit der "
        "Verstärkungen prüfen",
    ),
    (
        "mode {name}: the full force bends the tool by {1} {unit}, {2} times tcp_deviation = {3} "
        "{unit2}; check the stiffness and the band",
        "Eigenform {name}: die volle Kraft verformt das Werkzeug um {1} {unit}, das {2}-Fache von "
        "tcp_deviation = {3} {unit2}; Steifigkeit und Band prüfen",
    ),
    (
        "{1} {force} on {2} {mass} give {3} {rate}, which hardly moves the axis; check both units",
        "{1} {force} an {2} {mass} ergeben {3} {rate}, was die Achse kaum bewegt; beide Einheiten "
        "prüfen",
    ),
    (
        "{1} {force} on {2} {mass} give {3} {rate}, which is more than a machine axis bears; check "
        "both units",
        "{1} {force} an {2} {mass} ergeben {3} {rate}, mehr als eine Maschinenachse verträgt; "
        "beide Einheiten prüfen",
    ),
    (
        "{1} {force} take more than half of max_force = {2} {force2}; consider a counterbalance",
        "{1} {force} brauchen mehr als die Hälfte von max_force = {2} {force2}; einen "
        "Gewichtsausgleich erwägen",
    ),
    (
        "{1} {force} is above max_force = {2} {force2}, so it limits nothing; the two may be "
        "swapped",
        "{1} {force} liegt über max_force = {2} {force2} und begrenzt nichts; sind beide "
        "vertauscht?",
    ),
    (
        "{1} ms is long for a force loop (servo drives: 0.5 to 5 ms)",
        "{1} ms ist lang für einen Kraftregelkreis (Servoantriebe: 0,5 bis 5 ms)",
    ),
    (
        "a rigid axis would need {1} s for this move; check distance, velocity and force",
        "eine starre Achse brauchte {1} s für diese Bewegung; Weg, Geschwindigkeit und Kraft "
        "prüfen",
    ),
    (
        "{1} {unit} is finer than encoders resolve; check the unit",
        "{1} {unit} ist feiner, als Lagegeber auflösen; die Einheit prüfen",
    ),
    (
        "{1} {unit} is no accuracy at all; check the unit",
        "{1} {unit} ist gar keine Genauigkeit; die Einheit prüfen",
    ),
    (
        "{1} {mass} is more than three times the moving mass, {2} {mass2}; one set of limits will "
        "be slow for the empty axis",
        "{1} {mass} ist mehr als das Dreifache der bewegten Masse, {2} {mass2}; ein Satz "
        "Grenzwerte ist für die leere Achse langsam",
    ),
    (
        "surface {1}, accuracy {2} and speed {3} {unit} do not widen in this order; they may be "
        "swapped",
        "surface {1}, accuracy {2} und speed {3} {unit} werden in dieser Folge nicht weiter; sind "
        "sie vertauscht?",
    ),
    (
        "{1} {unit} is far from the moving mass, {2} to {3} {unit2}; the feed-forward will push "
        "too little or too much",
        "{1} {unit} liegt weit von der bewegten Masse, {2} bis {3} {unit2}; die Vorsteuerung "
        "schiebt zu wenig oder zu viel",
    ),
    (
        "{1} Hz is above a third of the velocity loop's sampling rate, {2} Hz",
        "{1} Hz liegt über einem Drittel der Abtastrate des Geschwindigkeitsreglers, {2} Hz",
    ),
    # numerical settings
    ("tuning", "Reglereinstellung"),
    ("search", "Suche"),
    ("comparison", "Vergleichssuche"),
    ("robustness", "Robustheit"),
    # last, since they fit much: what is inside must be known
    ("{key}: {-message}", "{key}: {message}"),
    ("{-a} and {-b}", "{a} und {b}"),
)
"""English pattern and German text; the first that fits is taken."""

ROTARY_EN = (
    (r"cable forces", "cable drag"),
    (r"The axis is linear: a rigid mass", "The axis is taken as a linear system: a rigid body"),
    (r"(?i)force on the line of the drive", "torque about the axis of the drive"),
    (r"Displacement of the tool per force", "Rotation of the tool per torque"),
    (
        r"laser interferometer or accelerometer at the tool",
        "angle measuring device, or accelerometer at a known radius",
    ),
    (r"\bforce(s?)\b", r"torque\1"),
    (r"\bForce(s?)\b", r"Torque\1"),
    (r"\bmass\b", "moment of inertia"),
    (r"\bMass\b", "Moment of inertia"),
    (r"\bdistance\b", "angle"),
    (r"\bDistance\b", "Angle"),
    (r"(?<=\d) kg\b(?!·| m)", " kg·m²"),
)

ROTARY_DE = (
    (
        "Die Achse ist linear: eine starre Masse",
        "Die Achse gilt als lineares System: starrer Körper",
    ),
    ("Rastkräfte und Kräfte der Energieführung", "Rastmomente und Momente der Energieführung"),
    ("Kraftsprung in der Wirklinie des Antriebs", "Momentensprung um die Achse des Antriebs"),
    ("Auslenkung des Werkzeugs je Kraft", "Drehung des Werkzeugs je Drehmoment"),
    (
        "Laserinterferometer oder Beschleunigungsaufnehmer am Werkzeug",
        "Winkelmessgerät oder Beschleunigungsaufnehmer auf bekanntem Radius",
    ),
    ("Weg, Geschwindigkeit und Kraft", "Winkel, Geschwindigkeit und Drehmoment"),
    ("^Weg(?=$| oder)", "Winkel"),
    ("an der Sollkraft", "am Sollmoment"),
    ("Größte Sollkraft", "Größtes Sollmoment"),
    ("Verlangte Sollkraft", "Verlangtes Sollmoment"),
    ("Größte Kraft", "Größtes Drehmoment"),
    ("verfügbare Kraft", "verfügbares Drehmoment"),
    ("innerhalb der Kraft", "innerhalb des Drehmoments"),
    ("keine zulässige Kraft", "kein zulässiges Drehmoment"),
    ("keine Kraft", "kein Drehmoment"),
    ("die volle Kraft", "das volle Drehmoment"),
    ("die Kraft", "das Drehmoment"),
    ("der quadrierten Motorkraft", "des quadrierten Motormoments"),
    ("(Soll|Effektiv|Dauer|Motor)kraft", r"\1moment"),
    (r"Kraft(?=-|[a-zä])", "Momenten"),
    ("Kräfte", "Drehmomente"),
    ("Kraft", "Drehmoment"),
    ("Bewegte Masse", "Bewegtes Trägheitsmoment"),
    ("der bewegten Masse", "des bewegten Trägheitsmoments"),
    ("Anteil der Masse", "Anteil des Trägheitsmoments"),
    ("Masse", "Trägheitsmoment"),
    (r"(?<=\d) kg\b(?!·| m)", " kg·m²"),
)
