"""Questions -> profile: from a data sheet to a commented machine file.

``script`` lists what is asked, ``question`` reads a reply, ``convert`` turns answers into the
profile's keys, ``insight`` says what follows from them, ``document`` writes the file, ``console``
talks, and ``session`` holds it together.
"""

from mtcommission.wizard.console import open_console
from mtcommission.wizard.session import Ending, run_wizard

__all__ = ["Ending", "open_console", "run_wizard"]
