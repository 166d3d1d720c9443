"""Time records -> responses, spectra and free vibrations, with what they are worth."""
