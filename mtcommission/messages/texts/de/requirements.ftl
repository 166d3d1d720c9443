requirement-residual-deviation = Restabweichung
requirement-settling-time = Einschwingzeit
requirement-contour-deviation = Konturabweichung
requirement-set-force = { $axis ->
    [rotary] Sollmoment
   *[linear] Sollkraft
}
requirement-rms-force = { $axis ->
    [rotary] Effektivmoment
   *[linear] Effektivkraft
}
requirement-peak = Höchstwert { SYMBOL($signal) }
requirement-together-with = { $requirement }, zusammen mit { $others }
