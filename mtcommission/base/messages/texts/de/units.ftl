decimal-mark = ,

dimension-mass = eine Masse
dimension-length = eine Länge
dimension-angle = ein Winkel
dimension-time = eine Zeit
dimension-frequency = eine Frequenz
dimension-force = { $axis ->
    [open-loop] eine Beschleunigung
   *[other] eine Kraft
}
dimension-torque = ein Drehmoment
dimension-moment-of-inertia = ein Trägheitsmoment
dimension-velocity = eine Geschwindigkeit
dimension-angular-velocity = eine Winkelgeschwindigkeit
dimension-acceleration = eine Beschleunigung
dimension-angular-acceleration = eine Winkelbeschleunigung
dimension-jerk = ein Ruck
dimension-angular-jerk = ein Winkelruck
dimension-stiffness = eine Steifigkeit
dimension-damping-constant = eine Dämpfungskonstante
dimension-rotary-stiffness = eine Drehsteifigkeit
dimension-rotary-damping-constant = eine Drehdämpfungskonstante
dimension-position-gain = eine Lageverstärkung
dimension-gain-per-mass = eine Verstärkung je Masse
dimension-gain-per-inertia = eine Verstärkung je Trägheitsmoment
dimension-modal-deflection = eine modale Auslenkung
dimension-modal-rate = eine modale Rate
dimension-rotary-modal-deflection = eine modale Auslenkung der Drehachse
dimension-rotary-modal-rate = eine modale Rate der Drehachse
dimension-ratio = ein Verhältnis
dimension-per = { $what } je { $other }
dimension-squared = { $what } zum Quadrat
dimension-in = eine Größe in { $units }

quantity-described = { $what }, { $units }
quantity-expected = muss { $what } sein, { $units }
unit-in = in { $last }
unit-in-one-of = in { $first } oder { $last }
unit-none-or = ohne Einheit oder in { $last }

unit-too-long = eine Einheit hat höchstens { $most } Zeichen
unit-unreadable = „{ $unit }“ ist keine Einheit; so schreiben: "N s/m" oder "m/s^2"
unit-unknown = unbekannte Einheit „{ $unit }“
unit-worth = {" "}({ $worth })
unit-meant = {" "}(ist „{ $unit }“ gemeint?)

quantity-with-control-characters = „{ $got }“ enthält Steuerzeichen; sie entfernen
quantity-too-long = „{ $got }“ ist zu lang; eine Größe hat höchstens { $most } Zeichen
quantity-without-unit = „{ $got }“ angegeben: { $why }{ $advice }; { $expected }
quantity-of-another-kind = „{ $got }“ angegeben, das ist { $what }{ $advice }; { $expected }{ $hint }
g-is-the-gram = ; g ist hier das Gramm, 9.81 m/s^2 schreiben
quantity-infinite = „{ $got }“ angegeben, muss eine endliche Zahl sein; { $expected }
quantity-without-number = „{ $got }“ angegeben, das beginnt nicht mit einer Zahl; { $expected }
number-infinite = „{ $got }“ angegeben, muss eine endliche Zahl sein
number-with-separators = „{ $got }“ angegeben; die Zahl ohne Tausendertrennzeichen schreiben
number-with-comma = „{ $got }“ mit Komma angegeben; mit Punkt schreiben: "{ $wanted }"

word-force = { $axis ->
    [open-loop] Beschleunigung
    [rotary] Drehmoment
   *[linear] Kraft
}
word-force-first = { word-force }
word-a-force = { $axis ->
    [rotary] ein Drehmoment
   *[linear] eine { word-force }
}
word-a-force-first = { $axis ->
    [rotary] Ein Drehmoment
   *[linear] Eine { word-force }
}
word-force-before = { $axis ->
    [open-loop] Beschleunigungs
    [rotary] Momenten
   *[linear] Kraft
}
word-force-behind = { $axis ->
    [open-loop] beschleunigung
    [rotary] moment
   *[linear] kraft
}
word-mass = { $axis ->
    [rotary] Trägheitsmoment
   *[linear] Masse
}
word-f-max = { $axis ->
    [open-loop] a_max
   *[other] F_max
}
word-f-set = { $axis ->
    [open-loop] a_set
   *[other] F_set
}
word-lambda = { $axis ->
    [open-loop] lambda B
   *[other] lambda_F
}
word-max-force = { $axis ->
    [open-loop] max_acceleration
   *[other] max_force
}
