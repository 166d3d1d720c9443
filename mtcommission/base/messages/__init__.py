"""What the program says, as data: kinds with typed values; a language is a folder of texts."""

from __future__ import annotations

from pathlib import Path

TEXTS = Path(__file__).with_name("texts")
"""One folder for each language, named by its code."""

ENGLISH = "en"

LANGUAGES: tuple[str, ...] = tuple(
    sorted(
        (folder.name for folder in TEXTS.iterdir() if folder.is_dir()),
        key=lambda code: (code != ENGLISH, code),
    )
)
"""Their codes, English first."""
