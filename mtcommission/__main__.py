"""``python -m mtcommission``, and the command ``mtcommission``: what is loaded first."""

from __future__ import annotations

import sys


def main() -> None:
    """Load the command line and run it; Ctrl-C while it loads is no traceback."""
    try:
        from mtcommission.cli import main as start
    except KeyboardInterrupt:
        sys.stderr.write("interrupted before anything began\n")
        sys.exit(130)
    start()


if __name__ == "__main__":
    main()
