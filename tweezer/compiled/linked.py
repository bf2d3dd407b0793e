"""Functions that only compiled code calls, linked into their callers without machine code.

Numba normally compiles each function to machine code and loads it, even if only compiled code calls
it. A caller compiled with its own copy is then bound to the copy that the process loaded first.
Separately optimised copies differ in rounding, so results depended in the last bits on whether a
process compiled a function or loaded it from the cache.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult

_KIND = "linked"


class _Entry:
    """Placeholder for the address that a linked function lacks and by which Numba identifies it."""


class _Linked(JITCodeLibrary):
    """Numba's code library of a function that is never compiled to machine code."""

    def _optimize_final_module(self) -> None:
        """Do nothing, because the code is optimised in the module it is linked into."""

    def _finalize_final_module(self) -> None:
        """Complete the module without compiling it to machine code."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """Return the library as the cache stores it: name, kind and LLVM's bitcode."""
        self._ensure_finalized()
        return self.name, _KIND, self._final_module.as_bitcode()


class LinkingCompiler(Compiler):
    """Numba's compiler, which omits machine code for functions with the flag `no_compile`."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function; `numba.core.compiler.compile_extra` calls this method."""
        if self.state.flags.no_compile:
            codegen = self.state.targetctx.codegen()
            self.state.library = _Linked(codegen, function.__qualname__)
        return super().compile_extra(function)


def with_entry(result: CompileResult) -> CompileResult:
    """Register a function that is only linked, so that compiled code can call it."""
    result = result._replace(entry_point=_Entry())
    result.target_context.insert_user_function(result.entry_point, result.fndesc, [result.library])
    return result


def set_environments(result: CompileResult) -> None:
    """Provide the machine code with the Python objects that functions linked into it refer to."""
    for each in result._find_referenced_environments():
        result.library.codegen.set_env(each.env_name, each)


def is_linked(kept: tuple[Any, ...]) -> bool:
    """Return whether a cached function is linked only; `kept` is Numba's tuple of its parts."""
    return bool(kept[0][1] == _KIND)


def rebuilt(context: Any, kept: tuple[Any, ...]) -> CompileResult:
    """Return a linked function from its cached parts, as `CompileResult._rebuild` does."""
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
