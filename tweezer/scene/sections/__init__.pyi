from .alternatives import ALTERNATIVES, BELONGING, FILLED, NAMED, WITHIN_LAYERS, Filled
from .bead import Bead
from .between import Between, Tether
from .detector import Detector, LockIn
from .feedback import Feedback
from .heat import Heat
from .interference import Mirror
from .light import Beam, Cover, Lens, Optics
from .medium import Medium, Wall
from .motion import MOST_SAMPLES, Camera, Dlvo, Forces, Simulation, Start
from .shapes import Layer

__all__ = [
    "ALTERNATIVES",
    "BELONGING",
    "FILLED",
    "MOST_SAMPLES",
    "NAMED",
    "WITHIN_LAYERS",
    "Bead",
    "Beam",
    "Between",
    "Camera",
    "Cover",
    "Detector",
    "Dlvo",
    "Feedback",
    "Filled",
    "Forces",
    "Heat",
    "Layer",
    "Lens",
    "LockIn",
    "Medium",
    "Mirror",
    "Optics",
    "Simulation",
    "Start",
    "Tether",
    "Wall",
]
