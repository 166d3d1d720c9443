"""The kinds of plant that come with the package; a new one is a file of its own and a line here."""

from __future__ import annotations

from mtcommission.machine.mechanics import KINDS, register
from mtcommission.machine.plant.base_excited import BaseExcited
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.modal import Modal

__all__ = ["KINDS"]

register(Manipulator)
register(Modal, motor_held=BaseExcited)
