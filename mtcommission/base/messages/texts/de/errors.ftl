modes-have-equal-poles = zwei Eigenformen haben gleiche Pole, daher kann { word-a-force } nicht beide unabhängig zur Ruhe bringen; zu einer Eigenform zusammenfassen (ihre tcp_gain und measured_gain addieren)
outcome-equal-poles = gleiche Pole: { $detail }: { modes-have-equal-poles }
outcome-not-controllable = { $axis ->
    [rotary] nicht steuerbar: { $detail }: das Antriebsmoment erreicht nicht jeden Zustand; die Eigenform weglassen, die es nicht anregen kann
   *[linear] nicht steuerbar: { $detail }: die Antriebs{ word-force-behind } erreicht nicht jeden Zustand; die Eigenform weglassen, die sie nicht anregen kann
}
outcome-final-time-too-short = { $axis ->
    [rotary] Endzeit zu kurz: { $detail }: kein zulässiges Drehmoment erreicht das Ziel so früh; ein längeres t_f vorgeben
   *[linear] Endzeit zu kurz: { $detail }: keine zulässige { word-force } erreicht das Ziel so früh; ein längeres t_f vorgeben
}
outcome-bound-cannot-hold = Schranke nicht einzuhalten: { $detail }: keine noch so langsame Bewegung hält diese Schranke ein; sie weiter fassen
outcome-beyond-horizon = jenseits des Suchhorizonts: { $detail }: nur eine Bewegung, die langsamer ist als der Horizont der Suche, hält die Schranke ein; sie weiter fassen
outcome-modes-not-told-apart = { $axis ->
    [rotary] Eigenformen nicht zu unterscheiden: { $detail }: ein so großes Drehmoment macht die Bewegung so kurz, dass alle Eigenformen gleich antworten, enger beieinander, als doppelte Genauigkeit unterscheidet; die Einheit von { word-max-force } und die Massen prüfen oder { word-max-force } verringern
   *[linear] Eigenformen nicht zu unterscheiden: { $detail }: eine so große { word-force } macht die Bewegung so kurz, dass alle Eigenformen gleich antworten, enger beieinander, als doppelte Genauigkeit unterscheidet; die Einheit von { word-max-force } und die Massen prüfen oder { word-max-force } verringern
}
outcome-no-convergence = keine Konvergenz: { $detail }: die Iteration endete, bevor die verlangte Genauigkeit erreicht war; das Profil einsenden und vorerst --method transcription nehmen
outcome-unstable-loop = instabiler Regelkreis: { $detail }: der geschlossene Regelkreis ist instabil; eine Verstärkung wie gesagt ändern oder alle weglassen, damit sie eingestellt werden
outcome-not-observable = nicht beobachtbar: { $detail }: die Messsysteme sehen diesen Zustand nicht, also kann ihn keine Rückführung nutzen; die Verstärkung weglassen oder mit tcp_sensor = "position" ein zweites Messsystem vorsehen
outcome-bandwidth-out-of-reach = Bandbreite nicht erreichbar: { $detail }: kein stabiler Regelkreis erreicht minimum_bandwidth mit den verlangten Reserven; force_lag und die Takte verkürzen oder minimum_bandwidth verringern
outcome-margins-out-of-reach = Reserven nicht erreichbar: { $detail }: bis hinab zu einer so weichen Kaskade hat keine die verlangten Reserven: sie nimmt einer Eigenform, die der Lagegeber sieht, Dämpfung; das Vorzeichen von measured_gain prüfen oder eine Kerbe in force_filters aufnehmen
outcome-undamped-mode = ungedämpfte Eigenform: { $detail }: der Lagegeber sieht diese Eigenform nicht, sie schwänge also ewig; ihren damping_ratio angeben (gemessen, oder vorsichtig 0.002)
outcome-feedback-design-failed = Entwurf der Rückführung gescheitert: { $detail }: die Riccati-Gleichung der Zustandsrückführung oder ihres Beobachters hat mit diesen Zahlen keine verlässliche Lösung; ihre Einheiten prüfen oder control.state_feedback = "off" setzen
outcome-no-force-left = { $axis ->
    [rotary] kein Drehmoment übrig: { $detail }: die statische Last braucht das ganze Drehmoment, die Achse kann sich also nicht bewegen; { word-max-force } erhöhen oder die Last ausgleichen
   *[linear] keine { word-force } übrig: { $detail }: die statische Last braucht die ganze { word-force }, die Achse kann sich also nicht bewegen; { word-max-force } erhöhen oder die Last ausgleichen
}
outcome-move-too-long = Bewegung zu lang: { $detail }: eine so lange Bewegung wird nicht Takt für Takt verfolgt; die Einheit von { word-max-force } prüfen, oder von Beschleunigung und Ruck, wo sie angegeben sind, oder eine kürzere Bewegung angeben (einen kleineren velocity_step oder einen kürzeren Weg bei gleicher max_velocity: konstante Geschwindigkeit und lange konstante Beschleunigung lassen keine Schwingung zurück, die Grenzwerte bleiben also nahezu gleich; was wegfällt, auch von max_settling_time abziehen)
outcome-setpoint-failed = kein Sollwert: { $detail }: Ruckig fand zu diesen Grenzwerten keinen Sollwert; prüfen, ob sie in SI-Einheiten angegeben sind
outcome-worker-lost = Prozess verloren: { $detail }: Prozesse der Reihenrechnung endeten immer wieder, aus Mangel an Speicher oder mit Gewalt; mit --resume und weniger --workers fortsetzen
outcome-scheduler-lost = Scheduler verloren: { $detail }: ihn und seine Prozesse neu starten und mit --resume fortsetzen
outcome-stopped = angehalten: { $detail }: die Reihenrechnung wurde unterbrochen; mit --resume fortsetzen
outcome-printing-failed = Druck gescheitert: { $detail }: das PDF konnte nicht gesetzt werden; --no-pdf verwenden und die Meldung einsenden

# what another program says, in its own words
foreign = { $text }
setpoint-of-limits = mit a = { PLAIN($acceleration, digits: 6) } m/s^2 und j = { PLAIN($jerk, digits: 6) } m/s^3 (an einer Drehachse rad statt m): { $complaint }
