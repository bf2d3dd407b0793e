"""Typographic characters in texts for people: µ, ±, ² and · instead of u, +-, ^2 and a space.

Texts are made with ASCII alone, as files have them. They are typeset where they are shown: on
pages, in figures and in Jupyter always, in a terminal and by `repr` if the encoding of its output
has the signs (`for_stream`). Otherwise they stay ASCII: "50.35 +- 0.49 pN/um".
"""

from __future__ import annotations

import re
from typing import IO

#: What stands before a unit: nothing, a space or a bracket, or the unit over it
_BEFORE = r"(?:(?<=^)|(?<=[\s(,·])|(?<=[NVmsx1]/))"
_MICRO = re.compile(rf"{_BEFORE}u(?=[msVWN]\b(?![.\-\\]\w))")
_PRODUCT = re.compile(r"\b([pnfmk]?(?:N|Pa)) (?=(?:[nuµ]?m|s)\b)")
_OF_THREE = re.compile(r"(?<=·)([nuµ]m) (?=s\b)")
_POWER = re.compile(r"(?<=[ms])\^([23])\b")
_SQUARE_AND_CUBE = {"2": "²", "3": "³"}
#: All signs
_SIGNS = "µ±·²³"


def typeset(text: str) -> str:
    """Return a text with typographic characters: "nN·s/m" for "nN s/m", "µm²" for "um^2"."""
    text = _MICRO.sub("µ", text.replace("+-", "±"))
    text = _OF_THREE.sub(r"\1·", _PRODUCT.sub(r"\1·", text))
    return _POWER.sub(lambda power: _SQUARE_AND_CUBE[power[1]], text)


def for_stream(text: str, stream: IO[str] | None) -> str:
    """Return `text` with typographic characters, if the encoding of the stream contains them.

    A stream without an encoding, such as one in memory, accepts all characters.
    """
    try:
        _SIGNS.encode(getattr(stream, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        return text
    return typeset(text)
