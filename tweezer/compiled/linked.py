"""Functions that only compiled code calls: linked into their callers, without machine code of their
own.

Numba makes machine code of each function, also of those that compiled code alone calls, and loads
it. Code of another function that was compiled with a copy of its own is then bound to the first
copy that the process loaded. The copies are optimised apart and differ in rounding, so a process
that compiled a function itself got other last bits than one that found it in the cache.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult

_KIND = "linked"


class _Entry:
    """Placeholder for the address that a linked function lacks: Numba looks the
    function up by it.
    """


class _Linked(JITCodeLibrary):
    """Numba's code library of a function, without machine code."""

    def _optimize_final_module(self) -> None:
        """Do nothing: the code is optimised in the module that it is linked into."""

    def _finalize_final_module(self) -> None:
        """Complete the module without making machine code of it."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """Return the library as the cache stores it: name, kind and LLVM's bitcode."""
        self._ensure_finalized()
        return self.name, _KIND, self._final_module.as_bitcode()


class LinkingCompiler(Compiler):
    """Numba's compiler, which makes no machine code of a function with the flag `no_compile`."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function, as `numba.core.compiler.compile_extra` asks for it."""
        if self.state.flags.no_compile:
            codegen = self.state.targetctx.codegen()
            self.state.library = _Linked(codegen, function.__qualname__)
        return super().compile_extra(function)


def with_entry(result: CompileResult) -> CompileResult:
    """Register a function that is only linked, so that compiled code finds it."""
    result = result._replace(entry_point=_Entry())
    result.target_context.insert_user_function(result.entry_point, result.fndesc, [result.library])
    return result


def set_environments(result: CompileResult) -> None:
    """Give the machine code the Python objects that functions linked into it refer to."""
    for each in result._find_referenced_environments():
        result.library.codegen.set_env(each.env_name, each)


def is_linked(kept: tuple[Any, ...]) -> bool:
    """Return whether the cached parts of a compiled function, Numba's tuple, are of one that is
    only linked.
    """
    return bool(kept[0][1] == _KIND)


def rebuilt(context: Any, kept: tuple[Any, ...]) -> CompileResult:
    """Return a linked function from its cached parts; corresponds to `CompileResult._rebuild`."""
    (name, _, bitcode), descriptor, environment, signature, objectmode, lifted, *others = kept
    annotation, reload_init, referenced = others
    for initialise in reload_init:
        initialise()
    library = _Linked(context.codegen(), name)
    library._final_module = llvm.parse_bitcode(bitcode)
    library._finalize_final_module()
    return CompileResult(
        typing_context=context.typing_context, target_context=context, entry_point=_Entry(),
        typing_error=None, type_annotation=annotation, signature=signature, objectmode=objectmode,
        lifted=lifted, fndesc=descriptor, library=library, call_helper=None,
        environment=environment, metadata=None, reload_init=reload_init,
        referenced_envs=referenced,
    )  # fmt: skip
