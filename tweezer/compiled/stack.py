"""Short arrays on the stack of compiled functions, which need no memory allocation."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

#: Size of a cache line of the processor, bytes
_LINE = 64


@intrinsic(prefer_literal=True)
def on_stack(typing: Any, count: Any, dtype: Any) -> Any:  # noqa: ARG001
    """Return an uninitialised array of `count` elements on the stack.

    The count must be a constant. The array is valid until the function returns, and must not be
    returned. In a loop every iteration gets the same memory.
    """
    if not isinstance(count, types.IntegerLiteral):
        return None
    kind, length = types.Array(dtype.dtype, 1, "C"), count.literal_value

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        number = context.get_value_type(kind.dtype)
        size = context.get_abi_sizeof(number)
        with builder.goto_entry_block():
            memory = builder.alloca(ir.ArrayType(number, length))
        memory.align = _LINE
        array = context.make_array(kind)(context, builder)
        context.populate_array(
            array,
            data=builder.bitcast(memory, number.as_pointer()),
            shape=[context.get_constant(types.intp, length)],
            strides=[context.get_constant(types.intp, size)],
            itemsize=context.get_constant(types.intp, size),
            meminfo=None,
        )
        return array._getvalue()

    return kind(count, dtype), emitted


@intrinsic
def borrowed(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Return the same arrays without reference counting, for use while a caller owns them.

    `value` is a tuple of arrays, numbers and such tuples. Compiled code updates a reference count
    wherever it names an array, which costs more than short work on the array.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _uncounted(context, builder, signature.args[0], values[0])

    return value(value), emitted


def _uncounted(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Emit a copy of a value of Numba's type `kind` in which no array has an owner."""
    if isinstance(kind, types.BaseTuple):
        parts = [
            _uncounted(context, builder, each, builder.extract_value(value, i))
            for i, each in enumerate(kind.types)
        ]
        return context.make_tuple(builder, kind, parts)
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = ir.Constant(array.meminfo.type, None)
        return array._getvalue()
    return value
