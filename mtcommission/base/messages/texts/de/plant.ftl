tcp-height-assumed = tcp_height: das Werkzeug steht { $side ->
    [above] über
   *[below] unter
} dem Drehgelenk, bei x_s - x_b + h φ; der Artikel nennt h ohne Gleichung und Vorzeichen

damping-ratio-beyond-one = { $got } angegeben, muss >= 0 und < 1 sein
modes-at-one-frequency = Eigenformen { $one } und { $other } bei { PLAIN($frequency, digits: 6) } Hz
equal-poles = { $modes }: { modes-have-equal-poles }
mode-not-driven = die { word-force } treibt die Eigenform { $mode } nicht an (Hebelarm 0)
state-mode-unknown = nennt keine Eigenform aus [plant], muss { $names } sein
lever-arm-zero = 0 angegeben, aber die { word-force } muss den Turm drehen; den Hebelarm angeben oder die Achse als kind = "modal" beschreiben
damping-beyond-critical = { $got } angegeben, das ist ein Dämpfungsgrad von { PLAIN($ratio, digits: 3) }; muss < { PLAIN($most, digits: 4) } { $unit } sein (Dämpfungsgrad 1)
named-twice = „{ $name }“ zweimal angegeben, die Namen müssen sich unterscheiden
