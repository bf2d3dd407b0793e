"""The code by which Python calls a compiled function, left out where only compiled code calls it.

That code takes a quarter of the time to compile.
"""

from __future__ import annotations

from typing import Any

from numba.core import sigutils
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from tweezer.compiled import linked


class Callers:
    """Compiles a function for those who call it.

    For compiled code without the code by which Python calls it, to be linked into that of its
    caller; and with that code when Python calls the function, or takes its address.
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
        """`Dispatcher.get_call_template`: compiled code calls the function."""
        before, self.compiled = self.compiled, True
        try:
            return self._call_template(*arguments)
        finally:
            self.compiled = before

    def _compiled(self, signature: Any) -> Any:
        """`Dispatcher.compile`: for Python once more, if it was without that code."""
        with global_compiler_lock:
            self._forget(signature)
            return self._compile(signature)

    def _get_compile_result(self, signature: Any) -> Any:
        """`Dispatcher.get_compile_result`: likewise for its address."""
        with global_compiler_lock:
            self._forget(signature)
            return self._result(signature)

    def _forget(self, signature: Any) -> None:
        """Forget what Python cannot call, if it is Python that calls."""
        types = tuple(sigutils.normalize_signature(signature)[0])
        if not self.compiled and types in self._without:
            self._without.remove(types)
            del self._overloads[types]

    def _added(self, result: Any) -> None:
        """`Dispatcher.add_overload`: Python must not find what it cannot call."""
        if self.compiled:
            types = tuple(result.signature.args)
            self._without.add(types)
            found = result.entry_point is not None
            self._overloads[types] = result if found else linked.with_entry(result)
        else:
            self._add(result)
            linked.set_environments(result)

    def _customised(self, flags: Any) -> Any:
        """`_FunctionCompiler._customize_flags`: the options of one compilation."""
        if self.compiled:
            flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.no_compile = True
        return flags
