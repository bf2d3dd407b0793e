"""A bead in an optical trap: derived dynamics, the real optical force, stated errors.

>>> import tweezer
>>> scene = tweezer.load_scene("thesis-990nm").replace(beam={"power": "80 mW"})
>>> run = tweezer.simulate(scene, duration="10 ms")

`__init__.pyi` lists the public names. They are loaded when first used, so that importing the
package takes little time.
"""

from typing import Any

import lazy_loader

from tweezer.values.former import find_former_paths, module_of

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
find_former_paths()


def __getattr__(name: str) -> Any:
    return module_of(name) or _public(name)
