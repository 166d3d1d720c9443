"""The kinds of plant that there are; a new one is a file of its own and a line here."""

from __future__ import annotations

from collections.abc import Mapping

from mtcommission.plant.manipulator import Manipulator
from mtcommission.plant.modal import Modal

KINDS: Mapping[str, type[Manipulator] | type[Modal]] = {
    kind.kind: kind for kind in (Manipulator, Modal)
}
"""By the name that ``plant.kind`` of a profile gives."""
