"""The emitted modules of the folder `generated/` of a checkout.

A wheel has these modules themselves in this place, so that an installed tweezer brings one package.
"""

from pathlib import Path

__path__ = [str(Path(__file__).parents[2] / "generated")]
