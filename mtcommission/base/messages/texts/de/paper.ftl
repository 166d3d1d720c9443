paper-place = Abschn. { $at }
paper-our-loop = eigener Regelkreis
paper-certified = bewiesenes Optimum
paper-certified-to = bewiesenes Optimum, relative Lücke { PLAIN($gap, digits: 1) }
paper-entry = λ(0) aus unserem Beweis bis zum Eintritt
paper-limits = a = { PLAIN($acceleration, digits: 3) } m/s², j = { PLAIN($jerk, digits: 3) } m/s³
paper-figure-caption = Bild { $number }: zeitoptimale Lösung, F_max = 2 kN{ $number ->
        [5] , |v_φ| ≤ 0,005 rad/s
       *[other] { "" }
    }
paper-kalman-rank = Rang der Kalman-Matrix
    .basis = { json-whole-number }
    .reason = Bestimmt nach Skalierung der Zustände. In SI-Einheiten sieht der Rang durch Rundung wie { $unscaled } aus.
paper-adjoint-equations = adjungierte Gleichungen: größter Fehler eines Koeffizienten, bezogen auf den größten
    .basis = Rundung; gedruckte Koeffizienten gegen -A unserer Strecke
paper-order = Ordnung der Beschränkung von v_φ
    .ours = Ordnung { $order }
    .basis = c A^(k-1) B unserer Strecke
paper-active-damping = Strukturschwingung durch die Regelung gedämpft
    .ours = Dämpfungsgrade von Gestell und Turm: { PLAIN($base, digits: 2) } und { PLAIN($tower, digits: 2) } ohne Regelung, { PLAIN($base_encoder, digits: 2) } und { PLAIN($tower_encoder, digits: 2) } mit dem Lagegeber allein, { PLAIN($base_sensed, digits: 2) } und { PLAIN($tower_sensed, digits: 2) } mit einem zweiten Geber am Werkzeug; ohne Ruckbegrenzung auf 5 µm eingeschwungen nach { PLAIN($encoder, digits: 0, style: "f", unit: "ms") } und { PLAIN($sensed, digits: 0, style: "f", unit: "ms") } ms
    .basis = { paper-our-loop }
    .reason = Der Regelkreis ist unser eigener, denn Bild 2 nennt keine Zahlen. Der Lagegeber allein sieht den Turm nicht: Gestell und Turm sind nicht gekoppelt. Mit einem zweiten kann die Regelung ihn dämpfen, und doch entscheidet der Sollwert, wie bald die Achse eingeschwungen ist.
paper-overshoot = Überschwingen am Ziel unter der Regelung
    .ours = die Geschwindigkeit am Werkzeug schwingt um { PLAIN($rough, digits: 1, style: "f", unit: "%") } % über (Rechteck), { PLAIN($least, digits: 1, style: "f", unit: "%") } bis { PLAIN($most, digits: 1, style: "f", unit: "%") } % (Trapeze so kurz wie die Optima), { PLAIN($smooth, digits: 1, style: "f", unit: "%") } % (für den Regelkreis gewähltes Trapez)
    .basis = { paper-our-loop }
    .reason = Es hängt vom Ruck ab: Grenzwerte, die zum Regelkreis passen, vermeiden es fast ganz.
paper-transfer-time = Überführungszeit unter der Regelung
    .ours = auf 5 µm eingeschwungen nach { PLAIN($smooth, digits: 1, style: "f", unit: "ms") } ms (für den Regelkreis gewähltes Trapez) bis { PLAIN($rough, digits: 1, style: "f", unit: "ms") } ms (Rechteck): das { PLAIN($smooth_share, digits: 1, style: "f") }- bis { PLAIN($rough_share, digits: 1, style: "f") }-Fache von { PLAIN($least, digits: 2, style: "f", unit: "ms") } ms
    .basis = { paper-our-loop }
    .reason = Als viel größer zählt das { PLAIN($much) }-Fache. Wie weit ein Regelkreis herunterkommt, hängt von seiner Einstellung ab, über die die Veröffentlichung nichts sagt.
paper-jerk-control = kurze Zeiten mit Dämpfung verlangen eine Ruckbegrenzung
    .ours = { $limits }: Höchstwert |v_φ| { PLAIN($smooth, digits: 1, style: "f", unit: "mrad") } statt { PLAIN($rough, digits: 1, style: "f", unit: "mrad") } mrad/s ohne Ruckbegrenzung; Einschwingzeiten in der Zeile davor
    .basis = { paper-our-loop }
paper-jerk-follows = wovon der mögliche Ruck abhängt
    .ours = Gestell bei { PLAIN($base_soft, digits: 1, style: "f") } / { PLAIN($base, digits: 1, style: "f") } / { PLAIN($base_stiff, digits: 1, style: "f") } Hz: j = { PLAIN($j_base_soft, digits: 1, style: "f") } / { PLAIN($j_base, digits: 1, style: "f") } / { PLAIN($j_base_stiff, digits: 1, style: "f") } m/s³; Turm bei { PLAIN($tower_soft, digits: 1, style: "f") } / { PLAIN($tower, digits: 1, style: "f") } / { PLAIN($tower_stiff, digits: 1, style: "f") } Hz: j = { PLAIN($j_tower_soft, digits: 1, style: "f") } / { PLAIN($j_tower, digits: 1, style: "f") } / { PLAIN($j_tower_stiff, digits: 1, style: "f") } m/s³
    .basis = Grenzwerte für jede Maschine neu gewählt; { paper-our-loop }
    .reason = Hier bestimmt das Gestell, die Eigenform, die der Lagegeber sieht. Eine Regel wird in docs/commissioning-rule.md hergeleitet und steht auf dem Blatt. Grenzen und Regler werden jedes Mal neu bestimmt; 6 % weniger Ruck kosten nur 2 % Einschwingzeit, kleinere Unterschiede besagen also nichts.
paper-switching-time = t_{ $number }
    .basis = der Text: „correct up to 3-4 decimals“
paper-final-time = t_f
    .basis = { paper-switching-time.basis }
    .reason = Keine Steuerung erreicht das Ziel vor { PLAIN($least, digits: 9, style: "f") } s (bewiesen), das gedruckte t_f ist also zu kurz. Explizite Euler-Schritte irren in diese Richtung, im Verhältnis der Schrittweite.
paper-terminal-error = { $state }(t_f) der gedruckten Steuerung, exakt integriert
    .basis = { PLAIN($share) } des Höchstwerts: drei Dezimalen von (12)
paper-adjoint = λ_{ $state }(0)
    .basis = was 1e-4 s in den Schaltzeiten ausmachen, und 0,1 %
paper-adjoint-implied = λ(0), das die gedruckten Zeiten (12) ergeben: größte relative Abweichung
    .basis = zwei der gedruckten Stellen
    .reason = Zeiten und Adjungierte der Veröffentlichung passen auf { PLAIN($deviation, digits: 1, style: "f", unit: "%") } % zueinander; die Rundung von (12) auf 1e-6 s erklärt { PLAIN($rounding, digits: 1, unit: "%") } %. Was unser λ(0) sonst vom gedruckten trennt, bis zu { PLAIN($off, digits: 1, style: "f", unit: "%") } %, sind die Zeiten, vor allem die des zweiten Bogens, der nur { PLAIN($arc, digits: 2, style: "f", unit: "ms") } ms lang ist.
paper-hamiltonian = H bei t = 0 mit dem gedruckten λ(0)
    .basis = drei Stellen
    .reason = H = 0 verlangt λ_F(0) = -T / F_max = -1,25e-6; gedruckt ist -1,2503e-6.
paper-switching-law = Schaltgesetz
    .ours = gilt im ganzen Intervall; { $zeros } Nullstellen von λ_F, an den Umschaltungen
    .basis = Beweis, und Nullstellen der davon getrennt integrierten Adjungierten
paper-law-as-printed = der Leser kann (9) mit dem gedruckten λ(0) nachprüfen
    .ours = vorwärts integriert hat λ_F { $forward } Nullstellen statt 5, die letzte bei { PLAIN($last, digits: 1, style: "f", unit: "ms") } ms; rückwärts ab H = 0 hat es { $backward }, um bis zu { PLAIN($off, digits: 2, style: "f", unit: "ms") } ms daneben
    .basis = (8) mit Matrixexponentialfunktionen
    .reason = Die Kraftverzögerung lässt Fehler von λ(0) wie e^(t/T) wachsen, über t_f auf das { PLAIN($growth, digits: 1) }-Fache: sechs oder sieben gedruckte Stellen reichen nicht. Das Gesetz selbst gilt, siehe die Zeile davor.
paper-jacobian-rank = Rang der 6 x 6-Jacobi-Matrix der Endbedingungen
    .basis = { json-whole-number }
    .reason = Voller Rang beweist ein strenges lokales Optimum; dass es das globale ist, beweist unsere untere Schranke, mit einer relativen Lücke von { PLAIN($gap, digits: 1) }.
paper-switches = Zahl der Umschaltungen bei F_max = 2 kN
    .ours = { $switches }, { $control } zuerst
    .basis = { paper-certified }
paper-switches-everywhere = Zahl der Umschaltungen für alle F_max > 0
    .ours = { $found ->
        [0] überall { $usual }
       *[other] { $usual }, aber { $exceptions }
    }
    .basis = { $count } bewiesene Optima von { PLAIN($lowest) } bis { PLAIN($highest, digits: 6) } N, größte relative Lücke { PLAIN($gap, digits: 1) }
    .reason = Im eigenen Bereich der Maschine (F_max ≤ { PLAIN($range, unit: "kN") } kN) öffnet sich eine doppelte Nullstelle der Schaltfunktion zu zwei weiteren Umschaltungen. Das Optimum ist eindeutig und bewiesen, fünf Umschaltungen sind dort also langsamer. Der kürzeste Bogen ist höchstens { PLAIN($arc, digits: 0, style: "f", unit: "us") } µs lang: auf einem Gitter leicht verloren. Zwischen den betrachteten Kräften ist nichts bewiesen.
paper-switches-between = { $switches } von { PLAIN($lowest, digits: 1, style: "f") } bis { PLAIN($highest, digits: 1, style: "f") } N
paper-switches-beyond = Zahl der Umschaltungen jenseits dieser Kräfte
    .ours = { $usual } von { PLAIN($highest, digits: 6) } bis { PLAIN($farthest, digits: 6) } N, wo t_f = { PLAIN($t_f, digits: 3, style: "f", unit: "ms") } ms ist; unter { PLAIN($weak) } N verschieben sich die Umschaltungen, von t_f aus gezählt, um weniger als { PLAIN($moved, digits: 2, unit: "ns") } ns
    .basis = { $count } bewiesene Optima, für den Rest die Theorie
    .reason = In weniger als { PLAIN($half, digits: 3, style: "f", unit: "ms") } ms, einer halben gedämpften Periode des Turms, hat keine Kombination von 1, e^(-t/T) und den Funktionen der Eigenformen mehr als fünf Nullstellen, und fünf Ruhebedingungen brauchen mindestens fünf Umschaltungen. Kleine Kräfte bewegen so lange, dass am Ende abgeklungen ist, was der Anfang anregt: dort sind die Umschaltungen die eines Grenzfalls.
paper-bounded-time = t_f unter |v_φ| ≤ 0.005
    .basis = eine Einheit der letzten gedruckten Dezimale
    .reason = Keine Steuerung ist schneller als { PLAIN($least, digits: 9, style: "f") } s (bewiesen): auf vier Dezimalen 0,0523. Wieder ist die gedruckte Zeit ein wenig zu kurz, sodass t_f = 0,0522 s aus Abschn. 6 unter der Schranke nicht erreichbar ist.
paper-increase = Zunahme von t_f gegenüber (12), relativ
    .basis = 1e-4 s in jeder der Zeiten
    .reason = Die eigenen zwei Zeiten der Veröffentlichung ergeben { PLAIN($own, digits: 4) }; damit ist unser Wert verglichen.
paper-boundary-arcs = Randbögen
    .ours = { $held }
    .basis = { paper-certified-to }
paper-bang-arcs = Bögen voller Kraft davor, dazwischen und danach
    .ours = { $arcs }; Berührpunkte: { $count ->
        [0] keine
       *[other] { $touches }
    }
    .basis = { paper-certified-to }
    .reason = Der kürzeste Bogen ({ $control }, { PLAIN($length, digits: 1, style: "f", unit: "us") } µs ab { PLAIN($start, digits: 3, style: "f", unit: "ms") } ms) ist { PLAIN($steps, digits: 1, style: "f") } Schritte des Gitters von 10000 der Veröffentlichung lang, und ein Berührpunkt ist ein Augenblick: beides geht auf einem Gitter leicht verloren. Eine Beschränkung der Ordnung 2 lässt beides zu.
paper-touch = { $side } bei { PLAIN($t, digits: 3, style: "f", unit: "ms") } ms
paper-second-derivative = zweite Ableitung von S_1
    .ours = relativer Fehler der gedruckten Formel { PLAIN($off, digits: 1) }, berichtigt { PLAIN($off_corrected, digits: 1) }
    .basis = c A (A x + B F_set) entlang der zeitoptimalen Steuerung
    .reason = Druckfehler: es fehlen Faktoren 1/J; auch die Einheiten zeigen es.
paper-boundary-control = Steuerung auf dem Rand
    .ours = auf unseren Randbögen liegt die gedruckte Formel um bis zu { PLAIN($off, digits: 2) } F_max daneben, die berichtigte um { PLAIN($off_corrected, digits: 1) } F_max
    .basis = F_set der bewiesenen Steuerung
    .reason = Druckfehler: es fehlen dieselben Faktoren 1/J.
paper-inside = Steuerung auf dem Rand innerhalb der zulässigen Menge
    .ours = |F_set| ≤ { PLAIN($largest, digits: 1, style: "f") } N auf den Randbögen, F_max = { PLAIN($limit, digits: 6) } N
    .basis = { paper-certified }
paper-switching-function = Schaltfunktion auf dem Randbogen
    .ours = beim Eintritt null bis auf { PLAIN($at_entry, digits: 1) } von |λ_F(0)|
    .basis = { paper-entry }, mit Matrixexponentialfunktionen
    .reason = Druckfehler: die Indizes I und U gehören zu einer anderen Maschine, einem Tauchspulmotor.
paper-multiplier = Multiplikator µ_1 der Schranke
    .correct = dasselbe + d/J λ_vφ
    .ours = mit der gedruckten Formel läuft λ_F auf { PLAIN($drift, digits: 2) } von |λ_F(0)| weg, mit der berichtigten auf { PLAIN($held, digits: 1) }; µ_1 ≥ { PLAIN($least, digits: 0, style: "f") } s/rad auf dem Bogen
    .basis = (8) mit µ_1 entlang unseres ersten Randbogens; λ_F muss 0 bleiben
    .reason = Druckfehler: d² λ_F / dt² = 0 enthält auch d/J λ_vφ, und λ_vφ verschwindet auf dem Bogen nicht.
paper-jumps = Sprünge der Adjungierten bei Ein- und Austritt
    .ours = beim ersten Eintritt von { PLAIN($before, digits: 5) } auf { PLAIN($after, digits: 5) } s²/rad
    .basis = { paper-entry }; innen legt d λ_F/dt = 0 sie fest
    .reason = Abwärts, wie die obere Schranke es verlangt; von dort hält µ_1 λ_F auf 0.
paper-peak-rate = Höchstwert von v_φ, { $control ->
        [damping] dämpfungsoptimal
        [bounded] zeitoptimal mit Schranke
       *[free] zeitoptimal ohne Schranke
    }
    .correct = v_φ statt φ
    .basis = 0,2 %; 1e-4 s in t_f machen 0,5 % aus
    .reason = Druckfehler: gedruckt als Maximumnorm von φ; es ist die von v_φ. φ selbst bleibt unter { PLAIN($angle, digits: 2) } rad.
paper-weight = Gewicht von { $state }
    .basis = 2 %: ein Gitter verwischt die Umschaltungen der Bewegung, die ausgeglichen wird
paper-terms = Terme des Funktionals
    .ours = 1 : { PLAIN($x_b, digits: 3) } : { PLAIN($phi, digits: 3) } : { PLAIN($v_b, digits: 3) } : { PLAIN($v_phi, digits: 3) } entlang der dämpfungsoptimalen Bewegung, J = { PLAIN($cost, digits: 7) } N² s
    .basis = innerhalb einer Dekade
    .reason = F_set², x_b, φ, v_b, v_φ. Die Veröffentlichung sagt nicht, entlang welcher Bewegung; gleiche Integrale aller Terme entlang der zeitoptimalen Bewegung aus Abschn. 5.1 ergeben alle vier Gewichte auf { PLAIN($off, digits: 1, style: "f", unit: "%") } %. Die beiden Geschwindigkeiten sind das, was die Optimierung dann senkt.
paper-control-law = größte Abweichung vom Steuergesetz, bezogen auf F_max
    .basis = entlang der ganzen Bewegung, mit der Adjungierten unserer Lösung
    .reason = Das Problem ist konvex: wo eine Adjungierte passt, ist die Steuerung optimal.
paper-continuous = die optimale Steuerung ist stetig
    .ours = größter Sprung { PLAIN($jump, digits: 1) } F_max, an den Stößen von { $arcs } Bögen
    .basis = Enden benachbarter Bögen
paper-saturated = linear-quadratisch mit Sättigung
    .ours = Bögen: { $arcs }; max |F_set| { PLAIN($largest, digits: 1, style: "f") } N
    .basis = Bögen der dämpfungsoptimalen Steuerung
paper-functional = Matrix D und adjungierte Gleichung des Funktionals
    .ours = { $states } Zustände; mit der berichtigten Gleichung gilt (16), siehe oben
    .basis = Zahl der Zustände
    .reason = Druckfehler: sechs Einträge für sieben Zustände, und der Punkt über λ fehlt.
paper-least-time = t_f muss größer als die kürzeste Zeit sein
    .ours = t_f = { PLAIN($longer, digits: 6) } s wird gelöst; keine Steuerung erreicht das Ziel vor { PLAIN($least, digits: 9, style: "f") } s
    .basis = untere Schranke aus dem Beweis
paper-oscillation = zeitoptimale Bewegungen schwingen
    .ours = v_φ wechselt in { PLAIN($t_f, digits: 1, style: "f", unit: "ms") } ms { $changes }-mal das Vorzeichen und erreicht bis zu { PLAIN($rate, digits: 1, style: "f", unit: "mrad") } mrad/s
    .basis = die bewiesene Steuerung aus Abschn. 5.1
paper-more-force = größeres F_max führt zu stärkeren Schwingungen
    .ours = von { PLAIN($least) } bis { PLAIN($most) } N wächst der Höchstwert von |v_φ| von { PLAIN($rate, digits: 1, style: "f", unit: "mrad") } auf { PLAIN($highest_rate, digits: 1, style: "f", unit: "mrad") } mrad/s, der von |φ| von { PLAIN($angle, digits: 0, style: "f", unit: "urad") } auf { PLAIN($largest_angle, digits: 0, style: "f", unit: "urad") } µrad
    .basis = { $count } bewiesene Optima in gleichen Verhältnissen
    .reason = { $falls ->
        [0] {""}
       *[other] Eine Tendenz, kein Gesetz: bei { $falls } der { $steps } Schritte zwischen diesen Kräften fällt der Höchstwert von |v_φ|.
    }
paper-bound-helps = die Schranke für v_φ senkt auch das größte |φ|
    .ours = von { PLAIN($free, digits: 1, style: "f", unit: "urad") } auf { PLAIN($bounded, digits: 1, style: "f", unit: "urad") } µrad, um { PLAIN($less, digits: 0, style: "f", unit: "%") } %
    .basis = Höchstwerte der beiden bewiesenen Steuerungen
paper-rate-between = größte Drehgeschwindigkeit der dämpfungsoptimalen Steuerung zwischen den beiden anderen
    .ours = { PLAIN($rate, digits: 2, style: "f", unit: "mrad") } mrad/s: das { PLAIN($over, digits: 2, style: "f") }-Fache der Schranke, { PLAIN($share, digits: 0, style: "f", unit: "%") } % der freien zeitoptimalen Steuerung
    .basis = dämpfungsoptimale und bewiesene zeitoptimale Steuerung, F_max = { PLAIN($limit) } N
paper-bounds-damp = Zustandsbeschränkungen verbessern die Dämpfung
    .ours = Höchstwert von |v_φ| um { PLAIN($less, digits: 0, style: "f", unit: "%") } % kleiner für { PLAIN($longer, digits: 0, style: "f", unit: "%") } % mehr Zeit
    .basis = die beiden bewiesenen Steuerungen
paper-hints = optimale Steuerungen geben Hinweise für die Ruckgrenze
    .ours = die Profile, die den Optima am nächsten kommen, haben j = { PLAIN($free, digits: 0, style: "f") } / { PLAIN($bounded, digits: 0, style: "f") } / { PLAIN($damped, digits: 0, style: "f") } m/s³ und sind im Regelkreis bestenfalls nach { PLAIN($soonest, digits: 0, style: "f", unit: "ms") } ms eingeschwungen; { $limits } nach { PLAIN($settling, digits: 0, style: "f", unit: "ms") } ms
    .basis = { paper-our-loop }
    .reason = Eine optimale Kraft löscht die Schwingung durch ihre Umschaltungen, die kein ruckbegrenztes Profil hat. Die Hinweise sind also obere Schranken und Startwerte; die Grenzwerte selbst sind im geschlossenen Regelkreis zu suchen.
