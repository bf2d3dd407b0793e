"""Vectors of eight numbers that the processor adds and multiplies simultaneously, for Numba.

`of_lanes` extracts one of eight numbers, and `alternated` takes every other one from each of two
vectors.

`lanes(array, i)` loads eight consecutive numbers and `store` writes them. `spread` repeats one
number, `total` adds the eight numbers, and `root` is the square root. The operators +, -, * and /
act on each of the eight. A product and a sum may be rounded once (fused). Short loops are then fast
without relying on the compiler to vectorise them. `transposed` loads the columns of an 8 x 8 block;
`columns`, `store_columns` and `add_columns` access the columns of an 8 x 3 block.

`words(array, i)` loads eight 64-bit words, with the operators +, ^, &, |, << and >> (shifting in
zeros), and `rotated`. `as_words` and `as_lanes` reinterpret the bits of numbers and words. `below`
compares numbers, `anywhere` tests for a nonzero word, and `chosen` selects between numbers.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.datamodel import models
from numba.extending import intrinsic, lower_builtin, register_model, type_callable

from tweezer.compiled.fingerprint import fingerprint

#: Number of elements of a vector
LANES = 8


def _vector(element: Any) -> Any:
    """Return LLVM's type of a vector of eight elements."""
    return ir.VectorType(element, LANES)


def _repeated(builder: Any, number: Any) -> Any:
    """Emit code that fills a vector with one number."""
    zeros = ir.Constant(_vector(number.type), None)
    first = builder.insert_element(zeros, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, zeros, _mask([0] * LANES))


def _mask(entries: Iterable[int]) -> Any:
    """Return a constant vector of indices; LLVM's shuffle instruction selects elements by it."""
    chosen = list(entries)
    return ir.Constant(ir.VectorType(ir.IntType(32), len(chosen)), chosen)


def _combined(builder: Any, instruction: str, kinds: Any, values: Any) -> Any:
    """Emit an arithmetic instruction on two vectors, or on a vector and a repeated number.

    `kinds` are Numba's types of the two `values`. Floating-point products may be fused with sums.
    """
    a, b = (
        value if isinstance(kind, Lanes) else _repeated(builder, value)
        for kind, value in zip(kinds, values, strict=True)
    )
    flags = ("contract",) if instruction.startswith("f") else ()
    return getattr(builder, instruction)(a, b, flags=flags)


class Lanes(types.Type):
    """Numba's type of a vector of eight numbers, or of eight 64-bit words."""


#: Digest of this whole file. A function that adds vectors does not name the code here that emits
#: the addition, so the fingerprint of that function cannot include it.
_DIGEST = fingerprint(Path(__file__).read_bytes())
#: The names of the types contain the digest, because the cache identifies a type by its name
_LANES, _WORDS = Lanes(f"Lanes {_DIGEST}"), Lanes(f"Words {_DIGEST}")


def _element(kind: Any) -> Any:
    """Return LLVM's type of an element: a double for numbers, an integer of 64 bits for words."""
    return ir.DoubleType() if kind is _LANES else ir.IntType(64)


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    """Representation of a vector in compiled code: eight elements in a register."""

    def __init__(self, manager: Any, numba_type: Any) -> None:
        super().__init__(manager, numba_type, _vector(_element(numba_type)))


def _place(context: Any, builder: Any, kinds: Any, array: Any, at: Any) -> Any:
    """Emit the address of eight elements of a contiguous array, beginning at flat index `at`.

    `kinds` are Numba's types of the arguments, the array first.
    """
    data = context.make_array(kinds[0])(context, builder, array).data
    vector = _vector(context.get_value_type(kinds[0].dtype))
    return builder.bitcast(builder.gep(data, [at]), vector.as_pointer())


def _load(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Emit code that loads eight elements of a contiguous array.

    `values` are the array and the flat index of the first element.
    """
    return builder.load(_place(context, builder, signature.args, *values), align=8)


@intrinsic
def lanes(typing: Any, array: Any, at: Any) -> Any:  # noqa: ARG001
    """Load eight consecutive numbers of a contiguous array, beginning at flat index `at`."""
    return _LANES(array, types.intp), _load


@intrinsic
def words(typing: Any, array: Any, at: Any) -> Any:  # noqa: ARG001
    """Load eight consecutive words of a contiguous 1-D integer array, beginning at index `at`."""
    return _WORDS(array, types.intp), _load


@intrinsic
def store(typing: Any, array: Any, at: Any, value: Any) -> Any:  # noqa: ARG001
    """Store eight numbers or words in a contiguous array.

    Parameters
    ----------
    typing : Context
        Typing context of numba.
    array : types.Array
        The array.
    at : types.Integer
        Flat index of the first of the eight.
    value : types.Type
        The numbers or words.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        place = _place(context, builder, signature.args, *values[:2])
        builder.store(values[2], place, align=8)
        return context.get_dummy_value()

    return types.none(array, types.intp, value), emitted


@intrinsic
def transposed(typing: Any, array: Any, at: Any) -> Any:  # noqa: ARG001
    """Load an 8 x 8 block of numbers, beginning at flat index `at`; return its columns as vectors.

    Pairs of vectors exchange blocks of one, two and then four elements.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        array, at = values
        rows = [
            _load(context, builder, signature, (array, builder.add(at, _at(i))))
            for i in range(LANES)
        ]
        step = 1
        while step < LANES:
            ends = [at + LANES - step if at & step else at for at in range(LANES)]
            for i in range(LANES):
                if not i & step:
                    a, b = rows[i], rows[i + step]
                    rows[i] = builder.shuffle_vector(a, b, _mask(ends))
                    rows[i + step] = builder.shuffle_vector(a, b, _mask(e + step for e in ends))
            step *= 2
        return context.make_tuple(builder, signature.return_type, rows)

    return types.UniTuple(_LANES, LANES)(array, types.intp), emitted


@intrinsic
def spread(typing: Any, number: Any) -> Any:  # noqa: ARG001
    """Return a vector that repeats one number or word."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return _repeated(builder, values[0])

    if number is types.uint64:
        return _WORDS(types.uint64), emitted
    return _LANES(types.float64), emitted


@intrinsic
def total(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Return the sum of eight numbers, by repeatedly adding the two halves of the vector."""

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


@intrinsic
def of_lanes(typing: Any, value: Any, at: Any) -> Any:  # noqa: ARG001
    """Return the number at index `at`, 0 to 7, of eight numbers."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return builder.extract_element(*values)

    return types.float64(_LANES, types.intp), emitted


@intrinsic
def alternated(typing: Any, some: Any, others: Any) -> Any:  # noqa: ARG001
    """Return eight numbers, from `some` at even indices and from `others` at odd indices."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return builder.shuffle_vector(*values, _mask(i + LANES * (i % 2) for i in range(LANES)))

    return _LANES(_LANES, _LANES), emitted


def _of_llvm(builder: Any, name: str, values: Any) -> Any:
    """Emit a call of a function that LLVM provides, and return its result."""
    kind = ir.FunctionType(values[0].type, [value.type for value in values])
    function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
    return builder.call(function, values)


@intrinsic
def root(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Return the square root of each of eight numbers."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return _of_llvm(builder, f"llvm.sqrt.v{LANES}f64", values)

    return _LANES(_LANES), emitted


@intrinsic
def rotated(typing: Any, value: Any, bits: Any) -> Any:  # noqa: ARG001
    """Return eight words, each rotated left by `bits`."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        by = _repeated(builder, values[1])
        return _of_llvm(builder, f"llvm.fshl.v{LANES}i64", [values[0], values[0], by])

    return _WORDS(_WORDS, types.uint64), emitted


def _same_bits(kind: Any) -> Any:
    """Return a function that emits code to reinterpret the bits of eight elements as a type."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return builder.bitcast(values[0], _vector(_element(kind)))

    return emitted


@intrinsic
def as_lanes(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Reinterpret the bits of eight words as numbers."""
    return _LANES(_WORDS), _same_bits(_LANES)


@intrinsic
def as_words(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Reinterpret the bits of eight numbers as words."""
    return _WORDS(_LANES), _same_bits(_WORDS)


@intrinsic
def chosen(typing: Any, which: Any, some: Any, others: Any) -> Any:  # noqa: ARG001
    """Return eight numbers, each chosen from two.

    Parameters
    ----------
    typing : Context
        Typing context of numba.
    which : types.Type
        One word a lane: nonzero selects the number of `some`, 0 the number of `others`.
    some, others : types.Type
        The numbers.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        zeros = ir.Constant(values[0].type, None)
        return builder.select(builder.icmp_unsigned("!=", values[0], zeros), *values[1:])

    return _LANES(_WORDS, _LANES, _LANES), emitted


@intrinsic
def below(typing: Any, a: Any, b: Any) -> Any:  # noqa: ARG001
    """Return eight words: all bits set where `a` is below `b`, otherwise 0."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return builder.sext(builder.fcmp_ordered("<", *values), _vector(ir.IntType(64)))

    return _WORDS(_LANES, _LANES), emitted


@intrinsic
def anywhere(typing: Any, value: Any) -> Any:  # noqa: ARG001
    """Return whether any of eight words is nonzero."""

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        zeros = ir.Constant(values[0].type, None)
        some = builder.icmp_unsigned("!=", values[0], zeros)
        bits = builder.bitcast(some, ir.IntType(LANES))
        return builder.icmp_unsigned("!=", bits, bits.type(0))

    return types.boolean(_WORDS), emitted


@intrinsic
def columns(typing: Any, array: Any, at: Any) -> Any:  # noqa: ARG001
    """Load eight rows of a contiguous array (n, 3), beginning at flat index `at`; return the three
    columns.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        a, b, c = (
            _load(context, builder, signature, (values[0], builder.add(values[1], _at(i))))
            for i in range(3)
        )
        found = []
        for k in range(3):
            entries = [3 * i + k for i in range(LANES)]
            early = [entry % (2 * LANES) for entry in entries]
            late = [i if entries[i] < 2 * LANES else entries[i] - LANES for i in range(LANES)]
            first = builder.shuffle_vector(a, b, _mask(early))
            found.append(builder.shuffle_vector(first, c, _mask(late)))
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(_LANES, 3)(array, types.intp), emitted


@intrinsic
def add_columns(typing: Any, array: Any, at: Any, x: Any, y: Any, z: Any) -> Any:  # noqa: ARG001
    """Add three columns to eight rows of a contiguous array (n, 3).

    Parameters
    ----------
    typing : Context
        Typing context of numba.
    array : types.Array
        The array.
    at : types.Integer
        Flat index of the first row.
    x, y, z : types.Type
        The columns.
    """
    return types.none(array, types.intp, _LANES, _LANES, _LANES), _rows_stored(add=True)


@intrinsic
def store_columns(typing: Any, array: Any, at: Any, x: Any, y: Any, z: Any) -> Any:  # noqa: ARG001
    """Store three columns in eight rows of a contiguous array (n, 3).

    Parameters
    ----------
    typing : Context
        Typing context of numba.
    array : types.Array
        The array.
    at : types.Integer
        Flat index of the first row.
    x, y, z : types.Type
        The columns.
    """
    return types.none(array, types.intp, _LANES, _LANES, _LANES), _rows_stored(add=False)


def _rows_stored(*, add: bool) -> Any:
    """Return a function that emits code to store three columns as rows of an array (n, 3).

    If `add`, the columns are added to the elements of the array.
    """

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        array, at, *column = values
        for i in range(3):
            entries = [divmod(LANES * i + k, 3) for k in range(LANES)]
            pair = [row + LANES * (k == 1) for row, k in entries]
            rest = [LANES + row if k == 2 else j for j, (row, k) in enumerate(entries)]
            part = builder.shuffle_vector(column[0], column[1], _mask(pair))
            part = builder.shuffle_vector(part, column[2], _mask(rest))
            where = array, builder.add(at, _at(i))
            if add:
                part = builder.fadd(_load(context, builder, signature, where), part)
            builder.store(part, _place(context, builder, signature.args, *where), align=8)
        return context.get_dummy_value()

    return emitted


def _at(i: int) -> Any:
    """Return the constant 8 i, the offset of the i-th vector in an array."""
    return ir.Constant(ir.IntType(64), LANES * i)


def _give(operation: Any, instruction: str, lanes: Any, number: Any) -> None:
    """Define an operator for two vectors, and for a vector and a number, in compiled code.

    `instruction` is LLVM's name of the operation, `lanes` the type of the vectors, and `number` the
    class of Numba's types of numbers.
    """

    @type_callable(operation)
    def typed(context: Any) -> Any:  # noqa: ARG001
        """Declare the operand and result types of the operator to Numba."""

        def of(a: Any, b: Any) -> Any:
            kinds = a is lanes, b is lanes
            others = [kind for kind, own in zip((a, b), kinds, strict=True) if not own]
            if any(kinds) and all(isinstance(kind, number) for kind in others):
                return lanes
            return None

        return of

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
        return _combined(builder, instruction, signature.args, values)

    for kinds in ((lanes, lanes), (lanes, number), (number, lanes)):
        lower_builtin(operation, *kinds)(emitted)


for _operation, _instruction in (
    (operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):  # fmt: skip
    _give(_operation, _instruction, _LANES, types.Float)
for _operation, _instruction in (
    (operator.add, "add"), (operator.xor, "xor"), (operator.and_, "and_"), (operator.or_, "or_"),
    (operator.lshift, "shl"), (operator.rshift, "lshr"),
):  # fmt: skip
    _give(_operation, _instruction, _WORDS, types.Integer)


@type_callable(operator.neg)
def _negated_type(context: Any) -> Any:  # noqa: ARG001
    """Declare to Numba that the negative of a vector of numbers is such a vector."""
    return lambda a: _LANES if a is _LANES else None


@lower_builtin(operator.neg, _LANES)
def _negated(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
    """Emit code for the negative of a vector of numbers."""
    return builder.fneg(values[0])
