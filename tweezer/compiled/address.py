"""Calls by address: a compiled loop may call functions that did not exist when it was compiled."""

from __future__ import annotations

import functools
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@functools.cache
def address(function: Any, signature: Any) -> int:
    """Address of the machine code of a compiled function for that signature.

    The function is compiled if needed. The address is valid as long as the process lives.
    """
    compiled = function.get_compile_result(signature)
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name))


@intrinsic
def call(typing: Any, at: Any, arguments: Any) -> Any:  # noqa: ARG001
    """Call the function at an address with a tuple of arguments. It returns nothing.

    The function must take arguments of these types; nothing checks that.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        nothing = context.get_value_type(types.none)
        taken = [context.get_value_type(each) for each in arguments.types]
        function = builder.inttoptr(values[0], ir.FunctionType(nothing, taken).as_pointer())
        parts = [builder.extract_value(values[1], i) for i in range(len(taken))]
        builder.call(function, parts)
        return context.get_dummy_value()

    return types.none(at, arguments), emitted
