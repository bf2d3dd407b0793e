"""Sections of a scene: bead, medium, lens, beam, start, forces, camera, optics, simulation.

`__init__.pyi` lists the names for other packages, which are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
