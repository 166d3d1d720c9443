"""German texts of the sheet, with the drive engineer's terms."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from mtcommission.sheet.labels_en import Labels
from mtcommission.sheet.phrases import Phrases
from mtcommission.sheet.phrases_de import PHRASES

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

ROTARY_WORDS: Phrases = (
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
"""What is said otherwise on a rotary axis, article and ending first."""

GERMAN = Labels(
    language="de",
    decimal_mark=",",
    names=NAMES,
    phrases=PHRASES,
    original="{text} [Originaltext]",
    rotary_words=ROTARY_WORDS,
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
    no_jerk_limit="ohne Grenze",
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
    reference_bounded=(
        "Mit Höchstwerten braucht der Vergleichswert {optimum}; die Empfehlung: {change}."
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
    further_warnings="Weitere Warnungen: {count}, siehe Abschnitt Nachweise und Annahmen.",
    check="Anforderung",
    found="Gefunden",
    permitted="Zulässig",
    verdict="Urteil",
    where="Ungünstigster Fall",
    warning="Warnung: {warning}",
    could_be_met="Erreichbar: {requirement} {value} statt {limit}.",
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
    attainable="Erreichbar",
    attainable_caption=(
        "Was stattdessen erreichbar wäre, allein oder mit den genannten, alle anderen eingehalten"
    ),
    attainable_band="{reason}; erreichbar wäre ein Band von {band}",
    alternatives_caption="Empfehlung und Alternativen, in derselben Simulation",
    limits_name="Grenzwerte",
    recommended="Empfohlen",
    rule_heading="Inbetriebnahmeregel, von Hand angewandt",
    rule_valid="Gültig für: {range}",
    rule_result=(
        "Von Hand: a = {acceleration}, j = {jerk} (Rampe: {chosen}; begrenzt durch: {bound}), "
        "vorhergesagte Restabweichung {residual}. Die Suche braucht keine Regel; diese dient zur "
        "Kontrolle mit dem Taschenrechner."
    ),
    rule_steps_caption="Die Regel, Schritt für Schritt",
    rule_symbols_caption=(
        "Formelzeichen der Regel (Index i: eine Eigenform; Werte je Eigenform: {modes})"
    ),
    rule_symbols=MappingProxyType(
        {
            "a": "Beschleunigung nach der Regel",
            "j": "Ruck nach der Regel",
            "t_j": "Ruckzeit nach der Regel, a/j",
            "band": "Zulässige TCP-Abweichung",
            "F": "Für die Bewegung verfügbare Kraft",
            "v": "Geschwindigkeitsänderung oder größte Geschwindigkeit jeder Bewegung",
            "L": "Weg jeder Positionierbewegung",
            "m": "Bewegte Masse; in der Kraftbedingung mit der größten Zuladung",
            "m_ff": "Masse in der Vorsteuerung",
            "T": "Zeitkonstante des Kraftregelkreises",
            "f": "Eigenfrequenz",
            "omega": "Eigenkreisfrequenz",
            "zeta": "Dämpfungsgrad einer Eigenform",
            "g": "Anteil einer Eigenform am Werkzeug, allein oder gegen den Lagegeber; der größere",
            "c": "Anteil einer Eigenform am Lagegeber",
            "R": "Anteil der Schwingung einer Eigenform, den eine Rampe übrig lässt",
            "x": "Länge einer Rampe in Perioden einer Eigenform, f t_j",
            "i": "Imaginäre Einheit (als Index: Nummer der Eigenform)",
        }
    ),
    symbol="Zeichen",
    meaning="Bedeutung",
    rule_step="Schritt",
    rule_how="Formel",
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
        "Regelkreises nach {settling} ein (abgetastet: {sampled}; {settling_difference}), "
        "Restabweichung {residual} ({residual_difference})."
    ),
    continuous_unsettled=(
        "Gegenprobe: in einer kontinuierlichen Näherung des Regelkreises schwingt derselbe "
        "Sollwert nicht ein (abgetastet: {sampled}); sie taugt hier nicht zur Probe, und nichts "
        "wird nach ihr beurteilt."
    ),
    claims=(
        "Die Veröffentlichung sagt: ein Sollwert im Regelkreis schwingt am Ende über und braucht "
        "viel länger als die kleinste Zeit. Hier gemessen:"
    ),
    why_not="Warum das Optimum nicht einfach eingegeben wird:",
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
    diagram_late="wirkt {time} später",
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
    gain_margin_up="Verstärkung darf steigen um",
    gain_margin_down="Verstärkung darf fallen um",
    bandwidth_short="Bandbreite",
    stiffness_short="Kleinste dynamische Steifigkeit",
    loop_corners_caption="Der Regelkreis in jedem Eckfall von Zuladung und Streuung",
    disturbance_caption="Antwort des Werkzeugs auf einen Kraftsprung in der Wirklinie des Antriebs",
    disturbance_alt=(
        "Auslenkung des Werkzeugs je Kraft über der Zeit, eine Kurve je Regelkreis. Größte Werte: "
        "{largest}."
    ),
    deflection="Auslenkung des Werkzeugs je Kraft",
    delays_caption="Verzögerungen in jedem Pfad des Regelkreises",
    path="Pfad",
    setpoint_age="Alter des Sollwerts",
    dead_time="Totzeit (ganze Takte)",
    hold="Mittleres Alter des gehaltenen Werts",
    lag="Verzögerungsglieder (Antrieb, Filter)",
    total="Summe",
    jerk_feedforward_caption=(
        "Was die Ruckvorsteuerung ändert, empfohlene Grenzwerte, ungünstigster Fall"
    ),
    jerk_weight="Gewicht der Ruckvorsteuerung",
    wanted_force="Verlangte Sollkraft, Spitze",
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
    corners_caption="{move}: Antwort in jedem Eckfall",
    payload="Zuladung",
    frequencies="Frequenzen",
    dampings="Dämpfungen",
    max_force="Größte Sollkraft",
    rms_force="Effektivkraft",
    saturated="Gesättigt",
    # robustness
    robustness_heading="Robustheit",
    kept_between=(
        "Weichen alle Eigenfrequenzen um denselben Faktor ab, sind alle Anforderungen von {low} "
        "bis {high} eingehalten."
    ),
    at_least="mindestens {value}",
    kept_nowhere=(
        "Die Anforderungen sind schon mit den Eigenfrequenzen des Profils nicht eingehalten; für "
        "einen Frequenzfehler bleibt nichts übrig."
    ),
    frequency_error="Fehler aller Eigenfrequenzen in %",
    frequency_error_caption=(
        "Restabweichung und Einschwingzeit über dem Fehler der Eigenfrequenzen, ungünstigste "
        "Zuladung und Dämpfung"
    ),
    frequency_error_alt=(
        "Zwei Kurven über dem gemeinsamen Fehler aller Eigenfrequenzen. Die Restabweichung liegt "
        "zwischen {least} und {most}; zulässig sind {band}."
    ),
    residual_error_caption=(
        "Restabweichung über dem Fehler der Eigenfrequenzen, ungünstigste Zuladung und Dämpfung"
    ),
    residual_error_alt=(
        "Eine Kurve über dem gemeinsamen Fehler aller Eigenfrequenzen. Die Restabweichung liegt "
        "zwischen {least} und {most}; zulässig sind {band}."
    ),
    no_settling_curve=(
        "Die Achse schwingt bei keinem der untersuchten Fehler der Eigenfrequenzen von {low} bis "
        "{high} ein; eine Kurve der Einschwingzeit gibt es daher nicht."
    ),
    no_error_curves=(
        "Die Achse schwingt bei keinem der untersuchten Fehler der Eigenfrequenzen von {low} bis "
        "{high} ein; Kurven von Restabweichung und Einschwingzeit gibt es daher nicht."
    ),
    nothing_drawn=(
        "Das Profil nennt weder eine Streuung von Frequenz oder Dämpfung noch einen Bereich der "
        "Zuladung; daher wurden keine Maschinen ausgelost."
    ),
    drawn=(
        "{samples} aus der angegebenen Streuung ausgeloste Maschinen (Zuladung, Frequenzen und "
        "Dämpfung je gleichverteilt und unabhängig; Startwert {seed}): {met} halten alle "
        "Anforderungen ein, {band} das Band."
    ),
    machines="Ausgeloste Maschinen",
    least="kleinster Wert",
    largest="größter Wert",
    share_of_machines="{share} liegen nicht darüber",
    quantiles_caption="Verteilung über die ausgelosten Maschinen, ungünstigste Bewegung",
    histogram_caption="{name} der ausgelosten Maschinen",
    histogram_alt=(
        "Histogramm: Werte von {low} bis {high}; die meisten Maschinen, {most}, bei {place}."
    ),
    worst_machine="größte Restabweichung",
    slowest_machine="längste Einschwingzeit",
    extremes_caption="Die ungünstigsten der ausgelosten Maschinen",
    sensitivities_caption=(
        "Was eine kleine Änderung kostet, ungünstigste Bewegung, ungünstigster Eckfall"
    ),
    what_changes="Was sich ändert",
    # other sizes of move
    sizes_heading="Kleinere und größere Bewegungen",
    sizes_note=(
        "Eine kleine Bewegung endet, bevor die Beschleunigung erreicht ist; ihre Rampen sind dann "
        "kürzer und löschen keine Schwingung. Die Tabelle sagt, für welche Bewegungen dieselben "
        "Grenzwerte das Band einhalten (ungünstigster Eckfall). Ein gleitender Mittelwert über "
        "eine Periode, wenn die Steuerung ihn hat, löscht die Schwingung bei jeder Bewegung; er "
        "ist gezeigt, wo er das Band bei allen kleineren Bewegungen einhält."
    ),
    sizes_caption="{move}: für welche Größen die Grenzwerte gelten",
    filter_time="Gleitender Mittelwert",
    full_from="Beschleunigung erreicht ab",
    kept_from="Band eingehalten ab",
    kept_to="Band eingehalten bis",
    never="nie",
    nowhere="nirgends",
    or_less="{value} oder weniger",
    or_more="{value} oder mehr",
    sizes_plot_caption=(
        "{move}: Restabweichung über der Größe der Bewegung, ungünstigster Eckfall"
    ),
    sizes_plot_alt=(
        "Restabweichung über der Größe der Bewegung, je eine Kurve für: {ways}. Zulässig sind "
        "{band}."
    ),
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
    settings_caption="Numerische Einstellungen: {names}",
    setting_names=MappingProxyType(
        {
            "gain_margin_db": "Verlangte Amplitudenreserve",
            "phase_margin_deg": "Verlangte Phasenreserve",
            "reserve_deg": "Für die Zustandsrückführung vorgehaltene Phase",
            "sensitivity_peak": "Zulässiges Maximum der Empfindlichkeit",
            "mode_weights": "Versuchte Gewichte der Eigenform für die Zustandsrückführung",
            "reduction": "Faktor von einem Versuch für Kp zum nächsten",
            "force_noise": "Kraftrauschen des Beobachters, bezogen auf F_max",
            "position_noise": "Geberrauschen des Beobachters",
            "least_acceleration": "Kleinste Beschleunigung, bezogen auf F_max/m",
            "least_jerk_time": "Kürzeste Ruckzeit",
            "longest_jerk_time": "Längste Ruckzeit, in Perioden der langsamsten Eigenform",
            "slow_jerk_time": "Längste Ruckzeit einer steifen Achse, mindestens",
            "grid": "Rasterpunkte je Richtung",
            "coarse_grid": "Rasterpunkte, an denen die Kraft simuliert wird",
            "seeds": "Gleichzeitig verfeinerte Zellen",
            "refinements": "Verfeinerungen, jede halbiert eine Zelle",
            "digits": "Signifikante Stellen des Ergebnisses",
            "samples": "Ausgeloste Maschinen, höchstens",
            "sample_cycles": "Über alle Maschinen simulierte Lagereglertakte, höchstens",
            "seed": "Startwert der Zufallszahlen",
            "frequency_range": "Größter versuchter Frequenzfehler, relativ",
            "frequency_points": "Versuchte Frequenzfehler",
            "landscape": "Punkte des Kennfelds je Richtung",
            "largest_fraction": "Größter versuchter Faktor auf Kp mit Zustandsrückführung",
            "mode_noise": "Rauschen der Eigenform im Beobachter, bezogen auf F_max",
            "evaluations": "In jedem Eckfall beurteilte Grenzwerte",
        }
    ),
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
    entry_heading="Parameter für die Steuerung",
    entry_caption="Werte für die Steuerung",
    parameter="Parameter",
    also="In anderer Einheit",
    old_value="Alter Wert",
    new_value="Neuer Wert",
    entered_by="Eingegeben von",
    verified="Geprüft",
    entry_note="Vor Gebrauch prüfen. Den Ruck nie auf-, die Ruckzeit nie abrunden.",
    signature_heading="Unterschrift",
    signed_values="{machine}, Achse {axis}: Beschleunigung {acceleration}, Ruck {jerk}.",
    signature_fields=(
        "Maschinennummer, Aufstellort",
        "An der Steuerung eingegeben (Datum, Name, Unterschrift)",
        "An der Maschine geprüft (Datum, Name, Unterschrift)",
        "Bemerkungen",
    ),
)
