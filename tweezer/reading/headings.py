"""Quantity and unit of a column, recognised from the words in its heading."""

from __future__ import annotations

import re
from typing import NamedTuple

from tweezer.values.prefixes import FREQUENT
from tweezer.values.units import to_si

AXES = ("x", "y", "z")
#: SI unit of each quantity that a column may have
SI = {"t": "s", **dict.fromkeys((*AXES, "drive"), "m")}
#: Unit of a position in an image with unknown scale
PIXEL = "px"
#: Characters that may surround a heading
AROUND = '#%" \r\n\t\ufeff'

_PIXELS = ("px", "pixel", "pixels", "pix", "pxl")
_VOLTS = {**FREQUENT["V"], "volt": 1.0, "volts": 1.0}
#: Words that denote a time
_TIMES = {"t", "time", "times", "timestamp", "timestamps"}
_SECONDS = {"seconds": "s", "second": "s", "secs": "s", "sec": "s"}
#: Words that may accompany them
_OF_TIME = {"elapsed", "relative", "stamp", "sample", "position", "pos"}
#: Words that denote a frame number, and words that may accompany them
_FRAMES = {"frame", "frames", "framenumber", "image", "slice", "sample", "samples", "index"}
_OF_FRAMES = {"number", "no", "nr", "num", "index", "idx", "id", "count"}
#: Words that denote a position, and accompany the name of an axis
_POSITION = {"position", "pos"}
_OF_AXES = {
    *_POSITION, "positions", "coordinate", "coordinates", "coord", "coords", "displacement",
    "deflection", "location", "centre", "center", "centroid", "com", "bead", "particle", "tracked",
    "axis", "signal", "detector", "qpd", "psd", "voltage", "volt", "volts",
}  # fmt: skip
#: Words that imply volts if there is no unit
_ELECTRIC = {"voltage", "volt", "volts"}
#: Words and units of a frequency, and words of a spectral density or amplitude
_FREQUENCIES = {"f", "freq", "frequency", "frequencies", "nu"}
_HERTZ = {"hz", "khz", "mhz", "1/s", "s^-1"}
_POWERS = {"psd", "asd", "power", "spectrum", "spectral", "density", "amplitude", "pxx", "sxx"}
_PER_HERTZ = re.compile(r"/\s*(?:hz|(?:sqrt|rt|√)\s*\(?\s*hz)|hz\s*\^?\s*-|^db", re.I)
#: First words of a heading that distinguishes beads; words such as "id" may follow
_BEADS = {"particle", "track", "trajectory", "bead", "molecule", "object"}
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^\W_]+")
_JOINED = re.compile(r"(?:(?P<before>[a-z]{3,12})[xyz]|[xyz](?P<after>[a-z]{3,12}))")


class Heading(NamedTuple):
    """Quantity and unit that the heading of a column denotes."""

    quantity: str | None
    """"t", "x", "y", "z", "frame" (frame number), "bead" (label of a bead) or "drive" (stage
    motion); None for anything else"""
    unit: str | None = None
    """unit as written, such as "um"; None without one"""
    plain: bool = False
    """whether the heading has no words other than the quantity; such a column is preferred"""
    assumed: str | None = None
    """unit implied by a word where none is written: "V" for "x voltage\""""


def understood(heading: str) -> Heading:
    """Return the quantity and the unit that a heading denotes.

    The quantity may be accompanied by words such as "position" or "elapsed", in any case. A unit
    follows in brackets, after a slash, or after a space or an underscore.
    """
    text = heading.strip(AROUND)
    if not text or len(text) > 200:
        return Heading(None)
    name, unit = _split(text)
    words = [word.lower() for word in _WORD.findall(name)]
    if unit is None and len(words) > 1:
        last = re.split(r"[\s_]+", name)[-1]
        shorter = words[: -len(_WORD.findall(last))]
        if shorter and (found := _quantity(shorter)).quantity in SI:
            assert found.quantity is not None
            if is_unit(last, found.quantity):
                return found._replace(unit=last)
    found = _quantity(words)
    return found if unit is None else found._replace(unit=unit)


def _split(text: str) -> tuple[str, str | None]:
    """Return the name in a heading, and its unit in brackets or after a slash; None without one."""
    if text.endswith(("]", ")")):
        name, opening, unit = text[:-1].rpartition("[" if text.endswith("]") else "(")
        if opening and name:
            return name, unit.strip()
    elif "/" in text:
        name, _, unit = text.partition("/")
        return name, unit.strip()
    return text, None


def _quantity(words: list[str]) -> Heading:
    """Return the quantity that the words of a heading, in lower case, denote; without a unit."""
    of = set(words)
    if words and words[0] in _BEADS and len(words) <= 2 and of - {words[0]} <= _OF_FRAMES:
        return Heading("bead")
    if len(words) == 1 and words[0] in _SECONDS:
        return Heading("t", assumed=_SECONDS[words[0]])
    if len(of & _TIMES) == 1 and of <= _TIMES | _OF_TIME and words.count("t") < 2:
        return Heading("t", None, not of - _TIMES - _POSITION)
    if words and words[0] in _FRAMES and of - {words[0]} <= _OF_FRAMES:
        return Heading("frame", None, words[0].startswith("frame"))
    axes = [word for word in words if word in AXES]
    beside = of - {*AXES}
    if not axes:
        for word in words:
            match = _JOINED.fullmatch(word)
            if match and (joined := match["before"] or match["after"]) in _OF_AXES:
                axes.append(word[0] if match["after"] else word[-1])
                beside = beside - {word} | {joined}
    if len(axes) == 1 and beside <= _OF_AXES:
        return Heading(axes[0], None, beside <= _POSITION, "V" if beside & _ELECTRIC else None)
    return Heading(None)


def of_a_spectrum(heading: str, beside: str | None) -> str | None:
    """Return the kind of a column in a table of a power spectrum.

    Parameters
    ----------
    heading : str
    beside : str or None
        Unit given outside the heading.

    Returns
    -------
    str or None
        "frequency", "power", or None for something else.
    """
    name, unit = _split(heading.strip(AROUND)[:200])
    words = {word.lower() for word in _WORD.findall(name)}
    units = [each.strip() for each in (unit, beside) if each]
    if any(_PER_HERTZ.search(each) for each in units) or _PER_HERTZ.search(heading[:200]):
        return "power"
    if words & _FREQUENCIES or any(each.lower() in _HERTZ for each in units):
        return "frequency"
    return "power" if words & _POWERS else None


def of_the_drive(heading: str, name: str) -> Heading | None:
    """Return the stage's motion as the quantity of a heading equal to `name`, perhaps with a unit.

    Returns None for another heading.
    """
    text = heading.strip(AROUND)
    if not text.lower().startswith(name.lower()):
        return None
    rest = text[len(name) :]
    unit = rest.strip("[]()/_ ")
    if rest and (rest[0] not in "[(/_ " or not is_unit(unit, "drive")):
        return None
    return Heading("drive", unit or None, plain=True)


def is_unit(text: str, quantity: str) -> bool:
    """Return whether `text` is a valid unit of a quantity, such as "x"."""
    try:
        factor_of(text, quantity)
    except (KeyError, ValueError):  # KeyError: a frame number has no unit
        return False
    return True


def factor_of(unit: str, quantity: str) -> tuple[float, str]:
    """Return the factor that converts `unit` to s, m, V or pixels, and the name of that unit.

    `quantity` is the quantity of the column, such as "x". Raises `ValueError` with the allowed
    units if `unit` does not fit it.
    """
    if quantity in AXES and unit.lower() in _PIXELS:
        return 1.0, PIXEL
    if quantity in AXES and unit in _VOLTS:
        return _VOLTS[unit], "V"
    return to_si(f"1 {unit}", SI[quantity]), SI[quantity]
