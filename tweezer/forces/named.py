"""The user's own forces by file and name: "handles.py:spring"."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tweezer.forces.force import Force
from tweezer.values.errors import SceneError
from tweezer.values.files import check_regular

#: File, name and digest of forces that were read, by `id`; they live as long as the process, so
#: that no `id` is used again
_ORIGINS: dict[int, str] = {}


def named_force(text: str) -> Any:
    """Return the force that "FILE.py:NAME" names; the file is run once.

    Raises `SceneError` if there is no such file or name, or if the file raises an exception.
    """
    file, colon, name = text.rpartition(":")
    if not colon or not file.endswith(".py") or not name.isidentifier():
        raise SceneError(
            f"force = {text!r}: must be FILE.py:NAME; example: handles.py:spring, where handles.py "
            "has spring = UserForce(...)"
        )
    path = Path(file).absolute()
    try:
        check_regular(path)
        content = path.read_bytes()
    except OSError as error:
        raise SceneError(f"force = {text!r}: {error.strerror or error}") from None
    digest = hashlib.sha256(content).hexdigest()[:16]
    module = _run(path, digest, text)
    if not hasattr(module, name):
        made = ", ".join(each for each, it in vars(module).items() if isinstance(it, Force))
        raise SceneError(
            f"force = {text!r}: {path.name} has no {name}; forces in it: {made or '-'}"
        )
    found = getattr(module, name)
    if isinstance(found, Force):
        _ORIGINS[id(found)] = f"{path.name}:{name}, sha256 {digest}"
    return found


@functools.cache
def _run(path: Path, digest: str, text: str) -> Any:
    """Run a Python file of forces as a module, once for each content, and return the module.

    digest: of the content. text: names the force in messages. Raises `SceneError` if the file
    raises an exception.
    """
    name = f"tweezer_force_{digest}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        told = " ".join(str(error).split())
        raise SceneError(
            f"force = {text!r}: {type(error).__name__} in {path.name}: {told}"
        ) from None
    return module


def origins_of(forces: Iterable[Force]) -> str:
    """Return the files of forces and their digests; "" if a force does not come from a file."""
    found = [_ORIGINS.get(id(each), "") for each in forces]
    return "; ".join(found) if all(found) else ""
