"""``python -m mtcommission``: the same as the command ``mtcommission``."""

from mtcommission.cli import main

if __name__ == "__main__":
    main()
