"""German texts of the sheet, with the drive engineer's terms."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from mtcommission.sheet.labels_en import Labels

NAMES: Mapping[str, str] = MappingProxyType(
    {
        "F_set": "Sollkraft F_set",
        "F": "Kraft F",
        "tcp": "Werkzeugbezugspunkt (TCP)",
        "encoder": "Lagegeber",
        "tcp_vibration": "Elastische Auslenkung am Werkzeug",
        "x_b": "Gestelllage x_b",
        "x_s": "Schlittenlage x_s",
        "phi": "Drehung des Aufbaus φ",
        "v_b": "Gestellgeschwindigkeit v_b",
        "v_s": "Schlittengeschwindigkeit v_s",
        "v_phi": "Drehgeschwindigkeit des Aufbaus v_φ",
        "x": "Lage x",
        "v": "Geschwindigkeit v",
        "t_f_lower_bound": "Bewiesene untere Schranke von t_f",
        "relative_gap": "Relativer Abstand zur unteren Schranke",
        "adjoint_initial": "Adjungierte bei t = 0",
        "switching_slopes": "Steigung der Schaltfunktion an jedem Schaltzeitpunkt",
        "switching_law_holds": "Schaltgesetz überall erfüllt",
        "terminal_jacobian_rank": "Rang der Jacobimatrix der Endbedingungen",
        "terminal_jacobian_condition": "Ihre Konditionszahl, skaliert",
        "law_residual": "Größte Abweichung vom Steuergesetz, bezogen auf F_max",
        "tcp_deviation": "Zulässige TCP-Abweichung (Band)",
        "tcp_height": "TCP-Höhe h, mit Vorzeichen",
        "force_lag": "Zeitkonstante des Kraftregelkreises T",
        "Kv": "Lagereglerverstärkung Kv",
        "Kp": "Geschwindigkeitsreglerverstärkung Kp",
        "Tn": "Nachstellzeit Tn",
        "base_mass": "Gestellmasse",
        "slider_mass": "Schlittenmasse",
        "rotary_inertia": "Drehträgheit",
        "lever_arm": "Hebelarm",
        "base_stiffness": "Gestellsteifigkeit",
        "base_damping": "Gestelldämpfung",
        "rotary_stiffness": "Drehsteifigkeit",
        "rotary_damping": "Drehdämpfung",
        "moving_mass": "Bewegte Masse",
        "frequency": "Eigenfrequenz",
        "damping_ratio": "Dämpfungsgrad",
        "tcp_gain": "Verstärkung am Werkzeug",
        "measured_gain": "Verstärkung am Lagegeber",
        "max_force": "Größte Kraft",
        "continuous_force": "Dauerkraft",
        "static_load": "Statische Last",
        "velocity_step": "Geschwindigkeitssprung",
        "distance": "Weg",
        "max_velocity": "Höchstgeschwindigkeit",
        "dwell": "Verweilzeit",
        "max_settling_time": "Größte Einschwingzeit",
        "frequency_spread": "Streuung der Frequenzen",
        "damping_spread": "Streuung der Dämpfungen",
        "payload (least)": "Zuladung (kleinste)",
        "payload (largest)": "Zuladung (größte)",
    }
)

PHRASES: tuple[tuple[str, str], ...] = (
    # checks, bounds, places
    ("residual deviation", "Restabweichung"),
    ("settling time", "Einschwingzeit"),
    ("set force", "Sollkraft"),
    ("RMS force", "Effektivkraft"),
    ("force limit", "Kraftgrenze"),
    ("peak {name}", "Höchstwert {name}"),
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
    ("illustrative", "Beispielwert"),
    ("illustrative numbers", "Beispielwerte"),
    ("illustrative numbers; derivation in the profile", "Beispielwerte; Herleitung im Profil"),
    ("stated in the profile", "im Profil angegeben"),
    ("a = F_max/m, no jerk limit", "a = F_max/m, ohne Ruckgrenze"),
    ("j = a f ({name}, {1} Hz)", "j = a f ({name}, {1} Hz)"),
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
    (
        "One acceleration ramp lasts one period of mode {name} ({1} Hz), which a ramp of that "
        "length does not excite.",
        "Eine Beschleunigungsrampe dauert eine Periode der Eigenform {name} ({1} Hz); eine Rampe "
        "dieser Länge regt sie nicht an.",
    ),
    (
        "velocity changes of at least a / f (here {1} m/s at a = {2} m/s^2; rad instead of m on a "
        "rotary axis); below that a is never reached; exact for an undamped mode",
        "Geschwindigkeitsänderungen von mindestens a / f (hier {1} m/s bei a = {2} m/s²; bei einer "
        "Rundachse rad statt m); darunter wird a nie erreicht; exakt für eine ungedämpfte "
        "Eigenform",
    ),
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
        "No state feedback: none damps mode {name} better than the cascade alone (damping ratio "
        "{1}) with the margins kept.",
        "Keine Zustandsrückführung: keine dämpft bei eingehaltenen Reserven die Eigenform {name} "
        "besser als die Kaskade allein (Dämpfungsgrad {1}).",
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
    # remarks on the optima
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
    ("tuning: {-name}", "Reglereinstellung: {name}"),
    ("search: {-name}", "Suche: {name}"),
    ("comparison: {-name}", "Vergleichssuche: {name}"),
    ("gain margin db", "Amplitudenreserve in dB"),
    ("phase margin deg", "Phasenreserve in °"),
    ("reserve deg", "Vorhalt in °"),
    ("sensitivity peak", "Maximum der Empfindlichkeit"),
    ("mode damping", "Dämpfung der Eigenform"),
    ("mode weights", "Gewichte der Eigenform"),
    ("reduction", "Absenkung je Schritt"),
    ("force noise", "Kraftrauschen, bezogen auf F_max"),
    ("position noise", "Lagerauschen"),
    ("least acceleration", "kleinste Beschleunigung, bezogen auf die größte"),
    ("least jerk time", "kleinste Ruckzeit in s"),
    ("longest jerk time", "größte Ruckzeit in s"),
    ("grid", "Raster"),
    ("coarse grid", "grobes Raster"),
    ("seeds", "Startpunkte"),
    ("refinements", "Verfeinerungen"),
    ("digits", "Stellen"),
    ("evaluations", "Auswertungen"),
    # last, since they fit much: what is inside must be known
    ("{key}: {-message}", "{key}: {message}"),
    ("{-a} and {-b}", "{a} und {b}"),
)
"""English pattern and German text; the first that fits is taken."""

GERMAN = Labels(
    language="de",
    decimal_mark=",",
    names=NAMES,
    phrases=PHRASES,
    original="{text} [Originaltext]",
    # the printers' own words
    title="Inbetriebnahmeprotokoll",
    axis="Achse",
    identity="Profil {name}, SHA-256 {hash}",
    disclaimer="Berechnetes Protokoll, keine Abnahmeprüfung.",
    contents="Inhalt",
    skip="Zum Ergebnis springen",
    page="Seite",
    script_note=(
        "Diagramme: Ziehen vergrößert, Doppelklick setzt zurück, Zeiger oder Pfeiltasten zeigen "
        "Werte. Ohne JavaScript stehen die Diagramme im PDF."
    ),
    # words
    yes="ja",
    no="nein",
    met="erfüllt",
    not_met="NICHT ERFÜLLT",
    not_settled="nicht eingeschwungen",
    unlimited="unbegrenzt",
    none="Keine.",
    move="Bewegung {number}",
    velocity_step="Geschwindigkeitssprung {velocity}",
    positioning="Positionieren um {distance}",
    positioning_limited="Positionieren um {distance} mit höchstens {velocity}",
    quantity="Größe",
    value="Wert",
    key="Schlüssel im Profil",
    source="Quelle",
    acceleration="Beschleunigung",
    jerk="Ruck",
    jerk_time="Ruckzeit",
    settling_time="Einschwingzeit",
    residual="Restabweichung",
    peak_deviation="Größte Abweichung",
    time="Zeit",
    frequency="Frequenz",
    damping_ratio="Dämpfungsgrad",
    velocity="Geschwindigkeit",
    # verdict
    verdict_heading="Ergebnis und einzugebende Werte",
    verdict_met="Alle Anforderungen erfüllt",
    verdict_not_met="Anforderungen NICHT erfüllt",
    values_bound_by="Begrenzt durch: {bound}",
    obstacle="Im Weg steht: {obstacle}",
    result_caption="Ergebnis mit diesen Grenzwerten, ungünstigste Bewegung, ungünstigster Eckfall",
    of_band="{value}, {percent} der zulässigen {band}",
    no_residual="nicht eingeschwungen; zulässig {band}",
    reference=(
        "{move}: zeitoptimaler Vergleichswert, exakte Ruhe: {optimum}; "
        "empfohlen: {settling} ({more} mehr)."
    ),
    reference_unsettled=(
        "{move}: zeitoptimaler Vergleichswert, exakte Ruhe: {optimum}; "
        "empfohlen: nicht eingeschwungen."
    ),
    reference_faster=(
        "{move}: zeitoptimaler Vergleichswert, exakte Ruhe: {optimum}; empfohlen: {settling}, "
        "{less} weniger, da am Band und nicht an exakter Ruhe gemessen."
    ),
    reference_composed=(
        "{optimum} (mit Konstantfahrt zusammengesetzt; bewiesen: nicht unter {bound})"
    ),
    reference_note=(
        "Der Vergleichswert bringt die Nennmaschine mit idealer Steuerung in exakte Ruhe; die "
        "Empfehlung ist eingeschwungen, sobald das Werkzeug in der zulässigen Abweichung bleibt."
    ),
    first_look_caption="{move}: Sollwert, Antwort und TCP-Abweichung, Nennmaschine",
    first_look_alt=(
        "Beschleunigung von Sollwert und Antwort sowie TCP-Abweichung über der Zeit: höchstens "
        "{peak}, eingeschwungen nach {settling}."
    ),
    checks_caption="Anforderungen",
    data_source="Quelle der Maschinendaten: {source}",
    warning_count="Warnungen: {count}, siehe Abschnitt Nachweise und Annahmen.",
    check="Anforderung",
    found="Gefunden",
    permitted="Zulässig",
    verdict="Urteil",
    where="Ungünstigster Fall",
    sparkline="Beschleunigungssollwert, {move}, {duration}:",
    # machine
    machine_heading="Maschine und Achse",
    data_caption="Daten, mit denen gerechnet wurde",
    machine_row="Maschine",
    axis_row="Achse",
    motion_row="Bewegungsart",
    linear="linear",
    rotary="rotatorisch",
    rigid_caption="Starre Achse",
    moving_mass="Bewegte Masse",
    moving_inertia="Bewegte Trägheit",
    controllability="Steuerbarkeit: Rang der Kalman-Matrix",
    of_states="{rank} von {count} Zuständen",
    modes_caption="Eigenformen der Struktur (ohne Regelung)",
    mode="Eigenform",
    tcp_gain="Verstärkung am Werkzeug",
    measured_gain="Verstärkung am Lagegeber",
    of_mode="{name} der Eigenform {mode}",
    peak_bound="{name}, größter Betrag",
    requirements_heading="Bewegungen und Anforderungen",
    requirements_caption="Was gefordert ist",
    # limits
    limits_heading="Empfohlene Grenzwerte",
    machining_caption="Grenzwerte je Bearbeitungsart, jede mit eigenem Band",
    machining_mode="Bearbeitungsart",
    machining_names=MappingProxyType(
        {
            "surface": "Oberfläche (Schlichten)",
            "accuracy": "Genauigkeit",
            "speed": "Geschwindigkeit (Schruppen)",
        }
    ),
    permitted_band="Band",
    bound_by_column="Begrenzt durch",
    alternatives_caption="Empfehlung und Alternativen, in derselben Simulation",
    limits_name="Grenzwerte",
    recommended="Empfohlen",
    rule_heading="Regel",
    rule_valid="Gültig für: {range}",
    rule_result=(
        "Von Hand: a = {acceleration}, j = {jerk} ({chosen}), vorhergesagte bleibende Abweichung "
        "{residual}. Die Suche oben braucht keine Regel; sie dient zur Kontrolle mit dem "
        "Taschenrechner."
    ),
    rule_steps_caption="Die Regel, von Hand auf diese Maschine angewandt",
    rule_step="Schritt",
    rule_how="Formel",
    rule_value="Wert",
    rules_heading="Vergleich mit Faustregeln",
    rules_caption=(
        "Regeln von Herstellern und Lehrbüchern, in derselben Simulation (ungünstigste Bewegung, "
        "ungünstigster Eckfall)"
    ),
    rule="Regel",
    meets="Alles erfüllt",
    compare_caption="Einschwingzeit gegen Restabweichung: Empfehlung, Alternativen und Regeln",
    compare_alt=(
        "Jeder Punkt ist eine Wahl der Grenzwerte; weiter links schwingt früher ein, weiter unten "
        "schwingt weniger nach. Empfohlen: {settling} und {residual}. Die Zahlen stehen in den "
        "Tabellen."
    ),
    unsettled_rules="Nicht eingeschwungen, daher nicht im Diagramm: {names}.",
    band="Band {band}",
    landscape_heading="Kennfeld der Einschwingzeit",
    landscape_caption="Größte Einschwingzeit über Beschleunigung und Ruckzeit",
    landscape_alt=(
        "Kennfeld über {rows} Beschleunigungen und {columns} Ruckzeiten; Einschwingzeiten von "
        "{least} bis {most}; der gewählte Punkt liegt bei {acceleration} und {jerk_time}."
    ),
    chosen="gewählt",
    residual_border="Restabweichung = Band {band}",
    usage_border="Kraft, Effektivkraft oder ein Höchstwert gerade erreicht",
    hatched="{caption} (schraffiert: nicht eingeschwungen)",
    # two records
    differences_heading="Änderungen seit dem früheren Protokoll",
    compared_with=(
        "Verglichen mit: {machine}, Achse {axis}, berechnet am {created}, Profil {name}, "
        "SHA-256 {hash}."
    ),
    changed_inputs="Maschine, Bewegungen und Anforderungen: was sich geändert hat",
    no_changed_inputs=(
        "Maschine, Bewegungen und Anforderungen sind in beiden Protokollen dieselben."
    ),
    changed_limits="Grenzwerte, vorher und nachher",
    changed_result="Ergebnis, vorher und nachher",
    changed_loop="Regelkreis, vorher und nachher",
    before="Vorher",
    after="Nachher",
    change="Änderung",
    changed="geändert",
    unchanged="gleich",
    not_stated="nicht angegeben",
    state_feedback_used="Zustandsrückführung",
    # motion
    motion_heading="Optimum, Empfehlung und Antwort",
    drive_caption="{move}: Kraft, Beschleunigung und Geschwindigkeit",
    vibration_caption="{move}: Schwingung und TCP-Abweichung",
    motion_alt=(
        "Verläufe über der Zeit: {signals}. Sollkraft der Antwort höchstens {force}; das Werkzeug "
        "weicht höchstens {peak} vom Sollwert ab und ist nach {settling} eingeschwungen."
    ),
    motion_note=(
        "Alle Diagramme einer Bewegung haben dieselbe Zeitachse. Optima enden bei t_f in exakter "
        "Ruhe; ihre Beschleunigung und die der Antwort ist F/m. Der Sollwert ist gezeigt wie "
        "vorgegeben; die Abweichung zählt gegen den um {delay} verzögerten Sollwert."
    ),
    time_optimal="zeitoptimal",
    constrained="zeitoptimal, beschränkt",
    damping_optimal="dämpfungsoptimal",
    setpoint="Sollwert",
    response="Antwort des Regelkreises",
    deviation="TCP-Abweichung",
    peaks_caption="{move}: größte Beträge",
    signal_head="Signal",
    mode_deflection="Auslenkung der Eigenform {mode}",
    mode_rate="Auslenkungsgeschwindigkeit der Eigenform {mode}",
    amplitudes_caption="{move}: Amplituden am Werkzeug nach dem Ende des Sollwerts",
    amplitude="Amplitude",
    setpoint_caption="{move}: Abschnitte des Sollwerts",
    duration="Dauer",
    segment="Abschnitt",
    moving_average="Gleitender Mittelwert (Ruckfilter) der Steuerung: {time}.",
    comparison_heading="Vergleich mit den optimalen Steuerungen",
    comparison_note=(
        "Nennmaschine. Im Regelkreis ist die Überführungszeit die Einschwingzeit; eine optimale "
        "Steuerung endet in exakter Ruhe. Überschwingen ist das der Werkzeuggeschwindigkeit "
        "(Geschwindigkeitssprung) oder der Werkzeuglage (Positionieren), bezogen auf das Ziel. "
        "Wärme ist das Integral der quadrierten Motorkraft."
    ),
    controls_caption="{move}: Wege, die Bewegung auszuführen",
    control="Steuerung",
    transfer_time="Überführungszeit",
    overshoot="Überschwingen",
    peak_of="Höchstwert {name}",
    heat="Wärme",
    work="Arbeit",
    fed_forward_caption=(
        "{move}: die optimale Steuerung selbst als Vorsteuerung, an der Nennmaschine und an einer "
        "etwas anderen"
    ),
    saturated_share="Zeitanteil ohne Kraftreserve",
    continuous_check=(
        "Gegenprobe: derselbe Sollwert schwingt in einer kontinuierlichen Näherung des "
        "Regelkreises nach {settling} ein (abgetastet: {sampled}), Restabweichung {residual}."
    ),
    # loop
    loop_heading="Regelkreis",
    diagram_caption="Struktur des Regelkreises",
    diagram_alt=(
        "Blockschaltbild: Lageregler {kv}, Geschwindigkeitsregler {kp} mit Nachstellzeit {tn}, "
        "Vorsteuerung von Geschwindigkeit, Beschleunigung und Ruck, Kraftgrenze und "
        "Kraftregelkreis, Mechanik, Rückführung des Lagegebers. Zustandsrückführung: {feedback}."
    ),
    diagram_delay="Verzögerung",
    diagram_cycle="Takt {cycle}",
    diagram_mechanics="Mechanik",
    diagram_modes="Eigenformen: {count}",
    diagram_observer="Beobachter",
    diagram_gains="{count} Werte, s. Tabelle",
    gains_caption="Reglerparameter",
    margins_caption="Stabilität, Kreis an der Sollkraft aufgetrennt",
    margin="Reserve",
    nominal="Nennmaschine",
    worst_corner="Ungünstigster Eckfall",
    gain_margin="Amplitudenreserve",
    phase_margin="Phasenreserve",
    sensitivity_peak="Maximum der Empfindlichkeit",
    bandwidth="Bandbreite des Geschwindigkeitsregelkreises (−3 dB)",
    reference_delay="Sollwertverzögerung τ",
    feedforward="Vorsteuerung: {name}",
    state_feedback="Zustandsrückführung von {name}",
    no_state_feedback="Keine Zustandsrückführung.",
    sensors="Geber: {names}.",
    observed="Beobachtete Zustände: {names}.",
    position_cycle="Lagereglertakt",
    velocity_cycle="Geschwindigkeitsreglertakt",
    variants_caption="Regelkreis mit und ohne Zustandsrückführung, je mit den besten Grenzwerten",
    variant_used="{name} (verwendet)",
    damping_of="Dämpfungsgrad der Eigenform {mode}",
    dynamic_stiffness="Kleinste dynamische Steifigkeit am Werkzeug",
    stiffness_at="{stiffness} bei {frequency}",
    bode_caption=(
        "Frequenzgang: offener Kreis (an der Sollkraft aufgetrennt), geschlossener "
        "Geschwindigkeitsregelkreis"
    ),
    bode_alt=(
        "Betrag und Phase über der Frequenz. Amplitudenreserve {gain}, Phasenreserve {phase}, "
        "Bandbreite des Geschwindigkeitsregelkreises {bandwidth}."
    ),
    magnitude="Betrag in dB",
    phase="Phase in °",
    open_loop="offener Kreis",
    closed_velocity="geschlossener Geschwindigkeitsregelkreis",
    poles_caption="Pole des geschlossenen Kreises, langsamste zuerst",
    real_part="Realteil",
    remarks="Bemerkungen",
    corners_heading="Eckfälle",
    corners_caption="{move}: Antwort in jedem Eckfall",
    payload="Zuladung",
    frequencies="Frequenzen",
    dampings="Dämpfungen",
    max_force="Größte Sollkraft",
    rms_force="Effektivkraft",
    saturated="Gesättigt",
    # evidence
    evidence_heading="Nachweise und Annahmen",
    certificate_caption="{move}: {what}",
    final_time="Endzeit t_f",
    method="Verfahren",
    cost="Kosten",
    switches="Schaltzeitpunkte",
    largest_error="Größter Endfehler, bezogen auf den Höchstwert seines Zustands",
    weights="Gewichte",
    assumptions="Annahmen",
    warnings="Warnungen",
    settings_caption="Numerische Einstellungen",
    setting="Einstellung",
    versions_heading="Versionen und Profil",
    versions_caption="Gerechnet mit",
    program="Programm",
    version="Version",
    created="Berechnet am",
    hash_row="SHA-256 des Profils",
    profile_caption="Profil {name}, wie gelesen",
    # measurements
    measure_heading="Messungen an der Maschine",
    measure_note=(
        "Die Werte gelten für die Nennmaschine ohne Zuladung. Liegt eine Frequenz außerhalb des "
        "zulässigen Bereichs: Profil berichtigen und neu rechnen, bevor die Grenzwerte gelten. "
        "Bewegungen: {moves}."
    ),
    measure_how=(
        "Eigenfrequenzen und Dämpfungsgrade: Impulshammer und Beschleunigungsaufnehmer am Werkzeug "
        "oder Frequenzgang des Antriebs; Regelung aus, Bremse gelöst, Mitte des Verfahrwegs.",
        "Bewegte Masse: Motorkraft durch Beschleunigung bei gleichbleibender Beschleunigung, ohne "
        "die Reibung (Mittel aus beiden Richtungen).",
        "Reserven und Bandbreite: Frequenzgang mit der Messfunktion der Steuerung, Kreis an der "
        "Sollkraft aufgetrennt.",
        "Abweichungen und Einschwingzeit: Laserinterferometer oder Beschleunigungsaufnehmer am "
        "Werkzeug, mit den Grenzwerten dieses Protokolls, gegen den verzögerten Sollwert.",
        "Kräfte: Aufzeichnung des Antriebs (Kraft- oder Stromsollwert).",
    ),
    measure_caption="Berechnete und gemessene Werte",
    measurement="Messung",
    calculated="Berechnet",
    measured="Gemessen",
    difference="Differenz",
    measured_by="Datum, Name",
    measure_fields=(
        "Messmittel (Typ, Nummer, kalibriert bis)",
        "Zustand der Maschine (Stellung der anderen Achsen, Zuladung, Temperatur)",
    ),
    # entry and signature
    entry_heading="Einzugebende Parameter und Unterschrift",
    entry_caption="Werte für die Steuerung",
    parameter="Parameter",
    also="In anderer Einheit",
    old_value="Alter Wert",
    new_value="Neuer Wert",
    entered_by="Eingegeben von",
    verified="Geprüft",
    entry_note="Vor Gebrauch prüfen. Den Ruck nie auf-, die Ruckzeit nie abrunden.",
    signature_fields=(
        "Maschinennummer, Aufstellort",
        "An der Steuerung eingegeben (Datum, Name, Unterschrift)",
        "An der Maschine geprüft (Datum, Name, Unterschrift)",
        "Bemerkungen",
    ),
)
