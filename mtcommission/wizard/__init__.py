"""Questions -> profile: from a data sheet to a commented machine file.

``script`` tells what is asked and what is settled, from the schema of profiles; ``question`` reads
a reply, ``answers`` turns answers into the profile's keys and back, ``files`` reads what is known
before the first question and writes the profile, ``session`` talks and holds it together.
"""

from mtcommission.wizard.session import Ending, open_console, run_wizard

__all__ = ["Ending", "open_console", "run_wizard"]
