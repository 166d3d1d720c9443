requirement-residual-deviation = Restabweichung
requirement-settling-time = Einschwingzeit
requirement-contour-deviation = Konturabweichung
requirement-set-force = { $axis ->
    [rotary] Sollmoment
   *[linear] Soll{ word-force-behind }
}
requirement-rms-force = { $axis ->
    [rotary] Effektivmoment
   *[linear] Effektiv{ word-force-behind }
}
requirement-peak = Höchstwert { SYMBOL($signal) }
requirement-together-with = { $requirement }, zusammen mit { $others }
