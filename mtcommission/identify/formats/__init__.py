"""Files of drives, controls and analysers -> what they hold, in their own names and units."""
