"""Digest of everything that a compiled function is compiled from."""

from __future__ import annotations

import builtins
import functools
import hashlib
import sys
import sysconfig
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic
from numba.core.types import Type

#: Folders of installed libraries
_LIBRARIES = {sysconfig.get_path(name) for name in ("stdlib", "purelib", "platlib")}
#: Types whose `repr` describes a value completely
_PLAIN = (int, float, complex, str, bytes, bool, type(None), type(Ellipsis), range)


def fingerprint(*values: Any) -> str:
    """Return a digest of functions and of everything they use: code, constants, called functions.

    A called function is found by name, as in Numba: in a closure, in the globals of the module, or
    as an attribute of a module. Functions of other libraries are represented by their names. Raises
    `TypeError` for a global whose type cannot be described.
    """
    digest = hashlib.sha256()
    for part in _parts(values, set()):
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()


def name_by_values(function: Any) -> None:
    """Append a digest of a closure's values to its name.

    Numba distinguishes the machine code of closures by a counter of the process, so without the
    digest a cached function could call the closure of another process (Numba issue 10486).
    """
    if function.__closure__:
        values = [cell.cell_contents for cell in function.__closure__]
        function.__qualname__ += f"_{fingerprint(*values)[:16]}"


def _parts(value: Any, seen: set[int]) -> Iterator[str]:
    """Yield the parts of a description of a value that is the same in every process.

    `seen` contains the `id` of each function that was described; new functions are added to it.
    """
    if isinstance(value, _PLAIN):
        yield repr(value)
    elif isinstance(value, tuple | list):
        yield f"{type(value).__name__} of {len(value)}"
        for each in value:
            yield from _parts(each, seen)
    elif isinstance(value, set | frozenset):
        yield repr(sorted(map(repr, value)))
    elif isinstance(value, dict):
        yield from _parts(sorted(value.items()), seen)
    elif isinstance(value, np.ndarray | np.generic):
        yield f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    elif isinstance(value, Dispatcher):
        yield from _parts(value.targetoptions, seen)
        yield from _parts(value.py_func, seen)
    elif isinstance(value, _Intrinsic):
        yield from _parts(value._defn, seen)
    elif isinstance(value, types.FunctionType) and _ours(value):
        yield value.__name__
        if id(value) not in seen:
            seen.add(id(value))
            yield from _of_function(value, seen)
    elif isinstance(value, type) and _ours(value):
        yield f"{value.__qualname__} {getattr(value, '_fields', ())}"
    elif isinstance(value, Type):
        yield str(value)
    elif isinstance(value, types.ModuleType | type) or callable(value):
        yield getattr(value, "__name__", type(value).__name__)
    else:
        raise TypeError(f"{value!r} in a compiled function: its changes cannot be detected")


def _of_function(function: types.FunctionType, seen: set[int]) -> Iterator[str]:
    """Yield a description of a Python function: code, defaults, closure and the globals that it
    reads.
    """
    yield from _of_code(function.__code__)
    yield from _parts(function.__defaults__, seen)
    yield from _parts([cell.cell_contents for cell in function.__closure__ or ()], seen)
    for name in sorted(_names(function.__code__)):
        if name in function.__globals__:
            value = function.__globals__[name]
            yield name
            yield from _parts(value, seen)
            if isinstance(value, types.ModuleType) and _may_change(value.__name__):
                used = _names(function.__code__) & set(vars(value))
                for attribute in sorted(used):
                    yield f"{name}.{attribute}"
                    yield from _parts(getattr(value, attribute), seen)
        elif not hasattr(builtins, name):
            yield f"no {name}"


@functools.cache
def _of_code(code: types.CodeType) -> list[str]:
    """Return the parts of a description of a code object and of the code objects within it."""
    parts = [
        code.co_code.hex(),
        repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)),
    ]
    for constant in code.co_consts:
        within = isinstance(constant, types.CodeType)
        parts += _of_code(constant) if within else _parts(constant, set())
    return parts


@functools.cache
def _names(code: types.CodeType) -> set[str]:
    """Return the names that the code of a function reads from its globals or from a module."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            names |= _names(constant)
    return names


def _ours(value: Any) -> bool:
    """Return whether a function or class belongs to tweezer or to a user."""
    return _may_change(str(value.__module__))


@functools.cache
def _may_change(module: str) -> bool:
    """Return whether a module belongs to tweezer or to a user.

    Other libraries change only with their version.
    """
    if module.partition(".")[0] in ("tweezer", "__main__"):
        return True
    path = getattr(sys.modules.get(module), "__file__", None)
    return path is not None and not any(Path(path).is_relative_to(each) for each in _LIBRARIES)
