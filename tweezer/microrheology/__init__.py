"""Microrheology: viscoelastic moduli of a medium, from the motion of a trapped bead.

`__init__.pyi` lists the public names. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
