"""Eight numbers that the processor adds and multiplies at once, as a type of compiled functions.

`lanes(array, i)` reads eight consecutive numbers, `store` writes them, `spread` repeats one number,
`total` adds them up; +, - and * act on each of the eight. A product and a sum may be rounded
once (fused). So short loops are fast without the compiler having to find out how.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.datamodel import models
from numba.extending import intrinsic, lower_builtin, register_model, type_callable

from tweezer.compiled.fingerprint import fingerprint

#: Count of numbers
LANES = 8


def _vector() -> Any:
    """Type of eight numbers in the processor."""
    return ir.VectorType(ir.DoubleType(), LANES)


def _repeated(builder: Any, number: Any) -> Any:
    zeros = ir.Constant(_vector(), [0.0] * LANES)
    first = builder.insert_element(zeros, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, zeros, _mask([0] * LANES))


def _mask(entries: Iterable[int]) -> Any:
    chosen = list(entries)
    return ir.Constant(ir.VectorType(ir.IntType(32), len(chosen)), chosen)


def _combined(builder: Any, instruction: str, kinds: Any, values: Any) -> Any:
    """Two lanes, or lanes and a number, combined. A product may be fused with a sum it enters."""
    a, b = (
        value if isinstance(kind, Lanes) else _repeated(builder, value)
        for kind, value in zip(kinds, values, strict=True)
    )
    return getattr(builder, instruction)(a, b, flags=("contract",))


class Lanes(types.Type):
    """Numba's type of eight numbers."""


#: The name holds the digest of the arithmetic: the cache of compiled code knows a type by its name
_LANES = Lanes(f"Lanes {fingerprint(_combined, _repeated, _mask)}")


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    """Eight numbers in a register."""

    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, _vector())


def _place(context: Any, builder: Any, array_type: Any, array: Any, at: Any) -> Any:
    """Address of eight numbers of a contiguous array, from its entry `at` on."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), _vector().as_pointer())


@intrinsic
def lanes(typing: Any, array: Any, at: Any) -> Any:  # noqa: ARG001
    """Eight numbers of a contiguous array of one axis, from its entry `at` on."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        place = _place(context, builder, signature.args[0], *values)
        return builder.load(place, align=8)

    return _LANES(array, types.intp), emitted


@intrinsic
def store(typing: Any, array: Any, at: Any, value: Any) -> Any:  # noqa: ARG001
    """Write eight numbers into a contiguous array of one axis, from its entry `at` on."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        place = _place(context, builder, signature.args[0], *values[:2])
        builder.store(values[2], place, align=8)
        return context.get_dummy_value()

    return types.none(array, types.intp, _LANES), emitted


@intrinsic
def spread(typing: Any, number: Any) -> Any:  # noqa: ARG001
    """One number eight times."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return _repeated(builder, values[0])

    return _LANES(types.float64), emitted


@intrinsic
def total(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """The sum of the eight."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        left, width = values[0], LANES
        while width > 1:
            width //= 2
            low, high = (
                builder.shuffle_vector(left, left, _mask(range(first, first + width)))
                for first in (0, width)
            )
            left = builder.fadd(low, high)
        return builder.extract_element(left, ir.Constant(ir.IntType(32), 0))

    return types.float64(_LANES), emitted


def _give(operation: Any, instruction: str) -> None:
    """Give lanes an operation with each other and with numbers."""

    @type_callable(operation)
    def typed(context: Any) -> Any:  # noqa: ARG001
        def of(a: Any, b: Any) -> Any:
            kinds = isinstance(a, Lanes), isinstance(b, Lanes)
            others = [kind for kind, own in zip((a, b), kinds, strict=True) if not own]
            if any(kinds) and all(isinstance(kind, types.Float) for kind in others):
                return _LANES
            return None

        return of

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return _combined(builder, instruction, signature.args, values)

    for kinds in ((Lanes, Lanes), (Lanes, types.Float), (types.Float, Lanes)):
        lower_builtin(operation, *kinds)(emitted)


for _operation, _instruction in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"),
):  # fmt: skip
    _give(_operation, _instruction)


@type_callable(operator.neg)
def _negated_type(context: Any) -> Any:  # noqa: ARG001
    return lambda a: _LANES if isinstance(a, Lanes) else None


@lower_builtin(operator.neg, Lanes)
def _negated(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
    return builder.fneg(values[0])
