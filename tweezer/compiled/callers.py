"""Compilation without the code by which Python calls a function, where only compiled code calls it.

That code takes a quarter of the time to compile.
"""

from __future__ import annotations

from typing import Any

from numba.core import sigutils
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from tweezer.compiled import linked


class Callers:
    """Compiler of a function that adds code for calls from Python only where Python calls it.

    For compiled code the function is compiled without it, to be linked into the code of its caller;
    it is compiled with it when Python calls the function or takes its address.
    """

    def __init__(self, dispatcher: Dispatcher) -> None:
        """dispatcher: of the function; calls of its methods go through this object from now on."""
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
        """Answer compiled code that calls the function; replaces `Dispatcher.get_call_template`."""
        before, self.compiled = self.compiled, True
        try:
            return self._call_template(*arguments)
        finally:
            self.compiled = before

    def _compiled(self, signature: Any) -> Any:
        """Compile the function, again for Python if it was compiled without the code for calls from
        Python.

        Replaces `Dispatcher.compile`.
        """
        with global_compiler_lock:
            self._forget(signature)
            return self._compile(signature)

    def _get_compile_result(self, signature: Any) -> Any:
        """Return the compiled function with an address; replaces `Dispatcher.get_compile_result`.

        A version without the code for calls from Python is compiled again.
        """
        with global_compiler_lock:
            self._forget(signature)
            return self._result(signature)

    def _forget(self, signature: Any) -> None:
        """Forget a version that Python cannot call, if it is Python that calls now."""
        types = tuple(sigutils.normalize_signature(signature)[0])
        if not self.compiled and types in self._without:
            self._without.remove(types)
            del self._overloads[types]

    def _added(self, result: Any) -> None:
        """Register a compiled version; replaces `Dispatcher.add_overload`.

        Python must not find a version that it cannot call.
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
