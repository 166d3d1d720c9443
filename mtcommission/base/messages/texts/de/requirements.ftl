requirement-residual-deviation = Restabweichung
requirement-settling-time = Einschwingzeit
requirement-contour-deviation = Konturabweichung
requirement-set-force = Soll{ word-force-behind }
requirement-rms-force = Effektiv{ word-force-behind }
requirement-peak = Höchstwert { SYMBOL($signal) }
requirement-together-with = { $requirement }, zusammen mit { $others }
