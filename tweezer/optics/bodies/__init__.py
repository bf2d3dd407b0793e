"""Light on a body of any shape: its T-matrix, and the exact force and torque.

`__init__.pyi` lists the names for other packages, which are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
