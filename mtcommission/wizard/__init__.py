"""Questions -> profile: from a data sheet to a commented machine file.

``script`` tells what is asked and what is settled, from the schema of profiles; ``question`` reads
a reply, ``answers`` turns answers into the profile's keys and back, ``insight`` says what follows
from them, ``document`` writes the file, ``source`` is what is known before the first question,
``console`` talks, and ``session`` holds it together.
"""

from mtcommission.wizard.console import open_console
from mtcommission.wizard.session import Ending, run_wizard

__all__ = ["Ending", "open_console", "run_wizard"]
