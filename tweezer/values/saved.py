"""Table of the kinds of results that tweezer saves, by which files are recognised."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from tweezer.values.errors import ResultError, warn
from tweezer.values.files import STANDARD_OUTPUT, digest, read_text

#: Key of the digest in a JSON file
DIGEST = "sha256"

#: Suffixes of files of runs, ensembles and sweeps
RESULTS = (".nc", ".zarr")
#: Suffix of the file of a trap
SAVED_TRAP = ".json"
#: Suffixes of recordings by format: text, HDF5 (also of runs), NumPy, MATLAB, LabVIEW
TEXTS = (".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm", ".prn")
HDF5 = (".h5", ".hdf5", ".nc")
NUMPY, MATLAB, TDMS = (".npy", ".npz"), ".mat", ".tdms"
RECORDINGS = (*TEXTS, *HDF5, *NUMPY, MATLAB, TDMS)


class Kind(NamedTuple):
    """A kind of file, and the commands of tweezer that accept it.

    A result (`KINDS`) is recognised by its content, any other file (`OTHERS`) by its name.
    """

    name: str
    """name of the kind, such as "run" or "calibration\""""
    told: str
    """name in words with its article, for messages"""
    marks: tuple[str, ...]
    """names that every result of this kind contains: attributes, variables or dimensions of a
    dataset, or keys of a JSON file"""
    page: str = ""
    """name of the page that shows it, PAGE in `viewing/of_PAGE.py` and `static/PAGE.js`; "" without
    a page"""
    compared: bool = False
    """whether `tweezer compare` accepts it"""
    command: str = ""
    """command of tweezer that reads a file that is not a result; "" without a command"""
    endings: tuple[str, ...] = ()
    """suffixes by which a file that is not a result is recognised"""
    of: str = ""
    """class of a result that is saved as JSON, as "MODULE:CLASS"; "" for a dataset"""
    within: str = ""
    """key of the result in its JSON file; "" if the file contains only the result"""
    reader: str = ""
    """module whose functions `content_of` and `result_in` convert to and from the JSON file; ""
    for a result whose fields form the whole file"""
    several: bool = False
    """whether the result is a tuple of objects of this class"""

    def way(self, name: str) -> str:
        """Return the end of a sentence, starting with "; ", on what can be done with a file.

        It is "" if tweezer cannot do anything with the file `name`.
        """
        ways = ["`tweezer view` shows it"] if self.page else []
        ways += ["`tweezer compare` compares it with another"] if self.compared else []
        ways += [f"use `tweezer {self.command} {name}`"] if self.command else []
        return f"; {' and '.join(ways)}" if ways else ""


#: Results; the kind of a result is the first one whose marks are all found
KINDS = (
    Kind("light", "the light of a scene", ("scene", "gradient", "light_time")),
    Kind("sweep", "a sweep", ("scene", "over", "outcome"), "sweep", True),
    Kind("beads statistics", "statistics of an ensemble of several beads",
         ("scene", "stationary_mean", "bead")),
    Kind("beads ensemble", "an ensemble of several beads",
         ("scene", "trajectory", "position", "bead")),
    Kind("statistics", "statistics of an ensemble", ("scene", "stationary_mean"), "ensemble", True),
    Kind("ensemble", "an ensemble", ("scene", "trajectory", "position"), "ensemble", True),
    Kind("heights", "a trap over heights", ("scene", "height", "equilibrium")),
    Kind("rotation", "the rotation of a body", ("scene", "order_tensor", "lag")),
    Kind("beads", "a run of several beads", ("scene", "status", "bead"), "beads"),
    Kind("run", "a run", ("scene", "status", "time"), "run", True),
    Kind("trap", "a trap", ("scene", "trap"), "trap", True,
         of="tweezer.trap.trap:Trap", reader="tweezer.trap.saved_trap"),
    Kind("body trap", "the trap of a body", ("scene", "body_trap"), compared=True,
         of="tweezer.trap.body:BodyTrap", reader="tweezer.trap.saved_body_trap"),
    Kind("rheology", "the rheology of a medium", ("storage", "loss", "elements"),
         of="tweezer.microrheology.results:Rheology"),
    Kind("calibration", "a calibration", ("axes", "exposure"), compared=True,
         of="tweezer.calibration.results:Calibration"),
    Kind("together", "calibrations of several recordings", ("recordings", "together"),
         of="tweezer.calibration.together:Together", within="together", several=True),
    Kind("surface", "calibrations that find a wall", ("recordings", "surface"), compared=True,
         of="tweezer.calibration.surface:Surface", within="surface"),
    Kind("fit", "a fit of keys", ("scene", "keys", "log_likelihood"),
         of="tweezer.tracking.inference:SceneFit"),
    Kind("depth", "a fit of the depth", ("minima", "parameters"),
         of="tweezer.tracking.depth:DepthFit"),
    Kind("tuning", "scaled runs beside the unscaled one", ("entries", "epsilon"),
         of="tweezer.runs.tuning:Tuning"),
)  # fmt: skip
#: Files that are not results, recognised by their names
OTHERS = (
    Kind("recording", "a recording", (), command="calibrate", endings=RECORDINGS),
    Kind("page", "a page or a report", (), endings=(".html",)),
    Kind("figure", "a figure", (), endings=(".png", ".svg", ".pdf")),
    Kind("scene", "a scene", (), command="run", endings=(".toml",)),
)
SHOWN = tuple(each for each in KINDS if each.page)
COMPARED = tuple(each for each in KINDS if each.compared)


def kind_of(result: Any) -> Kind | None:
    """Return the kind of a dataset, of the content of a JSON file, or of an object.

    A tuple is a result only of a kind with several objects. Returns None for an unknown kind.
    """
    if hasattr(result, "data_vars"):
        return _kind_with({*result.attrs, *result.variables, *result.sizes})
    if isinstance(result, dict):
        return _kind_with(set(result))
    several = isinstance(result, tuple)
    classes = {type(each) for each in (result if several else (result,))}
    names = {f"{each.__module__}:{each.__qualname__}" for each in classes}
    return next((each for each in KINDS if names == {each.of} and each.several == several), None)


def _kind_with(names: set[Any]) -> Kind | None:
    """Return the kind of a result whose attributes, variables and dimensions have these names.

    Returns None for an unknown kind.
    """
    return next((kind for kind in KINDS if names.issuperset(kind.marks)), None)


def kind_of_file(path: Path) -> Kind | None:
    """Return the kind of the result in a file or folder, or the kind that its name indicates.

    Returns None for an unknown kind.
    """
    try:
        if path.suffix.lower() == SAVED_TRAP:
            return kind_of(_content(path)[0])
        if path.suffix.lower() == ".zarr":
            from tweezer.values.stores import names_in_store

            return _kind_with(names_in_store(path))
        if path.suffix.lower() == ".nc":
            from tweezer.values.hdf5 import names_in

            return _kind_with(names_in(path))
    except Exception:  # readers raise errors of any type for damaged files
        return None
    ending = path.suffix.lower()
    there = os.path.isfile(path)  # noqa: PTH113 - `Path.is_file` raises for a name that is too long
    return next((kind for kind in OTHERS if there and ending in kind.endings), None)


def refusal(kind: Kind | None, command: str, taken: Iterable[Kind]) -> str:
    """Return a message, without its subject, that a command does not accept a result.

    It states the kind of the result and lists the kinds that the command accepts.
    """
    is_ = f"is {kind.told}" if kind else "is not a known kind of result"
    return f"{is_}; `tweezer {command}` accepts {', '.join(each.told for each in taken)}"


def read_json(path: Path) -> Any:
    """Return the content of a JSON file, without its digest.

    Raises `ResultError` if it cannot be read, or if its digest differs from its content. Warns
    about a result without a digest, as earlier versions wrote it.
    """
    found, sealed = _content(path)
    if not sealed and kind_of(found):
        warn(
            f"{path}: has no digest, so a change of its numbers goes unnoticed; it was changed by "
            "hand or saved by an earlier version",
            UserWarning,
        )
    return found


def _content(path: Path) -> tuple[Any, bool]:
    """Return the content of a JSON file without its digest, and whether it had one.

    Raises `ResultError` if it cannot be read or differs from its digest.
    """
    try:
        found = json.loads(read_text(path))
        if not isinstance(found, dict) or DIGEST not in found:
            return found, False
        if found.pop(DIGEST) != digest(found):
            raise ResultError(
                f"{path}: damaged: its content differs from what was saved; if you changed it, "
                "delete "
                f'the key "{DIGEST}"'
            )
        return found, True
    except FileNotFoundError:
        raise ResultError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise ResultError(f"{path}: is a folder") from None
    except (OSError, ValueError, RecursionError) as error:
        raise ResultError(f"{path}: cannot be read: {error}") from None


def check_ending(path: Path, formats: Iterable[str]) -> None:
    """Raise `ResultError` unless the name ends in one of the formats, in lower or upper case.

    JSON may also go to standard output.
    """
    if path == STANDARD_OUTPUT and "json" in formats:
        return
    if path.suffix.lstrip(".").lower() not in formats:
        raise ResultError(f"{path}: must end in .{', .'.join(formats)}")
