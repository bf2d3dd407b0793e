"""Calibration of a trap or a free bead from a recording, and the findings about the recording.

`__init__.pyi` lists the public names. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
