ask-machine-name = Name der Maschine
ask-machine-axis = Name der Achse
ask-machine-axis-where = Der Achsbuchstabe in NC-Programmen, z. B. X, Y, Z, B, C.
ask-machine-motion = Linear- oder Drehachse
ask-machine-motion-where = Eine Drehachse nimmt Trägheitsmoment für Masse, Drehmoment für Kraft und Winkel für Längen.
ask-machine-source = Woher die Zahlen stammen
ask-machine-source-where = Z. B. Datenblatt und Datum, oder an der Maschine gemessen; steht auf dem Blatt.
ask-drive-kind = Servo oder gesteuerte Achse (Schrittmotor)
ask-drive-kind-where = Gesteuert: ein Schrittmotor, oder ein so steifer Servo, dass nur die Struktur schwingt; seine Frequenzen sind die bei gehaltenem Motor, wie ein Beschleunigungsaufnehmer sie zeigt.
ask-drive-max-acceleration-where = Was er bei größter Geschwindigkeit ohne Schrittverlust schafft; nach Datenblatt: Moment dort / (r x bewegte Masse).
ask-drive-max-velocity-where = Schritte je Sekunde der Steuerung x Weg je Schritt, oder wo das Moment endet.
ask-drive-max-velocity-empty = die jeder Bewegung
choice-servo = Servo
choice-position-source = gesteuert (Lagequelle)
ask-drive-max-force-where = { $axis ->
    [rotary] Datenblatt des Motors: Spitzenmoment x Übersetzung.
   *[linear] Datenblatt des Motors: Spitzenkraft; oder das Spitzenmoment an der Welle in N m, aus dem mit Steigung und Übersetzung eine Kraft wird.
}
ask-drive-force-lag-where = Stromregler des Antriebs: Anstiegszeit auf 63 %; Servoantriebe haben 0,5 bis 5 ms.
ask-drive-continuous-force-where = Datenblatt des Motors: Nenn- oder Stillstandswert, die thermische (Effektiv-)Grenze.
ask-drive-continuous-force-empty = keine thermische Grenze
ask-drive-static-load-where = { $axis ->
    [rotary] Gewichts- oder Prozessmoment, das der Antrieb hält; Schwenkachse außer Gleichgewicht: Masse x 9,81 m/s^2 x Abstand des Schwerpunkts; sonst 0.
   *[linear] Gewicht oder Prozesskraft, die der Antrieb hält; senkrechte Achse ohne vollen Gewichtsausgleich: Masse x 9,81 m/s^2; sonst 0.
}
ask-wizard-way = Von der Mechanik bekannt
ask-wizard-way-where = Motor und Last: zwei Massen, eine Feder. Bode-Diagramm: jede Eigenform mit Anteil am Werkzeug; eine Datei mit dem Frequenzgang beantwortet das alles: mit q aufhören, mtcommission identify DATEI -o PROFIL aufrufen und wiederkommen. Turm: Schlitten mit Werkzeugsäule auf nachgiebigem Gestell (Maschine der Veröffentlichung).
ask-mass-where = Gewichte der Stückliste oder CAD.
ask-plant-rotary-inertia-where = CAD; oder aus gemessener Kippfrequenz und Drehsteifigkeit.
ask-plant-lever-arm-where = Zeichnung: Linie des Motors oder der Spindel gegen die Führungen.
ask-plant-tcp-height-where = Zeichnung; negativ, wenn der Turm rückwärts kippt, wenn er vorwärts geschoben wird.
ask-stiffness-where = Datenblatt der Aufstellelemente und Führungen, oder aus einer Messung: k = m (2 pi f)^2, bei Drehung mit dem Trägheitsmoment statt m.
ask-damping-where = d = 2 x Dämpfungsgrad x sqrt(k m), bei Drehung mit dem Trägheitsmoment statt m; üblich sind 0,02 bis 0,05.
ask-moves-distance = Bewegung { $number }: Weg oder Endgeschwindigkeit
ask-moves-distance-empty = keine mehr
ask-moves-distance-where = Die Grenzwerte gelten für alle Bewegungen der Liste: die typische und die schwerste, z. B. eine kurze und eine lange.
ask-moves-max-velocity-where = Eilgang der Achse, aus der Steuerung oder ihrem Datenblatt.
ask-moves-dwell-where = Kühlt den Motor: mit 0 s fährt die Achse ohne Pause, und { $axis ->
    [rotary] das Dauermoment
   *[linear] die Dauerkraft
} kann Beschleunigung kosten. Enter allein gilt als angenommen.
ask-moves-velocity-step = Bewegung { $number }: Geschwindigkeit am Ende
ask-requirements-tcp-deviation-where = Die halbe Toleranz, die der Schwingung bleibt, nicht die ganze Toleranz des Teils.
ask-requirements-max-settling-time-where = Taktzeitrechnung: vom Beginn der Bewegung, bis das Werkzeug ruht.
ask-requirements-frequency-spread-where = 5 % für gemessene Werte, 10 bis 20 % für gerechnete; macht etwas langsamer. Mit 0 % passen die Grenzwerte genau zu diesen Frequenzen.
ask-requirements-damping-spread-where = Dämpfung ist selten besser als auf 30 % bekannt, aber es macht wenig aus.
ask-requirements-payload = Größte Zuladung
ask-requirements-payload-where = Werkstück, Palette oder Werkzeug; die Grenzwerte gelten dann von leer bis zu dieser.
ask-requirements-contour-deviation-where = Während der Bewegung. Nur für ein Werkzeug, das unterwegs arbeitet (Kontur); wer am Ende stillstehen muss, braucht keine.
ask-requirements-contour-deviation-empty = am Ende still
ask-control-kind-where = Was sie nicht hat, wird weder benutzt noch versprochen; fehlt die eigene, die allgemeine Kaskade nehmen. mtcommission export druckt Grenzwerte und Verstärkungen in ihren Namen.
ask-control-position-loop-where = Im Antrieb heißt DSC (SINUMERIK: MD32640 = 1); damit darf Kv höher sein. Unbekannt nimmt, was die Steuerung ohne Vorgabe tut, die nächste Zeile, und kennzeichnet es als angenommen.
ask-control-empty = wie in der Steuerung
ask-control-position-cycle-where = Steuerung: Interpolations- oder Lagereglertakt, 0,5 bis 4 ms.
ask-control-velocity-cycle-where = Antrieb: Takt des Drehzahlreglers; der Lagereglertakt ist ein ganzes Vielfaches.
ask-control-position-gain-where = Steuerung: Kv-Faktor; (m/min)/mm oder 1/s.
ask-gain-empty = wird eingestellt
ask-control-velocity-gain-where = { $axis ->
    [rotary] Antrieb: Verstärkung des Drehzahlreglers, auf die Achse umgerechnet: x Übersetzung^2.
   *[linear] Antrieb: Verstärkung des Drehzahlreglers, auf die Achse umgerechnet: x (2 pi / Steigung)^2.
}
ask-control-state-feedback = Zustandsrückführung
ask-control-integral-time-where = Antrieb: Nachstellzeit des Drehzahlreglers.
ask-control-integral-time-empty = wird eingestellt
ask-drive-lead-where = Spindel: Steigung; Ritzel: Teilkreis x pi. Rechnet Moment, Trägheit und Verstärkung an der Motorwelle auf die Achse um, und zurück.
ask-drive-lead-empty = Linearmotor
name-gear = { $axis ->
    [rotary] Motorumdrehungen je Umdrehung der Achse
   *[linear] Motorumdrehungen je Umdrehung von Spindel oder Ritzel
}
ask-drive-gear-where = { $axis ->
    [rotary] Getriebe; 1 bei einem Torquemotor.
   *[linear] Getriebe oder Riemen; 1, wenn der Motor direkt daran sitzt.
}
ask-drive-encoder-resolution-where = Geber und Antrieb: Signalperiode / Interpolation, oder Weg je Umdrehung / Striche.
ask-today-acceleration = Beschleunigung in der Steuerung heute
ask-today-acceleration-where = Das Blatt zeigt dann, was die heutigen Werte neben den empfohlenen bringen.
ask-today-jerk = Ruck in der Steuerung heute
ask-today-jerk-where = In Einheiten der Achse; hat die Steuerung eine Zeit: Beschleunigung / Zeit.
ask-pair-motor-mass = { $axis ->
    [rotary] Trägheitsmoment auf der Motorseite, an der Achse
   *[linear] Masse auf der Motorseite, an der Achse gesehen
}
ask-pair-motor-mass-where = { $axis ->
    [rotary] Rotor und Getriebe: Trägheitsmoment x Übersetzung^2.
   *[linear] Läufer, Kupplung, Spindel, Getriebe: ihr Trägheitsmoment an der Motorwelle in kg m^2, aus dem mit Steigung und Übersetzung eine Masse wird; bewegter Teil eines Linearmotors: seine Masse.
}
ask-pair-load-mass = { word-mass } auf der Werkzeugseite der Feder
ask-pair-load-mass-where = { $axis ->
    [rotary] Tisch oder Kopf mit allem, was er trägt.
   *[linear] Tisch, Portal oder Kopf mit allem, was er trägt.
}
ask-pair-stiffness = Steifigkeit zwischen beiden
ask-pair-stiffness-where = { $axis ->
    [rotary] Getriebe oder Schnecke, Welle auf Torsion, Kupplung in Reihe, an der Achse: Datenblätter.
   *[linear] Spindel, Mutter und Lager in Reihe, Riemen, Zahnstange, Kupplung: Datenblätter.
}
ask-pair-damping-ratio = Dämpfungsgrad der Last gegen den gehaltenen Motor
ask-pair-frequency = Eigenfrequenz der Last, während der Motor hält
ask-pair-frequency-where = Bremse oder Lageregler ein, die Last anklopfen; im Bode-Diagramm des Motors die Antiresonanz.
ask-plant-moving-mass-where = { $axis ->
    [rotary] Drehmoment durch Winkelbeschleunigung bei tiefen Frequenzen.
   *[linear] Kraft durch Beschleunigung bei tiefen Frequenzen, mit Läufer; oder das ganze Trägheitsmoment an der Motorwelle in kg m^2.
}
ask-modes-frequency-empty = keine mehr
ask-frequency-where = Frequenzgang von Kraft zu Beschleunigung, oder Anklopfen mit Beschleunigungsaufnehmer: die Spitze.
ask-plant-modes-frequency-held-where = Bei gehaltenem Motor: die Spitze eines Beschleunigungsaufnehmers am Werkzeug (resonances_x.csv), oder nach Anklopfen.
ask-damping-ratio-where = Die halbe relative 3-dB-Breite der Spitze; Maschinengestelle zeigen 0,01 bis 0,1.
ask-plant-modes-tcp-gain-where = Residuum des Frequenzgangs von Kraft zu Werkzeug; 1/modale Masse, wenn die Eigenform an Kraft und Werkzeug 1 ist. Enter nimmt den ungünstigsten Fall eines Werkzeugs jenseits davon, als angenommen gekennzeichnet.

ask-or-leave-empty = { $text } (leer: { $meaning })
ask-left-out = weggelassen
ask-wizard-change = Nummer oder Schlüssel dessen, was zu ändern ist
ask-wizard-change-empty = Profil schreiben
ask-wizard-change-where = Eine Nummer der Liste oder ein Schlüssel des Profils, z. B. drive.max_force; < geht zu den Fragen zurück.
ask-wizard-run = Die Grenzwerte jetzt berechnen

choice-rotary = drehend
choice-off = aus
choice-control = in der Steuerung
choice-interpolated = in der Steuerung, Vorsteuerung interpoliert
choice-drive = im Antrieb (DSC)
choice-notch = Bandsperre
choice-low-pass = Tiefpass
choice-tower-masses-and-stiffness = Turm: Massen und Steifigkeit
choice-motor-and-load-masses-and-stiffness = Motor und Last: Massen und Steifigkeit
choice-motor-and-load-masses-and-measured-eigenfrequency = Motor und Last: Massen und gemessene Eigenfrequenz
choice-modes-from-a-bode-plot = Eigenformen aus einem Bode-Diagramm

wizard-begin = Profil { $file }. Die Eingabetaste übernimmt den Wert in [Klammern].
wizard-commands = Bei jeder Frage: ? Hilfe, < zurück, q Ende.
wizard-back = zurück
wizard-help = Hilfe
wizard-quit = Ende
wizard-settled = Nicht gefragt, da es eine brauchbare Vorgabe hat oder fehlen darf:
wizard-no-such-key = „{ $got }“ angegeben; eine Nummer der Liste oder einen Schlüssel des Profils eingeben
wizard-not-possible = Nicht möglich: { $key }: { $message }
wizard-kept = { $how } bei { $where }; Antworten stehen in { $file }, derselbe Befehl macht dort weiter
wizard-left-by-user = beendet
wizard-input-ended = Eingabe zu Ende
wizard-interrupted = unterbrochen
wizard-replaced = { $file } ersetzt, was vorher angegeben war: { $values }
wizard-taken-as = gelesen als { $what }
wizard-follows = = { $what }
wizard-example-behind = z. B. { $example }
wizard-leave-out = Die Eingabetaste allein lässt es weg; - entfernt einen früheren Wert.

reply-missing = hier ist eine Antwort nötig, z. B. { $example }
reply-no-choice = „{ $got }“ angegeben; eines wählen: { $choices }
reply-unprintable = Steuerzeichen oder Bytes einer anderen Kodierung angegeben; einfachen Text eingeben

insight-mode = Eigenform { $mode } bei { FREQUENCY($frequency) }, Dämpfungsgrad { PLAIN($damping_ratio, digits: 3) }
insight-deflection = Eigenform { $mode } verformt das Werkzeug um { LENGTH($deflection) } { $by ->
    [held] bei voller Beschleunigung
   *[free] { $axis ->
        [rotary] bei vollem Drehmoment, statisch
       *[linear] bei voller Kraft, statisch
    }
}
insight-no-force = Gewicht oder Prozesskraft lassen { FORCE($force) } von der Kraft des Antriebs: die Achse kann sich nicht bewegen; mit < zurückgehen und eines von beiden berichtigen
insight-acceleration = Beschleunigung des starren Körpers höchstens { ACCELERATION($acceleration) } ({ FORCE($force) } an { MASS($mass) })
insight-rotor-unknown = die { MASS($mass) } müssen den Läufer enthalten: jedes kg·cm² an der Motorwelle sind an der Achse { MASS($each) }

document-head = Maschinenprofil für mtcommission; eine Größe ist ein Text mit Einheit oder eine Zahl in SI.
document-assumed = Einen Schlüssel aus assumed nehmen, sobald jemand den Wert kennt.
wizard-by-hand = von Hand eingegeben
