"""Files of drives, controls and analysers -> what they hold, in their own names and units.

One reader for each format. Where a reader finds a file broken, or without anything of use here, it
raises InputError with the file, the line where there is one, what was got and what to do.
"""
