"""Import paths of earlier releases, which work until version 0.3 and warn with the new path."""

from __future__ import annotations

import importlib
import sys
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

#: Old paths of modules with public names, by the package that contains them now
_MOVED = {
    "calibration": (
        "analysis.calibration analysis.driving analysis.findings analysis.free "
        "analysis.histogram analysis.spectra analysis.surface analysis.together "
        "analysis.trajectories analysis.wall analysis.whittle"
    ),
    "dynamics": "analysis.escape",
    "ensembles": "analysis.first_passage",
    "plots": "report style",
    "reading": "analysis.recording",
    "results": "io",
    "runs": "analysis.derived analysis.summary analysis.tuning simulation",
    "scene": "bead choices sections water",
    "tracking": "analysis.depth analysis.inference",
    "trap": "analysis.heights analysis.holding analysis.least_power analysis.trap",
    "values": "errors units version",
}
_NEW = {
    f"tweezer.{old}": f"tweezer.{package}.{old.rpartition('.')[2]}"
    for package, modules in _MOVED.items()
    for old in modules.split()
} | {"tweezer.sweeps.figures": "tweezer.plots.sweeps"}
#: Package of earlier releases, and the packages that contain its names now
_ANALYSIS = "tweezer.analysis"
_HEIRS = ("calibration", "tracking", "trap", "runs", "reading", "ensembles")


class _Former(MetaPathFinder, Loader):
    """Import finder and loader for the module paths of earlier releases."""

    def find_spec(self, fullname: str, *_: Any) -> ModuleSpec | None:
        """Return the specification of a module with an old path, and warn; None for others."""
        if fullname == _ANALYSIS:
            return ModuleSpec(fullname, self, is_package=True)
        if fullname not in _NEW:
            return None
        _tell(fullname, _NEW[fullname])
        return ModuleSpec(fullname, self)

    def create_module(self, spec: ModuleSpec) -> None:
        """Return None, so that the import system creates the module."""

    def exec_module(self, module: ModuleType) -> None:
        """Replace the module of an old path by the module with the new path.

        The former package `tweezer.analysis` instead looks up its names in several packages.
        """
        if module.__name__ == _ANALYSIS:
            module.__dict__["__getattr__"] = _of_analysis
        else:  # the import system returns the entry of sys.modules
            sys.modules[module.__name__] = importlib.import_module(_NEW[module.__name__])


def find_former_paths() -> None:
    """Add the finder of old paths to the import system, unless it was added before."""
    if not any(isinstance(each, _Former) for each in sys.meta_path):
        sys.meta_path.append(_Former())


def module_of(name: str) -> ModuleType | None:
    """Return the module whose old path is `tweezer.NAME`; None if there was no such path."""
    old = f"tweezer.{name}"
    if old == _ANALYSIS:
        return importlib.import_module(old)
    if old not in _NEW:
        return None
    _tell(old, _NEW[old])
    module = importlib.import_module(_NEW[old])
    setattr(sys.modules["tweezer"], name, module)
    return module


def _of_analysis(name: str) -> Any:
    """Return a public name of the former package `tweezer.analysis`, with a warning."""
    for heir in () if name.startswith("__") else _HEIRS:
        package = importlib.import_module(f"tweezer.{heir}")
        if name in package.__all__:
            _tell(f"{_ANALYSIS}.{name}", f"tweezer.{heir}.{name}")
            found = getattr(package, name)
            setattr(sys.modules[_ANALYSIS], name, found)
            return found
    raise AttributeError(f"module {_ANALYSIS!r} has no attribute {name!r}")


def _tell(old: str, new: str) -> None:
    """Warn that a path of an earlier release has moved."""
    from tweezer.values.errors import warn

    warn(f"{old}: has moved to {new}; the old path will be removed in version 0.3", FutureWarning)
