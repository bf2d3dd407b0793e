"""The emitted modules in the folder `generated/` of a checkout.

A wheel contains these modules in place of this file.
"""

from pathlib import Path

__path__ = [str(Path(__file__).parents[2] / "generated")]
