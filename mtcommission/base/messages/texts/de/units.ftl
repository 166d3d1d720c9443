decimal-mark = ,

quantity-expected = in { $units } angeben

unit-unreadable = „{ $unit }“ ist keine Einheit; so schreiben: "N s/m" oder "m/s^2"
unit-unknown = unbekannte Einheit „{ $unit }“
unit-worth = {" "}({ $worth })
unit-meant = {" "}(ist „{ $unit }“ gemeint?)

quantity-too-long = „{ $got }“ ist zu lang; eine Größe hat höchstens { $most } Zeichen
quantity-without-unit = „{ $got }“ angegeben: { $why }{ $advice }; { $expected }
g-is-the-gram = { " " }(g ist hier das Gramm, 9.81 m/s^2 schreiben)
quantity-without-number = „{ $got }“ angegeben, das beginnt nicht mit einer Zahl; { $expected }
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
ratio-expected = ohne Einheit oder in { $units } angeben
quantity-in-other = „{ $got }“ angegeben{ $advice }; { $expected }
