"""The kinds of plant that come with the package; a new one is a file of its own and a line here."""

from mtcommission.machine.mechanics import register
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.modal import BaseExcited, Modal

register(Manipulator)
register(Modal, motor_held=BaseExcited)
