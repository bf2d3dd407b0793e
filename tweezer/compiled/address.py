"""Calls by address, by which a compiled loop calls functions that are compiled later."""

from __future__ import annotations

import functools
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@functools.cache
def address(function: Any, signature: Any) -> int:
    """Return the address of the machine code of a compiled function for a signature.

    The function is compiled if needed. The address is valid until the process ends.
    """
    compiled = function.get_compile_result(signature)
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name))


@intrinsic
def call(typing: Any, at: Any, arguments: Any) -> Any:  # noqa: ARG001
    """Call the function at the address `at` with a tuple of arguments; the function returns None.

    The types of the arguments are not checked.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        nothing = context.get_value_type(types.none)
        taken = [context.get_value_type(each) for each in arguments.types]
        function = builder.inttoptr(values[0], ir.FunctionType(nothing, taken).as_pointer())
        parts = [builder.extract_value(values[1], i) for i in range(len(taken))]
        builder.call(function, parts)
        return context.get_dummy_value()

    return types.none(at, arguments), emitted


def native_address(compiled: Any, signature: Any) -> int:
    """Return the address of a compiled function's machine code with Numba's calling convention.

    Called by `attempt`, it can report an exception, unlike a function called by `call`.
    """
    result = compiled.get_compile_result(signature)
    return int(result.library.get_pointer_to_function(result.fndesc.llvm_func_name))


@intrinsic
def attempt(typing: Any, at: Any, arguments: Any) -> Any:  # noqa: ARG001
    """Call the function at a `native_address`, and return whether it raised an exception.

    The types of the arguments are not checked.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        convention = context.call_conv
        kind = convention.get_function_type(types.none, arguments.types)
        function = builder.inttoptr(values[0], kind.as_pointer())
        parts = [builder.extract_value(values[1], i) for i in range(len(arguments.types))]
        returned, raised = (
            cgutils.alloca_once_value(builder, cgutils.get_null_value(each.pointee))
            for each in kind.args[:2]
        )
        packer = context.get_arg_packer(arguments.types)
        code = builder.call(function, [returned, raised, *packer.as_arguments(builder, parts)])
        return convention._get_return_status(builder, code, builder.load(raised)).is_error

    return types.boolean(at, arguments), emitted


@intrinsic
def array_at(typing: Any, at: Any, shape: Any) -> Any:  # noqa: ARG001
    """Return an array of the given shape that uses the memory at address `at`.

    The memory must outlive the array.
    """
    kind = types.Array(types.float64, len(shape), "C")

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        number = context.get_value_type(kind.dtype)
        size = context.get_constant(types.intp, context.get_abi_sizeof(number))
        lengths = cgutils.unpack_tuple(builder, values[1])
        strides = [size]
        for length in lengths[:0:-1]:
            strides.insert(0, builder.mul(strides[0], length))
        array = context.make_array(kind)(context, builder)
        context.populate_array(
            array,
            data=builder.inttoptr(values[0], number.as_pointer()),
            shape=lengths,
            strides=strides,
            itemsize=size,
            meminfo=None,
        )
        return array._getvalue()

    return kind(types.int64, types.UniTuple(types.int64, len(shape))), emitted


def protected(kind: Any) -> Any:
    """Return the read-only variant of the type of an array or of a named tuple of arrays."""
    if isinstance(kind, types.NamedTuple):
        return types.NamedTuple([protected(each) for each in kind.types], kind.instance_class)
    if isinstance(kind, types.NamedUniTuple):
        return types.NamedUniTuple(protected(kind.dtype), kind.count, kind.instance_class)
    return kind.copy(readonly=True)


@intrinsic
def read_only(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Return arrays unchanged, but with a type that forbids compiled code to write to them."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        context.nrt.incref(builder, signature.args[0], values[0])
        return values[0]

    return protected(value)(value), emitted
