"""The languages that there are; each has a folder of texts."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

LANGUAGES: Mapping[str, str] = MappingProxyType({"en": ".", "de": ","})
"""Languages there are, and their decimal marks."""
