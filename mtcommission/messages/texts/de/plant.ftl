tcp-height-assumed = tcp_height gilt als Höhe des Werkzeugbezugspunkts { $side ->
    [above] über
   *[below] unter
} dem Drehgelenk; das Werkzeug steht vom Gestell aus gesehen bei x_s − x_b + h φ. Die Veröffentlichung nennt h, aber weder Gleichung noch Vorzeichen.
