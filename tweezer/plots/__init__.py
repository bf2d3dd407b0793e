"""Figures of runs, traps, calibrations and fits, in the style of `tweezer.plots.style`.

Each function returns a Matplotlib Figure and changes no global state. `__init__.pyi` lists the
names, which are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
