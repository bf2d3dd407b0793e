"""Compilation that omits the entry point for Python from functions that only compiled code calls.

The entry point takes a quarter of the compile time.
"""

from __future__ import annotations

from typing import Any

from numba.core import sigutils
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from tweezer.compiled import linked


class Callers:
    """Compiler of a function that adds the entry point for Python only where Python calls it.

    If compiled code calls the function, it is compiled without an entry point and linked into the
    code of its caller. It is compiled with one when Python calls it or takes its address.
    """

    def __init__(self, dispatcher: Dispatcher) -> None:
        """Route the methods of `dispatcher`, the function's Numba object, through this object."""
        function: Any = dispatcher
        self._overloads = function.overloads
        self._call_template = function.get_call_template
        self._compile, self._add = function.compile, function.add_overload
        self._result = function.get_compile_result
        self._without: set[tuple[Any, ...]] = set()
        self.compiled = False
        """whether compiled code asks for the function at this moment"""
        function.get_call_template = self._get_call_template
        function.compile, function.add_overload = self._compiled, self._added
        function.get_compile_result = self._get_compile_result
        function._compiler._customize_flags = self._customised
        function._compiler.pipeline_class = linked.LinkingCompiler

    def _get_call_template(self, *arguments: Any) -> Any:
        """Return the variant for compiled code to call; replaces `Dispatcher.get_call_template`."""
        before, self.compiled = self.compiled, True
        try:
            return self._call_template(*arguments)
        finally:
            self.compiled = before

    def _compiled(self, signature: Any) -> Any:
        """Compile the function for Python, even if a variant without entry point exists.

        Replaces `Dispatcher.compile`.
        """
        with global_compiler_lock:
            self._forget(signature)
            return self._compile(signature)

    def _get_compile_result(self, signature: Any) -> Any:
        """Return the compiled function with an address; replaces `Dispatcher.get_compile_result`.

        A variant without entry point is compiled again.
        """
        with global_compiler_lock:
            self._forget(signature)
            return self._result(signature)

    def _forget(self, signature: Any) -> None:
        """Discard a variant without entry point if the present call is from Python."""
        types = tuple(sigutils.normalize_signature(signature)[0])
        if not self.compiled and types in self._without:
            self._without.remove(types)
            del self._overloads[types]

    def _added(self, result: Any) -> None:
        """Register a compiled variant; replaces `Dispatcher.add_overload`.

        A variant without entry point is hidden from calls by Python, which would fail.
        """
        if self.compiled:
            types = tuple(result.signature.args)
            self._without.add(types)
            found = result.entry_point is not None
            self._overloads[types] = result if found else linked.with_entry(result)
        else:
            self._add(result)
            linked.set_environments(result)

    def _customised(self, flags: Any) -> Any:
        """Set the options of one compilation; replaces `_FunctionCompiler._customize_flags`."""
        if self.compiled:
            flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.no_compile = True
        return flags
