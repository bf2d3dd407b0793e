"""The cache of compiled functions.

The digest in a file detects damage, not malice: whoever can write to the folder of the cache can
run code in the processes that read it.

Functions of other libraries use Numba's own cache.
"""

from __future__ import annotations

import functools
import hashlib
import logging
import pickle
import secrets
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
from numba.core import caching
from numba.core.dispatcher import Dispatcher
from numba.core.runtime.nrt import rtsys

from tweezer.compiled import environments, linked, options, shared
from tweezer.compiled.callers import Callers
from tweezer.compiled.compiling import not_kept, stored
from tweezer.compiled.fingerprint import fingerprint, name_by_values

_log = logging.getLogger("tweezer")

#: Version of the stored form; files with another version are ignored
_FORM = 3
#: Length of a SHA-256, bytes
_DIGEST = 32


def _fields(kind: Any) -> Any:
    """Return the field names of Numba's named tuples in a type, in order, at every depth.

    They are part of the file name, because compiled code reads a field by its position: it would
    be wrong after a change of the order.
    """
    parts = kind if isinstance(kind, tuple) else getattr(kind, "types", ())
    within = [_fields(each) for each in parts]
    return (getattr(kind, "fields", ()), within) if within else ()


class _File:
    """Compiled code of one function, in a file for each set of argument types and processor.

    A file begins with a digest of its sources and content. A file that is truncated, changed or
    compiled from other sources is ignored, and the function is compiled again. Files are written
    atomically, so processes need no lock.
    """

    def __init__(self, base: str, dispatcher: Dispatcher) -> None:
        self._base = base
        self._dispatcher = dispatcher

    @functools.cached_property
    def _compiled_from(self) -> bytes:
        """Description of everything that the function is compiled from.

        It uses the functions in memory, because source files may change while the program runs.
        """
        return f"{_FORM} {numba.__version__}{fingerprint(self._dispatcher)}".encode()

    def load(self, key: Any) -> Any:
        """Return the code stored for the variant `key`, Numba's tuple; None if there is no file."""
        try:
            whole = self.path(key).read_bytes()
        except OSError:
            return None
        digest, content = whole[:_DIGEST], whole[_DIGEST:]
        if digest != self._digest(content):
            return None
        try:
            kept_under, code = pickle.loads(content)
        except Exception as error:  # types from a module that this process cannot import
            _log.debug("%s cannot be read: %s", self.path(key), error)
            return None
        return code if kept_under == key else None

    def save(self, key: Any, code: Any) -> None:
        """Store the code of the variant `key`; raises `OSError` if it cannot be written."""
        content, path = caching.dumps((key, code)), self.path(key)
        part = path.with_name(f"{path.name}.{secrets.token_hex(8)}")
        try:
            part.write_bytes(self._digest(content) + content)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)

    def path(self, key: Any) -> Path:
        """Return the path of the file for the variant `key`."""
        signature, *others = key
        told = f"{signature!r} {_fields(getattr(signature, 'args', signature))} {others!r}"
        types_and_processor = hashlib.sha256(told.encode()).hexdigest()
        return Path(f"{self._base}.{types_and_processor[:16]}.nbc")

    def _digest(self, content: bytes) -> bytes:
        """Return the digest of the sources and of the content of a file."""
        return hashlib.sha256(self._compiled_from + content).digest()


class _Contents(caching.CompileResultCacheImpl):
    """Conversion of compiled functions to the parts that the cache stores, and back."""

    def reduce(self, result: Any) -> tuple[Any, ...]:
        """Return the parts of a compiled function that the cache stores."""
        *others, referenced = super().reduce(result)
        return (*others, environments.to_keep(referenced))

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> Any:
        """Rebuild a function from its stored parts, `payload`."""
        payload = (*payload[:-1], environments.rebuilt(payload[-1]))
        if linked.is_linked(payload):
            return linked.rebuilt(target_context, payload)
        return super().rebuild(target_context, payload)


class _Cache(caching.FunctionCache):
    """Numba's cache of one function, with files that are verified when read."""

    _impl_class = _Contents

    def __init__(self, dispatcher: Dispatcher, callers: Callers) -> None:
        super().__init__(dispatcher.py_func)
        base = Path(self.cache_path, self._impl.filename_base)
        self._cache_file = _File(str(base), dispatcher)
        self._callers = callers
        self.dispatcher = dispatcher
        stored.add(dispatcher)

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Return the key of a variant: argument types, processor, and the caller's language.

        Code called from Python differs from code that compiled functions call. The fingerprint
        covers everything else.
        """
        return sig, codegen.magic_tuple(), "compiled" if self._callers.compiled else "Python"

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the stored function, waiting for another process that is compiling it."""
        found = self._loaded(signature, context)
        if found is None and not self._callers.compiled:
            key = self._index_key(signature, context.codegen())
            if shared.claim(str(self._cache_file.path(key)), self.dispatcher):
                found = self._loaded(signature, context)
        return found

    def _loaded(self, signature: Any, context: Any) -> Any:
        """Return the stored function without starting Numba's compiler.

        Numba would import and register all functions that its compiler knows, which takes longer
        than loading the code. Machine code requires only Numba's memory management. The compiler
        registers its functions when it starts.
        """
        rtsys.initialize(context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(signature, context)

    def save_overload(self, signature: Any, code: Any) -> None:
        """Store a compiled function; warn once if the folder cannot be written."""
        try:
            super().save_overload(signature, code)
        except OSError as error:
            not_kept(str(error.strerror))
        finally:
            if not self._callers.compiled:
                shared.release()


def cached_njit(signature: Any = None, **options: Any) -> Any:
    """Return a decorator that compiles a function and stores the code in tweezer's cache.

    The function is compiled as by `numba.njit` with the same `options`. Later processes load the
    stored code, unless anything that it depends on has changed, in any file (see `fingerprint`).
    With `signature`, the argument types, the function is compiled or loaded immediately, otherwise
    when it is first called.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        dispatcher = named_njit(**options)(function)
        dispatcher._cache = _Cache(dispatcher, dispatcher.callers)
        if signature is not None:  # calls then skip the lookup of types
            dispatcher.compile(signature)
            dispatcher.disable_compile()
        return dispatcher

    return compiled


def named_njit(*, inner: bool = False, **options: Any) -> Any:
    """Compile a function as `numba.njit` does, without a cache, to be called by cached functions.

    If `inner`, only compiled functions may call it, and a call from Python raises `TypeError`.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        name_by_values(function)
        dispatcher: Any = numba.njit(**options)(function)
        dispatcher.callers = Callers(dispatcher)

        def refuse(*_: Any, **__: Any) -> None:
            raise TypeError(f"{function.__name__}: only compiled functions can call it")

        if inner:
            dispatcher._compile_for_args = refuse
        return dispatcher

    return compiled


def cache_functions(module: ModuleType) -> ModuleType:
    """Make the compiled functions of an emitted module use tweezer's cache; return the module."""
    for each in vars(module).values():
        function: Any = each
        if isinstance(each, Dispatcher) and not isinstance(function._cache, _Cache):
            function._cache = _Cache(each, Callers(each))
    return module


options.compare_by_what_is_set()
