# What is required of a move; one name for each, everywhere.

requirement-residual-deviation = residual deviation
requirement-settling-time = settling time
requirement-contour-deviation = contour deviation
requirement-set-force = set { word-force }
requirement-rms-force = RMS { word-force }
# $signal: a state or output of the plant, as the profile spells it
requirement-peak = peak { SYMBOL($signal) }
requirement-together-with = { $requirement }, together with { $others }
